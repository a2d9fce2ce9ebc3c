"""MATLAB / Octave packages in Octave, function by function, against the NumPy modules."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.io

from pne_sym.backends.octave import OctaveBackend
from pne_sym.model.manipulator import Manipulator
from pne_sym.program.public import Argument, PublicFunction
from tests import models
from tests.backends.c_library import Array
from tests.cli.program import HANG, pne_gen
from tests.infinite import finite_parts
from tests.program.test_public import interpreter, spanned
from tests.targets.modules import condition, vectors

GOOD = 4
"""States at which all is possible; the others follow."""


@dataclass(frozen=True)
class Call:
    """A function at arguments, by name."""

    function: PublicFunction
    given: dict[str, Array]

    @property
    def inputs(self) -> tuple[Argument, ...]:
        """Arguments that are given."""
        return tuple(a for a in self.function.inputs if a.name in self.given)


def octave() -> str | None:
    """The interpreter, if it is installed."""
    return shutil.which("octave-cli")


def write(manipulator: Manipulator, folder: Path) -> Path:
    """The package below a folder; what is to be on Octave's path."""
    for name, text in OctaveBackend().emit(models.bundle(manipulator)).items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return folder / "octave"


def run(script: str, path: Path) -> str:
    """What a script prints that runs with this folder on the path; any error is one."""
    program = octave()
    assert program is not None
    # Within the package, NAME.power is no other than it says.
    lines = "warning('off', 'Octave:shadowed-function');"
    lines += f"warning('error', 'Octave:undefined-return-values');addpath('{path}');\n{script}"
    with tempfile.TemporaryDirectory() as home:
        done = subprocess.run(
            [program, "--no-gui", "--norc", "--no-history", "--eval", lines],
            capture_output=True, text=True, check=False, timeout=HANG,
            env={**os.environ, "HOME": home, "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
    assert done.returncode == 0 and "warning" not in done.stderr, done.stderr  # noqa: PT018
    return done.stdout


def columns(array: Array, argument: Argument) -> Array:
    """States last."""
    if array.ndim == len(argument.value.shape):
        return array[..., None]
    return np.moveaxis(array, 0, -1)


def answers(manipulator: Manipulator, calls: list[Call]) -> list[tuple[list[Array], Array]]:
    """Outputs (states first) and statuses of calls, in one process."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        path = write(manipulator, folder)
        data, lines = {}, [f"load('{folder / 'in.mat'}');"]
        for k, call in enumerate(calls):
            f, inputs = call.function, {}
            for a in call.inputs:
                inputs[a.name] = f"{a.name}_{k}"
                data[inputs[a.name]] = columns(call.given[a.name], a)
            names = [a.name for a in f.required] + ["p"] * f.needs_model
            names += [a.name for a in f.optional]
            taken = ", ".join("[]" if n == "p" else inputs.get(n, "[]") for n in names)
            results = ", ".join([*(f"out_{k}_{j}" for j in range(len(f.outputs))), f"status_{k}"])
            lines.append(f"[{results}] = {manipulator.name}.{f.name}({taken});")
        scipy.io.savemat(folder / "in.mat", data)
        run("\n".join([*lines, f"save('-v6', '{folder / 'out.mat'}');"]), path)
        found = scipy.io.loadmat(folder / "out.mat")
    return [
        ([_states_first(found[f"out_{k}_{j}"], o) for j, o in enumerate(call.function.outputs)],
         found[f"status_{k}"][0])
        for k, call in enumerate(calls)
    ]  # fmt: skip


def _states_first(array: Array, output: Argument) -> Array:
    moved = np.moveaxis(array, -1, 0)
    return moved if output.value.shape else moved[:, 0]


def hostile(m: Any, good: dict[str, Array]) -> dict[str, Array]:
    """Good states, followed by some that are impossible or close to it."""
    X = good["X"][0]
    rng = np.random.default_rng(3)
    poses = [np.full_like(X, np.nan), np.full_like(X, np.inf), X + 1e3, X * 0.0]
    poses += [np.where(np.arange(len(X)) == k, np.nan, X) for k in (0, len(X) - 1)]
    poses += [X + rng.uniform(-1.0, 1.0, X.shape) for _ in range(6)]
    if m.NQ > m.NV:  # a quaternion whose square overflows
        at = good["t"].shape[-1]
        poses.append(np.concatenate((X[:at], 1e200 * X[at : at + 4], X[at + 4 :])))
    n = len(poses)
    found = {}
    for name, array in good.items():
        if name == "weights":
            found[name] = np.tile(array, (len(good["X"]) + n, 1))
            continue
        more = np.repeat(array[:1], n, axis=0)
        if name not in ("X", "R"):
            more[-3:] += 1.0
            more[-4], more[-5] = np.nan, 1e300
        found[name] = np.concatenate((array, more))
    found["X"][len(good["X"]) :] = poses
    return found


def of_module(m: Any, call: Call) -> list[Array]:
    """Outputs of the NumPy module."""
    found = getattr(m, call.function.name)(**{a.name: call.given[a.name] for a in call.inputs})
    outputs = list(found) if isinstance(found, tuple) else [found]
    return outputs[: len(call.function.outputs)]  # statuses apart


def conforms(manipulator: Manipulator) -> None:
    """Every function at good and at impossible states: values, NaN, statuses."""
    m, run_ = models.module(manipulator), interpreter(manipulator)
    good = vectors(m, GOOD)
    if m.NC:  # where the loops close: with more to be met than can be, no pose meets the rest
        X = m.project(good["X"])
        q = m.inverse_kinematics(X)[:, list(m.ACTUATED)]
        good |= {"X": X, "q_actuated": q}
    given = hostile(m, good)
    functions = [f for f in models.bundle(manipulator).program.public if f.is_exported]
    calls = [
        Call(f, {a.name: given[a.name] for a in f.inputs if a.name in given}) for f in functions
    ]
    assert len(calls) >= 10
    for call, (found, status) in zip(calls, answers(manipulator, calls), strict=True):
        name = f"{manipulator.name} {call.function.name}"
        of_numpy = of_module(m, call)
        wanted = run_.call(call.function.name, **call.given).status
        np.testing.assert_array_equal(status, wanted, name)
        assert not status[:GOOD].any(), name
        assert len(found) == len(of_numpy), name
        bound = 1e-13 * condition(m, call.function.name, good)
        for a, b in zip(found, of_numpy, strict=True):
            np.testing.assert_array_equal(np.isnan(a), np.isnan(b), name)
            assert a.shape == b.shape, name
            pair = [spanned(v) for v in (a, b)] if call.function.name == "null_space" else [a, b]
            pair = finite_parts(*pair)
            near = [v[:GOOD] for v in pair]
            scale = np.max(np.abs(near[1]), initial=0.0) or 1.0
            assert np.max(np.abs(near[0] - near[1]), initial=0.0) <= bound * scale, name
            others = [np.nan_to_num(v[GOOD:]) for v in pair]
            own = tuple(range(1, a.ndim))
            sizes = np.max(np.abs(others[1]), axis=own, initial=1e-9)
            errors = np.max(np.abs(others[0] - others[1]), axis=own, initial=0.0)
            assert np.all(errors <= 1e-6 * sizes), name


def end_to_end(name: str, out: Path) -> None:
    """Written by the command line, checked, called in Octave, removed when no longer wanted."""
    done = pne_gen(name, "--target", "numpy,c,octave", "--out", out, real=True)
    assert done.returncode == 0, done.stderr
    folder = out / name
    assert {f"{name}.py", f"{name}.c", "octave"} <= {p.name for p in folder.iterdir()}
    assert pne_gen("check", name, "--out", out, real=True).returncode == 0
    script = f"[M, s] = {name}.M({name}.home_pose()); printf('%.17g ', M); assert(s, 0);"
    m = models.module(models.catalogue(name))
    found = np.array(run(script, folder / "octave").split(), dtype=float).reshape(m.NV, m.NV)
    np.testing.assert_allclose(found, m.M(m.HOME_X), rtol=0, atol=1e-13 * found.max())
    old = folder / f"octave/+{name}/+internal/run_old.m"
    old.write_text((old.parent / "run_M.m").read_text())
    assert pne_gen("check", name, "--out", out, real=True).returncode == 1
    assert pne_gen(name, "--out", out, real=True).returncode == 0
    assert not (folder / "octave").exists()
