"""`pne-gen home`, and what is said where home.q is found."""

from __future__ import annotations

from pathlib import Path

from tests.cli.program import pne_gen
from tests.cli.test_faults import assert_refused

TWO_BARS = """
name = "two_bars"
space = "point"
platform.mass = 1.0
[leg_types.rrr]
platform_joint = { kind = "R", offset = [0.5, 0.0] }
joints = [
    { kind = "R", actuated = true, link = { mass = 1.0, inertia = 0.1 } },
    { kind = "R", offset = [0.5, 0.0], link = { mass = 1.0, inertia = 0.1 } },
]
[[legs]]
type = "rrr"
base_point = [-0.3, 0.0]
[[legs]]
type = "rrr"
base_point = [0.3, 0.0]
[home]
X = [0.0, 0.4]
"""
THIRD = "1.047197551"


def test_closures_are_listed_and_q_is_told(tmp_path: Path) -> None:
    """An equilateral triangle of 0.5 m above a base 0.3 m aside: two elbows for each leg."""
    (tmp_path / "two_bars.toml").write_text(TWO_BARS, encoding="utf-8")
    done = pne_gen("home", "two_bars.toml", cwd=tmp_path, real=True)
    assert done.returncode == 0
    assert done.stdout.splitlines() == [
        "two_bars: X = [0, 0.4]",
        "legs[0]: 2 closures",
        "  [1.974492769, -2.094395102]  home",
        "  [-0.1199023332, 2.094395102]",
        "legs[1]: 2 closures",
        "  [1.167099884, 2.094395102]  home",
        "  [-3.02169032, -2.094395102]",
        "branch of home: rrr legs: rrr_branch_1 = +1 -1",
    ]
    assert done.stderr.startswith("pne-gen: two_bars.toml: home: q found from X: q = [[1.97449, ")


def test_a_home_that_cannot_be_closed_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "two_bars.toml"
    path.write_text(TWO_BARS.replace("X = [0.0, 0.4]", "X = [0.0, 1.4]"), encoding="utf-8")
    assert_refused(pne_gen("home", path, real=True), "no displacements close the loops at X")
