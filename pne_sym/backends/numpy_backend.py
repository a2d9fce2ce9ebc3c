"""The NumPy back end: one module that imports nothing but numpy."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import Described, describe
from pne_sym.backends.numpy_functions import FunctionText, Places
from pne_sym.backends.numpy_public import (
    OPERATIONS,
    Orders,
    judged_functions,
    public_text,
    steps_text,
)
from pne_sym.backends.numpy_support import needed
from pne_sym.backends.python_public import ParametersView, exported, parameters_view
from pne_sym.backends.python_text import PythonText
from pne_sym.backends.templating import FIXED, render
from pne_sym.program.ir import Closure
from pne_sym.program.slices import symbols

_SUPPORT = (
    *("modes", "recording", "replay"),
    *("operations", "linear", "bounds", "iteration", "rotations"),
)
"""Templates of plain Python, of which a module gets what it needs."""


@dataclass(frozen=True)
class ModuleView:
    """Ready strings for the module's template."""

    described: Described
    exported: tuple[str, ...]
    parameters: ParametersView
    shapes: tuple[tuple[str, tuple[int, ...]], ...]
    places: tuple[str, ...]
    actuated: tuple[int, ...]
    quaternion: int | None
    given: tuple[tuple[int, int], ...]
    closures: tuple[str, ...]
    branches: tuple[str, ...]
    prepare: str
    support: str
    functions: tuple[str, ...]
    orders: tuple[str, ...]
    steps: tuple[str, ...]
    public: tuple[str, ...]


class NumpyBackend:
    """Emits NAME.py and __init__.py."""

    operations = OPERATIONS

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        view = self.view(bundle)
        return {
            f"{bundle.name}.py": render(
                "numpy/module.py.jinja", view=view, parameters=view.parameters, d=view.described
            ),
            "__init__.py": render("numpy/package.py.jinja", d=view.described),
        }

    def view(self, bundle: Bundle) -> ModuleView:
        """What the template prints."""
        program, c = bundle.program, bundle.coordinates
        places, orders = Places(), Orders(bundle)
        functions = _functions(bundle, places)
        texts = tuple(f.text() for f in functions)
        steps = tuple(steps_text(program, f, orders) for f in program.public)
        public = tuple(public_text(program, f) for f in program.public if f.is_exported)
        texts += orders.functions()
        return ModuleView(
            describe(bundle),
            exported(bundle),
            parameters_view(bundle),
            _shapes(functions, bundle),
            places.lines(),
            tuple(c.joints.index(a) for a in c.actuators),
            c.position if c.has_quaternion else None,
            program.given,
            tuple(_closure(bundle, closure) for closure in program.closures),
            _branches(bundle),
            _prepare(bundle, functions),
            needed(support(), (*texts, *orders.tables, *steps, *public)),
            texts,
            tuple(orders.tables),
            steps,
            public,
        )


@cache
def support() -> str:
    """All that a module may need of written-out Python."""
    numbers = {name.upper(): number for name, number in FIXED.items()}
    return "\n".join(render(f"numpy/{name}.py.jinja", **numbers) for name in _SUPPORT)


def _functions(bundle: Bundle, places: Places) -> tuple[FunctionText, ...]:
    """Functions of the program that steps and iterations run."""
    program = bundle.program
    judged = judged_functions(program)
    run = {n for f in program.public for n in f.functions}
    run |= {closure.function for closure in program.closures}
    return tuple(
        FunctionText(bundle, f, places, judged=f.name in judged)
        for f in program.functions.values()
        if f.name in run
    )


def _shapes(
    functions: Sequence[FunctionText], bundle: Bundle
) -> tuple[tuple[str, tuple[int, ...]], ...]:
    """Shapes of the arrays that functions give, by name."""
    names = dict.fromkeys(array for function in functions for array in function.f.arrays)
    return tuple((name, bundle.program.shapes[name]) for name in names)


def _closure(bundle: Bundle, closure: Closure) -> str:
    """A row of the table of closures."""
    function = bundle.program.functions[closure.function]
    joints = f"np.array({[list(leg) for leg in closure.joints]})"
    signs = f'_BRANCHES["{closure.sign_name}"]' if closure.rows else "()"
    facts = f"{function.inputs}, {function.arrays}, {joints}, {list(closure.turning)}"
    return f"(_run_{closure.function}, {facts}, {list(closure.rows)}, {signs})"


def _branches(bundle: Bundle) -> tuple[str, ...]:
    """Signs of the assembly branches, per leg."""
    return tuple(
        f'"{name}": np.array([{", ".join(f"{s}.0" for s in signs)}]),'
        for name, (_, signs) in bundle.derivation.parameters.branches.items()
    )


def _prepare(bundle: Bundle, functions: Sequence[FunctionText]) -> str:
    """Body of the function that computes the prepared values."""
    program, text = bundle.program, PythonText(bundle)
    formulas = [text.of(a.expr) for block in program.prepare for a in block.assignments]
    lines = ["sqrt = np.sqrt"]
    # Angles can be fixed by the parameters alone: of a leg that keeps a locked orientation.
    lines += [
        f"{name} = np.{of_numpy}"
        for name, of_numpy in (("sin", "sin"), ("cos", "cos"), ("atan2", "arctan2"))
        if any(f"{name}(" in formula for formula in formulas)
    ]
    # named, so that one more leg does not change every line that runs over the legs
    lines += [f"_{name} = {legs}" for name, legs in bundle.leg_counts.items()]
    lines += _parameters_read(bundle)
    for block in program.prepare:
        lines += text.statements(block.assignments)
        for s in block.sums:
            legs = f"_{block.leg_type}"
            lines.append(f"{s.target} = np.sum(np.broadcast_to({text.of(s.expr)}, {legs}))")
    listed = [line for function in functions for line in function.constants()]
    lines += ["return {", *(f"    {line}" for line in listed), "}"]
    return textwrap.indent("\n".join(lines), "    ")


def _parameters_read(bundle: Bundle) -> list[str]:
    """Names for the entries of parameters and the signs of branches that are used."""
    table = bundle.derivation.parameters
    used = set[str]().union(*map(symbols, bundle.program.prepare))
    entries = [
        f"{name} = p.{field.name}"
        + _subscript(field.shape, index, per_leg=field.leg_type is not None)
        for name, (field, index) in table.entries.items()
        if name in used
    ]
    return entries + [f'{name} = _BRANCHES["{name}"]' for name in table.branches if name in used]


def _subscript(shape: tuple[int, ...], index: int, *, per_leg: bool) -> str:
    """Subscript of one entry of a parameter array."""
    where = [":"] * per_leg + [str(k) for k in np.unravel_index(index, shape)] * bool(shape)
    return f"[{', '.join(where)}]" if shape else ""
