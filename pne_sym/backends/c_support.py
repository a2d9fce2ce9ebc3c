"""What of the written-out C in templates/c a module needs."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

from pne_sym.backends.templating import reached

_MADE = re.compile(r"^(?:(?:INLINE|APART|static)\b[^(;]*?\b(\w+)\(|#define (\w+))", re.MULTILINE)
_NAMED = re.compile(r"\b(\w+)\(|\b([A-Z]\w+)\b")


def needed(support: str, texts: Iterable[str]) -> str:
    """The functions and macros that texts name, and those that these name.

    Args:
        support: C source of functions and macros, blank lines between them and nowhere else.
        texts: C source that uses some of them.
    """
    parts = support.strip().split("\n\n")
    made = {name: part for part in parts for name in _names(_MADE, part)}
    names = reached(texts, made, lambda text: _names(_NAMED, text))
    return "\n\n".join(dict.fromkeys(made[name] for name in names))


@lru_cache(1 << 12)
def _names(pattern: re.Pattern[str], text: str) -> frozenset[str]:
    code = re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)
    return frozenset(name for groups in pattern.findall(code) for name in groups if name)
