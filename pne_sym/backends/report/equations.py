"""The chapters of the derivation: numbered equations with law, reference, rules and remarks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.blocks import block_statements, defines_blocks
from pne_sym.backends.report.collected import Collected, collected_terms
from pne_sym.backends.report.given import GivenWriter
from pne_sym.backends.report.legforce import leg_force_statements
from pne_sym.backends.report.legs import solved
from pne_sym.backends.report.markdown import display, inline, matrix, table, unit
from pne_sym.backends.report.names import plain_names, printer_for
from pne_sym.backends.report.overview import unit_vectors
from pne_sym.backends.report.view import ChapterView, EquationView, Lines, Statement
from pne_sym.backends.report.words import SCREWS
from pne_sym.backends.terms import Term, join_terms
from pne_sym.derivation import (
    Chapter,
    Condition,
    Derivation,
    Equation,
    FailureStatus,
    ReciprocalBasis,
    names_in,
    rotations_by_place,
)
from pne_sym.vector import LinearForm


class ChapterWriter:
    """Turns chapters into views."""

    def __init__(self, bundle: Bundle, collected: Collected) -> None:
        self.bundle = bundle
        self.derivation: Derivation = bundle.derivation
        self.collected = collected
        self.plain = printer_for(self.derivation)
        self.bases = last_duals(self.derivation)
        self.given = GivenWriter(self.derivation, self.plain)
        self.rotations = rotations_by_place(self.derivation)
        self.along: dict[str, Any] = {}  # reciprocal vectors that are axes of slides
        for info in self.derivation.leg_types:
            self.along |= unit_vectors(self.derivation, info.name)

    def chapters(self) -> tuple[ChapterView, ...]:
        """All chapters, each with what it has led to."""
        found = [self.chapter(chapter) for chapter in self.derivation.chapters]
        guards = [self._guards(c) for c in self.derivation.chapters if self._measures(c)]
        return (*found[:-1], *guards, found[-1])

    def _guards(self, chapter: Chapter) -> ChapterView:
        """The lengths against which a leg type's singularities are measured."""
        title = chapter.title.replace("Geometry and inertia", "Lever arms")
        return ChapterView(
            f"chapter-{chapter.leg_type}-arms",
            plain_names(title, self.derivation),
            "A number that tells what is nearly singular; nothing else depends on it.",
            tuple(self.equation(e, self.plain) for e in self._measures(chapter)),
            (),
        )

    def _measures(self, chapter: Chapter) -> list[Equation]:
        """Equations of a leg's length that nothing in its chapters but conditions needs."""
        lengths = {n for b in self.derivation.bases for n in names_in(b.length)}
        own = [e for e in chapter.equations if chapter.leg_type and e.name in lengths]
        used = {n for e in own for n in e.uses}
        found = [e for e in chapter.equations if e in own or e.name in used]
        others = [
            n
            for c in self.derivation.chapters
            if c.leg_type == chapter.leg_type
            for e in c.equations
            if e not in found
            for part in (e.rhs, *e.forms)
            for n in names_in(part)
        ]
        return [] if {e.name for e in found} & set(others) else found

    def chapter(self, chapter: Chapter) -> ChapterView:
        """One chapter."""
        printer = self.plain if chapter.leg_type else self.plain.with_index()
        return ChapterView(
            f"chapter-{chapter.id}",
            plain_names(chapter.title, self.derivation),
            self._text(chapter),
            tuple(self.equation(e, printer) for e in self._in_order(chapter)),
            tuple(self._statements(chapter)),
        )

    def _text(self, chapter: Chapter) -> str:
        """The opening paragraph; of inverse kinematics also how each joint is found."""
        text = plain_names(chapter.text, self.derivation)
        info = next((t for t in self.derivation.leg_types if f"{t.name}-K" == chapter.id), None)
        return "\n".join([text, "", *(f"- {line}" for line in solved(info))]) if info else text

    def _in_order(self, chapter: Chapter) -> Iterator[Equation]:
        """The equations of a chapter, and rotations as soon as they are known."""
        later = self._measures(chapter)
        for k in range(len(chapter.equations) + 1):
            yield from (e for e in chapter.equations[k - 1 : k] if k and e not in later)
            yield from self.rotations.get((chapter.id, k), ())

    def _statements(self, chapter: Chapter) -> Iterator[Statement]:
        same = [c for c in self.derivation.chapters if c.leg_type == chapter.leg_type]
        of_forces = next((c for c in same if c.id == f"{chapter.leg_type}-N"), same[-1])
        if chapter.leg_type and chapter is of_forces:
            yield from leg_force_statements(
                self.derivation, self.collected, chapter.leg_type, self.plain
            )
        if defines_blocks(self.derivation, chapter):
            yield from block_statements(self.bundle, self.plain)

    def equation(self, equation: Equation, printer: LatexPrinter) -> EquationView:
        """One equation."""
        return EquationView(
            equation.id,
            self._headline(equation, printer),
            self._formula(equation, printer),
            self._steps(equation, printer),
            tuple(self._remarks(equation, printer)),
        )

    def _formula(self, equation: Equation, printer: LatexPrinter) -> tuple[str, ...]:
        lines = display(printer.doprint(equation.lhs), self._rows(equation, printer))
        basis = next((b for b in self.derivation.bases if b.duals[0] == equation.lhs), None)
        if basis is None or not basis.rows:
            return lines
        return (*lines, *velocity_matrix(basis, printer))

    def _rows(self, equation: Equation, printer: LatexPrinter) -> list[tuple[Term, ...]]:
        """The right-hand side and what it is equal to."""
        return list(dict.fromkeys(map(printer.terms, (equation.rhs, *equation.forms))))

    def _headline(self, equation: Equation, printer: LatexPrinter) -> str:
        origin = self.collected.origin.get(equation.id)
        quantity = self.derivation.notation[equation.name]
        part = self._part_headline(equation, origin, printer) if origin is not None else ""
        if part and quantity.leg_type:
            return f"{_capital(part)}."
        reference = f", {equation.reference}" if equation.reference else ""
        measure = f" [{unit(quantity.unit)}]" if quantity.unit not in ("-", "") else ""
        title = f"{_capital(equation.title)}{measure}" + (f": {part}" if part else "")
        return f"{title}. *{_capital(equation.law.value)}{reference}.*"

    def _part_headline(self, equation: Equation, origin: Equation, printer: LatexPrinter) -> str:
        form = self.collected.forms.get(origin.name)
        part = part_of(equation, origin, form, printer)
        return f"{part} ([{origin.id}](#{origin.id}))"

    def _steps(self, equation: Equation, printer: LatexPrinter) -> Lines | None:
        if not equation.steps:
            return None
        rows = (
            (step.rule, *(inline(printer.doprint(e)) for e in (step.before, step.after)))
            for step in equation.steps
        )
        return table(("Rule", "before", "after"), dict.fromkeys(rows))

    def _remarks(self, equation: Equation, printer: LatexPrinter) -> Iterator[str]:
        form = self.collected.forms.get(equation.name)
        if form is not None and form.coefficients:
            terms = collected_terms(form, printer)
            if terms not in self._rows(equation, printer):
                text = f"{printer.doprint(equation.lhs)} = {join_terms(terms)}"
                yield f"Collected by Rules I and II: {inline(text)}."
        if (axis := self.along.get(equation.name)) is not None:
            yield (
                f"It is {inline(printer.doprint(axis))} itself, the unit vector along the leg: "
                "joints that turn move the connection point across it."
            )
        if any(b.rows and b.duals[0] == equation.lhs for b in self.derivation.bases):
            yield SCREWS
        body = next((b for b in self.derivation.body_frames if b.equation is equation), None)
        if body is not None and (fixed := self.given.fixed_in(body)):
            yield fixed
        for condition in equation.conditions:
            yield self._condition(equation, condition, printer)
        if equation.name in self.bases:
            yield basis_condition(self.bases[equation.name], printer)

    def _condition(self, equation: Equation, condition: Condition, printer: LatexPrinter) -> str:
        value = equation.lhs if condition.value == equation.rhs else condition.value
        text = printer.doprint(value)
        if condition.status is FailureStatus.UNREACHABLE:
            return f"**Out of reach** where {inline(text + ' < 0')}."
        return f"**Singular** where {inline(text)} vanishes."


