"""Every argument of every public function refuses complex numbers, in all targets that take any.

Array-API modules: tests/targets/test_xp.py.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked
from pne_sym.program.public import Argument, PublicFunction
from tests.backends.ext_module import ext_module
from tests.models import bundle, catalogue, module
from tests.octave.conformance import octave, run, write
from tests.targets.modules import vectors
from tests.whole.test_bounds import limited


@cache
def moving() -> Manipulator:
    """All arguments but q0 (test_arguments.py has it): bounds, redundancy, a base that moves."""
    return checked(replace(limited("planar_4rpr", 2, 5e3), moving_base=True))


def cases(spec: Manipulator) -> Iterator[tuple[PublicFunction, Argument, dict[str, Any]]]:
    """Functions and arguments, with values for all that they take."""
    given = {n: v[0] if n != "weights" else v for n, v in vectors(module(spec), 1).items()}
    given["length"] = np.array(0.5)
    for function in bundle(spec).program.public:
        if function.is_exported:
            values = {a.name: given[a.name] for a in function.inputs if a.value.size}
            yield from ((function, a, values) for a in function.inputs if a.value.size)


def named(spec: Manipulator) -> set[str]:
    return {a.name for _, a, _ in cases(spec)}


def complex_forms(argument: Argument, value: Any) -> list[Any]:
    """The numbers with and without imaginary parts, as arrays and in lists."""
    lists = [[*value.reshape(-1)[:-1].tolist(), 1j]] if value.ndim else [1j]
    return [value + 0j, value + 1j, *(lists if argument.name != "base" else [])]


def test_every_argument_is_looked_at() -> None:
    known = named(moving()) | named(catalogue("tripod_3prs"))
    assert known >= {"X", "V", "A", "tau", "wrench", "weights", "length", "base", "X0", "X1",
                     "q_actuated", "step", "s", "t", "R", "rpy", "direction", "tau_min", "tau_max",
                     "wrench_direction", "reference"}  # fmt: skip


@pytest.mark.parametrize("target", ["numpy", "ext"])
def test_of_modules(target: str) -> None:
    models = [(moving(), module(moving()))] if target == "numpy" else []
    prs = catalogue("tripod_3prs")
    models.append((prs, module(prs) if target == "numpy" else ext_module(prs)))
    for spec, m in models:
        for function, argument, values in cases(spec):
            for unfit in complex_forms(argument, values[argument.name]):
                told = rf"^{function.name}: {argument.name}: expected real numbers, got complex"
                with pytest.raises(TypeError, match=told):
                    getattr(m, function.name)(**{**values, argument.name: unfit})


@pytest.mark.skipif(octave() is None, reason="octave-cli is not installed")
def test_of_octave_packages(tmp_path: Path) -> None:
    spec, lines = moving(), ["told = {};"]
    for function, argument, values in cases(spec):
        names = [a.name for a in function.required] + ["p"] * function.needs_model
        names += [a.name for a in function.optional]
        texts = {n: f"reshape({v.reshape(-1, order='F').tolist()}, {[*v.shape, 1, 1]})"
                 for n, v in values.items()}  # fmt: skip
        texts[argument.name] += " + 1i"
        call = f"{spec.name}.{function.name}({', '.join(texts.get(n, '[]') for n in names)})"
        told = f"{argument.name}: expected real numbers"
        lines.append(f"try, {call}; printf('%s\\n', '{function.name} {argument.name}');")
        lines.append(f"catch e, assert(strncmp(e.message, '{told}', {len(told)})); end")
    assert len(lines) > 120
    assert run("\n".join(lines), write(spec, tmp_path)) == ""
