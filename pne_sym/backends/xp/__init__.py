"""The array-API back end: one functional module for NumPy, JAX, PyTorch and CuPy."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import describe, field_views
from pne_sym.backends.python_public import FILL, definition, taken
from pne_sym.backends.steps import COMMON
from pne_sym.backends.templating import defined, render
from pne_sym.backends.xp.printers import PRINTER, Code, Steps
from pne_sym.program.public import Default, PublicFunction, renamed


class XpBackend:
    """Emits NAME_xp.py."""

    @property
    def operations(self) -> frozenset[str]:
        """Those that are expressions, and those that are methods of the state in templates/xp."""
        own = (defined(folder, r"^    def (\w+)\(self") for folder in ("xp", "kernels"))
        return frozenset[str]().union(*own, Steps.expressions, COMMON)

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        program = bundle.program
        public = [renamed(f, {"s": "s_given"}) for f in program.public]  # s is the state
        code, steps = Code(bundle, PRINTER), Steps(program)
        facts = {
            "d": describe(bundle),
            "fields": field_views(bundle),
            "program": program,
            "prepare": code.prepared(),
            "functions": [(f, code.body(f)) for f in program.functions.values()],
            "steps": [(f, steps.lines(f)) for f in public],
            "exported": {f.name: _public(f) for f in program.public if f.is_exported},
        }
        return {f"{bundle.name}_xp.py": render("xp/module.py.jinja", **facts)}


def _public(function: PublicFunction) -> str:
    """A function that users call."""
    body = ["arguments = {  # with shape and default"]
    for a in function.inputs:
        numbers = a.default in (Default.ZEROS, Default.ONES)
        default = f"({FILL[a.default]},) * {a.value.size}" if numbers else FILL[a.default]
        body.append(f'    "{a.name}": ({taken(a)}, {a.value.shape}, {default}),')
    p, more = "p" if function.needs_model else "None", ", unbounded=True" * function.unbounded
    body += ["}", f"return _call(_steps_{function.name}, {p}, arguments{more})"]
    return definition(function, body, plain=True)
