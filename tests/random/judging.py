"""The generated code of a drawn mechanism against the independent projection.

Every compared quantity is an error relative to its largest entry.  Where a leg leaves
directions out, the split of its inertia between free and constrained directions is a matter
of choice; there the reduced quantities are compared, which are not.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.numpy_backend import NumpyBackend
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import JointKind, Manipulator, Space
from pne_sym.model.reader import checked
from pne_sym.pipeline import compile_bundle
from tests.backends.c_library import QUICK, CLibrary
from tests.oracle.base import Carried, base_of
from tests.oracle.closure import OracleError
from tests.oracle.comparison import relative_error
from tests.oracle.coordinates import (
    extra_indices,
    is_planar,
    passive_extra_rows,
    platform_rotation,
)
from tests.oracle.effects import margins
from tests.oracle.forces import RANK_TOLERANCE, are_held
from tests.oracle.jets import Array
from tests.oracle.projection import Result, accelerated, admissible, project
from tests.oracle.projection import complete_acceleration as complete
from tests.oracle.specs import State, random_state
from tests.random.invariants import Invariants

TOLERANCE = 1e-9
"""Largest error of a right answer; legs and actuators of what is drawn are well conditioned."""
GUESS = 0.02
"""How far the first guess of an iterated leg is off, m or rad."""


@dataclass
class Verdict:
    """What became of a mechanism.

    Attributes:
        refused: the reason, if it is outside the method.
        stateless: the oracle found no regular state beside home.
        errors: worst error by quantity.
        iterated: whether displacements are found by iteration.
        constrained: whether legs restrict the platform.
        overconstrained: whether some of these constraints follow from others.
        compiled: whether C was compared as well.
        other_branch: states at which iteration from home found another closure.
    """

    refused: str = ""
    stateless: bool = False
    errors: dict[str, float] = field(default_factory=dict)
    iterated: bool = False
    constrained: bool = False
    overconstrained: bool = False
    compiled: bool = False
    other_branch: int = 0

    def note(self, name: str, error: float) -> None:
        """Keep the worst."""
        error = float("inf") if np.isnan(error) else error
        self.errors[name] = max(self.errors.get(name, 0.0), error)

    @property
    def wrong(self) -> dict[str, float]:
        """Quantities that are not right."""
        return {name: error for name, error in self.errors.items() if not error < TOLERANCE}


def judge(
    manipulator: Manipulator,
    rng: np.random.Generator,
    *,
    states: int = 2,
    with_c: bool = False,
) -> Verdict:
    """Derive a mechanism, generate its code, and compare it at random states near home."""
    verdict = Verdict()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            manipulator = checked(manipulator)
            bundle = compile_bundle(manipulator)
        except SpecError as error:
            verdict.refused = f"{error.problem}; expected {error.expected}"
            return verdict
    module = _module(bundle)
    try:
        drawn = [random_state(manipulator, rng, 0.7) for _ in range(states)]
    except OracleError:
        verdict.stateless = True
        home = np.array(manipulator.home.X), np.array(manipulator.home.q)
        drawn = [_at_home(manipulator, rng, *home)]
    drawn = [_under_actuators(manipulator, rng, state) for state in drawn]
    verdict.iterated = any(not info.is_closed for info in bundle.derivation.leg_types)
    verdict.constrained = module.NC > 0
    verdict.overconstrained = module.OVERCONSTRAINED > 0
    for state in drawn:
        _Comparison(manipulator, module, verdict, state, rng).run()
    if with_c:
        _judge_c(bundle, module, verdict, drawn)
    return verdict


def _module(bundle: Bundle) -> Any:
    source = NumpyBackend().emit(bundle)[f"{bundle.name}.py"]
    made = ModuleType(bundle.name)
    exec(compile(source, f"<{bundle.name}.py>", "exec"), made.__dict__)
    return Carried(made, base_of(bundle.manipulator)) if bundle.manipulator.moving_base else made


def _at_home(manipulator: Manipulator, rng: np.random.Generator, X: Array, q: Array) -> State:
    """An admissible motion at home."""
    nv = project_size(manipulator, X)
    V, A = rng.uniform(-1.0, 1.0, nv), rng.uniform(-5.0, 5.0, nv)
    first = project(manipulator, X, q, V)
    V = V - np.linalg.pinv(first.Hk.T) @ (first.Hk.T @ V)
    moving = project(manipulator, X, q, V)
    A = A - np.linalg.pinv(moving.Hk.T) @ (moving.Hk.T @ A + moving.constraint_bias)
    wrench = rng.uniform(-20.0, 20.0, nv - len(extra_indices(manipulator)))
    try:
        A = complete(manipulator, X, q, V, A, wrench)
    except OracleError:  # too few actuators leave passive coordinates open
        A = _caused(manipulator, rng, State(X, q, V, A, wrench))
    return State(X, q, V, A, wrench)


def _under_actuators(manipulator: Manipulator, rng: np.random.Generator, state: State) -> State:
    """The state, with an acceleration that passive extra coordinates and constraints both obey.

    Where constraints hold passive coordinates, completing A from their rows could leave the
    manifold; what actuators and wrench cause does not.
    """
    moving = project(manipulator, *state)
    passive = passive_extra_rows(manipulator)
    if not passive or not np.abs(moving.Hk[passive]).max(initial=0.0) > RANK_TOLERANCE:
        return state
    return state._replace(A=_caused(manipulator, rng, state))


def _caused(manipulator: Manipulator, rng: np.random.Generator, state: State) -> Array:
    """The acceleration that random actuators cause at a state."""
    moving = project(manipulator, *state)
    return accelerated(manipulator, moving, rng.uniform(-20.0, 20.0, moving.H.shape[1]))


def project_size(manipulator: Manipulator, X: Array) -> int:
    """Length of V at coordinates X: a quaternion has one entry more."""
    return int(X.size) - (manipulator.space.value in ("spatial", "spherical"))


class _Comparison:
    """One state of one mechanism."""

    def __init__(
        self,
        manipulator: Manipulator,
        module: Any,
        verdict: Verdict,
        state: State,
        rng: np.random.Generator,
    ) -> None:
        self.manipulator, self.module, self.verdict, self.state = (
            manipulator,
            module,
            verdict,
            state,
        )
        self.ours: Result = project(manipulator, *state)
        guess = state.q + rng.uniform(-GUESS, GUESS, state.q.size)
        self.guess = {"q0": guess} if verdict.iterated else {}
        self.rng = rng

    def run(self) -> None:
        """Compare every function."""
        m, s, ours, guess = self.module, self.state, self.ours, self.guess
        note = self.note
        note("q", self._turned(m.inverse_kinematics(s.X, **guess)), s.q)
        if self.verdict.iterated:
            default = self._turned(m.inverse_kinematics(s.X))
            self.verdict.other_branch += bool(relative_error(default, s.q) > TOLERANCE)
        note("rates", m.joint_rates(s.X, s.V, **guess), ours.qd)
        note("accelerations", m.joint_accelerations(s.X, s.V, s.A, **guess), ours.qdd)
        self._dynamics()
        self._actuators()
        self._controller()
        Invariants(self.manipulator, m, s, self.rng, guess).check(self.verdict.note)
        kinetic, potential = m.energy(s.X, s.V, **guess)
        note("energy", np.array([kinetic, potential]), np.array([ours.kinetic, ours.potential]))

    def note(self, name: str, actual: Array, expected: Array) -> None:
        """Keep the error of a quantity; a wrong shape is an infinite one."""
        same = np.shape(actual) == np.shape(expected)
        self.verdict.note(name, relative_error(actual, expected) if same else np.inf)

    def _turned(self, q: Array) -> Array:
        """Displacements with turns counted as those of the state."""
        joints = [joint for leg in self.manipulator.legs for joint in leg.joints]
        turning = np.array([joint.kind is not JointKind.PRISMATIC for joint in joints])
        revolute = np.array([joint.kind is JointKind.REVOLUTE for joint in joints])
        result = np.array(q)
        whole = np.round((result - self.state.q) / (2 * np.pi)) * 2 * np.pi
        # Helical joints are not taken modulo a turn: it would move them along.
        return np.where(turning & revolute, result - whole, result)

    def _controller(self) -> None:
        """What a controller calls: actuators, limits, power."""
        m, s, ours, guess = self.module, self.state, self.ours, self.guess
        joints = [joint for leg in self.manipulator.legs for joint in leg.joints]
        own = list(m.ACTUATED)
        self.note("actuators", np.array([m.actuator_rates(s.X, s.V, **guess),
                  m.actuator_accelerations(s.X, s.V, s.A, **guess)]),
                  np.array([ours.qd[own], ours.qdd[own]]))  # fmt: skip
        room, wanted = m.joint_margins(s.X, **guess), margins(joints, s.q)
        limited = np.isfinite(wanted)
        self.note("margins", np.where(limited, room, 0.0), np.where(limited, wanted, 0.0))
        self.note("unlimited", np.isinf(room), ~limited)
        inside = m.within_limits(s.X, **guess)
        self.note("within limits", inside, float((wanted >= 0.0).all()))
        tau = np.linspace(-3.0, 2.0, m.NU)
        power = np.array([m.dissipation(s.X, s.V, **guess), m.power(s.X, s.V, tau, **guess)])
        self.note("power", power, np.array([ours.dissipation, tau @ ours.qd[own]]))

    def _dynamics(self) -> None:
        m, s, ours, guess = self.module, self.state, self.ours, self.guess
        M, Z, H = m.dynamics(s.X, s.V, **guess)
        self.note("M, Z, H alone", np.hstack([m.M(s.X, **guess).ravel(), m.Z(s.X, s.V, **guess),
                  m.H(s.X, **guess).ravel()]), np.hstack([M.ravel(), Z, H.ravel()]))  # fmt: skip
        if not m.NC:
            self.note("constraints", np.zeros(ours.Hk.shape[1]), np.zeros(0))
            for name, mine, theirs in (("M", M, ours.M), ("Z", Z, ours.Z), ("H", H, ours.H)):
                self.note(name, mine, theirs)
            return
        N, c = admissible(ours)
        self.note("M", N.T @ M @ N, N.T @ ours.M @ N)
        bias = N.T @ (ours.M @ c + ours.Z)
        # Reduced, the terms may cancel: an arm that turns without weight.
        scale = np.abs(ours.M @ c).max() + np.abs(ours.Z).max()
        gap = float(np.abs(N.T @ (M @ c + Z) - bias).max())
        self.verdict.note("Z", gap / scale if scale else gap)
        self.note("H", N.T @ H, N.T @ ours.H)
        Hk = m.Hk(s.X, **guess)
        self.verdict.note("Hk", float("inf") if Hk.shape != ours.Hk.shape else _span(Hk, ours.Hk))
        self.verdict.note("constraints", float(np.abs(m.constraints(s.X, **guess)).max()))
        left = Hk.T @ s.A + m.constraint_bias(s.X, s.V, **guess)
        size = 1.0 + np.abs(ours.constraint_bias).max(initial=0.0) + np.abs(s.A).max()
        self.verdict.note("constraint bias", float(np.abs(left).max() / size))

    def _actuators(self) -> None:
        """Inverse and forward dynamics, reactions: where the actuators determine them."""
        m, s, ours, guess = self.module, self.state, self.ours, self.guess
        motion = m.forward_dynamics(s.X, s.V, ours.tau, wrench=s.wrench, **guess)
        expected = accelerated(self.manipulator, ours, ours.tau)
        self.note("forward", motion[0] if m.NC else motion, expected)
        if not are_held(np.hstack([ours.H, ours.Hk]), passive_extra_rows(self.manipulator)):
            return
        found = m.inverse_dynamics(s.X, s.V, s.A, wrench=s.wrench, **guess)
        self.note("tau", found[0] if m.NC else found, ours.tau)
        mine = m.leg_reactions(s.X, s.V, s.A, wrench=s.wrench, **guess)
        theirs = np.array([leg.reaction for leg in ours.legs])[:, : mine.shape[-1]]
        idle = any(self._has_idle_wrench(k) for k in range(len(ours.legs)))
        if m.OVERCONSTRAINED:  # how legs share them is a matter of choice
            mine, theirs = (self._in_all(each, idle=idle) for each in (mine, theirs))
        elif idle:
            mine, theirs = self._effect(mine), self._effect(theirs)
        self.note("reactions", mine, theirs)

    def _in_all(self, reactions: Array, *, idle: bool) -> Array:
        """Forces of all legs together, where these are not shared with a guidance, and effects."""
        effect = np.sum(self._effect(reactions), axis=0)
        return effect if idle else np.concatenate((np.sum(reactions[:, :3], axis=0), effect))

    def _has_idle_wrench(self, k: int) -> bool:
        """Whether a leg can hold the platform in a way that does no work along its motions."""
        leg = self.manipulator.legs[k]
        moments = {"S": 0, "U": 1, "R": 2, "rigid": 3}[leg.platform_joint.kind.value]
        transmitted = 2 if is_planar(self.manipulator.space) else 3 + moments
        free = sum(not joint.extra for joint in leg.joints)
        return transmitted - free > len(self.ours.legs[k].constraint_wrenches)

    def _effect(self, reactions: Array) -> Array:
        """What reactions do along the platform's motions: the rest is shared with its guidance."""
        if self.manipulator.space is Space.TRANSLATIONAL:
            return reactions[:, :3]
        turned = platform_rotation(self.manipulator, self.state.X)
        arms = np.array([leg.platform_point for leg in self.manipulator.legs]) @ turned.T
        moments = reactions[:, 3:] if reactions.shape[1] > 3 else np.zeros_like(reactions)
        return np.asarray(np.cross(arms, reactions[:, :3]) + moments)


