"""The array-API back end: one functional module for NumPy, JAX, PyTorch and CuPy."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import describe, field_views
from pne_sym.backends.python_public import definition
from pne_sym.backends.steps import COMMON
from pne_sym.backends.templating import defined, render
from pne_sym.backends.xp.printers import PRINTER, Code, Steps
from pne_sym.program.public import Default, PublicFunction, renamed


class XpBackend:
    """Emits NAME_xp.py."""

    @property
    def operations(self) -> frozenset[str]:
        """Those that are expressions, and those that are methods of the state in templates/xp."""
        return defined("xp", r"^    def (\w+)\(self").union(Steps.expressions, COMMON)

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        program, c = bundle.program, bundle.coordinates
        public = [renamed(f, {"s": "s_given"}) for f in program.public]  # s is the state
        code, steps = Code(bundle, PRINTER), Steps(program)
        facts = {
            "d": describe(bundle),
            "fields": field_views(bundle),
            "program": program,
            "prepare": code.prepared(),
            "functions": [(f, code.body(f)) for f in program.functions.values()],
            "actuated": tuple(map(c.joints.index, c.actuators)),
            "steps": [(f, steps.lines(f)) for f in public],
            "exported": {f.name: _public(f) for f in program.public if f.is_exported},
        }
        return {f"{bundle.name}_xp.py": render("xp/module.py.jinja", **facts)}


def _public(function: PublicFunction) -> str:
    """A function that users call."""
    fill = {Default.ZEROS: "(0.0,) * {}", Default.ONES: "(1.0,) * {}", Default.HOME_Q: "HOME_Q"}
    fill[Default.REST] = "_REST"
    body = ["arguments = {  # with shape and default"]
    for a in function.inputs:
        default = fill[a.default].format(a.value.size) if a.default else None
        given = f"_motion_of_base({a.name})" if a.default is Default.REST else a.name
        body.append(f'    "{a.name}": ({given}, {a.value.shape}, {default}),')
    p = "p" if function.needs_model else "None"
    unbounded = ", unbounded=True" * function.unbounded
    body += [
        "}",
        f"return _call(_steps_{function.name}, {p}, arguments{unbounded})",
    ]
    return definition(function, body, plain=True)
