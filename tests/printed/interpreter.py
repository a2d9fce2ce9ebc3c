"""Computes what a report says, from its text and the given quantities alone.

Equations are taken in printed order.  A vector that is given in the axes of a body has numbers
there; chapters that come before the body's rotation is known compute with those.  As soon as
it is known, all of them are turned into base axes.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pne_sym.backends.glyphs import Glyph
from tests.backends.formulas import Parser, Value, column, plain
from tests.printed.document import Document, Printed, Section, read

Numbers = Mapping[str, Any]
_FORMS = re.compile(r"\\begin\{aligned\}(.*)\\end\{aligned\}", re.DOTALL)
_MATRIX = re.compile(r"\\begin\{bmatrix\}(.*?)\\end\{bmatrix\}", re.DOTALL)
_PART = re.compile(r"\((-?[\w.]+, -?[\w.]+, -?[\w.]+)\)")


@dataclass
class Scope:
    """What symbols stand for: of a leg, or of the platform.

    Attributes:
        base: by symbol, in base axes.
        fixed: by label of axes and symbol, in the axes of a body.
        matrix: of the joints' velocities, where the leg transmits moments.
    """

    base: dict[str, Any] = field(default_factory=dict)
    fixed: dict[str, dict[str, Any]] = field(default_factory=dict)
    matrix: list[list[Value]] = field(default_factory=list)


class Known:
    """Values by symbol for one formula: the leg's before the platform's."""

    def __init__(self, of: Interpreter, legs: dict[str, int], axes: str = "") -> None:
        self.of, self.legs, self.axes = of, legs, axes

    def __getitem__(self, symbol: str) -> Any:
        for scope, name in self.of.scopes(symbol, self.legs):
            if self.axes and name in scope.fixed[self.axes]:
                return scope.fixed[self.axes][name]
            if name in scope.base:
                assert not (self.axes and np.ndim(scope.base[name])), f"axes mixed: {symbol}"
                return scope.base[name]
        raise KeyError(symbol)

    def within(self, used: set[str]) -> Known:
        """The same in the axes of the body in which some symbols are fixed."""
        leg = next(iter(self.legs.values()), 0)
        axes = self.of.axes_of(self.of.legs[leg] if leg else self.of.platform, used)
        return Known(self.of, self.legs, axes)

    def over_legs(self, index: str, body: Value) -> Any:
        """Sum over the legs of a type."""
        legs = next(s.legs for s in self.of.text.types if s.index == index)
        return sum(body(Known(self.of, {**self.legs, index: leg})) for leg in legs)

    def reciprocal(self, place: list[str]) -> Any:
        """An entry of the inverse of the matrix of the joints' velocities."""
        ((_, leg),) = self.legs.items()
        rows = [[cell(self) for cell in row] for row in self.of.legs[leg].matrix]
        rows[0] = [v if np.ndim(v) else np.zeros((3, 1)) for v in rows[0]]
        matrix = np.vstack([np.hstack(rows[0]), *([plain(v) for v in row] for row in rows[1:])])
        row = np.linalg.inv(matrix)[int(place[0]) - 1]
        return row[:3].reshape(3, 1) if place[1] == "F" else row[2 + int(place[1])]


