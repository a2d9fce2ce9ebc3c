"""Two versions of a model compared by meaning.

>>> from pne_sym.generation import find
>>> from pne_sym.review.compare import compare
>>> from pne_sym.review.model import from_manipulator
>>> model = from_manipulator("planar_3rpr", find("planar_3rpr"))
>>> compare(model, model).equal
True
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from pne_sym.backends import registry
from pne_sym.review.alignment import Alignment, align
from pne_sym.review.blocks import Terms, c_blocks, numpy_blocks
from pne_sym.review.difference import (
    BlockDifference,
    Change,
    Comparison,
    Edit,
    EquationDifference,
    FileDifference,
    Verdict,
    by_text,
)
from pne_sym.review.edits import best_edits
from pne_sym.review.effect import effects
from pne_sym.review.equations import DerivationComparer
from pne_sym.review.execution import ExecutionError
from pne_sym.review.files import file_differences
from pne_sym.review.interface import interface_changes, operation_changes, text_of
from pne_sym.review.model import Model, by_path, printed_equations
from pne_sym.review.named import contradictions
from pne_sym.review.programs import SameText, first_statement, same_derivation, same_program
from pne_sym.review.reproduction import reproduced
from pne_sym.review.samples import length_of
from pne_sym.review.sandbox import best_isolation
from pne_sym.review.values import Runs, takes_base

TOLERANCE = 1e-9
_NOT_RUN = (
    "not what this pne-gen prints from the manifest, and nothing of a folder "
    "is executed without --run"
)


def compare(
    before: Model,
    after: Model,
    *,
    tolerance: float = TOLERANCE,
    seed: int = 0,
    run: bool = False,
    c: bool = True,
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
        c: with `run`, the C too.
    """
    found = Comparison(before.label, after.label, tolerance)
    if before.folder is not None or after.folder is not None:
        before, after = _of_the_same_targets(before, after)
        files = file_differences(before.files, after.files, ())
        same = len(before.files.keys() | after.files.keys()) - len(files)
        found = replace(found, identical_files=same, files=files)
        if not any(_may_be_generated(f.path, before, after) for f in files):
            return found
        before, after = reproduced(before), reproduced(after)
    alignment = align(before.manifest, after.manifest, (before.written, after.written))
    return _compared(found, _Pair(before, after, alignment, seed, run=run, c=c))


def _compared(found: Comparison, of: _Pair) -> Comparison:
    """What is known without running anything, then what running both tells."""
    found = replace(
        found,
        files=of.accounted(found.files),
        deviations=(*of.before.deviations, *of.after.deviations),
        operations=tuple(operation_changes(of.before, of.after)),
        specification=_specification(of.before, of.after),
    )
    if not (of.ours or of.run):
        versions = " and ".join(dict.fromkeys(d.version for d in found.deviations))
        return _as_printed(found, of, f"{versions}: {_NOT_RUN}")
    try:
        with np.errstate(all="ignore"):  # states that are impossible have no values
            return _with_values(found, of)
    except ExecutionError as error:
        return _as_printed(found, of, str(error))


def _as_printed(found: Comparison, of: _Pair, reason: str) -> Comparison:
    """The comparison by what the folders say: nothing of them is run."""
    return replace(
        found,
        not_compared=reason,
        equations=tuple(_compare_reports(of.before.report, of.after.report)),
        interface=tuple(interface_changes(of.before, of.after, (), of.alignment)),
        notes=tuple(_notes(of.before, of.after, run=of.run)),
    )


@dataclass(frozen=True)
class _Pair:
    """Two versions that may be run, and how."""

    before: Model
    after: Model
    alignment: Alignment
    seed: int
    run: bool
    c: bool

    @property
    def ours(self) -> bool:
        """Whether the derivations of both are known."""
        return self.before.bundle is not None and self.after.bundle is not None

    def accounted(self, files: Sequence[FileDifference]) -> tuple[FileDifference, ...]:
        """Files that differ; those that are this pne-gen's own text in both are compared."""
        models = (self.before, self.after)
        own = [f.path for f in files if self.ours and all(m.has_generated(f.path) for m in models)]
        return file_differences(self.before.files, self.after.files, own) if own else tuple(files)


