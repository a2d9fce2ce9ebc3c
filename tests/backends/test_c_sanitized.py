"""Every public function of the generated C under the address and undefined-behaviour sanitizers.

Arrays have the documented sizes exactly; the outputs of one state are also taken for a batch with
a remainder, and for a state that is impossible.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_public import CFunction, c_functions
from tests import models
from tests.backends.c_library import QUICK, find_compiler, quick_compiler, run, write_sources
from tests.sampling import sampled

FLAGS = ("-std=c99", *QUICK, "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
STATES = 9  # a lane of 8 states, and a remainder
HEAD = """#include "{name}.h"
#include <math.h>
#include <stdio.h>

enum {{ STATES = {states} }};
typedef {name}_real real;
static {name}_model model;

/* Poses near home; numbers between -1 and 1 elsewhere. */
static void fill(real *x, size_t size, const real *near)
{{
    for (size_t k = 0; k < STATES; ++k) {{
        for (size_t e = 0; e < size; ++e) {{
            const real part = (real)((7*k + 3*e)%11)/11 - (real)0.5;
            x[size*k + e] = near ? near[e] + (real)0.02*part : (real)1.5 + part;
        }}
    }}
}}
"""


def caller(bundle: Bundle, api: CFunction) -> str:
    """A C function that calls a public function in all its ways and counts the failures."""
    name, model = bundle.name, ["&model"] * api.has_model
    arrays = (*api.inputs, *api.outputs)
    lines = [f"static void call_{api.name}(void)", "{"]
    for a in arrays:
        lines.append(f"    static real in_{a.name}[STATES*{a.size}];")
    lines.append("    int status[STATES];")
    home = dict.fromkeys(("X", "X0", "X1"), f"{name}_HOME_X") | {"q0": f"{name}_HOME_Q"}
    for a in api.inputs:
        lines.append(f"    fill(in_{a.name}, {a.size}, {home.get(a.name, 'NULL')});")
    given = [f"in_{a.name}" for a in arrays]
    none = ["NULL" if a in api.inputs and a.optional and a.size else f"in_{a.name}" for a in arrays]
    for chosen in (given, none):
        single = ", ".join([*model, *chosen])
        lines.append(f'    printf("{api.name} %d\\n", {name}_{api.name}({single}));')
        batch = ", ".join([*model, "STATES", *chosen])
        for report in ("status", "NULL"):
            lines.append(f"    (void){name}_{api.name}_batch({batch}, {report});")
    lines.append("    for (size_t k = 0; k < STATES; ++k) {")
    first = api.inputs[0]
    lines.append(f"        in_{first.name}[{first.size}*k] = k%2 ? (real)NAN : (real)1e6;")
    lines.append("    }")
    batch = ", ".join([*model, "STATES", *given, "status"])
    lines.append(f"    (void){name}_{api.name}_batch({batch});")
    return "\n".join([*lines, "}", ""])


@pytest.mark.parametrize(
    "which", sampled(["tripod_3rps", "fivebar_redundant", "point_4rrr_redundant"], 2)
)
def test_sanitized(which: str, tmp_path: Path) -> None:
    """Constrained, redundantly actuated; iterated with extra coordinates and redundant."""
    manipulator = (models.catalogue if which in manipulators.names() else models.drawn)(which)
    bundle = models.bundle(manipulator)
    table = c_functions(bundle)
    source, program = write_sources(bundle, tmp_path), tmp_path / "program"
    calls = [f"    call_{a.name}();" for a in table]
    prepared = f"    const int code = {bundle.name}_prepare(&{bundle.name}_default_params, &model);"
    text = [
        HEAD.format(name=bundle.name, states=STATES),
        *(caller(bundle, a) for a in table),
        "\n".join(["int main(void)", "{", prepared, *calls, "    return code;", "}", ""]),
    ]
    main = tmp_path / "main.c"
    main.write_text("\n".join(text), encoding="utf-8")
    run(
        find_compiler(quick_compiler()), *FLAGS, f"-I{tmp_path}", main, source, "-o", program, "-lm"
    )
    printed = run("sh", "-c", 'ulimit -d unlimited && exec "$0"', program).split()
    names = [a.name for a in table for _ in range(2)]
    assert printed[::2] == names
    codes = dict(zip(names, printed[1::2], strict=True))
    assert codes["M"] == codes["inverse_dynamics"] == codes["inverse_kinematics"] == "0"
