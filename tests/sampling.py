"""Which cases of a parametrised test run in `make test`; `make test-all` runs all of them."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import pytest


def sampled(cases: Iterable[Any], every: int, keep: Collection[Any] = ()) -> list[Any]:
    """The cases of a test, of which one of `every` runs always, from the first on.

    Args:
        cases: values of a parameter, or tuples of several.
        every: how many cases a sampled one stands for.
        keep: cases that always run.
    """
    return [
        case if k % every == 0 or case in keep else _only_in_all(case)
        for k, case in enumerate(cases)
    ]


def _only_in_all(case: Any) -> Any:
    values = case if isinstance(case, tuple) else (case,)
    return pytest.param(*values, marks=pytest.mark.only_in_all)
