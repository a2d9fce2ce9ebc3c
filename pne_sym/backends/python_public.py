"""What users call in Python modules: signatures, docstrings, rules of arguments, exported names."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import describe, field_views
from pne_sym.backends.python_text import WIDTH
from pne_sym.backends.steps import described
from pne_sym.program.interpret import inputs_read
from pne_sym.program.ir import Program
from pne_sym.program.pose_operations import ORTHONORMAL
from pne_sym.program.public import Argument, Default, PublicFunction

_CONSTANTS = ("ACTUATED", "ACTUATOR_NAMES", "HOME_Q", "HOME_X")


def exported(bundle: Bundle) -> tuple[str, ...]:
    """Sizes, then the rest by name."""
    names = [f.name for f in bundle.program.public if f.is_exported]
    return (*bundle.coordinates.sizes, *sorted((*_CONSTANTS, "Parameters", *names)))


def module_facts(bundle: Bundle) -> dict[str, object]:
    """What templates print of a module of NumPy arrays: names, parameters and their checks."""
    return {
        "d": describe(bundle),
        "exported": exported(bundle),
        "fields": field_views(bundle),
        "relations": bundle.derivation.parameters.relations,
        "has_payload": bundle.manipulator.payload is not None,
    }


def definition(function: PublicFunction, body: Sequence[str], *, plain: bool = False) -> str:
    """A function that users call: signature, docstring and these statements.

    Args:
        function: what it is.
        body: its statements.
        plain: NaN alone tells what failed: there are no errors, no statuses, no `nearest`.
    """
    optional = [f"{a.name}=None" for a in function.optional]
    optional += ["nearest=False"] * (takes_rotation(function) and not plain)
    arguments = [a.name for a in function.required] + ["p=None"] * function.needs_model
    arguments += ["*", *optional] if optional else []
    lines = [*_docstring(function, plain=plain), *body]
    head = f"def {function.name}({', '.join(arguments)}):"
    return "\n".join((head, textwrap.indent("\n".join(lines), "    ").replace("\n    \n", "\n\n")))


def rows(program: Program, function: PublicFunction) -> list[str]:
    """Every argument with the shape of a state, its default, and what rule it obeys."""
    read = inputs_read(program, function)
    return [f"{_row(a, is_read=a.name in read)}," for a in function.inputs]


def takes_rotation(function: PublicFunction) -> bool:
    """Whether a rotation matrix is an argument; then `nearest` is another."""
    return any(map(_is_rotation, function.inputs))


def _is_rotation(argument: Argument) -> bool:
    """Matrices that are given are rotation matrices."""
    return len(argument.value.shape) == 2


def taken(argument: Argument) -> str:
    """An argument as an array, where users may give it otherwise."""
    is_base = argument.default is Default.REST
    return f"_motion_of_base({argument.name})" if is_base else argument.name


def _row(argument: Argument, *, is_read: bool) -> str:
    name, shape = argument.name, ", ".join(argument.dimensions)
    shape += "," * (len(argument.dimensions) == 1)
    value = taken(argument)
    if _is_rotation(argument):
        value = f"_rotations({name}, {argument.value.shape[0]}, nearest)"
    elif argument.value.size == 0:
        value = f"np.zeros(0) if {name} is None else {name}"
    rule = "positive" if argument.positive else "" if is_read else "unused"
    parts = [f'"{name}"', value, f"({shape})"]
    if argument.default or rule:
        parts.append(FILL[argument.default])
    if rule:
        parts.append(f'"{rule}"')
    return f"({', '.join(parts)})"


def _docstring(function: PublicFunction, *, plain: bool) -> list[str]:
    notes = [line for note in function.notes for line in ("", *_filled(note, ""))]
    inputs = [_described(a.name, a) for a in function.inputs]
    rotation = takes_rotation(function) and not plain
    if rotation:
        inputs.append(
            "nearest: take the rotation that is nearest to R: the least sum of squared differences."
        )
    inputs += ["p: parameters, by default those of the specification."] * function.needs_model
    outputs = [_described(a.label, a) for a in function.outputs]
    outputs += [f"status: {_STATUS} (...)."] * (function.gives_status and not plain)
    return [
        *_filled(f'"""{function.meaning}', ""),
        *notes,
        "",
        "Args:",
        *(line for text in inputs for line in _filled(text, "    ")),
        "",
        "Returns:",
        *(line for text in outputs for line in _filled(text, "    ")),
        *(["", "Raises:", *_filled(_NO_ROTATION, "    ")] if rotation else []),
        '"""',
    ]


_NO_ROTATION = (
    f"ValueError: R has not orthonormal rows, to {ORTHONORMAL:g}, and determinant +1, or no single "
    "nearest rotation."
)
FILL = {
    None: "None",
    Default.ZEROS: "0.0",
    Default.ONES: "1.0",
    Default.HOME_Q: "HOME_Q",
    Default.REST: "_REST",
}
_STATUS = "0 OK, 1 unreachable, 2 singular leg, 3 invalid, 4 not converged, as in C"


def _described(name: str, argument: Argument) -> str:
    shape = ", ".join(("...", *argument.dimensions)) if argument.dimensions else "...,"
    return described(name, argument, shape)


def _filled(text: str, indent: str) -> list[str]:
    """Lines of a paragraph."""
    more = indent + "    " * bool(indent)
    return textwrap.wrap(text, WIDTH - 4, initial_indent=indent, subsequent_indent=more)
