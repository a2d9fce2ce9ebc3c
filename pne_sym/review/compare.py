"""Two versions of a model compared by meaning.

>>> from pne_sym.generation import find
>>> from pne_sym.review.compare import compare
>>> from pne_sym.review.model import from_manipulator
>>> model = from_manipulator("planar_3rpr", find("planar_3rpr"))
>>> compare(model, model).equal
True
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from pne_sym.backends import registry
from pne_sym.backends.describe import Described, describe
from pne_sym.review.blocks import Terms, c_blocks, numpy_blocks
from pne_sym.review.difference import (
    BlockDifference,
    Change,
    Comparison,
    Deviation,
    EquationDifference,
    Verdict,
)
from pne_sym.review.equations import DerivationComparer
from pne_sym.review.execution import ExecutionError
from pne_sym.review.files import differing, file_differences
from pne_sym.review.interface import interface_changes, operation_changes
from pne_sym.review.model import Model, printed_equations
from pne_sym.review.reproduction import reproduced
from pne_sym.review.sandbox import best_isolation
from pne_sym.review.values import Runs
from pne_sym.review.written import as_written

TOLERANCE = 1e-9


def compare(
    before: Model,
    after: Model,
    *,
    tolerance: float = TOLERANCE,
    seed: int = 0,
    run: bool = False,
) -> Comparison:
    """Compare two versions of a model.

    Folders that are equal to the byte are identical. Otherwise a folder is compared with
    what this pne-gen prints from the specification in its manifest; where the two are
    equal, our own text in memory is run in its place. Nothing else of a folder is
    executed or compiled, unless that is asked for.

    Args:
        before: a version.
        after: another.
        tolerance: relative; values nearer than this are equal.
        seed: of the random parameters and states.
        run: execute the NumPy modules, and compile and execute the C, of both.
    """
    found = Comparison(before.label, after.label, tolerance, (0, 0), (), (), (), ())
    changed: list[str] = []
    if before.folder is not None or after.folder is not None:
        before, after = _of_the_same_targets(before, after)
        changed = differing(before.files, after.files)
        same = len(before.files.keys() | after.files.keys()) - len(changed)
        found = replace(found, identical_files=same)
        if not any(_may_be_generated(p, before, after) for p in changed):
            return replace(found, files=file_differences(before.files, after.files, ()))
        before, after = reproduced(before), reproduced(after)
    ours = before.bundle is not None and after.bundle is not None
    if changed:
        both = [p for p in changed if before.has_generated(p) and after.has_generated(p)]
        accounted = both if ours else ()
        found = replace(found, files=file_differences(before.files, after.files, accounted))
    found = replace(
        found,
        deviations=(*before.deviations, *after.deviations),
        operations=tuple(operation_changes(before, after)),
    )
    if ours or run:
        try:
            return _with_values(found, before, after, seed, run=run)
        except ExecutionError as error:
            found = replace(found, not_compared=str(error))
    else:
        found = replace(found, not_compared=_reason(found.deviations))
    return replace(
        found,
        equations=tuple(_compare_reports(before.report, after.report)),
        interface=tuple(interface_changes(before, after, {}, {})),
        notes=tuple(_notes(before, after, run=run)),
    )


def _of_the_same_targets(before: Model, after: Model) -> tuple[Model, Model]:
    """A specification beside a folder has the targets that the folder was generated with."""
    known = set(registry.choices())
    if after.folder is None and known.issuperset(before.targets):
        return before, replace(after, targets=before.targets)
    if before.folder is None and known.issuperset(after.targets):
        return replace(before, targets=after.targets), after
    return before, after


def _may_be_generated(path: str, before: Model, after: Model) -> bool:
    return any(
        registry.is_claimed(m.name, path) or (m.folder is None and path in m.files)
        for m in (before, after)
    )


def _reason(deviations: tuple[Deviation, ...]) -> str:
    versions = " and ".join(dict.fromkeys(d.version for d in deviations))
    return (
        f"{versions}: not what this pne-gen prints from the manifest, and nothing of a folder "
        "is executed without --run"
    )


def _with_values(
    found: Comparison, before: Model, after: Model, seed: int, *, run: bool
) -> Comparison:
    """The comparison with everything that is found by running both versions."""
    runs = Runs(before, after, seed)
    equations: tuple[EquationDifference, ...]
    if before.bundle and after.bundle and runs.comparable:
        equations = DerivationComparer(
            before.bundle.derivation, after.bundle.derivation, runs.samples(), found.tolerance
        ).compare()
    else:
        equations = tuple(_compare_reports(before.report, after.report))
    interface = as_written(
        interface_changes(before, after, *runs.defaults), before.written, after.written
    )
    found = replace(
        found,
        samples=(len(runs.kept), runs.states),
        blocks=tuple(_blocks(before, after, runs, found.tolerance, run=run)),
        equations=equations,
        interface=(*interface, *_constants(before, after, runs)),
    )
    notes = [*_notes(before, after, run=run), *_notes_of_values(before, after, found, runs)]
    return replace(found, notes=tuple(notes))


def _blocks(
    before: Model, after: Model, runs: Runs, tolerance: float, *, run: bool
) -> Iterator[BlockDifference]:
    """All functions of the NumPy modules, and of C where the code of folders is run."""
    if not runs.comparable:
        yield BlockDifference("all functions", Verdict.DIFFERENT)
        return
    actuators = before.manifest["sizes"]["NU"]
    terms = Terms(runs.kept, tolerance, {**after.functions, **before.functions}, actuators)
    same = _SameText(before, after)
    yield from numpy_blocks(*runs.answers, terms, same)
    if run and before.c == after.c:
        yield BlockDifference("C: all functions", Verdict.IDENTICAL)
    elif run:
        answers, faults = runs.c_answers()
        yield from (BlockDifference("C", Verdict.NOT_COMPARED, note=fault) for fault in faults)
        if answers is not None:
            yield from c_blocks(*answers, terms)
    yield from _not_run(before, after) if run else ()


def _not_run(before: Model, after: Model) -> Iterator[BlockDifference]:
    """Code of both versions that differs and that cannot be run here."""
    for of in registry.TARGETS:
        chosen = of.name in before.targets and of.name in after.targets
        if not chosen or of.runs or of.always:
            continue
        if before.of_target(of.name) != after.of_target(of.name):
            note = "its text differs, and --run does not run it"
            yield BlockDifference(of.name, Verdict.NOT_COMPARED, note=note)


class _SameText:
    """Whether the text of a function is the same in both NumPy modules.

    Of whole modules, or of our own texts also of functions that are printed from equal
    statements; nothing is looked for in the text itself.
    """

    def __init__(self, before: Model, after: Model) -> None:
        self.whole = before.python == after.python
        self.before, self.after = before.bundle, after.bundle
        if self.before is not None and self.after is not None:
            facts = [self._facts(describe(b)) for b in (self.before, self.after)]
            programs = [b.program for b in (self.before, self.after)]
            self.whole |= facts[0] == facts[1] and programs[0] == programs[1]

    @staticmethod
    def _facts(d: Described) -> Described:
        return replace(d, name="", upper="", title="")

    def __call__(self, name: str) -> bool:
        if self.whole or self.before is None or self.after is None:
            return self.whole
        old, new = self.before.program, self.after.program
        return (
            name in old.functions
            and old.functions[name] == new.functions.get(name)
            and (old.prepare, old.shapes) == (new.prepare, new.shapes)
        )


def _constants(before: Model, after: Model, runs: Runs) -> Iterator[Change]:
    """What the modules export besides functions, where that is not what their manifests say."""
    old, new = (a.constants for a in runs.answers)
    stated = [{**m.manifest["sizes"], **_home(m)} for m in (before, after)]
    for name in dict.fromkeys((*old, *new)):
        if name not in old or name not in new:
            yield Change("added" if name in new else "removed", f"constant {name}")
        elif not np.array_equal(old[name], new[name]) and not all(
            np.array_equal(np.asarray(side.get(name)), values[name])
            for side, values in zip(stated, (old, new), strict=True)
        ):
            yield Change("changed", f"constant {name}", _text(old[name]), _text(new[name]))


def _home(model: Model) -> dict[str, list[float]]:
    return {"HOME_X": model.manifest["home"]["X"], "HOME_Q": model.manifest["home"]["q"]}


def _text(value: object) -> str:
    return str(np.asarray(value).tolist())[:200]


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


def _notes(before: Model, after: Model, *, run: bool) -> Iterator[str]:
    """What a reader should know of the two versions."""
    for key in ("name", "title", "generator"):
        a, b = before.manifest.get(key), after.manifest.get(key)
        if a != b:
            yield f"{key}: {a} -> {b}"
    if before.targets != after.targets:
        yield f"targets: {', '.join(before.targets)} -> {', '.join(after.targets)}"
    if before.bundle is None or after.bundle is None:
        yield "equations, interface and operations are compared as the folders print them"
    for model in (before, after) if run else ():
        if model.bundle is None:
            yield (
                f"{model.label}: its code was executed, and values are by its own account; "
                f"isolation: {best_isolation()}"
            )


def _notes_of_values(before: Model, after: Model, found: Comparison, runs: Runs) -> Iterator[str]:
    """How far the comparison of values goes."""
    if not runs.comparable:
        yield "X or V have other entries: values cannot be compared"
    elif not runs.states:
        yield "no state was found that either version allows: values were not compared"
    if (
        before.bundle is not None
        and after.bundle is not None
        and any(b.verdict is Verdict.DIFFERENT for b in found.blocks)
        and not found.origins
    ):
        yield "all equations agree: what differs is outside them (lowering, branches, home)"
