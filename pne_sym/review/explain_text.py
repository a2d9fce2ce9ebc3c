"""Explanations as text for the terminal."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence

from pne_sym.backends import registry
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.emission import emit_target
from pne_sym.backends.target import Syntax, Target
from pne_sym.derivation import Equation
from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Manipulator
from pne_sym.review.code import (
    Passage,
    passages,
    program_passages,
    step_passages,
    why_without,
)
from pne_sym.review.equation_text import relation_formula
from pne_sym.review.explain import Explanation, Related, explain, find_equations, find_relation
from pne_sym.review.interface_text import wrapped
from pne_sym.review.plain import plain
from pne_sym.vector.arrays import Relation


def spec_text(manipulator: Manipulator) -> str:
    """The full form of a specification as JSON; itself a specification that can be read."""
    return json.dumps(to_full_form(manipulator), indent=1, ensure_ascii=False)


def contents(bundle: Bundle) -> Iterator[str]:
    """Chapters and equations."""
    for chapter in bundle.derivation.chapters:
        yield f"{chapter.id}  {chapter.title}"
        width = max(len(equation.id) for equation in chapter.equations)
        for equation in chapter.equations:
            formula = f"{equation.name} = {plain(equation.rhs)}"
            yield from _hanging(f"  {equation.id:<{width}}  ", formula)
        yield ""
    if bundle.derivation.relations:
        yield "Coupled motors, by arrays of all legs"
    for relation in bundle.derivation.relations:
        yield from _hanging(f"  {relation.id}  ", relation_formula(relation))


def stage_lines(
    bundle: Bundle, stage: str | None, wanted: str | None, *, transitively: bool = False
) -> Iterator[str]:
    """What `pne-gen explain` shows of a stage other than the specification.

    Args:
        bundle: the compiled manipulator.
        stage: one of `registry.stages()` but "spec"; None for the derivation and the program.
        wanted: id or name of an equation; None for all.
        transitively: follow uses and users to the end.

    Raises:
        UnknownEquationError: there is no such equation.
        TargetError: there is no such stage.
    """
    if stage is not None:
        registry.check_stage(stage)
    if wanted is None:
        yield from _whole(bundle, stage)
        return
    relation = find_relation(bundle.derivation, wanted)
    if relation is not None:
        yield from _relation_lines(bundle, stage, relation)
        return
    for k, equation in enumerate(find_equations(bundle.derivation, wanted)):
        if k:
            yield ""
        yield from _equation_lines(bundle, stage, equation, transitively=transitively)


def _equation_lines(
    bundle: Bundle, stage: str | None, equation: Equation, *, transitively: bool
) -> Iterator[str]:
    if stage in (None, "derivation"):
        yield from explanation(explain(bundle, equation.id, transitively=transitively))
    if stage == "derivation":
        return
    if stage in (None, "program"):
        found = program_passages(bundle, equation.id)
    else:
        found = _in_code(bundle, stage, equation.id)
    if stage is None:
        yield ""
        if found:
            yield "statements of the scalar program"
    if not found:
        yield from _hanging("", why_without(bundle, equation))
    yield from _passages(found)


def _relation_lines(bundle: Bundle, stage: str | None, relation: Relation) -> Iterator[str]:
    """A relation between arrays: what it says, and the steps of public functions made of it."""
    if stage in (None, "derivation"):
        users = [r.id for r in bundle.derivation.relations if relation.id in r.uses]
        yield f"({relation.id}) {relation.title}"
        yield ""
        yield from _hanging("  ", relation_formula(relation))
        yield ""
        yield f"  law:   {relation.law}; beyond the paper"
        yield ""
        yield f"uses: {', '.join(relation.uses)}"
        yield f"used by: {', '.join(users) or 'public functions'}"
    if stage in (None, "program"):
        yield from [""] * (stage is None)
        yield from _passages(step_passages(bundle, relation.id))
    elif stage != "derivation":
        yield from _passages(_in_code(bundle, stage, relation.id))


def _whole(bundle: Bundle, stage: str | None) -> Iterator[str]:
    if stage in (None, "derivation"):
        yield from contents(bundle)
    elif stage == "program":
        yield from _passages(program_passages(bundle, None))
    else:
        of = registry.target(stage)
        texts = _code(bundle, of)
        for path, text in texts.items():
            if len(texts) > 1:
                yield f"{_syntax(of).comments[0]} ---- {path}"
            yield from text.rstrip("\n").split("\n")


def _code(bundle: Bundle, of: Target) -> dict[str, str]:
    """The texts of a target in which statements stand under the ids of equations."""
    texts = sorted(emit_target(bundle, of).items())
    return {path: text for path, text in texts if of.has_code(bundle.name, path)}


def _in_code(bundle: Bundle, target: str, id_: str) -> tuple[Passage, ...]:
    """The statements of a target that stand under an id."""
    of = registry.target(target)
    return passages(_code(bundle, of), id_, _syntax(of))


def _syntax(of: Target) -> Syntax:
    assert of.syntax is not None, "a target with code has a syntax"
    return of.syntax


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
    for condition in equation.conditions:
        must = ">= 0" if condition.status.value == "unreachable" else "not near 0"
        yield f"  {condition.status.value} unless {plain(condition.value)} is {must}"
    for step in equation.steps:
        yield from _hanging(f"  {step.rule}: ", f"{plain(step.before)} -> {plain(step.after)}")
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
    return wrapped(start, " " * len(start), text)
