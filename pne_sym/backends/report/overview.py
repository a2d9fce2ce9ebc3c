"""The first page: what moves, the forces of the legs, the equation of motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.blocks import ARRAYS, block_matrix, defines_blocks
from pne_sym.backends.report.collected import Collected
from pne_sym.backends.report.coupling import of_rotors
from pne_sym.backends.report.legforce import closed_force
from pne_sym.backends.report.markdown import inline
from pne_sym.backends.report.names import leg_indices, leg_title
from pne_sym.backends.report.view import Statement
from pne_sym.derivation import Derivation, LegTypeInfo, Role
from pne_sym.model.leg_types import a_leg
from pne_sym.vector import Cross
from pne_sym.vector.nodes import VectorScale

_SHOWN = ("M", "Z", "H", "Hk")


def overview(bundle: Bundle, collected: Collected, printer: LatexPrinter) -> Iterator[Statement]:
    """Force of every leg type, blocks of M, Z and H, and what these are."""
    derivation = bundle.derivation
    for info in derivation.leg_types:
        lines = closed_force(derivation, collected, info.name, printer)
        if lines:
            yield Statement(
                f"{_a_leg(info)} acts on the platform with the force (Eq. 4; [derivation]"
                f"(#chapter-{info.name}-N))",
                lines,
            )
            yield Statement(_meaning(derivation, info, printer), ())
    blocks = {
        array: (
            *block_matrix([o for o in derivation.outputs if o.array == array], latex, printer),
            *of_rotors(derivation, array),
        )
        for array, latex, _ in ARRAYS
        if array in _SHOWN and any(o.array == array for o in derivation.outputs)
    }
    letters = leg_indices(derivation)
    over = " and ".join(
        f"{inline(letters[info.name])} runs over the {leg_title(info)} legs"
        for info in derivation.leg_types
    )
    text = f"Put into Newton's and Euler's equations of the platform these give ({over}):"
    for row in (("M", "Z"), ("H", "Hk")) if "Hk" in blocks else (tuple(blocks),):
        first, *others = (blocks[array] for array in row)
        beside = (line for lines in others for line in (r",\qquad", *lines))
        yield Statement(text, (*first, *beside))
        text = "and for actuators and reactions:"
    chapter = next((c for c in derivation.chapters if defines_blocks(derivation, c)), None)
    if chapter is not None:
        indexed = printer.with_index()
        rows = [f"{indexed.doprint(e.lhs)} &= {indexed.doprint(e.rhs)}" for e in chapter.equations]
        rows = [f"{row} \\\\" for row in rows[:-1]] + rows[-1:]
        yield Statement(
            f"with blocks in which mass and inertia of the last links are counted where they move "
            f"with the platform ([derivation](#chapter-{chapter.id})):",
            (r"\begin{aligned}", *rows, r"\end{aligned}"),
        )


def _a_leg(info: LegTypeInfo) -> str:
    """A leg of a type, where a sentence begins."""
    spelled = a_leg(info.title).replace(info.title, leg_title(info))
    return f"A{spelled[1:]}"


def _meaning(derivation: Derivation, info: LegTypeInfo, printer: LatexPrinter) -> str:
    """What stands in the force of a leg, in words."""
    own = [q for q in derivation.notation.values() if q.leg_type == info.name]
    role = {q.role: inline(str(printer.glyph_of(q.name))) for q in own}
    along = [
        inline(printer.doprint(o.value))
        for o in derivation.outputs
        if o.array == "actuator" and o.leg_type == info.name and o.columns[0][1] == 0
    ]
    units = unit_vectors(derivation, info.name)
    told = ", ".join(
        f"{inline(str(printer.glyph_of(name)))} is {inline(printer.doprint(e))}, the unit "
        "vector along the leg"
        for name, e in units.items()
    )
    by = f"Actuators push along {', '.join(along)}" if along else "It has no actuator"
    by += f" ({told})" if told and along else ""
    if Role.LEG_INERTIA in role:
        by += (
            f"; against the acceleration {role[Role.COLLECTED_ACCELERATION]} of its connection "
            f"point (less the centripetal part) it acts like the inertia {role[Role.LEG_INERTIA]}"
        )
    if Role.LEG_BIAS in role:
        by += f", and {role[Role.LEG_BIAS]} is what its velocity and weight take"
    return f"{by}. A circle marks what is left of a quantity at zero acceleration."


def unit_vectors(derivation: Derivation, leg_type: str) -> dict[str, Any]:
    """Reciprocal vectors that are the axes of their slides: by name, where it shows.

    So it is where all joints that turn carry the connection point across the axis, since the way
    from them to the point lies along it.
    """
    definitions = {e.lhs: e.rhs for e in derivation.equations()}
    found = {}
    for basis in derivation.bases:
        if basis.id != leg_type or basis.rows:
            continue
        for vector, dual in zip(basis.vectors, basis.duals, strict=False):
            others = [definitions.get(v) for v in basis.vectors if v != vector]
            if vector not in definitions and all(
                _turns_along(o, vector, definitions) for o in others
            ):
                found[dual.name] = vector
    return found


def _turns_along(velocity: Any, axis: Any, definitions: Mapping[Any, Any]) -> bool:
    """Whether a velocity vector is an axis crossed with what lies along another."""
    if not isinstance(velocity, Cross):
        return False
    arm = velocity.args[1]
    arm = definitions.get(arm, arm)
    return arm == axis or (isinstance(arm, VectorScale) and arm.args[1] == axis)
