"""Writing a derivation: chapters are opened, names are introduced once, equations appended."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, TypedDict, Unpack

import sympy as sp

from pne_sym.derivation.coordinates import Coordinates, LegTypeInfo, Output
from pne_sym.derivation.derivation import Chapter, Derivation
from pne_sym.derivation.dimensions import Dimensions, unit_of_components, unit_of_equation
from pne_sym.derivation.equation import Condition, Equation, Law, ReciprocalBasis, names_in
from pne_sym.derivation.frames import BodyFrame
from pne_sym.derivation.paper import check_reference
from pne_sym.derivation.parameters import NameTakenError, ParameterTable
from pne_sym.derivation.quantity import Frame, Given, Quantity, Role
from pne_sym.vector import LinearForm, Tensor, TensorSymbol, Vector, VectorSymbol
from pne_sym.vector.arrays import Relation
from pne_sym.vector.dimensions import DimensionError, dimension_of_unit


class Facts(TypedDict, total=False):
    """What else there is to say of a quantity that an equation defines: fields of `Quantity`."""

    body: str | None
    parameter: bool
    role: Role | None
    joint: int
    remainder_of: str


def _defined(name: str, rhs: Any, *, symmetric: bool) -> tuple[Any, Any]:
    """The symbol of what an expression defines, and the expression."""
    if isinstance(rhs, Vector):
        return VectorSymbol(name), rhs
    if isinstance(rhs, Tensor):
        return TensorSymbol(name, symmetric), rhs
    return sp.Symbol(name, real=True), sp.sympify(rhs)


class Book:
    """Collects chapters and notation; every name has one meaning."""

    def __init__(self) -> None:
        self.notation: dict[str, Quantity] = {}
        self.bases: list[ReciprocalBasis] = []
        self.givens: list[Given] = []
        self.frames: list[Frame] = []
        self.body_frames: list[BodyFrame] = []
        self.pose: list[Given] = []
        self.parameters = ParameterTable()
        self.outputs: list[Output] = []
        self.relations: list[Relation] = []
        self.leg_types: list[LegTypeInfo] = []
        self.coordinates: Coordinates | None = None
        self._collected: dict[str, tuple[LinearForm, LinearForm] | None] = {}
        self._chapters: list[tuple[str, str, str | None, str, list[Equation]]] = []

    def chapter(self, id_: str, title: str, text: str, leg_type: str | None = None) -> None:
        """Open a chapter; equations that follow belong to it."""
        self._chapters.append((id_, title, leg_type, text, []))

    def retext(self, text: str) -> None:
        """Give the open chapter another opening paragraph."""
        id_, title, leg_type, _, equations = self._chapters[-1]
        self._chapters[-1] = (id_, title, leg_type, text, equations)

    def note_quantity(self, quantity: Quantity) -> None:
        """Introduce a name; an entry of a parameter has that one's unit.

        Raises:
            NameTakenError: another quantity has it.
        """
        if quantity.name in self.notation:
            raise NameTakenError(quantity.name)
        leg_type = self._chapters[-1][2] if self._chapters else None
        if quantity.name in self.parameters.entries:
            field, _ = self.parameters.entries[quantity.name]
            quantity = replace(quantity, unit=field.unit)
        self.notation[quantity.name] = replace(quantity, leg_type=leg_type or "")

    def give(self, symbol: Any, frame: str, components: Sequence[Any], quantity: Quantity) -> Any:
        """Introduce a given vector, tensor or scalar with its components.

        It has the unit of its components where these are parameters or numbers; else the
        quantity says it.
        """
        unit = unit_of_components(components, self._units)
        self.note_quantity(quantity if unit is None else replace(quantity, unit=unit))
        self.givens.append(Given(symbol, frame, tuple(components)))
        return symbol

    def define(
        self,
        name: str,
        rhs: Any,
        latex: str,
        title: str,
        law: Law,
        *,
        reference: str = "",
        forms: Sequence[Any] = (),
        linear: LinearForm | None = None,
        expanded: Any = None,
        conditions: Sequence[Condition] = (),
        symmetric: bool = False,
        like: Any = sp.S.Zero,
        **facts: Unpack[Facts],
    ) -> Any:
        """Append an equation that defines a new name; returns its symbol.

        Its unit is that of the right-hand side, where that may be zero of an expression `like` it.

        Raises:
            DimensionError: dimensions in right-hand side, forms or conditions disagree.
            ValueError: the paper has nothing of this law at the reference.
        """
        check_reference(reference, law)
        symbol, rhs = _defined(name, rhs, symmetric=symmetric)
        steps = linear.steps if linear else ()
        told = tuple(forms), steps, expanded, tuple(conditions)
        equation = Equation(self._id(name), title, symbol, rhs, law, reference, *told)
        unit = self._unit_of(equation, like, facts.get("role"))
        self.note_quantity(Quantity(name, latex, title, unit, **facts))
        self._chapters[-1][-1].append(equation)
        return symbol

    def _unit_of(self, e: Equation, like: Any, role: Role | None) -> str:
        """The unit of what an equation defines."""
        others = (*e.forms, like)
        try:
            return unit_of_equation(e.rhs, others, e.conditions, self._units, law=e.law, role=role)
        except DimensionError as error:
            raise DimensionError(f"{e.name}: {error}") from None

    def measured(
        self, name: str, number: sp.Float, unit: str, latex: str, title: str, law: Law
    ) -> Any:
        """Append an equation for a number in a unit, fixed at generation."""
        dimension_of_unit(unit)
        symbol = self.define(name, number, latex, title, law, parameter=True)
        self.notation[name] = replace(self.notation[name], unit=unit)
        return symbol

    def _id(self, name: str) -> str:
        """What an equation is cited by: the name that it defines, ups-rho2_1 for ups_rho2_1.

        The hyphen stands behind the name of the leg type, so that nothing depends on what
        else there is.
        """
        chapters = (leg_type for _, _, leg_type, _, _ in self._chapters if leg_type)
        owner = max((t for t in chapters if name.startswith(f"{t}_")), key=len, default="")
        return f"{owner}-{name[len(owner) + 1 :]}" if owner else name

    @property
    def _units(self) -> Dimensions:
        return Dimensions(self.notation, self.parameters)

    def collect(self, name: str, named: LinearForm, plain: LinearForm) -> None:
        """What the rules made of a quantity: by the names of the parts, and by what they stand for.

        Which of the two is shown is settled when the book is closed: parts that nobody needs
        have no equation.
        """
        self._collected[name] = named, plain

    def collect_no_coefficients(self, name: str) -> None:
        """Note that of a quantity only the remainder is wanted."""
        self._collected[name] = None

    def _shown(self, left_out: set[str]) -> dict[str, LinearForm | None]:
        """The collected forms, in names that equations define."""
        shown: dict[str, LinearForm | None] = {}
        for name, forms in self._collected.items():
            if forms is None:
                shown[name] = None
                continue
            named, plain = forms
            form = LinearForm(
                {
                    x: plain.coefficients[x] if names_in(c) & left_out else c
                    for x, c in named.coefficients.items()
                },
                plain.remainder if names_in(named.remainder) & left_out else named.remainder,
            )
            parts = (*form.coefficients.values(), form.remainder)
            usable = not any(names_in(part) & left_out for part in parts)
            shown[name] = form if usable else None
        return shown

    def fix_axes(self, axes: BodyFrame, quantity: Quantity | None = None, rhs: Any = None) -> Any:
        """Introduce the axes of a body; returns the tensor that turns them into base axes.

        Its equation is for readers: programs take components from the frames.
        """
        symbol, equation = None, None
        if quantity is not None:
            self.note_quantity(quantity)
            self.notation[quantity.name] = replace(quantity, leg_type=axes.leg_type)
            symbol = TensorSymbol(quantity.name)
        if quantity is not None and rhs is not None:
            id_ = self._id(quantity.name)
            equation = Equation(id_, quantity.meaning, symbol, rhs, Law.GEOMETRY)
        self.body_frames.append(replace(axes, symbol=symbol, equation=equation))
        return symbol

    def mark(self) -> tuple[int, int, set[str]]:
        """A point in the open chapter to return to."""
        return len(self._chapters[-1][4]), len(self.givens), set(self.notation)

    def reset(self, mark: tuple[int, int, set[str]]) -> None:
        """Strike out what the open chapter has gained since the mark."""
        equations, givens, names = mark
        del self._chapters[-1][4][equations:]
        del self.givens[givens:]
        for name in set(self.notation) - names:
            del self.notation[name]

    def open_equations(self) -> tuple[Equation, ...]:
        """The equations of the chapter that is being written."""
        return tuple(self._chapters[-1][4])

    def all_equations(self) -> Iterator[Equation]:
        """All equations written so far."""
        for *_, equations in self._chapters:
            yield from equations

    def _needed(self) -> set[str]:
        """Names that the outputs need, through right-hand sides, forms and conditions."""
        definitions = {e.name: e for *_, equations in self._chapters for e in equations}
        frames = [
            v for f in self.frames for v in (*(f.axes or ()), *(f.rows or ()), *(f.angle or ()))
        ]
        frames += [v for basis in self.bases for v in (*basis.vectors, *basis.scales)]
        needed: set[str] = set()
        stack = [n for v in [*(o.value for o in self.outputs), *frames] for n in names_in(v)]
        while stack:
            name = stack.pop()
            if name in needed:
                continue
            needed.add(name)
            if name in definitions:
                equation = definitions[name]
                parts = [
                    equation.rhs,
                    *equation.forms,
                    *(x for c in equation.conditions for x in (c.value, c.scale)),
                ]
                stack.extend(n for part in parts for n in names_in(part))
        return needed

    def close(self) -> Derivation:
        """The finished derivation; equations that nothing needs are left out."""
        needed = self._needed()
        left_out = {e.name for e in self.all_equations()} - needed
        chapters = [
            Chapter(id_, title, leg_type, text, kept)
            for id_, title, leg_type, text, equations in self._chapters
            if (kept := tuple(e for e in equations if e.name in needed))
        ]
        return Derivation(
            tuple(chapters),
            dict(self.notation),
            tuple(self.bases),
            tuple(self.givens),
            tuple(self.frames),
            tuple(self.body_frames),
            tuple(self.pose),
            self.parameters,
            tuple(self.outputs),
            tuple(self.leg_types),
            self.coordinates,
            self._shown(left_out),
            tuple(self.relations),
        )
