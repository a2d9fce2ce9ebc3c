"""Which statements of the generated code belong to an equation: its id stands in a comment."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.target import Syntax
from pne_sym.derivation import Derivation, Equation, names_in
from pne_sym.program.ir import Block, Program
from pne_sym.program.public import Apply
from pne_sym.review.plain import plain

_ID = re.compile(r"\s*\(([A-Za-z0-9_-]+)\)")
_NONE = "no statement of its own"


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
    return tuple(Passage(tuple(names), lines) for lines, names in found.items())


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
            begun = line.lstrip().startswith(syntax.comments[0])
            is_open = begun and bool(syntax.closing) and syntax.closing not in line
        elif head:
            lines.append(line.strip())
    if head:
        yield function, head, tuple(lines)


def program_passages(bundle: Bundle, equation: str | None) -> tuple[Passage, ...]:
    """Statements of the scalar program that belong to an equation, or all with their ids."""
    in_function = {
        name: tuple(
            text if equation else f"{text}    ({own})"
            for block in blocks
            for own, _, text in statements_of(block)
            if equation in (None, own)
        )
        for name, blocks in places(bundle.program)
    }
    return _grouped(in_function)


def step_passages(bundle: Bundle, relation: str) -> tuple[Passage, ...]:
    """Steps of public functions that belong to a relation between arrays."""
    in_function = {
        f.name: tuple(
            f"{step.targets[0].name} = {step.operation}({', '.join(o.name for o in step.operands)})"
            for step in f.steps
            if isinstance(step, Apply) and step.equation == relation
        )
        for f in bundle.program.public
    }
    return _grouped(in_function)


def places(program: Program) -> list[tuple[str, tuple[Block, ...]]]:
    """Where statements stand, in order of computation: function and blocks."""
    functions = [(name, f.blocks) for name, f in program.functions.items()]
    return [("prepare", program.prepare), *functions]


def statements_of(block: Block) -> Iterator[tuple[str, str, str]]:
    """(equation, target, text) of assignments, sums and stores."""
    for a in block.assignments:
        yield a.equation, str(a.target), f"{a.target} = {plain(a.expr)}"
    for a in block.sums:
        yield a.equation, str(a.target), f"{a.target} += {plain(a.expr)}"
    for s in block.stores:
        place = f"{s.array}[{s.row}{'' if s.column is None else f', {s.column}'}]"
        value = "0" if s.value is None else plain(s.value)
        yield s.equation, place, f"{place} = {value}"


def why_without(bundle: Bundle, equation: Equation) -> str:
    """Why no statement is an equation's: what its components are, and where it went."""
    program, derivation = bundle.program, bundle.derivation
    stated = {own for _, blocks in places(program) for b in blocks for own, *_ in statements_of(b)}
    into = _users(derivation, equation.name, stated)
    used = f"used by {', '.join(into)}" if into else "used by the outputs alone"
    if equation.name not in program.lowered:
        return f"{_NONE}: it is never formed, what needs it is formed directly; {used}"
    frame, atoms = program.lowered[equation.name]
    shown = ", ".join(plain(atom) for atom in atoms)
    where = f" in the frame {frame}" if frame not in ("", "base") else ""
    if not any(atom.free_symbols for atom in atoms):
        return f"{_NONE}: it is {shown}{where}, whatever the state; {used}"
    made = {str(a.target) for _, bs in places(program) for b in bs for a in b.assignments}
    if any(str(s) not in made for atom in atoms for s in atom.free_symbols):
        return f"{_NONE}: written where it is used, in {', '.join(into) or 'outputs'}"
    return f"{_NONE}: it is {shown}{where}, values that are there already; {used}"


def _users(derivation: Derivation, name: str, stated: set[str]) -> list[str]:
    """The next equations that use a quantity and have statements."""
    equations = tuple(derivation.equations())
    reached, found = {name}, []
    for e in equations:
        parts = (e.rhs, *e.forms)
        if e.name not in reached and any(names_in(part) & reached for part in parts):
            if e.id in stated:
                found.append(e.id)
            else:
                reached.add(e.name)
    return found
