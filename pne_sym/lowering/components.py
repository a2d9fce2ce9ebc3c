"""Vectors to components: each named quantity in the frame where it costs least.

A named vector has a home frame (that of the body it belongs to).  In another
frame it is either rotated there or formed anew from its equation, whichever
needs fewer operations beyond what is already there; likewise, of several forms
of an equation the cheapest is taken.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence, Set
from functools import partial
from typing import Any

import sympy as sp

from pne_sym.derivation import Derivation, Equation, ReciprocalBasis, leg_sums, names_in
from pne_sym.lowering.bases import Bases
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.frames import Frames, Triple
from pne_sym.lowering.rotation import XYZ, Rotation, Tensor9, cross, symmetrised
from pne_sym.lowering.statements import Atom
from pne_sym.lowering.trials import NotYetError, Trials, atoms
from pne_sym.program.ir import Component
from pne_sym.vector import nodes as n


class Lowering:
    """Components of the quantities of one derivation.

    Vectors pass from frame to frame joint by joint, or, after `form_tip_axes`, through
    the axes of each leg's last link in base axes.  Which is cheaper depends on how many
    vectors pass, so callers try both.
    """

    def __init__(self, derivation: Derivation, builder: Builder) -> None:
        self.d = derivation
        self.b = builder
        self.definition: dict[str, Equation] = {e.name: e for e in derivation.equations()}
        self._place = {name: k for k, name in enumerate(self.definition)}
        self.given = {g.symbol: g for g in derivation.givens}
        self.trials = Trials(builder)
        self.home: dict[str, str] = {}
        self._vectors: dict[tuple[str, str], Triple] = {}
        self._tensors: dict[tuple[str, str], Tensor9] = {}
        self._scalars: dict[str, Atom] = {}
        self._totals: dict[Component, Atom] = {}  # sums over legs, by what they are
        self._in_progress: set[str] = set()
        frames = Frames(derivation, builder, self.vector, self.scalar, self.trials.store)
        self.rotation = Rotation(builder, frames, self.trials, self._vectors, self.definition)
        self.bases = Bases(derivation, builder, self.trials, self.vector, self.scalar, self.ensure)

    # ---- what was made -----------------------------------------------------------------

    def components(self) -> Iterator[tuple[Component, Atom]]:
        """All components that were made, of quantities, sums over legs and axes of frames."""
        for name, atom in self._scalars.items():
            yield Component(name), atom
        for (name, frame), v in self._vectors.items():
            yield from ((Component(name, frame, (i,)), v[i]) for i in range(3))
        for (name, frame), t in self._tensors.items():
            places = ((i, j) for i in range(3) for j in range(3))
            yield from ((Component(name, frame, (i, j)), t[i][j]) for i, j in places)
        yield from self._totals.items()
        yield from self.rotation.components()

    def made(self) -> dict[str, tuple[str, tuple[Atom, ...]]]:
        """Frame and components of every quantity, where it was made first."""
        found = {name: ("", (atom,)) for name, atom in self._scalars.items()}
        for name, frame in self.home.items():
            value = self._vectors.get((name, frame)) or self._tensors.get((name, frame))
            if value is not None:
                found[name] = (frame, tuple(atoms(value)))
        return found

    def _note_total(self, expr: Any, frame: str, value: Any) -> None:
        """Note what the sum of an equation over the legs of a type is, where it is the only one."""
        name, leg_type = self.b.quantity_of.get(self.b.equation, ""), expr.args[1]
        same = [
            s for s in leg_sums(self.definition[name].rhs if name else 0) if s.args[1] == leg_type
        ]
        if same != [expr]:
            return
        for k, atom in enumerate(atoms(value)):
            index = {"": (), 3: (k,), 9: (k // 3, k % 3)}[frame and len(atoms(value))]
            of = Component(name, frame, index, over=leg_type.name)
            self.trials.store(self._totals, of, atom)

    # ---- named quantities --------------------------------------------------------------

    def form_tip_axes(self) -> None:
        """Form the axes of each leg's last link in base axes before anything else."""
        for basis in self.d.bases:
            frame = basis.frames[0]
            for vector in basis.vectors:
                self.ensure(getattr(vector, "name", ""))
            names = (getattr(w, "name", "") for w in basis.duals)
            self.b.equation = next(self.definition[w].id for w in names if w in self.definition)
            along = [k for k in range(3) if self.rotation.along(frame, "base", k) is not None]
            for k in [*along, *(k for k in (2, 1, 0) if k not in along)]:
                self.b.keep(self.rotation.axis_column(frame, "base", k))

    def equation_of(self, expr: Any) -> str:
        """Id of the equation to which an expression belongs: its latest name's.

        What is made of given quantities alone belongs to the last equation of all.
        """
        names = names_in(expr)
        ids = [e.id for name, e in self.definition.items() if name in names]
        return ids[-1] if ids else list(self.definition.values())[-1].id

    def ensure(self, name: str) -> None:
        """Lower a name's definition in its home frame, and what it needs before it."""
        if name in self.home or name in self._scalars or name not in self.definition:
            return
        if name in self._in_progress:
            raise NotYetError(name)
        self._in_progress.add(name)
        before = self.b.equation
        try:
            self._ensure_new(self.definition[name])
        finally:
            self._in_progress.discard(name)
            self.b.equation = before

    def _ensure_new(self, equation: Equation) -> None:
        needed = self._in_order(names_in(equation.rhs))
        optional = self._in_order(set().union(*map(names_in, equation.forms)) - set(needed))
        for other in needed + optional:
            self.ensure(other)
        for other in needed:
            self._keep(other)
        self.b.equation = equation.id
        self._lower(equation)
        for condition in equation.conditions:
            self.b.guard(
                condition.trouble.value,
                self.scalar(condition.value),
                self.scalar(condition.scale),
                condition.power,
            )

    def _in_order(self, names: Set[str]) -> list[str]:
        """Names in the order in which they are defined, whatever they are."""
        return sorted(names, key=lambda name: (self._place.get(name, -1), name))

    def _keep(self, name: str) -> None:
        if name in self._scalars:
            self.b.keep([self._scalars[name]])
        elif name in self.home:
            key = (name, self.home[name])
            self.b.keep(atoms(self._vectors.get(key, self._tensors.get(key, ()))))

    def _lower(self, equation: Equation) -> None:
        name, lhs = equation.name, equation.lhs
        forms = (equation.rhs, *equation.forms)
        if isinstance(lhs, sp.Symbol):
            self._lower_scalar(name, forms)
            return
        frame = self._home_of(name, forms)
        self.trials.store(self.home, name, frame)
        if isinstance(lhs, n.VectorSymbol):
            if name in self.bases.duals:
                value = self._single(*self.bases.duals[name], frame)
            else:
                value = self.trials.cheapest([partial(self.vector, f, frame, name) for f in forms])
            self.trials.store(self._vectors, (name, frame), value)
        else:
            value = self.trials.cheapest([partial(self.tensor, f, frame, name) for f in forms])
            if lhs.is_symmetric:
                value = symmetrised(self.b, value)
            self.trials.store(self._tensors, (name, frame), value)

    def _lower_scalar(self, name: str, forms: Sequence[Any]) -> None:
        makers = [lambda f=f: self.scalar(f, name) for f in forms]
        self.trials.store(self._scalars, name, self.trials.cheapest(makers))

    def _home_of(self, name: str, forms: Sequence[Any]) -> str:
        body = self.d.notation[name].body
        if body is not None:
            return body
        frames = self._frames_of(forms[0])
        if len(frames) == 1:
            return frames[0]
        costs = [self.trials.attempt(partial(self._any, forms[0], f)).cost for f in frames]
        return frames[costs.index(min(costs))]

    def _any(self, expr: Any, frame: str) -> Any:
        return self.vector(expr, frame) if isinstance(expr, n.Vector) else self.tensor(expr, frame)

    def _frames_of(self, expr: Any) -> list[str]:
        """Home frames of the vectors and tensors in an expression, most frequent first."""
        found: dict[str, int] = {}
        for symbol in _symbols(expr):
            if symbol in self.given:
                frame = self.given[symbol].frame
            else:
                self.ensure(symbol.name)
                frame = self.home[symbol.name]
            found[frame] = found.get(frame, 0) + 1
        return sorted(found, key=lambda f: (-found[f], f)) or ["base"]

    # ---- vectors -------------------------------------------------------------------------

    def vector(self, expr: Any, frame: str, hint: str = "") -> Triple:
        """Components of a vector expression in a frame."""
        if isinstance(expr, n.VectorSymbol):
            return self._vector_symbol(expr, frame)
        if expr == n.ZeroVector:
            return (sp.S.Zero,) * 3
        operation = _VECTOR_OPERATIONS.get(type(expr))
        if operation is None:
            raise TypeError(f"no components for {type(expr).__name__}")
        result: Triple = operation(self, expr, frame, hint)
        return result

    def _vector_symbol(self, symbol: Any, frame: str) -> Triple:
        key = (symbol.name, frame)
        if key in self._vectors:
            return self._vectors[key]
        if symbol in self.given:
            given = self.given[symbol]
            if given.frame == frame:
                return self.trials.store(self._vectors, key, given.components)
            value = self.rotation.vector(given.components, given.frame, frame, symbol.name)
            return self.trials.store(self._vectors, key, value)
        self.ensure(symbol.name)
        if key in self._vectors:
            return self._vectors[key]
        home = self.home[symbol.name]
        makers = [
            lambda: self.rotation.vector(self._vectors[symbol.name, home], home, frame, symbol.name)
        ]
        equation = self.definition[symbol.name]
        if symbol.name not in self.bases.duals:
            makers += [
                partial(self.vector, f, frame, symbol.name)
                for f in (equation.rhs, *equation.forms)
                if self._is_there(f, frame)
            ]
        before, self.b.equation = self.b.equation, equation.id
        value = self.trials.cheapest(makers)
        self.b.equation = before
        return self.trials.store(self._vectors, key, value)

    def _is_there(self, expr: Any, frame: str) -> bool:
        """Whether all vectors of an expression have components in a frame already."""
        return all(
            (symbol.name, frame) in self._vectors
            or (symbol.name, frame) in self._tensors
            or (symbol in self.given and self.given[symbol].frame == frame)
            for symbol in _symbols(expr)
        )

    def _vector_cross(self, expr: Any, frame: str, hint: str) -> Triple:
        return cross(
            self.b, self.vector(expr.args[0], frame), self.vector(expr.args[1], frame), hint
        )

    def _vector_add(self, expr: Any, frame: str, hint: str) -> Triple:
        plain, duals = self._split_duals(expr.args)
        parts = [self.vector(term, frame) for term in plain]
        for basis, weights in duals:
            parts.append(self._combination(basis, weights, frame))
        return self._sum(parts, hint)

    def _sum(self, parts: Sequence[Triple], hint: str) -> Triple:
        return tuple(
            self.b.add([p[i] for p in parts], f"{hint}_{XYZ[i]}" if hint else "", named=bool(hint))
            for i in range(3)
        )

    def _split_duals(self, terms: Iterable[Any]) -> tuple[list[Any], list[Any]]:
        """Terms, and combinations of reciprocal vectors by basis."""
        plain: list[Any] = []
        weights: dict[int, tuple[ReciprocalBasis, list[Any]]] = {}
        for term in terms:
            factor, vector = n.split_scale(term)
            found = self.bases.of(vector)
            if found is None:
                plain.append(term)
                continue
            basis, k = found
            entry = weights.setdefault(id(basis), (basis, [sp.S.Zero] * len(basis.duals)))
            entry[1][k] = entry[1][k] + factor
        return plain, list(weights.values())

    def _vector_scale(self, expr: Any, frame: str, hint: str) -> Triple:
        factor, vector = expr.args
        if self.bases.of(vector) is not None:
            return self._vector_add(n.VectorAdd(expr), frame, hint)
        divisor = _divisor(factor)
        v = self.vector(vector, frame)
        if divisor is not None:
            bottom = self.scalar(divisor)
            top = self.scalar(factor * divisor)
            return tuple(
                self.b.divide(self.b.mul(top, c), bottom, f"{hint}_{XYZ[i]}" if hint else "")
                for i, c in enumerate(v)
            )
        if all(c == 0 for c in v):
            return v
        s = self.scalar(factor)
        return tuple(self.b.mul(s, c, f"{hint}_{XYZ[i]}" if hint else "") for i, c in enumerate(v))

    def _vector_apply(self, expr: Any, frame: str, hint: str) -> Triple:
        v = self.vector(expr.args[1], frame)
        t = self.tensor(expr.args[0], frame)
        return tuple(
            self.b.add(
                [self.b.mul(t[i][k], v[k]) for k in range(3)], f"{hint}_{XYZ[i]}" if hint else ""
            )
            for i in range(3)
        )

    def _vector_axial(self, expr: Any, frame: str, hint: str) -> Triple:
        """Of B S with symmetric S alone: nothing else has an axial vector in a derivation."""
        inner = expr.args[0]
        if not (isinstance(inner, n.Compose) and getattr(inner.args[1], "is_symmetric", False)):
            raise TypeError("no components for the axial vector of a general tensor")
        B, S = (self.tensor(factor, frame) for factor in inner.args)
        return self._moment_of(B, S, hint)

    def _moment_of(self, B: Tensor9, S: Tensor9, hint: str) -> Triple:
        """Axial(B S) for symmetric S, products of inertia taken out once."""
        b = self.b

        def entry(i: int) -> Atom:
            j, k = (i + 1) % 3, (i + 2) % 3
            return b.add(
                (
                    b.mul(B[k][i], S[i][j]),
                    b.mul(B[k][j], S[j][j]),
                    b.mul(S[j][k], b.difference(B[k][k], B[j][j])),
                    -b.mul(B[j][i], S[i][k]),
                    -b.mul(B[j][k], S[k][k]),
                ),
                f"{hint}_{XYZ[i]}" if hint else "",
            )

        return (entry(0), entry(1), entry(2))

    def _vector_total(self, expr: Any, frame: str, hint: str) -> Triple:
        value, leg_type = expr.args
        v = self.vector(value, frame, f"{hint}_leg" if hint else "")
        found = tuple(
            self.b.total(c, leg_type.name, f"{hint or 'total'}_{leg_type.name}_{XYZ[i]}")
            for i, c in enumerate(v)
        )
        self._note_total(expr, frame, found)
        return found

    def _combination(self, basis: ReciprocalBasis, weights: Sequence[Any], frame: str) -> Triple:
        """Force part of sum g_j (w_j; m_j)."""
        x, y, z, *_ = self.bases.wrench(basis, weights)
        return self.rotation.vector((x, y, z), self.bases.frame(basis), frame)

    def _single(self, basis: ReciprocalBasis, k: int, frame: str) -> Triple:
        """Force part of reciprocal wrench k."""
        x, y, z, *_ = self.bases.single(basis, k)
        return self.rotation.vector((x, y, z), self.bases.frame(basis), frame)

    def _vector_dual(self, expr: Any, frame: str, hint: str) -> Triple:
        k, *screws = expr.args
        return self._single(self.bases.of_screws(*screws), int(k), frame)

    # ---- tensors -------------------------------------------------------------------------

    def tensor(self, expr: Any, frame: str, hint: str = "") -> Tensor9:
        """Components of a tensor expression in a frame."""
        if isinstance(expr, n.TensorSymbol):
            return self._tensor_symbol(expr, frame)
        if expr in (n.ZeroTensor, n.Identity):
            one = sp.S.One if expr == n.Identity else sp.S.Zero
            return tuple(
                tuple(one if i == j else sp.S.Zero for j in range(3))  # type: ignore[return-value]
                for i in range(3)
            )
        operation = _TENSOR_OPERATIONS.get(type(expr))
        if operation is None:
            raise TypeError(f"no components for {type(expr).__name__}")
        result: Tensor9 = operation(self, expr, frame, hint)
        return result

    def _tensor_symbol(self, symbol: Any, frame: str) -> Tensor9:
        key = (symbol.name, frame)
        if key in self._tensors:
            return self._tensors[key]
        if symbol in self.given:
            given = self.given[symbol]
            c = given.components
            value: Tensor9 = (tuple(c[:3]), tuple(c[3:6]), tuple(c[6:]))
            origin = given.frame
        else:
            self.ensure(symbol.name)
            if key in self._tensors:
                return self._tensors[key]
            origin = self.home[symbol.name]
            value = self._tensors[symbol.name, origin]
        before = self.b.equation
        makers = [
            lambda: self.rotation.tensor(value, origin, frame, symbol.is_symmetric, symbol.name)
        ]
        if symbol.name in self.definition:
            equation = self.definition[symbol.name]
            self.b.equation = equation.id
            makers += [
                partial(self._anew, symbol, f, frame) for f in (equation.rhs, *equation.forms)
            ]
        found = self.trials.cheapest(makers)
        self.b.equation = before
        return self.trials.store(self._tensors, key, found)

    def _anew(self, symbol: Any, form: Any, frame: str) -> Tensor9:
        """A tensor formed from its equation in another frame than its home."""
        value = self.tensor(form, frame, symbol.name)
        return symmetrised(self.b, value) if symbol.is_symmetric else value

    def _tensor_add(self, expr: Any, frame: str, hint: str) -> Tensor9:
        parts = [self.tensor(term, frame) for term in expr.args]
        return self._entries(lambda i, j: self.b.add([p[i][j] for p in parts], _entry(hint, i, j)))

    def _entries(self, make: Callable[[int, int], Atom]) -> Tensor9:
        return tuple(tuple(make(i, j) for j in range(3)) for i in range(3))  # type: ignore[return-value]

    def _tensor_scale(self, expr: Any, frame: str, hint: str) -> Tensor9:
        s, t = self.scalar(expr.args[0]), self.tensor(expr.args[1], frame)
        return self._entries(lambda i, j: self.b.mul(s, t[i][j], _entry(hint, i, j)))

    def _tensor_skew(self, expr: Any, frame: str, hint: str) -> Tensor9:
        x, y, z = self.vector(expr.args[0], frame)
        zero = sp.S.Zero
        return ((zero, -z, y), (z, zero, -x), (-y, x, zero))

    def _tensor_outer(self, expr: Any, frame: str, hint: str) -> Tensor9:
        a, c = self.vector(expr.args[0], frame), self.vector(expr.args[1], frame)
        return self._entries(lambda i, j: self.b.mul(a[i], c[j], _entry(hint, i, j)))

    def _tensor_compose(self, expr: Any, frame: str, hint: str) -> Tensor9:
        first, second = expr.args
        if isinstance(first, n.Skew) and first == second:
            return self._skew_squared(self.vector(first.args[0], frame), hint)
        a, c = self.tensor(first, frame), self.tensor(second, frame)
        return self._entries(
            lambda i, j: self.b.add(
                [self.b.mul(a[i][k], c[k][j]) for k in range(3)], _entry(hint, i, j)
            )
        )

    def _skew_squared(self, w: Triple, hint: str) -> Tensor9:
        """w~ w~ = w w^T - (w . w) E: squares once."""
        b = self.b
        squares = [b.mul(c, c) for c in w]

        def entry(i: int, j: int) -> Atom:
            if i != j:
                return b.mul(w[min(i, j)], w[max(i, j)], _entry(hint, min(i, j), max(i, j)))
            return -b.add((squares[(i + 1) % 3], squares[(i + 2) % 3]), _entry(hint, i, i))

        return self._entries(entry)

    def _tensor_transpose(self, expr: Any, frame: str, hint: str) -> Tensor9:
        t = self.tensor(expr.args[0], frame)
        return self._entries(lambda i, j: t[j][i])

    def _tensor_total(self, expr: Any, frame: str, hint: str) -> Tensor9:
        value, leg_type = expr.args
        t = self.tensor(value, frame)
        stem = f"{hint or 'total'}_{leg_type.name}"
        found = self._entries(lambda i, j: self.b.total(t[i][j], leg_type.name, _entry(stem, i, j)))
        self._note_total(expr, frame, found)
        return found

    # ---- scalars -------------------------------------------------------------------------

    def scalar(self, expr: Any, hint: str = "") -> Atom:
        """The atom of a scalar expression."""
        if expr.is_Number:
            return expr
        if expr.is_Symbol:
            return self._scalar_symbol(expr)
        if isinstance(expr, n.Dot):
            return self._dot(expr, hint)
        if isinstance(expr, n.Trace):
            T = self.tensor(expr.args[0], self._frames_of(expr)[0])
            return self.b.add([T[i][i] for i in range(3)], hint)
        if isinstance(expr, n.DualScalar):
            return self._moment_part(expr)
        if isinstance(expr, n.LegSum):
            value, leg_type = expr.args
            stem = f"{hint or 'total'}_{leg_type.name}"
            found = self.b.total(self.scalar(value), leg_type.name, stem)
            self._note_total(expr, "", found)
            return found
        if expr.is_Add:
            return self._scalar_add(expr, hint)
        if expr.is_Mul:
            return self._product(expr, hint)
        if expr.is_Pow:
            return self._power(expr.base, expr.exp, hint)
        return self.b.let(expr.func(*(self.scalar(a) for a in expr.args)), hint, named=bool(hint))

    def _moment_part(self, expr: Any) -> Atom:
        """Moment part i of reciprocal wrench k."""
        k, i, *screws = expr.args
        return self.bases.single(self.bases.of_screws(*screws), int(k))[3 + int(i)]

    def _scalar_symbol(self, symbol: sp.Symbol) -> Atom:
        if symbol.name in self.definition:
            self.ensure(symbol.name)
            return self._scalars[symbol.name]
        return symbol

    def _scalar_add(self, expr: Any, hint: str) -> Atom:
        """A sum; what resolves a twist or a wrench along one basis is solved for at once."""
        plain: list[Any] = []
        twists: dict[tuple[int, int], tuple[ReciprocalBasis, list[Any]]] = {}
        products: list[tuple[Any, tuple[ReciprocalBasis, int, int]]] = []
        for term in expr.args:
            dual = self.bases.of(term.args[0]) if term.args else None
            coefficient = next(
                (
                    f
                    for f in sp.Mul.make_args(term)
                    if getattr(f, "name", "") in self.bases.coefficients
                ),
                None,
            )
            if isinstance(term, n.Dot) and dual is not None and dual[0].rows:
                basis, k = dual
                twists[id(basis), k] = (basis, [term.args[1], *[sp.S.Zero] * len(basis.rows)])
            elif coefficient is not None:
                products.append((term / coefficient, self.bases.coefficients[coefficient.name]))
            else:
                plain.append(term)
        wrenches: dict[tuple[int, int], tuple[ReciprocalBasis, list[Any]]] = {}
        for factor, (basis, k, i) in products:
            if (id(basis), k) in twists:
                twists[id(basis), k][1][1 + i] += factor
            else:
                zeros = [sp.S.Zero] * len(basis.duals)
                wrenches.setdefault((id(basis), i), (basis, zeros))[1][k] += factor
        parts = [self.scalar(term) for term in plain]
        for (_, k), (basis, (x, *coefficients)) in twists.items():
            parts.append(self.bases.resolve(basis, x, coefficients)[k])
        for (_, i), (basis, weights) in wrenches.items():
            parts.append(self.bases.wrench(basis, weights)[3 + i])
        return self.b.add(parts, hint, named=bool(hint))

    def _product(self, expr: Any, hint: str) -> Atom:
        divisor = _divisor(expr)
        if divisor is not None:
            top = self.scalar(expr * divisor)
            return self.b.divide(top, self.scalar(divisor), hint)
        result: Atom = sp.S.One
        for k, factor in enumerate(expr.args):
            last = k == len(expr.args) - 1
            result = self.b.mul(result, self.scalar(factor), hint if last else "")
        return result

    def _power(self, base: Any, exponent: Any, hint: str) -> Atom:
        value = self.scalar(base)
        if exponent == -1:
            return self.b.inverse(value)
        if exponent == sp.Rational(1, 2):
            return sp.sqrt(value) if value.is_Number else self.b.let(sp.sqrt(value), hint)
        if exponent == sp.Rational(-1, 2):
            return self.b.inverse(self.b.let(sp.sqrt(value)))
        if not exponent.is_Integer:
            raise TypeError(f"no power {exponent} in a program")
        result: Atom = value
        for _ in range(abs(int(exponent)) - 1):
            result = self.b.mul(result, value)
        return self.b.inverse(result) if exponent < 0 else result

    def _dot(self, expr: Any, hint: str) -> Atom:
        a, c = expr.args
        for dual, other in ((a, c), (c, a)):
            found = self.bases.of(dual)
            if found is not None:
                basis, k = found
                return self.bases.resolve(basis, other)[k]
        frames = sorted(self._frames_of(expr), key=lambda f: f not in self._coordinates(expr))
        return self.trials.cheapest([partial(self._dot_in, a, c, f, hint) for f in frames])

    def _coordinates(self, expr: Any) -> set[str]:
        """Frames along whose axes a factor of a scalar product lies: it is a component there."""
        given = (self.given[factor] for factor in expr.args if factor in self.given)
        return {g.frame for g in given if all(c.is_Integer for c in g.components)}

    def _dot_in(self, a: Any, c: Any, frame: str, hint: str) -> Atom:
        u, v = self.vector(a, frame), self.vector(c, frame)
        return self.b.add([self.b.mul(x, y) for x, y in zip(u, v, strict=True)], hint, named=True)