def _span(mine: Array, theirs: Array) -> float:
    """How far two sets of unit columns are from spanning the same, in unit amounts."""
    match = np.linalg.lstsq(theirs, mine, rcond=None)[0]
    return relative_error(theirs @ match, mine)


_C_FUNCTIONS: dict[str, Callable[[Any, State, Array, dict[str, Array]], Any]] = {
    "inverse_kinematics": lambda m, s, tau, q0: m.inverse_kinematics(s.X, **q0),
    "joint_rates": lambda m, s, tau, q0: m.joint_rates(s.X, s.V, **q0),
    "joint_accelerations": lambda m, s, tau, q0: m.joint_accelerations(s.X, s.V, s.A, **q0),
    "M": lambda m, s, tau, q0: m.M(s.X, **q0),
    "Z": lambda m, s, tau, q0: m.Z(s.X, s.V, **q0),
    "H": lambda m, s, tau, q0: m.H(s.X, **q0),
    "inverse_dynamics": lambda m, s, tau, q0: m.inverse_dynamics(
        s.X, s.V, s.A, wrench=s.wrench, **q0
    ),
    "inverse_dynamics_weighted": lambda m, s, tau, q0: m.inverse_dynamics(
        s.X, s.V, s.A, wrench=s.wrench, weights=np.linspace(1.0, 2.0, m.NU), **q0
    ),
    "forward_dynamics": lambda m, s, tau, q0: m.forward_dynamics(
        s.X, s.V, tau, wrench=s.wrench, **q0
    ),
    "leg_reactions": lambda m, s, tau, q0: m.leg_reactions(s.X, s.V, s.A, wrench=s.wrench, **q0),
    "energy": lambda m, s, tau, q0: m.energy(s.X, s.V, **q0),
    "Hk": lambda m, s, tau, q0: m.Hk(s.X, **q0),
    "complete_acceleration": lambda m, s, tau, q0: m.complete_acceleration(
        s.X, s.V, s.A, wrench=s.wrench, **q0
    ),
    "constraint_bias": lambda m, s, tau, q0: m.constraint_bias(s.X, s.V, **q0),
    "dissipation": lambda m, s, tau, q0: m.dissipation(s.X, s.V, **q0),
    "motor_rates": lambda m, s, tau, q0: m.motor_rates(s.X, s.V, **q0),
    "motor_torques": lambda m, s, tau, q0: m.motor_torques(s.X, s.V, s.A, tau, **q0),
    "reachable_wrench": lambda m, s, tau, q0: m.reachable_wrench(
        s.X, s.V, s.A, s.wrench, wrench=s.wrench, **q0
    ),
    "force_distribution": lambda m, s, tau, q0: m.force_distribution(
        s.X, s.V, s.A, *_bounds(m, s, q0), wrench=s.wrench, **q0
    ),
}


