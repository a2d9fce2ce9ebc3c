"""Lists of numbers as they are typed on the command line, and tables of them in files."""

from __future__ import annotations

import re
from pathlib import Path

from pne_sym.generation import InputError
from pne_sym.model.errors import show

_BETWEEN = re.compile(r"[\s,;]+")


def numbers(text: str) -> list[float]:
    """The numbers of a text, separated by commas, semicolons or blanks.

    Raises:
        ValueError: a piece is no number; the message shows it.
    """
    found = []
    for piece in _BETWEEN.split(text.strip(" \t\r\n,;")):
        try:
            found.append(float(piece))
        except ValueError:
            raise ValueError(f"{show(piece)} is not a number; commas stand between") from None
    return found


def table(path: Path) -> list[tuple[int, list[float]]]:
    """The rows of numbers in a text file, each with the number of its line.

    Blank lines and those that begin with # are left out, as is a first line of names.

    Raises:
        SpecError: the file cannot be read.
        InputError: a line has what is no number.
    """
    from pne_sym.model.files import bounded_text

    rows: list[tuple[int, list[float]]] = []
    names = False
    for number, line in enumerate(bounded_text(path).splitlines(), start=1):
        content = line.partition("#")[0].strip()
        if not content:
            continue
        try:
            rows.append((number, numbers(content)))
        except ValueError as error:
            if rows or names or not _is_heading(content):
                raise InputError(f"{path}: line {number}: {error}") from None
            names = True
    return rows


def _is_heading(line: str) -> bool:
    """Whether a line holds names only."""
    return all(re.fullmatch(r'["\']?[A-Za-z_]\w*["\']?', piece) for piece in _BETWEEN.split(line))
