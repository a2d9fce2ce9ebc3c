"""The manifest of a generated folder read as a stranger's: every entry that is used is checked."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Any

from pne_sym.contents import GENERATOR
from pne_sym.generation import InputError
from pne_sym.model.errors import SpecError, printable
from pne_sym.model.files import MAX_BYTES, parse
from pne_sym.review.sources import Source, decoded

FORMATS = (1, 2)
"""All that pne_sym has written; `backends.manifest` is not imported, it brings SymPy."""
_LONGEST_TEXT = 2000
_LARGEST = 100_000
"""Of any count, size or number of entries: hundreds of times what a model has."""
SIZES = ("NQ", "NV", "NU", "NC", "NW", "NJ")
COUNTS = ("mul", "add", "div", "sqrt", "trig")
Check = Callable[[Any], bool]


def read_manifest(text: str, source: str) -> dict[str, Any]:
    """The manifest as plain data, its used entries of the shape that they should have.

    Args:
        text: of NAME.json.
        source: what to call it in messages.

    Raises:
        InputError: it is at fault; the message has the entry.
    """
    if len(text) > MAX_BYTES:
        raise InputError(f"{source} is larger than {MAX_BYTES} bytes")
    try:
        manifest = parse(text, ".json", source)
    except SpecError as error:
        raise InputError(f"{source} is not JSON, or not as it should be: {error}") from error
    if not isinstance(manifest, dict) or GENERATOR not in str(manifest.get("generator"))[:100]:
        raise InputError(f"{source} is not of {GENERATOR}")
    _check(manifest, _ENTRIES, source)
    if manifest["format"] >= 2:
        _check(manifest, _ENTRIES_OF_2, source)
    if "targets" in manifest:
        _check(manifest, {"targets": lambda value: _list(_is_name)(value) and bool(value)}, source)
    if fault := _contradiction(manifest):
        raise InputError(printable(f"{source} contradicts itself: {fault}"))
    return manifest


def manifest_of(source: Source) -> dict[str, Any]:
    """The manifest of a generated folder.

    Raises:
        InputError: it is at fault, or of another model.
    """
    assert source.folder is not None
    what = f"{source.label[:100]!r}: its manifest"
    text = decoded(what, source.folder[f"{source.name}.json"].content)
    manifest = read_manifest(text, what)
    if manifest["name"] != source.name:
        raise InputError(f"{what} {source.name}.json is of another model, {manifest['name']!r}")
    return manifest


def _check(manifest: Mapping[str, Any], entries: Mapping[str, Check], source: str) -> None:
    for key, check in entries.items():
        if key not in manifest:
            raise InputError(f"{source} has no {key!r}")
        if not check(manifest[key]):
            raise InputError(f"{source}: its entry {key!r} is not as {GENERATOR} writes it")


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _LARGEST


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= 1e300


def _is_text(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= _LONGEST_TEXT


def _matching(pattern: re.Pattern[str]) -> Check:
    return lambda value: isinstance(value, str) and pattern.fullmatch(value) is not None


def _list(check: Check) -> Check:
    return lambda value: (
        isinstance(value, list) and len(value) <= _LARGEST and all(map(check, value))
    )


def _map(check: Check, key: Check = _is_text) -> Check:
    return lambda value: (
        isinstance(value, dict) and all(map(key, value)) and all(map(check, value.values()))
    )


def _fields(required: Mapping[str, Check], optional: Mapping[str, Check] | None = None) -> Check:
    """A table that has the required entries; others but the optional ones are not looked at."""
    return lambda value: (
        isinstance(value, dict)
        and all(k in value and check(value[k]) for k, check in required.items())
        and all(check(value[k]) for k, check in (optional or {}).items() if k in value)
    )


_is_name = _matching(re.compile(r"[A-Za-z][A-Za-z0-9_]{0,99}"))
_is_path = _matching(re.compile(r"[A-Za-z0-9_.\[\]]{1,200}"))
_pairs = _list(lambda pair: _list(_is_count)(pair) and len(pair) == 2)
_MOST_FUNCTIONS = 500
_any_functions = _map(
    _fields(
        {
            "inputs": _map(_is_count, _is_name),
            "outputs": _map(_is_count, _is_name),
            "optional": _list(_is_name),
            "model": lambda value: isinstance(value, bool),
        }
    ),
    _is_name,
)
_ENTRIES_OF_2: dict[str, Check] = {
    "functions": lambda value: _any_functions(value) and len(value) <= _MOST_FUNCTIONS,
    "specification": lambda value: isinstance(value, dict),
}
_ENTRIES: dict[str, Check] = {
    "name": _is_name,
    "format": lambda value: _is_count(value) and value in FORMATS,
    "title": _is_text,
    "space": _is_text,
    "sizes": _fields(dict.fromkeys(SIZES, _is_count)),
    "coordinates": _fields(dict.fromkeys(("X", "V", "wrench"), _list(_is_text))),
    "joints": _pairs,
    "actuators": _pairs,
    "extra": _pairs,
    "constraints": _list(_is_count),
    "home": _fields({"X": _list(_is_number), "q": _list(_is_number)}),
    "leg_types": _list(
        _fields(
            {
                "name": _is_name,
                "architecture": _is_text,
                "legs": _list(_is_count),
                "branches": _map(_list(lambda sign: isinstance(sign, int) and sign in (-1, 1))),
            }
        )
    ),
    "parameters": _list(
        _fields(
            {"name": _is_name, "unit": _is_text, "shape": _list(_is_count), "path": _is_path},
            {"legs": _list(_is_count), "zero_by_structure": _list(_is_count)},
        )
    ),
    "operations": _map(_fields(dict.fromkeys(COUNTS, _is_count))),
}


def _contradiction(m: Mapping[str, Any]) -> str:
    """The first contradiction between entries that programs rely on, or nothing."""
    sizes, home = m["sizes"], m["home"]
    for what, found, size in (
        ("home X", home["X"], "NQ"),
        ("home q", home["q"], "NJ"),
        ("joints", m["joints"], "NJ"),
        ("actuators", m["actuators"], "NU"),
    ):
        if len(found) != sizes[size]:
            return f"{what} has {len(found)} entries, {size} is {sizes[size]}"
    if len(m["coordinates"]["X"]) + len(m["extra"]) != sizes["NQ"]:
        return "the coordinates X and the extra ones are not NQ"
    if any(joint not in m["joints"] for joint in m["actuators"]):
        return "an actuator is no joint"
    names = [p["name"] for p in m["parameters"]]
    if len(set(names)) < len(names):
        return "two parameters have one name"
    return next(filter(None, map(_parameter_fault, m["parameters"])), "")


def _parameter_fault(p: Mapping[str, Any]) -> str:
    shape = p["shape"]
    if len(shape) > 4 or math.prod(shape) > _LARGEST:
        return f"parameter {p['name']} has an impossible shape"
    own = shape
    if "legs" in p:
        if not shape or shape[0] != len(p["legs"]) or len(set(p["legs"])) < len(p["legs"]):
            return f"parameter {p['name']} has not one entry per leg"
        own = shape[1:]
    if any(k >= math.prod(own) for k in p.get("zero_by_structure", ())):
        return f"parameter {p['name']} has no such entries that are zero by structure"
    return ""
