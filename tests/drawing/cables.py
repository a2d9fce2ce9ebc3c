"""A platform on eight cables in a frame: legs that reach far, from corners at two heights."""

from __future__ import annotations

import itertools

import numpy as np

from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import from_mapping


def cable_robot(width: float = 4.0, depth: float = 3.0, height: float = 2.6) -> Manipulator:
    """Eight UPS legs from the corners of a box of the given size (m) to those of a small one."""
    home = np.array([0.0, 0.0, 0.5 * height])
    legs, q = [], []
    for signs in itertools.product((-1.0, 1.0), repeat=3):
        base = np.array(signs) * [0.5 * width, 0.5 * depth, 0.5 * height] + [0, 0, 0.5 * height]
        corner = np.array(signs) * [0.15, 0.2, -0.1]  # crossed: low corners from high ones
        cable = home + corner - base
        length = float(np.linalg.norm(cable))
        x = cable / length
        y = np.cross([0.0, 0.0, 1.0], x)
        y /= np.linalg.norm(y)
        frame = np.column_stack([x, y, np.cross(x, y)])
        legs.append(
            {
                "base_point": base.tolist(),
                "base_frame": frame.tolist(),
                "platform_point": corner.tolist(),
                "joints": [
                    {"kind": "U", "axes": ["z", "y"]},
                    {"kind": "P", "axis": "x", "actuated": True, "link": {"mass": 0.1}},
                ],
                "platform_joint": "S",
            }
        )
        q.append([0.0, 0.0, length])
    spec = {
        "name": "cable_robot",
        "title": "A platform on eight cables",
        "space": "spatial",
        "platform": {"mass": 8.0, "inertia": [0.3, 0.3, 0.3]},
        "legs": legs,
        "home": {"X": [*home.tolist(), 0.0, 0.0, 0.0, 1.0], "q": q},
    }
    return from_mapping(spec, "cable_robot")
