"""The array-API back end: one functional module for NumPy, JAX, PyTorch and CuPy."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import describe, field_views
from pne_sym.backends.templating import methods, render
from pne_sym.backends.xp.functions import Code
from pne_sym.backends.xp.public import expressions, public_text, steps_text
from pne_sym.program.ir import Closure


class XpBackend:
    """Emits NAME_xp.py."""

    @property
    def operations(self) -> frozenset[str]:
        """Those that are expressions, and those that are methods of the state in templates/xp."""
        return expressions() | methods("xp")

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        program, c, code = bundle.program, bundle.coordinates, Code(bundle)
        exported = [f for f in program.public if f.is_exported]
        run = {name for f in program.public for name in f.functions}
        run |= {f"closure_{closure.leg_type}" for closure in program.closures}
        text = render(
            "xp/module.py.jinja",
            d=describe(bundle),
            fields=field_views(bundle),
            exported=sorted(f.name for f in exported),
            code=(
                code.prepare(),
                *(code.function(f) for f in program.functions.values() if f.name in run),
                *(steps_text(program, f) for f in program.public),
                *map(public_text, exported),
            ),
            closures=[_closure(bundle, closure) for closure in program.closures],
            given=program.given,
            actuated=tuple(map(c.joints.index, c.actuators)),
            quaternion=sum(name in "xyz" for name in c.pose) if c.has_quaternion else None,
        )
        return {f"{bundle.name}_xp.py": text}


def _closure(bundle: Bundle, closure: Closure) -> str:
    """A row of the table of closures."""
    function = bundle.program.functions[f"closure_{closure.leg_type}"]
    shape = (*bundle.program.shapes[f"gap_{closure.leg_type}"], closure.unknowns)
    branch = (closure.rows, tuple(map(float, closure.signs)))
    facts = f"{function.inputs}, {shape}, {branch}, {closure.places}, {closure.turning}"
    return f"(_run_{function.name}, {facts})"
