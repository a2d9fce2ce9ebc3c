"""A manipulator as the full form of its specification: plain, JSON-ready, without shorthand."""

from __future__ import annotations

from collections.abc import Sequence

from pne_sym.model.joint_kinds import JointKind
from pne_sym.model.manipulator import (
    Body,
    Joint,
    Leg,
    Manipulator,
    Matrix3,
    PlatformJoint,
)
from pne_sym.model.read_effects import FIELDS as EFFECTS

Plain = dict[str, object]
_PITCHED = {kind.letter for kind in JointKind if kind.pitched}


def to_full_form(manipulator: Manipulator) -> Plain:
    """The full form; reading it gives an equal manipulator."""
    m = manipulator
    form: Plain = {
        "name": m.name,
        "title": m.title,
        "space": str(m.space),
        "gravity": list(m.gravity),
    }
    if m.fixed_centre is not None:
        form["fixed_centre"] = list(m.fixed_centre)
    if m.moving_base:
        form["moving_base"] = True
    if m.coupling is not None:
        form["coupling"] = [list(row) for row in m.coupling]
    form["platform"] = _body(m.platform)
    if m.payload is not None:
        form["platform"] = _body(m.platform) | {"payload": _body(m.payload)}
    form["legs"] = [_leg(leg) for leg in m.legs]
    form["home"] = {"X": list(m.home.X)} | ({"q": list(m.home.q)} if m.home.q else {})
    if m.symbols:
        form["symbols"] = dict(m.symbols)
    return form


def _leg(leg: Leg) -> Plain:
    names = {"type": leg.type, "name": leg.name}
    return {key: name for key, name in names.items() if name} | {
        "base_point": list(leg.base_point),
        "base_frame": _rows(leg.base_frame),
        "joints": [_joint(joint) for joint in leg.joints],
        "platform_joint": _platform_joint(leg.platform_joint),
        "platform_point": list(leg.platform_point),
    }


def _joint(joint: Joint) -> Plain:
    named: Plain = {"name": joint.name} if joint.name else {}
    form: Plain = named | {
        "kind": str(joint.kind),
        "axis": list(joint.axis),
        "offset": list(joint.offset),
    }
    if str(joint.kind) in _PITCHED:
        form["pitch"] = joint.pitch
    form |= {
        "actuated": joint.actuated,
        "extra": joint.extra,
        "link": _body(joint.link),
    }
    effects = {name: getattr(joint, name) for name in EFFECTS}
    return form | {name: _present(each) for name, each in effects.items() if each is not None}


def _present(effect: object) -> Plain:
    """The fields that are there."""
    fields = {name: value for name, value in vars(effect).items() if value is not None}
    return {n: list(v) if isinstance(v, tuple) else v for n, v in fields.items()}


def _platform_joint(joint: PlatformJoint) -> Plain:
    form: Plain = {"kind": str(joint.kind), "offset": list(joint.offset)}
    if joint.axis_link is not None:
        form["axis_link"] = list(joint.axis_link)
    if joint.axis_platform is not None:
        form["axis_platform"] = list(joint.axis_platform)
    if joint.rotation is not None:
        form["rotation"] = _rows(joint.rotation)
    if joint.friction is not None:
        form["friction"] = _present(joint.friction)
    return form


def _body(body: Body) -> Plain:
    return {
        "mass": body.mass,
        "centre_of_mass": list(body.centre_of_mass),
        "inertia": _rows(body.inertia),
    }


def _rows(matrix: Matrix3 | Sequence[Sequence[float]]) -> list[list[float]]:
    return [list(row) for row in matrix]
