"""Relations between whole arrays, of coupled motors: ids in report, code, explanation and diff."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from pne_sym.backends import registry
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.report import ReportBackend
from pne_sym.lowering.program import lower
from pne_sym.program.public import Apply
from pne_sym.review.code import step_passages
from pne_sym.review.difference import Verdict
from pne_sym.review.explain_text import stage_lines
from pne_sym.review.model import from_bundle
from pne_sym.vector.arrays import product
from tests import models
from tests.printed.interpreter import Interpreter
from tests.printed.test_printed import close, numbers_of
from tests.review.versions import compare
from tests.whole.test_coupling import both

IDS = {
    "motor_rates", "motor_torques", "rotor_columns", "M_rotors", "Z_rotors", "required_rotors",
    "tau_rotors",
}  # fmt: skip
STAGES = [t.name for t in registry.TARGETS if t.syntax is not None]


@pytest.fixture(scope="module")
def coupled() -> Bundle:
    return models.bundle(both("fivebar_revolute")[1])


def test_every_step_beyond_the_sums_has_an_id(coupled: Bundle) -> None:
    """The report has each once, and nothing of a coupling is computed without one."""
    text = ReportBackend().emit(coupled)[f"{coupled.name}.md"]
    assert {r.id for r in coupled.derivation.relations} == IDS
    assert all(text.count(f'<a id="{id_}"></a>**({id_})** ') == 1 for id_ in IDS)
    made = set[str]()
    for f in coupled.program.public:
        arrays = {"coupling", "rotor_roots", "rotor_columns"}
        for step in f.steps:
            if isinstance(step, Apply) and arrays & {o.name for o in step.operands}:
                assert step.equation in IDS, (f.name, step)
                made.add(step.equation)
    assert made == IDS


@pytest.mark.parametrize("stage", STAGES)
def test_statements_stand_under_the_id(coupled: Bundle, stage: str) -> None:
    """All lines of a relation and nothing else: each has a name that its steps make."""
    for id_ in sorted(IDS):
        told = [t for t in stage_lines(coupled, stage, id_) if re.match(r"    \S", t)]
        end = ";" if stage in ("c", "octave") else ""  # where a statement may take several lines
        statements = re.split(rf"{end}\n|;$", "\n".join(told))
        steps = [line.split() for p in step_passages(coupled, id_) for line in p.lines]
        made = {line[0] for line in steps}
        assert made <= set(re.findall(r"\w+", "\n".join(told))), id_
        for text in filter(None, statements):
            assert made & set(re.findall(r"\w+", text)), (id_, text)


def test_explained_without_a_stage(coupled: Bundle) -> None:
    told = "\n".join(stage_lines(coupled, None, "Z_rotors"))
    assert "Z_rotors = rotor_columns diag(rotor_roots) coupling actuated_bias" in told
    assert "law:   coupling" in told
    assert "Z_rotors = times(rotor_columns, " in told
    assert "M_rotors = rotor_columns rotor_columns^T" in "\n".join(stage_lines(coupled, None, None))


def test_rates_and_torques_as_printed(coupled: Bundle) -> None:
    """From the report's products alone."""
    spec = coupled.manipulator
    m, state = models.module(spec), models.state_at(spec, 2)
    text = ReportBackend().emit(coupled)[f"{coupled.name}.md"]
    numbers = numbers_of(coupled, state)
    found = Interpreter(text, numbers)
    S, C = found.relation("rotor_columns"), np.asarray(spec.coupling)
    roots = found.array("rotor_roots")
    close(S, m.H(state.X) @ C.T * roots, "S")
    qdd = m.actuator_accelerations(state.X, state.V, state.A)
    close(found.relation("tau_rotors"), C.T @ (roots**2 * (C @ qdd)), "tau_rotors")


def test_a_changed_relation_is_placed(coupled: Bundle) -> None:
    """A matrix that is not transposed is named, with both texts and what follows."""
    d = coupled.derivation
    wrong = replace(
        next(r for r in d.relations if r.id == "M_rotors"),
        rhs=product("rotor_columns", "rotor_columns"),
    )
    changed = replace(d, relations=tuple(wrong if r.id == wrong.id else r for r in d.relations))
    other = replace(coupled, derivation=changed, program=lower(changed))
    found = compare(from_bundle("a", coupled), from_bundle("b", other))
    (told,) = found.structure
    assert (told.id, told.verdict) == ("M_rotors", Verdict.CHANGED)
    assert told.before == "M_rotors = rotor_columns rotor_columns^T"
    assert told.after == "M_rotors = rotor_columns rotor_columns"
    assert {b.name for b in found.blocks if b.verdict is Verdict.DIFFERENT} >= {"M", "energy"}
    same = compare(from_bundle("a", coupled), from_bundle("b", coupled))
    assert {e.id for e in same.equations if e.verdict is Verdict.IDENTICAL} >= IDS
