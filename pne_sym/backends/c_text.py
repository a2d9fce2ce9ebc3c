"""C spelling: names, literals, comments, wrapped lines."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import sympy as sp

from pne_sym.backends.scalar import Dialect, ScalarPrinter, wrap

WIDTH = 98
_ENTRY = re.compile(r"[A-Z]+_\d+")
_RESERVED = frozenset({"size_t", "ptrdiff_t", "wchar_t", "max_align_t"})
_EXACT = 1 << 20  # whole numbers up to here are exact in every real type
# Functions of the real type, defined in the generated file; none is a name of libm.
_DIALECT = Dialect(
    {
        "sqrt": "root",
        "sin": "sine",
        "cos": "cosine",
        "atan2": "angle",
        "Abs": "magnitude",
        "Min": "lesser",
    },
    "R({})",
)


@lru_cache(1 << 16)
def c_name(name: str) -> str:
    """A name of the program as a C identifier that is no keyword, macro or name of the layout.

    Names of the layout have no underscore, macros no lower-case letter.

    >>> c_name("v_21"), c_name("size"), c_name("X_0"), c_name("M_PI")
    ('v_21', 'size_', 'X_0', 'M_PI_')
    """
    plain = "_" in name and any(ch.islower() for ch in name) and name not in _RESERVED
    return name if plain or _ENTRY.fullmatch(name) else f"{name}_"


class CPrinter(ScalarPrinter):
    """Expressions in C; small whole numbers as they are, other literals of the real type."""

    def __init__(self) -> None:
        super().__init__(_DIALECT)

    def _print_Symbol(self, expr: Any) -> str:  # noqa: N802
        return c_name(str(expr.name))

    def _number(self, value: float) -> str:
        if value == int(value) and abs(value) < _EXACT:
            return str(int(value))
        return super()._number(value)

    def text(self, expr: Any) -> str:
        """An expression as text."""
        return str(self.doprint(sp.sympify(expr)))


PRINTER = CPrinter()


def comment_text(text: str) -> str:
    """Text that cannot end or open a comment."""
    return " ".join(text.replace("*/", "* /").replace("/*", "/ *").split())


def wrapped(text: str, indent: str) -> list[str]:
    """Text in lines that fit into a comment."""
    return wrap(comment_text(text), WIDTH - 4, indent)


def comment(text: str, indent: str = "") -> list[str]:
    """A comment of one or more lines."""
    return wrap(f"{indent}/* {comment_text(text)} */", WIDTH, f"{indent}   ")


def indented(lines: Iterable[str], by: int = 1) -> list[str]:
    """Lines moved to the right; empty ones stay empty."""
    return [f"{'    ' * by}{line}" if line else line for line in lines]


def side_by_side(count: str, lines: Iterable[str]) -> list[str]:
    """Lines for every k of as many legs or states as run side by side, of "w" states or of one."""
    vectors = f"IN_VECTORS({'LANES' if count == 'w' else count})"
    return [vectors, f"for (size_t k = 0; k < {count}; ++k) {{", *indented(lines), "}"]


def statement(text: str) -> list[str]:
    """A statement, broken at spaces where it is long."""
    return wrap(f"{text};", WIDTH - 8, "    ")


def listing(head: str, items: Sequence[str], tail: str, indent: str = "    ") -> list[str]:
    """head item, item, ... tail, broken where it is long."""
    return wrap(f"{head}{', '.join(items)}{tail}", WIDTH, indent)


def in_pairs(terms: Sequence[str]) -> str:
    """A sum in pairs: shorter to wait for than one after another.

    >>> in_pairs(["a", "b", "c", "d", "e"])
    '(a + b) + (c + (d + e))'
    """
    half = len(terms) // 2
    if not half:
        return terms[0]
    parts = (in_pairs(part) for part in (terms[:half], terms[half:]))
    return " + ".join(f"({p})" if " + " in p else p for p in parts)


def table(places: Sequence[int], index: str) -> str | None:
    """Index of the place of a leg, where the places are evenly spaced; None where not.

    >>> table((3, 5, 7), "leg"), table((4,), "leg"), table((0, 1, 5), "leg")
    ('3 + 2*leg', '4', None)
    """
    first = places[0]
    step = places[1] - first if len(places) > 1 else 0
    if step < 0 or any(p != first + step * k for k, p in enumerate(places)):
        return None
    if step == 0:
        return str(first)
    turn = index if step == 1 else f"{step}*{index}"
    return f"{first} + {turn}" if first else turn


def words_of(lines: Iterable[str]) -> set[str]:
    """Identifiers and numbers in code, comments left out."""
    code = re.sub(r"/\*.*?\*/", " ", "\n".join(lines), flags=re.DOTALL)
    return set(re.findall(r"\w+", code))


class Routine(NamedTuple):
    """A static function of the generated file; only the parameters that it reads are kept.

    Attributes:
        name: of the function.
        parameters: declarations, such as "const real *X".
        body: lines.
        kind: how the compiler is to treat it; "" for what users call.
        result: its type.
    """

    name: str
    parameters: tuple[str, ...]
    body: tuple[str, ...]
    kind: str = "INLINE"
    result: str = "void"

    @staticmethod
    def of(
        name: str, parameters: Iterable[str], body: Iterable[str], kind: str = "INLINE"
    ) -> Routine:
        """A routine without the parameters that its body does not mention."""
        lines = tuple(body)
        words = words_of(lines)
        kept = tuple(p for p in parameters if parameter_name(p) in words)
        return Routine(name, kept, lines, kind)

    def definition(self) -> list[str]:
        """The text of the function."""
        return [
            *listing(f"{self.kind} {self.result} {self.name}(".lstrip(), self.parameters, ")"),
            "{",
            *indented(self.body),
            "}",
        ]

    def call(self, **changes: str) -> str:
        """A call with arguments of the parameters' names, or as given."""
        return self.call_with(changes)

    def call_with(self, changes: Mapping[str, str]) -> str:
        """The same with a mapping."""
        names = [parameter_name(p) for p in self.parameters]
        return f"{self.name}({', '.join(changes.get(n, n) for n in names)});"


def parameter_name(declaration: str) -> str:
    """The name that a declaration declares."""
    return declaration.rsplit(maxsplit=1)[-1].lstrip("*")
