"""Every function of every catalogue entry in Octave, against the NumPy modules."""

from __future__ import annotations

import pytest

from pne_sym import manipulators
from tests import models
from tests.octave.conformance import conforms


@pytest.mark.parametrize("name", manipulators.names())
def test_equal_to_the_numpy_module(name: str) -> None:
    conforms(models.catalogue(name))
