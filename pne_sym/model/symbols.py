r"""Symbols that an author gives to what the specification describes.

A symbol is a letter, a word or a Greek letter with a backslash, and may have a
subscript of the same kind or a number: `L`, `r_u`, `\theta_1`.  Nothing else of
LaTeX is let in.
"""

from __future__ import annotations

import re

from pne_sym.model.entry import Entry
from pne_sym.model.errors import show

GREEK = tuple(
    """
    alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi
    pi rho sigma tau upsilon phi varphi chi psi omega
    Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega
    """.split()
)
MOST = 200
_LETTER = rf"[A-Za-z]{{1,12}}|\\(?:{'|'.join(GREEK)})"
_GRAMMAR = re.compile(rf"(?P<base>{_LETTER})(?:_(?P<sub>{_LETTER}|[0-9]{{1,3}}))?")
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,79}")
_EXPECTED = (
    r"a letter, a word of up to 12 letters or a Greek letter such as \theta, with or without a "
    "subscript of this kind or a number: L, r_u, m_2"
)


def split_symbol(text: str) -> tuple[str, str] | None:
    r"""Base and subscript of a symbol, or None where the text is none.

    >>> split_symbol(r"\theta_12")
    ('\\theta', '12')
    >>> split_symbol(r"\input{x}") is None
    True
    """
    match = _GRAMMAR.fullmatch(text)
    return None if match is None else (match["base"], match["sub"] or "")


def read_symbols(entry: Entry | None) -> tuple[tuple[str, str], ...]:
    """Symbols by the names of quantities, sorted by name.

    Raises:
        SpecError: a name or a symbol is outside the grammar.
    """
    if entry is None:
        return ()
    found: dict[str, str] = {}
    for name, value in entry.named():
        if not _NAME.fullmatch(name):
            raise entry.fault("names of quantities, such as q_1", f"name {show(name)}")
        text = value.text()
        if split_symbol(text) is None:
            raise value.fault(_EXPECTED)
        found[name] = text
    if len(found) > MOST:
        raise entry.fault(f"at most {MOST} symbols", f"{len(found)} symbols")
    return tuple(sorted(found.items()))
