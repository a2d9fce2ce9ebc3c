"""Which statements of the generated code belong to an equation: its id stands in a comment."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.review.plain import plain

_HEAD = re.compile(r"\s*(?:#|//|/\*)\s*\(([A-Za-z0-9_-]+)\)")
_COMMENT = re.compile(r"\s*(?:#|//|/\*)")
_PYTHON_FUNCTION = re.compile(r"def (\w+)\(")
_C_FUNCTION = re.compile(r"[A-Za-z_][\w\s*]*?\b(\w+)\(")
_LAST = re.compile(r"\s*(?:ok\b|return\b|shared\b|def\b|[{}]|#if|#end|for\b|if\b)|\s*$")


@dataclass(frozen=True)
class Passage:
    """Lines of code that compute one equation.

    Attributes:
        functions: where the lines stand, in order; the same in each.
        lines: without indentation.
    """

    functions: tuple[str, ...]
    lines: tuple[str, ...]


def passages(text: str, equation: str) -> tuple[Passage, ...]:
    """The statements under an equation's comment in a Python or C file."""
    in_function: dict[str, list[str]] = {}
    for function, head, lines in _runs(text):
        if head == equation:
            in_function.setdefault(function, []).extend(lines)
    return _grouped({function: tuple(lines) for function, lines in in_function.items()})


def _grouped(in_function: Mapping[str, tuple[str, ...]]) -> tuple[Passage, ...]:
    """Functions with the same lines told together."""
    found: dict[tuple[str, ...], list[str]] = {}
    for function, lines in in_function.items():
        if lines:
            found.setdefault(lines, []).append(function)
    return tuple(Passage(tuple(places), lines) for lines, places in found.items())


def _runs(text: str) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """(function, equation id, statements) of every run of statements."""
    function, head, lines = "", "", list[str]()
    for line in text.split("\n"):
        started = _PYTHON_FUNCTION.match(line) or _C_FUNCTION.match(line)
        commented = _HEAD.match(line)
        if started or commented or _COMMENT.match(line) or _LAST.match(line):
            if head:
                yield function, head, tuple(lines)
            head, lines = (commented.group(1) if commented else ""), []
            function = started.group(1) if started else function
        elif head:
            lines.append(line.strip())
    if head:
        yield function, head, tuple(lines)


def program_passages(bundle: Bundle, equation: str | None) -> tuple[Passage, ...]:
    """Statements of the scalar program that belong to an equation, or all with their ids."""
    places = [("prepare", bundle.program.prepare)]
    places += [(name, f.blocks) for name, f in bundle.program.functions.items()]
    in_function = {
        name: tuple(
            f"{a.target} = {plain(a.expr)}" + ("" if equation else f"    ({a.equation})")
            for block in blocks
            for a in block.assignments
            if equation in (None, a.equation)
        )
        for name, blocks in places
    }
    return _grouped(in_function)
