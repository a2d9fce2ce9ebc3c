"""M and Z: the acceleration collected in Newton's and Euler's equations of the platform.

The equations stand in the chapter before, with the legs' forces as they are.  Here these are put
in by Eq. 4, and Rules I and II collect what then depends on the platform's acceleration, as they do
for the legs.

Reference: sections 2.3 and 2.4, Eqs. 32 to 34.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from pne_sym.derivation import Book, Equation, names_in
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.mechanics.terms import Writer, glossary
from pne_sym.vector import (
    LinearForm,
    RuleApplication,
    Transpose,
    Vector,
    VectorSymbol,
    ZeroVector,
    linear_form,
    sum_over_legs,
    vector_sum,
)


class Side(NamedTuple):
    """Forces, or moments: names of what is collected, and what is made of it.

    Attributes:
        inertia: inertia force or moment of the platform.
        required: what actuators and external wrench must give.
        row: of M.
        own, whole: what is left of these two.
    """

    inertia: str
    required: str
    row: str
    own: str
    whole: str


FORCES = Side("f_p", "R_t", "t", "Z_p", "Z_t")
MOMENTS = Side("mu_p", "R_a", "a", "Z_q", "Z_a")
_TERMS = glossary(r"""
M_tt | \mathbf M_{tt}           | RULES symmetric @base | Eq. 34
    translational block of M
M_ta | \mathbf M_{t\alpha}      | RULES @base | Eq. 34
    coupling block of M
M_aa | \mathbf M_{\alpha\alpha} | RULES symmetric @base | Eq. 34
    rotational block of M
Z_p  | \mathbf Z_p              | RULES | Eq. 34
    centripetal force and weight of the platform
Z_q  | \mathbf Z_q              | RULES | Eq. 34
    gyroscopic moment and moment of the weight of the platform
Z_t  | \mathbf Z_t              | RULES | Eq. 34
    translational part of Z
Z_a  | \mathbf Z_\alpha         | RULES | Eq. 34
    rotational part of Z
""")


class BlockWriter:
    """Collects the platform's acceleration, and writes its coefficients and what is left."""

    def __init__(
        self, book: Book, platform: PlatformMotion, legs: Sequence[Leg], mass: Any, moment: Vector
    ) -> None:
        self.book, self.p, self.legs = book, platform, legs
        self.mass, self.moment = mass, moment
        self.eq = Writer(book, None, _TERMS)
        both = {"t": platform.t_ddot, "a": platform.alpha}
        self.unknowns = {index: x for index, x in both.items() if x != ZeroVector}
        self.known: dict[Any, LinearForm] = {}
        self.steps: list[RuleApplication] = []

    def write(self) -> dict[str, Any]:
        """The blocks of M and the parts of Z by their names."""
        sides = [side for side in (FORCES, MOMENTS) if side.row in self.unknowns]
        plain = {side: self._own(side) for side in sides}
        for leg in self.legs:
            self._leg(leg)
        forms = {side: self._form(self._equation(side.required).rhs) for side in sides}
        found: dict[str, Any] = {}
        for side in sides:
            for index in self.unknowns:
                if side.row + index != "at":  # that block is the mirror image of the one for "ta"
                    block = self._block(side, index, forms[side], plain[side])
                    found[side.row + index] = block
        for side in sides:
            found[side.own] = self._rest(side.own, side.inertia, plain[side])
            found[side.whole] = self._rest(side.whole, side.required, forms[side])
            self._collected(side, found, plain[side], forms[side])
        return found

    def _equation(self, name: str) -> Equation:
        return next(e for e in self.book.all_equations() if e.name == name)

    def _form(self, expr: Any) -> LinearForm:
        return linear_form(expr, list(self.unknowns.values()), self.known)

    # ---- what the equations use -------------------------------------------------------

    def _own(self, side: Side) -> LinearForm:
        """The platform's inertia force or moment; from here on its rest has a name."""
        a_t = next((e for e in self.book.all_equations() if e.name == "a_t"), None)
        if a_t is not None:
            self.known[a_t.lhs] = self._form(a_t.rhs)
        form = self._form(self._equation(side.inertia).rhs)
        named = replace(form, remainder=VectorSymbol(side.own))
        self.known[VectorSymbol(side.inertia)] = named
        return form

    def _leg(self, leg: Leg) -> None:
        """Force and moment of a leg by Eq. 4, its connection point moving with the platform."""
        d, a_p = leg.dynamics, leg.motion.a_p
        given = next((e for e in self.book.all_equations() if e.lhs == a_p), None)
        point = given.rhs if given is not None else a_p
        force = replace(d.form, remainder=-d.U)
        if a_p in force.coefficients:
            force = replace(force, coefficients={**force.coefficients, a_p: -d.Q})
        for symbol, form in ((d.force, force), (d.moment, d.moment_form)):
            if symbol != ZeroVector:
                closed = self._form(vector_sum(self._terms(form, a_p, point)))
                self.known[symbol] = closed
                self.steps.extend(_summed(step, leg.name) for step in closed.steps)

    def _terms(self, form: LinearForm, a_p: Any, point: Vector) -> Iterator[Vector]:
        """Eq. 4 without actuation.

        Accelerations of extra coordinates are left out: M is symmetric, their columns are the
        rows of these coordinates.
        """
        for x, c in form.coefficients.items():
            if x == a_p:
                yield c @ point
            elif x == self.p.alpha:
                yield c @ x
        yield form.remainder

    # ---- what comes out ---------------------------------------------------------------

    def _block(self, side: Side, index: str, form: LinearForm, own: LinearForm) -> Any:
        """A block of M: a coefficient of what actuators and external wrench must give."""
        unknown = self.unknowns[index]
        steps = (
            s for s in (*own.steps, *self.steps, *form.steps) if unknown.name in names_in(s.before)
        )
        rules = LinearForm({}, ZeroVector, tuple(dict.fromkeys(steps)))
        whole, value = self._equation(side.required).rhs, form.coefficients[unknown]
        return self.eq(f"M_{side.row}{index}", value, linear=rules, expanded=whole)

    def _rest(self, symbol: str, name: str, form: LinearForm) -> Any:
        """What is left of a quantity at zero acceleration of the platform."""
        equation, forms = self._equation(name), tuple[Any, ...]()
        if symbol == FORCES.own and equation.forms:  # with the spin's tensor, which legs use too
            forms = (self.p.spin @ self.moment - self.mass * self.p.gravity,)
        return self.eq(
            symbol,
            form.remainder,
            body=self.book.notation[name].body,
            forms=forms,
            expanded=equation.rhs,
            remainder_of=name,
        )

    def _collected(
        self, side: Side, found: dict[str, Any], own: LinearForm, form: LinearForm
    ) -> None:
        """Tell what has been collected, by names."""
        named = {
            x: found[side.row + index]
            if side.row + index in found
            else Transpose(found[index + side.row])
            for index, x in self.unknowns.items()
        }
        self.book.collect(side.inertia, replace(own, remainder=found[side.own]), own)
        self.book.collect(side.required, LinearForm(named, found[side.whole]), form)


def _summed(step: RuleApplication, leg_type: str) -> RuleApplication:
    """The same step for all legs of a type."""
    before, after = (sum_over_legs(x, leg_type) for x in (step.before, step.after))
    return replace(step, before=before, after=after)
