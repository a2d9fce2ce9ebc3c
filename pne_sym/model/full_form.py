"""A manipulator as the full form of its specification: plain, JSON-ready, without shorthand."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

from pne_sym.model.joint_kinds import JointKind
from pne_sym.model.kind import Kind
from pne_sym.model.manipulator import Body, Leg, Manipulator

Plain = dict[str, object]
_PITCHED = {kind.letter for kind in JointKind if kind.pitched}


def to_full_form(manipulator: Manipulator) -> Plain:
    """The full form; reading it gives an equal manipulator."""
    m = manipulator
    form: Plain = {
        "name": m.name,
        "title": m.title,
        "space": str(m.space),
        "gravity": list(m.gravity),
    }
    if m.fixed_centre is not None:
        form["fixed_centre"] = list(m.fixed_centre)
    if m.moving_base:
        form["moving_base"] = True
    if m.coupling is not None:
        form["coupling"] = [list(row) for row in m.coupling]
    payload = {} if m.payload is None else {"payload": _table(m.payload, Body)}
    form["platform"] = _table(m.platform, Body) | payload
    form["legs"] = [_table(leg, Leg) for leg in m.legs]
    form["home"] = {"X": list(m.home.X)} | ({"q": list(m.home.q)} if m.home.q else {})
    if m.symbols:
        form["symbols"] = dict(m.symbols)
    return form


def _table(part: Any, of: type | None = None) -> Plain:
    """The fields of a part that are there; what it is called first, a pitch where there is one."""
    form: Plain = {}
    for field in sorted(fields(of or part), key=lambda field: field.name not in ("type", "name")):
        name, value = field.name, getattr(part, field.name)
        absent = value is field.default is None or (field.default == "" and value == "")
        if not absent and (name != "pitch" or str(part.kind) in _PITCHED):
            form[name] = _plain(value)
    return form


def _plain(value: Any) -> object:
    """Tables, lists, texts, numbers.

    Raises:
        TypeError: it is none of these.
    """
    if isinstance(value, int | float | np.generic):
        return value
    if isinstance(value, str | Kind):
        return str(value)
    return _table(value) if is_dataclass(value) else [_plain(each) for each in value]
