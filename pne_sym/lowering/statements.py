"""What was made: statements in their order, where their values are known, what they need.

All of it since a mark can be forgotten, and what was forgotten made again.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple, TypeVar

import sympy as sp

from pne_sym.lowering import algebra
from pne_sym.lowering.algebra import operations
from pne_sym.program.ir import Check, Stage, Store

Atom = Any  # sympy Symbol, -Symbol or Number


@lru_cache(1 << 16)
def of_leg(stem: str, leg_type: str) -> str:
    """The stem of a name, with the leg type where a leg has its own value.

    So that no number in a name counts values of other leg types.
    """
    return stem if not leg_type or f"_{leg_type}_" in f"_{stem}_" else f"{leg_type}_{stem}"


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

    @property
    def read(self) -> tuple[Any, ...]:
        """Expressions in it."""
        return (self.expr,)


End = Check | Store
"""What becomes of values."""
_End = TypeVar("_End", bound=End)


def rewritten(end: _End, changes: Mapping[Any, Any]) -> _End:
    """With other expressions for its values; of a tested pivot the sign says nothing."""
    value = algebra.replaced(end.value, changes)
    if not isinstance(end, Check):
        return replace(end, value=value)
    value = algebra.signed(value)[1] if end.status == "singular" else value
    return replace(end, value=value, scale=algebra.replaced(end.scale, changes))


def read_by(items: Iterable[Statement | End]) -> set[Any]:
    """Symbols in statements, guards and entries."""
    return set().union(*(algebra.symbols(e) for item in items for e in item.read))


class _Known:
    """What is known of a symbol; each has one, which stays while the symbol is forgotten.

    Attributes:
        symbol: whose it is.
        stage: at which it is there; None while it is forgotten.
        made: the statement that makes it; None of what is given from outside.
        needs: the made values in its statement.
        weight: operations of its statement; None until they are asked for.
    """

    __slots__ = ("made", "needs", "stage", "symbol", "weight")

    def __init__(self, symbol: Any) -> None:
        self.symbol = symbol
        self.stage: Stage | None = None
        self.made: Statement | None = None
        self.needs: tuple[_Known, ...] = ()
        self.weight: int | None = None


class _Value:
    """The value of what can be asked for; each has one, which stays while the value is forgotten.

    So nothing is looked up again to forget it or to make it anew.

    Attributes:
        atom: None while it is not known.
        parts: what is known of the symbols of an expression; None until it is asked for.
        signed: of an expression its sign, what it is without, and the value of that; likewise.
        total: what SymPy makes of a sum of atoms; likewise.
    """

    __slots__ = ("atom", "parts", "signed", "total")

    def __init__(self) -> None:
        self.atom: Atom | None = None
        self.parts: tuple[_Known, ...] | None = None
        self.signed: tuple[int, Any, _Value] | None = None
        self.total: Any = None


class Undone(NamedTuple):
    """What a rollback has forgotten.

    Attributes:
        statements: as they were, with what was known of their targets.
        guards: as they were.
        values: with the atoms that they were.
        issues: per statement its hint, the number issued before it, and the last one.
    """

    statements: list[tuple[_Known, Statement, tuple[_Known, ...], int | None]]
    values: list[tuple[_Value, Atom]]
    guards: list[Check]
    issues: list[tuple[str, int, int]]


class Statements:
    """Statements in the order of their making, each value under the expression that it has."""

    def __init__(self) -> None:
        self.guards: list[Check] = []
        self.equation = ""
        self.quantity_of: dict[str, str] = {}
        self.leg_counts: dict[str, int] = {}
        self._values: dict[Any, _Value] = {}  # by what is asked for
        self._found: list[_Value] = []  # those that are known, in order
        self._known: dict[sp.Symbol, _Known] = {}
        self._called: dict[str, _Known] = {}  # of what was made, by its name
        self._order: list[_Known] = []  # of the statements
        self._names: set[str] = set()
        self._issued: dict[str, int] = {}
        self._issues: list[tuple[str, int]] = []  # per statement: hint, number before it
        self._live: set[_Known] = set()

    @property
    def statements(self) -> list[Statement]:
        """All of them in their order."""
        return [known.made for known in self._order if known.made]

    # ---- symbols ---------------------------------------------------------------------

    def declare(self, symbol: sp.Symbol, stage: Stage) -> sp.Symbol:
        """A symbol that is given from outside."""
        self._of(symbol).stage = algebra.joined(frozenset((stage,)))  # equal ones are one
        self._names.add(symbol.name)
        return symbol

    def given_names(self) -> list[str]:
        """Names of the symbols that are given from outside."""
        return [s.name for s, known in self._known.items() if known.stage and not known.made]

    def is_declared(self, symbol: sp.Symbol) -> bool:
        """Whether a symbol is known."""
        known = self._known.get(symbol)
        return known is not None and known.stage is not None

    def maker(self, symbol: Any) -> Statement | None:
        """The statement that makes a value; None if it is given from outside, or no symbol."""
        known = self._known.get(symbol)
        return None if known is None else known.made

    def stage_of(self, expr: Any) -> Stage:
        """Stage at which an expression can be computed."""
        return _joined(self._parts(expr))

    def _of(self, symbol: sp.Symbol) -> _Known:
        known = self._known.get(symbol)
        if known is None:
            known = self._known[symbol] = _Known(symbol)
        return known

    def _parts(self, expr: Any) -> tuple[_Known, ...]:
        """What is known of the symbols in an expression; trials ask for the same ones again."""
        value = self._value_of(expr)
        if value.parts is None:
            value.parts = tuple([self._known[symbol] for symbol in algebra.symbols(expr)])
        return value.parts

    # ---- values ----------------------------------------------------------------------

    def _record(
        self, expr: Any, hint: str, *, named: bool = False, total_of: str | None = None
    ) -> Any:
        """The symbol of a new statement."""
        parts = self._parts(expr)
        stage = _joined(parts).after_sum() if total_of else _joined(parts)
        hint = self._stem(hint, stage)
        name = self._fresh(hint)
        known = self._called.get(name)
        if known is None:
            known = self._called[name] = self._of(algebra.symbol(name))
        made = Statement(known.symbol, expr, stage, self.equation, total_of, named, hint)
        self._place(known, made, tuple([part for part in parts if part.made]))
        return known.symbol

    def _stem(self, hint: str, stage: Stage) -> str:
        """What a name begins with."""
        hint = hint or f"{self.quantity_of.get(self.equation, 'v')}_t"
        return of_leg(hint, stage.leg_type)

    def _fresh(self, hint: str) -> str:
        """A name that no other symbol has: the hint, or the hint and a number."""
        before = self._issued.get(hint, 0)
        k = before + 1
        while (name := hint if k == 1 else f"{hint}_{k}") in self._names:
            k += 1
        self._names.add(name)
        self._issues.append((hint, before))
        self._issued[hint] = k
        return name

    def _place(
        self,
        known: _Known,
        made: Statement,
        needs: tuple[_Known, ...],
        weight: int | None = None,
    ) -> None:
        """Put a statement behind the others."""
        known.stage, known.made, known.needs, known.weight = made.stage, made, needs, weight
        self._order.append(known)

    def _value_of(self, asked: Any) -> _Value:
        """The place for the value of what is asked for."""
        value = self._values.get(asked)
        if value is None:
            value = self._values[asked] = _Value()
        return value

    def _remember(self, value: _Value, atom: Atom) -> Atom:
        """Keep a value until a rollback."""
        value.atom = atom
        self._found.append(value)
        return atom

    def guard(self, status: str, value: Atom, scale: Atom, power: int) -> None:
        """Require a condition; constants and parameters need no guard at run time."""
        if value.is_Number or not self.stage_of(value).depends_on_state:
            return
        stage = Stage.join((self.stage_of(value), self.stage_of(sp.sympify(scale))))
        guard = Check(status, value, sp.sympify(scale), power, self.equation, stage)
        if guard not in self.guards:
            self.guards.append(guard)

    # ---- trials ----------------------------------------------------------------------

    def mark(self) -> tuple[int, int, int]:
        """A point to return to."""
        return len(self._order), len(self._found), len(self.guards)

    def rollback(self, mark: tuple[int, int, int]) -> Undone:
        """Forget all that was made since the mark; what was forgotten, for `redo`."""
        statements, values, guards = mark
        forgotten = Undone(
            [(k, k.made, k.needs, k.weight) for k in self._order[statements:] if k.made],
            [(value, value.atom) for value in self._found[values:]],
            self.guards[guards:],
            [(hint, before, self._issued[hint]) for hint, before in self._issues[statements:]],
        )
        for known, made, _, _ in forgotten.statements:
            known.stage, known.made, known.needs = None, None, ()
            self._names.discard(made.target.name)
        for value, _ in forgotten.values:
            value.atom = None
        for hint, before, _ in reversed(forgotten.issues):
            self._issued[hint] = before
        del self._issues[statements:]
        del self._order[statements:]
        del self._found[values:]
        del self.guards[guards:]
        return forgotten

    def redo(self, forgotten: Undone) -> None:
        """Make again what a rollback to the present point has forgotten."""
        for known, made, needs, weight in forgotten.statements:
            self._place(known, made, needs, weight)
            self._names.add(made.target.name)
        for value, atom in forgotten.values:
            self._remember(value, atom)
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
        for s in self.statements:
            made = s._replace(expr=expressions[s.target])
            known = self._known[s.target]
            known.made, known.weight = made, None
            known.needs = tuple(part for part in self._parts(made.expr) if part.made)
        self.guards = [rewritten(guard, changes) for guard in self.guards]

    # ---- what is needed --------------------------------------------------------------

    def cost(self, atoms: Iterable[Atom]) -> int:
        """Run-time operations needed for the atoms beyond what is live already."""
        return self._cost(self._reach(atoms))

    def cost_of_all(self, atoms: Iterable[Atom]) -> int:
        """Run-time operations needed for the atoms, whatever is live."""
        return self._cost(self._reach(atoms, frozenset()))

    def _cost(self, reached: Iterable[_Known]) -> int:
        found = 0
        for known in reached:
            if known.weight is None and known.made:
                known.weight = self._operations(known.made)
            found += known.weight or 0
        return found

    def _operations(self, statement: Statement) -> int:
        """Operations of a statement, over all legs; none at parameter stages."""
        if not statement.stage.depends_on_state:
            return 0
        times = self.leg_counts[statement.stage.leg_type] if statement.stage.per_leg else 1
        if statement.total_of:
            return self.leg_counts[statement.total_of]
        return times * operations(statement.expr)

    def keep(self, atoms: Iterable[Atom]) -> None:
        """Mark the atoms and all they need as live."""
        self._live |= self._reach(atoms)

    def keep_nothing(self) -> None:
        """Nothing is live any more."""
        self._live = set()

    def needed(self, atoms: Iterable[Atom]) -> list[Statement]:
        """The statements that make atoms, and all that these need, in their order."""
        found = self._reach(atoms, frozenset())
        return [known.made for known in self._order if known in found and known.made]

    def _reach(self, atoms: Iterable[Atom], live: Set[_Known] | None = None) -> set[_Known]:
        live = self._live if live is None else live
        found: set[_Known] = set()
        stack = [known for atom in atoms for known in self._parts(sp.sympify(atom))]
        while stack:
            known = stack.pop()
            if known.made and known not in found and known not in live:
                found.add(known)
                stack += known.needs
        return found


def _joined(parts: Sequence[_Known]) -> Stage:
    """The stage of what is made of these."""
    stages = {id(part.stage): part.stage for part in parts if part.stage}
    if len(stages) == 1:
        return next(iter(stages.values()))
    return algebra.joined(frozenset(stages.values()))
