"""Runs one generated NumPy package in a process of its own: request file in, JSON out.

The parent (`execution.py`) starts it confined. It imports nothing of pne_sym. What
is called is what the package exports: every function of `__all__`, with the values
that the request has for its arguments by name, without the optional ones, with
each of them, and with all; states one by one and as a batch.
"""

from __future__ import annotations

import base64
import importlib
import inspect
import json
import os
import sys
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

_LONGEST = 300
_PARAMETERS = "p"


def main() -> None:
    """Answer the request in the file named on the command line."""
    with open(sys.argv[1], encoding="utf-8") as stream:  # noqa: PTH123 - little is imported
        request = json.load(stream)
    answer_to = os.dup(1)
    os.dup2(2, 1)  # what the module prints is no answer
    sys.path.insert(0, request["folder"])
    warnings.simplefilter("ignore")
    answer = answered(importlib.import_module(request["model"]), request)
    with os.fdopen(answer_to, "w") as stream:
        json.dump(answer, stream)


def answered(model: Any, request: dict[str, Any]) -> dict[str, Any]:
    """What a module answers to a request."""
    with np.errstate(all="ignore"):
        return {
            "defaults": {n: packed(getattr(model.Parameters(), n)) for n in request["defaults"]},
            "constants": dict(_constants(model)),
            "sets": [_run(model, each) for each in request["sets"]],
        }


def _run(model: Any, each: dict[str, Any]) -> dict[str, Any]:
    """The states used, made to meet the constraints where asked, and all functions there."""
    p = None if each["parameters"] is None else model.Parameters(**each["parameters"])
    values = {n: _unpacked(v) for n, v in each["values"].items()}
    only, made = each.get("only"), {}
    if each["consistent"]:
        if hasattr(model, "Hk") and each["consistent"] != "q":
            _onto_the_manifold(model, values, p)
        values["q"] = model.inverse_kinematics(values["X"], p=p)
        made = {n: packed(v) for n, v in values.items()}
        if only is None:
            return {"values": made, "calls": []}
    shared = set(each["shared"])
    return {"values": made, "calls": [*_calls(model, values, shared, p, only)]}


def _constants(model: Any) -> Iterator[tuple[str, Any]]:
    """What the package exports besides functions and classes."""
    for name in model.__all__:
        member = getattr(model, name)
        if not callable(member):
            try:
                yield name, packed(np.asarray(member, dtype=float))
            except (TypeError, ValueError):
                yield name, {"text": repr(member)[:_LONGEST]}


def _calls(
    model: Any, values: dict[str, Any], shared: set[str], p: Any, only: list[str] | None
) -> Iterator[Any]:
    """Every call of every exported function, or of some without options, and what it returns."""
    for name in model.__all__:
        if only is not None and name not in only:
            continue
        function = getattr(model, name)
        if inspect.isclass(function) or not callable(function):
            continue
        needed: list[str] = []
        offered: list[str] = []
        for parameter in inspect.signature(function).parameters.values():
            if parameter.name != _PARAMETERS:
                free = parameter.default is not parameter.empty
                (offered if free else needed).append(parameter.name)
        for given in _choices(offered) if only is None else [[]]:
            yield {"function": name, "given": given, **_call(function, [*needed, *given], values,
                                                             shared, p)}  # fmt: skip


def _choices(offered: list[str]) -> list[list[str]]:
    """None of the optional arguments, each of them, all of them."""
    found = [[], *([n] for n in offered)]
    return [*found, offered] if len(offered) > 1 else found


def _call(
    function: Any, names: list[str], values: dict[str, Any], shared: set[str], p: Any
) -> dict[str, Any]:
    """What a function returns for a batch of states, and for them one by one."""
    unknown = [n for n in names if n not in values]
    if unknown:
        return {"error": f"no value is known for its argument {unknown[0]}"}
    more = {_PARAMETERS: p} if _PARAMETERS in inspect.signature(function).parameters else {}
    arguments = {n: values[n] for n in names}
    arguments |= {n: values[w] for n in names for o in names if (w := f"{n} with {o}") in values}
    count = len(values["X"])
    try:
        batch = _tuple(function(**arguments, **more))
        rows = [
            _tuple(
                function(**{n: v if n in shared else v[k] for n, v in arguments.items()}, **more)
            )
            for k in range(count)
        ]
        single = [np.stack([np.asarray(v) for v in each]) for each in zip(*rows, strict=True)]
        return {"batch": [packed(v) for v in batch], "single": [packed(v) for v in single]}
    except Exception as error:  # noqa: BLE001 - whatever it is, the parent is told
        return {"error": f"{type(error).__name__}: {error}"[:_LONGEST]}


def _tuple(value: Any) -> tuple[Any, ...]:
    return value if isinstance(value, tuple) else (value,)


def packed(value: Any) -> dict[str, Any]:
    """An array as JSON."""
    array = np.ascontiguousarray(value, dtype="<f8")
    shape = np.shape(value)
    return {"shape": list(shape), "data": base64.b64encode(array.tobytes()).decode()}


def _unpacked(value: dict[str, Any]) -> Any:
    data = base64.b64decode(value["data"])
    return np.frombuffer(data, dtype="<f8").reshape(value["shape"]).copy()


def _onto_the_manifold(model: Any, state: dict[str, Any], p: Any) -> None:
    """Pose, velocity and acceleration that the constraints allow."""
    state["X"] = X = model.project(state["X"], p=p)
    rows = np.swapaxes(model.Hk(X, p=p), -1, -2)
    for name in ("V", "A"):
        gap = (rows @ state[name][..., None])[..., 0]
        if name == "A":
            gap = gap + model.constraint_bias(X, state["V"], p=p)
        good = np.isfinite(rows).all(axis=(-1, -2)) & np.isfinite(gap).all(axis=-1)
        step = np.linalg.pinv(np.where(good[..., None, None], rows, 0.0)) @ gap[..., None]
        state[name] = np.where(good[..., None], state[name] - step[..., 0], np.nan)


if __name__ == "__main__":
    main()
