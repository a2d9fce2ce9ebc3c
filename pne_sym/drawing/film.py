"""Pictures that follow each other, as a moving one: GIF by Pillow, MP4 by ffmpeg."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pne_sym.drawing.paper import MISSING, blank, layout, paint, write
from pne_sym.drawing.shapes import Picture
from pne_sym.generation import InputError
from pne_sym.writer import OutputError

if TYPE_CHECKING:
    from matplotlib.animation import AbstractMovieWriter

FORMATS = (".gif", ".mp4")
_DPI = 120
_FASTEST = 100
"""Frames per second: a GIF counts hundredths."""
_PLACED_BY = 12
"""Of how many pictures labels keep clear."""


def check_film(path: Path, fps: int) -> None:
    """Refuse what cannot become an animation, before any work.

    Raises:
        InputError: the file's name does not end in a format that is known, or fps is not
            1 to 100; ffmpeg, which an MP4 needs, is not installed.
    """
    if path.suffix not in FORMATS:
        raise InputError(f"cannot animate {path}: its name ends in {', '.join(FORMATS)}")
    if not 1 <= fps <= _FASTEST:
        raise InputError(f"fps: 1 to {_FASTEST} frames per second are needed, not {fps}")
    _writer(path.suffix, fps)


def save_film(
    pictures: Sequence[Picture],
    path: Path,
    fps: int,
    frame_done: Callable[[], None] = lambda: None,
) -> None:
    """Write an animation.

    Args:
        pictures: the frames, in the same plane and with the same labels.
        path: of the file, `.gif` or `.mp4`.
        fps: frames per second, 1 to 100.
        frame_done: called after each frame.

    Raises:
        InputError: as `check_film` says, or matplotlib is not installed.
        OutputError: the file cannot be written.
    """
    check_film(path, fps)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    writer = _writer(path.suffix, fps)
    steps = max(1, len(pictures) // _PLACED_BY)
    plan = layout(pictures, pictures[::steps])
    page = blank(plan)
    FigureCanvasAgg(page)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / f"film{path.suffix}"
        try:
            with writer.saving(page, str(file), _DPI):
                for picture in pictures:
                    page.clear()
                    paint(page, picture, plan)
                    writer.grab_frame()
                    frame_done()
            content = file.read_bytes()
        except OSError as error:
            raise OutputError(f"cannot write {path}: {error.strerror or error}") from error
    write(path, content)


def _writer(suffix: str, fps: int) -> AbstractMovieWriter:
    try:
        from matplotlib.animation import FFMpegWriter, PillowWriter
    except ImportError as error:
        raise InputError(MISSING) from error
    if suffix == ".gif":
        return PillowWriter(fps=fps)
    if not FFMpegWriter.isAvailable():
        raise InputError("an MP4 needs ffmpeg, which was not found; a GIF needs nothing more")
    return FFMpegWriter(fps=fps, codec="h264")
