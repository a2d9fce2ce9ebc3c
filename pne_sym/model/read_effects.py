"""Friction, springs, motors and limits of a joint, as a specification has them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, TypeVar

from pne_sym.model.effects import Actuator, Effects, Friction, Limits, Spring
from pne_sym.model.entry import Entry, Table
from pne_sym.model.values import SNAP, not_negative, number, numbers

FIELDS = ("friction", "spring", "actuator", "limits")
FRICTION = ("viscous", "coulomb", "velocity_scale")
SPRING = ("stiffness", "rest")
ACTUATOR = ("rotor_inertia", "gear_ratio")
LIMITS = ("displacement", "rate", "effort")

_Kind = TypeVar("_Kind")


def read_effects(
    table: Table, actuated: Sequence[bool], *, mixed: bool = False
) -> tuple[Effects, ...]:
    """What acts in each degree of freedom of a joint.

    Args:
        table: of the joint.
        actuated: for each of its degrees of freedom, whether it is actuated.
        mixed: its degrees of freedom differ in kind: one table cannot be meant for all.

    Raises:
        SpecError: a value without meaning, or a motor where nothing is actuated.
    """
    count = len(actuated)
    frictions = _each(table.get("friction"), count, read_friction, mixed=mixed)
    springs = _each(table.get("spring"), count, _spring, mixed=mixed)
    limits = _each(table.get("limits"), count, _limits, mixed=mixed)
    motors = _each(table.get("actuator"), count, read_actuator, mixed=mixed and sum(actuated) > 1)
    motors = _where_actuated(table.get("actuator"), motors, actuated, lambda _: None, "no motor {}")
    efforts = "no effort {}: nothing acts there"
    limits = _where_actuated(table.get("limits"), limits, actuated, _without_effort, efforts)
    return tuple(map(Effects, frictions, springs, motors, limits))


def _each(
    entry: Entry | None, count: int, read: Callable[[Entry], _Kind], *, mixed: bool
) -> tuple[_Kind | None, ...]:
    """What each degree of freedom has: a table is for every one, a list has an entry for each."""
    if entry is None or entry.value is False:
        return (None,) * count
    if isinstance(entry.value, list | tuple):
        which = ", a table or false for each degree of freedom"
        items = entry.counted(count, "entries", which)
        return tuple(None if item.value is False else read(item) for item in items)
    if mixed:
        raise entry.fault(
            f"a list of {count}, a table or false for each degree of freedom: one is "
            "prismatic, the other revolute"
        )
    return (read(entry),) * count


def _where_actuated(
    entry: Entry | None,
    values: tuple[_Kind | None, ...],
    actuated: Sequence[bool],
    idle: Callable[[Any], _Kind | None],
    expected: str,
) -> tuple[_Kind | None, ...]:
    """What degrees of freedom have, where only actuated ones can have all of it.

    One table is meant for the actuated ones; the others have of it what is left `idle`.
    """
    pairs = zip(values, actuated, strict=True)
    found = tuple(value if own or value is None else idle(value) for value, own in pairs)
    if entry and found != values and (isinstance(entry.value, list | tuple) or not any(actuated)):
        raise entry.fault(expected.format("where the joint is not actuated"))
    return found


def _without_effort(limits: Limits) -> Limits | None:
    rest = replace(limits, effort=None)
    return None if rest == Limits() else rest


def read_friction(entry: Entry) -> Friction:
    """Viscous friction, Coulomb friction, or both.

    Raises:
        SpecError: neither, a negative one, or Coulomb friction without a positive velocity scale.
    """
    table = entry.table(FRICTION)
    if not {"viscous", "coulomb"} & table.fields.keys():
        raise entry.fault("viscous, coulomb with velocity_scale, or all three")
    scale = None
    if table.get("coulomb"):
        meaning = "the rate below which it grows linearly"
        scale = _positive(table.require("velocity_scale", meaning))
    else:
        table.refuse(("velocity_scale",), "it belongs to coulomb")
    return Friction(
        table.read("viscous", not_negative, None), table.read("coulomb", not_negative, None), scale
    )


def _spring(entry: Entry) -> Spring:
    table = entry.table(SPRING)
    stiffness = not_negative(table.require("stiffness", "a number (N m/rad or N/m)"))
    return Spring(stiffness, table.read("rest", number, 0.0))


def read_actuator(entry: Entry) -> Actuator:
    """A motor.

    Raises:
        SpecError: a negative inertia, or a ratio next to zero.
    """
    table = entry.table(ACTUATOR)
    inertia = not_negative(table.require("rotor_inertia", "a number (kg m^2)"))
    gear = table.require("gear_ratio", "motor angle per displacement (of prismatic joints: rad/m)")
    ratio = number(gear)
    if abs(ratio) < SNAP:
        raise gear.fault(f"a number other than zero, at least {SNAP:g} in size")
    return Actuator(inertia, ratio)


def _limits(entry: Entry) -> Limits:
    table = entry.table(LIMITS)
    if not table.fields:
        raise entry.fault("displacement = [least, largest], rate, effort, or some of them")
    return Limits(
        table.read("displacement", _range, None),
        table.read("rate", _positive, None),
        table.read("effort", _positive, None),
    )


def _range(entry: Entry) -> tuple[float, float]:
    least, largest = numbers(entry, 2, "a list of two numbers: least, largest")
    if not least < largest:
        raise entry.fault("a least displacement below the largest")
    return least, largest


def _positive(entry: Entry) -> float:
    value = number(entry)
    if value < SNAP:
        raise entry.fault(f"a positive number, at least {SNAP:g}")
    return value
