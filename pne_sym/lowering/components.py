"""Vectors to components: each named quantity in the frame where it costs least.

A named vector has a home frame (that of the body it belongs to).  In another
frame it is either rotated there or formed anew from its equation, whichever
needs fewer operations beyond what is already there; likewise, of several forms
of an equation the cheapest is taken.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence, Set
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
from pne_sym.lowering.rotation import Rotation
from pne_sym.lowering.statements import Atom
from pne_sym.lowering.trials import NotYetError, Trials, atoms
from pne_sym.lowering.triples import IDENTITY, Matrix, Triple, matrix, symmetrised
from pne_sym.program.ir import Component
from pne_sym.vector import nodes as n

_OPERATIONS = vectors.OPERATIONS | tensors.OPERATIONS
_CONSTANTS: dict[Any, Any] = {
    n.ZeroVector: (sp.S.Zero,) * 3,
    n.ZeroTensor: ((sp.S.Zero,) * 3,) * 3,
    n.Identity: IDENTITY,
}
_INDICES: dict[int, list[tuple[int, ...]]] = {
    1: [()],
    3: [(i,) for i in range(3)],
    9: [divmod(k, 3) for k in range(9)],
}
"""Number of components -> their indices."""


class Lowering:
    """Components of the quantities of one derivation.

    Vectors pass from frame to frame joint by joint, or, after `form_tip_axes`, through
    the axes of each leg's last link in base axes.  Which is cheaper depends on how many
    vectors pass, so callers try both.

    Args:
        derivation: whose quantities they are.
        builder: makes the statements.
        outputs: those that are to be cheap.

    Attributes:
        given: what is given, by symbol.
        trials: for ways of which the cheapest is taken.
        home: the frame in which each quantity was made first; "" of scalars.
        known: components by name and frame, as far as they are made.
        rotation: between frames.
        bases: reciprocal bases, and what is resolved in them.
    """

    def __init__(
        self, derivation: Derivation, builder: Builder, outputs: Sequence[Output] = ()
    ) -> None:
        self.d = derivation
        self.b = builder
        self.definition: dict[str, Equation] = {e.name: e for e in derivation.equations()}
        self._uses = self._counted(outputs)
        self._place = {name: k for k, name in enumerate(self.definition)}
        self.given = {g.symbol: g for g in derivation.givens}
        self.trials = Trials(builder)
        self.home: dict[str, str] = {}
        self.known: dict[tuple[str, str], Any] = {}
        self._totals: dict[Component, Atom] = {}  # sums over legs, by what they are
        self._in_progress: set[str] = set()
        self.rotation, self.bases = Rotation(self), Bases(self)

    def _counted(self, outputs: Iterable[Output]) -> Counter[str]:
        """By name, how many of these outputs, and equations that they need, use a quantity."""
        stack = [name for output in outputs for name in sorted(names_in(output.value))]
        found, seen = Counter(stack), set[str]()
        while stack:
            name = stack.pop()
            if name in self.definition and name not in seen:
                seen.add(name)
                used = sorted(names_in(self.definition[name].rhs))
                found.update(used)
                stack += used
        return found

    # ---- what was made -----------------------------------------------------------------

    def components(self) -> Iterator[tuple[Component, Atom]]:
        """All components that were made, of quantities, sums over legs and axes of frames."""
        found = [(name, frame, atoms(value)) for (name, frame), value in self.known.items()]
        for name, frame, value in sorted(found, key=lambda item: len(item[-1])):
            for index, atom in zip(_INDICES[len(value)], value, strict=True):
                yield Component(name, frame, index), atom
        yield from self._totals.items()
        yield from self.rotation.components()

    def made(self) -> dict[str, tuple[str, tuple[Atom, ...]]]:
        """Frame and components of every quantity, where it was made first."""
        made = {name: (frame, self.known.get((name, frame))) for name, frame in self.home.items()}
        return {n: (f, tuple(atoms(value))) for n, (f, value) in made.items() if value is not None}

    def note_total(self, expr: Any, frame: str, value: Any) -> None:
        """Note what the sum of an equation over the legs of a type is, where it is the only one."""
        name, leg_type = self.b.quantity_of.get(self.b.equation, ""), expr.args[1]
        same = [
            s for s in leg_sums(self.definition[name].rhs if name else 0) if s.args[1] == leg_type
        ]
        if same != [expr]:
            return
        found = atoms(value)
        for index, atom in zip(_INDICES[len(found)], found, strict=True):
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
        if name in self.home or name not in self.definition:
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
            root = self.known[equation.name, ""]
            return self.b.mul(root, root)
        return self.scalar(value)

    def _in_order(self, names: Set[str]) -> list[str]:
        """Names in the order in which they are defined, whatever they are."""
        return sorted(names, key=lambda name: (self._place.get(name, -1), name))

    def _keep(self, name: str) -> None:
        if name in self.home:
            self.b.keep(atoms(self.known.get((name, self.home[name]), ())))

    def _lower(self, equation: Equation) -> None:
        name, lhs = equation.name, equation.lhs
        forms = (equation.rhs, *equation.forms)
        if isinstance(lhs, sp.Symbol):
            value = self.trials.cheapest([partial(self.scalar, f, name) for f in forms])
            self.trials.store(self.home, name, "")
            self.trials.store(self.known, (name, ""), value)
            return
        frame = self._home_of(name, forms)
        self.trials.store(self.home, name, frame)
        if name in self.bases.duals:
            value = vectors.single(self, *self.bases.duals[name], frame)
        else:
            value = self.trials.cheapest([partial(self._any, f, frame, name) for f in forms])
        self.trials.store(self.known, (name, frame), self._symmetrised(lhs, value))

    def _symmetrised(self, symbol: Any, value: Any) -> Any:
        symmetric = isinstance(symbol, n.TensorSymbol) and symbol.is_symmetric
        return symmetrised(self.b, value) if symmetric else value

    def _home_of(self, name: str, forms: Sequence[Any]) -> str:
        body = self.d.notation[name].body
        if body is not None:
            return body
        frames = self.frames_of(forms[0])
        if len(frames) == 1:
            return frames[0]
        costs = [self.trials.attempt(partial(self._any, forms[0], f)).cost for f in frames]
        return frames[costs.index(min(costs))]

    def frames_of(self, expr: Any) -> list[str]:
        """Home frames of the vectors and tensors in an expression, most frequent first."""
        found = Counter(self._home(symbol) for symbol in _symbols(expr))
        return sorted(found, key=lambda f: (-found[f], f)) or ["base"]

    def _home(self, symbol: Any) -> str:
        if symbol in self.given:
            return self.given[symbol].frame
        self.ensure(symbol.name)
        return self.home[symbol.name]

    # ---- vectors and tensors ---------------------------------------------------------------

    def vector(self, expr: Any, frame: str, hint: str = "") -> Triple:
        """Components of a vector expression in a frame."""
        found: Triple = self._any(expr, frame, hint)
        return found

    def tensor(self, expr: Any, frame: str, hint: str = "") -> Matrix:
        """Components of a tensor expression in a frame."""
        found: Matrix = self._any(expr, frame, hint)
        return found

    def _any(self, expr: Any, frame: str, hint: str = "") -> Any:
        if isinstance(expr, n.VectorSymbol | n.TensorSymbol):
            return self._of_symbol(expr, frame)
        if expr in _CONSTANTS:
            return _CONSTANTS[expr]
        operation = _OPERATIONS.get(type(expr))
        if operation is None:
            raise TypeError(f"no components for {type(expr).__name__}")
        return operation(self, expr, frame, hint)

    def _of_symbol(self, symbol: Any, frame: str) -> Any:
        key = (symbol.name, frame)
        if key not in self.known and symbol not in self.given:
            self.ensure(symbol.name)
        if key in self.known:
            return self.known[key]
        makers: list[Callable[[], Any]] = [partial(self._turned, symbol, frame)]
        before = self.b.equation
        if symbol.name in self.definition:
            equation = self.definition[symbol.name]
            makers += self._anew(symbol, (equation.rhs, *equation.forms), frame)
            self.b.equation = equation.id
        found = self.trials.cheapest(makers)
        self.b.equation = before
        return self.trials.store(self.known, key, found)

    def _turned(self, symbol: Any, frame: str) -> Any:
        """What is given or was made in its home frame, in another."""
        home, given = self._home(symbol), self.given.get(symbol)
        value = given.components if given else self.known[symbol.name, home]
        if isinstance(symbol, n.VectorSymbol):
            return self.rotation.vector(value, home, frame, symbol.name)
        rows = value if len(value) == 3 else matrix(lambda i, j: value[3 * i + j])
        return self.rotation.tensor(rows, home, frame, symbol.is_symmetric, symbol.name)

    def _anew(self, symbol: Any, forms: Sequence[Any], frame: str) -> Iterator[Callable[[], Any]]:
        """Ways to form it from its equation in another frame than its home."""
        if symbol.name not in self.bases.duals:
            for form in forms:
                if isinstance(symbol, n.TensorSymbol) or self._is_there(form, frame):
                    yield partial(self._formed, symbol, form, frame)
            yield from self._in_parts(forms[0], self.home[symbol.name], frame, symbol.name)

    def _formed(self, symbol: Any, form: Any, frame: str) -> Any:
        return self._symmetrised(symbol, self._any(form, frame, symbol.name))

    def _in_parts(
        self, total: Any, home: str, frame: str, hint: str
    ) -> Iterator[Callable[[], Triple]]:
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
            (symbol.name, frame) in self.known
            or (symbol in self.given and self.given[symbol].frame == frame)
            for symbol in _symbols(expr)
        )

    # ---- scalars -------------------------------------------------------------------------

    def scalar(self, expr: Any, hint: str = "") -> Atom:
        """The atom of a scalar expression."""
        if expr.is_Number:
            return expr
        return self._scalar_symbol(expr) if expr.is_Symbol else scalars.atom_of(self, expr, hint)

    def _scalar_symbol(self, symbol: sp.Symbol) -> Atom:
        if symbol.name in self.definition:
            self.ensure(symbol.name)
            return self.known[symbol.name, ""]
        return symbol


def _symbols(expr: Any) -> list[Any]:
    """Vector and tensor symbols of an expression, in order of appearance."""
    if isinstance(expr, n.VectorSymbol | n.TensorSymbol):
        return [expr]
    return list(dict.fromkeys(s for arg in getattr(expr, "args", ()) for s in _symbols(arg)))


def _lengths_across(equation: Equation) -> Iterator[Any]:
    """Cross products whose length a form of an equation takes."""
    for form in equation.forms:
        for factor in sp.Mul.make_args(form) if isinstance(form, sp.Expr) else ():
            squared = factor.base if factor.is_Pow else None
            if isinstance(squared, n.Dot) and isinstance(squared.args[0], n.Cross):
                yield squared.args[0]
