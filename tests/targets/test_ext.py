"""Every function of every catalogue entry: the extension module against the NumPy module."""

from __future__ import annotations

import pytest

from pne_sym import manipulators
from tests.backends.ext_module import assert_all_alike


@pytest.mark.parametrize("name", manipulators.names())
def test_equal_to_the_numpy_module(name: str) -> None:
    assert_all_alike(name)
