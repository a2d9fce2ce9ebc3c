"""Extension modules in folders of their own, and what they are compared with."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.backends.ext import ExtBackend
from pne_sym.model.manipulator import Manipulator
from tests import models
from tests.backends.c_library import quick_compiler
from tests.infinite import finite_parts
from tests.targets.modules import call, condition, functions, vectors

CACHE = Path(__file__).resolve().parents[2] / ".pytest_cache" / "ext"
QUICK = {"PNE_SYM_CACHE": str(CACHE), "PNE_SYM_CFLAGS": "-O0", "CC": quick_compiler()}


@cache
def text(manipulator: Manipulator) -> str:
    """NAME_ext.py."""
    (found,) = ExtBackend().emit(models.bundle(manipulator)).values()
    return found


def placed(folder: Path, manipulator: Manipulator) -> Path:
    """NAME_ext.py in a folder."""
    path = folder / f"{manipulator.name}_ext.py"
    path.write_text(text(manipulator), encoding="utf-8")
    return path


@cache
def ext_module(manipulator: Manipulator) -> Any:
    """NAME_ext.py, compiled quickly."""
    folder = CACHE.with_name("ext-modules")
    for each in (CACHE, folder):
        each.mkdir(mode=0o700, parents=True, exist_ok=True)
    path = placed(folder, manipulator)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = made  # where what is pickled is found
    with pytest.MonkeyPatch.context() as patch:
        for variable, value in QUICK.items():
            patch.setenv(variable, value)
        spec.loader.exec_module(made)
    return made


def pair(of: str | Manipulator) -> tuple[Any, Any]:
    """Extension and NumPy module of a manipulator, or of a catalogue entry."""
    manipulator = models.catalogue(of) if isinstance(of, str) else of
    return ext_module(manipulator), models.module(manipulator)


def run(path: Path, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """`python path arguments` with an environment of this process, changed."""
    return subprocess.run(
        [sys.executable, str(path), *arguments],
        env=os.environ | environment,
        cwd=path.parent,
        capture_output=True,
        text=True,
        check=False,
    )


def assert_alike(of: str | Manipulator, function: str, given: dict[str, Any]) -> None:
    """The results of both modules at the arguments that a function takes."""
    e, m = pair(of)
    found, wanted = call(e, function, given), call(m, function, given)
    assert len(found) == len(wanted), function
    at = np.atleast_2d(given["X"])
    possible = np.isfinite(m.dynamics(at, np.zeros(m.NV))[0]).all(axis=(1, 2))
    at = at[possible & (np.abs(at) < 10.0).all(axis=1)]
    at = at if len(at) else m.HOME_X[None]
    if function == "null_space":
        found, wanted = ([a @ np.swapaxes(a, -1, -2) for a in x] for x in (found, wanted))
    for a, b in zip(found, wanted, strict=True):
        assert (type(a), a.dtype, a.shape) == (type(b), b.dtype, b.shape), function
        np.testing.assert_array_equal(np.isnan(a), np.isnan(b), function)
        found_part, part = finite_parts(a, b)
        error = np.max(np.abs(np.nan_to_num(found_part - part)), initial=0.0)
        # residuals of loops that are closed are rounding: beside lengths of the order of one
        least = 1.0 if function == "constraints" else 0.0
        scale = np.max(np.abs(np.nan_to_num(part)), initial=least) or 1.0
        assert error <= 1e-13 * condition(m, function, {"X": at}) * scale, function


def assert_all_alike(of: str | Manipulator) -> None:
    """Every function: one state, a few, one state of some arguments for several of others."""
    e, m = pair(of)
    states = vectors(m)
    one = {n: v if n == "weights" else v[0] for n, v in states.items()}
    mixed = {n: v[0] if n in ("X", "X0", "t") else v for n, v in states.items()}
    for function in functions(e):
        for given in (states, one, mixed):
            assert_alike(of, function, given)
