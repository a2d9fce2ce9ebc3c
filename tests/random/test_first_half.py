"""Random mechanisms against the independent projection: the first half, for one worker."""

from __future__ import annotations

import pytest

from tests.random.cases import FIRST, check_breadth, judged
from tests.sampling import sampled


@pytest.mark.parametrize("seed", sampled(FIRST, 0, keep=[0, 16]))
def test_right_or_refused_for_a_reason(seed: int) -> None:
    found = judged(seed)
    assert not found.problem, found


@pytest.mark.only_in_all  # judges every seed
def test_everything_occurs() -> None:
    check_breadth(FIRST)
