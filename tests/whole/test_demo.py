"""`bench/demo.py`, which `make demo` runs: the model in C is as large as its compiler says."""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

from tests.backends.c_library import find_compiler

DEMO = Path(__file__).parents[2] / "bench" / "demo.py"


def test_the_model_has_the_size_that_the_compiler_tells(tmp_path: Path) -> None:
    compiler = find_compiler("gcc")
    spec = importlib.util.spec_from_file_location("demo", DEMO)
    assert spec is not None
    assert spec.loader is not None
    demo = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(demo)
    source = tmp_path / "size.c"
    source.write_text(
        '#include <stdio.h>\n#include "stewart.h"\n'
        'int main(void) { printf("%zu", sizeof(stewart_model)); return 0; }\n'
    )
    program = tmp_path / "size"
    subprocess.run([compiler, f"-I{demo.FOLDER}", source, "-o", program], check=True)
    size = int(subprocess.run([program], capture_output=True, check=True).stdout)
    library = demo.compiled(str(tmp_path))
    assert library is not None
    assert library.size_of_model() == size > 1000


def test_it_shows_that_numpy_and_c_agree() -> None:
    find_compiler("gcc")
    shown = subprocess.run(
        [sys.executable, DEMO], capture_output=True, check=True, text=True
    ).stdout
    found = re.search(r"largest relative difference (\S+)", shown)
    assert found is not None
    assert float(found[1]) < 1e-12
