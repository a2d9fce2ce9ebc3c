"""What of the written-out Python in templates/numpy a module needs."""

from __future__ import annotations

import ast
import symtable
from collections.abc import Iterable
from functools import cache, lru_cache
from typing import NamedTuple

from pne_sym.backends.templating import reached


class _Part(NamedTuple):
    """A function, a class or a constant: its source."""

    text: str
    is_constant: bool


def needed(support: str, texts: Iterable[str]) -> str:
    """The functions, classes and constants that texts name, and those that these name.

    Args:
        support: Python source of functions, classes and constants, in the order of the result.
        texts: Python source that uses some of them.
    """
    parts = _parts(support)
    found = reached(texts, {name: part.text for name, part in parts.items()}, _named)
    text, before = "", None
    for part in dict.fromkeys(parts[name] for name in found):
        gap = "\n" if part.is_constant and before else "\n\n\n" if text else ""
        text, before = text + gap + part.text, part.is_constant
    return text


@cache  # all models have the same
def _parts(support: str) -> dict[str, _Part]:
    """What source makes, by its names."""
    lines, found = support.split("\n"), dict[str, _Part]()
    for node in ast.parse(support).body:
        assert node.end_lineno is not None
        text = "\n".join(lines[node.lineno - 1 : node.end_lineno])
        part = _Part(text, isinstance(node, ast.Assign))
        found |= dict.fromkeys(_made(node), part)
    return found


def _made(node: ast.stmt) -> list[str]:
    """Names that a statement gives values."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    assert isinstance(node, ast.Assign)
    return [n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name)]


@lru_cache(1 << 12)  # most are of the support, which all models have
def _named(text: str) -> frozenset[str]:
    """Names that occur in source, those of attributes apart."""
    tables, found = [symtable.symtable(text, "", "exec")], set[str]()
    while tables:
        table = tables.pop()
        found.update(table.get_identifiers())
        tables += table.get_children()
    return frozenset(found)
