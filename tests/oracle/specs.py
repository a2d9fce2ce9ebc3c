"""Descriptions for tests: full forms read as they are, without validation.

Random geometry and random states are in `randomisation`, offered here as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pne_sym.model.manipulator import (
    IDENTITY3,
    Body,
    Home,
    Joint,
    JointKind,
    Leg,
    Manipulator,
    Matrix3,
    PlatformJoint,
    PlatformJointKind,
    Space,
    Vector3,
)
from tests.oracle.randomisation import State, random_state, randomise

__all__ = ["State", "from_dict", "random_state", "randomise"]

_PLANAR_SPACES = (Space.POINT, Space.PLANAR)


def from_dict(full_form: Mapping[str, Any]) -> Manipulator:
    """A manipulator from its full form; fields left out take the dataclasses' defaults.

    Vectors of two components (planar mechanisms) are embedded at z = 0.
    """
    space = Space(full_form["space"])
    gravity = (0.0, -9.81, 0.0) if space in _PLANAR_SPACES else (0.0, 0.0, -9.81)
    home = full_form["home"]
    centre = full_form.get("fixed_centre")
    return Manipulator(
        name=full_form["name"],
        title=full_form.get("title", full_form["name"]),
        space=space,
        gravity=_vector(full_form.get("gravity", gravity)),
        platform=_body(full_form.get("platform", {})),
        legs=tuple(_leg(leg) for leg in full_form["legs"]),
        home=Home(X=tuple(map(float, home["X"])), q=tuple(map(float, home["q"]))),
        fixed_centre=None if centre is None else _vector(centre),
    )


def _vector(components: Sequence[float]) -> Vector3:
    x, y, z = (float(component) for component in (*components, 0.0, 0.0, 0.0)[:3])
    return (x, y, z)


def _matrix(rows: Sequence[Sequence[float]]) -> Matrix3:
    first, second, third = (_vector(row) for row in rows)
    return (first, second, third)


def _body(data: Mapping[str, Any]) -> Body:
    default = Body()
    return Body(
        mass=float(data.get("mass", default.mass)),
        centre_of_mass=_vector(data.get("centre_of_mass", default.centre_of_mass)),
        inertia=_matrix(data.get("inertia", default.inertia)),
    )


def _joint(data: Mapping[str, Any]) -> Joint:
    return Joint(
        kind=JointKind(data["kind"]),
        axis=_vector(data["axis"]),
        offset=_vector(data.get("offset", ())),
        pitch=float(data.get("pitch") or 0.0),
        actuated=bool(data.get("actuated", False)),
        extra=bool(data.get("extra", False)),
        link=_body(data.get("link", {})),
    )


def _platform_joint(data: Mapping[str, Any]) -> PlatformJoint:
    axis_link, axis_platform = data.get("axis_link"), data.get("axis_platform")
    rotation = data.get("rotation")
    return PlatformJoint(
        kind=PlatformJointKind(data["kind"]),
        offset=_vector(data.get("offset", ())),
        axis_link=None if axis_link is None else _vector(axis_link),
        axis_platform=None if axis_platform is None else _vector(axis_platform),
        rotation=None if rotation is None else _matrix(rotation),
    )


def _leg(data: Mapping[str, Any]) -> Leg:
    return Leg(
        base_point=_vector(data.get("base_point", ())),
        base_frame=_matrix(data.get("base_frame", IDENTITY3)),
        joints=tuple(_joint(joint) for joint in data["joints"]),
        platform_joint=_platform_joint(data["platform_joint"]),
        platform_point=_vector(data.get("platform_point", ())),
    )
