"""Leg types: structure, given symbols, parameters, how each joint is solved."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.report.given import GivenWriter
from pne_sym.backends.report.markdown import inline, table
from pne_sym.backends.report.mechanism import model_joints
from pne_sym.backends.report.names import leg_indices, leg_title
from pne_sym.backends.report.view import LegView, Lines
from pne_sym.backends.report.words import METHODS
from pne_sym.derivation import Derivation, LegTypeInfo, ParameterField
from pne_sym.model.manipulator import ZERO3, Joint, Leg, Vector3

_TOLERANCE = 1e-9
_AXES = "xyz"


def leg_views(bundle: Bundle, given: GivenWriter) -> tuple[LegView, ...]:
    """All leg types."""
    return tuple(_leg(bundle, info, given) for info in bundle.derivation.leg_types)


def _leg(bundle: Bundle, info: LegTypeInfo, given: GivenWriter) -> LegView:
    derivation = bundle.derivation
    joints = model_joints(bundle.manipulator, info)
    return LegView(
        leg_title(info),
        _which(info, bundle.manipulator.legs, leg_indices(derivation)[info.name]),
        table(
            ("Joint", "Kind", "Role", "Axis", "To the axis before", "Offset", "Link"),
            [_joint_row(joints, j) for j in range(len(joints))],
        ),
        tuple(_closing(bundle, info)),
        given.frames(info),
        given.table(info),
    )


def _which(info: LegTypeInfo, legs: Sequence[Leg], letter: str) -> str:
    """Which legs are of a type, and their index in sums."""
    word = "Legs" if len(info.indices) > 1 else "Leg"
    numbers = f"{ranges([i + 1 for i in info.indices])}"
    called = ", ".join(f"{i + 1} is `{legs[i].name}`" for i in info.indices if legs[i].name)
    return (
        f"{word} {numbers}, of type `{info.name}`{'; ' * bool(called)}{called}; "
        f"index {inline(letter)} in sums."
    )


def ranges(numbers: Sequence[int]) -> str:
    """Numbers in short.

    >>> ranges([1, 2, 3, 5])
    '1 to 3, 5'
    """
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    return ", ".join(f"{r[0]} to {r[-1]}" if len(r) > 1 else str(r[0]) for r in runs)


# ---- structure -------------------------------------------------------------------------


def _joint_row(joints: Sequence[Joint], at: int) -> tuple[str, ...]:
    joint = joints[at]
    before = joints[at - 1].axis if at else None
    roles = [
        word
        for word, holds in (("actuated", joint.actuated), ("extra coordinate", joint.extra))
        if holds
    ]
    return (
        f"{at + 1}" + (f" `{joint.name}`" if joint.name else ""),
        joint.kind.word,
        ", ".join(roles) or "passive",
        _axis(joint.axis),
        _relation(before, joint.axis),
        _offset(joint.offset),
        "massless" if joint.link.is_massless else "with mass",
    )


def _axis(axis: Vector3) -> str:
    for k, component in enumerate(axis):
        if abs(abs(component) - 1) < _TOLERANCE:
            return f"along {'-' if component < 0 else ''}{_AXES[k]}"
    return "parameter"


def _relation(before: Vector3 | None, axis: Vector3) -> str:
    if before is None:
        return "-"
    along = sum(a * b for a, b in zip(before, axis, strict=True))
    if abs(along) < _TOLERANCE:
        return "perpendicular"
    return "parallel" if abs(abs(along) - 1) < _TOLERANCE else "oblique"


def _offset(offset: Vector3) -> str:
    if offset == ZERO3:
        return "none"
    return "along " + ", ".join(_AXES[k] for k in range(3) if offset[k] != 0.0)


def _closing(bundle: Bundle, info: LegTypeInfo) -> Iterator[str]:
    """The platform joint, and the signs of the assembly branches."""
    end = bundle.manipulator.legs[info.indices[0]].platform_joint
    kind = end.kind.word
    if bundle.coordinates.planar:
        kind = "pin (the points coincide)"
    offset = "" if end.offset == ZERO3 else f", offset {_offset(end.offset)}"
    yield f"Platform joint: {kind}{offset}."
    if not info.is_closed:
        yield _branch(bundle, info)


def _branch(bundle: Bundle, info: LegTypeInfo) -> str:
    """How the branch of iterated displacements is told."""
    if not info.orientation:
        return (
            "The iterated displacements are fewer than the conditions of the loop closure, and no "
            "sign tells their branches apart: the closure is the one reached from `q0`."
        )
    symbol = inline(bundle.derivation.notation[info.orientation_sign].latex)
    return (
        f"{symbol} is the sign of the determinant of the derivative of the loop closure by the "
        f"iterated displacements ({_conditions(bundle, info)}). Only a singular state of the leg "
        "changes it: from the last displacements of a path in steps small against the distance "
        "to the next one, the closure stays on the branch of home. A closure with another sign "
        "is refused: not converged."
    )


def _conditions(bundle: Bundle, info: LegTypeInfo) -> str:
    """Rows of the derivative, in words: axes of the last link, moment directions."""
    axes = 2 if bundle.coordinates.planar else 3
    if len(info.orientation) == axes + info.transmitted:
        return "all conditions"
    slides = ["xyz"[k] for k in info.orientation if k < axes]
    turns = [str(k - axes + 1) for k in info.orientation if k >= axes]
    parts = [f"along {', '.join(slides)} of the last link"] if slides else []
    return " and ".join(parts + [f"about moment direction {', '.join(turns)}"] * bool(turns))


def solved(info: LegTypeInfo) -> Iterator[str]:
    """How the inverse kinematics finds each joint."""
    reasons = dict(info.reasons)
    for j, method in enumerate(info.methods, 1):
        reason = f": {reasons[j]}" if reasons.get(j) else ", together with the others"
        words = METHODS.get(method, method).format(j=j, reason=reason)
        yield f"Joint {j}: {words}."


# ---- parameters ------------------------------------------------------------------------


def parameter_table(derivation: Derivation) -> Lines:
    """Live parameters, with their places in the full form."""
    head = ("Name", "Shape", "Path in the full form")
    return table(head, map(_parameter_row, derivation.parameters.fields))


def places(derivation: Derivation) -> str:
    """What i in paths stands for."""
    told = [f"{ranges(info.indices)} for {leg_title(info)} legs" for info in derivation.leg_types]
    return f"i is {', '.join(told)}, counted from 0"


def _parameter_row(field: ParameterField) -> tuple[str, ...]:
    shape = ", ".join(map(str, field.shape))
    path = field.paths[0]
    if field.leg_type:
        path = f"legs[i].{path.split('.', 1)[1]}"
    return f"`{field.name}`", f"({shape})" if shape else "scalar", f"`{path}`"
