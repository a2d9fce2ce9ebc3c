"""Which displacements are found by iteration, and where they stand in q."""

from __future__ import annotations

from pne_sym.derivation import Coordinates, Derivation
from pne_sym.program.ir import Closure


def closures(derivation: Derivation) -> tuple[Closure, ...]:
    """The leg types whose displacements are found by iteration."""
    c = _coordinates(derivation)
    found = []
    for t in derivation.leg_types:
        if t.is_closed:
            continue
        looked_for = [j for j in range(t.joints) if t.methods[j] != "given"]
        joints = tuple(tuple(c.joints.index((i, j)) for j in looked_for) for i in t.indices)
        turning = tuple(j for leg in joints for j in leg if c.turning[j])
        _, signs = derivation.parameters.branches.get(t.orientation_sign, ("", ()))
        found.append(Closure(t.name, joints, turning, t.orientation, signs, t.orientation_sign))
    return tuple(found)


def given_displacements(derivation: Derivation) -> tuple[tuple[int, int], ...]:
    """(position in q, position in X) of the extra coordinates."""
    c = _coordinates(derivation)
    return tuple((c.joints.index(e), k) for k, e in enumerate(c.extras, len(c.pose)))


def _coordinates(derivation: Derivation) -> Coordinates:
    assert derivation.coordinates is not None
    return derivation.coordinates
