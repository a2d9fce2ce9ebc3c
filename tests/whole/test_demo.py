"""`bench/demo.py`, which `make demo` runs."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from tests.backends.ext_module import CACHE, QUICK, placed
from tests.models import catalogue

DEMO = Path(__file__).parents[2] / "bench" / "demo.py"


def demonstrated(folder: Path, **environment: str) -> str:
    """What it prints."""
    return subprocess.run(
        [sys.executable, DEMO, folder],
        env=os.environ | QUICK | environment,
        capture_output=True,
        check=True,
        text=True,
    ).stdout


def test_it_shows_that_numpy_and_c_agree(tmp_path: Path) -> None:
    CACHE.mkdir(mode=0o700, parents=True, exist_ok=True)
    placed(tmp_path, catalogue("stewart"))
    found = re.search(r"largest relative difference (\S+)", demonstrated(tmp_path))
    assert found is not None
    assert float(found[1]) < 1e-12


def test_it_goes_on_without_a_compiler(tmp_path: Path) -> None:
    placed(tmp_path, catalogue("stewart"))
    shown = demonstrated(tmp_path, CC="nowhere-cc", PNE_SYM_CACHE=str(tmp_path / "cache"))
    assert "C: NOT RUN, stewart_ext: no C compiler: CC=nowhere-cc is not found" in shown
    assert "Read the derivation in generated/stewart/stewart.md" in shown
