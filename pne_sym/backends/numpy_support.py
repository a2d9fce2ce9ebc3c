"""What of the written-out Python in templates/numpy and templates/kernels a module needs."""

from __future__ import annotations

import ast
import re
import textwrap
from collections.abc import Iterable
from functools import cache, lru_cache
from typing import NamedTuple

from pne_sym.backends.kernels import texts
from pne_sym.backends.templating import reached, render

_SUPPORT = (
    *("modes", "recording", "replay"),
    *("operations", "linear", "bounds", "iteration", "rotations"),
)
_NAME = re.compile(r"(?<![\w.])_\w+")
_SPELLINGS = {
    r" *(?:xp = self\.xp|a = self\.require_rotation\(a\))\n": "",  # arguments are looked at before
    r"_constant\(xp, ((?:[^()]|\((?:[^()]|\([^()]*\))*\))*)\)": r"\1",
    r"self\.number\(([^()]*)\)": r"\1",
    r"\b(?:self\.)?xp\.": "np.",
    r", \.\.\.\]": "]",
    r"\bnp\.concat\b": "np.concatenate",
    r"\bnp\.atan2\b": "np.arctan2",
    r"x, _ = self\.eliminated\(": "x = _solve(",
    r"self\.pivot\b": "_PIVOT",
    r"self\.tiny\b": "0.0",
    r"self\.eye\((\w+)\)": r"np.eye(len(\1))[..., None]",
    r"self\.outer\((\w+), (\w+)\)": r"\1[:, None] * \2",
    r"self\.bordered\((\w+)\)": r"np.pad(\1, ((0, 1), (0, 1), (0, 0)))",
    r"self\.largest\((\w+)\)": r"np.max(abs(\1), axis=0)",
    r"self\.product\((\w+), (\w+)\)": r'np.einsum("iks,kjs->ijs", \1, \2)',
    r"self\.transposed\((\w+)\)": r"np.swapaxes(\1, 0, 1)",
    r"^def (\w+)\(self, ": r"\ndef _\1(",
    r"self\.": "_",
}
"""Patterns of what kernels, which are methods, write otherwise than functions, in this order."""


@cache
def support(quaternion_at: int | None = None) -> str:
    """All that a module may need: NumPy's own, then kernels.

    Args:
        quaternion_at: place of the quaternion in poses, if they have one.
    """
    own = "\n".join(render(f"numpy/{name}.py.jinja") for name in _SUPPORT)
    text = textwrap.dedent("".join(texts(quaternion_at)))
    for pattern, spelling in _SPELLINGS.items():
        text = re.sub(pattern, spelling, text, flags=re.MULTILINE)
    return f"{own}\n{text}"


class _Part(NamedTuple):
    """A function, a class or a constant: its source."""

    text: str
    is_constant: bool


def needed(support: str, texts: Iterable[str]) -> str:
    """The functions, classes and constants that texts name, and those that these name.

    Args:
        support: Python source of functions, classes and constants, in the order of the result; of
            those with one name the first counts.
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
        for name in _made(node):
            found.setdefault(name, part)
    return found


def _made(node: ast.stmt) -> list[str]:
    """Names that a statement gives values."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    assert isinstance(node, ast.Assign)
    return [n.id for target in node.targets for n in ast.walk(target) if isinstance(n, ast.Name)]


@lru_cache(1 << 12)  # most are of the support, which all models have
def _named(text: str) -> frozenset[str]:
    """Names in source that begin as those of the support do, attributes apart."""
    return frozenset(_NAME.findall(text))
