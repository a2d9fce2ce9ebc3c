"""Architecture notation: `6-UPS`, `2-RPR+1-RRR`, `3-_PRPS`; from the base to the platform.

The last letter is the platform joint.  `_` before a letter marks the joint as actuated, `*` after
it as an extra coordinate.  Without any `_` in the whole text, actuators are chosen.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from pne_sym.model.errors import SpecError, show
from pne_sym.model.joint_kinds import WrittenJoint
from pne_sym.model.legs import MAX_LEGS
from pne_sym.model.platform_kinds import PlatformJointKind

PLATFORM = {k.in_architecture: k for k in PlatformJointKind if k.in_architecture}
"""Platform joints that the notation has; W (welded) is the rigid one."""
_BY_MOMENTS = sorted(PLATFORM, key=lambda letter: PLATFORM[letter].moments)
_ENDS = f"{', '.join(_BY_MOMENTS[:-1])} or {_BY_MOMENTS[-1]}"
MOST_DOFS = 7
SOURCE = "--legs"
_GUIDED = 3
"""Legs beside a guide, at least."""

_GROUP = re.compile(r"(?:([0-9]{1,4})-)?((?:_?[A-Za-z]\*?)+)")
_LETTER = re.compile(r"(_?)([A-Za-z])(\*?)")
_GRAMMAR = (
    f"COUNT-LETTERS, several joined by +, of the letters {' '.join(map(str, WrittenJoint))}, "
    "_ before an actuated joint, * after an extra one, such as 6-UPS, 2-RPR+1-RRR, 6-U_PS"
)


@dataclass(frozen=True)
class Letter:
    """A joint as the notation has it.

    Attributes:
        kind: of joint.
        actuated: marked by `_`: of a universal joint the second degree of freedom, of others all.
        extra: marked by `*`: of joints with several degrees of freedom the last.
    """

    kind: WrittenJoint
    actuated: bool = False
    extra: bool = False


@dataclass(frozen=True)
class LegGroup:
    """Legs that are alike.

    Attributes:
        count: how many.
        letters: joints from the base, without the platform joint.
        platform: the platform joint.
    """

    count: int
    letters: tuple[Letter, ...]
    platform: PlatformJointKind

    @property
    def dofs(self) -> int:
        """Degrees of freedom of a leg, without those of the platform joint."""
        return sum(len(letter.kind.parts) for letter in self.letters)

    @property
    def plain(self) -> str:
        """The letters without marks."""
        return (
            "".join(letter.kind.letter for letter in self.letters) + self.platform.in_architecture
        )


def parse_legs(text: str) -> tuple[LegGroup, ...]:
    """Groups of legs from the notation; neighbours that are alike become one.

    >>> [(group.count, group.plain) for group in parse_legs("2-RPR+1-RRR")]
    [(2, 'RPR'), (1, 'RRR')]
    >>> parse_legs("3-R_PS")[0].letters[1].actuated
    True

    Raises:
        SpecError: not in the notation, or more than a specification may have.
    """
    if len(text) > 1000:
        raise fault(f"{len(text)} characters", _GRAMMAR)
    groups: list[LegGroup] = []
    for part in text.split("+"):
        group = _group(part.strip())
        if groups and replace(groups[-1], count=group.count) == group:
            groups[-1] = replace(group, count=groups[-1].count + group.count)
        else:
            groups.append(group)
    total = sum(group.count for group in groups)
    if not 1 <= total <= MAX_LEGS:
        raise fault(f"{total} legs", f"1 to {MAX_LEGS} legs")
    return tuple(groups)


def is_marked(groups: tuple[LegGroup, ...]) -> bool:
    """Whether any joint is marked as actuated: then only the marked ones are."""
    return any(letter.actuated for group in groups for letter in group.letters)


def is_guide(group: LegGroup, groups: tuple[LegGroup, ...]) -> bool:
    """Whether it is a single leg without actuators that holds the platform in the middle."""
    others = sum(other.count for other in groups if other is not group)
    return group.count == 1 and group.platform.moments > 0 and others >= _GUIDED


def _group(part: str) -> LegGroup:
    match = _GROUP.fullmatch(part)
    if not match:
        raise fault(f"value {show(part)}", _GRAMMAR)
    count = int(match[1] or 1)
    if count < 1:
        raise fault(f"{count} legs {show(match[2])}", "one leg or more")
    written = [
        (kind.upper(), actuated, extra) for actuated, kind, extra in _LETTER.findall(match[2])
    ]
    return _leg(part, count, written)


def _leg(part: str, count: int, written: list[tuple[str, str, str]]) -> LegGroup:
    """Legs from their letters, each with its marks."""
    known = {kind.letter: kind for kind in WrittenJoint}
    for letter, *_ in written:
        if letter not in known and letter not in PLATFORM:
            words = ", ".join(f"{kind} {kind.word}" for kind in known.values())
            raise fault(f"joint {letter!r} in {show(part)}", words)
    *chain, (last, *marks) = written
    if not chain:
        raise fault(f"leg {show(part)}", "at least one joint before the platform joint")
    if last not in PLATFORM:
        raise fault(
            f"platform joint {last!r} in {show(part)}",
            f"a leg that ends in {_ENDS} (the last letter is the platform joint)",
        )
    if any(marks):
        raise fault(f"a mark at the platform joint of {show(part)}", "marks of other joints only")
    for letter, *_ in chain:
        if letter not in known:
            raise fault(f"joint {letter!r} in {show(part)}", "only as platform joint, at the end")
    joints = tuple(
        Letter(known[kind], bool(actuated), bool(extra)) for kind, actuated, extra in chain
    )
    group = LegGroup(count, joints, PLATFORM[last])
    if group.dofs > MOST_DOFS:
        raise fault(
            f"{group.dofs} degrees of freedom in {show(part)}",
            f"at most {MOST_DOFS} before the platform joint; longer chains are written by hand",
        )
    return group


def fault(problem: str, expected: str) -> SpecError:
    """What is wrong with the architecture that is asked for."""
    return SpecError(SOURCE, "", problem, expected)
