"""Changes of the interface in few lines: what follows from one cause is told together."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator

from pne_sym.review.difference import Change

_SHOWN = 10
_ORDERS = ("joints", "actuators", "extra", "constraints")
_NAMES = "constant ACTUATOR_NAMES"
_NAMED = ("actuators", "constant ACTUATED")
"""What the names of the actuators tell too."""
_ARGUMENT = re.compile(r"(\w+) \(")
_SIZE = re.compile(r"'(\w+)': (\d+)")
_LONG = 100
_WIDTH = 98


def interface_lines(changes: list[Change]) -> Iterator[str]:
    """Parameters, functions, sizes and the like."""
    renamed = [c for c in changes if c.kind == "renamed" and c.what == "parameter"]
    sized = [c for c in changes if c.kind == "changed" and c.what.startswith("function ")]
    shaped = [c for c in changes if c.kind == "changed" and c.what.startswith("parameter ")]
    others = [c for c in changes if c not in renamed and c not in sized and c not in shaped]
    if renamed:
        yield from _cut("parameters renamed:", [f"{c.before} -> {c.after}" for c in renamed])
    if shaped:
        yield from _alike(shaped, "parameters of another shape")
    for words in dict.fromkeys(map(_arguments, sized)):
        yield from _alike([c for c in sized if _arguments(c) == words], f"functions {words}")
    for kind, what in ((k, w) for k in ("added", "removed") for w in ("parameter ", "function ")):
        group = [c for c in others if c.kind == kind and c.what.startswith(what)]
        if len(group) > 1:
            others = [c for c in others if c not in group]
            yield from _cut(f"{what.strip()}s {kind}:", [c.what.removeprefix(what) for c in group])
    yield from _others(others)


def _others(others: list[Change]) -> Iterator[str]:
    """What has no group of its own; of actuators their names where these are known."""
    if any(c.what == _NAMES for c in others):
        others = [c for c in others if c.what not in _NAMED]
    orders = [c.what for c in others if c.what in _ORDERS]
    if orders:
        yield from listed("entries of other joints, or in another order:", orders)
    others = [c for c in others if c.what not in _ORDERS]
    for c in others[:_SHOWN]:
        yield from _single(c)
    if len(others) > _SHOWN:
        yield from _cut("and", [c.what for c in others[_SHOWN:]])


def _alike(changes: list[Change], words: str) -> Iterator[str]:
    if len(changes) == 1:
        yield from _single(changes[0])
        return
    names = [c.what.partition(" ")[2] for c in changes]
    yield from _cut(f"{words}:", names)


def _arguments(c: Change) -> str:
    """How the signature of a function changed."""
    old, new = (_ARGUMENT.findall(text.partition("->")[0]) for text in (c.before, c.after))
    for words, names in (
        ("that take", [n for n in new if n not in old]),
        ("that no longer take", [n for n in old if n not in new]),
    ):
        if names:
            return f"{words} {', '.join(names)}"
    return "with other numbers of entries"


def _single(c: Change) -> Iterator[str]:
    if c.what == "sizes":
        yield f"  changed: sizes {_sizes(c)}"
        return
    yield f"  {c.kind}: {c.what}"
    yield from before_after(_short(c.before), _short(c.after))


def before_after(before: str, after: str) -> Iterator[str]:
    """A text before and after, as lines of a diff."""
    yield from (f"-   {line}" for line in before.split("\n") if line)
    yield from (f"+   {line}" for line in after.split("\n") if line)


def _sizes(c: Change) -> str:
    """Those that are others: NU 3 -> 4."""
    old, new = (dict(_SIZE.findall(text)) for text in (c.before, c.after))
    return ", ".join(f"{n} {v} -> {new.get(n)}" for n, v in old.items() if new.get(n) != v)


def _short(text: str) -> str:
    return text if len(text) <= 4 * _LONG else f"{text[: 4 * _LONG]}..."


def _cut(start: str, names: list[str]) -> list[str]:
    more = [f"and {len(names) - _SHOWN} more"] if len(names) > _SHOWN else []
    return listed(start, [*names[:_SHOWN], *more])


def shortened(ids: Iterable[str]) -> Iterator[str]:
    """Ids without the leg type where that before them has it.

    >>> list(shortened(["rpr-q_1", "rpr-q_2", "M_tt", "rpr-U"]))
    ['rpr-q_1', 'q_2', 'M_tt', 'rpr-U']
    """
    known = ""
    for id_ in ids:
        leg_type, hyphen, rest = id_.partition("-")
        yield rest if hyphen and leg_type == known else id_
        known = leg_type if hyphen else ""


def listed(start: str, names: Iterable[str]) -> list[str]:
    """Names in as few lines as there is room for."""
    return wrapped("  ", "    ", f"{start} {', '.join(names)}")


def wrapped(first: str, further: str, text: str) -> list[str]:
    """A text in lines that begin so."""
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=first,
        subsequent_indent=further,
        break_long_words=False,
        break_on_hyphens=False,
    )
