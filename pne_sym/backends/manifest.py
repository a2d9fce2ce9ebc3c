"""The manifest back end: what a model consists of, for programs to read."""

from __future__ import annotations

import hashlib
import json
import re
from importlib.metadata import version
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.derivation import ParameterField
from pne_sym.model.full_form import to_full_form
from pne_sym.program.count import count_block, count_expression
from pne_sym.program.ir import Counts, Function

FORMAT = 1


class ManifestBackend:
    """Emits NAME.json."""

    name = "manifest"

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        return {f"{bundle.name}.json": _text(_manifest(bundle))}


def _manifest(bundle: Bundle) -> dict[str, Any]:
    c = bundle.coordinates
    return {
        "format": FORMAT,
        "generator": f"pne_sym {version('pne-sym')}",
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


def _operations(function: Function, legs: dict[str, int]) -> dict[str, Any]:
    """Counts of a function: in all, of naming the inputs, and per block (one leg each)."""
    unpack = sum((count_expression(a.expr) for a in function.unpack), Counts())
    total = Counts()
    blocks = []
    for block in function.blocks:
        counts = count_block(block)
        total = total + counts.times(legs.get(block.leg_type, 1))
        blocks.append({"over": block.leg_type or "once", **_counts(counts)})
    return {**_counts(total), "inputs": _counts(unpack), "blocks": blocks}


def _counts(c: Counts) -> dict[str, int]:
    return {"mul": c.mul, "add": c.add, "div": c.div, "sqrt": c.sqrt, "trig": c.trig}


def spec_digest(bundle: Bundle) -> str:
    """SHA-256 of the specification in full form."""
    return _digest(json.dumps(to_full_form(bundle.manipulator), sort_keys=True))


def derivation_digest(bundle: Bundle) -> str:
    """SHA-256 of the named equations."""
    lines = [f"{e.id} {e.name} = {e.rhs}" for e in bundle.derivation.equations()]
    return _digest("\n".join(lines))


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def _text(manifest: dict[str, Any]) -> str:
    """JSON with one line per entry of the second level, so that changes show as small diffs."""
    lines = ["{"]
    for k, (key, value) in enumerate(manifest.items()):
        comma = "," if k < len(manifest) - 1 else ""
        if isinstance(value, dict) and value:
            lines.append(f"{json.dumps(key)}: {{")
            inner = [f" {json.dumps(n)}: {json.dumps(v)}" for n, v in value.items()]
            lines += [line + ("," if i < len(inner) - 1 else "") for i, line in enumerate(inner)]
            lines.append("}" + comma)
        elif isinstance(value, list | tuple) and value and isinstance(value[0], dict):
            lines.append(f"{json.dumps(key)}: [")
            inner = [f" {json.dumps(v)}" for v in value]
            lines += [line + ("," if i < len(inner) - 1 else "") for i, line in enumerate(inner)]
            lines.append("]" + comma)
        else:
            lines.append(f"{json.dumps(key)}: {json.dumps(value)}{comma}")
    return "\n".join([*lines, "}", ""])
