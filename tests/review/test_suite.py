"""Twelve realistic edits: each told for what it is, in so many lines, and for what it means."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import pytest
import sympy as sp

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.derivation import ParameterTable
from pne_sym.lowering import tensors
from pne_sym.lowering.components import Lowering
from pne_sym.lowering.program import lower
from pne_sym.model.reader import from_text
from pne_sym.pipeline import compile_bundle
from pne_sym.review.compare import compare
from pne_sym.review.diff_text import as_text, sections, verdict
from pne_sym.review.difference import Comparison, Verdict
from pne_sym.review.markdown import as_markdown
from pne_sym.review.model import Model, from_bundle, version_of
from pne_sym.review.sources import Source
from tests.models import bundle, catalogue
from tests.review.versions import change, with_rhs
from tests.whole.test_coupling import both

# a home position that no longer closes exactly is found anew, and said so
pytestmark = pytest.mark.filterwarnings("ignore::pne_sym.model.errors.SpecWarning")
MODEL = "planar_3rpr"
TEXT = manipulators.path(MODEL).read_text(encoding="utf-8")
Replaced = tuple[tuple[str, str], ...]


@cache
def version(text: str) -> Model:
    return version_of(Source("a robot", "robot", text, ".toml"))


def edited(*changes: tuple[str, str]) -> str:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


@cache
def compared(*changes: tuple[str, str]) -> Comparison:
    return compare(version(TEXT), version(edited(*changes)))


LEG = """[[legs]]
type = "rpr"
base_point = [-0.2, 0.8]
base_frame = [[0.4349655341112302, 0.9004471023526769], [-0.9004471023526769, 0.4349655341112302]]
platform_point = [0.0, 0.18]

[home]"""
ELBOW = """[[leg_types.rpr.joints]]
kind = "R"
extra = true
offset = [0.1, 0.05]
link.mass = 0.5

[[leg_types.rpr.joints]]
# Actuator"""
EDITS: dict[str, tuple[Replaced, str, int]] = {
    "parameter value": (
        (("mass = 4.0", "mass = 5.0"),),
        "platform: mass 4 -> 5 kg (+25 %)",
        30,
    ),
    "c.g. off axis": (
        (("centre_of_mass = [0.175, 0.0]", "centre_of_mass = [0.175, 0.01]"),),
        "leg type rpr, joint 1 (R), link: centre of mass moved by 10 mm, off zero in y",
        32,
    ),
    "offset": (
        (('kind = "P"\n', 'kind = "P"\noffset = [0.0, 0.02]\n'),),
        "leg type rpr, joint 2 (P): offset set to 20 mm from zero",
        125,
    ),
    "axis flipped": (
        (('axis = "x"', 'axis = "-x"'), ("0.62]", "-0.62]")),
        "leg type rpr, joint 2 (P): axis flipped",
        57,
    ),
    "leg added": (
        (("[home]", LEG), ("    [0.0, 0.62],\n]", "    [0.0, 0.62],\n    [0.0, 0.7],\n]")),
        "leg 4 (of type rpr) added",
        115,
    ),
    "joint inserted": (
        (
            ("[[leg_types.rpr.joints]]\n# Actuator", ELBOW),
            ("[0.0, 0.62]", "[0.0, 0.0, 0.52]"),
            ("0.09999999999999999]", "0.1, 0.0, 0.0, 0.0]"),
            ("\nq_2 =", "\nq_3 ="),
            ("\ne_2 =", "\ne_3 ="),
        ),
        "leg type rpr: joint 2 (R) inserted",
        165,
    ),
    "actuator moved": (
        (("actuated = true\n", ""), ('kind = "R"\n', 'kind = "R"\nactuated = true\n')),
        "leg type rpr: actuated joint moved from joint 2 to joint 1",
        80,
    ),
}


