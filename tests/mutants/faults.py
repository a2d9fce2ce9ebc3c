"""The faults that are planted, as data: rows of the files in `tests/mutants/faults`."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDER = Path(__file__).parent / "faults"
_KEYS = {"what", "file", "before", "after", "tests", "needs"}


class FaultError(ValueError):
    """A row that says nothing sensible, or no longer fits the sources."""


@dataclass(frozen=True)
class Fault:
    """A fault in one file.

    Attributes:
        name: file of rows and number in it, such as "mechanics-3".
        what: the fault in words.
        file: path from the top of the repository.
        before: text that occurs there exactly once.
        after: what takes its place.
        tests: those that are expected to find it, as pytest takes them.
        wider: what is tried before it counts as a survivor.
        needs: a module without which the tests cannot run, or "".
    """

    name: str
    what: str
    file: str
    before: str
    after: str
    tests: tuple[str, ...]
    wider: tuple[str, ...]
    needs: str = ""

    def mutated(self, text: str) -> str:
        """The file's text with the fault in it.

        Raises:
            FaultError: the text that it replaces is not there exactly once.
        """
        found = text.count(self.before)
        if found != 1:
            raise FaultError(
                f"{self.name}: {self.before[:60]!r} occurs {found} times in {self.file}, "
                "expected once"
            )
        return text.replace(self.before, self.after)


def faults(folder: Path = FOLDER) -> list[Fault]:
    """All rows, in the order of their files' names and within these.

    Raises:
        FaultError: a row without a field, or with one too many.
    """
    return [fault for path in sorted(folder.glob("*.toml")) for fault in _rows(path)]


def _rows(path: Path) -> list[Fault]:
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    wider = tuple(table.get("wider", ()))
    found = []
    for number, row in enumerate(table["fault"], 1):
        name = f"{path.stem}-{number}"
        if not _KEYS - {"needs"} <= row.keys() <= _KEYS:
            raise FaultError(f"{name}: has {sorted(row)}, expected {sorted(_KEYS)}")
        tests = tuple(row["tests"])
        if row["before"] == row["after"] or not tests:
            raise FaultError(f"{name}: changes nothing, or names no test")
        rest = {key: row[key] for key in ("what", "file", "before", "after")}
        found.append(Fault(name, tests=tests, wider=wider, needs=row.get("needs", ""), **rest))
    return found
