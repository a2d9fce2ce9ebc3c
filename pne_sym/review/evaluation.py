"""Numbers for every quantity of a derivation and its arrays, straight from its equations.

All vectors and tensors have components in base axes. Only the derivation is
used, not the lowering: what is compared is what the report says.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from pne_sym.derivation import Derivation, Equation, Frame, Given, Output, names_in
from pne_sym.lowering.inputs import leg_inputs, unpack
from pne_sym.vector import (
    Dot,
    LegSum,
    TensorLegSum,
    TensorSymbol,
    VectorLegSum,
    VectorSymbol,
)
from pne_sym.vector.evaluate import evaluate

SUMS = (LegSum, VectorLegSum, TensorLegSum)
Borrow = Callable[[str, int | None], Any]


@dataclass(frozen=True)
class Situation:
    """Numbers to evaluate a model at: parameters by name, and one X, V, A, q, base."""

    parameters: Mapping[str, Any]
    vectors: Mapping[str, Any]


class Structure:
    """Who is who in a derivation: definitions, given quantities, values per leg."""

    def __init__(self, derivation: Derivation) -> None:
        self.derivation = derivation
        self.equations: dict[str, Equation] = {e.name: e for e in derivation.equations()}
        self.givens: dict[str, Given] = {str(g.symbol.name): g for g in derivation.givens}
        self.frames: dict[str, Frame] = {f.name: f for f in derivation.frames}
        self.legs = {t.name: t.indices for t in derivation.leg_types}
        self.type_of_leg = {leg: t.name for t in derivation.leg_types for leg in t.indices}
        self.leg_type = self._leg_types()
        self.made_of = cache(self._made_of)

    def _leg_types(self) -> dict[str, str]:
        """Name -> leg type, for quantities of which every leg of the type has its own."""
        table = self.derivation.parameters
        found = {n: f.leg_type for n, (f, _) in table.entries.items() if f.leg_type}
        found |= {n: leg_type for n, (leg_type, _) in table.branches.items()}
        for name in self.givens:
            if owner := self.derivation.notation[name].leg_type:
                found[name] = owner
        for chapter in self.derivation.chapters:
            for equation in chapter.equations:
                used = names_outside_sums(equation.rhs)
                owners = [found[n] for n in sorted(used) if n in found]
                if chapter.leg_type or owners:
                    found[equation.name] = chapter.leg_type or owners[0]
        return found

    def _made_of(self, expr: Any) -> tuple[list[Given] | None, list[str]]:
        """The given vectors that an expression is made of, and the vectors on the way.

        None where it is not made of such alone.
        """
        found: dict[str, Given] = {}
        names: list[str] = []
        stack = sorted(names_in(expr))
        while stack:
            name = stack.pop(0)
            given, equation = self.givens.get(name), self.equations.get(name)
            if given is not None and len(given.components) > 1:
                found[name] = given
            elif equation is None or not _is_vector_without_sums(equation):
                return None, []
            elif name not in names:
                names.append(name)
                stack += sorted(names_in(equation.rhs))
        return list(found.values()) or None, names

    def ancestors(self, frame: str | None) -> list[str]:
        """A frame, and those that it stands in, from the inside."""
        chain = []
        while frame is not None:
            chain.append(frame)
            frame = self.frames[frame].parent
        return chain

    def legs_of(self, name: str) -> tuple[int | None, ...]:
        """The legs that have a value of this name; (None,) where there is one in all."""
        return self.legs[self.leg_type[name]] if name in self.leg_type else (None,)


def turned(rotation: Any, value: Any) -> Any:
    """A vector or tensor in other axes."""
    return rotation @ value if value.ndim == 1 else rotation @ value @ rotation.T


def names_outside_sums(expr: Any) -> set[str]:
    """Names in an expression that do not stand within a sum over legs."""
    if isinstance(expr, SUMS):
        return set()
    if hasattr(expr, "name") or not getattr(expr, "args", ()):
        return set(names_in(expr))
    return {name for arg in expr.args for name in names_outside_sums(arg)}


def _is_vector_without_sums(equation: Equation) -> bool:
    is_vector = isinstance(equation.lhs, VectorSymbol)
    return is_vector and names_in(equation.rhs) == names_outside_sums(equation.rhs)


class State:
    """A derivation's quantities at one set of parameters and one state.

    Args:
        structure: of the derivation.
        at: the parameters and the state.
        borrow: values to use instead of the derivation's own, or None where there is none.
    """

    def __init__(self, structure: Structure, at: Situation, borrow: Borrow | None = None) -> None:
        self.structure, self.at, self.borrow = structure, at, borrow
        self._values: dict[tuple[str, int | None], Any] = {}
        self._parts: dict[str, Any] = {}
        self.rotation = cache(self._rotation)
        self._inputs = _inputs(structure.derivation, at.vectors)

    def value(self, name: str, leg: int | None) -> Any:
        """Value of a name; of its leg where every leg has its own."""
        if name in self._parts:
            return self._parts[name]
        known = name in self.structure.leg_type or name in self.structure.equations
        key = (name, leg if name in self.structure.leg_type or not known else None)
        if key not in self._values:
            lent = self.borrow(*key) if self.borrow else None
            self._values[key] = self.own(*key) if lent is None else lent
        return self._values[key]

    def own(self, name: str, leg: int | None) -> Any:
        """Value of a name by the derivation's own definition."""
        structure = self.structure
        if name in structure.equations:
            return self.of(structure.equations[name].rhs, leg)
        given = structure.givens.get(name)
        if given is None or given.components == (given.symbol,):
            return self._scalar(name, leg)
        raw = self._components(given, leg)
        return self._raised(raw, given.frame, "base", leg) if raw.ndim else float(raw)

    def of(self, expr: Any, leg: int | None) -> Any:
        """Value of an expression; sums run over the legs."""
        expr = self._reduced(expr, leg)
        return evaluate(expr, _Lookup(lambda name: self.value(name, leg)))

    def _rotation(self, name: str, leg: int | None) -> Any:
        """base_R_frame."""
        frame = self.structure.frames[name]
        if frame.parent is None:
            return np.eye(3)
        if frame.axes is not None:
            return np.column_stack([self.of(axis, leg) for axis in frame.axes])
        return self.rotation(frame.parent, leg) @ self._step(frame, leg)

    def _step(self, frame: Frame, leg: int | None) -> Any:
        """parent_R_frame of a frame that is not given by its axes."""
        if frame.angle is not None:
            c, s = (self.of(v, leg) for v in frame.angle)
            return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        if frame.rows is not None:
            return np.array([self._in_frame(row, frame.name, leg) for row in frame.rows])
        assert frame.rotation is not None
        entries = [self.of(sp.sympify(entry), leg) for entry in frame.rotation]
        return np.array(entries, dtype=float).reshape(3, 3)

    def _raised(self, value: Any, name: str, to: str, leg: int | None) -> Any:
        """Components of a vector or tensor in an ancestor of its frame.

        A vector along a joint's axis is known before the joint's angle.
        """
        while name != to:
            frame = self.structure.frames[name]
            assert frame.parent is not None
            if frame.axes is not None:
                value = turned(self._axes(frame, leg), value)
            elif value.ndim == 2 or frame.angle is None or value[:2].any():
                value = turned(self._step(frame, leg), value)
            name = frame.parent
        return value

    def _axes(self, frame: Frame, leg: int | None) -> Any:
        """parent_R_frame of a frame that is given by its axes."""
        assert frame.axes is not None
        assert frame.parent is not None
        made_of = [self._fixed(axis, leg) for axis in frame.axes]
        if all(
            g and all(frame.parent in self.structure.ancestors(x.frame) for x in g) for g in made_of
        ):
            columns = [
                self._product(g or [], axis, frame.parent, leg)
                for g, axis in zip(made_of, frame.axes, strict=True)
            ]
            return np.column_stack(columns)
        return self.rotation(frame.parent, leg).T @ self.rotation(frame.name, leg)

    def _in_frame(self, expr: Any, frame: str, leg: int | None) -> Any:
        """Value of a vector that is known in a frame, components in that frame."""

        def look(name: str) -> Any:
            given = self.structure.givens.get(name)
            if given is not None and given.frame == frame:
                return self._components(given, leg)
            if name in self.structure.equations:
                return self._in_frame(self.structure.equations[name].rhs, frame, leg)
            return self.value(name, leg)

        return evaluate(expr, _Lookup(look))

    def _components(self, given: Given, leg: int | None) -> Any:
        values = [self.of(sp.sympify(c), leg) for c in given.components]
        shape: tuple[int, ...] = {1: (), 3: (3,), 9: (3, 3)}[len(values)]
        return np.array(values, dtype=float).reshape(shape)

    def _scalar(self, name: str, leg: int | None) -> float:
        """An entry of a parameter, a branch's sign, or an entry of X, V, A."""
        derivation = self.structure.derivation
        table = derivation.parameters
        if name in table.entries:
            field, index = table.entries[name]
            value = np.asarray(self.at.parameters[field.name], dtype=float)
            if field.leg_type:
                value = value[self.structure.legs[field.leg_type].index(leg)]
            return float(value.reshape(-1)[index])
        if name in table.branches:
            leg_type, signs = table.branches[name]
            return float(signs[self.structure.legs[leg_type].index(leg)])
        if name in self._inputs:
            return self._inputs[name]
        if leg is None:
            raise KeyError(name)
        leg_type = self.structure.type_of_leg[leg]
        vector, indices = leg_inputs(derivation, name)
        return float(self.at.vectors[vector][indices[self.structure.legs[leg_type].index(leg)]])

    def _reduced(self, expr: Any, leg: int | None) -> Any:
        """The expression with sums over legs, and products of given vectors, as symbols.

        A product of vectors given in links, and of what is made of such, is formed in their
        common frame: it may be needed to find the angle by which they are turned.
        """
        if isinstance(expr, SUMS):
            value, leg_type = expr.args
            legs = self.structure.legs[str(leg_type)]
            return self._named(expr, sum(self.of(value, each) for each in legs))
        args = getattr(expr, "args", ())
        if hasattr(expr, "name") or not args:
            return expr
        if isinstance(expr, Dot):
            givens = self._fixed(expr, leg)
            if givens is not None:
                return self._named(expr, self._product(givens, expr, self._common(givens), leg))
        reduced = tuple(self._reduced(arg, leg) for arg in args)
        return expr if reduced == args else expr.func(*reduced)

    def _fixed(self, expr: Any, leg: int | None) -> list[Given] | None:
        """The given vectors that an expression is made of; None where it is not of these alone."""
        givens, names = self.structure.made_of(expr)
        lent = self.borrow is not None and any(self.borrow(n, leg) is not None for n in names)
        return None if lent else givens

    def _common(self, givens: list[Given]) -> str:
        """The frame that given vectors have in common."""
        chains = [self.structure.ancestors(given.frame) for given in givens]
        return next(f for f in chains[0] if all(f in chain for chain in chains))

    def _product(self, givens: list[Given], expr: Any, frame: str, leg: int | None) -> Any:
        """A product of such vectors, components in a frame above all of theirs."""
        values = {
            str(g.symbol.name): self._raised(self._components(g, leg), g.frame, frame, leg)
            for g in givens
        }

        def look(name: str) -> Any:
            if name not in values:
                values[name] = evaluate(self.structure.equations[name].rhs, _Lookup(look))
            return values[name]

        return evaluate(expr, _Lookup(look))

    def _named(self, expr: Any, value: Any) -> Any:
        """A symbol with a value of its own."""
        name = f"part {len(self._parts)}"
        self._parts[name] = value
        return _symbol_like(expr, name)


