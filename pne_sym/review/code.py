"""Which statements of the generated code belong to an equation: its id stands in a comment."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.target import Syntax
from pne_sym.review.plain import plain

_ID = re.compile(r"\s*\(([A-Za-z0-9_-]+)\)")


@dataclass(frozen=True)
class Passage:
    """Lines of code that compute one equation.

    Attributes:
        functions: where the lines stand, in order; the same in each.
        lines: without indentation.
    """

    functions: tuple[str, ...]
    lines: tuple[str, ...]


def passages(texts: Mapping[str, str], equation: str, syntax: Syntax) -> tuple[Passage, ...]:
    """The statements under an equation's comment.

    Args:
        texts: files of code by their paths.
        equation: its id.
        syntax: of the code.
    """
    in_function: dict[str, list[str]] = {}
    for text in texts.values():
        for function, head, lines in _runs(text, syntax):
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


def _runs(text: str, syntax: Syntax) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """(function, equation id, statements) of every run of statements."""
    function_head, ends = re.compile(syntax.function), re.compile(rf"\s*(?:{syntax.ends})|\s*$")
    comment = re.compile(rf"\s*(?:{'|'.join(map(re.escape, syntax.comments))})")
    function, head, lines, is_open = "", "", list[str](), False
    for line in text.split("\n"):
        if is_open:
            is_open = syntax.closing not in line
            continue
        started, commented = function_head.match(line), comment.match(line)
        if started or commented or ends.match(line):
            if head:
                yield function, head, tuple(lines)
            named = _ID.match(line, commented.end()) if commented else None
            head, lines = (named.group(1) if named else ""), []
            function = started.group(1) if started else function
            is_open = _stays_open(line, syntax)
        elif head:
            lines.append(line.strip())
    if head:
        yield function, head, tuple(lines)


def _stays_open(line: str, syntax: Syntax) -> bool:
    """Whether a comment that begins a line goes on in the next."""
    begun = line.lstrip().startswith(syntax.comments[0])
    return bool(syntax.closing) and begun and syntax.closing not in line


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
