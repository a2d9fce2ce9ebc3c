"""Closed-form dynamics of parallel manipulators: readable derivations, fast standalone code.

The pipeline in one line each::

    manipulator = pne_sym.load("stewart")        # data: a catalogue name or a spec file
    derivation = pne_sym.derive(manipulator)     # named vector equations
    program = pne_sym.lower(derivation)          # scalar straight-line code
    files = pne_sym.compile_model(manipulator)   # NumPy, C, report, manifest: name -> text
    pne_sym.generate("stewart", "generated")     # the same, written to generated/stewart/
    pne_sym.draw("stewart", "stewart.svg")       # a picture (needs matplotlib)

>>> import pne_sym
>>> manipulator = pne_sym.load("planar_3rpr")
>>> derivation = pne_sym.derive(manipulator)
>>> print(derivation.definition("rpr_S").title)
from the base point to the connection point
>>> sorted(pne_sym.lower(derivation).functions)[:3]
['H', 'M', 'Z']

Names are looked up when they are used, so that importing the package is quick.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from pne_sym.version import __version__ as __version__

# How many results SymPy keeps per function, which it reads when it is imported.  Its own thousand
# are fewer than one derivation makes: with these a dense one takes half the time.
os.environ.setdefault("SYMPY_CACHE_SIZE", "200000")

if TYPE_CHECKING:
    from pne_sym.drawing import animate, draw
    from pne_sym.generation import find as load
    from pne_sym.generation import generate
    from pne_sym.lowering.program import lower
    from pne_sym.mechanics.derive import derive
    from pne_sym.model.errors import SpecError, SpecWarning
    from pne_sym.model.manipulator import (
        Body,
        Home,
        Joint,
        JointKind,
        Leg,
        Manipulator,
        PlatformJoint,
        PlatformJointKind,
        Space,
    )
    from pne_sym.pipeline import compile_model

_MODEL = "Body Home Joint JointKind Leg Manipulator PlatformJoint PlatformJointKind Space".split()
_HOMES = {
    **{name: ("pne_sym.model.manipulator", name) for name in _MODEL},
    "SpecError": ("pne_sym.model.errors", "SpecError"),
    "SpecWarning": ("pne_sym.model.errors", "SpecWarning"),
    "animate": ("pne_sym.drawing", "animate"),
    "compile_model": ("pne_sym.pipeline", "compile_model"),
    "derive": ("pne_sym.mechanics.derive", "derive"),
    "draw": ("pne_sym.drawing", "draw"),
    "generate": ("pne_sym.generation", "generate"),
    "load": ("pne_sym.generation", "find"),
    "lower": ("pne_sym.lowering.program", "lower"),
}

__all__ = [
    "Body",
    "Home",
    "Joint",
    "JointKind",
    "Leg",
    "Manipulator",
    "PlatformJoint",
    "PlatformJointKind",
    "Space",
    "SpecError",
    "SpecWarning",
    "animate",
    "compile_model",
    "derive",
    "draw",
    "generate",
    "load",
    "lower",
]


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name not in _HOMES:
        raise AttributeError(f"module 'pne_sym' has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _HOMES[name]
    return getattr(import_module(module), attribute)
