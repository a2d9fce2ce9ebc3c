"""Vectors to components: each named quantity in the frame where it costs least.

A named vector has a home frame (that of the body it belongs to).  In another
frame it is either rotated there or formed anew from its equation, whichever
needs fewer operations beyond what is already there; likewise, of several forms
of an equation the cheapest is taken.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set
from functools import partial
from typing import Any

import sympy as sp

from pne_sym.derivation import (
    Derivation,
    Equation,
    Output,
    ReciprocalBasis,
    leg_sums,
    names_in,
)
from pne_sym.lowering import scalars, tensors, vectors
from pne_sym.lowering.bases import Bases
from pne_sym.lowering.builder import Builder
from pne_sym.lowering.frames import Frames, Triple
from pne_sym.lowering.interface import Components
from pne_sym.lowering.rotation import Rotation, Tensor9, symmetrised
from pne_sym.lowering.statements import Atom
from pne_sym.lowering.trials import NotYetError, Trials, atoms
from pne_sym.lowering.uses import uses
from pne_sym.program.ir import Component
from pne_sym.vector import nodes as n


class Lowering(Components):
    """Components of the quantities of one derivation.

    Vectors pass from frame to frame joint by joint, or, after `form_tip_axes`, through
    the axes of each leg's last link in base axes.  Which is cheaper depends on how many
    vectors pass, so callers try both.

    Args:
        derivation: whose quantities they are.
        builder: makes the statements.
        outputs: those that are to be cheap.
    """

    def __init__(
        self, derivation: Derivation, builder: Builder, outputs: Sequence[Output] = ()
    ) -> None:
        self.d = derivation
        self.b = builder
        self.definition: dict[str, Equation] = {e.name: e for e in derivation.equations()}
        self._uses = uses(self.definition, outputs)
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

    def note_total(self, expr: Any, frame: str, value: Any) -> None:
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
            if not basis.rows:  # platform joints that turn about axes ask for all cosines anyway
                self._keep_lengths_across(basis)
            for vector in basis.vectors:
                self.ensure(getattr(vector, "name", ""))
            parts = (*basis.duals, *(part for own in basis.moment_duals for part in own))
            names = (getattr(part, "name", "") for part in parts)
            self.b.equation = next(self.definition[w].id for w in names if w in self.definition)
            along = [k for k in range(3) if self.rotation.along(frame, "base", k) is not None]
            for k in [*along, *(k for k in (2, 1, 0) if k not in along)]:
                self.b.keep(self.rotation.axis_column(frame, "base", k))

    def _keep_lengths_across(self, basis: ReciprocalBasis) -> None:
        """Form the cross products e x S of whose lengths a leg's equations may be made.

        Of some velocity vectors they are the components in base axes, and so, over their lengths,
        axes of frames.
        """
        defined = [self.definition[v.name] for v in basis.vectors if v.name in self.definition]
        leg_types = {self.d.notation[equation.name].leg_type for equation in defined}
        for equation in list(self.definition.values()):
            if self.d.notation[equation.name].leg_type in leg_types:
                for cross in _lengths_across(equation):
                    self.b.equation = equation.id
                    self.b.keep(self.vector(cross, "base"))
        for equation in defined:
            for vector in (*_symbols(equation.rhs), equation.lhs):
                known = partial(self.vector, vector, "base")
                if self.trials.attempt(known).cost == 0:
                    known()

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
            # What nothing else uses costs nothing where this equation can do without it.
            if self._uses[other] != 1:
                self._keep(other)
        self.b.equation = equation.id
        self._lower(equation)
        for condition in equation.conditions:
            self.b.guard(
                condition.status.value,
                self._tested(equation, condition.value),
                self.scalar(condition.scale),
                condition.power,
            )

    def _tested(self, equation: Equation, value: Any) -> Atom:
        """What a condition tests: under a root the square of this, whatever form it took."""
        factors = sp.Mul.make_args(equation.rhs) if equation.forms else ()
        if sp.sqrt(value) in factors:
            root = self._scalars[equation.name]
            return self.b.mul(root, root)
        return self.scalar(value)

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
                value = vectors.single(self, *self.bases.duals[name], frame)
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
        frames = self.frames_of(forms[0])
        if len(frames) == 1:
            return frames[0]
        costs = [self.trials.attempt(partial(self._any, forms[0], f)).cost for f in frames]
        return frames[costs.index(min(costs))]

    def _any(self, expr: Any, frame: str) -> Any:
        return self.vector(expr, frame) if isinstance(expr, n.Vector) else self.tensor(expr, frame)

    def frames_of(self, expr: Any) -> list[str]:
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
        operation = vectors.OPERATIONS.get(type(expr))
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
            makers += self._in_parts(equation.rhs, home, frame, symbol.name)
        before, self.b.equation = self.b.equation, equation.id
        value = self.trials.cheapest(makers)
        self.b.equation = before
        return self.trials.store(self._vectors, key, value)

    def _in_parts(self, total: Any, home: str, frame: str, hint: str) -> Iterator[Any]:
        """A way to a sum: what is there in a frame already is added there, the rest turned."""
        terms: tuple[list[Any], list[Any]] = ([], [])
        for term in total.args if isinstance(total, n.VectorAdd) else ():
            terms[self._is_there(term, frame)].append(term)
        rest, here = (n.vector_sum(of) for of in terms)
        if all(terms):
            yield lambda: vectors.summed(
                self,
                (
                    self.rotation.vector(self.vector(rest, home), home, frame, f"{hint}_rest"),
                    self.vector(here, frame),
                ),
                hint,
            )

    def _is_there(self, expr: Any, frame: str) -> bool:
        """Whether all vectors of an expression have components in a frame already."""
        return all(
            (symbol.name, frame) in self._vectors
            or (symbol.name, frame) in self._tensors
            or (symbol in self.given and self.given[symbol].frame == frame)
            for symbol in _symbols(expr)
        )

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
        operation = tensors.OPERATIONS.get(type(expr))
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

    # ---- scalars -------------------------------------------------------------------------

    def scalar(self, expr: Any, hint: str = "") -> Atom:
        """The atom of a scalar expression."""
        if expr.is_Number:
            return expr
        return self._scalar_symbol(expr) if expr.is_Symbol else scalars.atom_of(self, expr, hint)

    def _scalar_symbol(self, symbol: sp.Symbol) -> Atom:
        if symbol.name in self.definition:
            self.ensure(symbol.name)
            return self._scalars[symbol.name]
        return symbol


def _symbols(expr: Any) -> list[Any]:
    """Vector and tensor symbols of an expression, in order of appearance."""
    if isinstance(expr, n.VectorSymbol | n.TensorSymbol):
        return [expr]
    found: list[Any] = []
    for arg in getattr(expr, "args", ()):
        found.extend(symbol for symbol in _symbols(arg) if symbol not in found)
    return found


def _lengths_across(equation: Equation) -> Iterator[Any]:
    """Cross products whose length a form of an equation takes."""
    for form in equation.forms:
        for factor in sp.Mul.make_args(form) if isinstance(form, sp.Expr) else ():
            squared = factor.base if factor.is_Pow else None
            if isinstance(squared, n.Dot) and isinstance(squared.args[0], n.Cross):
                yield squared.args[0]
