"""A value of a specification together with the place where it stands.

Readers take entries, never bare values, so that every fault can name its
place as the author wrote it, also inside a shared leg type or an override.
"""

from __future__ import annotations

import difflib
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from pne_sym.model.errors import SpecError, SpecWarning, printable, show

MAX_ELEMENTS = 4096
"""Lists and tables beyond it are refused at once, before any work is done on them."""
_Value = TypeVar("_Value")


@dataclass(frozen=True)
class Entry:
    """A value and where it stands.

    Attributes:
        source: the file, or what stands for it.
        where: path of the field, such as `legs[0].joints[1].axis`.
        value: what the file holds there.
        below: the table whose fields this one overrides, one by one.
    """

    source: str
    where: str
    value: object
    below: Entry | None = None

    def fault(self, expected: str, problem: str = "") -> SpecError:
        """The error for this value; `problem` defaults to naming the value."""
        return SpecError(self.source, self.where, problem or f"value {show(self.value)}", expected)

    def warn(self, message: str, kind: type[Warning] = SpecWarning) -> None:
        """Warn of this value, with its place."""
        warnings.warn(f"{self.source}: {self.where}{message}", kind, stacklevel=3)

    def table(self, known: Iterable[str]) -> Table:
        """The fields of a table.

        Args:
            known: names that the table may have.

        Raises:
            SpecError: not a table, or a field that is not known (the message
                has the nearest known name).
        """
        known = tuple(known)
        fields = dict(self.below.table(known).fields) if self.below else {}
        for name, entry in self.named():
            if name not in known:
                raise self._unknown(name, known)
            fields[name] = entry.over(fields.get(name))
        return Table(self, fields)

    def over(self, lower: Entry | None) -> Entry:
        """This entry, overriding a lower one: a table field by field, else as a whole."""
        if lower and isinstance(lower.value, Mapping) and isinstance(self.value, Mapping):
            return replace(self, below=lower)
        return self

    def named(self) -> Iterator[tuple[str, Entry]]:
        """Fields of a table with free names; a JSON null counts as absent."""
        if not isinstance(self.value, Mapping):
            raise self.fault("a table")
        self._check_size(len(self.value))
        for name, value in self.value.items():
            if value is not None:
                where = _join(self.where, name)
                yield str(name), Entry(self.source, where, value)

    def items(self) -> list[Entry]:
        """The elements of a list.

        Raises:
            SpecError: not a list, or an absurdly long one.
        """
        if not isinstance(self.value, list | tuple):
            raise self.fault("a list")
        self._check_size(len(self.value))
        return [Entry(self.source, f"{self.where}[{i}]", v) for i, v in enumerate(self.value)]

    def counted(self, count: int, what: str, which: str) -> list[Entry]:
        """The elements of a list of a given length.

        Args:
            count: how many.
            what: they are called.
            which: they are, for the message.

        Raises:
            SpecError: not a list, or of another length.
        """
        items = self.items()
        if len(items) != count:
            raise self.fault(f"{count} {what}{which}", f"{len(items)} {what}")
        return items

    def text(self) -> str:
        """The value as a string.

        Raises:
            SpecError: not a string.
        """
        if not isinstance(self.value, str):
            raise self.fault("a string")
        return self.value

    def choice(self, allowed: Sequence[str]) -> str:
        """The value as one of some words.

        Raises:
            SpecError: none of them (the message has the nearest).
        """
        if isinstance(self.value, str) and self.value in allowed:
            return self.value
        hint = nearest(self.value, allowed) if isinstance(self.value, str) else ""
        raise self.fault("one of " + ", ".join(allowed) + hint)

    def flag(self) -> bool:
        """The value as true or false.

        Raises:
            SpecError: something else.
        """
        if not isinstance(self.value, bool):
            raise self.fault("true or false")
        return self.value

    def _check_size(self, size: int) -> None:
        if size > MAX_ELEMENTS:
            raise self.fault(f"at most {MAX_ELEMENTS} elements", problem=f"{size} elements")

    def _unknown(self, name: str, known: tuple[str, ...]) -> SpecError:
        problem = f"unknown field {show(name)}{nearest(name, known)}"
        return SpecError(self.source, self.where, problem, "one of " + ", ".join(known))


@dataclass(frozen=True)
class Table:
    """The known fields of a table that are present."""

    entry: Entry
    fields: Mapping[str, Entry]

    def get(self, name: str) -> Entry | None:
        """The field, or None where it is left out."""
        return self.fields.get(name)

    def read(self, name: str, reader: Callable[[Entry], _Value], default: _Value) -> _Value:
        """The field as a reader has it; the default where it is left out."""
        return reader(self.fields[name]) if name in self.fields else default

    def require(self, name: str, expected: str) -> Entry:
        """The field.

        Args:
            name: of the field.
            expected: what it should hold, for the message.

        Raises:
            SpecError: the field is left out.
        """
        if name not in self.fields:
            raise self.entry.fault(f"{name} = {expected}", problem=f"missing field '{name}'")
        return self.fields[name]

    def refuse(self, names: Iterable[str], reason: str) -> None:
        """Refuse fields that have no meaning beside the others.

        Raises:
            SpecError: one of them is present.
        """
        for name in names:
            if name in self.fields:
                raise self.fields[name].fault(f"no such field: {reason}")


def nearest(name: str, known: Iterable[str]) -> str:
    """A hint with the known names nearest to a mistaken one, or nothing."""
    close = near(name, known, 3)
    return f" (did you mean {' or '.join(close)}?)" if close else ""


def near(name: str, known: Iterable[str], count: int, *, likeness: float = 0.6) -> list[str]:
    """The known names most like a mistaken one, the nearest first; likeness is 0 to 1."""
    return difflib.get_close_matches(name[:60].lower(), list(known), n=count, cutoff=likeness)


def _join(where: str, name: object) -> str:
    field = printable(str(name), 40)
    return f"{where}.{field}" if where else field
