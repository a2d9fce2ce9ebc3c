"""What functions of the program give besides where motors are coupled.

A motor turns with several joints, of several legs: what its rotor does is no sum over legs.  The
steps of public functions put it together (`program.algorithm`), from these arrays.
"""

from __future__ import annotations

from collections.abc import Collection

Group = tuple[tuple[str, tuple[str, ...]], ...]

_ROTORS = ("rotor_roots", "coupling")
_BESIDES: dict[str, tuple[str, ...]] = {
    "dynamics": ("actuated_bias", *_ROTORS),
    "M": ("H", *_ROTORS),
    "Z": ("H", "actuated_bias", *_ROTORS),
    "required": ("actuated_accelerations", *_ROTORS),
}
"""Function of the program -> arrays."""


def with_coupling(groups: tuple[Group, ...], made: Collection[str]) -> tuple[Group, ...]:
    """The groups of functions with the arrays that coupled rotors need, of those that are made."""
    if "rotor_roots" not in made:
        return groups
    return tuple(
        tuple(
            (name, arrays + tuple(a for a in _BESIDES.get(name, ()) if a == "H" or a in made))
            for name, arrays in group
        )
        for group in groups
    )
