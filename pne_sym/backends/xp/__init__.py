"""The array-API back end: one functional module for NumPy, JAX, PyTorch and CuPy."""

from __future__ import annotations

from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import FieldView, describe, field_views
from pne_sym.backends.templating import render
from pne_sym.backends.xp.functions import function_text, prepare_text
from pne_sym.backends.xp.public import public_text, steps_text
from pne_sym.backends.xp.text import XpText
from pne_sym.program.public import Apply


@dataclass(frozen=True)
class ClosureView:
    """A closure, ready to print.

    Attributes:
        leg_type: name of the leg type.
        inputs: of the function that gives gap and slope.
        shape: legs, conditions, unknowns.
        places, turning: positions in q, and of angles among them.
    """

    leg_type: str
    inputs: tuple[str, ...]
    shape: tuple[int, int, int]
    places: tuple[int, ...]
    turning: tuple[int, ...]


@dataclass(frozen=True)
class XpView:
    """Ready strings for the module's template."""

    fields: tuple[FieldView, ...]
    per_leg: tuple[str, ...]
    exported: tuple[str, ...]
    prepare: str
    functions: tuple[str, ...]
    public: tuple[str, ...]
    closures: tuple[ClosureView, ...]
    given: tuple[tuple[int, int], ...]
    quaternion: int | None


class XpBackend:
    """Emits NAME_xp.py."""

    name = "xp"

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text.

        Raises:
            NotImplementedError: an operation that the templates do not provide.
        """
        text = render("xp/module.py.jinja", view=_view(bundle), d=describe(bundle))
        steps = [step for f in bundle.program.public for step in f.steps]
        used = {step.operation for step in steps if isinstance(step, Apply)}
        missing = sorted(name for name in used if f"\ndef _{name}(" not in text)
        if missing:
            raise NotImplementedError(f"operations without a definition in templates/xp: {missing}")
        return {f"{bundle.name}_xp.py": text}


def _view(bundle: Bundle) -> XpView:
    program, c = bundle.program, bundle.coordinates
    text, fields = XpText(bundle), field_views(bundle)
    return XpView(
        fields,
        tuple(f.name for f in fields if f.per_leg),
        tuple(sorted(f.name for f in program.public if f.is_exported)),
        prepare_text(text, bundle),
        tuple(function_text(text, bundle, f) for f in program.functions.values()),
        (
            *(steps_text(program, f) for f in program.public),
            *(public_text(f) for f in program.public if f.is_exported),
        ),
        tuple(_closure(bundle, k) for k in range(len(program.closures))),
        program.given,
        sum(name in "xyz" for name in c.pose) if c.has_quaternion else None,
    )


def _closure(bundle: Bundle, k: int) -> ClosureView:
    closure = bundle.program.closures[k]
    legs, conditions = bundle.program.shapes[f"gap_{closure.leg_type}"]
    return ClosureView(
        closure.leg_type,
        bundle.program.functions[f"closure_{closure.leg_type}"].inputs,
        (legs, conditions, closure.unknowns),
        closure.places,
        closure.turning,
    )
