"""Quantities of one derivation by their names in another: leg types and joints aligned.

A joint that is put in moves the numbers of those beyond it, and a second leg type puts
the name of the first into all its names. Neither is a change of the quantity.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import sympy as sp
from sympy.core.symbol import Str

from pne_sym.review.alignment import Alignment
from pne_sym.review.evaluation import SUMS, Structure
from pne_sym.vector import TensorAdd, TensorSymbol, VectorAdd, VectorSymbol

_TOKEN = re.compile(r"[A-Za-z_]\w*")


class Names:
    """Names after by their names before.

    Attributes:
        partner: name after -> name before: quantities, frames, leg types, entries of parameters.
        found: those of them that the alignment gives.
        legs: leg after -> leg before.
    """

    def __init__(self, before: Structure, after: Structure, alignment: Alignment) -> None:
        self.a, self.b, self.alignment = before, after, alignment
        self.legs = {leg: old for leg, old in alignment.legs.items() if leg in after.type_of_leg}
        self.partner: dict[str, str] = dict(alignment.types)
        self._by_stem = {
            (before.leg_type.get(n, ""), _stem(n, before.leg_type.get(n, ""))): n
            for n in (*before.givens, *before.equations)
        }
        for name in (*after.givens, *after.equations):
            if (found := self._quantity(name)) is not None:
                self.partner[name] = found
        self.partner |= dict(self._entries())
        self.partner |= dict(self._frames())
        self.found = dict(self.partner)

    def as_before(self, text: str) -> str:
        """A text after with the names before; names without counterpart are marked."""
        known = self.partner

        def other(match: re.Match[str]) -> str:
            name = match[0]
            if name in known:
                return known[name]
            is_quantity = name in self.b.equations or name in self.b.givens
            return f"new {name}" if is_quantity else name

        return _TOKEN.sub(other, text)

    def expression(self, expr: Any) -> Any:
        """An expression after with the names before; sums over types that were one joined."""
        if isinstance(expr, SUMS):
            value, leg_type = expr.args
            return expr.func(
                self.expression(value), Str(self.partner.get(str(leg_type), f"new {leg_type}"))
            )
        if isinstance(expr, VectorSymbol | TensorSymbol | sp.Symbol):
            return self._symbol(expr)
        args = getattr(expr, "args", ())
        if not args:
            return expr
        made = [self.expression(arg) for arg in args]
        if isinstance(expr, sp.Add | VectorAdd | TensorAdd):
            made = [a for k, a in enumerate(made) if not isinstance(a, SUMS) or a not in made[:k]]
        if len(made) == 1 and len(args) > 1:
            return made[0]
        same = len(made) == len(args) and all(a is b for a, b in zip(made, args, strict=True))
        return expr if same else expr.func(*made)

    def _symbol(self, symbol: Any) -> Any:
        name = str(symbol.name)
        other = self.as_before(name)
        if other == name:
            return symbol
        if isinstance(symbol, VectorSymbol):
            return VectorSymbol(other)
        if isinstance(symbol, TensorSymbol):
            return TensorSymbol(other, symbol.args[1])
        return sp.Symbol(other, real=True)

    def joints_of(self, leg_type: str) -> dict[int, int]:
        """Joint after -> joint before of a leg type, both from 1."""
        old = self.alignment.types.get(leg_type)
        for leg in self.b.legs.get(leg_type, ()):
            partner = self.legs.get(leg)
            if partner is not None and self.a.type_of_leg.get(partner) == old:
                return {j + 1: i + 1 for j, i in self.alignment.joints[leg].items()}
        return {}

    def _quantity(self, name: str) -> str | None:
        new_type = self.b.leg_type.get(name, "")
        old_type = self.alignment.types.get(new_type) if new_type else ""
        if old_type is None:
            return None
        for mapped in self._mapped(_stem(name, new_type), new_type):
            partner = self._by_stem.get((old_type, mapped))
            if partner is not None and self._same_title(partner, name, new_type):
                return partner
        return None

    def _mapped(self, text: str, leg_type: str, *, everywhere: bool = False) -> Iterator[str]:
        """A text of a leg type after with the numbers of joints as they are before."""
        joints, count = self.joints_of(leg_type), self._joint_count(leg_type)
        return _renumbered(text, joints, count, everywhere=everywhere)

    def _joint_count(self, leg_type: str) -> int:
        return max((t.joints for t in self.b.derivation.leg_types if t.name == leg_type), default=0)

    def _same_title(self, before: str, after: str, leg_type: str) -> bool:
        """Whether two quantities say the same of corresponding joints."""
        joints, count = self.joints_of(leg_type), self._joint_count(leg_type)
        if all(joints.get(k, k) == k for k in range(1, count + 1)) and len(joints) >= count:
            return True
        titles = [self._title(s, n) for s, n in ((self.a, before), (self.b, after))]
        return next(self._mapped(titles[1], leg_type), "") == titles[0]

    @staticmethod
    def _title(s: Structure, name: str) -> str:
        if name in s.equations:
            return s.equations[name].title
        quantity = s.derivation.notation.get(name)
        return quantity.meaning if quantity else name

    def _entries(self) -> Iterator[tuple[str, str]]:
        """Entries of parameters, by the paths at which these stand in the full form."""
        places = {
            (path, index): name
            for name, (f, index) in self.a.derivation.parameters.entries.items()
            for path in f.paths
        }
        for name, (f, index) in self.b.derivation.parameters.entries.items():
            partners = {
                places.get((path, index)) for path in map(self.alignment.canonical, f.paths)
            }
            found = sorted(p for p in partners if p is not None)
            if found:
                yield name, found[0]
        for name, (leg_type, _) in self.b.derivation.parameters.branches.items():
            for mapped in self._mapped(_stem(name, leg_type), leg_type):
                for old, (of, _) in self.a.derivation.parameters.branches.items():
                    if of == self.alignment.types.get(leg_type) and _stem(old, of) == mapped:
                        yield name, old

    def _frames(self) -> Iterator[tuple[str, str]]:
        """Frames by leg type and joint: rpr.axes1."""
        for name in self.b.frames:
            leg_type, dot, rest = name.partition(".")
            if not dot or leg_type not in self.alignment.types:
                continue
            for mapped in self._mapped(rest, leg_type, everywhere=True):
                old = f"{self.alignment.types[leg_type]}.{mapped}"
                if old in self.a.frames:
                    yield name, old


def _stem(name: str, leg_type: str) -> str:
    """A name without that of its leg type."""
    if not leg_type:
        return name
    return re.sub(rf"(?:^|_){re.escape(leg_type)}(?=_|$)", "", name).lstrip("_")


def _renumbered(
    text: str, joints: Mapping[int, int], count: int, *, everywhere: bool = False
) -> Iterator[str]:
    """A text with the numbers of joints as they are before: numbers alone, then all.

    Nothing where a joint has no counterpart.
    """
    alone, anywhere = r"(?<![A-Za-z0-9])\d+(?![A-Za-z0-9])", r"\d+"
    for pattern in (anywhere,) if everywhere else (alone, anywhere):
        lost = False

        def other(match: re.Match[str]) -> str:
            nonlocal lost
            number = int(match[0])
            if not 1 <= number <= count:
                return match[0]
            lost |= number not in joints
            return str(joints.get(number, number))

        found = re.sub(pattern, other, text)
        if not lost:
            yield found
