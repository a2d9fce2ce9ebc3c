"""How times grow with the legs and with the states of a call."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bench.c_programs import our_program
from bench.cases import Array, Case
from bench.programs import measure
from pne_sym import manipulators
from pne_sym.model.manipulator import Leg, Manipulator, Vector3
from pne_sym.model.reader import checked

LEGS = {"planar_3rpr": ((3, 6, 12, 24, 60), 1), "stewart": ((6, 12, 24, 60), 2)}
"""Numbers of legs, and how many legs stand together."""
SHOWN = {"planar_3rpr": "n-RPR in the plane", "stewart": "n-UPS"}
STATES = (1, 10, 100, 1000, 10_000, 100_000, 1_000_000)
PROCESSES = 3
ENOUGH = 0.3
"""Seconds for which a call is repeated; the least time counts."""
HEADS = {"inverse_dynamics": "inverse dynamics", "dynamics": "M, Z, H"}


def with_legs(name: str, count: int, together: int) -> Manipulator:
    """A manipulator with so many legs, set around the home of its platform."""
    plain = manipulators.load(name)
    centre = np.array([*plain.home.X[:2], 0.0])
    legs = []
    for k in range(count):
        angle = 2.0 * math.pi * (k // together) * together / count
        legs.append(_turned(plain.legs[k % together], angle, centre))
    joints = sum(len(leg.joints) for leg in plain.legs[:together])
    home = replace(plain.home, q=plain.home.q[:joints] * (count // together))
    return checked(replace(plain, name=f"{name}_{count}", legs=tuple(legs), home=home))


def _turned(leg: Leg, angle: float, centre: Array) -> Leg:
    """A leg turned about the vertical through the platform's home."""
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    base_point = centre + turn @ (np.array(leg.base_point) - centre)
    base_frame = turn @ np.array(leg.base_frame)
    return replace(
        leg,
        base_point=_vector(base_point),
        base_frame=(_vector(base_frame[0]), _vector(base_frame[1]), _vector(base_frame[2])),
        platform_point=_vector(turn @ np.array(leg.platform_point)),
    )


def _vector(entries: Array) -> Vector3:
    x, y, z = map(float, entries)
    return x, y, z


def over_legs() -> dict[str, list[list[float]]]:
    """Curves of our C by gcc: (legs, nanoseconds)."""
    programs = []
    for name, (counts, together) in LEGS.items():
        for count in counts:
            case = Case(f"{name}_{count}", with_legs(name, count, together))
            case.generate()
            programs.append(our_program(case))
    curves: dict[str, list[list[float]]] = {}
    for row in measure(programs, PROCESSES):
        if row["function"] != "forward_dynamics":
            name, count = row["mechanism"].rsplit("_", 1)
            how = row["who"].replace("ours", HEADS[row["function"]])
            curves.setdefault(f"{SHOWN[name]}: {how}", []).append([int(count), row["ns"]])
    return dict(sorted(curves.items()))


def _nanoseconds(call: Callable[[], Any], states: int) -> float:
    """Of a state: the least of calls that take a while together."""
    best, spent = math.inf, 0.0
    call()
    while spent < ENOUGH:
        start = time.perf_counter()
        call()
        taken = time.perf_counter() - start
        best, spent = min(best, taken), spent + taken
    return 1e9 * best / states


def over_states() -> dict[str, list[list[float]]]:
    """Curves of the Stewart platform, from Python: (states, nanoseconds)."""
    case = Case("stewart")
    most = case.states(1000)
    modules = {"NumPy": case.module(), "extension (our C)": case.module("_ext")}
    curves: dict[str, list[list[float]]] = {}
    for count in STATES:
        rows = np.arange(count) % 1000
        X, V, A = (a[rows] for a in (most.X, most.V, most.A))
        for who, m in modules.items():
            for label, call in (
                ("inverse dynamics", partial(m.inverse_dynamics, X, V, A)),
                ("M, Z, H", partial(m.dynamics, X, V)),
            ):
                points = curves.setdefault(f"{who}: {label}", [])
                points.append([count, round(_nanoseconds(call, count), 1)])
    return dict(sorted(curves.items()))
