"""What values are: statements get their names, equations and signs when all of them are made.

While values are made nothing is known of what else they are: a value may be found again as a
component of a later quantity, or with the other sign.  So names are given behind everything, by
what the tables of the lowering say.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation, Law
from pne_sym.lowering import algebra
from pne_sym.lowering.components import Lowering
from pne_sym.lowering.margins import OWN_NAMES
from pne_sym.lowering.statements import End, Statement, of_leg
from pne_sym.program.ir import Component, Kind

Signed = tuple[int, Component]


class Meaning:
    """What the values of a program are.

    Attributes:
        lowered: quantity -> frame and components in which it was made first.
    """

    def __init__(self, derivation: Derivation, lowerings: Iterable[Lowering]) -> None:
        equations = tuple(derivation.equations())
        self._id = {e.name: e.id for e in equations}
        self._quantity = {e.id: e.name for e in equations}
        self._order = {e.id: k for k, e in enumerate(equations)}
        self._constant = {e.name for e in equations if e.law is Law.LUMPING}
        self._frames = {f.name: k for k, f in enumerate(derivation.frames)}
        self._signed: dict[Any, dict[Signed, None]] = {}
        self._turned: set[Any] = set()
        self._called: dict[Any, Any] = {}  # names that were given
        self.lowered: dict[str, tuple[str, tuple[Any, ...]]] = {}
        for lowering in lowerings:
            for component, atom in lowering.components():
                sign, symbol = algebra.signed(atom)
                if symbol.is_Symbol:
                    self._signed.setdefault(symbol, {})[sign, component] = None
            for name, found in lowering.made().items():
                self.lowered.setdefault(name, found)

    # ---- what a value is -----------------------------------------------------------------

    def of(self, symbol: Any) -> tuple[Component, ...]:
        """What it is, the first thing it is first; nothing where it is none of all."""
        return self._with(symbol, 1)

    def _with(self, symbol: Any, sign: int) -> tuple[Component, ...]:
        found = [c for known, c in self._signed.get(symbol, ()) if known == sign]
        return tuple(sorted(found, key=self._rank))

    def is_opposite(self, symbol: Any) -> bool:
        """Whether it is the negative of something, and nothing itself."""
        signs = {sign for sign, _ in self._signed.get(symbol, ())}
        return signs == {-1}

    def turn(self, symbol: Any) -> None:
        """Note that it has the other sign now."""
        self._signed[symbol] = {(-sign, c): None for sign, c in self._signed.get(symbol, ())}
        self._turned ^= {symbol}

    def opposites(self) -> dict[tuple[str, str, str], list[Any]]:
        """Values that are the negative of something, and nothing themselves, by of what."""
        found: dict[tuple[str, str, str], list[Any]] = {}
        for symbol in self._signed:
            if self.is_opposite(symbol):
                c = self._with(symbol, -1)[0]
                found.setdefault((c.quantity or c.axes, c.frame, c.over), []).append(symbol)
        return found

    def _rank(self, component: Component) -> tuple[Any, ...]:
        """Quantities in order of derivation, at home; then what is given; then axes."""
        equation = self._id.get(component.quantity, "")
        home = self.lowered.get(component.quantity, ("", ()))[0]
        return (
            bool(component.axes),
            not equation,
            self._order.get(equation, -1),
            component.frame not in ("", "base"),
            component.frame != home,
            self._frames.get(component.frame, -1),
            self._frames.get(component.axes, -1),
            component.index,
        )

    # ---- names ---------------------------------------------------------------------------

    def stem(self, statement: Statement, names: Mapping[Any, Any]) -> str:
        """The name of a value but for its number: what it is, or what it is for.

        Args:
            statement: that makes it.
            names: of values made before.
        """
        expr, stem = statement.expr, f"{self._quantity.get(statement.equation, 'v')}_t"
        if statement.hint:
            stem = statement.hint
        elif expr.is_Pow and expr.exp == -1 and expr.base.is_Symbol:
            stem = f"inv_{names.get(expr.base, expr.base).name}"
        return of_leg(stem, statement.stage.leg_type)

    def by_name(
        self, statements: Iterable[Statement], names: Mapping[Any, Any]
    ) -> dict[str, tuple[Component, ...]]:
        """What values are, by their names in a function; first what a value is called by."""
        found = {}
        for s in statements:
            self._called.setdefault(s.target, names[s.target])
            means = sorted(self.of(s.target), key=lambda c: c.name != s.hint)
            if means:
                found[names[s.target].name] = tuple(means)
        return found

    def shown(self) -> dict[str, tuple[str, tuple[Any, ...]]]:
        """`lowered`, by the names that values have in the first function that has them."""

        def named(atom: Any) -> Any:
            called = {s: self._called.get(s, s) for s in algebra.symbols(atom)}
            signs = {s: -c if s in self._turned else c for s, c in called.items()}
            return algebra.replaced(atom, signs)

        return {
            name: (frame, tuple(named(sp.sympify(atom)) for atom in found))
            for name, (frame, found) in self.lowered.items()
        }

    # ---- equations -----------------------------------------------------------------------

    def told(
        self, statements: Iterable[Statement], uses: Iterable[Statement | End]
    ) -> list[Statement]:
        """The statements with their equations, and the names of what they are as hints.

        A value has the name of the first quantity that it is a component of, but none that the
        derivation defines later than the value is needed.  What has no such name belongs to the
        first equation that needs it.

        Args:
            statements: in an order of computation.
            uses: what else uses them.
        """
        needed: dict[Any, str] = {}
        for use in uses:
            for expr in use.read:
                self._note(needed, expr, use.equation)
        found: list[Statement] = []
        for s in reversed(tuple(statements)):
            need = needed.get(s.target, s.equation)
            of = next((c for c in self.of(s.target) if self._is_known(c, need)), None)
            part = of or next(
                (c for c in self._with(s.target, -1) if self._is_known(c, need)), None
            )
            equation = self._id.get(part.quantity, need) if part else need
            own = s.hint.removeprefix(f"{s.stage.leg_type}_") in OWN_NAMES
            hint = of.name if of else s.hint if own else ""
            found.append(s._replace(equation=equation, hint=hint))
            self._note(needed, s.expr, need if self._is_turned(s, part) else equation)
        return self.sorted(found[::-1])

    def sorted(self, statements: Sequence[Statement]) -> list[Statement]:
        """The statements in the order of the derivation, each after what it uses."""
        rank = {s.target: (self.order(s.equation), k) for k, s in enumerate(statements)}
        users: dict[Any, list[Statement]] = {}
        waits: dict[Any, int] = {}
        for s in statements:
            own = [symbol for symbol in algebra.symbols(s.expr) if symbol in rank]
            waits[s.target] = len(own)
            for symbol in own:
                users.setdefault(symbol, []).append(s)
        ready = [(rank[s.target], s) for s in statements if not waits[s.target]]
        heapq.heapify(ready)
        found: list[Statement] = []
        while ready:
            found.append(heapq.heappop(ready)[1])
            for user in users.get(found[-1].target, ()):
                waits[user.target] -= 1
                if not waits[user.target]:
                    heapq.heappush(ready, (rank[user.target], user))
        return found

    def _is_known(self, component: Component, need: str) -> bool:
        """Whether the derivation defines a quantity no later than in an equation."""
        equation = self._id.get(component.quantity, "")
        return not equation or self.order(equation) <= self.order(need)

    def _is_turned(self, statement: Statement, part: Component | None) -> bool:
        """Whether it is what is constant in a link, in other axes: these are known later."""
        constant = part is not None and part.quantity in self._constant
        return constant and statement.stage.kind is Kind.STATE_LEG

    def _note(self, needed: dict[Any, str], expr: Any, equation: str) -> None:
        for symbol in algebra.symbols(expr):
            if symbol not in needed or self.order(equation) < self.order(needed[symbol]):
                needed[symbol] = equation

    def order(self, equation: str) -> int:
        """Place of an equation in the derivation."""
        return self._order.get(equation, len(self._order))
