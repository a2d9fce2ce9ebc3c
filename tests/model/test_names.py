"""Names of leg types, legs and joints: in all that is generated, and never two alike."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest

from pne_sym.backends.emission import emit
from pne_sym.mechanics.derive import derive
from pne_sym.mechanics.structure import leg_types
from pne_sym.model.entry import Entry
from pne_sym.model.errors import SpecError
from pne_sym.model.joints import read_joint
from pne_sym.model.reader import from_mapping, to_full_form
from pne_sym.pipeline import compile_bundle
from tests.model.examples import planar
from tests.models import catalogue

Form = dict[str, Any]
HIP, SLIDE = "leg_types.rpr.joints.0.name", "leg_types.rpr.joints.1.name"


def changed(*changes: tuple[str, Any]) -> Form:
    form = copy.deepcopy(planar())
    for path, value in changes:
        *keys, last = (int(key) if key.isdigit() else key for key in path.split("."))
        place: Any = form
        for key in keys:
            place = place[key]
        place[last] = value
    return form


def types(*changes: tuple[str, Any]) -> list[tuple[str, tuple[int, ...]]]:
    manipulator = from_mapping(changed(*changes), "pair")
    again = from_mapping(to_full_form(manipulator), "again")
    assert again == manipulator
    return [(t.name, t.indices) for t in leg_types(manipulator)]


FREE = {"0": {"actuated": True}}
SPARE = {"platform_joint": "R", "joints": planar()["leg_types"]["rpr"]["joints"]}


def test_a_structure_has_the_name_of_its_type() -> None:
    assert types() == [("rpr", (0, 1))]
    renamed = changed(("legs.0.type", "strut"), ("legs.1.type", "strut"))
    renamed["leg_types"] = {"strut": renamed["leg_types"]["rpr"]}
    assert [t.name for t in leg_types(from_mapping(renamed, "pair"))] == ["strut"]


def test_what_overrides_split_off_has_the_name_of_its_first_leg() -> None:
    assert types(("legs.0.joints", FREE)) == [("rpr_leg1", (0,)), ("rpr", (1,))]
    named = ("legs.1.joints", FREE), ("legs.1.name", "front")
    assert types(*named) == [("rpr", (0,)), ("rpr_front", (1,))]


def test_what_all_legs_override_is_the_type() -> None:
    assert types(("legs.0.joints", FREE), ("legs.1.joints", FREE)) == [("rpr", (0, 1))]


def test_types_of_equal_structure_are_one_under_the_first_name() -> None:
    spare = ("leg_types.spare", SPARE)
    assert types(spare, ("legs.0.type", "spare")) == [("rpr", (0, 1))]


def test_without_a_type_the_architecture_is_the_name() -> None:
    form: Any = to_full_form(from_mapping(planar(), "pair"))
    for leg in form["legs"]:
        del leg["type"]
    form["legs"][0]["joints"][0]["actuated"] = True
    assert [t.name for t in leg_types(from_mapping(form, "pair"))] == ["rpr", "rpr2"]


def test_names_are_in_all_that_is_generated() -> None:
    names = (HIP, "hip"), (SLIDE, "slide"), ("legs.0.name", "front")
    bundle = compile_bundle(from_mapping(changed(*names), "pair"))
    assert bundle.coordinates.actuator_names == ("front_slide", "leg2_slide")
    fields = {f.name for f in bundle.derivation.parameters.fields}
    assert {"rpr_link_hip_mass", "rpr_link_hip_inertia"} <= fields
    ids = {e.id for e in bundle.derivation.equations()}
    assert {"rpr-q_hip", "rpr-q_slide", "rpr-qd_slide"} <= ids
    assert not any("_1" in id_ for id_ in ids - {"rpr-u_1"} if id_.startswith("rpr-q"))
    files = emit(bundle, ("numpy", "c"))
    for file, text in files.items():
        wanted = "hip", "slide", "front"
        assert file == "__init__.py" or all(name in text for name in wanted), file


def test_names_change_nothing_else() -> None:
    """A name is a name: statements, places and formulas are the same."""
    names = (HIP, "hip"), (SLIDE, "slide")
    plain, named = (derive(from_mapping(form, "pair")) for form in (planar(), changed(*names)))
    assert len(plain.notation) == len(named.notation)
    assert [q.latex for q in plain.notation.values()] == [q.latex for q in named.notation.values()]
    assert "name" not in str(to_full_form(from_mapping(planar(), "pair"))["legs"])


@pytest.mark.parametrize(
    ("name", "wanted"), [("hip", ["hip_1", "hip_2"]), (["a", "b"], ["a", "b"])]
)
def test_a_joint_of_several_freedoms_has_several_names(name: Any, wanted: list[str]) -> None:
    joint = Entry("spec", "joint", {"kind": "U", "axes": ["z", "y"], "name": name})
    assert [j.name for j in read_joint(joint, plane=False)] == wanted


def test_a_structure_that_would_have_the_name_of_another_type_is_refused() -> None:
    form = changed(("leg_types.rpr_leg1", SPARE), ("legs.0.joints", FREE))
    form["leg_types"]["rpr_leg1"]["platform_joint"] = {"kind": "R", "offset": [0.1, 0.0]}
    form["legs"].append(form["legs"][1] | {"type": "rpr_leg1"})
    form["home"]["q"].append([3 * math.pi / 4, math.sqrt(2) - 0.1])
    with pytest.raises(SpecError, match="legs of two structures would be of the type 'rpr_leg1'"):
        from_mapping(form, "pair")


def test_names_that_make_one_name_of_two_quantities_are_refused() -> None:
    """rho_tip_2 is of joint 2, and would be the rho of a joint named tip_2."""
    form: Any = to_full_form(catalogue("planar_3rrr"))
    for leg in form["legs"]:
        leg["joints"][0]["name"] = "tip_2"
    with pytest.raises(SpecError, match="two quantities would be called 'rrr_rho_tip_2'"):
        derive(from_mapping(form, "pair"))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ([(HIP, "slide"), (SLIDE, "slide")], "joints 1 and 2 are both called 'slide'"),
        ([(HIP, "joint2")], "joints 1 and 2 are both called 'joint2'"),
        ([("legs.0.name", "a"), ("legs.1.name", "a")], "legs 1 and 2 are both called 'a'"),
        ([("legs.0.name", "leg2")], "legs 1 and 2 are both called 'leg2'"),
        ([("legs.0.name", "a"), (HIP, "b_c"), ("legs.1.name", "a_b"), (SLIDE, "c")], "'a_b_c'"),
        ([(HIP, "Hip")], "name: value 'Hip'; expected a lower-case letter"),
        ([(HIP, "a" * 21)], "at most 20 characters"),
        ([(HIP, ["a", "b"])], "a list of 1"),
        ([("legs.0.name", "x; y")], "legs[0].name: value 'x; y'"),
    ],
)
def test_refused(changes: list[tuple[str, Any]], message: str) -> None:
    with pytest.raises(SpecError) as caught:
        from_mapping(changed(*changes), "pair")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
