"""What ends a run of the tests."""

import gc

import pytest


@pytest.hookimpl(tryfirst=True)
def pytest_unconfigure() -> None:
    """Expressions that are left are not looked through for cycles, which takes seconds."""
    gc.freeze()
