"""What the numbers were measured on: no names, no paths, no dates."""

from __future__ import annotations

import platform
import re
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from bench.c_programs import compilers

PACKAGES = ("numpy", "jax", "casadi", "pin", "mujoco")


def processor() -> str:
    """The model and its vectors."""
    told = Path("/proc/cpuinfo")
    if not told.exists():
        return platform.machine()
    text = told.read_text(encoding="utf-8")
    name = re.search(r"model name\s*: (.*)", text)
    number = re.search(r"model\s*: (\d+)", text)
    vectors = next((v for v in ("avx512f", "avx2", "avx", "neon") if v in text), "no vectors")
    words = " ".join(re.sub(r"\([A-Z]+\)", "", name[1]).split()) if name else platform.machine()
    return f"{words}{f' (model {number[1]})' if number else ''}, {vectors}"


def compiler_version(compiler: str) -> str:
    """Such as gcc 12.2.0."""
    said = subprocess.run(
        [compiler, "-dumpfullversion", "-dumpversion"], capture_output=True, text=True, check=True
    )
    return f"{compiler} {said.stdout.strip()}"


def description() -> dict[str, str]:
    """Of the machine and of what runs on it."""
    found = {"processor": processor(), "compilers": ", ".join(map(compiler_version, compilers()))}
    packages = [f"Python {platform.python_version()}"]
    for name in PACKAGES:
        try:
            packages.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            packages.append(f"{name}: not installed")
    return found | {"packages": ", ".join(packages)}
