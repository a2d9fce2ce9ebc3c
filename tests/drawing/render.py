"""SVG pictures drawn by a program that is not ours, as arrays of pixels."""

from __future__ import annotations

import io
import os
import shutil
import subprocess
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]

DPI = 200
"""Of the PNG pictures that are compared."""
BLOCK = 8
"""Pixels; a mean over such squares knows no anti-aliasing."""


def drawn(svg: Path) -> Array:
    """The picture as rsvg-convert draws it, rows x columns x red, green, blue, 0 to 1."""
    program = shutil.which("rsvg-convert")
    if program is None:
        tell = pytest.fail if os.environ.get("CI") == "true" else pytest.skip
        tell("NOT RUN: rsvg-convert is not installed (librsvg2-bin)")
    done = subprocess.run(
        [str(program), f"--dpi-x={DPI}", f"--dpi-y={DPI}", str(svg)],
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr.decode()
    return pixels(done.stdout)


def pixels(png: bytes) -> Array:
    """The pixels of a PNG picture."""
    return np.asarray(matplotlib.image.imread(io.BytesIO(png)), dtype=float)[:, :, :3]


def largest_difference(one: Array, other: Array) -> float:
    """The largest difference of two pictures' means over squares of some pixels."""
    rows, columns = (
        min(a, b) // BLOCK for a, b in zip(one.shape[:2], other.shape[:2], strict=True)
    )
    means = [
        each[: rows * BLOCK, : columns * BLOCK]
        .reshape(rows, BLOCK, columns, BLOCK, 3)
        .mean(axis=(1, 3))
        for each in (one, other)
    ]
    return float(np.abs(means[0] - means[1]).max())
