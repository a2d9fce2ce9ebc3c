"""The command `pne-gen new`: a first specification for people to edit."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from pne_sym.cli.console import Report
from pne_sym.cli.faults import told
from pne_sym.cli.options import Debug


def new(
    path: Annotated[
        Path,
        typer.Argument(
            metavar="FILE.toml", help="The specification to be written; its name is the model's."
        ),
    ],
    legs: Annotated[
        str,
        typer.Option(
            "--legs",
            metavar="LEGS",
            help="The architecture, such as 6-UPS or 2-RPR+1-RRR: count, joints from the base, "
            "platform joint. _ marks a driven joint (6-U_PS), * an extra coordinate. "
            "Without marks, drives are chosen.",
        ),
    ],
    space: Annotated[
        str | None,
        typer.Option(
            "--space",
            metavar="SPACE",
            show_default=False,
            help="point, planar, spatial, translational or spherical. "
            "Default: planar where the legs can move in the plane, else spatial.",
        ),
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", "-f", help="Replace a file that stands there.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Tell only warnings.")] = False,
    debug: Debug = False,
) -> None:
    """Write a first specification of your own manipulator.

    Its geometry is plausible and closes; it can be generated as it is. Edit the numbers.
    """
    with told(debug=debug):
        from pne_sym.mechanics.mobility import mobility
        from pne_sym.starter import write_starter

        manipulator = write_starter(path, legs, space, force=force)
        report = Report(quiet=quiet)
        report.line(f"wrote {path}: {mobility(manipulator)}")
        report.line(f"next: edit it, then {shlex.join(['pne-gen', str(path)])} --out generated/")
