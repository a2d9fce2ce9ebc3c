"""A model at home and at poses around it, before anything is printed.

The functions of the program are evaluated by the interpreter with the parameters of the
specification.  What is not finite at home is refused; where only the linear equations of the
dynamics are singular, or a pose around home fails, a warning says so and why.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import equation_titles
from pne_sym.mechanics.mobility import motions_at_home
from pne_sym.model.errors import SpecError, SpecWarning
from pne_sym.model.kinematics import TASK_SPACES, Array, displaced, pose_at
from pne_sym.model.manipulator import Manipulator
from pne_sym.program.evaluate import Evaluation, Failure, Flags, Status, evaluate, prepare
from pne_sym.program.interpret import REST, Interpreter
from pne_sym.program.iteration import close_loops

STEP = 0.01
"""How far the poses around home are: no angle (rad) or length (of the mechanism's size) more."""
_STILL = 1e-6  # a direction of this size is none
_AT_HOME = 2  # states at home: at rest and moving; the others are around it
_CAUSES = {
    "unreachable": "does not reach the platform, by",
    "singular": "is singular, by",
    "invalid": "cannot be evaluated, by",
}
_FUNCTIONS = {  # of the program, by what is public of them
    "inverse_kinematics": "inverse_kinematics",
    "joint_rates": "joint_rates",
    "dynamics": "M, Z, H",
    "constraints": "constraints",
    "joint_accelerations": "joint_accelerations",
    "required": "inverse_dynamics",
    "legs": "leg_reactions",
    "potential": "energy",
    "dissipation": "dissipation",
    "motors": "motor_rates",
    "joint_margins": "joint_margins",
    "effort_limits": "reachable_wrench",
}


_SOLVED = ("inverse_dynamics", "leg_reactions", "complete_acceleration", "forward_dynamics")
_UNDERDRIVEN = "fewer actuators than degrees of freedom, so that no forces give any acceleration"


def check_home(bundle: Bundle) -> None:
    """Evaluate a model at home and around it.

    Warns with `SpecWarning` where inverse or forward dynamics have no solution, or a pose
    around home is impossible.

    Raises:
        SpecError: a function of the model is not finite at home; the message says which, at
            which leg, and which equation it is.
    """
    model = _Model(bundle)
    model.require_home()
    for message in (*model.around_home(), *model.solves()):
        warnings.warn(f"{bundle.name}: {message}", SpecWarning, stacklevel=2)


class _Fault(NamedTuple):
    """A function that is not finite at some states, and the first reason."""

    function: str
    states: Flags
    reason: str


class _Model:
    """The model's functions at home, at rest and moving, and at the poses around it."""

    def __init__(self, bundle: Bundle) -> None:
        self.bundle, self.titles = bundle, equation_titles(bundle.derivation)
        self.prepared = prepare(bundle.program, bundle.derivation.parameters.values())
        home = np.array(bundle.coordinates.home[0])
        X = np.array([*[home] * _AT_HOME, *poses_around_home(bundle.manipulator)])
        n = bundle.coordinates.sizes["NV"]
        moving = np.tile(1.0 / np.arange(2, n + 2), (len(X), 1))
        moving[0] = 0.0
        q, self.converged = close_loops(
            bundle.program, self.prepared, X, np.array(bundle.coordinates.home[1])
        )
        base = np.tile(REST, (len(X), 1))
        self.vectors = {"X": X, "V": moving, "A": moving, "base": base, "q": q}
        self.found = {
            name: evaluate(bundle.program, name, self.prepared, self.vectors)
            for name in _FUNCTIONS
            if name in bundle.program.functions
        }

    def require_home(self) -> None:
        """Refuse a model that is not finite at home."""
        faults = list(self._faults(slice(0, _AT_HOME)))
        if faults:
            raise SpecError(
                self.bundle.name,
                "home",
                f"{', '.join(f.function for f in faults)} would be NaN there: {faults[0].reason}",
                "a home, and parameters, at which the model can be evaluated",
            )

    def around_home(self) -> Iterator[str]:
        """What fails at poses around home, though not there."""
        faults = list(self._faults(slice(_AT_HOME, None)))
        if faults:
            failed = np.any([f.states for f in faults], axis=0)
            yield (
                f"home: {', '.join(f.function for f in faults)} NaN at {_share(failed)} around it, "
                f"{STEP:g} rad or {STEP:.0%} of the size away: {faults[0].reason}"
            )

    def solves(self) -> Iterator[str]:
        """Public functions without a solution by structure, at home, or at poses around it."""
        c = self.bundle.coordinates
        failed = self._unsolved(c.sizes["NU"])
        if not c.actuation.is_determined:
            never = [name for name, states in failed.items() if states.all()]
            yield f"{', '.join(never)}: NaN at every state: {_UNDERDRIVEN}"
            failed = {name: states for name, states in failed.items() if name not in never}
        reasons: dict[str, list[str]] = {}
        for name in failed:
            reasons.setdefault(_singular(name, constrained=c.sizes["NC"] > 0), []).append(name)
        for reason, names in reasons.items():
            states = np.any([failed[n] for n in names], axis=0)
            around = f"at {_share(states[_AT_HOME:])} around it"
            where = "there" if states[:_AT_HOME].any() else around
            yield f"home: {', '.join(names)} NaN {where}: {reason}"

    def _unsolved(self, actuators: int) -> dict[str, Flags]:
        """Functions that solve linear equations -> states at which these have no solution."""
        c, program = self.bundle.coordinates, self.bundle.program
        model = Interpreter(program, self.prepared, c.home[1])
        given = {**self.vectors, "tau": np.ones((len(self.vectors["X"]), actuators))}
        usable = self.converged & (self.found["dynamics"].status == Status.OK)
        found = {}
        for name in _SOLVED:
            if name in model.functions:
                inputs = {a.name: given[a.name] for a in model.functions[name].required}
                found[name] = (model.call(name, **inputs).status != Status.OK) & usable
        return {name: states for name, states in found.items() if states.any()}

    # ---- reasons ---------------------------------------------------------------------

    def _faults(self, where: slice) -> Iterator[_Fault]:
        """Functions that are not finite at some of the states, with the reason for the first."""
        open_ = ~self.converged[where]
        if open_.any():
            reason = "Newton's iteration from home's displacements does not close the loops"
            yield _Fault("inverse_kinematics", open_, reason)
            return
        for name, evaluation in self.found.items():
            failed = evaluation.status[where] != Status.OK
            if failed.any():
                state = int(np.flatnonzero(failed)[0]) + (where.start or 0)
                yield _Fault(_FUNCTIONS[name], failed, self._reason(name, evaluation, state))

    def _reason(self, name: str, evaluation: Evaluation, state: int) -> str:
        """Why a function is not finite at a state: a guard, or else the first value that is not."""
        status = Status(int(evaluation.status[state])).name.lower()
        for failure in evaluation.failures:
            if failure.check.status == status and failure.failed[..., state].any():
                return self._of_guard(failure, state)
        program = self.bundle.program
        parts = [(self.prepared, 0, block) for block in program.prepare]
        parts += [(evaluation.values, state, block) for block in program.functions[name].blocks]
        for values, column, block in parts:
            for a in block.assignments:
                broken = ~np.isfinite(_at(values[a.target.name], column))
                if broken.any():
                    where = self._where(block.leg_type, broken)
                    return f"{where}{self._equation(a.equation)} is not finite"
        return "a sum over the legs is not finite"

    def _of_guard(self, failure: Failure, state: int) -> str:
        where = self._where(failure.leg_type, failure.failed[..., state])
        subject = where.removesuffix(": ") or "the platform"
        return f"{subject} {_CAUSES[failure.check.status]} {self._equation(failure.check.equation)}"

    def _where(self, leg_type: str, failed: Flags) -> str:
        """The first leg that fails, as it is written in a specification."""
        if not leg_type:
            return ""
        info = next(t for t in self.bundle.derivation.leg_types if t.name == leg_type)
        failed = np.broadcast_to(failed, len(info.indices))
        index = info.indices[int(np.flatnonzero(failed)[0])]
        name = self.bundle.manipulator.legs[index].name
        return f"legs[{index}]{f' ({name})' if name else ''}: "

    def _equation(self, id_: str) -> str:
        title = self.titles.get(id_, "")
        return f"equation {id_} ({title})" if title else f"equation {id_}"


def _at(value: Array, state: int) -> Array:
    """A value at one state, () or (legs,); prepared ones are the same at all."""
    value = np.atleast_1d(value)  # a number of the structure has no states
    return np.asarray(value[..., state if value.shape[-1] > 1 else 0])


def poses_around_home(manipulator: Manipulator) -> list[Array]:
    """X at `STEP` from home to both sides, along what the mechanism can do there to first order.

    One pair for every platform coordinate and extra joint: the motion that is nearest to moving
    it alone.
    """
    space, joints = manipulator.space, manipulator.joints
    twist, size = list(TASK_SPACES[space].components), _size(manipulator)
    slides = np.array([c < 3 for c in twist] + [not j.kind.is_angle for j in joints])
    units = np.where(slides, size, 1.0)
    basis = np.linalg.qr(motions_at_home(manipulator) / units[:, None])[0]
    extra = [len(twist) + k for k, joint in enumerate(joints) if joint.extra]
    own = len(TASK_SPACES[space].pose_names)
    X, poses = np.array(manipulator.home.X), []
    for k in (*range(len(twist)), *extra):
        motion = basis @ basis[k]
        if np.abs(motion).max(initial=0.0) < _STILL:
            continue
        motion *= STEP * units / np.abs(motion).max()
        for step in (motion, -motion):
            platform = displaced(space, X[:own], step[: len(twist)])
            poses.append(np.concatenate((platform, X[own:] + step[extra])))
    return poses


def _size(manipulator: Manipulator) -> float:
    """The largest distance between joints of base and platform at home, m; 1 if there is none."""
    pose = pose_at(manipulator.space, manipulator.home.X, manipulator.fixed_centre)
    points = [np.array(leg.base_point) for leg in manipulator.legs]
    points += [pose.t + pose.R @ np.array(leg.platform_point) for leg in manipulator.legs]
    found = np.array(points)
    size = float(np.linalg.norm(found[:, None] - found[None, :], axis=-1).max())
    return size if size > 0.0 else 1.0


def _singular(function: str, *, constrained: bool) -> str:
    """Why a function has no solution."""
    if function in ("inverse_dynamics", "leg_reactions"):
        return f"{'[H Hk]' if constrained else 'H'} is singular"
    if function != "forward_dynamics":
        return "the equations of the passive extra coordinates are singular"
    if constrained:
        return (
            "the matrix of accelerations and multipliers is singular: a motion without inertia, "
            "or constraints that depend on one another"
        )
    return "M is singular: a motion without inertia"


def _share(failed: Flags) -> str:
    return f"{int(failed.sum())} of {failed.size} poses"
