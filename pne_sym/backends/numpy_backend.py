"""The NumPy back end: one module that imports nothing but numpy."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import (
    Described,
    FieldView,
    describe,
    field_views,
    moment_rows,
)
from pne_sym.backends.numpy_parts import Parts
from pne_sym.backends.numpy_text import PythonText
from pne_sym.backends.templating import render
from pne_sym.derivation import AxisRelation, LegTypeInfo
from pne_sym.program.ir import Closure
from pne_sym.program.slices import symbols


@dataclass(frozen=True)
class ModuleView:
    """Ready strings for the module's template."""

    described: Described
    fields: tuple[FieldView, ...]
    relations: tuple[AxisRelation, ...]
    defaults: tuple[str, ...]
    legs: tuple[LegTypeInfo, ...]
    driven_joints: tuple[int, ...]
    turning_drives: tuple[int, ...]
    actuator_legs: tuple[int, ...]
    moment_rows: tuple[int, ...]
    closures: tuple[Closure, ...]
    extra_joints: tuple[int, ...]
    turning_joints: tuple[bool, ...]
    branches: tuple[str, ...]
    prepare: str
    functions: tuple[str, ...]
    plans: tuple[str, ...]


class NumpyBackend:
    """Emits NAME.py and __init__.py."""

    operations = None

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        view = self.view(bundle)
        return {
            f"{bundle.name}.py": render("numpy/module.py.jinja", view=view, d=view.described),
            "__init__.py": render("numpy/package.py.jinja", d=view.described),
        }

    def view(self, bundle: Bundle) -> ModuleView:
        """What the template prints."""
        text = PythonText(bundle)
        parts = [Parts(text, bundle, f) for f in bundle.program.functions.values()]
        fields, c = field_views(bundle), bundle.coordinates
        driven = tuple(c.joints.index(a) for a in c.actuators)
        return ModuleView(
            describe(bundle),
            fields,
            tuple(bundle.derivation.parameters.relations),
            tuple(line for f in fields for line in _default_lines(f)),
            bundle.derivation.leg_types,
            driven,
            tuple(k for k, j in enumerate(driven) if c.turning[j]),
            tuple(leg for leg, _ in c.actuators),
            moment_rows(bundle),
            bundle.program.closures,
            tuple(joint for joint, _ in bundle.program.given),
            c.turning,
            _branches(bundle),
            _prepare(bundle, text),
            tuple(part.text() for part in parts),
            tuple(part.plan() for part in parts),
        )


def _default_lines(f: FieldView) -> list[str]:
    """Lines of a parameter's default, one per leg."""
    if not f.per_leg:
        return [f'"{f.name}": {f.rows[0]},']
    return [f'"{f.name}": [', *(f"    {row}," for row in f.rows), "],"]


def _branches(bundle: Bundle) -> tuple[str, ...]:
    """Signs of the assembly branches, per leg."""
    return tuple(
        f'"{name}": np.array([{", ".join(f"{s}.0" for s in signs)}]),'
        for name, (_, signs) in bundle.derivation.parameters.branches.items()
    )


def _prepare(bundle: Bundle, text: PythonText) -> str:
    """Body of the function that computes the prepared values."""
    program = bundle.program
    formulas = [text.of(a.expr) for block in program.prepare for a in block.assignments]
    lines = ["sqrt = np.sqrt"]
    # Angles can be fixed by the parameters alone: of a leg that keeps a locked orientation.
    lines += [
        f"{name} = np.{of_numpy}"
        for name, of_numpy in (("sin", "sin"), ("cos", "cos"), ("atan2", "arctan2"))
        if any(f"{name}(" in formula for formula in formulas)
    ]
    # named, so that one more leg does not change every line that runs over the legs
    lines += [f'_{t} = (len(_LEGS["{t}"]),)' for t in bundle.leg_counts]
    lines += _parameters_read(bundle)
    for block in program.prepare:
        lines += text.statements(block.assignments)
        for target, value in block.sums:
            legs = f"_{block.leg_type}"
            lines.append(f"{target} = np.sum(np.broadcast_to({text.of(value)}, {legs}))")
    lines += _prepared(bundle)
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


def _prepared(bundle: Bundle) -> list[str]:
    """The prepared values as what is returned: shared ones, and those of the legs by type."""
    prepared = bundle.program.prepared
    lines = ["shared = {", *(f'    "{n}": float({n}),' for n, leg in prepared if not leg)]
    lines += ["}", "legs = {"]
    for leg_type in bundle.leg_counts:
        lines.append(f'    "{leg_type}": {{')
        lines += [
            f'        "{n}": np.broadcast_to({n}, _{leg_type}),'
            for n, leg in prepared
            if leg == leg_type
        ]
        lines.append("    },")
    return [*lines, "}", "return shared, legs"]


def _subscript(shape: tuple[int, ...], index: int, *, per_leg: bool) -> str:
    """Subscript of one entry of a parameter array."""
    where = []
    if per_leg:
        where.append(":")
    if shape == (3,):
        where.append(str(index))
    elif shape == (3, 3):
        where += [str(index // 3), str(index % 3)]
    return f"[{', '.join(where)}]" if where and where != [":"] else ""
