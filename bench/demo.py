"""The generated Stewart platform at work: forces along a motion, from NumPy and from compiled C.

Run by `make demo`, after `pne-gen stewart --out generated/`; the argument is a folder with
stewart_ext.py, of `pne-gen stewart --target ext`.
"""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path
from types import ModuleType

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


def extension(folder: Path) -> ModuleType | None:
    """The C as a Python module, compiled unless it has been; None where that cannot be."""
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module("stewart_ext")
    except ImportError as error:
        print(f"\nC: NOT RUN, {error}")
        return None


def main() -> None:
    """Print forces along the motion, their agreement, operation counts, where to read on."""
    t = np.linspace(0.0, 1.0, 6)
    X, V, A = motion(t)
    tau = stewart.inverse_dynamics(X, V, A)
    print("\nActuator forces [N] along a figure of eight (NumPy):")
    print("   t [s] " + "".join(f"   leg {k + 1}" for k in range(stewart.NU)))
    for instant, row in zip(t, tau, strict=True):
        print(f"  {instant:6.2f} " + "".join(f"{force:8.2f}" for force in row))
    compiled = extension(Path(sys.argv[1]))
    if compiled is not None:
        gap = np.max(np.abs(compiled.inverse_dynamics(X, V, A) - tau)) / np.max(np.abs(tau))
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
