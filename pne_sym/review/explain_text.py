"""Explanations as text for the terminal."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterable, Iterator, Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.registry import BACKENDS
from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Manipulator
from pne_sym.review.code import Passage, passages, program_passages
from pne_sym.review.explain import Explanation, Related, explain, find_equation
from pne_sym.review.plain import plain

STAGES = ("spec", "derivation", "program", "c", "numpy")
_SUFFIX = {"numpy": ".py", "c": ".c"}
_WIDTH = 98


class NotGeneratedError(ValueError):
    """A stage that this version generates nothing for."""


def spec_text(manipulator: Manipulator) -> str:
    """The full form of a specification as JSON; itself a specification that can be read."""
    return json.dumps(to_full_form(manipulator), indent=1, ensure_ascii=False)


def contents(bundle: Bundle) -> Iterator[str]:
    """Chapters and equations."""
    for chapter in bundle.derivation.chapters:
        yield f"{chapter.id}  {chapter.title}"
        for equation in chapter.equations:
            formula = f"{equation.name} = {plain(equation.rhs)}"
            yield from _hanging(f"  {equation.id:<9} ", formula)
        yield ""


def stage_lines(
    bundle: Bundle, stage: str | None, wanted: str | None, *, transitively: bool = False
) -> Iterator[str]:
    """What `pne-gen explain` shows of a stage other than the specification.

    Args:
        bundle: the compiled manipulator.
        stage: one of `STAGES` but "spec"; None for the derivation and the scalar program.
        wanted: id or name of an equation; None for all.
        transitively: follow uses and users to the end.

    Raises:
        UnknownEquationError: there is no such equation.
        NotGeneratedError: nothing is generated for the stage.
    """
    if wanted is None:
        yield from _whole(bundle, stage)
        return
    if stage in (None, "derivation"):
        yield from explanation(explain(bundle, wanted, transitively=transitively))
    if stage == "derivation":
        return
    equation = find_equation(bundle.derivation, wanted)
    if stage in _SUFFIX:
        found = passages(_file(bundle, stage), equation.id)
    else:
        found = program_passages(bundle, equation.id)
    if stage is None:
        yield ""
        yield "statements of the scalar program" if found else _no_statements(equation.id)
    elif not found:
        yield _no_statements(equation.id)
    yield from _passages(found)


def _no_statements(equation: str) -> str:
    return f"no statement of its own: what uses {equation} is formed directly"


def _whole(bundle: Bundle, stage: str | None) -> Iterator[str]:
    if stage in (None, "derivation"):
        yield from contents(bundle)
    elif stage in _SUFFIX:
        yield from _file(bundle, stage).rstrip("\n").split("\n")
    else:
        yield from _passages(program_passages(bundle, None))


def _file(bundle: Bundle, stage: str) -> str:
    """Text of the file that a back end emits for a language."""
    for backend in BACKENDS:
        if backend.name == stage:
            return backend.emit(bundle)[f"{bundle.name}{_SUFFIX[stage]}"]
    raise NotGeneratedError(f"nothing is generated for the stage {stage!r} in this version")


def _passages(found: Sequence[Passage]) -> Iterator[str]:
    for passage in found:
        yield from _hanging("  in ", ", ".join(passage.functions))
        yield from (f"    {line}" for line in passage.lines)


def explanation(told: Explanation) -> Iterator[str]:
    """An equation with its law, what it uses and what uses it."""
    equation, quantity = told.equation, told.quantity
    unit = "" if quantity.unit in ("", "-") else f" [{quantity.unit}]"
    yield f"({equation.id}) {equation.title}{unit}"
    yield f"  in chapter: {told.chapter}"
    yield ""
    yield from _hanging("  ", told.formula)
    for form in told.forms:
        yield from _hanging(f"  {' ' * len(equation.name)} = ", form)
    yield ""
    reference = f"; {equation.reference}" if equation.reference else ""
    yield f"  law:   {equation.law.value}{reference}"
    yield f"  LaTeX: {told.latex}"
    if equation.note:
        yield from _hanging("  note:  ", equation.note)
    for condition in equation.conditions:
        must = ">= 0" if condition.trouble.value == "unreachable" else "not near 0"
        yield f"  {condition.trouble.value} unless {plain(condition.value)} is {must}"
    for step in equation.steps:
        yield from _hanging(f"  {step.rule.name}: ", f"{plain(step.before)} -> {plain(step.after)}")
    yield from _list("uses", told.uses)
    yield from _list("used by", told.used_by)


def _list(title: str, related: Iterable[Related]) -> Iterator[str]:
    rows = tuple(related)
    yield ""
    yield f"{title}: nothing" if not rows else title
    ids = max((len(r.id) for r in rows), default=0)
    names = max((len(r.name) for r in rows), default=0)
    for r in rows:
        yield f"  {r.id:<{ids}}  {r.name:<{names}}  {r.meaning}"


def _hanging(start: str, text: str) -> list[str]:
    """A text that may take more lines, indented under its start."""
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=start,
        subsequent_indent=" " * len(start),
        break_long_words=False,
        break_on_hyphens=False,
    )
