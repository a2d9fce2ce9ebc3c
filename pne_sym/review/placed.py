"""Versions whose code contradicts their own derivation: the first statement, and its line."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from pne_sym.review.difference import Contradiction
from pne_sym.review.equations import Sample
from pne_sym.review.model import Model
from pne_sym.review.named import Situation, Statement, first_contradiction

_SITUATIONS = 2
"""At random, a statement that is wrong is so at each of them; the second is for what is zero."""


def contradictions(
    models: tuple[Model, Model], samples: Sequence[Sample]
) -> tuple[Contradiction, ...]:
    """Of each version whose derivation is known, the first statement that contradicts it."""
    return tuple(_first(models, samples))


def _first(models: tuple[Model, Model], samples: Sequence[Sample]) -> Iterator[Contradiction]:
    for k, model in enumerate(models):
        if model.bundle is None:
            continue
        at = [Situation((s.before, s.after)[k], s.vectors[k]) for s in samples[:_SITUATIONS]]
        s = first_contradiction(model.bundle.derivation, model.bundle.program, at)
        if s is not None:
            line = line_of(model, s)
            yield Contradiction(
                model.label, s.equation, s.name, s.function, s.means, line, s.found, s.expected
            )


def line_of(model: Model, statement: Statement) -> str:
    """The line of C, else of Python, that computes a value; empty for stored entries."""
    name = re.escape(statement.name)
    forms = (
        (
            f"{model.name}.c",
            model.c,
            rf"/\* ---- {statement.function} ",
            rf"\s*((const real |v->){name} =|KEEP(_OF_LEG)?\({name},)",
        ),
        (f"{model.name}.py", model.python, rf"def _run_{statement.function}\(", rf"\s*{name} ="),
    )
    for path, files, head, form in forms:
        lines = files.get(path, b"").decode(errors="replace").split("\n")
        start = next((k for k, line in enumerate(lines) if re.match(head, line)), len(lines))
        for k in (*range(start, len(lines)), *range(start)):  # what functions share stands before
            if re.match(form, lines[k]):
                return f"{path}:{k + 1}"
    return ""
