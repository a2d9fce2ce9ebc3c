"""A whole derivation: a list of chapters, which are lists of equations; the proof as data."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from pne_sym.derivation.coordinates import Coordinates, LegTypeInfo, Output
from pne_sym.derivation.equation import Equation, ReciprocalBasis
from pne_sym.derivation.frames import BodyFrame
from pne_sym.derivation.parameters import ParameterTable
from pne_sym.derivation.quantity import Frame, Given, Quantity, Role
from pne_sym.vector import LinearForm
from pne_sym.vector.arrays import Relation

_JOINT_STATE = (Role.DISPLACEMENT, Role.RATE, Role.JOINT_ACCELERATION)


@dataclass(frozen=True)
class Chapter:
    """A run of equations on one subject.

    Attributes:
        id: prefix of the equations' ids.
        title: for people.
        leg_type: name of the leg type the chapter is about, or None.
        text: an opening paragraph, Markdown.
        equations: in order.
    """

    id: str
    title: str
    leg_type: str | None
    text: str
    equations: tuple[Equation, ...]


@dataclass(frozen=True)
class Derivation:
    """The whole derivation of a manipulator.

    Attributes:
        chapters: in order; names are defined before they are used.
        notation: by name.
        bases: reciprocal bases.
        givens: components of what is given.
        frames: frames, parents first.
        body_frames: those of them that are the axes of a body.
        pose: components of what describes the platform's rotation; no program needs it.
        parameters: the live parameters.
        outputs: what the generated code returns.
        leg_types: the leg types, in order of first appearance.
        coordinates: names and order of what goes in and comes out.
        collected: name -> coefficients of the accelerations and remainder, by their names;
            None where only the remainder is wanted.
        relations: equations between whole arrays, of all legs.
    """

    chapters: tuple[Chapter, ...]
    notation: dict[str, Quantity] = field(default_factory=dict)
    bases: tuple[ReciprocalBasis, ...] = ()
    givens: tuple[Given, ...] = ()
    frames: tuple[Frame, ...] = ()
    body_frames: tuple[BodyFrame, ...] = ()
    pose: tuple[Given, ...] = ()
    parameters: ParameterTable = field(default_factory=ParameterTable)
    outputs: tuple[Output, ...] = ()
    leg_types: tuple[LegTypeInfo, ...] = ()
    coordinates: Coordinates | None = None
    collected: dict[str, LinearForm | None] = field(default_factory=dict)
    relations: tuple[Relation, ...] = ()

    def equations(self) -> Iterator[Equation]:
        """All equations in order."""
        for chapter in self.chapters:
            yield from chapter.equations

    def rotations(self) -> Iterator[Equation]:
        """How axes of bodies are turned: for readers, programs take components from the frames."""
        for body in self.body_frames:
            if body.equation is not None:
                yield body.equation

    def leg_state(self) -> Iterator[Quantity]:
        """Scalars of a leg that are given: extra coordinates, what is found by iteration."""
        defined = {e.name for e in self.equations()}
        for quantity in self.notation.values():
            if quantity.joint and quantity.role in _JOINT_STATE and quantity.name not in defined:
                yield quantity

    def with_role(self, role: Role) -> Quantity | None:
        """The platform's quantity with a role, or None."""
        found = (q for q in self.notation.values() if q.role is role and not q.leg_type)
        return next(found, None)

    def definition(self, name: str) -> Equation:
        """The equation that defines a name.

        Raises:
            KeyError: nothing defines it (it is given).
        """
        for equation in (*self.equations(), *self.rotations()):
            if equation.name == name:
                return equation
        raise KeyError(name)


def full_names(derivation: Derivation, name: str) -> list[str]:
    """A quantity's names with their leg types: a name without type is of all types that have it.

    q_2 is rpr_q_2 and prr_q_2, q_2_rpr is rpr_q_2; what is no such quantity is returned as it is.
    """
    if name in derivation.notation:
        return [name]
    types = [info.name for info in derivation.leg_types]
    found = (f"{of}_{text}" for of in types for text in (name, name.removesuffix(f"_{of}")))
    return [n for n in dict.fromkeys(found) if n in derivation.notation] or [name]


def full_name(derivation: Derivation, name: str) -> str:
    """The same where one type has it; what several have is returned as it is."""
    found = full_names(derivation, name)
    return found[0] if len(found) == 1 else name
