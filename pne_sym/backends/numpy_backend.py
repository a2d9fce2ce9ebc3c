"""The NumPy back end: one module that imports nothing but numpy."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import describe
from pne_sym.backends.kernels import kernels
from pne_sym.backends.numpy_functions import Code, FunctionText, Places
from pne_sym.backends.numpy_public import Steps, public_text
from pne_sym.backends.numpy_support import needed, support
from pne_sym.backends.python_public import module_facts
from pne_sym.backends.steps import COMMON
from pne_sym.backends.templating import defined, render
from pne_sym.program.ir import Closure


class NumpyBackend:
    """Emits NAME.py and __init__.py."""

    @property
    def operations(self) -> frozenset[str]:
        """Those that are expressions, and those that are functions in templates."""
        own = defined("numpy", r"^def _(\w+)\(") | {f.name for f in kernels()}
        return own.union(Steps.expressions, COMMON)

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        program, d = bundle.program, describe(bundle)
        places, steps = Places(), Steps(bundle)
        functions = _functions(bundle, places, steps.judged)
        texts = [f.text() for f in functions]
        parts = [steps.text(f) for f in program.public]
        public = [public_text(program, f) for f in program.public if f.is_exported]
        texts += steps.solvers()
        facts = {
            **module_facts(bundle),
            "program": program,
            "arrays": dict.fromkeys(array for f in functions for array in f.f.arrays),
            "places": places.lines(),
            "branches": bundle.derivation.parameters.branches,
            "prepare": _prepare(bundle, functions),
            "support": needed(support(d.quaternion_at), (*texts, *steps.orders, *parts, *public)),
            "functions": texts,
            "orders": steps.orders,
            "closures": [_closure(bundle, closure) for closure in program.closures],
            "texts": [*parts, *public],
        }
        return {
            f"{bundle.name}.py": render("numpy/module.py.jinja", **facts),
            "__init__.py": render("numpy/package.py.jinja", d=d),
        }


def _functions(bundle: Bundle, places: Places, judged: set[str]) -> tuple[FunctionText, ...]:
    """Functions of the program that steps and iterations run."""
    program = bundle.program
    run = {n for f in program.public for n in f.functions}
    run |= {closure.function for closure in program.closures}
    return tuple(
        FunctionText(bundle, f, places, judged=f.name in judged)
        for f in program.functions.values()
        if f.name in run
    )


def _closure(bundle: Bundle, closure: Closure) -> str:
    """A row of the table of closures."""
    function = bundle.program.functions[closure.function]
    joints = f"np.array({[list(leg) for leg in closure.joints]})"
    signs = f'_BRANCHES["{closure.sign_name}"]' if closure.rows else "()"
    facts = f"{function.inputs}, {function.arrays}, {joints}, {list(closure.turning)}"
    return f"(_run_{closure.function}, {facts}, {list(closure.rows)}, {signs})"


def _prepare(bundle: Bundle, functions: Sequence[FunctionText]) -> str:
    """Body of the function that computes the prepared values."""
    program, text = bundle.program, Code(bundle)
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
    lines += text.prepared()
    listed = [line for function in functions for line in function.constants()]
    lines += ["return {", *(f"    {line}" for line in listed), "}"]
    return textwrap.indent("\n".join(lines), "    ")
