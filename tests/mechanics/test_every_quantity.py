"""Every line of every derivation at random, asymmetric parameters and states.

Each named quantity is evaluated from its equation and compared with a value that owes nothing to
the derivation (`independent`); its other forms must give the same; what depends on the platform's
acceleration must be coefficient times acceleration plus remainder, at several accelerations.
Names without an independent value are listed, and may not grow in number.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import sympy as sp

from pne_sym.derivation import Derivation, Equation, FailureStatus
from pne_sym.mechanics.derive import derive
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked
from pne_sym.vector import (
    LinearForm,
    Tensor,
    TensorSymbol,
    Vector,
    VectorSymbol,
    linear_form,
)
from tests.mechanics.evaluation import Array, Names, Situation
from tests.mechanics.independent import (
    ASSEMBLED,
    PLATFORM,
    Facts,
    PlatformFacts,
    leg_value,
)
from tests.mechanics.structures import REFUSED, STRUCTURES, drawn
from tests.models import random_spec, state_at
from tests.oracle.projection import admissible
from tests.random.effects import with_effects
from tests.sampling import entries, sampled

TOLERANCE = 1e-9
LEAST_SHARE = 0.85
CONSISTENT_ONLY = re.compile(
    r"(Kc|Ks|Kr|Kd|rho2|disc|root|un|um|uu|from_centre)_\d+"  # steps of the inverse kinematics
    r"|(z|n|n0|l|aside|across|reference|c0|s0)_\d+|n0?_\d+_part"  # frames; they must be orthonormal
    r"|n_c\d*|f_c_part|f_c_size|mu_c|(f|size|n|mu|m\d+|mu\d+)_c\d+|volume_c|o_c|phi_c\d+|gamma_c\d+"
    r"|wn_\d+|end_l\d|t_c\d+"  # wrenches and moments come as components in some basis
    r"|n_m\d+|nd_m\d+|nu_\d+|m\d+_w_\d+"
    r"|Hk_a_\d+|M_ya_\d+|legs_size"
)
"""Names that have no independent value of their own: what is made of them has one."""
OF_CHOICE = re.compile(r"(f|size|n|mu|gamma|phi|m\d+|mu\d+)_c\d+|Hk_a_\d+")
"""Those of the wrenches that a guide leaves out: they span a space, its basis is a choice."""
DRESSED = [
    ("extra revolute between", 3),
    ("planar, extra slides", 4),
    ("one slide, universal at the platform", 5),
    ("translational, three slides", 6),
    ("helix at the base", 8),
]
"""Structures that are examined with friction, springs and motors, and the seeds of these."""
AT_REST = {"Z_p": "f_p", "Z_q": "mu_p"}
"""What another quantity comes to at zero acceleration."""


class Account:
    """What was compared, and the worst errors."""

    def __init__(self) -> None:
        self.independent: set[str] = set()
        self.consistent: set[str] = set()
        self.faults: list[str] = []
        self.worst = 0.0

    def compare(self, where: str, found: Any, expected: Any) -> None:
        found, expected = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
        scale = float(np.abs(expected).max(initial=0.0))
        error = float(np.abs(found - np.broadcast_to(expected, found.shape)).max(initial=0.0))
        if not error <= TOLERANCE * scale + 1e-10:
            self.faults.append(f"{where}: {found.tolist()} instead of {expected.tolist()}")
        elif scale > 1e-6:
            self.worst = max(self.worst, error / scale)


def accelerations(situation: Situation) -> list[Array]:
    """Admissible accelerations; zero among them where nothing forbids it.

    A coefficient that is wrong in any entry is seen at one that is drawn at random.
    """
    rng = np.random.default_rng(8)
    A = situation.A
    free, _ = admissible(situation.oracle)
    steps = [free @ rng.uniform(-8.0, 8.0, free.shape[1]) for _ in range(2)]
    others = [A + step for step in steps]
    return [np.zeros_like(A), *others] if free.shape[1] == A.size else others


class Examination:
    """One derivation at one state."""

    def __init__(self, manipulator: Manipulator, seed: int) -> None:
        self.manipulator = manipulator
        self.derivation: Derivation = derive(self.manipulator)
        state = state_at(self.manipulator, seed)
        self.main = Situation(self.manipulator, self.derivation, state, state.A)
        self.others = [
            Situation(self.manipulator, self.derivation, state, A) for A in accelerations(self.main)
        ]
        self.facts = [Facts(names) for names in self.main.legs]
        self.other_facts = [[Facts(names) for names in s.legs] for s in self.others]
        self.account = Account()

    def run(self) -> Account:
        for chapter in self.derivation.chapters:
            if chapter.leg_type is None:
                for equation in chapter.equations:
                    self.platform(equation)
                continue
            for index, names in enumerate(self.main.legs):
                if names.leg_type == chapter.leg_type:
                    for equation in chapter.equations:
                        self.leg_line(equation, index, names)
        for index in range(len(self.main.legs)):
            self.linear_forms(index)
        self.collected_platform()
        return self.account

    # ---- one line -------------------------------------------------------------------------

    def line(self, equation: Equation, names: Names, where: str) -> None:
        """Forms agree, rules keep the value, conditions hold at a regular state."""
        value = names[equation.name]
        for k, form in enumerate(equation.forms):
            self.account.compare(f"{where}, form {k + 1}", names.value(form), value)
        for step in equation.steps:
            self.account.compare(
                f"{where}, {step.rule}: {step.before}",
                names.value(step.after),
                names.value(step.before),
            )
        for condition in equation.conditions:
            amount, scale = names.value(condition.value), names.value(condition.scale)
            if condition.status is FailureStatus.UNREACHABLE:
                held = amount >= 0.0
            else:
                held = abs(amount) > 1e-4**condition.power * scale
            if not held:
                self.account.faults.append(f"{where}: {condition} fails at a regular state")

    def leg_line(self, equation: Equation, index: int, names: Names) -> None:
        where = f"leg {index}: {equation.name}"
        self.line(equation, names, where)
        stem = names.stem(equation.name)
        coefficient = re.fullmatch(r"d(?:alpha|y_\d+)?_(?!\d)(.*)", stem)
        bare = (coefficient.group(1) if coefficient else stem).removesuffix("_o")
        if CONSISTENT_ONLY.fullmatch(bare):
            self.account.consistent.add(equation.id)
            return
        if bare == "U":
            bare, stem = "c", "c_o"  # up to its sign: see linear_forms
        found = leg_value(bare)
        if found is None:
            self.account.faults.append(f"{where}: no independent value, and not listed as such")
            return
        self.account.independent.add(equation.id)
        if stem == bare:
            function, number = found
            self.account.compare(
                where,
                names[equation.name],
                self._seen(names[equation.name], function(self.facts[index], number)),
            )

    def _seen(self, found: Any, expected: Any) -> Any:
        """In the plane only what maps the plane into itself, or the normal, counts."""
        expected = np.asarray(expected, dtype=float)
        if not self.facts[0].planar or expected.shape != (3, 3):
            return expected
        seen = np.array(found, dtype=float)
        seen[:2, :2] = expected[:2, :2]
        if abs(seen[2, 2]) > 0.0 and np.abs(expected[2, 2]) > 0.0:
            seen[2, 2] = expected[2, 2]
        return seen

    # ---- the platform -----------------------------------------------------------------------

    def platform(self, equation: Equation) -> None:
        name, facts = equation.name, PlatformFacts(self.facts)
        if name not in (*PLATFORM, *ASSEMBLED, *AT_REST):
            self.of_a_leg(equation)
            return
        self.line(equation, self.main.platform, name)
        value = self.main.platform[name]
        self.account.independent.add(name)
        if name in PLATFORM:
            self.account.compare(name, value, self._seen(value, PLATFORM[name](facts)))
        elif name in ASSEMBLED:
            blocks, expected = ASSEMBLED[name]
            where = np.ix_(*(self._components(block) for block in blocks.split()))
            self.account.compare(name, np.asarray(value)[where], expected(facts))
        else:
            still = Situation(
                self.manipulator, self.derivation, self.main.state, np.zeros_like(self.main.A)
            )
            at_rest = PlatformFacts([Facts(names) for names in still.legs])
            self.account.compare(name, value, PLATFORM[AT_REST[name]](at_rest))

    def collected_platform(self) -> None:
        """Forces and moments of the platform by M and Z, at all accelerations.

        Not where there are extra coordinates, whose accelerations act on the platform too.
        """
        if any(facts.extras for facts in self.facts):
            return
        for name, form in self.derivation.collected.items():
            if form is None or self.derivation.notation[name].leg_type:
                continue
            for s in self.others:
                parts = [s.platform.value(c @ x) for x, c in form.coefficients.items()]
                total = sum(parts) + s.platform.value(form.remainder)
                seen = self._components("linear" if name in ("f_p", "R_t") else "angular")
                self.account.compare(f"{name} collected", total[seen], s.platform[name][seen])
                self.account.independent.add(name)

    def of_a_leg(self, equation: Equation) -> None:
        """A quantity per leg in a chapter on the platform: columns of H, rows of extras."""
        for index, names in enumerate(self.main.legs):
            if equation.id.startswith(f"{names.leg_type}-"):
                self.leg_line(equation, index, names)

    def _components(self, block: str) -> list[int]:
        coordinates = self.derivation.coordinates
        assert coordinates is not None
        first = 0 if block == "linear" else 3
        return [c - first for c in coordinates.components if first <= c < first + 3]

    # ---- coefficient times acceleration plus remainder ----------------------------------------

    def linear_forms(self, index: int) -> None:
        """Each quantity of a leg that depends on the acceleration, at all accelerations."""
        names = self.main.legs[index]
        known: dict[Any, LinearForm] = {}
        a_p = VectorSymbol(names.named("a_p"))
        extras = {
            sp.Symbol(names.named(f"ydd_{j}"), real=True): j for j in self.facts[index].extras
        }
        unknowns = [a_p, VectorSymbol("alpha"), *extras]
        for chapter in self.derivation.chapters:
            for equation in chapter.equations if chapter.leg_type == names.leg_type else ():
                dependent = names_of(equation.rhs) & {
                    *(u.name for u in unknowns),
                    *(k.name for k in known),
                }
                if not dependent or equation.lhs == a_p or isinstance(equation.lhs, Tensor):
                    continue
                form = linear_form(equation.rhs, unknowns, known)
                marks = {a_p: "", VectorSymbol("alpha"): "alpha"}
                marks |= {unknown: f"y_{j}" for unknown, j in extras.items()}
                known[equation.lhs] = self._named(index, names, equation, form, marks)
                self._at_all(index, equation.name, known[equation.lhs])

    def _named(
        self, index: int, names: Names, equation: Equation, form: LinearForm, marks: Any
    ) -> LinearForm:
        """The form with the derivation's names for its parts, where it has them."""
        parts = {}
        for unknown, value in form.coefficients.items():
            name = names.named(f"d{marks[unknown]}_{names.stem(equation.name)}")
            parts[unknown] = self._checked(index, names, name, value)
        remainder = self._checked(index, names, f"{equation.name}_o", form.remainder)
        return LinearForm(parts, remainder)

    def _checked(self, index: int, names: Names, name: str, value: Any) -> Any:
        if name not in names.defined:
            return value
        self.account.compare(f"leg {index}: {name}", names[name], names.value(value))
        if isinstance(value, Vector):
            return VectorSymbol(name)
        return TensorSymbol(name) if isinstance(value, Tensor) else sp.Symbol(name, real=True)

    def _at_all(self, index: int, name: str, form: LinearForm) -> None:
        names = self.main.legs[index]
        found = leg_value(names.stem(name))
        if found is None:
            return
        function, number = found
        parts = [(u.name, names.value(c)) for u, c in form.coefficients.items()]
        remainder = names.value(form.remainder)
        for s, facts in zip(self.others, self.other_facts, strict=True):
            total = remainder
            for unknown, coefficient in parts:
                x = s.legs[index][unknown]
                vector = np.ndim(x) == 1
                total = total + (coefficient @ x if vector else coefficient * x)
            self.account.compare(
                f"leg {index}: {name} as a linear form", total, function(facts[index], number)
            )


