"""What of the written-out Python in templates/numpy a module needs."""

from __future__ import annotations

import ast
from collections.abc import Iterable

from pne_sym.backends.templating import reached


def needed(support: str, texts: Iterable[str]) -> str:
    """The functions, classes and constants that texts name, and those that these name.

    Args:
        support: Python source of functions, classes and constants, in the order of the result.
        texts: Python source that uses some of them.
    """
    lines = support.split("\n")
    parts = {name: node for node in ast.parse(support).body for name in _made(node)}
    found = reached(map(ast.parse, texts), parts, _named)
    kept = dict.fromkeys(parts[name] for name in found)
    text, before = "", ""
    for node in kept:
        assert node.end_lineno is not None
        kind = "constant" if isinstance(node, ast.Assign) else "function"
        gap = "\n" if kind == before == "constant" else "\n\n\n" if before else ""
        text += gap + "\n".join(lines[node.lineno - 1 : node.end_lineno])
        before = kind
    return text


def _made(node: ast.stmt) -> list[str]:
    """Names that a statement gives values."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    assert isinstance(node, ast.Assign)
    return [n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name)]


def _named(node: ast.AST) -> list[str]:
    """Names that occur in a tree, in order."""
    return [n.id for n in ast.walk(node) if type(n) is ast.Name]
