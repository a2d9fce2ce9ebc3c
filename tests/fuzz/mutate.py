"""Broken specifications: bytes changed in a text, or pieces changed in a tree; all from a seed."""

from __future__ import annotations

import copy
import json
import random
from functools import cache
from typing import Any

from pne_sym import manipulators
from pne_sym.model.reader import to_full_form
from pne_sym.starter import starter_text

NAMES = (
    "fivebar_revolute", "fivebar_offset", "fivebar_prismatic", "planar_3rpr", "planar_redundant",
    "sixbar", "tripod_3rps", "tripod_3upu", "delta", "spherical_3ups", "stewart_sps",
)  # fmt: skip
STARTERS = ("3-RPR", "2-RRR", "3-UPU", "1-RRRRS+2-RRRS")
WORDS: tuple[Any, ...] = (
    None, True, False, -1, 0, 1, 3.5, 1e300, -1e-300, 1e-9, float("nan"), float("inf"), 10**30,
    "", "x", "-z", "R", "P", "S", "U", "rigid", "spherical", "point", "{{ 7 * 7 }}", "*/ int x; /*",
    "__import__('os')", "%s%n", "\x00\u202e", "../../x", "a" * 300, [], {}, [[]], [0, 0, 0],
    [1, 0, 0], [0.6, 0.8, 0], [[1, 0, 0]] * 3, {"kind": "U"}, {"rpy_deg": [10, 20, 30]}, {"0": {}},
    ["x", "y"], {"mass": 1}, {"mass": 0, "inertia": [1, 1, 1]}, [True, False],
)  # fmt: skip
PIECES = (
    b"", b"[", b"]", b"{", b"}", b'"', b"'", b'"""', b"=", b".", b",", b"9", b"-", b"e9", b"\n",
    b"\x00", b"\xff", b"\xc3\xa9", b"[[legs]]\n", b"[home]\n", b"nan", b"inf", b"true", b"#", b"\\",
    b"1979-05-27", b"0x", b"a.b.c.d = 1\n", b"\r", b"\x1b[31m", b"\xe2\x80\xae", b"\xef\xbb\xbf",
)  # fmt: skip

Case = tuple[bytes, str]


def make_case(seed: int, index: int) -> Case:
    """The content and the suffix of one broken (or by chance still valid) specification."""
    rng = random.Random(f"{seed}/{index}")
    if rng.random() < 0.5:
        text, suffix = rng.choice(texts())
        return broken_bytes(text, rng), suffix
    form: Any = copy.deepcopy(rng.choice(trees()))
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        break_tree(form, rng)
    return json.dumps(form).encode(), ".json"


@cache
def texts() -> tuple[tuple[bytes, str], ...]:
    """Valid specifications as text."""
    toml = [manipulators.path(name).read_text(encoding="utf-8") for name in NAMES]
    toml += [starter_text("my_robot", legs) for legs in STARTERS]
    both = [(text.encode(), ".toml") for text in toml]
    return (*both, (json.dumps(trees()[0]).encode(), ".json"))


@cache
def trees() -> tuple[Any, ...]:
    """Valid specifications in full form."""
    return tuple(to_full_form(manipulators.load(name)) for name in NAMES)


def broken_bytes(text: bytes, rng: random.Random) -> bytes:
    """Pieces cut out, put in, doubled, or taken from elsewhere."""
    for _ in range(rng.choice((1, 1, 2, 4, 16))):
        start = rng.randrange(len(text) + 1)
        end = min(len(text), start + rng.choice((0, 1, 1, 2, 5, 40, 400)))
        way = rng.random()
        if way < 0.6:
            piece = rng.choice(PIECES)
        elif way < 0.7:
            piece = bytes([rng.randrange(256)])
        elif way < 0.85:
            piece = text[start:end] * 2
        else:
            other = rng.randrange(len(text) + 1)
            piece = text[other : other + rng.choice((1, 10, 100))]
        text = text[:start] + piece + text[end:]
    return text


def break_tree(form: Any, rng: random.Random) -> None:
    """Replace, rename, remove or move something somewhere in a tree of dicts and lists."""
    while True:
        keys = list(form) if isinstance(form, dict) else list(range(len(form)))
        if not keys:
            return
        key = rng.choice(keys)
        if isinstance(form[key], dict | list) and rng.random() < 0.85:
            form = form[key]
            continue
        break
    way = rng.random()
    if way < 0.15:
        del form[key]
    elif way < 0.25 and isinstance(form[key], int | float):
        form[key] = form[key] * rng.choice((0, -1, 2, 1e-12, 1e12, 1.0000001))
    elif way < 0.35:
        form[key] = copy.deepcopy(form[rng.choice(keys)])
    elif way < 0.4 and isinstance(form, dict):
        form[str(key)[:-1] or "a"] = form.pop(key)
    else:
        form[key] = copy.deepcopy(rng.choice(WORDS))
