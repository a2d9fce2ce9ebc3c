"""The rows of `pne-gen list`: what each model of the catalogue is, in one line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator

HEAD = ("name", "DOF", "actuators", "legs", "title")


def row(manipulator: Manipulator) -> tuple[str, ...]:
    """Name, degrees of freedom at home, actuated joints by kind, legs, title."""
    from pne_sym.mechanics.mobility import mobility

    kinds = Counter(str(joint.kind) for joint in manipulator.joints if joint.actuated)
    actuators = " + ".join(f"{count} {kind}" for kind, count in kinds.items())
    found = mobility(manipulator)
    dofs = f"{found.dofs}" + (f" ({found.passive} passive)" if found.passive else "")
    return (manipulator.name, dofs, actuators, architecture(manipulator), manipulator.title)


def architecture(manipulator: Manipulator) -> str:
    """The legs as `pne-gen new --legs` takes them, without marks, such as 6-UPS or 2-RRR+1-RPR."""
    from pne_sym.mechanics.structure import architecture_of

    plain = (architecture_of(leg).translate({ord(mark): "" for mark in "_*"})
             for leg in manipulator.legs)  # fmt: skip
    return "+".join(f"{count}-{letters}" for letters, count in Counter(plain).items())


def aligned(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """The rows below a heading, in columns, for people."""
    table = [HEAD, *rows]
    widths = [max(len(line[k]) for line in table) for k in range(len(HEAD))]
    for line in table:
        cells = [cell.ljust(width) for cell, width in zip(line, widths, strict=True)]
        yield "  ".join(cells).rstrip()


def tabbed(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """The rows for programs: name, title, then the rest, with tabs between."""
    for name, dofs, actuators, legs, title in rows:
        yield "\t".join((name, title, dofs, actuators, legs))
