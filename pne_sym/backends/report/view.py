"""What the report's templates print: ready strings, nothing to compute."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Table:
    """A table; every row is a finished line.

    Attributes:
        head: the heading line.
        rule: the line under it.
        rows: one line each.
    """

    head: str
    rule: str
    rows: tuple[str, ...]


@dataclass(frozen=True)
class EquationView:
    """A numbered equation.

    Attributes:
        id: as in the comments of the code.
        headline: what it says, law, reference and unit.
        formula: lines of the displayed formula.
        steps: Rules I and II before and after, or None.
        remarks: sentences below.
    """

    id: str
    headline: str
    formula: tuple[str, ...]
    steps: Table | None
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class Statement:
    """A displayed formula that sums up, with its sentence."""

    text: str
    formula: tuple[str, ...]


@dataclass(frozen=True)
class ChapterView:
    """A chapter of the derivation.

    Attributes:
        anchor: target of links.
        title: of the chapter.
        text: introduction.
        equations: in order.
        statements: what the chapter has led to.
    """

    anchor: str
    title: str
    text: str
    equations: tuple[EquationView, ...]
    statements: tuple[Statement, ...]


@dataclass(frozen=True)
class LegView:
    """A leg type: which legs, its structure, axes, notation.

    Attributes:
        title: architecture notation.
        legs: the sentence that tells which legs are of this type.
        joints: structure, joint by joint.
        closing: the platform joint, and the assembly branches.
        frames: axes of its links.
        notation: symbols that are given.
    """

    title: str
    legs: str
    joints: Table
    closing: tuple[str, ...]
    frames: Table
    notation: Table


@dataclass(frozen=True)
class ReportView:
    """The whole document.

    Attributes:
        name: of the model.
        title: safe in Markdown.
        summary: one paragraph.
        cases: the cases of the paper's section 3 that apply.
        sizes: dimensions.
        orders: order of the entries of X, V, tau, q ...
        equation: the equation of motion.
        contents: links to the chapters.
        conventions: sentences.
        marks: notation that is general.
        laws: why equations hold.
        frames: axes of base and platform.
        notation: symbols that are given, of the platform.
        parameters: where the live parameters stand in the full form.
        places: what i in paths stands for.
        overview: forces of the legs, blocks of the equation of motion.
        legs: leg types.
        chapters: of the derivation.
        functions: how the functions use the equations.
        failures: impossible states.
        counts: operations per function.
        parts: operations per part of a function.
        index: all defined symbols with their equations.
    """

    name: str
    title: str
    summary: str
    cases: tuple[str, ...]
    sizes: Table
    orders: Table
    equation: tuple[str, ...]
    contents: tuple[str, ...]
    conventions: tuple[str, ...]
    marks: Table
    laws: Table
    frames: Table
    notation: Table
    parameters: Table
    places: str
    overview: tuple[Statement, ...]
    legs: tuple[LegView, ...]
    chapters: tuple[ChapterView, ...]
    functions: tuple[Statement, ...]
    failures: tuple[str, ...]
    counts: Table
    parts: Table
    index: Table