def by_array(derivation: Derivation) -> dict[str, list[Output]]:
    """The outputs that make up each array."""
    found: dict[str, list[Output]] = {}
    for output in derivation.outputs:
        found.setdefault(output.array, []).append(output)
    return found


def assembled(state: State, outputs: list[Output]) -> dict[tuple[int, int], float]:
    """Entries of an array by row and column."""
    entries: dict[tuple[int, int], float] = {}
    for o in outputs:
        along_row = o.rows == ((0, 0),) and o.columns not in ((), ((0, 0),))
        legs = state.structure.legs[o.leg_type] if o.leg_type else (None,)
        for k, leg in enumerate(legs):
            value = np.asarray(state.of(o.value, leg), dtype=float)
            if o.frame != "base" and value.ndim:
                value = turned(state.rotation(o.frame, leg).T, value)
            r0 = o.leg_rows[k] if o.leg_rows else 0
            c0 = o.leg_columns[k] if o.leg_columns else 0
            for i, row in o.rows:
                for j, column in o.columns or ((0, 0),):
                    place = (row + r0, column + c0)
                    entries[place] = _entry(value, i, j, along_row=along_row)
                    if o.mirrored:
                        entries[place[::-1]] = entries[place]
    return entries


def _entry(value: Any, i: int, j: int, *, along_row: bool) -> float:
    if value.ndim == 0:
        return float(value)
    return float(value[i, j] if value.ndim == 2 else value[j if along_row else i])


class _Lookup(dict[str, Any]):
    """Values that are found when they are asked for."""

    def __init__(self, find: Callable[[str], Any]) -> None:
        super().__init__()
        self._find = find

    def __missing__(self, name: str) -> Any:
        return self._find(name)


def _symbol_like(expr: Any, name: str) -> Any:
    if isinstance(expr, VectorLegSum):
        return VectorSymbol(name)
    return TensorSymbol(name) if isinstance(expr, TensorLegSum) else sp.Symbol(name, real=True)


def _inputs(derivation: Derivation, vectors: Mapping[str, Any]) -> dict[str, float]:
    """Scalars that the derivation names in X, V and A."""
    values = {f"{v}_{k}": float(e) for v, entries in vectors.items() for k, e in enumerate(entries)}
    for assignments, _ in unpack(derivation).values():
        for a in assignments:
            values[str(a.target)] = float(evaluate(sp.sympify(a.expr), values))
    return values
