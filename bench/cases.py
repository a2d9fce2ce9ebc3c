"""The mechanisms that are measured, their states, and what is right there."""

from __future__ import annotations

import importlib
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import ModuleType

import numpy as np

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.generation import generate
from pne_sym.model.manipulator import Manipulator
from pne_sym.pipeline import compile_bundle
from pne_sym.program.evaluate import prepare

Array = np.ndarray

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "bench"
"""Generated models, programs and their states: nothing of it is kept in the repository."""
NAMES = ("stewart", "planar_3rrr", "tripod_3rps", "hexapod_6rus")
STATES = 256
"""As many as stay in the second level of the cache with all their results."""
NEAR_HOME = 0.02
"""Poses differ from home by up to so much [m, rad]."""
FUNCTIONS = ("inverse_dynamics", "dynamics", "forward_dynamics")


@dataclass(frozen=True)
class States:
    """States of the mechanism that keep its constraints, with the forces that they take.

    Attributes:
        X: (states, NQ).
        V: (states, NV).
        A: (states, NV).
        tau: (states, NU).
    """

    X: Array
    V: Array
    A: Array
    tau: Array


class Case:
    """A mechanism of the catalogue, generated."""

    def __init__(self, name: str, manipulator: Manipulator | None = None) -> None:
        self.name = name
        self.manipulator = manipulator or manipulators.load(name)
        self.folder = BUILD / "generated" / name

    def generate(self) -> None:
        """Write the code of all targets that are measured."""
        generate(self.manipulator, self.folder.parent, ("numpy", "c", "xp", "ext"))

    def module(self, suffix: str = "") -> ModuleType:
        """NAME.py, NAME_ext.py or NAME_xp.py."""
        if str(self.folder) not in sys.path:
            sys.path.insert(0, str(self.folder))
        return importlib.import_module(f"{self.name}{suffix}")

    @cached_property
    def bundle(self) -> Bundle:
        """The program itself, for code of other generators."""
        return compile_bundle(self.manipulator)

    @cached_property
    def prepared(self) -> dict[str, Array]:
        """Prepared values by name, (legs,) or (1,)."""
        given = self.bundle.derivation.parameters.values()
        values = prepare(self.bundle.program, given)
        return {name: np.atleast_1d(np.squeeze(v)) for name, v in values.items()}

    def states(self, count: int = STATES) -> States:
        """States near home: the same for everybody, in every run."""
        m, rng = self.module(), np.random.default_rng(0)
        X = m.HOME_X + NEAR_HOME * rng.uniform(-1.0, 1.0, (count, m.NQ))
        V = rng.uniform(-1.0, 1.0, (count, m.NV))
        tau = m.inverse_dynamics(X, 0.0 * V, 0.0 * V)
        if m.NC:  # states must keep the constraints
            X, tau = m.project(X), tau[0]
            Hk = m.Hk(X)
            V = V - (Hk @ np.linalg.solve(Hk.mT @ Hk, Hk.mT @ V[..., None]))[..., 0]
        tau = tau + 20.0 * rng.uniform(-1.0, 1.0, (count, m.NU))
        A = m.forward_dynamics(X, V, tau)
        return States(X, V, A[0] if m.NC else A, tau)

    def right(self, s: States) -> dict[str, tuple[Array, ...]]:
        """What every function gives, by the NumPy module."""
        m = self.module()
        forces = m.inverse_dynamics(s.X, s.V, s.A)
        M, Z, H, *_ = m.dynamics(s.X, s.V)
        return {
            "inverse_dynamics": (forces[0] if m.NC else forces,),
            "dynamics": (M, Z, H),
            "forward_dynamics": (s.A,),
        }


def error(found: tuple[Array, ...], right: tuple[Array, ...]) -> float:
    """The largest difference of an entry, relative to the largest entry of its array."""
    pairs = zip(found, right, strict=True)
    return max(float(np.max(np.abs(f - r)) / np.max(np.abs(r))) for f, r in pairs)
