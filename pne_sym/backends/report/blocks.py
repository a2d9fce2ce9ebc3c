"""M, Z, H and Hk as block matrices, from the places of the derivation's outputs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import sympy as sp

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.markdown import inline
from pne_sym.backends.report.names import leg_indices, leg_title
from pne_sym.backends.report.view import Statement
from pne_sym.derivation import Chapter, Derivation, Output
from pne_sym.vector import Tensor, Vector

Key = tuple[int, ...]
ARRAYS = (
    ("M", r"\mathbf M(X)", "The mass matrix, symmetric"),
    ("Z", r"\mathbf Z(X,V)", "Centrifugal, Coriolis, gyroscopic terms and weight"),
    (
        "H",
        r"\mathbf H(X)",
        (
            "What the actuators do to the platform, one column for every entry of "
            r"$`\boldsymbol\tau`$"
        ),
    ),
    (
        "Hk",
        r"\mathbf H_k(X)",
        (
            "What the constraints do to the platform, one column for every entry "
            r"of $`\boldsymbol\lambda`$"
        ),
    ),
)


def defines_blocks(derivation: Derivation, chapter: Chapter) -> bool:
    """Whether a chapter defines the blocks of M."""
    names = {
        getattr(o.value, "name", "")
        for o in derivation.outputs
        if o.array == "M" and not o.leg_type
    }
    return any(e.name in names for e in chapter.equations)


def block_statements(bundle: Bundle, printer: LatexPrinter) -> Iterator[Statement]:
    """One statement for each array."""
    derivation = bundle.derivation
    for array, latex, words in ARRAYS:
        outputs = [o for o in derivation.outputs if o.array == array]
        if outputs:
            grid = _Grid(outputs, printer.with_index())
            note = _index_note(derivation, outputs)
            yield Statement(f"**{array}.** {words}.{note}", grid.lines(latex))


def _index_note(derivation: Derivation, outputs: list[Output]) -> str:
    """What the indices of legs stand for."""
    letters = leg_indices(derivation)
    titles = {info.name: leg_title(info) for info in derivation.leg_types}
    present = dict.fromkeys(o.leg_type for o in outputs if o.leg_type)
    if not present:
        return ""
    words = " and ".join(f"{inline(letters[t])} for every {titles[t]} leg" for t in present)
    return f" Entries with an index stand there once for each leg: {words}."


class _Grid:
    """Cells by row and column block."""

    def __init__(self, outputs: list[Output], printer: LatexPrinter) -> None:
        self.printer = printer
        self.cells: dict[tuple[Key, Key], str] = {}
        self.per_leg: set[Key] = set()
        for output in outputs:
            self._place(output)

    def _place(self, output: Output) -> None:
        row, column = self._keys(output)
        text = self._cell(output.value, row_of_vector=bool(output.leg_rows and output.columns))
        self.cells[row, column] = text
        if output.mirrored:
            self.cells[column, row] = self._cell(
                output.value, row_of_vector=False, transposed=isinstance(output.value, Tensor)
            )

    def _keys(self, output: Output) -> tuple[Key, Key]:
        row: Key = output.leg_rows or tuple(place for _, place in output.rows)
        column: Key = output.leg_columns or tuple(place for _, place in output.columns)
        if output.leg_rows:
            self.per_leg.add(row)
        if output.leg_columns:
            self.per_leg.add(column)
        return row, column

    def _cell(self, value: Any, *, row_of_vector: bool, transposed: bool = False) -> str:
        if transposed or (row_of_vector and isinstance(value, Vector)):
            return self.printer.transposed(value)
        value = value if isinstance(value, Vector | Tensor) else sp.sympify(value)
        return self.printer.doprint(value)

    def lines(self, latex: str) -> tuple[str, ...]:
        """The matrix, one cell per line."""
        rows = sorted({row for row, _ in self.cells}, key=self._order)
        columns = sorted({column for _, column in self.cells}, key=self._order)
        dots = all(column in self.per_leg for column in columns) and columns != [()]
        lines = [f"{latex} =", r"\begin{bmatrix}"]
        for k, row in enumerate(rows):
            cells = [self.cells.get((row, column), self._zero(row, column)) for column in columns]
            if dots:
                cells = [r"\cdots", *(part for cell in cells for part in (cell, r"\cdots"))]
            lines += [cells[0], *(f"& {cell}" for cell in cells[1:])]
            if k < len(rows) - 1:
                lines[-1] += r" \\"
        return (*lines, r"\end{bmatrix}")

    def _zero(self, row: Key, column: Key) -> str:
        return "0" if row in self.per_leg and column in self.per_leg else r"\mathbf 0"

    def _order(self, key: Key) -> tuple[int, int]:
        return (key in self.per_leg, min(key, default=0))
