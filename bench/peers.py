"""Pinocchio and MuJoCo, called from Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from bench.cases import Case, States
from bench.mujoco_model import in_mujoco
from bench.pinocchio_model import constraint_dynamics


def peers(case: Case, s: States) -> Iterator[tuple[str, Callable[[int], Any]]]:
    """Keys, and what computes the state of a number."""
    yield "Pinocchio, constraintDynamics forward_dynamics", constraint_dynamics(case, s)
    yield from in_mujoco(case, s)
