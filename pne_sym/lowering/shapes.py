"""Shapes of the arrays that the functions of a program give."""

from __future__ import annotations

from pne_sym.derivation import Derivation

_ALWAYS = {
    "M": "NV NV", "Z": "NV", "H": "NV NU", "Hk": "NV NC", "required": "NV",
    "q": "NJ", "qd": "NJ", "qdd": "NJ", "constraints": "NC", "constraint_bias": "NC",
    "leg_force": "legs wide", "actuator": "NU wide", "constraint_direction": "NC wide",
    "potential": "1", "lengths": "2", "pivots": "legs", "reach": "legs",
}  # fmt: skip
_SOMETIMES = {
    "dissipation": "1", "margins": "NJ", "effort_limits": "NU", "coupling": "NU NU",
    "motor_rates": "NU", "per_turn": "NU", "ratios": "NU", "rotor_roots": "NU",
    "actuated_rates": "NU", "actuated_accelerations": "NU", "actuated_bias": "NU",
}  # fmt: skip
"""Arrays that not every mechanism has."""


def shapes(derivation: Derivation) -> dict[str, tuple[int, ...]]:
    """Shape of every output array."""
    c = derivation.coordinates
    assert c is not None
    sizes = {"1": 1, "2": 2, "wide": 6 if c.transmits_moments else 3, **c.sizes}
    sizes["legs"] = sum(len(t.indices) for t in derivation.leg_types)
    made = {output.array for output in derivation.outputs}
    found = {}
    for t in (t for t in derivation.leg_types if not t.is_closed):
        rows = (2 if c.planar else 3) + t.transmitted
        found[f"residual_{t.name}"] = (len(t.indices), rows)
        found[f"jacobian_{t.name}"] = (len(t.indices), rows * t.unknowns)
    named = _ALWAYS | {array: n for array, n in _SOMETIMES.items() if array in made}
    return found | {array: tuple(sizes[n] for n in names.split()) for array, names in named.items()}
