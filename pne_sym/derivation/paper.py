"""What stands where in the paper: its numbered equations and sections, and the laws they state.

Dasgupta & Choudhury (1999), Mech. Mach. Theory 34, 801-824.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from pne_sym.derivation.equation import Law

BEYOND = "beyond the paper"
_REFERENCE = re.compile(
    r"(?:Sec\. (?P<section>\d(?:\.\d)?(?:, (?:joint table|step \d\.\d))?)(?:, (?=Eq)|$))?"
    r"(?:Eqs?\. (?P<equations>\d+(?:, \d+)*))?"
)


@dataclass(frozen=True)
class Passage:
    """A numbered equation, or a section.

    Attributes:
        section: that it stands in.
        laws: of the equations of a derivation that refer to it.
        statement: in words.
    """

    section: str
    laws: frozenset[Law]
    statement: str


def _passages(table: str) -> dict[str, Passage]:
    found = {}
    for line in table.strip().splitlines():
        name, section, laws, statement = (cell.strip() for cell in line.split("|"))
        found[name] = Passage(section, frozenset(Law[word] for word in laws.split()), statement)
    return found


EQUATIONS = _passages("""
1  | 2   | NEWTON                        | Newton: forces on a body and its mass times acceleration
2  | 2   | EULER                         | Euler: moments about a point and the inertia of a body
3  | 2.3 | REDUCTION NEWTON              | force of a leg: of its actuators, and the rest
4  | 2.3 | RULES                         | force of a leg with the acceleration collected
5  | 2.4 | ASSEMBLY                      | equations of motion
6  | 3.5 | ASSEMBLY FREEDOM RULES        | equations of motion with coordinates of extra joints
7  | 3.6 | ASSEMBLY FREEDOM RULES        | equations of motion with passive extra coordinates
8  | 4.1 | RECIPROCITY                   | five-bar, slides: acceleration of the slide
9  | 4.1 | RECIPROCITY                   | five-bar, slides: angular acceleration of the leg
10 | 4.1 | RATE                          | five-bar, slides: acceleration of the lower link
11 | 4.1 | RATE                          | five-bar, slides: acceleration of the upper link
12 | 4.1 | FREEDOM                       | five-bar, slides: forces along the slide
13 | 4.1 | FREEDOM                       | five-bar, slides: moments about the base joint
14 | 4.1 | RULES                         | five-bar, slides: force of a leg
15 | 4.1 | ASSEMBLY                      | five-bar, slides: equations of motion
16 | 4.2 | RECIPROCITY                   | five-bar, turning: joint accelerations
17 | 4.2 | RATE                          | five-bar, turning: acceleration of the lower link
18 | 4.2 | RATE                          | five-bar, turning: acceleration of the upper link
19 | 4.2 | FREEDOM                       | five-bar, turning: moments about the elbow
20 | 4.2 | FREEDOM                       | five-bar, turning: moments about the base joint
21 | 4.2 | RULES                         | five-bar, turning: force of a leg
22 | 4.2 | ASSEMBLY                      | five-bar, turning: equations of motion
23 | 5.2 | RATE                          | 3-PRPS: acceleration of the connection point
24 | 5.2 | RATE                          | 3-PRPS: acceleration of the lower link
25 | 5.2 | RATE                          | 3-PRPS: acceleration of the middle link
26 | 5.2 | RATE                          | 3-PRPS: acceleration of the upper link
27 | 5.2 | FREEDOM                       | 3-PRPS: forces along the leg
28 | 5.2 | FREEDOM                       | 3-PRPS: forces along the base slide
29 | 5.2 | FREEDOM                       | 3-PRPS: moments about the base joint
30 | 5.2 | RECIPROCITY                   | 3-PRPS: force of a leg by its components
31 | 5.2 | RULES                         | 3-PRPS: force of a leg with the acceleration collected
32 | 5.2 | NEWTON ASSEMBLY RATE          | forces on the platform
33 | 5.2 | EULER ASSEMBLY                | moments on the platform about its origin
34 | 5.2 | ASSEMBLY RULES                | equations of motion: M, Z and H
35 | 5.4 | GEOMETRY RECIPROCITY          | 3-RPS: force of a leg with a constraint force
36 | 5.4 | ASSEMBLY                      | 3-RPS: equations of motion with constraint forces
37 | 5.4 | LOOP_CLOSURE                  | 3-RPS: the constraints
""")
SECTIONS = _passages("""
2.2              | 2.2 | RATE                          | kinematics and dynamics of a leg
2.2, joint table | 2.2 | FREEDOM RATE GEOMETRY RECIPROCITY | which equations belong to which joint
2.3              | 2.3 | RULES RECIPROCITY             | solution for a leg's force; Rules I and II
2.5, step 1.1    | 2.5 | GEOMETRY RATE                 | motion of the connection points
2.5, step 1.3    | 2.5 | EULER                         | equilibrium of the distal links
""")


def passages(reference: str) -> tuple[Passage, ...]:
    """The passages that a reference names; none for an empty one, and for what is not in the paper.

    Raises:
        ValueError: it has another form, or names what the paper does not have.

    >>> [p.statement for p in passages("Eqs. 6, 7")]
    ['equations of motion with coordinates of extra joints', \
'equations of motion with passive extra coordinates']
    """
    if reference in ("", BEYOND):
        return ()
    match = _REFERENCE.fullmatch(reference)
    if match is None:
        raise ValueError(f"{reference!r} is no reference to the paper")
    section, numbers = match["section"], (match["equations"] or "").split(", ")
    try:
        found = [EQUATIONS[number] for number in numbers if number]
        named = [SECTIONS[section]] if section else []
    except KeyError as error:
        raise ValueError(f"{reference!r}: the paper has no {error}") from None
    if named and any(p.section != named[0].section for p in found):
        raise ValueError(f"{reference!r}: the equation stands in another section")
    return (*named, *found)


def check_reference(reference: str, law: Law) -> None:
    """Whether what the paper says there is a matter of this law.

    Raises:
        ValueError: it is not, or the paper has no such passage.
    """
    for passage in passages(reference):
        if law not in passage.laws:
            raise ValueError(f"{reference!r} is on {passage.statement!r}, no matter of {law.name}")
