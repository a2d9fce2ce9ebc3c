"""Text of a specification to plain tables; bounded in size and nesting."""

from __future__ import annotations

import json
import re
import tomllib
from itertools import pairwise
from pathlib import Path

from pne_sym.model.errors import SpecError, printable

MAX_BYTES = 4 * 1024 * 1024
MAX_DEPTH = 16
SUFFIXES = (".toml", ".json")

_KEY_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_LONG_KEY = re.compile(rf"(?<![A-Za-z0-9_-])(?:{_KEY_PART}\.[ \t]*+){{{MAX_DEPTH}}}")
"""A dotted key nested too deeply: tomllib needs quadratic time for such keys."""


def read_file(path: Path) -> str:
    """The text of a specification file.

    Raises:
        SpecError: unreadable, too large, not UTF-8, or of an unknown kind.
    """
    source = str(path)
    try:
        if not path.is_file():
            problem = "not a regular file" if path.exists() else "no such file"
            raise SpecError(source, "", problem, "a specification in TOML or JSON")
        if path.suffix.lower() not in SUFFIXES:
            raise SpecError(source, "", f"file of kind '{path.suffix}'", "a .toml or .json file")
    except OSError as error:
        raise SpecError(source, "", f"cannot be read: {error.strerror}") from None
    return bounded_text(path)


def bounded_text(path: Path, kind: str = "UTF-8 text", most: int = MAX_BYTES) -> str:
    """The text of a file of some kind, of so many bytes at the most.

    Raises:
        SpecError: unreadable, too large, or not UTF-8.
    """
    source = str(path)
    try:
        with path.open("rb") as stream:
            content = stream.read(most + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise SpecError(source, "", f"cannot be read: {reason}") from None
    if len(content) > most:
        raise SpecError(source, "", "file too large", f"at most {most} bytes")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SpecError(source, "", f"byte {error.start} is not UTF-8", kind) from None


def parse(text: str, suffix: str, source: str) -> object:
    """Tables, lists, numbers and strings from the text of a specification.

    Args:
        text: of the file.
        suffix: `.toml` or `.json`.
        source: for messages.

    Raises:
        SpecError: a syntax error (with its line), or too much nesting.
    """
    too_deep = SpecError(source, "", "nested too deeply", f"at most {MAX_DEPTH} levels")
    try:
        if suffix.lower() == ".json":
            data = json.loads(text, object_pairs_hook=_distinct)
        elif _LONG_KEY.search(text):
            raise too_deep
        else:
            data = tomllib.loads(text)
    except RecursionError:
        raise too_deep from None
    except SpecError:
        raise
    except ValueError as error:
        # TOMLDecodeError, JSONDecodeError, and integers of thousands of digits.
        raise SpecError(source, "", printable(f"syntax error: {error}")) from None
    if _depth_exceeds(data, MAX_DEPTH):
        raise too_deep
    return data


def _distinct(pairs: list[tuple[str, object]]) -> dict[str, object]:
    table = dict(pairs)
    if len(table) < len(pairs):
        keys = [key for key, _ in pairs]
        # Equal keys are neighbours once sorted.
        twice = next(a for a, b in pairwise(sorted(keys)) if a == b)
        raise ValueError(f"field {twice[:40]!r} stands twice in one table")
    return table


def _depth_exceeds(data: object, limit: int) -> bool:
    """Level by level rather than by recursion, which hostile nesting would exhaust."""
    level = [data]
    for _ in range(limit + 1):
        inner: list[object] = []
        for value in level:
            if isinstance(value, dict):
                inner.extend(v for v in value.values() if isinstance(v, dict | list))
            elif isinstance(value, list):
                inner.extend(v for v in value if isinstance(v, dict | list))
        if not inner:
            return False
        level = inner
    return True
