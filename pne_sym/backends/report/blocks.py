"""M, Z, H and Hk as block matrices, from the places of the derivation's outputs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.coupling import coupling_statements, of_rotors
from pne_sym.backends.report.markdown import inline, matrix
from pne_sym.backends.report.names import leg_indices, leg_title
from pne_sym.backends.report.view import Statement
from pne_sym.derivation import Chapter, Derivation, Output
from pne_sym.vector import Tensor, Vector


class Key(NamedTuple):
    """A block of rows or columns; what every leg has its own of stands last."""

    per_leg: bool
    places: tuple[int, ...]


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
    (
        "constraints",
        r"\boldsymbol\chi(X)",
        "Loop-closure residuals, zero where the platform can be (Eq. 37)",
    ),
    (
        "constraint_bias",
        r"\boldsymbol\iota(X,V)",
        "What the second derivative of the constraints holds besides the acceleration",
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
            note = _index_note(derivation, outputs)
            beside = of_rotors(derivation, array)
            formula = (*block_matrix(outputs, latex, printer), *beside)
            yield Statement(f"**`{array}`.** {words}.{note}", formula)
    yield from coupling_statements(derivation, lambda o, latex: block_matrix(o, latex, printer))
    if bundle.coordinates.extras:
        yield _partition(bundle)


def _partition(bundle: Bundle) -> Statement:
    """The blocks of Eqs. 6 and 7 by their names."""
    joints = [bundle.manipulator.legs[i].joints[j] for i, j in bundle.coordinates.extras]
    actuated = {joint.actuated for joint in joints}
    equations = " and ".join(
        words
        for kind, words in ((True, "Eq. 6, the paper's θ"), (False, "Eq. 7, the paper's φ"))
        if kind in actuated
    )
    actuators = r"\mathbf H_y" if True in actuated else r"\mathbf 0"
    return Statement(
        f"**Partition.** $`x`$ marks the platform's rows and columns, $`y`$ those of the extra "
        f"coordinates ({equations}), which come after them:",
        (
            r"\begin{bmatrix}\mathbf M_{xx} & \mathbf M_{xy} \\",
            r"\mathbf M_{yx} & \mathbf M_{yy}\end{bmatrix}",
            r"\begin{bmatrix}\mathbf A_x \\ \ddot{\mathbf y}\end{bmatrix}",
            r"+ \begin{bmatrix}\mathbf Z_x \\ \mathbf Z_y\end{bmatrix}",
            rf"= \begin{{bmatrix}}\mathbf H_x \\ {actuators}\end{{bmatrix}}\boldsymbol\tau",
            r"+ \begin{bmatrix}\mathbf F_{\mathrm{ext}} \\ \mathbf 0\end{bmatrix}",
        ),
    )


def block_matrix(outputs: Sequence[Output], latex: str, printer: LatexPrinter) -> tuple[str, ...]:
    """An array as a block matrix, one cell per line."""
    return _Grid(outputs, printer.with_index()).lines(latex)


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

    def __init__(self, outputs: Sequence[Output], printer: LatexPrinter) -> None:
        self.printer = printer
        self.cells: dict[tuple[Key, Key], str] = {}
        for output in outputs:
            self._place(output)

    def _place(self, output: Output) -> None:
        row, column = _key(output.leg_rows, output.rows), _key(output.leg_columns, output.columns)
        along_row = bool(output.leg_rows and output.columns)
        self.cells[row, column] = self._cell(output.value, transposed=along_row)
        if output.mirrored:
            turned = isinstance(output.value, Tensor)
            self.cells[column, row] = self._cell(output.value, transposed=turned)

    def _cell(self, value: Any, *, transposed: bool) -> str:
        if transposed and isinstance(value, Vector | Tensor):
            return self.printer.transposed(value)
        return self.printer.doprint(value)

    def lines(self, latex: str) -> tuple[str, ...]:
        """The matrix, one cell per line."""
        rows = sorted({row for row, _ in self.cells})
        columns = sorted({column for _, column in self.cells})
        dots = all(column.per_leg for column in columns)
        cells = [[self.cells.get((r, c), _zero(r, c)) for c in columns] for r in rows]
        if dots:
            cells = [[r"\cdots", *(x for cell in row for x in (cell, r"\cdots"))] for row in cells]
        return matrix(f"{latex} =", cells)


def _key(per_leg: tuple[int, ...], places: tuple[tuple[int, int], ...]) -> Key:
    if per_leg:
        return Key(per_leg=True, places=per_leg)
    return Key(per_leg=False, places=tuple(place for _, place in places))


def _zero(row: Key, column: Key) -> str:
    return "0" if row.per_leg and column.per_leg else r"\mathbf 0"
