"""Shapes of the arrays that the functions of a program give."""

from __future__ import annotations

from pne_sym.derivation import Derivation


def shapes(derivation: Derivation) -> dict[str, tuple[int, ...]]:
    """Shape of every output array."""
    assert derivation.coordinates is not None
    n = derivation.coordinates.sizes
    legs = sum(len(t.indices) for t in derivation.leg_types)
    wide = 6 if derivation.coordinates.transmits_moments else 3
    closures = {
        f"{stem}_{t.name}": (len(t.indices), rows * (t.unknowns if stem == "jacobian" else 1))
        for t in derivation.leg_types
        if not t.is_closed
        for rows in ((2 if derivation.coordinates.planar else 3) + t.transmitted,)
        for stem in ("residual", "jacobian")
    }
    return {
        **closures,
        "M": (n["NV"], n["NV"]),
        "Z": (n["NV"],),
        "H": (n["NV"], n["NU"]),
        "Hk": (n["NV"], n["NC"]),
        "required": (n["NV"],),
        "q": (n["NJ"],),
        "qd": (n["NJ"],),
        "qdd": (n["NJ"],),
        "leg_force": (legs, wide),
        "actuator": (n["NU"], wide),
        "constraint_direction": (n["NC"], wide),
        "potential": (1,),
        **({"dissipation": (1,)} if _is_made(derivation, "dissipation") else {}),
        **{name: (n["NU"],) for name in _OF_MOTORS if _is_made(derivation, name)},
        **({"coupling": (n["NU"], n["NU"])} if _is_made(derivation, "coupling") else {}),
        **({"margins": (n["NJ"],)} if _is_made(derivation, "margins") else {}),
        **({"effort_limits": (n["NU"],)} if _is_made(derivation, "effort_limits") else {}),
        "constraints": (n["NC"],),
        "constraint_bias": (n["NC"],),
        "lengths": (2,),
        "pivots": (legs,),
        "reach": (legs,),
    }


_OF_MOTORS = (
    "motor_rates",
    "per_turn",
    "ratios",
    "actuated_rates",
    "actuated_accelerations",
    "actuated_bias",
    "rotor_roots",
)


def _is_made(derivation: Derivation, array: str) -> bool:
    """Whether something stands in an array that not every mechanism has."""
    return any(output.array == array for output in derivation.outputs)
