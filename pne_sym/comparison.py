"""Comparing a model's folder with what would be generated; writes nothing."""

from __future__ import annotations

import difflib
import enum
import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

from pne_sym.contents import MODEL_NAME, Contents, check_names, folders_of, read_file
from pne_sym.writer import readable_errors


class DifferenceKind(enum.StrEnum):
    """How a file differs from what would be generated."""

    MISSING = "missing"
    STALE = "stale"
    CHANGED = "changed"


class Difference(NamedTuple):
    """One file that is not what would be generated.

    Attributes:
        path: the file, below the output folder.
        kind: missing; stale (would not be generated); or changed.
        diff: unified diff from the file to what would be generated, of a link a line that says so
            (changed files only), otherwise empty.
    """

    path: Path
    kind: DifferenceKind
    diff: str = ""


def check_model(out: Path, name: str, files: Mapping[str, str]) -> list[Difference]:
    """Compare `out/name/` with what would be generated.

    Files there that are not of a generation are the user's, and make no difference.

    Args:
        out: the output folder.
        name: the model's name.
        files: path below the model's folder -> text, as for `write_model`.

    Returns:
        The differences, sorted by path; empty if the folder is up to date.

    Raises:
        OutputError: a file cannot be read.
        ValueError: a name that could lead out of the folder.
    """
    check_names(name, files)
    folder = out / name
    with readable_errors(folder, "read"):
        present = Contents(folder).files | {f for f in files if os.path.lexists(folder / f)}
        differences = []
        for file in sorted(present | set(files)):
            path = Path(name, file)
            if file not in present:
                differences.append(Difference(path, DifferenceKind.MISSING))
            elif file not in files:
                differences.append(Difference(path, DifferenceKind.STALE))
            elif (found := read_file(folder / file)) != files[file].encode("utf-8"):
                # What a stranger's link leads to is nobody's to read in a log.
                linked = any((folder / part).is_symlink() for part in [*folders_of(file), file])
                told = f"{out / path}: a link leads elsewhere; what stands there is not shown\n"
                diff = told if linked else _unified_diff(out / path, found, files[file])
                differences.append(Difference(path, DifferenceKind.CHANGED, diff))
    return differences


def models_in(out: Path) -> list[str]:
    """The names of the models that stand in an output folder, sorted.

    Raises:
        OutputError: the folder cannot be read.
    """
    with readable_errors(out, "read"):
        names = [
            path.name for path in out.iterdir() if path.is_dir() and Contents(path).is_generated
        ]
    return sorted(name for name in names if MODEL_NAME.fullmatch(name))


def _unified_diff(path: Path, found: bytes, expected: str) -> str:
    old = found.decode("utf-8", errors="backslashreplace")
    lines = difflib.unified_diff(
        _lines(old),
        _lines(expected),
        f"{path} (as it stands)",
        f"{path} (as generated)",
        lineterm="",
    )
    return "".join(f"{line}\n" for line in lines)


def _lines(text: str) -> list[str]:
    """Split at line feeds only, telling a missing last one."""
    lines = text.split("\n")
    last = lines.pop()
    return [*lines, f"{last}\n\\ No newline at end of file"] if last else lines
