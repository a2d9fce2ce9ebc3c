"""Options under which compilers drop the checks of what is not finite: refused by the source."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests import models
from tests.backends.c_library import find_compiler, write_sources

REFUSED = ("-ffast-math", "-Ofast", "-ffinite-math-only")
ALLOWED = ("-O3", "-fno-math-errno", "-fno-trapping-math", "-ffast-math -fno-fast-math")
KNOWN = "-DPLANAR_3RPR_ALLOW_FAST_MATH"


def compiled(compiler: str, source: Path, *options: str) -> subprocess.CompletedProcess[str]:
    """The compiler's verdict on the source's text and meaning."""
    command = [find_compiler(compiler), "-std=c99", "-fsyntax-only", *options, str(source)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_fast_math_is_refused(compiler: str, tmp_path: Path) -> None:
    source = write_sources(models.bundle(models.catalogue("planar_3rpr")), tmp_path)
    for option in REFUSED:
        done = compiled(compiler, source, option)
        assert done.returncode != 0
        assert "define PLANAR_3RPR_ALLOW_FAST_MATH" in done.stderr
        assert compiled(compiler, source, option, KNOWN).returncode == 0
    for options in ALLOWED:
        assert compiled(compiler, source, *options.split()).returncode == 0
