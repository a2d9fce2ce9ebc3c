"""A C program that calls every public function of a generated module: its text, input and output.

The functions and their arguments are those of the manifest; numbers go in and
come out as doubles, so that nothing of the module's text has to be understood.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Key = tuple[str, tuple[str, ...], str]
"""A call: function, optional arguments given, "single" or "batch"."""
_SIZES = ("NQ", "NV", "NU", "NC", "NW", "NJ")
_HEAD = """\
#include "{name}.h"
#include <stdio.h>
#include <stdlib.h>

typedef {name}_real real;
static {name}_model model;
static {name}_params params;
static FILE *input;

static void get(real *to, size_t count)
{{
    double value;
    size_t k;
    for (k = 0; k < count; k++) {{
        if (fread(&value, sizeof value, 1, input) != 1)
            exit(3);
        to[k] = (real)value;
    }}
}}

static void put(const real *from, size_t count)
{{
    size_t k;
    for (k = 0; k < count; k++) {{
        double value = (double)from[k];
        if (fwrite(&value, sizeof value, 1, stdout) != 1)
            exit(4);
    }}
}}

static void put_one(double value)
{{
    if (fwrite(&value, sizeof value, 1, stdout) != 1)
        exit(4);
}}

static void forget(real *to, size_t count)
{{
    size_t k;
    for (k = 0; k < count; k++)
        to[k] = (real)77;
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


def c_calls(functions: Mapping[str, Any]) -> tuple[CCall, ...]:
    """Every function of a manifest: without optional arguments, with each, with all."""
    found = []
    for name, f in functions.items():
        optional = tuple(n for n in f["optional"] if f["inputs"].get(n))
        choices = [(), *((n,) for n in optional), *([optional] if len(optional) > 1 else [])]
        inputs, outputs = tuple(f["inputs"].items()), tuple(f["outputs"].items())
        found += [CCall(name, given, inputs, outputs, f["model"], optional) for given in choices]
    return tuple(found)


def driver_text(
    name: str, parameters: Sequence[Mapping[str, Any]], calls: Sequence[CCall], states: int
) -> str:
    """The program.

    Args:
        name: of the model.
        parameters: entries of the manifest.
        calls: what to call.
        states: how many there are in every set.
    """
    lines = [_HEAD.format(name=name), *_parameter_functions(parameters)]
    for k, call in enumerate(calls):
        lines += _call_function(k, name, call, states)
    lines += ["int main(int count, char **words)", "{", "    double sets, own;"]
    lines += ['    if (count != 2 || !(input = fopen(words[1], "rb")))', "        return 3;"]
    lines += [f"    put_one((double){name.upper()}_{size});" for size in _SIZES]
    lines += [
        f"    put({name}_HOME_X, {name.upper()}_NQ);",
        f"    put({name}_HOME_Q, {name.upper()}_NJ);",
        f"    params = {name}_default_params;",
        "    put_params();",
        "    if (fread(&sets, sizeof sets, 1, input) != 1)",
        "        return 3;",
        "    for (; sets > 0.5; sets -= 1.0) {",
        "        if (fread(&own, sizeof own, 1, input) != 1)",
        "            return 3;",
        f"        params = {name}_default_params;",
        "        if (own > 0.5)",
        "            get_params();",
        f"        put_one((double){name}_prepare(&params, &model));",
        *(f"        call_{k}();" for k in range(len(calls))),
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


def _call_function(k: int, name: str, c: CCall, states: int) -> Iterator[str]:
    """States one by one with their status, then all at once with theirs."""
    taken = [(n, size) for n, size in c.inputs if n in c.given or n not in c.optional]
    yield f"static void call_{k}(void)"
    yield "{"
    for n, size in taken:
        yield f"    static real in_{n}[{max(1, states * size)}];"
    for n, size in c.outputs:
        yield f"    static real out_{n}[{max(1, states * size)}];"
    yield f"    static int status[{states}];"
    yield "    size_t k;"
    yield from (f"    get(in_{n}, {states * size});" for n, size in taken)
    yield f"    for (k = 0; k < {states}; k++) {{"
    yield from (f"        forget(out_{n} + k * {size}, {size});" for n, size in c.outputs)
    arguments = ["&model"] * c.model + _arguments(c, " + k * {size}")
    yield f"        put_one((double){name}_{c.function}({', '.join(arguments)}));"
    yield from (f"        put(out_{n} + k * {size}, {size});" for n, size in c.outputs)
    yield "    }"
    yield from (f"    forget(out_{n}, {states * size});" for n, size in c.outputs)
    arguments = ["&model"] * c.model + [str(states), *_arguments(c, ""), "status"]
    yield f"    put_one((double){name}_{c.function}_batch({', '.join(arguments)}));"
    yield f"    for (k = 0; k < {states}; k++)"
    yield "        put_one((double)status[k]);"
    yield from (f"    put(out_{n}, {states * size});" for n, size in c.outputs)
    yield "}"
    yield ""


def _arguments(c: CCall, step: str) -> list[str]:
    given = [
        f"in_{n}{step.format(size=size)}" if n in c.given or n not in c.optional else "NULL"
        for n, size in c.inputs
    ]
    return given + [f"out_{n}{step.format(size=size)}" for n, size in c.outputs]


def driver_input(
    parameters: Sequence[Mapping[str, Any]],
    calls: Sequence[CCall],
    sets: Sequence[tuple[Mapping[str, Any] | None, Mapping[str, Array]]],
) -> bytes:
    """What the program reads: per set the parameters (None: defaults) and values of arguments.

    Raises:
        KeyError: an argument has no value.
    """
    parts: list[Any] = [len(sets)]
    for values, arguments in sets:
        parts.append(values is not None)
        if values is not None:
            parts += [np.ravel(np.asarray(values[p["name"]], dtype=float)) for p in parameters]
        for c in calls:
            parts += [
                np.ravel(arguments[n]) for n, _ in c.inputs if n in c.given or n not in c.optional
            ]
    return np.concatenate([np.atleast_1d(np.asarray(x, dtype="<f8")) for x in parts]).tobytes()


@dataclass(frozen=True)
class CAnswer:
    """What the program says.

    Attributes:
        sizes: NQ, NV, NU, NC, NW, NJ of the header.
        home: HOME_X, then HOME_Q.
        defaults: of the parameters, by name.
        calls: per set; outputs of every call, then the status.
    """

    sizes: Array
    home: Array
    defaults: dict[str, Array]
    calls: list[dict[Key, list[Array]]]


def parsed(
    said: bytes,
    manifest: Mapping[str, Any],
    calls: Sequence[CCall],
    sets: int,
    states: int,
) -> CAnswer:
    """The program's output taken apart.

    Raises:
        ValueError: it is longer or shorter than it should be.
    """
    if len(said) % 8:
        raise ValueError("not doubles")
    rest = np.frombuffer(said, dtype="<f8").astype(np.float64)

    def take(*shape: int) -> Array:
        nonlocal rest
        count = math.prod(shape)
        if len(rest) < count:
            raise ValueError("too short")
        part, rest = rest[:count], rest[count:]
        return part.reshape(shape)

    sizes = take(len(_SIZES))
    home = take(manifest["sizes"]["NQ"] + manifest["sizes"]["NJ"])
    defaults = {p["name"]: take(*p["shape"]) for p in manifest["parameters"]}
    found: list[dict[Key, list[Array]]] = []
    for _ in range(sets):
        prepared = take(1)
        values: dict[Key, list[Array]] = {("prepare", (), "single"): [np.repeat(prepared, states)]}
        for c in calls:
            outputs = [size for _, size in c.outputs]
            rows = take(states, 1 + sum(outputs))
            ends = np.cumsum([1, *outputs])
            single = [rows[:, a:b] for a, b in pairwise(ends)]
            values[c.function, c.given, "single"] = [*single, rows[:, 0]]
            failed, status = take(1), take(states)
            batch = [take(states, size) for size in outputs]
            values[c.function, c.given, "batch"] = [*batch, status, np.repeat(failed, states)]
        found.append(values)
    if len(rest):
        raise ValueError("too long")
    return CAnswer(sizes, home, defaults, found)
