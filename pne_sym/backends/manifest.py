"""The manifest back end: what a model consists of, for programs to read."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import asdict
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_public import CFunction, c_functions
from pne_sym.backends.registry import default
from pne_sym.derivation import ParameterField
from pne_sym.model.full_form import to_full_form
from pne_sym.program.count import count_block, count_expression
from pne_sym.program.ir import Counts, Function
from pne_sym.version import __version__

FORMAT = 2
"""1: without `functions` and `specification`."""


class ManifestBackend:
    """Emits NAME.json."""

    operations = None

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        return {f"{bundle.name}.json": _text(_manifest(bundle))}


def _manifest(bundle: Bundle) -> dict[str, Any]:
    c = bundle.coordinates
    return {
        "format": FORMAT,
        "generator": f"pne_sym {__version__}",
        **({"targets": bundle.targets} if bundle.targets != default() else {}),
        "name": bundle.name,
        "title": bundle.manipulator.title,
        "space": c.space,
        "sizes": c.sizes,
        "coordinates": {"X": c.pose, "V": c.rates, "wrench": c.wrench},
        "joints": c.joints,
        "actuators": c.actuators,
        "extra": c.extras,
        "constraints": c.constraints,
        "home": {"X": c.home[0], "q": c.home[1]},
        "leg_types": [_leg_type(bundle, t) for t in bundle.derivation.leg_types],
        "parameters": [_parameter(f) for f in bundle.derivation.parameters.fields],
        "operations": {
            name: _operations(f, bundle.leg_counts) for name, f in bundle.program.functions.items()
        },
        "functions": {f.name: _function(f) for f in c_functions(bundle)},
        "specification": to_full_form(bundle.manipulator),
        "digests": {"spec": spec_digest(bundle), "derivation": derivation_digest(bundle)},
    }


def _leg_type(bundle: Bundle, t: Any) -> dict[str, Any]:
    branches = {
        name: signs
        for name, (leg_type, signs) in bundle.derivation.parameters.branches.items()
        if leg_type == t.name
    }
    return {
        "name": t.name,
        "architecture": t.title,
        "legs": t.indices,
        "inverse_kinematics": t.methods,
        "no_closed_form": dict(t.reasons),
        "branches": branches,
    }


def _parameter(f: ParameterField) -> dict[str, Any]:
    path = re.sub(r"^legs\[\d+\]", "legs[i]", f.paths[0])
    legs = [int(found.group(1)) for p in f.paths if (found := re.match(r"legs\[(\d+)\]", p))]
    entry: dict[str, Any] = {
        "name": f.name,
        "unit": f.unit,
        "shape": f.default.shape,
        "meaning": f.meaning,
        "path": path,
    }
    if legs:
        entry["legs"] = legs
    if f.zeros:
        entry["zero_by_structure"] = f.zeros
    return entry


def _function(a: CFunction) -> dict[str, Any]:
    """A public function of the C module: entries of each argument, in order, per state."""
    return {
        "inputs": {i.name: i.size for i in a.inputs},
        "optional": [i.name for i in a.inputs if i.optional],
        "outputs": {o.name: o.size for o in a.outputs},
        "model": a.has_model,
    }


def _operations(function: Function, legs: dict[str, int]) -> dict[str, Any]:
    """Counts of a function: in all, of naming the inputs, and per block (one leg each)."""
    unpack = sum((count_expression(a.expr) for a in function.unpack), Counts())
    total = Counts()
    blocks = []
    for block in function.blocks:
        counts = count_block(block)
        total = total + counts.times(legs.get(block.leg_type, 1))
        blocks.append({"over": block.leg_type or "once", **asdict(counts)})
    return {**asdict(total), "inputs": asdict(unpack), "blocks": blocks}


def spec_digest(bundle: Bundle) -> str:
    """SHA-256 of the specification in full form."""
    return _digest(json.dumps(to_full_form(bundle.manipulator), sort_keys=True))


def derivation_digest(bundle: Bundle) -> str:
    """SHA-256 of the named equations."""
    lines = [f"{e.id} {e.name} = {e.rhs}" for e in bundle.derivation.equations()]
    lines += [f"{r.id} = {r.rhs}" for r in bundle.derivation.relations]
    return _digest("\n".join(lines))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _text(manifest: dict[str, Any]) -> str:
    """JSON with one line per entry of the second level, so that changes show as small diffs.

    Lists of tables below it (the legs of the specification) have a line per table.
    """
    lines = ["{"]
    for k, (key, value) in enumerate(manifest.items()):
        lines += _entry(f"{json.dumps(key)}: ", value, 0, last=k == len(manifest) - 1)
    return "\n".join([*lines, "}", ""])


def _entry(start: str, value: Any, depth: int, *, last: bool) -> list[str]:
    """Lines of an entry: taken apart at the first level, and lists of tables at the second."""
    comma, space = "" if last else ",", " " * depth
    tables = isinstance(value, list | tuple) and bool(value) and isinstance(value[0], dict)
    if tables and depth < 2:
        items = [("", v) for v in value]
        ends = "[]"
    elif isinstance(value, dict) and value and not depth:
        items = [(f"{json.dumps(n)}: ", v) for n, v in value.items()]
        ends = "{}"
    else:
        return [f"{space}{start}{json.dumps(value)}{comma}"]
    lines = [f"{space}{start}{ends[0]}"]
    for k, (name, each) in enumerate(items):
        lines += _entry(name, each, depth + 1, last=k == len(items) - 1)
    return [*lines, f"{space}{ends[1]}{comma}"]
