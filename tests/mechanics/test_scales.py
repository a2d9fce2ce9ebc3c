"""Lengths of legs: of lever arms, whatever the origins, and live where links make them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pne_sym import manipulators
from pne_sym.derivation import Book, Equation
from pne_sym.mechanics.completion import Auxiliary, completion_at_home
from pne_sym.mechanics.derive import derive
from pne_sym.mechanics.leg_frames import build_geometry
from pne_sym.mechanics.scales import SMALLEST, home_lengths, lever_arms, with_size
from pne_sym.mechanics.structure import leg_types
from pne_sym.model.manipulator import ZERO3, Body, Home, Joint, Leg, Manipulator
from pne_sym.vector.evaluate import evaluate
from tests.oracle.mechanisms import mechanism
from tests.oracle.randomisation import vector3
from tests.whole.rewriting import Rewriting, drawn_shifts


@pytest.mark.parametrize("name", manipulators.names())
def test_lever_arms_do_not_depend_on_origins(name: str) -> None:
    spec = manipulators.load(name)
    far = drawn_shifts(spec, np.random.default_rng(2), 50.0, seats=False)
    arms = lever_arms(Rewriting(replace(spec, symbols=()), far).after)
    assert arms == pytest.approx(lever_arms(spec), rel=1e-9, abs=1e-9)


def size_of(spec: Manipulator) -> Equation:
    (found,) = (e for e in derive(spec).equations() if e.id.endswith("-size"))
    return found


def test_links_are_live_and_struts_are_those_of_home() -> None:
    assert {"rrr_d_2", "rrr_d_3", "rrr_size_0"} <= set(
        size_of(manipulators.load("planar_3rrr")).uses
    )
    assert size_of(manipulators.load("stewart")).rhs == pytest.approx(0.8, rel=0.05)


@pytest.mark.parametrize("times", [10.0, 1e3])
def test_longer_links_have_a_longer_measure(times: float) -> None:
    """What is singular is told relative to the links as they are, not as they were."""
    spec = manipulators.load("planar_3rrr")
    leg, size = spec.legs[0], size_of(spec)
    offsets = {"rrr_d_2": leg.joints[1].offset, "rrr_d_3": leg.platform_joint.offset}
    (least,) = (float(e.rhs) for e in derive(spec).equations() if e.id == "rrr-size_0")

    def at(scale: float) -> float:
        vectors = {name: scale * np.array(offset) for name, offset in offsets.items()}
        axis = {"rrr_e_1": np.array([0.0, 0.0, 1.0])}
        return float(evaluate(size.rhs, {**vectors, **axis, "rrr_size_0": least}))

    assert at(times) == pytest.approx(times * at(1.0), rel=1e-5)
    assert at(0.0) > 0.0


def wrist() -> Manipulator:
    """Three axes through the point that they carry: no lever arm anywhere."""
    spec = mechanism("spherical", ["Rz0* Ry0* Rx* | rigid"], np.random.default_rng(0))
    (leg,) = spec.legs
    joints = tuple(replace(joint, offset=ZERO3) for joint in leg.joints)
    end = replace(leg.platform_joint, offset=ZERO3)
    point = replace(leg, joints=joints, platform_joint=end, platform_point=ZERO3)
    return replace(spec, legs=(replace(point, base_point=spec.fixed_centre or ZERO3),))


def test_a_wrist_has_a_length_too() -> None:
    spec = wrist()
    assert lever_arms(spec) == [0.0]
    found = home_lengths(spec, leg_types(spec)[0])
    assert found.arm == found.least == SMALLEST
    assert size_of(spec).rhs == SMALLEST


def scaled(spec: Manipulator, k: float) -> Manipulator:
    """The same mechanism k times as large."""

    def body(b: Body) -> Body:
        inertia = tuple(vector3(k * k * np.array(row)) for row in b.inertia)
        return replace(b, centre_of_mass=vector3(k * np.array(b.centre_of_mass)), inertia=inertia)

    def joint(j: Joint) -> Joint:
        return replace(
            j, offset=vector3(k * np.array(j.offset)), pitch=k * j.pitch, link=body(j.link)
        )

    def leg(of: Leg) -> Leg:
        end = of.platform_joint
        return replace(
            of,
            base_point=vector3(k * np.array(of.base_point)),
            platform_point=vector3(k * np.array(of.platform_point)),
            joints=tuple(map(joint, of.joints)),
            platform_joint=replace(end, offset=vector3(k * np.array(end.offset))),
        )

    slides = [not j.turns for of in spec.legs for j in of.joints]
    q = np.where(slides, k, 1.0) * np.array(spec.home.q)
    X = np.array(spec.home.X)
    X[:3] *= k
    home = Home(tuple(map(float, X)), tuple(map(float, q)))
    return replace(spec, platform=body(spec.platform), legs=tuple(map(leg, spec.legs)), home=home)


def completions(spec: Manipulator) -> list[tuple[Auxiliary, ...]]:
    found = []
    for leg_type in leg_types(spec):
        book = Book()
        book.chapter("G", "", "")
        g = build_geometry(book, leg_type, planar=False)
        g = with_size(book, g, home_lengths(spec, leg_type))
        found.append(completion_at_home(spec, g))
    return found


GUIDES = {
    "tricept": manipulators.load("tricept"),
    "two joints at U": mechanism(
        "spatial", ["Rz* Ry | U", *["Rz0 Ry Px* | S"] * 4], np.random.default_rng(7), plain=True
    ),
    "four joints at R": mechanism(
        "spatial", ["Rz* Ry Px* Rx | R", *["Rz0 Ry Px* | S"] * 3], np.random.default_rng(7)
    ),
}


@pytest.mark.parametrize("k", [1e-4, 1e4])
@pytest.mark.parametrize("name", GUIDES)
def test_what_completes_a_guide_does_not_depend_on_the_size_of_the_machine(
    name: str, k: float
) -> None:
    spec = GUIDES[name]
    assert completions(scaled(spec, k)) == completions(spec)