def part_of(
    equation: Equation, origin: Equation, form: LinearForm | None, printer: LatexPrinter
) -> str:
    """What a coefficient or a remainder is of."""
    name = inline(printer.doprint(origin.lhs))
    for unknown, value in form.coefficients.items() if form else ():
        if value == equation.lhs:
            return f"coefficient of {inline(printer.doprint(unknown))} in {name}"
    return f"remainder of {name}"


def last_duals(derivation: Derivation) -> dict[str, ReciprocalBasis]:
    """By the name of the last reciprocal vector that is used: the basis."""
    defined = [e.name for e in derivation.equations()]
    found = {}
    for basis in derivation.bases:
        names = [d.name for d in (*basis.duals, *(m for row in basis.moment_duals for m in row))]
        used = [name for name in defined if name in names]
        if used:
            found[used[-1]] = basis
    return found


def velocity_matrix(basis: ReciprocalBasis, printer: LatexPrinter) -> tuple[str, ...]:
    """The matrix of the joints' velocities where a leg transmits moments."""
    rows = [[printer.doprint(v) for v in row] for row in (basis.vectors, *basis.rows)]
    return matrix(r",\qquad \mathcal V =", rows)


def basis_condition(basis: ReciprocalBasis, printer: LatexPrinter) -> str:
    """Where the reciprocal vectors of a leg do not exist."""
    vectors = [printer.doprint(v) for v in basis.vectors]
    if basis.rows:
        return r"**Singular** where the determinant of $`\mathcal V`$ vanishes."
    if len(vectors) == 3:
        volume = rf"{vectors[0]}\cdot({vectors[1]}\times {vectors[2]})"
    else:
        volume = r"\times ".join(vectors)
    return (
        f"**Singular** where {inline(volume)} vanishes: the velocity vectors are not independent."
    )


def index_rows(
    derivation: Derivation, printer: LatexPrinter, collected: Collected
) -> Iterator[tuple[str, ...]]:
    """Every defined symbol with its meaning, unit and equation."""
    rotations = rotations_by_place(derivation)
    for chapter in derivation.chapters:
        used = printer if chapter.leg_type else printer.with_index()
        places = range(len(chapter.equations) + 1)
        turns = [e for k in places for e in rotations.get((chapter.id, k), ())]
        for equation in (*turns, *chapter.equations):
            quantity: Any = derivation.notation[equation.name]
            origin = collected.origin.get(equation.id)
            form = collected.forms.get(origin.name) if origin else None
            yield (
                inline(used.doprint(equation.lhs)),
                part_of(equation, origin, form, used) if origin else quantity.meaning,
                unit(quantity.unit),
                f"[{equation.id}](#{equation.id})",
            )


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
