"""What a comparison of two versions of a model finds: plain data."""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Any


class Verdict(enum.StrEnum):
    """How something compares."""

    IDENTICAL = "identical text"
    EQUAL = "different text, equal values"
    DIFFERENT = "different values"
    FOLLOWS = "follows from an equation before"
    CHANGED = "different text"
    ADDED = "added"
    REMOVED = "removed"
    NOT_COMPARED = "not compared"


def by_text(before: str, after: str) -> tuple[Verdict, str, str]:
    """How two texts compare, of which one may be empty; then both, unless they are the same."""
    if before == after:
        return Verdict.IDENTICAL, "", ""
    alone = Verdict.REMOVED if before else Verdict.ADDED
    return Verdict.CHANGED if before and after else alone, before, after


@dataclass(frozen=True)
class Gap:
    """The largest relative difference of a quantity.

    Attributes:
        size: |after - before| over the largest entry at any of the states; infinite
            where only one of the two has a value, or the shapes differ.
        where: entry, and leg where every leg has its own, such as "[2] of leg 1".
        before: value there.
        after: value there.
    """

    size: float
    where: str
    before: float
    after: float


@dataclass(frozen=True)
class BlockDifference:
    """A function of the generated code: M, Z, H, inverse kinematics ..."""

    name: str
    verdict: Verdict
    gap: Gap | None = None
    note: str = ""


@dataclass(frozen=True)
class EquationDifference:
    """One equation.

    Attributes:
        id: before, or after where it is new.
        name: of the quantity (of a report without its derivation: its LaTeX).
        title: in words.
        leg_type: of its chapter; empty for the platform.
        verdict: how it compares, given equal values of what it uses.
        before, after: formulas; empty where there is none.
        gap: largest relative difference, given equal values of what it uses.
        note: new id or name, changed law or conditions, the form that differs.
    """

    id: str
    name: str
    title: str
    leg_type: str
    verdict: Verdict
    before: str = ""
    after: str = ""
    gap: Gap | None = None
    note: str = ""


@dataclass(frozen=True)
class Change:
    """A parameter, coordinate or other part of the interface that changed.

    Attributes:
        kind: "added", "removed", "renamed" or "changed".
        what: "parameter gravity", "coordinates X" ...
        before, after: as text.
    """

    kind: str
    what: str
    before: str = ""
    after: str = ""


@dataclass(frozen=True)
class Edit:
    """An entry of the specification that was edited.

    Attributes:
        words: what was done, for people: "leg type rpr, joint 1 (R): axis flipped".
        path: where it stands: in the author's file, or in the full form.
        before, after: as text; empty where there is none.
    """

    words: str
    path: str
    before: str = ""
    after: str = ""


@dataclass(frozen=True)
class Effect:
    """What a change does to a quantity that engineers design by.

    Attributes:
        what: "required force of leg 1", "least eigenvalue of M" ...
        where: "at home", or at which states.
        before, after: values; None where there is no counterpart.
        changed: whether they differ by more than rounding.
        unit: of the values, or empty.
        note: the largest change where there are several states.
    """

    what: str
    where: str
    before: float | None
    after: float | None
    changed: bool
    unit: str = ""
    note: str = ""


@dataclass(frozen=True)
class StatementDifference:
    """The first statement of the program that differs while the derivation does not.

    Attributes:
        equation: id of its equation.
        target: name of the value.
        function: where it stands.
        before, after: the statement.
        count: how many statements differ in all.
    """

    equation: str
    target: str
    function: str
    before: str
    after: str
    count: int


@dataclass(frozen=True)
class Contradiction:
    """The first statement of a program whose value is not what its own derivation says.

    Attributes:
        version: which of the two versions has it.
        equation: id of its equation.
        target: name of the value, or place of a stored entry.
        function: where it stands.
        means: what it is called: the component of which quantity, in which frame.
        line: "stewart.c:1512", or empty.
        found, expected: its value at a state, and what the equation says.
    """

    version: str
    equation: str
    target: str
    function: str
    means: str
    line: str
    found: float
    expected: float


@dataclass(frozen=True)
class OperationChange:
    """Operation counts of a function: mul, add, div, sqrt, trig."""

    function: str
    before: tuple[int, ...]
    after: tuple[int, ...]


@dataclass(frozen=True)
class FileDifference:
    """A file that is not the same in both versions, to the byte.

    Attributes:
        path: below the folder.
        where: "line 12", "only after" ...
        before, after: the first lines that differ, shortened.
        accounted: both texts are what this pne-gen prints from the specifications that are
            compared; of any other file the difference counts.
    """

    path: str
    where: str
    before: str = ""
    after: str = ""
    accounted: bool = False


