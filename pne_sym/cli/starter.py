"""The command `pne-gen new`: a first specification for people to edit."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pne_sym.cli.console import Report
from pne_sym.cli.faults import told
from pne_sym.cli.options import Debug, Quiet, of_option, unset

if TYPE_CHECKING:
    from pne_sym.starter.points import Geometry


Points = Annotated[
    Path | None,
    unset(
        "--points FILE.csv",
        "Joint points (m), a row for each leg: base point in the base frame, platform point "
        "in the platform frame; x,y,z,x,y,z, in the plane x,y,x,y.",
    ),
]
Radii = Annotated[
    str | None,
    unset(
        "--radii BASE,PLATFORM",
        "Joint points on two circles of these radii (m), at --base-angles and --platform-angles.",
    ),
]
BaseAngles = Annotated[
    str | None,
    unset(
        "--base-angles NUMBERS",
        "With --radii: an angle (degrees) for each leg's base point.",
    ),
]
PlatformAngles = Annotated[
    str | None,
    unset(
        "--platform-angles NUMBERS",
        "The same for the platform points. Default: those of the base.",
    ),
]
Height = Annotated[
    float | None,
    unset(
        "--height METRES",
        "With --points or --radii in space: the platform's origin above the base's at home.",
    ),
]


Target = Annotated[
    Path,
    typer.Argument(
        metavar="FILE.toml", help="The specification to be written; its name is the model's."
    ),
]
Legs = Annotated[
    str,
    typer.Option(
        "--legs",
        metavar="LEGS",
        help="The architecture, such as 6-UPS or 2-RPR+1-RRR: count, joints from the base, "
        "platform joint. _ marks an actuated joint (6-U_PS), * an extra coordinate. "
        "Without marks, actuators are chosen.",
    ),
]
Space = Annotated[
    str | None,
    unset(
        "--space SPACE",
        "point, planar, spatial, translational or spherical. "
        "Default: planar where the legs can move in the plane, else spatial.",
    ),
]
Force = Annotated[bool, typer.Option("--force", "-f", help="Replace a file that stands there.")]


def new(  # noqa: PLR0913, PLR0917 - an option each
    path: Target,
    legs: Legs,
    space: Space = None,
    points: Points = None,
    radii: Radii = None,
    base_angles: BaseAngles = None,
    platform_angles: PlatformAngles = None,
    height: Height = None,
    force: Force = False,
    quiet: Quiet = False,
    debug: Debug = False,
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
