"""Potential energy, and what friction takes."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.derivation import Book, Law, Output
from pne_sym.mechanics.leg_chain import LegChain
from pne_sym.mechanics.legs import Leg
from pne_sym.mechanics.lumping import PlatformInertia
from pne_sym.mechanics.platform_motion import PlatformMotion
from pne_sym.vector import Dot, ZeroVector, sum_over_legs, vector_sum


def write_potential(
    book: Book,
    platform: PlatformMotion,
    inertia: PlatformInertia,
    legs: list[Leg],
) -> None:
    """Potential energy, zero at the base origin."""
    sprung = any(leg.dynamics.forces.potential != 0 for leg in legs)
    text = "Weight times height, zero at the base origin" + ", and the energy of springs" * sprung
    book.chapter("V", "Potential energy", f"{text}.")
    total: Any = -Dot(platform.weight, inertia.mass * platform.t + inertia.moment)
    for leg in legs:
        g = leg.g
        terms: list[Any] = []
        for body in leg.dynamics.bodies:
            if not body.at_tip:  # its mass is counted with the platform
                terms.append(
                    body.mass * vector_sum((g.base_point, *_path(leg.motion.chain, body.joint)))
                )
            terms.append(body.first_moment)
        moment = vector_sum(terms)
        if moment != ZeroVector:
            total = total + sum_over_legs(-Dot(platform.weight, moment), leg.name)
        total = total + sum_over_legs(leg.dynamics.forces.potential, leg.name)
    energy = book.define("potential", total, r"\mathcal E", "potential energy", Law.ENERGY)
    book.outputs.append(Output("potential", energy, ((0, 0),)))


def write_dissipation(book: Book, legs: list[Leg]) -> None:
    """Power that friction takes, where there is any."""
    taken = [(leg.name, leg.dynamics.forces.dissipation) for leg in legs]
    total = sp.Add(*(sum_over_legs(power, name) for name, power in taken))
    if total == 0:
        return
    book.chapter("D", "Dissipation", "Friction times rate, of all joints; never negative.")
    power = book.define(
        "dissipation", total, r"\mathcal D", "power that friction takes", Law.FRICTION
    )
    book.outputs.append(Output("dissipation", power, ((0, 0),)))


def _path(chain: LegChain, joint: int) -> list[Any]:
    """Vectors from the base point to the origin of a link."""
    group, path = chain.g.group[joint], [chain.reach(joint)]
    while group:
        group = chain.g.group[group - 1]
        path.append(chain.spans[group])
    return path