@pytest.mark.parametrize("case", EDITS)
def test_an_edit_of_the_specification(case: str) -> None:
    changes, headline, bound = EDITS[case]
    found = compared(*changes)
    assert verdict(found) == f"different: {headline}"
    lines = list(as_text(found))
    assert lines[2] == f"different: {headline}"
    assert len(lines) <= bound, "\n".join(lines)
    assert max(map(len, lines)) <= 420
    assert not found.not_compared
    assert found.effects
    titles = [s.title.split(",")[0] for s in sections(found)]
    order = ["specification", "structure", "values", "interface", "effect", "rewritings and counts"]
    assert titles == [t for t in order if t in titles]
    assert next(as_markdown(found)).startswith("### ⚠️ different: ")


def test_a_default_that_happens_to_be_zero_decides_nothing() -> None:
    """To and from an axis: the same equations, the same functions, other numbers."""
    there = EDITS["c.g. off axis"][0][0]
    back = compare(version(edited(there)), version(TEXT))
    for found in (compared(there), back):
        assert {e.verdict for e in found.equations} == {Verdict.IDENTICAL}
        assert {b.verdict for b in found.blocks} == {Verdict.IDENTICAL}
        assert {c.what for c in found.interface} == {
            f"default of legs[{k}].joints[0].link.centre_of_mass" for k in range(3)
        }
        assert any(e.changed for e in found.effects)


def test_an_axis_that_is_flipped_is_not_headed_by_what_did_not_change() -> None:
    found = compared(*EDITS["axis flipped"][0])
    assert not found.structure  # frames follow the axis: the equations are the same
    assert {e.before for e in found.effects[:3]} == {-e.after for e in found.effects[:3] if e.after}
    assert not any("mass" in e.words for e in found.specification or ())


def test_a_leg_added_leaves_the_equations_of_the_others() -> None:
    found = compared(*EDITS["leg added"][0])
    counted = {e.name for e in found.structure}
    assert counted <= {
        "rpr_size",
        "b_c",
        "spread",
        "legs_size",
    }  # means over the legs, and home's size
    sums = [e for e in found.equations if "a sum over 4 legs, was over 3" in e.note]
    assert len(sums) >= 4
    assert "M_tt" not in counted
    assert any("no counterpart before" in line for line in as_text(found))


def test_a_joint_inserted_is_compared_joint_by_joint() -> None:
    found = compared(*EDITS["joint inserted"][0])
    assert found.samples[1] >= 16
    of = {e.name: e for e in found.equations}
    assert of["rpr_omega_1"].verdict is of["rpr_qd_3"].verdict is Verdict.IDENTICAL or (
        of["rpr_qd_3"].verdict is Verdict.FOLLOWS
    )
    assert of["rpr_q_3"].before.startswith("rpr_q_2 = ")
    assert of["rpr_h_2"].verdict is Verdict.ADDED
    assert of["rpr_h_3"].verdict in (Verdict.IDENTICAL, Verdict.FOLLOWS)
    same = (Verdict.IDENTICAL, Verdict.FOLLOWS, Verdict.EQUAL)
    assert sum(e.verdict in same for e in found.equations) >= 60
    renamed = {(c.before, c.after) for c in found.interface if c.what == "parameter"}
    assert ("rpr_link2_mass", "rpr_link3_mass") in renamed


def test_a_leg_of_another_type() -> None:
    mixed = manipulators.path("planar_mixed").read_text(encoding="utf-8")
    found = compare(version(TEXT), version(mixed))
    assert verdict(found) == "different: leg 2: type rpr -> rrr, and 7 other edits"
    shown = list(as_text(found))
    assert any(line.startswith("  leg type rrr (RRR) added") for line in shown)
    assert found.samples[1] >= 16
    assert len(shown) <= 164  # three of symbols
    assert {e.verdict for e in found.equations if e.leg_type == "rrr"} == {Verdict.ADDED}
    kept = [e for e in found.equations if e.leg_type == "rpr"]
    same = (Verdict.IDENTICAL, Verdict.FOLLOWS)
    assert sum(e.verdict in same for e in kept) >= 0.9 * len(kept)


def bundled(name: str) -> Model:
    return from_bundle(name, bundle(catalogue(name)))


