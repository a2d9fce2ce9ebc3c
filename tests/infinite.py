"""Answers with infinite entries, as joints without limits have them."""

from __future__ import annotations

from typing import Any

import numpy as np


def finite_parts(found: Any, wanted: Any) -> list[Any]:
    """Both without their infinite entries, which are the same."""
    endless = np.isposinf(wanted)
    np.testing.assert_array_equal(np.isposinf(found), endless)
    return [np.where(endless, 0.0, a) for a in (found, wanted)]
