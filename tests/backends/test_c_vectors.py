"""Vectors in the machine code of the C: how long they are, by compiler."""

from __future__ import annotations

import platform
import re
import subprocess
from pathlib import Path

import pytest

from tests import models
from tests.backends.c_library import find_compiler, write_sources

AVX512 = "-O2 -march=skylake-avx512 -fno-math-errno -Rpass=loop-vectorize -w -c -o /dev/null"
GCC = "-O3 -march=skylake-avx512 -mprefer-vector-width=512 -fno-math-errno -w -S -o -"
LOOP = re.compile(r"for \(size_t k = 0; k < LANES; \+\+k\) \{\n +\w+_(legs_rrr|after)\(")


ON_X86 = pytest.mark.skipif(
    platform.machine() != "x86_64", reason="vectors of AVX-512 are asked for"
)


def part(name: str, folder: Path, *used: str) -> Path:
    """What runs M, Z and H and what it needs, without the functions after it."""
    text = write_sources(models.bundle(models.catalogue(name)), folder).read_text()
    text = text.split("/* ---- M ---- */")[0]
    text += "".join(f"void *const {f}_used = (void *){f};\n" for f in used)
    source = folder / "part.c"
    source.write_text(text)
    return source


def run(compiler: str, flags: str, source: Path) -> subprocess.CompletedProcess[str]:
    command = [find_compiler(compiler), *flags.split(), "-I", str(source.parent), str(source)]
    return subprocess.run(command, capture_output=True, text=True, check=True)


@ON_X86
def test_clang_takes_whole_vectors(tmp_path: Path) -> None:
    """As told by its own remarks."""
    source = part("fivebar_revolute", tmp_path, "dynamics_run_lanes")
    text, done = source.read_text(), run("clang", AVX512, source)
    pattern = r"part\.c:(\d+):.*vectorized loop \(vectorization width: (\d+)"
    widths = {int(line): int(width) for line, width in re.findall(pattern, done.stderr)}
    begin = text.index("void dynamics_run_lanes")
    loops = [text.count("\n", 0, m.start()) + 1 for m in LOOP.finditer(text, begin)]
    assert len(loops) == 2
    assert {line: widths.get(line) for line in loops} == dict.fromkeys(loops, 8)


@ON_X86
def test_gcc_keeps_to_short_vectors_where_legs_are_few(tmp_path: Path) -> None:
    """One state of three legs has no vector of 64 bytes, which would make all others slow."""
    runs = ("dynamics_run", "dynamics_run_lanes")
    code = run("gcc", GCC, part("planar_3rpr", tmp_path, *runs)).stdout
    one, lanes = (code.split(f"\n{name}:\n")[1].split("\t.cfi_endproc")[0] for name in runs)
    assert "%ymm" in one
    assert "%zmm" not in one
    assert "%zmm" in lanes


@ON_X86
def test_gcc_makes_vectors_around_calls(tmp_path: Path) -> None:
    """Legs with sines and cosines call these for eight legs, or states, at once."""
    runs = ("dynamics_run", "dynamics_run_lanes")
    code = run("gcc", GCC, part("stewart_sps", tmp_path, *runs)).stdout
    for name in runs:
        own = code.split(f"\n{name}:\n")[1].split("\t.cfi_endproc")[0]
        assert {"_ZGVeN8v_sine", "_ZGVeN8v_cosine"} <= set(re.findall(r"call\s+(\w+)", own))
