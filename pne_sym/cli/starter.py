"""The command `pne-gen new`: a first specification for people to edit."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pne_sym.cli.console import Report
from pne_sym.cli.faults import told
from pne_sym.cli.options import debug_flag, flag, of_option, quiet_flag, valued

if TYPE_CHECKING:
    from pne_sym.starter.points import Geometry


@click.command
@click.argument(
    "path",
    metavar="FILE.toml",
    type=Path,
    help="The specification to be written; its name is the model's.",
)
@valued(
    "--legs LEGS",
    "The architecture, such as 6-UPS or 2-RPR+1-RRR: count, joints from the base, "
    "platform joint. _ marks an actuated joint (6-U_PS), * an extra coordinate. "
    "Without marks, actuators are chosen.",
    required=True,
)
@valued(
    "--space SPACE",
    "point, planar, spatial, translational or spherical. "
    "Default: planar where the legs can move in the plane, else spatial.",
)
@valued(
    "--points FILE.csv",
    "Joint points (m), a row for each leg: base point in the base frame, platform point "
    "in the platform frame; x,y,z,x,y,z, in the plane x,y,x,y.",
    type=Path,
)
@valued(
    "--radii BASE,PLATFORM",
    "Joint points on two circles of these radii (m), at --base-angles and --platform-angles.",
)
@valued("--base-angles NUMBERS", "With --radii: an angle (degrees) for each leg's base point.")
@valued(
    "--platform-angles NUMBERS",
    "The same for the platform points. Default: those of the base.",
)
@valued(
    "--height METRES",
    "With --points or --radii in space: the platform's origin above the base's at home.",
    type=float,
)
@flag("--force -f", "Replace a file that stands there.")
@quiet_flag
@debug_flag
def new(  # noqa: PLR0913, PLR0917 - an option each
    path: Path,
    legs: str,
    space: str | None,
    points: Path | None,
    radii: str | None,
    base_angles: str | None,
    platform_angles: str | None,
    height: float | None,
    force: bool,
    quiet: bool,
    debug: bool,
) -> None:
    """Write a first specification of your own manipulator.

    Its geometry is plausible, or between your own joint points, and closes; it can be
    generated as it is. Edit the numbers.
    """
    with told(debug=debug):
        from pne_sym.mechanics.mobility import mobility
        from pne_sym.starter import write_starter

        geometry = _geometry(points, radii, base_angles, platform_angles, height)
        manipulator = write_starter(path, legs, space, geometry, force=force)
        report = Report(quiet=quiet)
        report.line(f"wrote {path}: {mobility(manipulator)}")
        report.line(f"next: edit it, then {shlex.join(['pne-gen', str(path)])} --out generated/")


def _geometry(
    points: Path | None,
    radii: str | None,
    base: str | None,
    platform: str | None,
    height: float | None,
) -> Geometry | None:
    """Where the legs stand, or None; options that do not go together are refused."""
    from pne_sym.generation import InputError
    from pne_sym.starter import PointsFile, Rings

    if points is not None and (radii or base or platform):
        raise InputError("--points and --radii exclude each other")
    if points is not None:
        return PointsFile(points, height)
    if radii is None:
        if base or platform or height is not None:
            raise InputError("angles and --height belong to --radii or --points")
        return None
    if base is None:
        raise InputError("--radii needs --base-angles, an angle for each leg")
    angles = of_option("--base-angles", base)
    others = angles if platform is None else of_option("--platform-angles", platform)
    return Rings(of_option("--radii", radii), angles, others, height)
