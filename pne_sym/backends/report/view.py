"""What the report's templates print: ready strings, nothing to compute."""

from __future__ import annotations

from typing import NamedTuple

Lines = tuple[str, ...]
"""Of a formula, or of a table: heads of columns, the rule under them, rows."""


class EquationView(NamedTuple):
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
    formula: Lines
    steps: Lines | None
    remarks: Lines


class Statement(NamedTuple):
    """A displayed formula that sums up, with its sentence."""

    text: str
    formula: Lines


class ChapterView(NamedTuple):
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


class LegView(NamedTuple):
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
    joints: Lines
    closing: Lines
    frames: Lines
    notation: Lines
