"""Tests about one manipulator of the catalogue run on one worker, so that it is compiled once.

Other tests stay together by file.  For `pytest -n 2 --dist loadgroup`.
"""

from __future__ import annotations

import pytest

from pne_sym import manipulators

_NAMES = frozenset(manipulators.names())


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Group the tests before they are distributed."""
    for item in items:
        values = item.callspec.params.values() if hasattr(item, "callspec") else ()
        named = [value for value in values if isinstance(value, str) and value in _NAMES]
        group = named[0] if named else item.path.as_posix()
        item.add_marker(pytest.mark.xdist_group(group))
