"""States side by side run in whole vectors by clang too, as told by its own remarks."""

from __future__ import annotations

import platform
import re
import subprocess
from pathlib import Path

import pytest

from tests import models
from tests.backends.c_library import find_compiler, write_sources

AVX512 = "-O2 -march=skylake-avx512 -fno-math-errno -Rpass=loop-vectorize -w -c -o /dev/null"
LOOP = re.compile(r"for \(size_t k = 0; k < LANES; \+\+k\) \{\n +\w+_(legs_rrr|after)\(")


@pytest.mark.skipif(platform.machine() != "x86_64", reason="vectors of AVX-512 are asked for")
def test_clang_takes_whole_vectors(tmp_path: Path) -> None:
    text = write_sources(models.bundle(models.catalogue("fivebar_revolute")), tmp_path).read_text()
    # what runs M, Z and H and what it needs, without the functions after it
    text = text.split("/* ---- M ---- */")[0] + "void *const used = (void *)dynamics_run_lanes;\n"
    source = tmp_path / "part.c"
    source.write_text(text)
    command = [find_compiler("clang"), *AVX512.split(), "-I", str(tmp_path), str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    pattern = r"part\.c:(\d+):.*vectorized loop \(vectorization width: (\d+)"
    widths = {int(line): int(width) for line, width in re.findall(pattern, done.stderr)}
    begin = text.index("void dynamics_run_lanes")
    loops = [text.count("\n", 0, m.start()) + 1 for m in LOOP.finditer(text, begin)]
    assert len(loops) == 2
    assert {line: widths.get(line) for line in loops} == dict.fromkeys(loops, 8)