@dataclass(frozen=True)
class Deviation:
    """Where a folder is not what this pne-gen prints from its own manifest.

    Attributes:
        version: what the user called the folder.
        path: a file; empty where the reason is not in one.
        where: "line 12", or the reason.
        printed, found: the first lines that differ, shortened.
    """

    version: str
    path: str
    where: str
    printed: str = ""
    found: str = ""


@dataclass(frozen=True)
class Comparison:
    """Two versions of a model compared.

    Attributes:
        before, after: what was compared.
        tolerance: relative; values nearer than this are equal.
        samples: (parameter sets, states in all) at which values were compared.
        blocks: functions of the generated code.
        equations: all equations in order of derivation, identical ones too.
        interface: parameters, coordinates and defaults that changed.
        operations: counts that changed.
        notes: what limits the comparison.
        files: those of generated folders that differ.
        identical_files: how many are equal to the byte.
        deviations: where the folders are not what this pne-gen prints.
        not_compared: why values were not compared; empty where they were, or need not be.
        specification: what was edited; None where a version does not hold its specification.
        effects: on what engineers design by, each version at its own defaults.
        statement: where the programs of one derivation first differ.
        contradictions: of versions whose code does not compute what their derivation says.
    """

    before: str
    after: str
    tolerance: float
    samples: tuple[int, int] = (0, 0)
    blocks: tuple[BlockDifference, ...] = ()
    equations: tuple[EquationDifference, ...] = ()
    interface: tuple[Change, ...] = ()
    operations: tuple[OperationChange, ...] = ()
    notes: tuple[str, ...] = ()
    files: tuple[FileDifference, ...] = ()
    identical_files: int = 0
    deviations: tuple[Deviation, ...] = ()
    not_compared: str = ""
    specification: tuple[Edit, ...] | None = None
    effects: tuple[Effect, ...] = ()
    statement: StatementDifference | None = None
    contradictions: tuple[Contradiction, ...] = ()

    @property
    def equal(self) -> bool:
        """Whether all was compared, and values and interface are the same.

        Texts need not be, where both are this pne-gen's own.
        """
        bad = (Verdict.DIFFERENT, Verdict.ADDED, Verdict.REMOVED, Verdict.NOT_COMPARED)
        return (
            not self.not_compared
            and all(f.accounted for f in self.files)
            and not self.interface
            and not any(b.verdict in bad for b in self.blocks)
            and not any(e.verdict is Verdict.DIFFERENT for e in self.equations)
        )

    @property
    def origins(self) -> tuple[EquationDifference, ...]:
        """Equations that differ though what they use is equal; the first comes first."""
        return tuple(e for e in self.equations if e.verdict is Verdict.DIFFERENT)

    @property
    def structure(self) -> tuple[EquationDifference, ...]:
        """Equations that are new, gone, or say something else."""
        kinds = (Verdict.DIFFERENT, Verdict.CHANGED, Verdict.ADDED, Verdict.REMOVED)
        return tuple(e for e in self.equations if e.verdict in kinds)

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON; equations of identical text are counted, not listed."""
        listed = [e for e in self.equations if e.verdict is not Verdict.IDENTICAL]
        return {
            "before": self.before,
            "after": self.after,
            "equal": self.equal,
            "specification": [_plain(e) for e in self.specification or ()],
            "tolerance": self.tolerance,
            "samples": {"parameter_sets": self.samples[0], "states": self.samples[1]},
            "blocks": [_plain(b) for b in self.blocks],
            "first_difference": self.origins[0].id if self.origins else None,
            "first_statement": _plain(self.statement) if self.statement else None,
            "contradictions": [_plain(c) for c in self.contradictions],
            "identical_equations": len(self.equations) - len(listed),
            "equations": [_plain(e) for e in listed],
            "effects": [_plain(e) for e in self.effects],
            "interface": [_plain(c) for c in self.interface],
            "operations": [_plain(o) for o in self.operations],
            "notes": list(self.notes),
            "files": [_plain(f) for f in self.files],
            "identical_files": self.identical_files,
            "deviations": [_plain(d) for d in self.deviations],
            "not_compared": self.not_compared,
        }


def _plain(item: Any) -> dict[str, Any]:
    """A dataclass as plain data, without what is empty; infinity as a text."""
    found: dict[str, Any] = {}
    for name, value in vars(item).items():
        if isinstance(value, Gap):
            found[name] = {k: _number(v) for k, v in vars(value).items()}
        elif value not in ("", None):
            found[name] = str(value) if isinstance(value, enum.Enum) else _number(value)
    return found


def _number(value: Any) -> Any:
    return str(value) if isinstance(value, float) and not abs(value) < float("inf") else value
