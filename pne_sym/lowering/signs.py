"""Values that are the negative of a quantity's component get its sign, where that costs nothing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from operator import attrgetter
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.lowering import algebra
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.meaning import Meaning
from pne_sym.lowering.statements import Statement


def settle(
    builder: Builder, meaning: Meaning, statements: Sequence[Statement], stored: Sequence[Any]
) -> set[Any]:
    """Turn the signs of values that are the negative of something, where that takes no operation.

    The components of a quantity are turned together, and with them whatever has no sign of its
    own and then needs fewer changes of sign.

    Args:
        builder: its statements and guards are changed.
        meaning: of the values; it is told what was turned.
        statements: as they will be printed, about.
        stored: values as they are stored.

    Returns:
        the symbols that have the other sign.
    """
    signs = _Signs(builder, meaning, statements, stored)
    groups = [[s for s in g if s in signs.form] for g in meaning.opposites().values()]
    for group in (g for g in groups if g):
        if not signs.turn(group) and len(group) > 1:
            for symbol in group:
                signs.turn([symbol])
    turned = {symbol for symbol, sign in signs.sign.items() if sign == -1}
    changes = {symbol: -symbol for symbol in turned}
    expressions = {s.target: algebra.replaced(s.expr, changes) for s in builder.statements}
    builder.rewrite(expressions | {s: -expressions[s] for s in turned}, changes)
    for symbol in turned:
        meaning.turn(symbol)
    return turned


_LEGS = 3  # for how many a statement of legs counts, so that one leg more changes no sign


class _Term(NamedTuple):
    """What the sign of a term depends on.

    Attributes:
        sign: its own.
        is_free: it has a number as a factor, which takes any sign.
        odd: values that change its sign with theirs.
        inner: expressions in it whose signs stay in there.
    """

    sign: int
    is_free: bool
    odd: tuple[Any, ...]
    inner: tuple[tuple[_Term, ...], ...]


@lru_cache(1 << 16)
def _form(expr: Any) -> tuple[_Term, ...]:
    """The terms of an expression."""
    return tuple(map(_term, sp.Add.make_args(expr)))


def _term(expr: Any) -> _Term:
    factor, rest = expr.as_coeff_Mul()
    odd, inner = [], []
    for part in sp.Mul.make_args(rest):
        base, exponent = part.as_base_exp()
        if base.is_Symbol and exponent.is_Integer:
            odd += [base] if exponent % 2 else []
        elif part.is_Add:
            inner.append(_form(part))
        else:
            inner += [_form(arg) for arg in part.args if not arg.is_Number]
    return _Term(-1 if factor.is_negative else 1, abs(factor) != 1, tuple(odd), tuple(inner))


class _Signs:
    """Signs of values, and how many changes of sign they make needed.

    Attributes:
        form: the terms of each value.
        sign: -1 of values that are turned.
    """

    def __init__(
        self,
        builder: Builder,
        meaning: Meaning,
        statements: Sequence[Statement],
        stored: Sequence[Any],
    ) -> None:
        self.b = builder
        self.form = {s.target: _form(s.expr) for s in statements}
        self.weight = {s.target: self._runs(s) for s in statements}
        self.sign = dict.fromkeys(self.form, 1)
        self.fixed = {s for s in self.form if meaning.of(s)}
        self.opposite = {s for s in self.form if meaning.is_opposite(s)}
        self.users: dict[Any, list[Any]] = {}
        for s in statements:
            for symbol in sorted(algebra.symbols(s.expr), key=attrgetter("name")):
                self.users.setdefault(symbol, []).append(s.target)
        self.uses = {
            s.target: sorted(algebra.symbols(s.expr), key=attrgetter("name")) for s in statements
        }
        self.stored: dict[Any, list[int]] = {}
        for value in stored:
            sign, symbol = algebra.signed(value)
            self.stored.setdefault(symbol, []).append(sign)

    def turn(self, group: Sequence[Any]) -> bool:
        """Turn values, and others with them; not if that takes more operations than before."""
        before = dict(self.sign)
        group = [symbol for symbol in group if self.sign[symbol] == 1]
        more = sum(map(self._turn, group))
        fixed = self.fixed | set(group)
        left = self._around(group, fixed)
        while left and more > 0:
            symbol = left.pop(0)
            change = self._turn(symbol)
            if change < 0 or (change == 0 and symbol in self.opposite and self.sign[symbol] == -1):
                more += change
                left += [s for s in self._around([symbol], fixed) if s not in left]
            else:
                self._turn(symbol)
        if more > 0:
            self.sign = before
        self.fixed |= {s for s in self.opposite if self.sign[s] == -1}
        return more <= 0

    def _turn(self, symbol: Any) -> int:
        """Turn one value; how many more changes of sign that takes."""
        targets = [symbol, *self.users.get(symbol, ())]
        before = sum(self.weight[t] * self._needed(t) for t in targets)
        stored = -self.sign[symbol] * sum(self.stored.get(symbol, ()))
        self.sign[symbol] *= -1
        return sum(self.weight[t] * self._needed(t) for t in targets) - before - stored

    def _needed(self, target: Any) -> int:
        return self._changes(self.form[target], self.sign[target])

    def _changes(self, form: tuple[_Term, ...], outer: int = 1) -> int:
        """Changes of sign besides additions and subtractions."""
        inner = sum(self._changes(part) for term in form for part in term.inner)
        return inner + all(not t.is_free and self._of(t) == -outer for t in form)

    def _of(self, term: _Term) -> int:
        sign = term.sign
        for symbol in term.odd:
            sign *= self.sign.get(symbol, 1)
        return sign

    def _around(self, symbols: Iterable[Any], fixed: set[Any]) -> list[Any]:
        """Values beside these in the same statements that may be turned."""
        found: dict[Any, None] = {}
        for symbol in symbols:
            for target in (symbol, *self.users.get(symbol, ())):
                found |= dict.fromkeys([target, *self.uses[target]])
        return [s for s in found if s in self.form and s not in fixed]

    def _runs(self, statement: Statement) -> int:
        """How much a statement counts."""
        if not statement.stage.depends_on_state:
            return 0
        leg_type = statement.total_of or statement.stage.leg_type
        return _LEGS if leg_type else 1