def _bounds(module: Any, state: State, q0: dict[str, Array]) -> tuple[Array, Array]:
    """Bounds of actuator forces, some of which are met."""
    s = state
    found = module.inverse_dynamics(s.X, s.V, s.A, wrench=s.wrench, **q0)
    tau = np.nan_to_num(found[0] if module.NC else found)
    size = np.max(np.abs(tau), initial=1.0)
    around = size * np.where(np.arange(module.NU) % 2, 0.5, 0.05)
    return tau - around, tau + 2.0 * size * np.where(np.arange(module.NU) % 3, -0.02, 1.0)


def _judge_c(bundle: Bundle, module: Any, verdict: Verdict, states: list[State]) -> None:
    """The generated C against the generated NumPy."""
    with tempfile.TemporaryDirectory() as folder:
        library = CLibrary(bundle, Path(folder), flags=QUICK)
        for state in states:
            tau = np.random.default_rng(1).uniform(-20.0, 20.0, module.NU)
            weights = np.linspace(1.0, 2.0, module.NU)
            arguments = {**state._asdict(), "tau": tau, "q0": state.q, "weights": weights}
            arguments["base"] = base_of(bundle.manipulator).flat
            guess = {"q0": state.q} if verdict.iterated else {}
            arguments["wrench_direction"] = state.wrench
            arguments["tau_min"], arguments["tau_max"] = _bounds(module, state, guess)
            arguments["reference"] = np.zeros(module.NU)
            for name, call in _C_FUNCTIONS.items():
                if name not in library.api:
                    continue
                expected = call(module, state, tau, guess)
                inputs = [arguments[argument.name] for argument in library.api[name].inputs]
                outputs, _ = library.single(name, *inputs)
                parts = expected if isinstance(expected, tuple) else (expected,)
                for mine, theirs in zip(outputs, parts, strict=True):
                    theirs = np.ravel(theirs)
                    if np.isnan(theirs).all() and np.isnan(mine).all():
                        continue
                    endless = np.isinf(theirs) & (mine == theirs)
                    mine, theirs = (np.where(endless, 0.0, v) for v in (mine, theirs))
                    if name == "constraint_bias":  # its terms may cancel to nothing but rounding
                        one = np.ones(1)
                        mine, theirs = np.append(mine, one), np.append(theirs, one)
                    verdict.note(f"C {name}", relative_error(mine, theirs))
    verdict.compiled = True
