"""Random mechanisms against the independent projection: the second half, for one worker."""

from __future__ import annotations

import pytest

from tests.random.cases import SECOND, check_breadth, judged
from tests.sampling import sampled


@pytest.mark.parametrize("seed", sampled(SECOND, 0, keep=[63, 67]))
def test_right_or_refused_for_a_reason(seed: int) -> None:
    found = judged(seed)
    assert not found.problem, found


@pytest.mark.only_in_all  # judges every seed
def test_everything_occurs() -> None:
    check_breadth(SECOND)
