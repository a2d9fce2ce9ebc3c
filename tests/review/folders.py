"""Generated folders on disk, copied and edited, compared by the program in this process."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path

from click.testing import CliRunner, Result

from pne_sym.backends.emission import emit
from pne_sym.cli.app import app
from pne_sym.review.compare import compare
from pne_sym.review.difference import Comparison
from pne_sym.review.model import Model, version_of
from pne_sym.review.sources import find_source
from tests.models import bundle, catalogue

Edit = Callable[[str], str]


@cache
def texts(name: str) -> dict[str, str]:
    """What is generated for a model of the catalogue."""
    return emit(bundle(catalogue(name)))


def write(folder: Path, name: str) -> Path:
    """A generated folder of the model's name below a folder."""
    place = folder / name
    place.mkdir(parents=True)
    for file, text in texts(name).items():
        (place / file).write_text(text, encoding="utf-8")
    return place


def pair(folder: Path, name: str) -> tuple[Path, Path]:
    """A generated folder, and its copy."""
    before = write(folder / "before", name)
    after = folder / "after" / name
    shutil.copytree(before, after)
    return before, after


def edit(path: Path, change: Edit) -> None:
    """Edit a file; the test fails where that changes nothing."""
    text = path.read_text(encoding="utf-8")
    changed = change(text)
    assert changed != text, "the edit did not find its place"
    path.write_text(changed, encoding="utf-8")


def diff(*arguments: str | Path) -> Result:
    """`pne-gen diff` in this process."""
    return CliRunner().invoke(app, ["diff", *map(str, arguments)])


def find_version(text: str) -> Model:
    """A version of a model as `pne-gen diff` finds it."""
    return version_of(find_source(text))


def compared(before: Path, after: Path, *, run: bool = False) -> Comparison:
    """The two folders compared."""
    return compare(find_version(str(before)), find_version(str(after)), run=run)
