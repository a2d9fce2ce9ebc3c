"""Small valid specifications for the tests to spoil, and ways to spoil them."""

from __future__ import annotations

import copy
import math
from typing import Any

Spec = dict[str, Any]


def planar() -> Spec:
    """A 2-RPR mechanism with a point output, in short hand."""
    return {
        "name": "pair",
        "space": "point",
        "platform": {"mass": 0.5},
        "leg_types": {
            "rpr": {
                "joints": [
                    {"kind": "R", "link": {"mass": 1.0, "centre_of_mass": [0.1, 0.0]}},
                    {"kind": "P", "axis": "x", "actuated": True},
                ]
            }
        },
        "legs": [
            {"type": "rpr", "base_point": [0.0, 0.0]},
            {"type": "rpr", "base_point": [2.0, 0.0]},
        ],
        "home": {
            "X": [1.0, 1.0],
            "q": [[math.pi / 4, math.sqrt(2)], [3 * math.pi / 4, math.sqrt(2)]],
        },
    }


def spatial(**leg: Any) -> Spec:
    """One leg of a P joint up the z axis and a spherical platform joint, in full form."""
    return {
        "name": "lift",
        "title": "A lift",
        "space": "spatial",
        "gravity": [0.0, 0.0, -9.81],
        "platform": {
            "mass": 2.0,
            "centre_of_mass": [0.0, 0.0, 0.1],
            "inertia": [[0.2, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]],
        },
        "legs": [
            {
                "base_point": [0.0, 0.0, 0.0],
                "base_frame": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                "joints": [
                    {
                        "kind": "P",
                        "axis": [0.0, 0.0, 1.0],
                        "offset": [0.0, 0.0, 0.0],
                        "actuated": True,
                        "extra": False,
                        "link": {
                            "mass": 1.0,
                            "centre_of_mass": [0.0, 0.0, 0.0],
                            "inertia": [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]],
                        },
                    }
                ],
                "platform_joint": {"kind": "S", "offset": [0.0, 0.0, 0.0]},
                "platform_point": [0.0, 0.0, 0.0],
            }
            | leg
        ],
        "home": {"X": [0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 1.0], "q": [0.5]},
    }


_ABSENT = object()
ABSENT: Any = _ABSENT


def spoilt(spec: Spec, path: str, value: Any) -> Spec:
    """The specification with one field replaced, added, or (ABSENT) taken away."""
    result = copy.deepcopy(spec)
    *parents, last = (int(key) if key.isdigit() else key for key in path.split("."))
    target: Any = result
    for key in parents:
        target = target[key]
    if value is ABSENT:
        del target[last]
    else:
        target[last] = value
    return result
