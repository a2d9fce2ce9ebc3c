"""Lists of numbers as they are typed on the command line, and tables of them in files."""

from __future__ import annotations

import re
from pathlib import Path

from pne_sym.generation import InputError
from pne_sym.model.errors import show

_BETWEEN = re.compile(r"[\s,;]+")
_LARGEST = 4 * 1024 * 1024


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
        InputError: the file cannot be read, or a line has what is no number.
    """
    rows: list[tuple[int, list[float]]] = []
    names = False
    for number, line in enumerate(_text(path).splitlines(), start=1):
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


def _text(path: Path) -> str:
    try:
        with path.open("rb") as stream:
            content = stream.read(_LARGEST + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"cannot read {path}: {reason}") from None
    if len(content) > _LARGEST:
        raise InputError(f"{path}: file too large; at most {_LARGEST} bytes")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: byte {error.start} is not UTF-8") from None
