"""Models compiled in memory, once per test run, and the live parameters of other specifications.

What is compiled is kept between runs, and shared by the workers of one, under all that it depends
on: the engine's sources and templates, versions of libraries, the specification.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import pickle
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.manifest import ManifestBackend
from pne_sym.backends.numpy_backend import NumpyBackend
from pne_sym.derivation import Derivation
from pne_sym.mechanics.derive import derive
from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import from_text
from pne_sym.pipeline import compile_bundle
from tests.oracle.specs import State, random_state, randomise

_ROOT = Path(__file__).resolve().parents[1]
_LIBRARIES = ("jinja2", "numpy", "pne-sym", "sympy")


def _engine() -> str:
    """Digest of everything but the specification that generated texts depend on."""
    found = hashlib.sha256("".join(version(name) for name in _LIBRARIES).encode())
    for folder, pattern in (("pne_sym", "*.py"), ("templates", "*.jinja")):
        for path in sorted((_ROOT / folder).rglob(pattern)):
            found.update(f"{path.relative_to(_ROOT)}\0".encode() + path.read_bytes())
    return found.hexdigest()[:32]


# At import, when the engine has been: what is edited during a run is not taken for what ran.
KEPT = _ROOT / ".pytest_cache" / "models" / _engine()
_STEP = re.compile(r"\.?([a-z_]+)|\[(\d+)\]")


@cache
def catalogue(name: str) -> Manipulator:
    """A manipulator of the catalogue."""
    return manipulators.load(name)


@cache
def derivation(name: str) -> Derivation:
    """The derivation of a manipulator of the catalogue."""
    return derive(catalogue(name))


@cache
def bundle(manipulator: Manipulator) -> Bundle:
    """The compiled manipulator: derivation and program."""
    kept = _place(manipulator, "pickle")
    with alone(kept):
        if not kept.exists():
            keep(kept, pickle.dumps(compile_bundle(manipulator)))
    found: Bundle = pickle.loads(kept.read_bytes())
    return found


@cache
def texts(manipulator: Manipulator) -> tuple[str, str]:
    """The NumPy module and the manifest."""
    kept = _place(manipulator, "json")
    if not kept.exists():
        compiled = bundle(manipulator)
        made = (
            NumpyBackend().emit(compiled)[f"{compiled.name}.py"],
            ManifestBackend().emit(compiled)[f"{compiled.name}.json"],
        )
        keep(kept, json.dumps(made).encode())
    module_text, manifest_text = json.loads(kept.read_bytes())
    return module_text, manifest_text


def _place(manipulator: Manipulator, suffix: str) -> Path:
    """The file for what is made of a manipulator."""
    return KEPT / f"{hashlib.sha256(repr(manipulator).encode()).hexdigest()[:32]}.{suffix}"


@contextmanager
def alone(kept: Path) -> Iterator[None]:
    """Other workers wait, and find made what they would make as well."""
    KEPT.mkdir(parents=True, exist_ok=True)
    with kept.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def keep(kept: Path, made: bytes) -> None:
    """Store, complete at every moment for other workers to read."""
    KEPT.mkdir(parents=True, exist_ok=True)
    for other in KEPT.parent.iterdir():
        if other != KEPT:  # of an engine that is no more
            shutil.rmtree(other, ignore_errors=True)
    draft = kept.with_suffix(f".{os.getpid()}")
    draft.write_bytes(made)
    draft.replace(kept)


def source(manipulator: Manipulator) -> str:
    """Text of the NumPy module."""
    return texts(manipulator)[0]


@cache
def module(manipulator: Manipulator) -> Any:
    """The NumPy module, in memory (typed Any: what it offers depends on the manipulator)."""
    made = ModuleType(manipulator.name)
    exec(compile(source(manipulator), f"<{manipulator.name}.py>", "exec"), made.__dict__)
    return made


def run(m: Any, function: str, arrays: Any, *vectors: Any) -> list[Any]:
    """Arrays (states, *shape) of a function of the program in a NumPy module, at (states, n)."""
    states = [np.moveaxis(v, 0, -1) for v in vectors]
    with np.errstate(all="ignore"):
        mode = m._mode(m._DEFAULT, len(vectors[0]))
        found = mode.run(getattr(m, f"_run_{function}"), arrays, *states)
    return [np.moveaxis(a, -1, 0) for a in found]


def closed(m: Any, X: Any, q: Any) -> Any:
    """Displacements (..., NJ) that close the loops at X in a NumPy module, iterated from q."""
    X, q = (np.broadcast_to(v, (*np.shape(X)[:-1], v.shape[-1])) for v in (X, q))
    columns = [v.reshape(-1, v.shape[-1]).T for v in (X, q)]
    with np.errstate(all="ignore"):
        found = m._closed(m._mode(m._DEFAULT, columns[0].shape[1]), *columns)
    return found.T.reshape(q.shape)


@cache
def manifest(manipulator: Manipulator) -> dict[str, Any]:
    """The manifest, as a program would read it."""
    data: dict[str, Any] = json.loads(texts(manipulator)[1])
    return data


@cache
def drawn(file: str) -> Manipulator:
    """A manipulator that was drawn at random and kept in tests/data/drawn."""
    text = (_ROOT / f"tests/data/drawn/{file}.json").read_text(encoding="utf-8")
    return from_text(text, ".json", file)


@cache
def random_spec(name: str, seed: int) -> Manipulator:
    """Random geometry, inertia, tilted frames and gravity of a catalogue entry's structure."""
    return randomise(catalogue(name), np.random.default_rng(seed))


@cache
def same_branch_spec(name: str, seed: int) -> Manipulator:
    """A random specification whose home is on the catalogue entry's branches.

    Branches are fixed at generation: only such a one is a matter of parameters.
    """
    wanted = derive(catalogue(name)).parameters.branches
    for attempt in range(200):
        found = random_spec(name, 1000 * attempt + seed)
        if derive(found).parameters.branches == wanted:
            return found
    raise AssertionError(f"no random {name} on the branches of its own home")


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