PLANTED = ("hexapod_6ucu", "hybrid_3rrrs", "hybrid_3rrrs_redundant")
"""Entries on which faults are planted in tests/mutants."""


def names_of(expr: Any) -> set[str]:
    if hasattr(expr, "name"):
        return {expr.name}
    return {name for arg in getattr(expr, "args", ()) for name in names_of(arg)}


@pytest.mark.parametrize("name", entries(keep=PLANTED))
def test_every_quantity(name: str) -> None:
    """Of the catalogue, with random geometry, inertia, frames and gravity."""
    account = Examination(random_spec(name, 1), 1).run()
    assert not account.faults, "\n".join(account.faults[:20])
    assert account.worst < TOLERANCE
    assert not account.independent & account.consistent
    rest = {found for found in account.consistent if not OF_CHOICE.match(found.partition("-")[2])}
    share = len(account.independent) / len(account.independent | rest)
    assert share > LEAST_SHARE, sorted(rest)


@pytest.mark.parametrize("name", sampled([s for s in STRUCTURES if s not in REFUSED], 3))
def test_every_quantity_of_other_structures(name: str) -> None:
    account = Examination(drawn(name), 11).run()
    assert not account.faults, "\n".join(account.faults[:20])


@pytest.mark.parametrize(("name", "seed"), sampled(DRESSED, 2))
def test_every_quantity_with_friction_springs_and_motors(name: str, seed: int) -> None:
    spec = with_effects(drawn(name), np.random.default_rng(seed), share=1.0)
    account = Examination(checked(spec), seed).run()
    assert not account.faults, "\n".join(account.faults[:20])
    assert any(re.search("-(friction|spring|rotor)", found) for found in account.independent)


@pytest.mark.parametrize("name", REFUSED)
def test_refused_structures(name: str) -> None:
    with pytest.raises(SpecError, match=REFUSED[name]):
        derive(drawn(name))
