"""Models compiled in memory, once per test run, and the live parameters of other specifications."""

from __future__ import annotations

import json
import re
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.manifest import ManifestBackend
from pne_sym.backends.numpy_backend import NumpyBackend
from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Manipulator
from pne_sym.pipeline import compile_bundle
from tests.oracle.specs import State, random_state, randomise

_STEP = re.compile(r"\.?([a-z_]+)|\[(\d+)\]")


@cache
def catalogue(name: str) -> Manipulator:
    """A manipulator of the catalogue."""
    return manipulators.load(name)


@cache
def bundle(manipulator: Manipulator) -> Bundle:
    """The compiled manipulator: derivation and program."""
    return compile_bundle(manipulator)


@cache
def source(manipulator: Manipulator) -> str:
    """Text of the NumPy module."""
    compiled = bundle(manipulator)
    return NumpyBackend().emit(compiled)[f"{compiled.name}.py"]


@cache
def module(manipulator: Manipulator) -> Any:
    """The NumPy module, in memory (typed Any: what it offers depends on the manipulator)."""
    made = ModuleType(manipulator.name)
    exec(compile(source(manipulator), f"<{manipulator.name}.py>", "exec"), made.__dict__)
    return made


@cache
def manifest(manipulator: Manipulator) -> dict[str, Any]:
    """The manifest, as a program would read it."""
    compiled = bundle(manipulator)
    data: dict[str, Any] = json.loads(ManifestBackend().emit(compiled)[f"{compiled.name}.json"])
    return data


@cache
def random_spec(name: str, seed: int) -> Manipulator:
    """Random geometry, inertia, tilted frames and gravity of a catalogue entry's structure."""
    return randomise(catalogue(name), np.random.default_rng(seed))


@cache
def state_at(manipulator: Manipulator, seed: int) -> State:
    """A random closed state of a manipulator."""
    return random_state(manipulator, np.random.default_rng(seed))


def live_parameters(nominal: Manipulator, other: Manipulator) -> Any:
    """`Parameters` of the module generated from `nominal` with the numbers of `other`.

    Only what the manifest says is used: name, shape and path of every parameter.
    """
    form = to_full_form(other)
    values = {p["name"]: _value(p, form) for p in manifest(nominal)["parameters"]}
    return module(nominal).Parameters(**values)


def _value(parameter: dict[str, Any], form: dict[str, Any]) -> Any:
    path = parameter["path"]
    if "legs" not in parameter:
        return np.array(at_path(form, path), dtype=float).reshape(parameter["shape"])
    rows = [at_path(form, path.replace("[i]", f"[{leg}]")) for leg in parameter["legs"]]
    return np.array(rows, dtype=float).reshape(parameter["shape"])


def at_path(form: Any, path: str) -> Any:
    """The value at a path such as legs[2].joints[1].link.mass of a full form."""
    assert "".join(m.group(0) for m in _STEP.finditer(path)) == path, path
    for match in _STEP.finditer(path):
        name, index = match.groups()
        form = form[name] if name else form[int(index)]
    return form


def parameter_names(manipulator: Manipulator) -> dict[str, str]:
    """Entries of parameters and signs of branches -> leg type, or ""."""
    table = bundle(manipulator).derivation.parameters
    entries = {name: field.leg_type or "" for name, (field, _) in table.entries.items()}
    return entries | {name: leg_type for name, (leg_type, _) in table.branches.items()}
