"""What the mechanism is: summary, case of the paper, dimensions, order of all vectors."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.report.markdown import table, unit
from pne_sym.backends.report.names import leg_title
from pne_sym.backends.report.view import Lines
from pne_sym.backends.report.words import CASES, SPACES
from pne_sym.derivation import LegTypeInfo
from pne_sym.model.joint_kinds import WrittenJoint
from pne_sym.model.manipulator import Joint, Manipulator
from pne_sym.model.platform_kinds import PlatformJointKind

_SIZES = {
    "NQ": "size of X: coordinates of the platform, and extra coordinates",
    "NV": "size of V and A, rows of M, Z and H",
    "NU": "size of tau: actuators, columns of H",
    "NC": "size of lambda: constraints, columns of Hk",
    "NW": "size of a wrench",
    "NJ": "size of q: displacements of all joints of the legs",
}


def summary(bundle: Bundle) -> str:
    """What moves, what carries it, what is actuated."""
    manipulator = bundle.manipulator
    parts = [
        f"{len(info.indices)} {leg_title(info)} leg{'s' * (len(info.indices) > 1)}"
        for info in bundle.derivation.leg_types
    ]
    carried = " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)
    stars = ", a star marks a joint whose displacement is an extra coordinate"
    return (
        f"The mechanism is {SPACES[manipulator.space.value]}, carried by {carried} in parallel. "
        f"Legs are named from the base to the platform ({_letters(bundle)}); actuated joints are "
        f"underlined{stars if bundle.coordinates.extras else ''}."
    )


def _letters(bundle: Bundle) -> str:
    """The letters of the architectures that occur."""
    titles = "".join(info.title for info in bundle.derivation.leg_types)
    kinds = {kind.letter: kind.word for kind in (*WrittenJoint, *PlatformJointKind)}
    return ", ".join(
        f"{k}: {word} joint" for k, word in kinds.items() if len(k) == 1 and k in titles
    )


def cases(bundle: Bundle) -> tuple[str, ...]:
    """The cases of section 3 of the paper that apply."""
    return tuple(CASES[case] for case in bundle.coordinates.cases)


def sizes(bundle: Bundle) -> Lines:
    """Dimensions."""
    values = bundle.coordinates.sizes
    rows = [(f"`{key}`", _SIZES[key], str(values[key])) for key in _SIZES]
    return table(("Name", "Meaning", "Value"), rows, numbers=1)


def orders(bundle: Bundle) -> Lines:
    """What the entries of all vectors are, in which order."""
    return table(("Vector", "Entries, in this order"), _order_rows(bundle))


def _order_rows(bundle: Bundle) -> Iterator[tuple[str, str]]:
    c = bundle.coordinates
    extra = _per_type(bundle, lambda joint: joint.extra)
    pose, rates = ", ".join(c.pose), ", ".join(c.rates)
    if c.extras:
        pose += f"; then the extra coordinates: {extra}"
        rates += "; then those of the extra coordinates"
    yield "`X`", pose
    yield "`V`, `A`", f"{rates} (A: their derivatives)"
    yield (
        "`tau`",
        _per_type(bundle, lambda joint: joint.actuated, lambda joint: joint.kind.effort_unit)
        or "none",
    )
    yield "`q`", _per_type(bundle, lambda _: True)
    if c.constraints:
        units = ", ".join(map(unit, c.constraint_units))
        yield (
            "`lambda`",
            f"coefficients of the legs' constraint wrenches, leg by leg ({units})",
        )
    yield "`wrench`", f"{', '.join(c.wrench)}: external force and moment on the platform"
    if any(not info.is_closed for info in bundle.derivation.leg_types):
        yield (
            "`q0`",
            (
                "first guess of the displacements, as q, where they are iterated; default: home. "
                "Along a trajectory the last q serves best"
            ),
        )


def _per_type(
    bundle: Bundle,
    pick: Callable[[Joint], bool],
    measure: Callable[[Joint], str] = lambda joint: joint.kind.unit,
) -> str:
    """Joints picked, by leg type: one statement for all legs of the type."""
    parts = []
    for info in bundle.derivation.leg_types:
        joints = model_joints(bundle.manipulator, info)
        chosen = [
            f"{j} ({unit(measure(joint))})" for j, joint in enumerate(joints, 1) if pick(joint)
        ]
        if chosen:
            word = "joints" if len(chosen) > 1 else "joint"
            parts.append(f"of every {leg_title(info)} leg {word} {', '.join(chosen)}")
    return "; ".join(parts) + ("; legs in their order" if parts else "")


def model_joints(manipulator: Manipulator, info: LegTypeInfo) -> tuple[Joint, ...]:
    """Joints of the leg whose structure stands for its type."""
    return manipulator.legs[info.indices[0]].joints


def equation_of_motion(bundle: Bundle) -> tuple[str, ...]:
    """The result, Eq. 5 and its kin."""
    lines = [
        r"\mathbf M(X)\,\mathbf A + \mathbf Z(X, V)",
        r"= \mathbf H(X)\,\boldsymbol\tau",
        r"+ \mathbf F_{\mathrm{ext}}",
    ]
    if bundle.coordinates.sizes["NC"]:
        lines.append(r"+ \mathbf H_k(X)\,\boldsymbol\lambda")
    return tuple(lines)
