"""The generated Stewart platform at work: forces along a motion, from NumPy and from compiled C.

Run by `make demo`, after `pne-gen stewart --out generated/`.
"""

from __future__ import annotations

import ctypes
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "generated" / "stewart"
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT))

from generated import stewart  # noqa: E402  (the folder is found from here)

Array = np.ndarray


def motion(t: Array) -> tuple[Array, Array, Array]:
    """Pose, velocity, acceleration along a figure of eight that also yaws; t (n,) in s."""
    w = 2 * np.pi
    x, y, z = 0.10 * np.sin(w * t), 0.05 * np.sin(2 * w * t), 0.75 + 0.03 * np.cos(w * t)
    yaw, zero = 0.2 * np.sin(w * t), np.zeros_like(t)
    X = stewart.pose_from_rpy(np.stack((x, y, z), -1), np.stack((zero, zero, yaw), -1))
    rate = np.stack(
        (
            0.10 * w * np.cos(w * t),
            0.10 * w * np.cos(2 * w * t),
            -0.03 * w * np.sin(w * t),
            zero,
            zero,
            0.2 * w * np.cos(w * t),
        ),
        -1,
    )
    acceleration = np.stack(
        (-w * w * x, -4 * w * w * y, -w * w * (z - 0.75), zero, zero, -w * w * yaw), -1
    )
    return X, rate, acceleration


SIZE = """\
#include "stewart.h"
size_t size_of_model(void);
size_t size_of_model(void) { return sizeof(stewart_model); }
"""


def compiled(folder: str) -> ctypes.CDLL | None:
    """The C module and the size of its model as a shared library, or None without a compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    library, size = Path(folder) / "stewart.so", Path(folder) / "size.c"
    size.write_text(SIZE, encoding="utf-8")
    subprocess.run(
        [
            compiler,
            "-std=c99",
            "-O3",
            "-fno-math-errno",
            "-shared",
            "-fPIC",
            f"-I{FOLDER}",
            str(FOLDER / "stewart.c"),
            str(size),
            "-o",
            str(library),
            "-lm",
        ],
        check=True,
    )
    found = ctypes.CDLL(str(library))
    found.size_of_model.restype = ctypes.c_size_t
    return found


def forces_from_c(library: ctypes.CDLL, X: Array, V: Array, A: Array) -> Array:
    """Actuator forces of every state from the compiled module."""
    pointer = ctypes.POINTER(ctypes.c_double)
    tau = np.empty((len(X), stewart.NU))
    model = ctypes.create_string_buffer(library.size_of_model())
    defaults = ctypes.byref(ctypes.c_char.in_dll(library, "stewart_default_params"))
    if library.stewart_prepare(defaults, model) != 0:
        raise RuntimeError("stewart_prepare refused the default parameters")
    for state in zip(X, V, A, tau, strict=True):
        x, v, a, out = (row.ctypes.data_as(pointer) for row in state)
        status = library.stewart_inverse_dynamics(model, x, v, a, None, out)
        if status != 0:
            raise RuntimeError(f"stewart_inverse_dynamics: status {status}")
    return tau


def main() -> None:
    """Print forces along the motion, their agreement, operation counts, where to read on."""
    t = np.linspace(0.0, 1.0, 6)
    X, V, A = motion(t)
    tau = stewart.inverse_dynamics(X, V, A)
    print("\nActuator forces [N] along a figure of eight (NumPy):")
    print("   t [s] " + "".join(f"   leg {k + 1}" for k in range(stewart.NU)))
    for instant, row in zip(t, tau, strict=True):
        print(f"  {instant:6.2f} " + "".join(f"{force:8.2f}" for force in row))
    with tempfile.TemporaryDirectory() as folder:
        library = compiled(folder)
        if library is None:
            print("\nC: NOT RUN, no C compiler found")
        else:
            X, V, A = (np.ascontiguousarray(v) for v in (X, V, A))
            gap = np.max(np.abs(forces_from_c(library, X, V, A) - tau)) / np.max(np.abs(tau))
            print(f"\nThe same from the compiled C: largest relative difference {gap:.1e}")
    manifest = json.loads((FOLDER / "stewart.json").read_text(encoding="utf-8"))
    print("\nOperations for one state (mul, add, div, sqrt), six legs, live parameters:")
    for name, what in (
        ("dynamics", "M, Z and H together"),
        ("required", "inverse dynamics up to the 6 x 6 solve"),
        ("inverse_kinematics", "all joint displacements"),
    ):
        n = manifest["operations"][name]
        parts = [n[k] for k in ("mul", "add", "div", "sqrt")]
        print(f"  {what:40s} {' + '.join(map(str, parts))} = {sum(parts)}")
    print("\nRead the derivation in generated/stewart/stewart.md")


if __name__ == "__main__":
    main()