class Interpreter:
    """A report that computes.

    Args:
        text: the report.
        numbers: vectors X, V, A, q (q where it is iterated) and all parameters by their names;
            those of legs (legs of the type, ...).
    """

    def __init__(self, text: str, numbers: Numbers) -> None:
        self.text: Document = read(text)
        self.numbers = numbers
        self.platform = Scope()
        self.legs = {leg: Scope() for s in self.text.types for leg in s.legs}
        self.platform_first = _places(self.text)
        self.symbols: dict[str, set[str]] = {s.title: set() for s in self.text.sections.values()}
        self.displacements: dict[tuple[int, int], float] = {}
        self._given()
        for equation in self.text.equations:
            try:
                self._equation(equation)
            except Exception as error:
                error.add_note(f"{equation.id}: {equation.formula}")
                raise

    # ---- symbols --------------------------------------------------------------------------

    def scopes(self, symbol: str, legs: dict[str, int]) -> Iterator[tuple[Scope, str]]:
        """Where a symbol may stand, and under which name."""
        glyph = Glyph.of(symbol)
        plain, _, last = glyph.sub.rpartition(",")
        for index, leg in legs.items():
            yield self.legs[leg], symbol
            if index in (last, glyph.sub):
                yield self.legs[leg], str(glyph._replace(sub=plain))
        yield self.platform, symbol

    def _parser(self, title: str) -> Parser:
        """Symbols known in a chapter: in those on the platform, of legs with their index."""
        known = list(self.symbols[""])
        if title:
            return Parser([*known, *self.symbols[title]])
        for section in self.text.types:
            known += [str(Glyph.of(s).indexed(section.index)) for s in self.symbols[section.title]]
        return Parser(known)

    # ---- what is given --------------------------------------------------------------------

    def _given(self) -> None:
        for section in self.text.sections.values():
            for symbol, meaning, axes, value in section.given:
                name = str(Glyph.of(symbol))
                self.symbols[section.title].add(name)
                for leg in section.legs or (0,):
                    scope = self.legs[leg] if leg else self.platform
                    self._put(scope, section, axes, name, (meaning, value, leg))

    def _put(
        self, scope: Scope, section: Section, axes: str, name: str, told: tuple[str, str, int]
    ) -> None:
        meaning, text, leg = told
        if text.startswith("$`"):
            value: Any = text[2:-2]  # made of others fixed in the same axes: when they are known
        else:
            value = column(self._value(text, section, leg))
        turned = {**self.text.sections[""].axes, **section.axes}
        for label in axes.split(" and "):
            if turned.get(label):
                scope.fixed.setdefault(label, {})[name] = value
            else:
                scope.base[name] = value
        match = re.match(r"(?:extra coordinate: )?displacement of joint (\d+)", meaning)
        if match and leg:
            self.displacements[leg, int(match[1])] = float(value)

    def _value(self, text: str, section: Section, leg: int) -> Any:
        """Numbers behind a symbol."""
        name, _, what = text.partition("`: ") if text.startswith("`") else ("", "", text)
        name = name.strip("`")
        if name in self.platform_first:
            return self._entry(name, what, leg)
        if name:
            found = np.asarray(self.numbers[name], dtype=float)
            found = found[section.legs.index(leg)] if leg else found
            if found.shape == (3, 3) and what == "zz alone":
                return np.diag([0.0, 0.0, found[2, 2]])
            if what.startswith("entry "):
                at, count = map(int, what.removeprefix("entry ").split(" of "))
                assert found.size == count
                return float(found.reshape(-1)[at - 1])
            if what.startswith("row "):
                return found[int(what.removeprefix("row ")) - 1]
            kept = _PART.fullmatch(what)
            if kept:
                return [0.0 if p == "0" else found["xyz".index(p)] for p in kept[1].split(", ")]
            return _symmetric(found) if found.shape == (3, 3) and "inertia" in name else found
        match = _PART.fullmatch(what)
        if match:
            return [float(p) for p in match[1].split(", ")]
        sign, _, others = what.partition(", -1 for leg")
        return -1.0 if str(leg) in re.findall(r"\d+", others) else float(sign)

    def _entry(self, vector: str, what: str, leg: int) -> Any:
        """Entries of X, V, A or q."""
        values, first = np.asarray(self.numbers[vector], dtype=float), self.platform_first[vector]
        if what.startswith("joint "):
            joint = leg, int(what.removeprefix("joint "))
            return values[len(first) + self.text.joints("q" if vector == "q" else "X").index(joint)]
        match = _PART.fullmatch(what)
        parts = match[1].split(", ") if match else [what]
        found = [0.0 if part == "0" else values[first.index(part)] for part in parts]
        return found if match else found[0]

    # ---- equations ------------------------------------------------------------------------

    def _equation(self, printed: Printed) -> None:
        formula, matrix = printed.formula, ""
        if r"\mathcal V =" in formula:
            formula, _, matrix = formula.partition(r",\qquad \mathcal V =")
        body = _FORMS.search(formula)
        left, *rights = (body[1] if body else formula).replace("&", "").split("= ")
        rights = [r.replace(r"\\", "").replace(r"\quad {}", "").strip() for r in rights]
        parser = self._parser(printed.title)
        forms = [parser.read(right) for right in rights]
        glyph = Glyph.of(left.strip())
        for legs in self._legs_of(printed, glyph):
            if matrix:
                cells = _cells(matrix)
                scope = self.legs[next(iter(legs.values()))]
                scope.matrix = [[parser.read(c)[0] for c in row] for row in cells]
            self._define(printed, glyph, forms, legs)

    def _legs_of(self, printed: Printed, left: Glyph) -> Iterator[dict[str, int]]:
        """For which legs an equation is evaluated: by the chapter, or the index to the left."""
        for section in self.text.types:
            own = printed.title == section.title
            if own or (not printed.title and left.sub.split(",")[-1] == section.index):
                yield from ({section.index: leg} for leg in section.legs)
                return
        yield {}

    def _define(
        self,
        printed: Printed,
        glyph: Glyph,
        forms: list[tuple[Value, set[str]]],
        legs: dict[str, int],
    ) -> None:
        leg = next(iter(legs.values()), 0)
        scope = self.legs[leg] if leg else self.platform
        if leg and not printed.title:
            glyph = glyph._replace(sub=glyph.sub.rpartition(",")[0])
        name, values = str(glyph), []
        title = printed.title or next((s.title for s in self.text.types if leg in s.legs), "")
        self.symbols[title].add(name)
        for value, used in forms:
            axes = self.axes_of(scope, used)
            values.append(column(value(Known(self, legs, axes))))
        for other in values[1:]:
            np.testing.assert_allclose(other, values[0], rtol=1e-9, atol=1e-9, err_msg=printed.id)
        found = np.squeeze(values[0]) if np.shape(values[0]) == (1, 1) else values[0]
        if axes and np.ndim(found):
            scope.fixed[axes][name] = found
        else:
            scope.base[name] = found
        match = re.match(r"Displacement of joint (\d+)(?! per)\b", printed.words)
        if match:
            self.displacements[leg, int(match[1])] = float(found)
        for owner in (scope, *([] if leg else self.legs.values())):
            self._turn_known(owner, self.text.sections[title])

    def axes_of(self, scope: Scope, used: set[str]) -> str:
        """Axes of the body in which everything is fixed that is not known in base axes yet.

        "" where there is nothing such, or in several bodies: then lengths alone can be told.
        """
        waiting = {
            n for n in used if n not in scope.base and any(n in v for v in scope.fixed.values())
        }
        labels = [label for label, v in scope.fixed.items() if waiting and waiting <= v.keys()]
        if labels:
            self._made_of_others(scope, labels[0])
        return labels[0] if labels else ""

    def _made_of_others(self, scope: Scope, label: str) -> None:
        """Vectors that are given by a formula in others fixed in the same axes."""
        values = scope.fixed[label]
        for name, value in list(values.items()):
            if isinstance(value, str):
                formula, used = Parser(values).read(value)
                if not any(isinstance(values[u], str) for u in used):
                    values[name] = column(formula(values))

    def _turn_known(self, scope: Scope, section: Section) -> None:
        """What is fixed in a body, in base axes as soon as its rotation is known."""
        for label, values in scope.fixed.items():
            axes = {**self.text.sections[""].axes, **section.axes}
            if label not in axes:
                continue
            turn = str(Glyph.of(axes[label]))
            rotation = scope.base.get(turn, self.platform.base.get(turn))
            if rotation is None:
                continue
            self._made_of_others(scope, label)
            for name, value in values.items():
                if name not in scope.base and not isinstance(value, str):
                    scope.base[name] = _turned(rotation, value)

    # ---- arrays ---------------------------------------------------------------------------

    def array(self, name: str) -> Any:
        """M, Z, H, Hk or what is required, from its block matrix."""
        printed = next(b for b in self.text.blocks if b.id == name)
        cells = _cells(printed.formula)
        parser = self._parser("")
        found = _Blocks(self, [[parser.read(c) for c in row] for row in cells], name).array()
        return found + self._of_rotors(printed.formula.partition(r"\end{bmatrix}")[2])

    def _of_rotors(self, text: str) -> Any:
        """What stands beside the blocks: of coupled motors."""
        return self._matrix(text.removeprefix(" + ")) if text.startswith(" + ") else 0.0

    def relation(self, id_: str) -> Any:
        """A whole array, from its printed product."""
        (formula,) = (r.formula for r in self.text.relations if r.id == id_)
        factors = formula.partition(" = ")[2].split(r"\,")
        return functools.reduce(np.matmul, map(self._matrix, factors))

    def _matrix(self, text: str) -> Any:
        """An array by its symbol, transposed, inverted or on a diagonal."""
        if text.endswith("^{-1}"):
            return np.linalg.inv(self._matrix(text.removesuffix("^{-1}")))
        if text.endswith(r"^{\mathsf T}"):
            return self._matrix(text.removesuffix(r"^{\mathsf T}")).T
        if text.startswith(r"\mathrm{diag}("):
            return np.diag(self._matrix(text.removeprefix(r"\mathrm{diag}(").removesuffix(")")))
        if text.startswith("("):
            return self._matrix(text[1:-1])
        if text == _COUPLING:
            return np.asarray(self.numbers["coupling"])
        places = (self.relation, self.text.relations), (self.array, self.text.blocks)
        (value,) = (
            of(found.id)
            for of, all_ in places
            for found in all_
            if found.formula.partition(" =")[0].removesuffix("(X)") == text
        )
        return value

    def joint_displacements(self) -> Any:
        """q of all joints of all legs."""
        return np.array([self.displacements[at] for at in self.text.joints("q")])


