"""The command `pne-gen draw`: a picture of a manipulator at home."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pne_sym.cli.console import Report
from pne_sym.cli.faults import told
from pne_sym.cli.options import Debug, Source


def draw(
    source: Source,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            show_default=False,
            help="The picture: .svg, .png or .pdf. Default: NAME.svg.",
        ),
    ] = None,
    azimuth: Annotated[
        float | None,
        typer.Option(
            "--azimuth",
            metavar="DEGREES",
            show_default=False,
            help="Where to look from, counted from x towards y. Default: where the legs "
            "hide each other least. Not in the plane.",
        ),
    ] = None,
    elevation: Annotated[
        float | None,
        typer.Option(
            "--elevation",
            metavar="DEGREES",
            show_default=False,
            help="How far above the horizon to look from. Default: 20.",
        ),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Tell only warnings.")] = False,
    debug: Debug = False,
) -> None:
    """Draw a manipulator at home.

    Base, joints by their kinds, links, platform and frames, from its own data; driven
    joints stand out. Needs matplotlib: pip install 'pne-sym[draw]'.
    """
    with told(debug=debug):
        from pne_sym import drawing
        from pne_sym.generation import find

        manipulator = find(source)
        path = Path(f"{manipulator.name}.svg") if out is None else out
        drawing.draw(manipulator, path, azimuth=azimuth, elevation=elevation)
        Report(quiet=quiet).line(f"wrote {path}: {path.stat().st_size / 1000:.0f} kB")
