"""Architecture notation: `6-UPS`, `2-RPR+1-RRR`, `3-_PRPS`; from the base to the platform.

The last letter is the platform joint.  `_` before a letter marks the joint as driven, `*` after
it as an extra coordinate.  Without any `_` in the whole text, drives are chosen.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from pne_sym.model.errors import SpecError, show
from pne_sym.model.legs import MAX_LEGS

FREEDOMS = {"R": 1, "P": 1, "H": 1, "U": 2, "C": 2, "S": 3}
PLATFORM = {"S": 0, "U": 1, "R": 2}
"""Letters of a platform joint, and how many moments it transmits in space."""
MOST_FREEDOMS = 7
SOURCE = "--legs"

_GROUP = re.compile(r"(?:([0-9]{1,4})-)?((?:_?[A-Za-z]\*?)+)")
_LETTER = re.compile(r"(_?)([A-Za-z])(\*?)")
_GRAMMAR = (
    "COUNT-LETTERS, several joined by +, of the letters R P H U C S, "
    "_ before a driven joint, * after an extra one, such as 6-UPS, 2-RPR+1-RRR, 6-U_PS"
)


@dataclass(frozen=True)
class Letter:
    """A joint as the notation has it.

    Attributes:
        kind: R, P, H, U, C or S.
        driven: marked by `_`: of a universal joint the second freedom, of others all.
        extra: marked by `*`: of joints with several freedoms the last.
    """

    kind: str
    driven: bool = False
    extra: bool = False


@dataclass(frozen=True)
class LegGroup:
    """Legs that are alike.

    Attributes:
        count: how many.
        letters: joints from the base, without the platform joint.
        platform: letter of the platform joint.
    """

    count: int
    letters: tuple[Letter, ...]
    platform: str

    @property
    def freedoms(self) -> int:
        """Freedoms of a leg, without those of the platform joint."""
        return sum(FREEDOMS[letter.kind] for letter in self.letters)

    @property
    def plain(self) -> str:
        """The letters without marks."""
        return "".join(letter.kind for letter in self.letters) + self.platform


def parse_legs(text: str) -> tuple[LegGroup, ...]:
    """Groups of legs from the notation; neighbours that are alike become one.

    >>> [(group.count, group.plain) for group in parse_legs("2-RPR+1-RRR")]
    [(2, 'RPR'), (1, 'RRR')]
    >>> parse_legs("3-R_PS")[0].letters[1].driven
    True

    Raises:
        SpecError: not in the notation, or more than a specification may have.
    """
    if len(text) > 1000:
        raise _fault(f"{len(text)} characters", _GRAMMAR)
    groups: list[LegGroup] = []
    for part in text.split("+"):
        group = _group(part.strip())
        if groups and replace(groups[-1], count=group.count) == group:
            groups[-1] = replace(group, count=groups[-1].count + group.count)
        else:
            groups.append(group)
    total = sum(group.count for group in groups)
    if not 1 <= total <= MAX_LEGS:
        raise _fault(f"{total} legs", f"1 to {MAX_LEGS} legs")
    return tuple(groups)


def is_marked(groups: tuple[LegGroup, ...]) -> bool:
    """Whether any joint is marked as driven: then only the marked ones are."""
    return any(letter.driven for group in groups for letter in group.letters)


def _group(part: str) -> LegGroup:
    match = _GROUP.fullmatch(part)
    if not match:
        raise _fault(f"value {show(part)}", _GRAMMAR)
    count = int(match[1] or 1)
    if count < 1:
        raise _fault(f"{count} legs {show(match[2])}", "one leg or more")
    letters = tuple(
        Letter(kind.upper(), bool(driven), bool(extra))
        for driven, kind, extra in _LETTER.findall(match[2])
    )
    for letter in letters:
        if letter.kind not in FREEDOMS:
            raise _fault(
                f"joint {letter.kind!r} in {show(part)}",
                "R revolute, P prismatic, H helical, U universal, C cylindrical, S spherical",
            )
    return _leg(part, count, letters)


def _leg(part: str, count: int, letters: tuple[Letter, ...]) -> LegGroup:
    *joints, last = letters
    if not joints:
        raise _fault(f"leg {show(part)}", "at least one joint before the platform joint")
    if last.kind not in PLATFORM:
        raise _fault(
            f"platform joint {last.kind!r} in {show(part)}",
            "a leg that ends in S, U or R (the last letter is the platform joint)",
        )
    if last.driven or last.extra:
        raise _fault(f"a mark at the platform joint of {show(part)}", "marks of other joints only")
    group = LegGroup(count, tuple(joints), last.kind)
    if group.freedoms > MOST_FREEDOMS:
        raise _fault(
            f"{group.freedoms} freedoms in {show(part)}",
            f"at most {MOST_FREEDOMS} before the platform joint; longer chains are written by hand",
        )
    return group


def _fault(problem: str, expected: str) -> SpecError:
    return SpecError(SOURCE, "", problem, expected)
