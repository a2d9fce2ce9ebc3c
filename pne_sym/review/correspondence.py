"""Entries of the flat vectors of one version in those of another: by coordinate, leg and joint."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pne_sym.model.kinematics import Array
from pne_sym.review.alignment import Alignment

Places = list[int | None]
"""Per entry of a version, its position in the other; None where it has no counterpart."""


class Correspondence:
    """Where the entries of a version stand in the other.

    Args:
        one: manifest of the version whose vectors are known.
        other: of the one whose vectors are wanted.
        alignment: of before and after.
        backwards: the version that is wanted is the one before.
    """

    def __init__(
        self,
        one: Mapping[str, Any],
        other: Mapping[str, Any],
        alignment: Alignment,
        *,
        backwards: bool = False,
    ) -> None:
        self.one, self.other = one, other
        pairs = {
            (leg, joint): (old, alignment.joints[leg][joint])
            for leg, old in alignment.legs.items()
            for joint in alignment.joints[leg]
        }
        self.partner = {v: k for k, v in pairs.items()} if backwards else pairs

    def joints(self, key: str) -> Places:
        """Of q (`joints`), tau (`actuators`) or the extra coordinates (`extra`)."""
        known = [tuple(pair) for pair in self.one[key]]
        found: Places = []
        for pair in self.other[key]:
            partner = self.partner.get(tuple(pair))
            found.append(known.index(partner) if partner in known else None)
        return found

    def coordinates(self, name: str) -> Places:
        """Of X or V: the platform's coordinates, then the extra ones."""
        known, own = (m["coordinates"][name] for m in (self.one, self.other))
        found: Places = [known.index(n) if n in known else None for n in own]
        extra = self.joints("extra")
        return found + [None if k is None else len(known) + k for k in extra]

    def of(self, argument: str) -> Places | None:
        """Of an argument of a function; None where all versions order it alike."""
        if argument in ("X", "X0"):
            return self.coordinates("X")
        if argument in ("V", "A", "direction"):
            return self.coordinates("V")
        if argument in ("q", "q0"):
            return self.joints("joints")
        if argument in ("tau", "weights", "q_actuated", "tau_min", "tau_max", "reference"):
            return self.joints("actuators")
        return None

    def carried(self, argument: str, value: Array, fill: float) -> Array:
        """Values of an argument as the other version orders its entries.

        Args:
            argument: its name.
            value: (..., n).
            fill: what entries without counterpart have; of poses and displacements they are home's.
        """
        if (places := self.of(argument)) is None:
            return value
        found = np.full((*value.shape[:-1], len(places)), fill)
        if argument in ("X", "X0", "q", "q0"):
            found[...] = self.other["home"][argument[0]]
        for k, place in enumerate(places):
            if place is not None:
                found[..., k] = value[..., place]
        return found


def same_platform(before: Mapping[str, Any], after: Mapping[str, Any]) -> bool:
    """Whether the platform's coordinates and velocities mean the same in both versions."""
    old, new = before["coordinates"], after["coordinates"]
    return all(old[name] == new[name] for name in ("X", "V", "wrench"))
