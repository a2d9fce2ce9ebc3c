"""Whether accelerations of passive extra coordinates can bring other forces about.

Where actuators and constraints leave combinations of rows idle, an acceleration has forces only if
it meets as many conditions.  Mostly the passive extra coordinates follow from them.  A coordinate
whose acceleration is felt by none of these rows (a slide that only the platform feels) does not:
then these are conditions on the other accelerations, and nothing is to be completed.  The rows
are those of M, so that the program itself is asked, at home and at poses away from it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.derivation import Derivation
from pne_sym.mechanics.actuation import elsewhere
from pne_sym.model.errors import SpecError
from pne_sym.model.kinematics import Array
from pne_sym.program.evaluate import evaluate, prepare
from pne_sym.program.interpret import REST
from pne_sym.program.iteration import close_loops

_POSES = 3
"""Poses beside home."""
_FELT = 1e-7
"""A smaller effect, as a fraction of the terms that it is the sum of, is rounding."""


def completes(bundle: Bundle) -> bool:
    """Whether accelerations of passive extra coordinates follow from the rows that are idle.

    Raises:
        SpecError: some of them do and others do not.
    """
    facts = bundle.coordinates.actuation
    if not (facts.idle and facts.is_determined and facts.is_coupled):
        return True
    influence = max(_influence(*matrices) for matrices in _samples(bundle))
    if influence in (0, facts.idle):
        return influence > 0
    raise SpecError(
        bundle.name,
        "legs",
        f"accelerations of passive extra coordinates meet {influence} of {facts.idle} conditions "
        "that actuators and constraints leave open",
        "actuators on which every acceleration of the platform, or of extra joints, depends",
    )


def without_completion(derivation: Derivation) -> Derivation:
    """The derivation of a manipulator whose accelerations are not to be completed."""
    coordinates = derivation.coordinates
    assert coordinates is not None
    facts = replace(coordinates.actuation, completes=False)
    return replace(derivation, coordinates=replace(coordinates, actuation=facts))


def _samples(bundle: Bundle) -> list[tuple[Array, Array, tuple[int, ...], int]]:
    """M, [H Hk], passive rows and the rank of [H Hk], at every pose."""
    rng, facts = np.random.default_rng(0), bundle.coordinates.actuation
    moved = (elsewhere(bundle.manipulator, rng) for _ in range(_POSES))
    homes = [bundle.manipulator.home, *(m.home for m in moved if m is not None)]
    prepared = prepare(bundle.program, bundle.derivation.parameters.values())
    found = []
    for home in homes:
        X = np.array([home.X])
        q, _ = close_loops(bundle.program, prepared, X, np.array(home.q))
        still = np.zeros((1, bundle.coordinates.sizes["NV"]))
        vectors = {"X": X, "V": still, "base": REST[None], "q": q}
        arrays = evaluate(bundle.program, "dynamics", prepared, vectors).outputs
        actuators = [arrays[name][0] for name in ("H", "Hk") if name in arrays]
        found.append((arrays["M"][0], np.hstack(actuators), facts.passive, facts.rank))
    return found


def _influence(M: Array, actuators: Array, passive: tuple[int, ...], rank: int) -> int:
    """Rank of what the idle rows feel of the passive extra coordinates; 0 if not finite."""
    if not (np.isfinite(M).all() and np.isfinite(actuators).all()):
        return 0
    idle = np.linalg.svd(actuators)[0][:, rank:].T
    columns = M[:, list(passive)]
    sizes = np.linalg.norm(columns, axis=0)
    effect = idle @ columns / np.where(sizes > 0.0, sizes, 1.0)
    return int(np.sum(np.linalg.svd(effect, compute_uv=False) > _FELT))