def _specification(before: Model, after: Model) -> tuple[Edit, ...] | None:
    """What was edited, where both versions hold their specifications."""
    forms = [m.manifest.get("specification") for m in (before, after)]
    if forms[0] is None or forms[1] is None:
        return None
    return best_edits((forms[0], forms[1]), (before.written, after.written))


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


def _with_values(found: Comparison, of: _Pair) -> Comparison:
    """The comparison with everything that is found by running both versions."""
    before, after = of.before, of.after
    if before.bundle and after.bundle and same_program(before.bundle, after.bundle):
        return _of_equal_text(found, of)
    runs = Runs(before, after, of.seed, of.alignment)
    found = replace(
        found,
        samples=(len(runs.kept), runs.states),
        blocks=tuple(_blocks(of, runs, found.tolerance)),
        equations=_equations(of, runs, found.tolerance),
        interface=(
            *interface_changes(before, after, runs.defaults, of.alignment),
            *(_constants(before, after, runs) if runs.comparable else ()),
        ),
    )
    if before.bundle and after.bundle and same_derivation(before.bundle, after.bundle):
        found = replace(found, statement=first_statement(before.bundle, after.bundle))
    if any(b.verdict is Verdict.DIFFERENT for b in found.blocks):
        found = replace(
            found, contradictions=tuple(contradictions((before, after), runs.samples()))
        )
    notes = [*_notes(before, after, run=of.run), *_notes_of_values(found, of, runs)]
    return _with_effects(replace(found, notes=tuple(notes)), of, runs.defaults)


def _of_equal_text(found: Comparison, of: _Pair) -> Comparison:
    """Two versions whose functions have the same text: only defaults can differ."""
    before, after = of.before, of.after
    assert before.bundle is not None
    assert after.bundle is not None
    names = [f.name for f in after.bundle.program.public]
    same = Verdict.IDENTICAL
    derivation = after.bundle.derivation
    owner = {e.name: c.leg_type or "" for c in derivation.chapters for e in c.equations}
    new = {of.alignment.canonical(p): v for p, v in _defaults(after).items()}
    defaults = [_defaults(before), new]
    names += ["C: all functions"] if of.run else []
    found = replace(
        found,
        blocks=(*(BlockDifference(name, same) for name in names), *_not_run(before, after, of.run)),
        equations=tuple(
            EquationDifference(e.id, e.name, e.title, owner[e.name], same)
            for e in derivation.equations()
        )
        + tuple(EquationDifference(r.id, r.id, r.title, "", same) for r in derivation.relations),
        interface=tuple(interface_changes(before, after, defaults, of.alignment)),
        notes=tuple(_notes(before, after, run=of.run)),
    )
    return _with_effects(found, of, defaults)


def _defaults(model: Model) -> dict[str, Any]:
    assert model.bundle is not None
    fields = model.bundle.derivation.parameters.fields
    return by_path(model, {f.name: f.default for f in fields})


def _with_effects(
    found: Comparison, of: _Pair, defaults: Sequence[Mapping[str, Any]]
) -> Comparison:
    """What the change does to required forces and the like, unless nothing was changed."""
    if found.equal and not found.interface:
        return found
    size = length_of({**defaults[1], **defaults[0]})
    try:
        told = effects(of.before, of.after, of.alignment, size=size, seed=of.seed)
    except ExecutionError as error:
        return replace(found, notes=(*found.notes, f"effects are not known: {error}"))
    return replace(found, effects=told)


def _equations(of: _Pair, runs: Runs, tolerance: float) -> tuple[EquationDifference, ...]:
    before, after = of.before, of.after
    if not (before.bundle and after.bundle):
        return tuple(_compare_reports(before.report, after.report))
    old, new = before.bundle.derivation, after.bundle.derivation
    return DerivationComparer(old, new, runs.samples(), tolerance, of.alignment).compare()


