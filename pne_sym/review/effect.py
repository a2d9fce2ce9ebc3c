"""What a change does to what engineers design by: required forces, inertia, condition of H.

Each version is taken at its own defaults and its own home, and at states around it that are
the same for both where their platforms have the same coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from pne_sym.model.kinematics import Array
from pne_sym.review.alignment import Alignment
from pne_sym.review.correspondence import Correspondence, same_platform
from pne_sym.review.difference import Effect
from pne_sym.review.execution import Answer, ExecutionError
from pne_sym.review.model import Model
from pne_sym.review.samples import random_values
from pne_sym.review.values import Set, asked_of, request_for

STATES = 8
_ASKED = ("M", "H", "inverse_dynamics", "condition")
_HOME, _AROUND = "at home, at rest", f"at {STATES} states around home"
_SMALL = 1e-9


@dataclass(frozen=True)
class _Facts:
    """Of a version, per state; the first is home at rest.

    Attributes:
        forces: (states, actuators) required by inverse dynamics.
        least: (states,) eigenvalue of M.
        condition: (states,) of H, its moment rows over a length.
    """

    forces: Array
    least: Array
    condition: Array


def effects(
    before: Model, after: Model, alignment: Alignment, *, size: float, seed: int = 0
) -> tuple[Effect, ...]:
    """What differs, and what has no counterpart.

    Args:
        before: a version that may be run.
        after: likewise.
        alignment: of their legs and joints.
        size: a length of the mechanism, m.
        seed: of the states around home.

    Raises:
        ExecutionError: a version cannot be run.
    """
    common = same_platform(before.manifest, after.manifest)
    states = [_states(before, size, seed)]
    if common:
        states.append(_carried(states[0], before, after, alignment))
    else:
        states.append(_states(after, size, seed))
    facts = [_facts(m, s) for m, s in zip((before, after), states, strict=True)]
    own = Correspondence(after.manifest, before.manifest, alignment, backwards=True)
    places = own.joints("actuators")
    return tuple(_told(facts[0], facts[1], (before, after), places, common=common))


def _states(model: Model, size: float, seed: int) -> dict[str, Array]:
    """Home at rest, then states around it."""
    drawn = random_values(model.manifest, STATES + 1, size, np.random.default_rng(seed))
    found = {n: drawn[n].copy() for n in ("X", "V", "A")}
    found["X"][0] = model.manifest["home"]["X"]
    found["V"][0] = found["A"][0] = 0.0
    return found


def _carried(
    states: Mapping[str, Array], before: Model, after: Model, alignment: Alignment
) -> dict[str, Array]:
    """The same states as the other version orders them; home is its own."""
    own = Correspondence(before.manifest, after.manifest, alignment)
    found = {name: own.carried(name, states[name], 0.0) for name in ("X", "V", "A")}
    found["X"][0] = after.manifest["home"]["X"]
    return found


def _facts(model: Model, states: Mapping[str, Array]) -> _Facts:
    request = request_for(Set(None, dict(states)), consistent=True) | {"only": list(_ASKED)}
    answer = asked_of(model, [request])
    count = len(states["X"])
    M, H, forces = (_result(answer, name, count) for name in ("M", "H", "inverse_dynamics"))
    if M.ndim != 3 or H.ndim != 3 or forces.ndim != 2:
        raise ExecutionError(f"{model.label}: its NumPy module answers with other shapes")
    own = [_where_finite(H, lambda good: np.linalg.svd(good, compute_uv=False))]
    sigma = answer.calls[0].get(("condition", (), "batch"), own)[0]
    values, none = _where_finite(M, np.linalg.eigvalsh), np.full(count, np.nan)
    with np.errstate(all="ignore"):
        condition = sigma[:, 0] / sigma[:, -1] if sigma.shape[-1] else none
    return _Facts(forces, values[:, 0] if values.shape[-1] else none, condition)


def _result(answer: Answer, name: str, count: int) -> Array:
    found = answer.calls[0].get((name, (), "batch"))
    if not found or found[0].shape[:1] != (count,):
        return np.full((count, 0), np.nan)
    return found[0]


def _where_finite(matrices: Array, of: Callable[[Array], Any]) -> Array:
    """Figures of matrices, a row for each; NaN where a matrix has no value."""
    good = np.isfinite(matrices).all(axis=(1, 2))
    known = of(matrices[good])
    found = np.full((len(matrices), known.shape[1]), np.nan)
    found[good] = known
    return found


def _told(
    old: _Facts,
    new: _Facts,
    models: tuple[Model, Model],
    places: list[int | None],
    *,
    common: bool,
) -> Iterator[Effect]:
    actuators = [m.manifest["actuators"] for m in models]
    size = float(np.nanmax(np.abs(old.forces[0]), initial=0.0))
    for k, place in enumerate(places):
        what, unit = _force(models[0], *actuators[0][k])
        after = None if place is None else float(new.forces[0, place])
        yield _at_home(what, float(old.forces[0, k]), after, size, unit)
    for k in sorted(set(range(len(actuators[1]))) - set(places)):
        what, unit = _force(models[1], *actuators[1][k])
        yield _at_home(what, None, float(new.forces[0, k]), size, unit)
    figures = (
        ("least eigenvalue of M", old.least, new.least),
        ("condition of H", old.condition, new.condition),
    )
    for what, a, b in figures:
        yield _at_home(what, float(a[0]), float(b[0]), 0.0)
    if not common:
        return
    matched = [(k, place) for k, place in enumerate(places) if place is not None]
    if matched:
        rows, columns = (list(side) for side in zip(*matched, strict=True))
        names = [_force(models[0], *actuators[0][k]) for k in rows]
        yield _forces_around(old.forces[1:, rows], new.forces[1:, columns], names)
    for what, a, b in figures:
        yield _figure_around(what, a[1:], b[1:])


def _at_home(what: str, a: float | None, b: float | None, size: float, unit: str = "") -> Effect:
    """A figure at home; what is small against others of its kind may be rounding."""
    changed = a is None or b is None or np.isfinite(a) != np.isfinite(b)
    if a is not None and b is not None and np.isfinite(a) and np.isfinite(b):
        changed = abs(a - b) > _SMALL * max(abs(a), abs(b), size)
    return Effect(what, _HOME, a, b, bool(changed), unit)


def _force(model: Model, leg: int, joint: int) -> tuple[str, str]:
    """What an actuator gives, and its unit."""
    per_leg = [pair[0] for pair in model.manifest["actuators"]].count(leg)
    form = model.manifest.get("specification", {}).get("legs", [])
    try:
        kind = form[leg]["joints"][joint]["kind"]
    except (LookupError, TypeError):  # a stranger's manifest
        kind = "P"
    what, unit = ("force", "N") if kind == "P" else ("torque", "N m")
    place = f"leg {leg + 1}" + (f", joint {joint + 1}" if per_leg > 1 else "")
    return f"required {what} of {place}", unit


def _forces_around(old: Array, new: Array, names: list[tuple[str, str]]) -> Effect:
    """The largest change over states, beside the largest force of its actuator before."""
    both = np.isfinite(old) & np.isfinite(new)
    size = np.max(np.abs(np.where(both, old, 0.0)), axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.nan_to_num(np.where(both, np.abs(new - old), 0.0) / size, posinf=np.inf)
    at = np.unravel_index(int(np.argmax(step)), step.shape)
    what, unit = names[int(at[1])]
    pair = f"{what.partition(' of ')[2]}: {old[at]:.4g} -> {new[at]:.4g} {unit}"
    times = f"{step[at]:.3g} times" if step[at] >= 10.0 else f"{100.0 * step[at]:.3g} % of"
    share = f"by {times} the largest before, " if size[at[1]] else ""
    note = f"{share}{pair}" if step[at] > _SMALL else ""
    return _around("required forces", old, new, note, at)


def _figure_around(what: str, old: Array, new: Array) -> Effect:
    """The largest change over states of a figure that is not negative, beside itself."""
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.nan_to_num(np.where(np.isfinite(old) & np.isfinite(new), new / old - 1.0, 0.0))
    at = int(np.argmax(np.abs(step)))
    percent = f"{100.0 * step[at]:+.3g} %" if step[at] < 10.0 else f"{step[at] + 1.0:.3g} times"
    note = f"by up to {percent}, {old[at]:.4g} -> {new[at]:.4g}" if abs(step[at]) > _SMALL else ""
    return _around(what, old, new, note, at)


def _around(what: str, old: Array, new: Array, note: str, at: Any) -> Effect:
    """A change around home; also where a state is possible in one version only."""
    possible = [np.isfinite(side.reshape(len(side), -1)).all(axis=1) for side in (old, new)]
    lost = int((possible[0] != possible[1]).sum())
    if lost:
        note += f"{'; ' if note else ''}{lost} of {len(old)} states possible in one version only"
    return Effect(what, _AROUND, float(old[at]), float(new[at]), bool(note), note=note)
