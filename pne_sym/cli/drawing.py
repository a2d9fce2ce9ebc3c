"""The command `pne-gen draw`: a picture of a manipulator at a pose, or an animation of a path."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pne_sym.cli.console import Report
from pne_sym.cli.faults import told
from pne_sym.cli.numbers import table
from pne_sym.cli.options import debug_flag, of_option, quiet_flag, source_argument, valued

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator


@click.command
@source_argument
@valued(
    "--out -o FILE",
    "The picture: .svg, .png or .pdf; with --path .gif, or .mp4 where ffmpeg is "
    "installed. Default: NAME.svg, NAME.gif.",
    type=Path,
)
@valued(
    "--pose NUMBERS",
    "The platform's pose, numbers with commas between (m, rad): x,y,z,roll,pitch,yaw "
    "(fixed axes) or X itself, x,y,z,qx,qy,qz,qw; in the plane x,y,phi or x,y; without "
    "rotation x,y,z; about a centre roll,pitch,yaw or the quaternion. Then the extra "
    "coordinates, if there are any. Default: home.",
)
@valued(
    "--q NUMBERS",
    "Displacements of all joints, legs as in the spec and joints from the base, from "
    "which the legs are closed at the pose. Default: found along the straight way from home.",
)
@valued(
    "--path FILE.csv",
    "Animate: a frame for each line, which holds the numbers of a pose as for --pose. "
    "A first line of names and lines that begin with # are left out.",
    type=Path,
)
@valued(
    "--fps N",
    "Frames per second, with --path.",
    type=click.IntRange(1, 100),
    default=25,
    show_default=True,
)
@valued(
    "--azimuth DEGREES",
    "Where to look from, counted from x towards y. Default: where the legs "
    "hide each other least. Not in the plane.",
    type=float,
)
@valued("--elevation DEGREES", "How far above the horizon to look from. Default: 20.", type=float)
@quiet_flag
@debug_flag
def draw(  # noqa: PLR0913, PLR0917 - an option each
    source: str,
    out: Path | None,
    pose: str | None,
    q: str | None,
    path: Path | None,
    fps: int,
    azimuth: float | None,
    elevation: float | None,
    quiet: bool,
    debug: bool,
) -> None:
    """Draw a manipulator at a pose, or on a path.

    A picture, or an animation: base, joints by their kinds, links, platform and frames, from its
    own data; actuated joints stand out. Needs matplotlib: pip install 'pne-sym[draw]'.
    """
    with told(debug=debug):
        from pne_sym import drawing
        from pne_sym.generation import InputError, find

        if pose is not None and path is not None:
            raise InputError("--pose and --path exclude each other")
        manipulator, report = find(source), Report(quiet=quiet)
        guess = None if q is None else of_option("--q", q)
        target = out or Path(f"{manipulator.name}.{'svg' if path is None else 'gif'}")
        look = {"azimuth": azimuth, "elevation": elevation}
        if path is None:
            X = None if pose is None else of_option("--pose", pose, manipulator)
            drawing.draw(manipulator, target, X, guess, **look)
        else:
            drawing.check_film(target, fps)
            poses = _poses(manipulator, path)
            try:
                frames = drawing.pictures(manipulator, poses, guess, **look)
            except InputError as error:
                raise InputError(f"{path}: {error}") from error
            with report.progress(len(frames)) as step:
                step.working_on(f"{manipulator.name}: frames")
                drawing.save_film(frames, target, fps, step.done)
        report.line(f"wrote {target}: {target.stat().st_size / 1000:.0f} kB")


def _poses(manipulator: Manipulator, path: Path) -> list[list[float]]:
    """X of every line of a file."""
    from pne_sym.drawing import pose_of
    from pne_sym.generation import InputError

    poses = []
    for line, values in table(path):
        try:
            poses.append(pose_of(manipulator, values))
        except InputError as error:
            raise InputError(f"{path}: line {line}: {error}") from error
    return poses
