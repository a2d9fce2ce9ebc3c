"""Calling the code of a folder, or our own text, in confined processes.

Answers are parsed strictly. What a foreign module answers is its own account: nothing
here takes it for more.
"""

from __future__ import annotations

import base64
import json
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from pne_sym.model.kinematics import Array
from pne_sym.review.c_driver import Asked, CCall, Key, driver_input, driver_text
from pne_sym.review.manifests import SIZES
from pne_sym.review.sandbox import Isolation, Limits, SandboxError, compiler, workplace

_MOST_CALLS = 10_000
_MOST_AXES = 8
_RUNNER = Path(__file__).with_name("runner.py")
_FLAGS = ("-std=c99", "-O0", "-w", "-ffp-contract=off", "-fno-diagnostics-color")


class ExecutionError(ValueError):
    """The code cannot be run, or its answer is not one; the message is one line for people."""


@dataclass(frozen=True)
class Answer:
    """What a module, of Python or C, answers, by its own account.

    Attributes:
        defaults: of the parameters, by name.
        constants: other exported values; numbers as arrays, else text. Of C the sizes NQ, NV,
            NU, NC, NW, NJ, and home: HOME_X, then HOME_Q.
        states: per set the states that it was asked to make consistent.
        calls: per set what every call returned; of C its status too.
        errors: calls that failed, with the reason.
    """

    defaults: dict[str, Array] = field(default_factory=dict)
    constants: dict[str, Array | str] = field(default_factory=dict)
    states: list[dict[str, Array]] = field(default_factory=list)
    calls: list[dict[Key, list[Array]]] = field(default_factory=list)
    errors: dict[tuple[str, tuple[str, ...]], str] = field(default_factory=dict)


def execute(
    label: str,
    model: str,
    files: Mapping[str, bytes],
    request: Mapping[str, Any],
    isolation: Isolation | None,
) -> Answer:
    """Import a package and call all of its functions.

    Args:
        label: what to call it in messages.
        model: its name.
        files: of the package.
        request: `defaults`, names of parameters; `sets`, as `runner.py` reads them.
        isolation: None for the best that works here.

    Raises:
        ExecutionError: it fails, meets a limit, or does not answer as it should.
    """
    try:
        with workplace(isolation) as place:
            asked = {**request, "model": model, "folder": f"{place.given}/package"}
            own = {"request.json": json.dumps(asked).encode(), "runner.py": _RUNNER.read_bytes()}
            place.put({f"package/{model}/{name}": text for name, text in files.items()} | own)
            command = [sys.executable, "-I", f"{place.given}/runner.py"]
            said = place.run([*command, f"{place.given}/request.json"], Limits())
    except SandboxError as error:
        raise ExecutionError(f"{label}: its NumPy module cannot be run: {error}") from error
    try:
        return _parsed(said, request)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise ExecutionError(
            f"{label}: its NumPy module answers with something else than values"
        ) from error


def _unpacked(value: Any) -> Array:
    """An array from JSON; ValueError where it is anything else."""
    if not isinstance(value, dict) or value.keys() != {"shape", "data"}:
        raise ValueError("not an array")
    shape = value["shape"]
    if not isinstance(shape, list) or len(shape) > _MOST_AXES:
        raise ValueError("not a shape")
    if not all(isinstance(n, int) and not isinstance(n, bool) and 0 <= n < 10**6 for n in shape):
        raise ValueError("not a shape")
    if not isinstance(value["data"], str):
        raise ValueError("not data")
    data = base64.b64decode(value["data"], validate=True)
    if len(data) != 8 * math.prod(shape):
        raise ValueError("data of another size")
    return np.frombuffer(data, dtype="<f8").reshape(shape).astype(np.float64)


def _parsed(said: bytes, request: Mapping[str, Any]) -> Answer:
    """The answer, every part checked."""
    told = json.loads(said)
    if not isinstance(told, dict) or told.keys() != {"defaults", "constants", "sets"}:
        raise ValueError("not an answer")
    if list(told["defaults"]) != list(request["defaults"]):
        raise ValueError("defaults of other parameters")
    found = Answer(
        {name: _unpacked(v) for name, v in told["defaults"].items()},
        {_text(name): _constant(v) for name, v in told["constants"].items()},
    )
    if not isinstance(told["sets"], list) or len(told["sets"]) != len(request["sets"]):
        raise ValueError("another number of sets")
    for each in told["sets"]:
        if not isinstance(each, dict) or not isinstance(each["calls"], list):
            raise ValueError("no set")
        found.states.append({_text(n): _unpacked(v) for n, v in each["values"].items()})
        found.calls.append(_calls(each["calls"], found.errors))
    return found


