"""LaTeX names of quantities taken apart and put together: base, subscript, superscript."""

from __future__ import annotations

import re
from typing import NamedTuple

_GROUP = re.compile(r"\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}")
_TOKEN = re.compile(r"\\[A-Za-z]+\s?|\\.|[^\\{}]")
_WORD = re.compile(r"\\[A-Za-z]+\s*")
_INVISIBLE = re.compile(
    r"\\(?:mathbf|boldsymbol|math(?:rm|sf|tt|frak)|(?:wide)?tilde|hat|d?dot|left|right)(?![a-z])\s*"
    r"|\\[,;! ]"
)
_FRACTION = re.compile(rf"\\frac({_GROUP.pattern})({_GROUP.pattern})")
_SCRIPT = re.compile(rf"[_^]({_GROUP.pattern}|\\[A-Za-z]+|.)")


class Glyph(NamedTuple):
    r"""A symbol with its scripts, such as \mathbf h with subscript 2.

    >>> str(Glyph.of(r"\mathbf h_{2}").tilde().indexed("i"))
    '\\tilde{\\mathbf h}_{2,i}'
    """

    base: str
    sub: str = ""
    sup: str = ""

    @staticmethod
    def of(latex: str) -> Glyph:
        """Parse the LaTeX of a symbol; scripts are those outside all braces."""
        base, sub, sup = "", "", ""
        at = 0
        while at < len(latex):
            mark = latex[at]
            if mark == "'":
                sup, at = sup + r"\prime", at + 1
            elif mark in "_^":
                script, at = _argument(latex, at + 1)
                sub, sup = (sub + script, sup) if mark == "_" else (sub, sup + script)
            else:
                piece, at = _piece(latex, at)
                base += piece
        return Glyph(base, sub, sup)

    def tilde(self) -> Glyph:
        """With the tilde of a cross-product tensor."""
        return self._replace(base=rf"\tilde{{{self.base}}}")

    def indexed(self, index: str) -> Glyph:
        """With one more index."""
        return self._replace(sub=f"{self.sub},{index}" if self.sub else index)

    def raised(self, exponent: str) -> str:
        """To a power, in brackets where a superscript stands already."""
        if self.sup:
            return f"({self})^{braced(exponent)}"
        return str(self._replace(sup=exponent))

    def __str__(self) -> str:
        text = self.base
        if self.sub:
            text += f"_{braced(self.sub)}"
        if self.sup:
            text += f"^{braced(self.sup)}"
        return text


def braced(script: str) -> str:
    """The argument of a script: one character, or in braces."""
    return script if len(script) == 1 else f"{{{script}}}"


def _argument(latex: str, at: int) -> tuple[str, int]:
    """The argument of a script: a group, a command or one character."""
    piece, end = _piece(latex, at)
    return (piece[1:-1] if piece.startswith("{") else piece.strip()), end


def _piece(latex: str, at: int) -> tuple[str, int]:
    """A group or a token of the base."""
    found = _GROUP.match(latex, at) or _TOKEN.match(latex, at)
    if found is None:
        raise ValueError(f"unbalanced braces, or a script without argument, in {latex!r}")
    return found.group(), found.end()


def visible_width(latex: str) -> float:
    r"""Rough width of a formula in characters; scripts count less, fractions once.

    >>> visible_width(r"\mathbf a\times\mathbf b")
    3
    """
    text = _INVISIBLE.sub("{}", latex)
    while match := _FRACTION.search(text):
        wider = max(match.group(1), match.group(2), key=visible_width)
        text = text[: match.start()] + wider + text[match.end() :]
    scripts = sum(0.6 * len(_WORD.sub("x", script).strip("{}")) for script in _SCRIPT.findall(text))
    body = _WORD.sub("x", _SCRIPT.sub("", text))
    return len(re.sub(r"[{}&\s]", "", body)) + scripts