def test_inertia_made_full() -> None:
    """In space: products of inertia are live entries, so this is a value."""
    text = manipulators.path("spherical_3ups").read_text(encoding="utf-8")
    old = next(
        line for line in text.splitlines() if line.startswith(("inertia = [", "link.inertia"))
    )
    key, _, rest = old.partition(" = ")
    x, y, z = (float(v) for v in rest.split("#")[0].strip(" []").split(","))
    off = 0.1 * min(x, y, z)
    full = f"{key} = {{ ixx = {x}, iyy = {y}, izz = {z}, ixy = {off} }}"
    before = version_of(Source("before", "robot", text, ".toml"))
    after = version_of(Source("after", "robot", text.replace(old, full, 1), ".toml"))
    found = compare(before, after)
    assert verdict(found).endswith("inertia now full (products of inertia)")
    assert len(list(as_text(found))) <= 40
    assert not found.structure


def test_a_parameter_renamed(monkeypatch: pytest.MonkeyPatch) -> None:
    add = ParameterTable.add

    def renamed(self: ParameterTable, parameter: object) -> object:
        assert dataclasses.is_dataclass(parameter)
        if parameter.name == "platform_mass":  # type: ignore[attr-defined]
            parameter = replace(parameter, name="payload_mass")  # type: ignore[type-var]
        return add(self, parameter)  # type: ignore[arg-type]

    before = version(TEXT)
    monkeypatch.setattr(ParameterTable, "add", renamed)
    after = from_bundle("after", compile_bundle(from_text(TEXT, ".toml", "after")))
    found = compare(before, after)
    told = [(c.kind, c.before, c.after) for c in found.interface]
    assert told == [("renamed", "platform_mass", "payload_mass")]
    assert not found.structure
    assert verdict(found).endswith("the interface changed")
    assert len(list(as_text(found))) <= 30


def test_a_fault_in_a_law() -> None:
    found = change(MODEL, {"Z_t": with_rhs(lambda rhs: 2 * rhs)})
    assert verdict(found).startswith("different: the derivation, first at ")
    assert " at Z_t, " in verdict(found)
    assert [e.name for e in found.structure] == ["Z_t"]
    assert len(list(as_text(found))) <= 45


def test_a_fault_in_the_lowering() -> None:
    """A sign in the program, the derivation being right: placed at its statement."""
    right = bundle(catalogue(MODEL))
    wrong = flipped(
        right, "Z", lambda a: str(a.target).startswith("J_star") or "phi_2_o" in str(a.target)
    )
    found = compare(bundled(MODEL), from_bundle("after", wrong))
    assert not found.equal
    assert not found.structure
    assert found.statement is not None
    assert f"-   {found.statement.before}" in list(as_text(found))
    (placed,) = found.contradictions
    assert (placed.version, placed.function) == ("after", "Z")
    assert placed.equation == found.statement.equation
    assert re.fullmatch(rf"{MODEL}\.c:\d+", placed.line)
    assert verdict(found) == (
        f"different: the lowering, first at {placed.equation} ({placed.target}) in Z, {placed.line}"
    )
    assert any("contradicts its derivation" in line for line in as_text(found))
    assert len(list(as_text(found))) <= 48


