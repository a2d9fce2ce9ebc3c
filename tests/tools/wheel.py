"""Build the sdist, the wheel from it, and use the wheel as a user would.

The wheel is installed into an empty environment and run from a folder outside
the repository; the model that it generates must be the one in `generated/`.
"""

from __future__ import annotations

import filecmp
import os
import subprocess
import sys
import tempfile
import venv
import zipfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
MODEL = "stewart"


def main() -> None:
    """Build, install, generate, compare."""
    with tempfile.TemporaryDirectory(prefix="pne-wheel-") as temporary:
        folder = Path(temporary)
        # Without options, build makes the sdist, and the wheel from the sdist.
        _run(sys.executable, "-m", "build", "--outdir", folder / "dist", REPOSITORY, cwd=folder)
        (wheel,) = (folder / "dist").glob("*.whl")
        _check_content(wheel)

        venv.create(folder / "env", with_pip=True)
        scripts = folder / "env" / ("Scripts" if os.name == "nt" else "bin")
        _run(scripts / "python", "-m", "pip", "install", "--quiet", wheel, cwd=folder)
        _run(scripts / "pne-gen", MODEL, "--out", folder / "generated", cwd=folder)
        _check_same(REPOSITORY / "generated" / MODEL, folder / "generated" / MODEL)
        print("the wheel works outside the repository and writes what stands in generated/")


def _check_content(wheel: Path) -> None:
    """Check that every template, catalogue file and module is in the wheel."""
    names = set(zipfile.ZipFile(wheel).namelist())
    expected = {
        f"pne_sym/{path.relative_to(REPOSITORY)}"
        for path in (REPOSITORY / "templates").rglob("*")
        if path.is_file()
    } | {
        str(path.relative_to(REPOSITORY))
        for path in (REPOSITORY / "pne_sym").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    if missing := sorted(expected - names):
        sys.exit(f"not in {wheel.name}: {', '.join(missing)}")


def _check_same(expected: Path, found: Path) -> None:
    compared = filecmp.dircmp(expected, found, ignore=["__pycache__"])
    _, differing, errors = filecmp.cmpfiles(expected, found, compared.common_files, shallow=False)
    if wrong := [*compared.left_only, *compared.right_only, *differing, *errors]:
        sys.exit(f"the installed wheel generates {expected.name} differently: {', '.join(wrong)}")


def _run(*command: str | Path, cwd: Path) -> None:
    print(*command, flush=True)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    subprocess.run([str(part) for part in command], cwd=cwd, env=environment, check=True)


if __name__ == "__main__":
    main()
