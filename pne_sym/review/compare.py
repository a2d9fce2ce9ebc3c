"""Two versions of a model compared by meaning.

>>> from pne_sym.generation import find
>>> from pne_sym.review.compare import compare
>>> from pne_sym.review.model import from_manipulator
>>> model = from_manipulator("planar_3rpr", find("planar_3rpr"))
>>> compare(model, model).equal
True
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from pne_sym.review.blocks import compare_blocks
from pne_sym.review.difference import BlockDifference, Comparison, EquationDifference, Verdict
from pne_sym.review.equations import DerivationComparer, Sample
from pne_sym.review.execution import execute
from pne_sym.review.interface import interface_changes, operation_changes
from pne_sym.review.model import Model, by_name, by_path, printed_equations, report_of
from pne_sym.review.samples import length_of, random_parameters, random_states
from pne_sym.review.written import as_written

TOLERANCE = 1e-9
PARAMETER_SETS = 4
STATES = 8
_PER_SET = 2
"""States of each parameter set at which every equation is evaluated."""


def compare(
    before: Model, after: Model, *, tolerance: float = TOLERANCE, seed: int = 0
) -> Comparison:
    """Compare two versions of a model.

    Args:
        before: a version.
        after: another.
        tolerance: relative; values nearer than this are equal.
        seed: of the random parameters and states.

    Raises:
        ExecutionError: a generated module cannot be run.
    """
    runs = _Runs(before, after, seed)
    equations: tuple[EquationDifference, ...]
    if before.bundle and after.bundle and runs.comparable:
        comparer = DerivationComparer(
            before.bundle.derivation, after.bundle.derivation, runs.samples(), tolerance
        )
        equations = comparer.compare()
    else:
        equations = tuple(_compare_reports(report_of(before), report_of(after)))
    blocks = tuple(compare_blocks(before, after, runs.old, runs.new, tolerance))
    found = Comparison(
        before.label,
        after.label,
        tolerance,
        (PARAMETER_SETS, runs.states),
        blocks if runs.comparable else (BlockDifference("all functions", Verdict.DIFFERENT),),
        equations,
        as_written(
            interface_changes(before, after, runs.old_defaults, runs.new_defaults),
            before.written,
            after.written,
        ),
        tuple(operation_changes(before, after)),
    )
    return replace(found, notes=tuple(_notes(before, after, found, runs)))


class _Runs:
    """Both modules run at common parameters and states.

    Attributes:
        old, new: values by function, per set of parameters; states that neither
            version allows are left out.
        states: how many states were compared.
        comparable: whether X and V mean the same in both.
    """

    def __init__(self, before: Model, after: Model, seed: int) -> None:
        self.before, self.after = before, after
        sizes = [m.manifest["sizes"] for m in (before, after)]
        self.comparable = all(sizes[0][k] == sizes[1][k] for k in ("NQ", "NV"))
        first = [execute(m.label, m.source, []) for m in (before, after)]
        self.old_defaults = by_path(before, first[0]["defaults"])
        self.new_defaults = by_path(after, first[1]["defaults"])
        self.old: list[Any] = []
        self.new: list[Any] = []
        self.states = 0
        self._parameters: list[tuple[dict[str, Any], dict[str, Any]]] = []
        self._states: list[dict[str, Any]] = []
        if self.comparable:
            self._run(np.random.default_rng(seed))

    def _run(self, rng: np.random.Generator) -> None:
        defaults = {**self.new_defaults, **self.old_defaults}
        size, requests = length_of(defaults), []
        for _ in range(PARAMETER_SETS):
            drawn = random_parameters(defaults, rng)
            old = {**drawn, **self._structural(self.new_defaults, drawn)}
            self._parameters.append((by_name(self.before, drawn), by_name(self.after, old)))
            states = random_states(self.before, STATES, size, rng)
            requests.append({**states, "consistent": True, "parameters": self._parameters[-1][0]})
        answers = execute(self.before.label, self.before.source, requests)["sets"]
        for request, answer, (_, parameters) in zip(
            requests, answers, self._parameters, strict=True
        ):
            request.update({k: answer[k] for k in ("X", "V", "A")})
            request.update(consistent=False, parameters=parameters, tau=self._tau(request["tau"]))
        others = execute(self.after.label, self.after.source, requests)["sets"]
        for request, answer, other in zip(requests, answers, others, strict=True):
            self._keep(request, answer["values"], other["values"])

    def _structural(self, new: dict[str, Any], drawn: dict[str, Any]) -> dict[str, Any]:
        """Entries that are zero before by structure, but free after, at their values after."""
        free = {}
        for path, value in new.items():
            old = self.old_defaults.get(path)
            if old is not None and np.shape(value) and np.any((old == 0.0) & (value != 0.0)):
                free[path] = np.where((old == 0.0) & (value != 0.0), value, drawn[path])
        return free

    def _tau(self, tau: list[list[float]]) -> list[list[float]]:
        """Drive forces for as many drives as the version after has."""
        wanted = self.after.manifest["sizes"]["NU"]
        return [(row + [0.0] * wanted)[:wanted] for row in tau]

    def _keep(self, request: dict[str, Any], old: dict[str, Any], new: dict[str, Any]) -> None:
        """Keep the states that one of the two versions allows."""
        possible = np.isfinite(np.array(request["X"], dtype=float)).all(axis=1)
        reached = [
            np.isfinite(np.array(values["M"][0], dtype=float)).all(axis=(1, 2))
            for values in (old, new)
        ]
        kept = np.flatnonzero(possible & (reached[0] | reached[1]))
        self.states += len(kept)
        for values, side in ((old, self.old), (new, self.new)):
            side.append({n: [np.array(v)[kept] for v in each] for n, each in values.items()})
        both = [int(k) for k in kept if reached[0][k] and reached[1][k]][:_PER_SET]
        self._states.append(
            {n: np.array(request[n])[both] for n in ("X", "V", "A")}
            | {"q": np.array(old["inverse_kinematics"][0])[both]}
        )

    def samples(self) -> list[Sample]:
        """States for comparing equations: possible in both versions."""
        return [
            Sample(old, new, {name: rows[k] for name, rows in states.items()})
            for (old, new), states in zip(self._parameters, self._states, strict=True)
            for k in range(len(states["X"]))
        ]


def _compare_reports(before: str, after: str) -> list[EquationDifference]:
    """Equations of two reports by text: the same where left-hand side and chapter agree."""
    old = {(e.id.rstrip("0123456789"), e.left): e for e in printed_equations(before)}
    found = []
    for equation in printed_equations(after):
        chapter = equation.id.rstrip("0123456789")
        partner = old.pop((chapter, equation.left), None)
        leg_type = chapter.partition("-")[0] if "-" in chapter else ""
        old_text, new_text = (partner.formula if partner else ""), equation.formula
        if partner is None:
            verdict = Verdict.ADDED
        elif old_text == new_text:
            verdict, old_text, new_text = Verdict.IDENTICAL, "", ""
        else:
            verdict = Verdict.CHANGED
        found.append(
            EquationDifference(
                equation.id, equation.left, equation.title, leg_type, verdict, old_text, new_text
            )
        )
    found += [
        EquationDifference(e.id, e.left, e.title, "", Verdict.REMOVED, before=e.formula)
        for e in old.values()
    ]
    return found


def _notes(before: Model, after: Model, found: Comparison, runs: _Runs) -> list[str]:
    """What a reader should know of how far the comparison goes."""
    notes = []
    for key in ("name", "title", "generator"):
        a, b = before.manifest.get(key), after.manifest.get(key)
        if a != b:
            notes.append(f"{key}: {a} -> {b}")
    if not runs.comparable:
        notes.append("X or V have other entries: values cannot be compared")
    elif not runs.states:
        notes.append("no state was found that either version allows: values were not compared")
    if not (before.bundle and after.bundle):
        notes.append(
            "equations are compared as the reports print them, values function by function: "
            "one of the two is a generated folder"
        )
    elif any(b.verdict is Verdict.DIFFERENT for b in found.blocks) and not found.origins:
        notes.append("all equations agree: what differs is outside them (lowering, branches, home)")
    return notes
