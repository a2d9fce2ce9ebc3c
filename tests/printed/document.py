"""A report as text: its tables, its equations in order, its block matrices."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

_ID = re.compile(r'<a id="([^"]+)"></a>\*\*\(\1\)\*\* (.*)')
_OF_LEG = re.compile(r" of an? (\S+( \d+)?) leg$")
Row = tuple[str, ...]


@dataclass
class Section:
    """The part of a leg type, or that of the platform.

    Attributes:
        title: the architecture, "" for the platform.
        legs: numbers of its legs, from 1.
        index: the letter that runs over them.
        given: (symbol, meaning, axes, value) of what is given.
        axes: label of axes -> symbol of the rotation, "" for base axes.
    """

    title: str = ""
    legs: tuple[int, ...] = ()
    index: str = ""
    given: list[Row] = field(default_factory=list)
    axes: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Printed:
    """A displayed formula.

    Attributes:
        id: of the equation; of a block matrix the array's name.
        words: the text above.
        formula: its lines, joined.
        title: architecture of the chapter's leg, or "".
    """

    id: str
    words: str
    formula: str
    title: str


@dataclass
class Document:
    """What a report says.

    Attributes:
        sections: by architecture.
        equations, blocks: in order.
        relations: of whole arrays, in order.
        orders: vector -> its entries in words.
    """

    sections: dict[str, Section] = field(default_factory=dict)
    equations: list[Printed] = field(default_factory=list)
    blocks: list[Printed] = field(default_factory=list)
    relations: list[Printed] = field(default_factory=list)
    orders: dict[str, str] = field(default_factory=dict)

    @property
    def types(self) -> list[Section]:
        """The sections of leg types."""
        return [s for s in self.sections.values() if s.title]

    def joints(self, vector: str) -> list[tuple[int, int]]:
        """(leg, joint) of the entries of a vector that come of joints."""
        return sorted((leg, j) for s, j in self._named(vector) for leg in s.legs)

    def owners(self, vector: str) -> list[str]:
        """Index of the legs of every joint that is named, in the order of the words."""
        return [s.index for s, _ in self._named(vector)]

    def _named(self, vector: str) -> list[tuple[Section, int]]:
        words = re.findall(r"of every (\S+(?: \d+)?) leg joints? ([^;]+)", self.orders[vector])
        return [
            (self.sections[title], int(j))
            for title, joints in words
            for j in re.findall(r"(\d+) \(", joints)
        ]


def read(text: str) -> Document:
    """Read a report."""
    made = Document({"": Section()})
    section, chapter, words = made.sections[""], "", ""
    lines = text.split("\n")
    for k, line in enumerate(lines):
        if line.startswith("## "):
            heading = re.fullmatch(r"## (\S+( \d+)?) legs", line)
            section = made.sections[""]
            if heading:
                section = made.sections[heading[1]] = Section(heading[1])
        elif line.startswith("### "):
            about = _OF_LEG.search(line)
            chapter = about[1] if about else ""
        elif section.title and (
            match := re.match(r"Legs? ([\d, to]+), of type .*; index \$`(.+?)`\$ in sums", line)
        ):
            section.legs, section.index = _numbers(match[1]), match[2]
        elif line.startswith("| "):
            _row(made, section, lines, k)
        elif line == "```math":
            end = lines.index("```", k)
            _formula(made, words, " ".join(lines[k + 1 : end]), chapter)
        words = line if line and not line.startswith("|") else words
    return made


def _numbers(text: str) -> tuple[int, ...]:
    found: list[int] = []
    for part in text.split(", "):
        first, _, last = part.partition(" to ")
        found += range(int(first), int(last or first) + 1)
    return tuple(found)


def _row(made: Document, section: Section, lines: list[str], k: int) -> None:
    """A row of a table that tells numbers, by the heading of the table."""
    head = k
    while lines[head - 1].startswith("| "):
        head -= 1
    if k < head + 2:
        return
    cells = tuple(cell.strip() for cell in lines[k].strip("|").split(" | "))
    if lines[head] == "| Symbol | Meaning | Unit | Axes of | Value |":
        section.given.append((_math(cells[0]), cells[1], cells[3], cells[4]))
    elif lines[head].startswith("| Axes of | "):
        found = re.match(r"\$`(.+?)`\$", cells[2])
        section.axes[cells[0]] = found[1] if found else ""
    elif lines[head] == "| Vector | Entries, in this order |":
        for name in re.findall(r"`(\w+)`", cells[0]):
            made.orders[name] = cells[1]


def _math(cell: str) -> str:
    return cell.removeprefix("$`").removesuffix("`$")


def _formula(made: Document, words: str, formula: str, chapter: str) -> None:
    if match := _ID.match(words):
        of_arrays = match[2].endswith("*Coupling, beyond the paper.*")
        found = made.relations if of_arrays else made.equations
        found.append(Printed(match[1], match[2], formula, chapter))
    elif match := re.match(r"\*\*`(\w+)`\.\*\*", words):
        made.blocks.append(Printed(match[1], words, formula, ""))
    elif words.startswith("**Inverse dynamics**"):
        made.blocks.append(Printed("required", words, formula.partition(r"\qquad")[2], ""))