def _calls(
    calls: Sequence[Any], errors: dict[tuple[str, tuple[str, ...]], str]
) -> dict[Key, list[Array]]:
    if len(calls) > _MOST_CALLS:
        raise ValueError("too many calls")
    found: dict[Key, list[Array]] = {}
    for call in calls:
        function, given = _text(call["function"]), tuple(_text(n) for n in call["given"])
        if "error" in call:
            errors.setdefault((function, given), _text(call["error"]))
            continue
        for mode in ("batch", "single"):
            if not isinstance(call[mode], list):
                raise ValueError("no values")
            found[function, given, mode] = [_unpacked(v) for v in call[mode]]
    return found


def _constant(value: Any) -> Array | str:
    if isinstance(value, dict) and value.keys() == {"text"}:
        return _text(value["text"])
    return _unpacked(value)


def _text(value: Any) -> str:
    """A short text that can be shown."""
    if not isinstance(value, str):
        raise TypeError("not a text")
    return "".join(c if c.isprintable() else "?" for c in value[:300])


def execute_c(
    label: str,
    files: Mapping[str, bytes],
    manifest: Mapping[str, Any],
    asked: Asked,
    isolation: Isolation | None,
) -> Answer:
    """Compile a C module with a program that calls all of its functions, and run that.

    Args:
        label: what to call it in messages.
        files: header and source, among others.
        manifest: with the model's name, sizes and parameters.
        asked: calls, parameters and values.
        isolation: None for the best that works here.

    Raises:
        ExecutionError: there is no compiler, or it fails, meets a limit, or does not
            answer as it should.
    """
    cc, name = compiler(), manifest["name"]
    if cc is None:
        raise ExecutionError(f"{label}: its C cannot be compiled: no cc, gcc or clang in /usr/bin")
    sources = {n: files.get(n, b"") for n in (f"{name}.h", f"{name}.c")}
    program = {"driver.c": driver_text(manifest, asked).encode()}
    program["input"] = driver_input(manifest, asked)
    try:
        with workplace(isolation) as place:
            place.put(sources | program)
            texts = [f"{place.given}/{n}" for n in ("driver.c", f"{name}.c")]
            made = f"{place.made}/driver"
            command = [cc, *_FLAGS, f"-I{place.given}", *texts, "-o", made, "-lm"]
            place.run(command, Limits(processes=True), writes=True)
            said = place.run([made, f"{place.given}/input"], Limits())
    except SandboxError as error:
        raise ExecutionError(f"{label}: its C cannot be compiled or run: {error}") from error
    try:
        return _parsed_c(said, manifest, asked)
    except ValueError as error:
        raise ExecutionError(f"{label}: its C answers with something else: {error}") from error


def _parsed_c(said: bytes, manifest: Mapping[str, Any], asked: Asked) -> Answer:
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

    def returned(c: CCall) -> list[Array]:
        status = take(asked.states)
        return [*(take(asked.states, size) for _, size in c.outputs), status]

    own = manifest["sizes"]
    facts: dict[str, Array | str] = {"sizes": take(len(SIZES)), "home": take(own["NQ"] + own["NJ"])}
    defaults = {p["name"]: take(*p["shape"]) for p in manifest["parameters"]}
    found: list[dict[Key, list[Array]]] = []
    for _ in asked.sets:
        values: dict[Key, list[Array]] = {
            ("prepare", (), "single"): [np.repeat(take(1), asked.states)]
        }
        for c in asked.calls:
            values[c.function, c.given, "single"] = returned(c)
            failed = np.repeat(take(1), asked.states)
            values[c.function, c.given, "batch"] = [*returned(c), failed]
        found.append(values)
    if len(rest):
        raise ValueError("too long")
    return Answer(defaults, facts, calls=found)
