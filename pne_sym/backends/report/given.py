"""What is given: symbols with the axes and the numbers that stand behind them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.markdown import inline, table, unit
from pne_sym.backends.report.names import per_leg_names
from pne_sym.backends.report.view import Lines
from pne_sym.derivation import (
    BodyAxes,
    BodyFrame,
    Derivation,
    Given,
    LegTypeInfo,
    Quantity,
    Role,
    names_in,
)
from pne_sym.vector import TensorSymbol, Vector

_HEAD = ("Symbol", "Meaning", "Unit", "Axes of", "Value")
_AXES = "xyz"
_LINEAR = {Role.POSITION: "X", Role.VELOCITY: "V", Role.ACCELERATION: "A"}
_ANGULAR = {Role.ANGULAR_VELOCITY: "V", Role.ANGULAR_ACCELERATION: "A"}
_OF_JOINT = {Role.DISPLACEMENT: "X", Role.RATE: "V", Role.JOINT_ACCELERATION: "A"}


class GivenWriter:
    """Rows of given symbols and of frames."""

    def __init__(self, derivation: Derivation, printer: LatexPrinter) -> None:
        self.d, self.printer = derivation, printer
        self.axes = BodyAxes(derivation)
        self.givens = {g.symbol.name: g for g in (*derivation.givens, *derivation.pose)}
        self.per_leg = per_leg_names(derivation)

    def table(self, info: LegTypeInfo | None) -> Lines:
        """Symbols that equations use and none defines, of a leg type or of the platform."""
        return table(_HEAD, dict.fromkeys(self._rows(info)))

    def frames(self, info: LegTypeInfo | None) -> Lines:
        """Axes of bodies, and how they are turned."""
        rows: list[tuple[str, ...]] = [
            (body.body, self._from(body), self._into_base(body))
            for body in self.axes.bodies.values()
            if body.leg_type == (info.name if info else "")
        ]
        worked_in = self.axes.worked_in(info.name) if info else ()
        rows += [self._worked_in(*told) for told in worked_in]
        return table(("Axes of", "What they are", "Into base axes"), rows)

    def _worked_in(self, name: str, body: BodyFrame, axes: Sequence[Any]) -> tuple[str, ...]:
        """Axes in which the code takes components besides, by those of their body."""
        told = [
            inline(self.printer.doprint(a))
            if isinstance(a, Vector)
            else f"({', '.join(map(str, a))})"
            for a in axes
        ]
        return (
            f"`{name.rpartition('.')[2]}`",
            f"in code alone: x, y, z are {', '.join(told)} in axes of {body.body}",
            "with these",
        )

    def fixed_in(self, body: BodyFrame) -> str:
        """The sentence that tells what is turned by a rotation."""
        used = self._used(None)
        symbols = [
            g.symbol for g in self.d.givens if self.axes.of(g)[0] is body and g.symbol.name in used
        ]
        latex = {s: self.printer.doprint(s) for s in symbols}
        if not latex:
            return ""
        turn = self.printer.doprint(body.symbol)
        told = []
        for kind, after in ((Vector, ""), (TensorSymbol, rf"\,{turn}^{{\mathsf T}}")):
            first = next((s for s in symbols if isinstance(s, kind)), None)
            if first is not None:
                raised = self.printer.glyph(first).raised("0")
                told.append(inline(rf"{latex[first]}={turn}\,{raised}{after}"))
        fixed = ", ".join(inline(text) for text in dict.fromkeys(latex.values()))
        return f"It turns {fixed} and what is made of them: in base axes {' and '.join(told)}."

    # ---- rows -----------------------------------------------------------------------------

    def _used(self, leg_type: str | None) -> set[str]:
        """Names on right-hand sides, in rotations, and in what is told of the given."""
        chapters = [c for c in self.d.chapters if leg_type is None or c.leg_type == leg_type]
        own = [e for e in self.d.rotations() if leg_type is None or e.id.startswith(f"{leg_type}-")]
        equations = [*own, *(e for c in chapters for e in c.equations)]
        parts = [p for e in equations for p in (e.rhs, *e.forms)]
        used = {n for part in parts for n in names_in(part)}
        for name in sorted(used & self.givens.keys() - {g.symbol.name for g in self.d.pose}):
            value = self.axes.of(self.givens[name])[1]
            used |= names_in(value) if isinstance(value, Vector) else set()
        told = self.axes.worked_in(leg_type) if leg_type else ()
        return used | {
            n for *_, axes in told for a in axes if isinstance(a, Vector) for n in names_in(a)
        }

    def _rows(self, info: LegTypeInfo | None) -> Iterator[tuple[str, ...]]:
        defined = {e.name for e in self.d.equations()}
        defined |= {e.name for e in self.d.rotations()}
        used = self._used(info.name if info else None)
        for name, quantity in self.d.notation.items():
            own = self._owner(name) == (info.name if info else "")
            if name in used and name not in defined and own:
                symbol = inline(str(self.printer.glyph_of(name)))
                yield symbol, quantity.meaning, unit(quantity.unit), *self._value(quantity, info)

    def _owner(self, name: str) -> str:
        return self.per_leg.get(name, "") or self.d.notation[name].leg_type

    def _value(self, quantity: Quantity, info: LegTypeInfo | None) -> tuple[str, str]:
        """Axes, and components or where they come from."""
        given = self.givens.get(quantity.name)
        leg_frame = next((b for b in self.d.body_frames if b.symbol == _tensor(quantity)), None)
        if leg_frame is not None:
            frame = self.axes.frames[leg_frame.frame]
            return "base", f"`{self._fields(frame.rotation or ())[0]}`"
        if given is None:
            return "", self._scalar(quantity, info)
        if given in self.d.pose:
            return "base" if len(given.components) == 3 else "", self._of_pose(given)
        body, value = self.axes.of(given)
        turning = self.axes.turning.get(given.symbol)
        place = f"{body.body} and {turning.body}" if turning else body.body
        if isinstance(value, Vector):
            return place, inline(self.printer.doprint(value))
        return place, self._components(quantity, value)

    def _components(self, quantity: Quantity, value: Sequence[Any]) -> str:
        if quantity.role in _LINEAR and not self._fields(value):
            names = self._coordinates(quantity.role)
            return f"`{_LINEAR[quantity.role]}`: {_listed(value, names)}"
        if quantity.role in _ANGULAR:
            names = self._coordinates(quantity.role)
            return f"`{_ANGULAR[quantity.role]}`: {_listed(value, names)}"
        fields = self._fields(value)
        if not fields:
            return f"({', '.join(map(str, value))})"
        (field,) = fields
        if len(value) == 3 and 0 in value:
            named = [a for a, v in zip(_AXES, value, strict=True) if v != 0]
            return f"`{field}`: {_listed(value, named)}"
        entry = self.d.parameters.entries[str(value[0])] if value[0] != 0 else None
        if entry is not None and entry[0].shape == (3, 3) and len(value) == 3:
            return f"`{field}`: row {entry[1] // 3 + 1}"
        return f"`{field}`" + (": zz alone" if entry is None and len(value) == 9 else "")

    def _coordinates(self, role: Role | None) -> list[str]:
        c = self.d.coordinates
        assert c is not None
        if role is Role.POSITION:
            return list(c.pose[: c.position])
        return list(c.rates[c.position :] if role in _ANGULAR else c.rates[: c.position])

    def _of_pose(self, given: Given) -> str:
        c = self.d.coordinates
        assert c is not None
        entries = c.pose[c.position :]
        if given.components[0] == 0:
            return f"({', '.join(map(str, given.components))})"
        if len(given.components) == 3:
            return f"`X`: ({', '.join(entries[:3])})"
        return f"`X`: {entries[-1]}"

    def _scalar(self, quantity: Quantity, info: LegTypeInfo | None) -> str:
        name, parameters = quantity.name, self.d.parameters
        if name in parameters.entries:
            field, index = parameters.entries[name]
            return f"`{field.name}`" + f": entry {index + 1} of {field.size}" * bool(field.shape)
        if name in parameters.branches:
            assert info is not None
            return _signs(info, parameters.branches[name][1])
        c, at = self.d.coordinates, quantity.joint
        assert c is not None
        assert info is not None
        assert quantity.role is not None
        extra = (info.indices[0], at - 1) in c.extras
        return f"`{_OF_JOINT[quantity.role] if extra else 'q'}`: joint {at}"

    def _fields(self, components: Sequence[Any]) -> list[str]:
        """Parameters whose entries stand there."""
        table = self.d.parameters
        names = [n for c in components for n in sorted(names_in(c) & set(table.entries))]
        return list(dict.fromkeys(table.entries[n][0].name for n in names))

    # ---- frames ---------------------------------------------------------------------------

    def _from(self, body: BodyFrame) -> str:
        if body.frame == "base":
            return "fixed, those of vectors' components where none are named"
        if not body.leg_type:
            return "fixed in the platform, origin at the platform origin"
        if not body.before:
            return "fixed in the base, those of the leg's specification"
        before = self.axes.bodies[body.before].body
        return f"parallel to those of {before} at zero displacement"

    def _into_base(self, body: BodyFrame) -> str:
        if body.symbol is None:
            return "the same" if body.frame == "base" else "parallel to them"
        symbol = inline(self.printer.doprint(body.symbol))
        if body.equation is None:
            return symbol
        return f"{symbol} ([{body.equation.id}](#{body.equation.id}))"


def _tensor(quantity: Quantity) -> TensorSymbol:
    return TensorSymbol(quantity.name)


def _listed(components: Sequence[Any], names: Sequence[str]) -> str:
    """Components by their names, zeros where they have none."""
    left = iter(names)
    return f"({', '.join('0' if c == 0 else next(left) for c in components)})"


def _signs(info: LegTypeInfo, signs: Sequence[int]) -> str:
    if len(set(signs)) == 1:
        return f"{signs[0]:+d}"
    minus = [str(i + 1) for i, sign in zip(info.indices, signs, strict=True) if sign < 0]
    return f"+1, -1 for leg{'s' * (len(minus) > 1)} {', '.join(minus)}"
