"""Functions of a program on arrays: straight-line code, the legs as a leading dimension."""

from __future__ import annotations

import textwrap

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.xp.text import XpText
from pne_sym.program.count import count_function
from pne_sym.program.ir import Block, Function
from pne_sym.program.slices import columns, flat_places, slices, symbols

_SIZES = {"X": "NQ", "V": "NV", "A": "NV", "q": "NJ"}


def function_text(text: XpText, bundle: Bundle, function: Function) -> str:
    """A function of the program: of the state and input vectors, to its arrays."""
    counts = count_function(function, bundle.leg_counts)
    lines = ["xp, c = s.xp, s.prepared", *_inputs(bundle, function)]
    lines += text.lines(function.unpack, guarded=True) + text.required(function.unpack_checks)
    for block in function.blocks:
        if block.leg_type:
            lines.append(f"# over the legs {block.leg_type}")
            for entry in function.leg_inputs.get(block.leg_type, ()):
                lines.append(f"{entry.symbol} = s.per_leg({entry.vector}, {entry.indices})")
        lines += text.lines(block.assignments, guarded=True) + text.required(block.checks)
        for target, value in block.sums:
            legs = bundle.leg_counts[block.leg_type]
            lines += text.assign(str(target), f"s.total({text.of(value)}, {legs})")
    arrays = [_array(text, bundle, function, name) for name in function.arrays]
    lines += ["found = (", *(line for array in arrays for line in array), ")"]
    lines += ["s.settle()", "return found"]
    comment = (
        f"# {function.name}: {counts.mul} mul, {counts.add} add, {counts.div} div, "
        f"{counts.sqrt} sqrt, {counts.trig} trig"
    )
    signature = f"def _run_{function.name}({', '.join(('s', *function.inputs))}):"
    return "\n".join((comment, signature, textwrap.indent("\n".join(lines), "    ")))


def _inputs(bundle: Bundle, function: Function) -> list[str]:
    """Names for prepared values, and for the entries of the input vectors that are read."""
    parts = slices(function)
    read = {name for block in function.blocks for name in symbols(block)} | parts.reads_before
    named = [n for n in function.shared if n in read]
    named += [n for names in function.per_leg.values() for n in names]
    lines = [f'{name} = c["{name}"]' for name in named]
    for vector in function.inputs:
        size = bundle.coordinates.sizes[_SIZES[vector]]
        entries = [(k, f"{vector}_{k}") for k in range(size)]
        lines += [f"{name} = {vector}[{k}, ...]" for k, name in entries if name in read]
    return lines


def _array(text: XpText, bundle: Bundle, function: Function, name: str) -> list[str]:
    """An output array, put together from what the blocks store."""
    shape = bundle.program.shapes[name]
    lines = ["    s.array(", f"        {shape},"]
    for block in function.blocks:
        legs = bundle.leg_counts.get(block.leg_type, 1)
        for store in (s for s in block.stores if s.array == name):
            places = flat_places(store, columns(shape), legs)
            lines.append(f"        ({places}, {text.of(store.value)}),")
    return [*lines, "    ),"]


def prepare_text(text: XpText, bundle: Bundle) -> str:
    """The function that computes what depends on the parameters alone."""
    lines = ["xp = s.xp", *_parameters(bundle)]
    for block in bundle.program.prepare:
        lines += text.lines(block.assignments, guarded=False)
        lines += _sums(text, bundle, block)
    lines += ["return {", *(f'    "{n}": {n},' for n, _ in bundle.program.prepared), "}"]
    head = ("def _prepare(s):", '    """Values that depend on the parameters alone."""')
    return "\n".join((*head, textwrap.indent("\n".join(lines), "    ")))


def _sums(text: XpText, bundle: Bundle, block: Block) -> list[str]:
    legs = bundle.leg_counts.get(block.leg_type, 1)
    return [f"{target} = s.total({text.of(value)}, {legs})" for target, value in block.sums]


def _parameters(bundle: Bundle) -> list[str]:
    """Names for the entries of parameters and the signs of branches that are used."""
    table = bundle.derivation.parameters
    used = set[str]().union(*map(symbols, bundle.program.prepare))
    used |= {name for name, _ in bundle.program.prepared}
    lines, fields = [], dict[str, None]()
    for name, (field, index) in table.entries.items():
        if name not in used:
            continue
        if field.name not in fields:
            fields[field.name] = None
            lines.append(f'a = s.field("{field.name}")')
        width = field.shape[-1] if field.shape else 1
        place = {0: (), 1: (index,), 2: divmod(index, width)}[len(field.shape)]
        lines.append(f"{name} = a[{', '.join((*map(str, place), '...'))}]")
    signs = [(n, s) for n, (_, s) in table.branches.items() if n in used]
    return lines + [f"{name} = s.signs({tuple(map(float, values))})" for name, values in signs]
