"""Names that are allowed, however odd, give code that compiles and imports."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import pne_sym
from pne_sym.model.reader import from_text
from pne_sym.starter import starter_text
from tests.sampling import sampled

# Words of the generated code's own: functions, classes, fields, sizes, locals, prefixes.
NAMES = [
    "m", "h", "x", "t", "p", "q", "out", "params", "model", "parameters", "real", "dynamics",
    "pose",
    "nq", "ok", "prepare", "batch", "rpr", "home", "platform_mass", "gravity", "self", "cls", "np",
    "generated", "std", "fp", "e", "int8", "status", "a" * 40, "r2", "x_1", "sizes",
]  # fmt: skip


@pytest.mark.parametrize("name", sampled(NAMES, 4))
def test_python_and_c(name: str, tmp_path: Path) -> None:
    manipulator = from_text(starter_text(name, "2-RPR", "point"), ".toml", name)
    pne_sym.generate(manipulator, tmp_path / "made_here")
    code = (
        f"import made_here.{name} as m, {name} as alone; X = m.NQ and [0.0, 0.0];"
        "assert (m.M(X) == alone.M(X)).all(); print(m.inverse_dynamics(X, X, X).shape)"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=tmp_path,
        env={"PYTHONPATH": f"{tmp_path}:{tmp_path / 'made_here' / name}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "(2,)\n", "")
    source = tmp_path / "made_here" / name / f"{name}.c"
    if not source.exists() or not (compiler := shutil.which("gcc")):
        pytest.skip("no C back end, or no gcc")
    user = tmp_path / "user.cpp"
    user.write_text(f'#include "{name}.h"\nint main() {{ return 0; }}\n')
    for file, standard in ((source, "-std=c99"), (user, "-std=c++17")):
        command = [compiler, standard, "-Wall", "-Wextra", "-Werror", "-fsyntax-only", str(file)]
        done = subprocess.run(
            [*command, "-I", str(source.parent)], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
