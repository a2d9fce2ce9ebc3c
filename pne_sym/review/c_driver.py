"""A C program that calls every public function of a generated module: its text, input and output.

The functions and their arguments are those of the manifest; numbers go in and
come out as doubles, so that nothing of the module's text has to be understood.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pne_sym.model.kinematics import Array
from pne_sym.review.manifests import SIZES

Key = tuple[str, tuple[str, ...], str]
"""A call: function, optional arguments given, "single" or "batch"."""
_HEAD = """\
#include "{name}.h"
#include <stdio.h>
#include <stdlib.h>

typedef {name}_real real;
static {name}_model model;
static {name}_params params;
static FILE *input;

static double get_one(void)
{{
    double value;
    if (fread(&value, sizeof value, 1, input) != 1)
        exit(3);
    return value;
}}

static void put_one(double value)
{{
    if (fwrite(&value, sizeof value, 1, stdout) != 1)
        exit(4);
}}

static void get(real *to, size_t count)
{{
    for (; count; count--)
        *to++ = (real)get_one();
}}

static void put(const real *from, size_t count)
{{
    for (; count; count--)
        put_one((double)*from++);
}}

static void forget(real *to, size_t count)
{{
    for (; count; count--)
        *to++ = (real)77;
}}
"""


@dataclass(frozen=True)
class CCall:
    """A call of a public function.

    Attributes:
        function: its name, without prefix.
        given: optional arguments that are given; NULL stands for the others.
        inputs: names and entries of the arguments, in order.
        outputs: likewise.
        model: whether the prepared model is the first argument.
        optional: arguments that may be NULL.
    """

    function: str
    given: tuple[str, ...]
    inputs: tuple[tuple[str, int], ...]
    outputs: tuple[tuple[str, int], ...]
    model: bool
    optional: tuple[str, ...]

    @property
    def taken(self) -> list[tuple[str, int]]:
        """The inputs that have values."""
        return [(n, size) for n, size in self.inputs if n in self.given or n not in self.optional]


@dataclass(frozen=True)
class Asked:
    """What a C module is asked.

    Attributes:
        calls: of which functions.
        sets: parameters by name (None: defaults), and values of arguments.
        states: how many there are in every set.
    """

    calls: tuple[CCall, ...]
    sets: Sequence[tuple[Mapping[str, Any] | None, Mapping[str, Array]]]
    states: int


def c_calls(functions: Mapping[str, Any]) -> tuple[CCall, ...]:
    """Every function of a manifest: without optional arguments, with each, with all."""
    found = []
    for name, f in functions.items():
        optional = tuple(n for n in f["optional"] if f["inputs"].get(n))
        choices = [(), *((n,) for n in optional), *([optional] if len(optional) > 1 else [])]
        inputs, outputs = tuple(f["inputs"].items()), tuple(f["outputs"].items())
        found += [CCall(name, given, inputs, outputs, f["model"], optional) for given in choices]
    return tuple(found)


def driver_text(manifest: Mapping[str, Any], asked: Asked) -> str:
    """The program.

    Args:
        manifest: with the model's name and parameters.
        asked: what to call.
    """
    name, parameters = manifest["name"], manifest["parameters"]
    lines = [_HEAD.format(name=name), *_parameter_functions(parameters)]
    for k, call in enumerate(asked.calls):
        lines += _call_function(k, name, call, asked.states)
    lines += ["int main(int count, char **words)", "{", "    double sets;"]
    lines += ['    if (count != 2 || !(input = fopen(words[1], "rb")))', "        return 3;"]
    lines += [f"    put_one((double){name.upper()}_{size});" for size in SIZES]
    lines += [
        f"    put({name}_HOME_X, {name.upper()}_NQ);",
        f"    put({name}_HOME_Q, {name.upper()}_NJ);",
        f"    params = {name}_default_params;",
        "    put_params();",
        "    for (sets = get_one(); sets > 0.5; sets -= 1.0) {",
        f"        params = {name}_default_params;",
        "        if (get_one() > 0.5)",
        "            get_params();",
        f"        put_one((double){name}_prepare(&params, &model));",
        *(f"        call_{k}();" for k in range(len(asked.calls))),
        "    }",
        "    return fflush(stdout) ? 4 : 0;",
        "}",
        "",
    ]
    return "\n".join(lines)


def _parameter_functions(parameters: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    for what, access in (("get", "(real *)"), ("put", "(const real *)")):
        yield f"static void {what}_params(void)"
        yield "{"
        for p in parameters:
            field, size = f"params.{p['name']}", math.prod(p["shape"])
            yield f"    if (sizeof {field} != {size} * sizeof(real))"
            yield "        exit(5);"
            yield f"    {what}({access}&{field}, {size});"
        yield "}"
        yield ""


def _call_function(k: int, name: str, c: CCall, states: int) -> list[str]:
    """States one by one, then all at once: their status, and what is returned."""
    arrays = [(f"in_{n}", size) for n, size in c.taken] + [(f"out_{n}", s) for n, s in c.outputs]
    clear = [f"    forget(out_{n}, {states * size});" for n, size in c.outputs]
    tell = [f"    put(out_{n}, {states * size});" for n, size in c.outputs]
    model = ["&model"] * c.model
    single = ", ".join(model + _arguments(c, " + k * {size}"))
    batch = ", ".join([*model, str(states), *_arguments(c, ""), "status"])
    return [
        f"static void call_{k}(void)",
        "{",
        *(f"    static real {array}[{max(1, states * size)}];" for array, size in arrays),
        f"    static int status[{states}];",
        "    size_t k;",
        *(f"    get(in_{n}, {states * size});" for n, size in c.taken),
        *clear,
        f"    for (k = 0; k < {states}; k++)",
        f"        put_one((double){name}_{c.function}({single}));",
        *tell,
        *clear,
        f"    put_one((double){name}_{c.function}_batch({batch}));",
        f"    for (k = 0; k < {states}; k++)",
        "        put_one((double)status[k]);",
        *tell,
        "}",
        "",
    ]


def _arguments(c: CCall, step: str) -> list[str]:
    taken = dict(c.taken)
    given = [f"in_{n}{step.format(size=size)}" if n in taken else "NULL" for n, size in c.inputs]
    return given + [f"out_{n}{step.format(size=size)}" for n, size in c.outputs]


def driver_input(manifest: Mapping[str, Any], asked: Asked) -> bytes:
    """What the program reads: per set the parameters and values of arguments.

    Raises:
        KeyError: an argument has no value.
    """
    parts: list[Any] = [len(asked.sets)]
    for values, arguments in asked.sets:
        parts.append(values is not None)
        if values is not None:
            parts += [values[p["name"]] for p in manifest["parameters"]]
        parts += [arguments[n] for c in asked.calls for n, _ in c.taken]
    return np.concatenate([np.ravel(np.asarray(x, dtype="<f8")) for x in parts]).tobytes()
