"""The command `pne-gen home`: the closures of all legs at home, and the assembly branch."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import click

from pne_sym.cli.console import Report
from pne_sym.cli.faults import told
from pne_sym.cli.options import debug_flag, source_argument

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator


@click.command
@source_argument
@debug_flag
def home(source: str, debug: bool) -> None:
    """List all closures of the legs at home.

    The assembly branch that home selects is told too. A line of numbers is q of a leg at the
    pose home.X, as the specification may state it; that of home is marked. What a specification
    without home.q gets stands first.
    """
    with told(debug=debug):
        from pne_sym.generation import find

        manipulator, report = find(source), Report()
        for line in (*_closures(manipulator), *_branches(manipulator)):
            report.line(line)


def _closures(m: Manipulator) -> Iterator[str]:
    import numpy as np

    from pne_sym.model.assembly import all_closures, distance
    from pne_sym.model.home import principal
    from pne_sym.model.loops import Loops

    loops = Loops.of(m)
    yield f"{m.name}: X = {_listed(m.home.X)}"
    found = all_closures(loops, np.array(m.home.X))
    for k, (leg, s, own) in enumerate(zip(m.legs, loops.slices(), found, strict=True)):
        q = np.array(m.home.q[s])
        if not any(distance(leg, q, other) < _SAME for other in own):
            own.append(q)  # one of a continuum
        yield f"legs[{k}]: {len(own)} closure{'s' if len(own) > 1 else ''}"
        for other in own:
            mark = "  home" if distance(leg, q, other) < _SAME else ""
            yield f"  {_listed(principal(list(leg.joints), other.tolist()))}{mark}"


_SAME = 1e-6


def _branches(m: Manipulator) -> Iterator[str]:
    """The signs of the roots of the inverse kinematics, by their names in report and manifest."""
    from pne_sym.mechanics.derive import derive

    for name, (leg_type, signs) in derive(m).parameters.branches.items():
        signed = " ".join("+1" if sign > 0 else "-1" for sign in signs)
        yield f"branch of home: {leg_type} legs: {name} = {signed}"


def _listed(values: object) -> str:
    import numpy as np

    return "[" + ", ".join(f"{x:.10g}" for x in np.round(np.asarray(values), 12) + 0.0) + "]"
