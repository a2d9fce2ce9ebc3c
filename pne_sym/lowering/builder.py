"""Scalar statements with value numbering: equal expressions are computed once.

Every value is an *atom*: a symbol, a negated symbol or a number.  Zeros, ones
and signs therefore vanish as expressions are built, and what depends on
parameters alone is told apart by its stage.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.lowering import algebra
from pne_sym.lowering.algebra import operations, terms_of
from pne_sym.program.ir import Stage

Atom = Any  # sympy Symbol, -Symbol or Number


def of_leg(stem: str, stage: Stage) -> str:
    """The stem of a name, with the leg type where a leg has its own value.

    So that no number in a name counts values of other leg types.
    """
    of = stage.leg_type
    return stem if not of or f"_{of}_" in f"_{stem}_" else f"{of}_{stem}"


class Statement(NamedTuple):
    """target = expr, computed at a stage, for an equation.

    A sum over the legs of a type has `total_of` instead of being an expression
    over legs: target = sum of expr.
    """

    target: sp.Symbol
    expr: Any
    stage: Stage
    equation: str
    total_of: str | None = None
    is_named: bool = False
    hint: str = ""


@dataclass(frozen=True)
class Guard:
    """A condition on values: see `derivation.Condition`."""

    trouble: str
    value: Any
    scale: Any
    power: int
    stage: Stage
    equation: str

    def rewritten(self, changes: Mapping[Any, Any]) -> Guard:
        """With other expressions for its values; of a tested pivot the sign says nothing."""
        value, scale = (algebra.replaced(sp.sympify(e), changes) for e in (self.value, self.scale))
        if self.trouble == "singular":
            value = algebra.signed(value)[1]
        return replace(self, value=value, scale=scale)


@dataclass(frozen=True)
class Undone:
    """What a rollback has forgotten.

    Attributes:
        statements, guards: as they were.
        values: expressions and the atoms that had their values.
        issues: per statement its hint, the number issued before it, and the last one.
    """

    statements: list[Statement]
    values: list[tuple[Any, Atom]]
    guards: list[Guard]
    issues: list[tuple[str, int, int]]


class Builder:
    """Statements in the order of their making."""

    def __init__(self) -> None:
        self.statements: list[Statement] = []
        self.guards: list[Guard] = []
        self._value: dict[Any, Atom] = {}
        self._made: list[Any] = []
        self.of: dict[sp.Symbol, Statement] = {}
        self._stage: dict[sp.Symbol, Stage] = {}
        self._names: set[str] = set()
        self._issued: dict[str, int] = {}
        self._issues: list[tuple[str, int]] = []  # per statement: hint, number before it
        self.quantity_of: dict[str, str] = {}
        self.live: set[sp.Symbol] = set()
        self.equation = ""
        self.leg_counts: dict[str, int] = {}
        self.signs: set[sp.Symbol] = set()

    # ---- symbols ---------------------------------------------------------------------

    def declare(self, symbol: sp.Symbol, stage: Stage) -> sp.Symbol:
        """A symbol that is given from outside."""
        self._stage[symbol] = stage
        self._names.add(symbol.name)
        return symbol

    def given_names(self) -> list[str]:
        """Names of the symbols that are given from outside."""
        return [s.name for s in self._stage if s not in self.of]

    def is_declared(self, symbol: sp.Symbol) -> bool:
        """Whether a symbol is known."""
        return symbol in self._stage

    def stage_of(self, expr: Any) -> Stage:
        """Stage at which an expression can be computed."""
        if expr.is_Symbol:
            return self._stage[expr]
        stages = [self._stage[s] for s in algebra.symbols(expr)]
        if stages and all(stage is stages[0] for stage in stages):
            return stages[0]
        return algebra.joined(frozenset(stages))

    def _fresh(self, hint: str) -> str:
        """A name that no other symbol has: the hint, or the hint and a number."""
        k = self._issued.get(hint, 0) + 1
        while (name := hint if k == 1 else f"{hint}_{k}") in self._names:
            k += 1
        self._names.add(name)
        self._issues.append((hint, self._issued.get(hint, 0)))
        self._issued[hint] = k
        return name

    def _stem(self, hint: str, stage: Stage) -> str:
        """What a name begins with."""
        return of_leg(hint or f"{self.quantity_of.get(self.equation, 'v')}_t", stage)

    # ---- values ----------------------------------------------------------------------

    def let(self, expr: Any, hint: str = "", *, named: bool = False) -> Atom:
        """The atom of an expression; a new statement only when the value is new."""
        expr = sp.sympify(expr)
        if expr.is_Number or expr.is_Symbol:
            return expr
        if expr.is_Mul and len(expr.args) == 2:
            factor, other = expr.args
            if factor is sp.S.NegativeOne and other.is_Symbol:
                return expr
        sign, key = algebra.signed(expr)
        known = self._value.get(key)
        if known is not None:
            return known if sign == 1 else algebra.negative(known)
        if not hint:  # only what has a name keeps its sign: names do not lie
            made = self._record(key, self.stage_of(expr), hint, named)
            return made if sign == 1 else algebra.negative(made)
        symbol = self._record(expr, self.stage_of(expr), hint, named, key=key)
        self._value[key] = symbol if sign == 1 else algebra.negative(symbol)
        return symbol

    def _record(
        self,
        expr: Any,
        stage: Stage,
        hint: str,
        named: bool,
        total_of: str | None = None,
        key: Any = None,
    ) -> sp.Symbol:
        hint = self._stem(hint, stage)
        symbol = algebra.symbol(self._fresh(hint))
        self._stage[symbol] = stage
        statement = Statement(symbol, expr, stage, self.equation, total_of, named, hint)
        self.statements.append(statement)
        self.of[symbol] = statement
        key = expr if key is None else key
        self._value[key] = symbol
        self._made.append(key)
        return symbol

    def total(self, atom: Atom, leg_type: str, hint: str) -> Atom:
        """Sum of a value over the legs of a type."""
        if atom == 0:
            return sp.S.Zero
        if atom.could_extract_minus_sign():
            return -self.total(-atom, leg_type, hint)
        stage = self.stage_of(atom)
        if not stage.per_leg:
            return self.let(self.leg_counts[leg_type] * atom, hint)
        key = ("total", leg_type, atom)
        if key in self._value:
            return self._value[key]
        return self._record(atom, stage.after_sum(), hint, True, leg_type, key)

    def guard(self, trouble: str, value: Atom, scale: Atom, power: int) -> None:
        """Require a condition; constants and parameters need no guard at run time."""
        if value.is_Number or not self.stage_of(value).depends_on_state:
            return
        stage = Stage.join((self.stage_of(value), self.stage_of(sp.sympify(scale))))
        guard = Guard(trouble, value, sp.sympify(scale), power, stage, self.equation)
        if guard not in self.guards:
            self.guards.append(guard)

    # ---- arithmetic on atoms -----------------------------------------------------------

    def add(self, terms: Iterable[Atom], hint: str = "", *, named: bool = False) -> Atom:
        """Sum of atoms."""
        present = [t for t in terms if t is not sp.S.Zero]
        if len(present) < 2:
            return present[0] if present else sp.S.Zero
        key = ("sum", *present)
        if key not in self._value:
            self._remember(key, self.let(self._opened(algebra.total(*present)), hint, named=named))
        return self._value[key]

    def _remember(self, key: Any, value: Atom) -> Atom:
        """Keep a result under the operation that asked for it, until a rollback."""
        self._value[key] = value
        self._made.append(key)
        return value

    def _opened(self, total: Any) -> Any:
        """The sum with named sums in it opened, where terms then cancel."""
        if not total.is_Add or len(total.args) > 6:
            return total
        inner = []
        for term in total.args:
            sign, symbol = algebra.signed(term)
            made = self.of.get(symbol)
            is_sum = made is not None and made.expr.is_Add and not made.total_of
            expr = made.expr if made is not None and is_sum else None
            inner.append(algebra.negative(expr) if expr is not None and sign == -1 else expr)
        if all(expr is None for expr in inner):
            return total
        return algebra.opened(total, tuple(inner))

    def difference(self, a: Atom, b: Atom) -> Atom:
        """a - b; of two named sums only what does not cancel."""
        terms = [t for atom, sign in ((a, 1), (b, -1)) for t in self._terms(atom, sign)]
        total = algebra.total(*terms)
        return self.let(total if terms_of(total) <= 2 else a - b)

    def mul(self, a: Atom, b: Atom, hint: str = "", *, named: bool = False) -> Atom:
        """Product of atoms; x/b times b is x."""
        if a is sp.S.Zero or b is sp.S.Zero:
            return sp.S.Zero
        if a is sp.S.One or b is sp.S.One:
            return b if a is sp.S.One else a
        key = ("product", a, b)
        if key in self._value:
            return self._value[key]
        return self._remember(key, self._product(a, b, hint, named=named))

    def _product(self, a: Atom, b: Atom, hint: str, *, named: bool) -> Atom:
        if a.is_Number or b.is_Number:
            return self.let(algebra.product(a, b), hint, named=named)
        sign = 1
        if a.is_Mul:
            a, sign = algebra.negative(a), -sign
        if b.is_Mul:
            b, sign = algebra.negative(b), -sign
        cancelled = self._square_of_root(a) if a == b else None
        if cancelled is None:
            cancelled = self._cancel(a, b)
        if cancelled is None:
            cancelled = self._cancel(b, a)
        if cancelled is None:
            cancelled = self.let(algebra.product(a, b), hint, named=named)
        return cancelled if sign == 1 else algebra.negative(cancelled)

    def _square_of_root(self, a: Atom) -> Atom | None:
        """x for a = sign sqrt(x)."""
        made = self.of.get(a)
        if made is None or made.total_of:
            return None
        factors = made.expr.args if made.expr.is_Mul else (made.expr,)
        radicands = []
        for factor in factors:
            if factor in self.signs:
                continue
            source = self.of[factor].expr if factor in self.of else factor
            if not (source.is_Pow and source.exp == sp.Rational(1, 2)):
                return None
            radicands.append(source.base)
        return radicands[0] if len(radicands) == 1 else None

    def _cancel(self, a: sp.Symbol, b: sp.Symbol) -> Atom | None:
        """a b where a is made of 1/b, or b is 1/x and a is made of x; None if neither."""
        made = self.of.get(a)
        if made is None or made.total_of:
            return None
        inverse = self._value.get(algebra.inverse(b))
        base = self._base_of_inverse(b)
        factors = made.expr.args if made.expr.is_Mul else (made.expr,)
        for wanted in (inverse, base):
            if wanted is not None and wanted in factors:
                return self.let(algebra.quotient(made.expr, wanted))
        if made.expr == algebra.inverse(b):
            return sp.S.One
        return None

    def _base_of_inverse(self, b: sp.Symbol) -> Atom | None:
        made = self.of.get(b)
        if made is not None and made.expr.is_Pow and made.expr.exp == -1:
            return made.expr.base
        return None

    def inverse(self, a: Atom) -> Atom:
        """1 / atom."""
        if a.is_Number:
            return 1 / a
        if a.is_Mul:
            return -self.inverse(-a)
        made = self.of.get(a)
        if made is not None and made.expr.is_Pow and made.expr.exp == -1:
            return made.expr.base
        return self.let(algebra.inverse(a), f"inv_{a.name}")

    def divide(self, a: Atom, b: Atom, hint: str = "", *, named: bool = False) -> Atom:
        """a / b; where terms of a hold the factor b it cancels term by term."""
        if a == 0 or b == 1:
            return a
        if b == -1:
            return -a
        if b.is_Mul:
            return -self.divide(a, -b, hint, named=named)
        inverse = self.inverse(b)
        terms = [inner for term in self._terms(a) for inner in self._terms(term)]
        quotients = [self._quotient(term, b) for term in terms]
        if len(terms) > 1 and any(q is not None for q in quotients):
            rest = self.add([t for t, q in zip(terms, quotients, strict=True) if q is None])
            cancelled = [q for q in quotients if q is not None]
            return self.add([self.mul(rest, inverse), *cancelled], hint, named=named)
        return self.mul(a, inverse, hint, named=named)

    def _terms(self, a: Atom, outer: int = 1) -> list[Atom]:
        """Terms of a named sum, with a sign; the atom itself where it is none."""
        if a.is_Number:
            return [outer * a]
        sign, symbol = algebra.signed(a)
        made = self.of.get(symbol)
        if made is None or made.total_of or not made.expr.is_Add:
            return [outer * a]
        return [outer * sign * term for term in made.expr.args]

    def _quotient(self, term: Any, b: sp.Symbol) -> Atom | None:
        """term / b if the factor b is visible in the term."""
        sign = 1
        if term.could_extract_minus_sign():
            term, sign = -term, -1
        made = self.of.get(term) if term.is_Symbol else None
        product = made.expr if made is not None and not made.total_of else term
        if product.is_Mul and b in product.args:
            return sign * self.let(algebra.quotient(product, b))
        return None

    # ---- trials ----------------------------------------------------------------------

    def mark(self) -> tuple[int, int, int]:
        """A point to return to."""
        return len(self.statements), len(self._made), len(self.guards)

    def rollback(self, mark: tuple[int, int, int]) -> Undone:
        """Forget all that was made since the mark; what was forgotten, for `redo`."""
        statements, made, guards = mark
        forgotten = Undone(
            self.statements[statements:],
            [(key, self._value[key]) for key in self._made[made:]],
            self.guards[guards:],
            [(hint, before, self._issued[hint]) for hint, before in self._issues[statements:]],
        )
        for statement in forgotten.statements:
            del self.of[statement.target], self._stage[statement.target]
            self._names.discard(statement.target.name)
        for hint, before, _ in reversed(forgotten.issues):
            self._issued[hint] = before
        for key, _ in forgotten.values:
            del self._value[key]
        del self._issues[statements:]
        del self.statements[statements:]
        del self._made[made:]
        del self.guards[guards:]
        return forgotten

    def redo(self, forgotten: Undone) -> None:
        """Make again what a rollback to the present point has forgotten."""
        for statement in forgotten.statements:
            self.of[statement.target] = statement
            self._stage[statement.target] = statement.stage
            self._names.add(statement.target.name)
        self.statements += forgotten.statements
        for key, value in forgotten.values:
            self._value[key] = value
            self._made.append(key)
        self.guards += forgotten.guards
        for hint, before, after in forgotten.issues:
            self._issues.append((hint, before))
            self._issued[hint] = after

    def rewrite(self, expressions: Mapping[Any, Any], changes: Mapping[Any, Any]) -> None:
        """Other expressions for the same values, or for their negatives.

        Args:
            expressions: of every statement's target.
            changes: what stands for the values in guards; of tested pivots the sign says nothing.
        """
        self.statements = [s._replace(expr=expressions[s.target]) for s in self.statements]
        self.of = {s.target: s for s in self.statements}
        self.guards = [guard.rewritten(changes) for guard in self.guards]

    def cost(self, atoms: Iterable[Atom]) -> int:
        """Run-time operations needed for the atoms beyond what is live already."""
        return sum(map(self.weight, self._reach(atoms)))

    def weight(self, statement: Statement) -> int:
        """Operations of a statement, over all legs; none at parameter stages."""
        if not statement.stage.depends_on_state:
            return 0
        times = self.leg_counts[statement.stage.leg_type] if statement.stage.per_leg else 1
        if statement.total_of:
            return self.leg_counts[statement.total_of]
        return times * operations(statement.expr)

    def keep(self, atoms: Iterable[Atom]) -> None:
        """Mark the atoms and all they need as live."""
        for statement in self._reach(atoms):
            self.live.add(statement.target)

    def _reach(self, atoms: Iterable[Atom]) -> list[Statement]:
        found: dict[sp.Symbol, Statement] = {}
        stack = [s for atom in atoms for s in algebra.symbols(sp.sympify(atom))]
        while stack:
            symbol = stack.pop()
            if symbol in found or symbol in self.live:
                continue
            made = self.of.get(symbol)
            if made is not None:
                found[symbol] = made
                stack.extend(algebra.symbols(made.expr))
        return list(found.values())