def _turned(rotation: Any, value: Any) -> Any:
    if np.shape(value) == (3, 3):
        return rotation @ value @ rotation.T
    return rotation @ value if np.shape(value) == (3, 1) else value


def _symmetric(found: Any) -> Any:
    upper = np.triu(found)
    return upper + upper.T - np.diag(np.diag(found))


def _places(text: Document) -> dict[str, list[str]]:
    """Names of the first entries of X, V and A, before those of joints."""
    found: dict[str, list[str]] = {"q": []}
    for vector in ("X", "V", "A"):
        words = text.orders[vector].partition("; then")[0].partition(" (A:")[0]
        found[vector] = words.split(", ")
    return found


def _cells(formula: str) -> list[list[str]]:
    match = _MATRIX.search(formula)
    assert match
    rows = [row.split("&") for row in match[1].split(r"\\")]
    return [[c.strip() for c in row if c.strip() not in (r"\cdots", "")] for row in rows]


_COUPLING = r"\boldsymbol{\mathcal K}"
_OF_DRIVES = ("rotor_roots", "actuated_accelerations", "actuated_bias")


class _Blocks:
    """An array of blocks; what has an index stands there once for each leg."""

    def __init__(
        self, of: Interpreter, cells: list[list[tuple[Value, set[str]]]], name: str
    ) -> None:
        self.of, self.cells, self.name = of, cells, name
        rates = of.platform_first["V"]
        linear = [k for k, axis in enumerate(("vx", "vy", "vz")) if axis in rates]
        angular = [k for k, axis in enumerate(("wx", "wy", "wz")) if axis in rates]
        self.fixed = [parts for parts in (linear, angular) if parts]
        self.vector = "tau" if name in _OF_DRIVES else "X"
        if name in _OF_DRIVES:
            self.fixed = []

    def _index(self, used: set[str]) -> str:
        """The letter of the legs in a cell."""
        letters = [s.index for s in self.of.text.types]
        found = {i for u in used for i in letters if i == Glyph.of(u).sub.split(",")[-1]}
        return next(iter(sorted(found)), "")

    def array(self) -> Any:
        rows = self._rows()
        columns = self._columns(rows)
        found = np.zeros((rows[-1].stop, columns[-1].stop if columns else 1))
        for row, line in zip(rows, self.cells, strict=True):
            for column_, (value, _) in zip(columns or [_Span(0, 1)], line, strict=True):
                self._place(found, row, column_, value)
        return found if columns else found[:, 0]

    def _rows(self) -> list[_Span]:
        """Platform rows first, then those of legs."""
        spans, at = [], 0
        for k, line in enumerate(self.cells):
            if k < len(self.fixed):
                spans.append(_Span(at, at + len(self.fixed[k]), self.fixed[k]))
            else:
                index = next(filter(None, (self._index(used) for _, used in line)))
                spans.append(self._span(at, index, self.vector, spans))
            at = max(at, spans[-1].stop)
        return _joined(spans)

    def _columns(self, rows: list[_Span]) -> list[_Span]:
        if self.name in ("Z", "required", *_OF_DRIVES):
            return []
        if self.name == "M":
            return rows
        spans: list[_Span] = []
        for k in range(len(self.cells[0])):
            if self.name == "H":
                spans.append(self._span(0, self.of.text.owners("tau")[k], "tau", spans))
            else:
                index = next(filter(None, (self._index(line[k][1]) for line in self.cells)))
                spans.append(self._span(0, index, "lambda", spans))
        return _joined(spans)

    def _span(self, at: int, index: str, vector: str, before: list[_Span]) -> _Span:
        """Places of one entry for each leg of a type: the next of its joints."""
        section = next(s for s in self.of.text.types if s.index == index)
        number = sum(span.index == index for span in before)
        order = self._order(vector)
        start = sum(len(parts) for parts in self.fixed) if vector == "X" else 0
        places = {
            leg: start + [k for k, owner in enumerate(order) if owner == leg][number]
            for leg in section.legs
        }
        return _Span(at, start + len(order), [], index, places)

    def _order(self, vector: str) -> list[int]:
        """The leg of every entry."""
        if vector != "lambda":
            return [leg for leg, _ in self.of.text.joints(vector)]
        each = {
            s.index: sum(
                any(self._index(line[k][1]) == s.index for line in self.cells)
                for k in range(len(self.cells[0]))
            )
            for s in self.of.text.types
        }
        legs = sorted((leg, s.index) for s in self.of.text.types for leg in s.legs)
        return [leg for leg, index in legs for _ in range(each[index])]

    def _place(self, found: Any, row: _Span, column_: _Span, value: Value) -> None:
        indices = {row.index, column_.index} - {""}
        if len(indices) > 1:
            return  # of different legs: zero
        index = next(iter(indices), "")
        for leg in {**row.places, **column_.places} or {0: 0}:
            cell = np.atleast_2d(value(Known(self.of, {index: leg} if leg else {})))
            rows, columns = row.at(leg), column_.at(leg)
            if cell.shape == (3, 3):
                cell = cell[np.ix_(row.parts, column_.parts)]
            elif cell.shape == (3, 1):
                cell = cell[row.parts]
            elif cell.shape == (1, 3):
                cell = cell[:, column_.parts]
            found[np.ix_(rows, columns)] = cell


@dataclass
class _Span:
    """Rows or columns of a block.

    Attributes:
        start, stop: of the platform's; of legs stop is the size of the whole.
        parts: components of the platform's vector.
        index, places: of legs, the letter and the place by leg.
    """

    start: int
    stop: int
    parts: list[int] = field(default_factory=list)
    index: str = ""
    places: dict[int, int] = field(default_factory=dict)

    def at(self, leg: int) -> list[int]:
        """The places in the whole."""
        return [self.places[leg]] if self.places else list(range(self.start, self.stop))


def _joined(spans: list[_Span]) -> list[_Span]:
    """All stop where the whole does."""
    whole = max(span.stop for span in spans)
    spans[-1].stop = whole if spans[-1].places else spans[-1].stop
    return spans
