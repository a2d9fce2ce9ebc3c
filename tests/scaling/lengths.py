"""The same mechanism built larger: every length multiplied, masses and times as they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.model.manipulator import Body, Home, Joint, Manipulator, Matrix3, Vector3
from tests.whole.cases import Array


def larger(spec: Manipulator, factor: float) -> Manipulator:
    """The mechanism `factor` times as large: what it is generated from, home and gravity too."""
    squared = factor**2

    def points(value: Vector3) -> Vector3:
        x, y, z = (factor * v for v in value)
        return (x, y, z)

    def body(value: Body) -> Body:
        rows = [tuple(squared * v for v in row) for row in value.inertia]
        return replace(
            value, centre_of_mass=points(value.centre_of_mass), inertia=cast("Matrix3", tuple(rows))
        )

    def joint(value: Joint) -> Joint:
        return replace(
            value,
            offset=points(value.offset),
            pitch=factor * value.pitch,
            link=body(value.link),
        )

    legs = tuple(
        replace(
            leg,
            base_point=points(leg.base_point),
            platform_point=points(leg.platform_point),
            joints=tuple(map(joint, leg.joints)),
            platform_joint=replace(leg.platform_joint, offset=points(leg.platform_joint.offset)),
        )
        for leg in spec.legs
    )
    home = Home(
        tuple(np.array(spec.home.X) * factor ** pose_powers(spec).astype(float)),
        tuple(np.array(spec.home.q) * factor ** joint_powers(spec).astype(float)),
    )
    centre = None if spec.fixed_centre is None else points(spec.fixed_centre)
    return replace(
        spec,
        name=f"{spec.name}_large" if factor > 1 else f"{spec.name}_small",
        gravity=points(spec.gravity),
        platform=body(spec.platform),
        legs=legs,
        home=home,
        fixed_centre=centre,
    )


def turning_extras(spec: Manipulator) -> list[bool]:
    """Whether each extra coordinate is an angle; that of a helix is, too."""
    return [joint.turns for leg in spec.legs for joint in leg.joints if joint.extra]


def pose_powers(spec: Manipulator) -> Array:
    """Power of the metre of the entries of X."""
    places = {"point": 2, "planar": 2, "spatial": 3, "translational": 3, "spherical": 0}[spec.space]
    extras = turning_extras(spec)
    angles = len(spec.home.X) - places - len(extras)
    return np.array([1] * places + [0] * angles + [int(not turns) for turns in extras])


def rate_powers(bundle: Bundle) -> Array:
    """Power of the metre of the entries of V and A."""
    rates = [int(c < 3) for c in bundle.coordinates.components]
    return np.array(rates + [int(not turns) for turns in turning_extras(bundle.manipulator)])


def force_powers(bundle: Bundle) -> Array:
    """Power of the metre of generalised forces: 1 of forces, 2 of moments."""
    return 2 - rate_powers(bundle)


def joint_powers(spec: Manipulator) -> Array:
    """Power of the metre of the entries of q."""
    return np.array([int(not joint.turns) for leg in spec.legs for joint in leg.joints])


def actuator_powers(bundle: Bundle) -> Array:
    """Power of the metre of the entries of tau."""
    c, joints = bundle.coordinates, joint_powers(bundle.manipulator)
    return 2 - np.array([joints[c.joints.index(a)] for a in c.actuators], dtype=int)


def scaled(bundle: Bundle, vectors: Mapping[str, Any], factor: float) -> dict[str, Array]:
    """X, V, A, q (and tau, wrench) of the same motion in the larger mechanism."""
    c = bundle.coordinates
    powers = {
        "X": pose_powers(bundle.manipulator),
        "V": rate_powers(bundle),
        "A": rate_powers(bundle),
        "q": joint_powers(bundle.manipulator),
        "tau": actuator_powers(bundle),
        "wrench": force_powers(bundle)[: len(c.wrench)],
    }
    return {n: np.asarray(v) * factor ** powers[n].astype(float) for n, v in vectors.items()}