def test_a_fault_in_a_product_of_tensors(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the lowering's own code, against a folder of before: no statement is as it was."""
    right = tensors._skew_squared

    def wrong(of: Lowering, w: Any, hint: str) -> Any:
        rows = right(of, w, hint)
        return tuple(
            tuple(-e if i != j else e for j, e in enumerate(r)) for i, r in enumerate(rows)
        )

    before = bundled("tripod_3rps")
    monkeypatch.setattr(tensors, "_skew_squared", wrong)
    manipulator = catalogue("tripod_3rps")
    derivation = bundle(manipulator).derivation
    after = from_bundle("after", Bundle(manipulator, derivation, lower(derivation)))
    found = compare(before, after)
    assert not found.structure
    (placed,) = found.contradictions
    assert placed.target == "W_p_xy"
    assert placed.equation == derivation.definition("W_p").id
    assert verdict(found).startswith(
        f"different: the lowering, first at {placed.equation} (W_p_xy)"
    )


def flipped(of: Bundle, function: str, wanted: Callable[[object], bool]) -> Bundle:
    """The program with the sign of one statement of a function turned."""
    f = of.program.functions[function]
    blocks = list(f.blocks)
    for k, block in enumerate(blocks):
        for n, a in enumerate(block.assignments):
            if wanted(a):
                wrong = replace(a, expr=-sp.sympify(a.expr))
                made = (*block.assignments[:n], wrong, *block.assignments[n + 1 :])
                blocks[k] = replace(block, assignments=made)
                functions = {**of.program.functions, function: replace(f, blocks=tuple(blocks))}
                return replace(of, program=replace(of.program, functions=functions))
    raise AssertionError("there is no such statement")


def test_any_two_models_can_be_compared() -> None:
    found = compare(bundled("delta"), bundled("sixbar"))
    assert not found.equal
    assert not found.not_compared
    assert verdict(found).startswith("different: space translational -> planar")
    shown = list(as_text(found))
    assert any("no function has a counterpart" in line for line in shown)
    assert any("no counterpart after" in line for line in shown)
    assert len(shown) <= 200


def test_another_symbol_is_no_other_model() -> None:
    found = compared(('q_2 = "L"', 'q_2 = "D"'))
    assert verdict(found) == "equal: symbols of q_2 changed; the same values"
    assert {b.verdict for b in found.blocks} == {Verdict.IDENTICAL}


def test_motors_are_coupled() -> None:
    """Rotor inertias are numbers, not tensors; another coupling takes no values away."""
    alone, together = both(MODEL)
    assert together.coupling is not None
    rows = tuple(tuple(2.0 * x for x in row) for row in together.coupling)
    versions = [
        from_bundle(m.name, bundle(m))
        for m in (alone, together, dataclasses.replace(together, coupling=rows))
    ]
    for before, after, words in (
        (*versions[:2], "coupling added"),
        (*versions[1:], "coupling changed"),  # the same text: the same values
    ):
        found = compare(before, after)
        assert verdict(found) == f"different: {words}"
        assert found.samples[1] >= 16 * (words == "coupling added")
        assert not found.not_compared
        assert any(e.changed for e in found.effects)


def test_law_and_statement_are_told_of_both_orders() -> None:
    """What is gone in one direction is new in the other."""
    there = compared(*EDITS["offset"][0])
    back = compare(version(edited(*EDITS["offset"][0])), version(TEXT))
    new = {e.name for e in there.equations if e.verdict is Verdict.ADDED}
    gone = {e.name for e in back.equations if e.verdict is Verdict.REMOVED}
    assert new == gone
    assert new


def test_what_computes_by_the_same_text_is_not_said_to_be_rewritten() -> None:
    """Friction has parameters of its own: what does not feel it is as it was."""
    damped = ("actuated = true\n", "actuated = true\nfriction = { viscous = 180.0 }\n")
    found = compared(damped)
    verdicts = {b.name: b.verdict for b in found.blocks}
    for name in ("H", "M", "pose", "inverse_kinematics", "forward_kinematics", "condition"):
        assert verdicts[name] is Verdict.IDENTICAL, name
    assert verdicts["Z"] is verdicts["inverse_dynamics"] is Verdict.DIFFERENT
    longer = compared(("0.7173779532087043", "0.7273779532087043"))  # base point and its home
    verdicts = {b.name: b.verdict for b in longer.blocks}
    assert verdicts["pose"] is Verdict.IDENTICAL
    assert verdicts["M"] is Verdict.EQUAL  # it checks lengths beside the leg's size
    assert verdicts["condition"] is Verdict.DIFFERENT
    assert verdict(longer) == "different: leg 1: base point moved by 10 mm"


def test_legs_in_another_order_are_the_same_legs() -> None:
    head, *legs = TEXT.split("[[legs]]")
    last, end, tail = legs[2].partition("[symbols]")
    swapped = "[[legs]]".join([head, legs[1], legs[0], last]) + end + tail
    found = compare(version(TEXT), version(swapped))
    assert verdict(found) == "different: legs 1 and 2 swapped"
    assert not any(e.changed for e in found.effects)
    assert ("1, 2, 3", "2, 1, 3") in {(c.before, c.after) for c in found.interface}
    assert not found.equal  # entries of q and tau belong to other legs
