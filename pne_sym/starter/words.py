"""What the comments of a starter say."""

from __future__ import annotations

import textwrap

from pne_sym.model.manipulator import Space
from pne_sym.starter.chain import Plain

SPACES: dict[Space, str] = {
    Space.POINT: "X = x, y of the output point; V = their rates",
    Space.PLANAR: "X = x, y, phi; V = their rates",
    Space.SPATIAL: "X = x, y, z, quaternion (qx, qy, qz, qw); V = velocity, angular velocity",
    Space.TRANSLATIONAL: "X = x, y, z; the platform keeps the orientation of the base",
    Space.SPHERICAL: "X = quaternion (qx, qy, qz, qw); the platform turns about fixed_centre",
}
HEAD = (
    "#",
    "# A starting point: the numbers are plausible, not yours. Put in your own.",
    "# Units: m, kg, s, N, rad. Frames: the base frame is fixed; the platform frame moves with",
    "# the platform; a leg frame is fixed at base_point and turned by base_frame; a link's frame",
    "# sits at its joint and is parallel to the leg frame when all displacements are zero.",
    "# Inertias are about the body's own centre of mass. docs/spec-format.md explains every field.",
    "#",
)
LEGS: dict[bool, tuple[str, ...]] = {
    True: (
        "# base_point (base frame) is where the leg starts, platform_point (platform frame) where",
        "# it ends. base_frame turns the leg frame, here about z by the third angle (degrees).",
        "# A field of the leg type that differs in one leg: joints.0.link.mass = 1.5",
    ),
    False: (
        "# base_point (base frame) is where the leg starts, platform_point (platform frame) where",
        "# it ends. base_frame: roll, pitch, yaw in degrees; with -90, -90 the leg's x axis points",
        "# up, its y axis outwards in the direction of the third angle, its z axis across.",
        "# A field of the leg type that differs in one leg: joints.0.link.mass = 1.5",
    ),
}
HOME = (
    "# A pose X at which the loops close with the displacements q, leg by leg from the base; it",
    "# also selects the assembly branch. After a change of geometry the old numbers may stand as",
    "# a guess: pne-gen closes the loops where it is within 0.5 (m or rad), and tells the change.",
)


def joint_comment(text: str, fields: Plain) -> list[str]:
    """Comment lines of a joint."""
    if fields.get("actuated"):
        text += " Actuated."
    if fields.get("extra"):
        text += " A degree of freedom marked extra is a coordinate of its own, appended to X."
    return textwrap.wrap(text, 96, initial_indent="# ", subsequent_indent="# ")