def _blocks(of: _Pair, runs: Runs, tolerance: float) -> Iterator[BlockDifference]:
    """All functions of the NumPy modules, and of C where the code of folders is run."""
    before, after = of.before, of.after
    if not runs.comparable:
        yield BlockDifference("all functions", Verdict.DIFFERENT, note=_OTHER_COORDINATES)
        return
    actuators = before.manifest["sizes"]["NU"]
    terms = Terms(runs.kept, tolerance, {**after.functions, **before.functions}, actuators)
    same: Callable[[str], bool] = lambda _: before.python == after.python  # noqa: E731
    if before.bundle is not None and after.bundle is not None:
        same = SameText(before.bundle.program, after.bundle.program)
    yield from numpy_blocks(*runs.answers, terms, same)
    if of.run and before.c == after.c:
        yield BlockDifference("C: all functions", Verdict.IDENTICAL)
    elif of.run and not of.c:
        yield BlockDifference("C", Verdict.NOT_COMPARED, note="left out by --no-c")
    elif of.run:
        answers, faults = runs.c_answers()
        yield from (BlockDifference("C", Verdict.NOT_COMPARED, note=fault) for fault in faults)
        if answers is not None:
            yield from c_blocks(*answers, terms)
    yield from _not_run(before, after, of.run)


_OTHER_COORDINATES = "X or V have other entries: no function has a counterpart"


def _not_run(before: Model, after: Model, run: bool) -> Iterator[BlockDifference]:
    """With --run, code of both versions that differs and that cannot be run here."""
    for of in registry.TARGETS if run else ():
        chosen = of.name in before.targets and of.name in after.targets
        if not chosen or of.runs or of.always:
            continue
        if before.of_target(of.name) != after.of_target(of.name):
            note = "its text differs, and --run does not run it"
            yield BlockDifference(of.name, Verdict.NOT_COMPARED, note=note)


def _constants(before: Model, after: Model, runs: Runs) -> Iterator[Change]:
    """What the modules export besides functions, where that is not what their manifests say."""
    old, new = (a.constants for a in runs.answers)
    manifests = (before.manifest, after.manifest)
    stated = [{**m["sizes"], "HOME_X": m["home"]["X"], "HOME_Q": m["home"]["q"]} for m in manifests]
    for name in dict.fromkeys((*old, *new)):
        if name not in old or name not in new:
            yield Change("added" if name in new else "removed", f"constant {name}")
        elif not np.array_equal(old[name], new[name]) and not all(
            np.array_equal(np.asarray(side.get(name)), values[name])
            for side, values in zip(stated, (old, new), strict=True)
        ):
            sides = (text_of(side[name])[:200] for side in (old, new))
            yield Change("changed", f"constant {name}", *sides)


def _compare_reports(before: str, after: str) -> list[EquationDifference]:
    """Equations of two reports by text: the same where left-hand side and id agree."""
    old = {(e.id, e.left): e for e in printed_equations(before)}
    found = []
    for equation in printed_equations(after):
        partner = old.pop((equation.id, equation.left), None)
        leg_type = equation.id.partition("-")[0] if "-" in equation.id else ""
        about = (equation.id, equation.left, equation.title, leg_type)
        texts = by_text(partner.formula if partner else "", equation.formula)
        found.append(EquationDifference(*about, *texts))
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


def _notes_of_values(found: Comparison, of: _Pair, runs: Runs) -> Iterator[str]:
    """How far the comparison of values goes."""
    if takes_base(of.before.manifest) != takes_base(of.after.manifest):
        yield "the base of one version moves: equations and values are compared with it at rest"
    if runs.comparable and not runs.states:
        yield "no state was found that either version allows: values were not compared"
    if not runs.common:
        yield "no state is possible at equal parameters: each version has its own"
    if (
        of.ours
        and any(b.verdict is Verdict.DIFFERENT for b in found.blocks)
        and not found.structure
        and not found.contradictions
        and runs.comparable
    ):
        yield "all equations agree: what differs is outside them (lowering, branches, home)"
