"""The public functions of a generated C model, read from its header alone.

Names, sizes and what may be NULL are taken from the prototypes and the comments
above them, so that what runs with them checks what the header promises.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

_COMMENTED = re.compile(
    r"/\* (?P<text>(?:(?!\*/).)*?) \*/\s*int (?P<head>\w+\([^)]*\));", re.DOTALL
)
_ARRAY = re.compile(r"(\w+) \(([^)]*)\)")


@dataclass(frozen=True)
class Array:
    """An argument: its name, its entries per state, whether it may be NULL."""

    name: str
    size: int
    optional: bool = False
    positive: bool = False


@dataclass(frozen=True)
class Function:
    """A public function, without its prefix.

    `has_model` tells of the first argument, `endless` of results that may be infinite.
    """

    name: str
    has_model: bool
    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    endless: bool


@dataclass(frozen=True)
class Interface:
    """A model's header: its name, sizes such as NQ, functions, entries of X and q at home."""

    name: str
    sizes: dict[str, int]
    functions: tuple[Function, ...]
    quaternion: int | None

    def function(self, name: str) -> Function:
        """The function of a name."""
        return next(f for f in self.functions if f.name == name)


def read_header(path: Path) -> Interface:
    """The interface that a header declares.

    Raises:
        ValueError: a prototype and the comment above it do not name the same arguments.
    """
    text, name = path.read_text(encoding="utf-8"), path.stem
    sizes = {
        key: int(value)
        for key, value in re.findall(rf"#define {name.upper()}_(N\w) (\d+)$", text, re.MULTILINE)
    }
    functions = []
    for found in _COMMENTED.finditer(text):
        words = " ".join(found["text"].split())
        if " In: " in words:
            functions.append(_function(name, words, " ".join(found["head"].split()), sizes))
    names = re.search(r"^ \* X: (.*)$", text, re.MULTILINE)
    assert names
    coordinates = names[1].split(", ")
    quaternion = coordinates.index("qx") if "qx" in coordinates else None
    return Interface(name, sizes, tuple(functions), quaternion)


def _function(prefix: str, comment: str, head: str, sizes: dict[str, int]) -> Function:
    name, declared = re.fullmatch(rf"{prefix}_(\w+)\((.*)\)", head).groups()  # type: ignore[union-attr]
    told = re.search(r" In: (.*?)\. +Out: (.*?)\.$", comment)
    assert told, comment
    inputs, outputs = (
        tuple(_array(*a, sizes) for a in _ARRAY.findall(part)) for part in told.groups()
    )
    arguments = [argument.split()[-1].lstrip("*") for argument in declared.split(",")]
    has_model = arguments[0] == "model"
    if arguments[has_model:] != [a.name for a in (*inputs, *outputs)]:
        raise ValueError(f"{prefix}_{name}: comment and prototype differ")
    return Function(name, has_model, inputs, outputs, "infinite where" in comment)


def _array(name: str, text: str, sizes: dict[str, int]) -> Array:
    shape = text.replace(", or NULL", "").replace(", positive", "")
    size = math.prod(sizes.get(part) or int(part) for part in shape.split(" x "))
    return Array(name, size, optional="or NULL" in text, positive="positive" in text)
