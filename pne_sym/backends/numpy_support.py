"""What of the written-out Python in templates/numpy a module needs."""

from __future__ import annotations

import ast
from collections.abc import Iterable


def needed(support: str, texts: Iterable[str]) -> str:
    """The functions, classes and constants that texts name, and those that these name.

    Args:
        support: Python source of functions, classes and constants, in the order of the result.
        texts: Python source that uses some of them.
    """
    lines = support.split("\n")
    parts = {name: node for node in ast.parse(support).body for name in _made(node)}
    open_ = [name for text in texts for name in _named(ast.parse(text)) if name in parts]
    found = set[str]()
    while open_:
        name = open_.pop()
        if name not in found:
            found.add(name)
            open_ += [other for other in _named(parts[name]) if other in parts]
    kept = dict.fromkeys(node for name, node in parts.items() if name in found)
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
    return [n.id for n in ast.walk(node) if isinstance(n, ast.Name)]