_VECTOR_OPERATIONS: dict[type, Any] = {
    n.VectorAdd: Lowering._vector_add,
    n.VectorScale: Lowering._vector_scale,
    n.Cross: Lowering._vector_cross,
    n.Apply: Lowering._vector_apply,
    n.Axial: Lowering._vector_axial,
    n.DualVector: Lowering._vector_dual,
    n.VectorLegSum: Lowering._vector_total,
}
_TENSOR_OPERATIONS: dict[type, Any] = {
    n.TensorAdd: Lowering._tensor_add,
    n.TensorScale: Lowering._tensor_scale,
    n.Skew: Lowering._tensor_skew,
    n.Outer: Lowering._tensor_outer,
    n.Compose: Lowering._tensor_compose,
    n.Transpose: Lowering._tensor_transpose,
    n.TensorLegSum: Lowering._tensor_total,
}


def _entry(hint: str, i: int, j: int) -> str:
    return f"{hint}_{XYZ[i]}{XYZ[j]}" if hint else ""


def _divisor(expr: Any) -> Any | None:
    """The symbol or scalar by which an expression divides, if it is a single one."""
    factors = expr.args if expr.is_Mul else (expr,)
    divisors = [f.base for f in factors if f.is_Pow and f.exp == -1]
    return divisors[0] if len(divisors) == 1 else None


def _symbols(expr: Any) -> list[Any]:
    """Vector and tensor symbols of an expression, in order of appearance."""
    if isinstance(expr, n.VectorSymbol | n.TensorSymbol):
        return [expr]
    found: list[Any] = []
    for arg in getattr(expr, "args", ()):
        found.extend(symbol for symbol in _symbols(arg) if symbol not in found)
    return found
