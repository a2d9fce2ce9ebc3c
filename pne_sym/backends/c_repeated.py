"""Public functions that begin with all that another one does: in C they call it."""

from __future__ import annotations

from dataclasses import replace

from pne_sym.program.interpret import inputs_read
from pne_sym.program.ir import Program
from pne_sym.program.public import Apply, PublicFunction, Value


def repeated(
    program: Program, f: PublicFunction, other: PublicFunction
) -> tuple[tuple[str, Value], ...]:
    """Results of another function, with whose steps a function begins, as values of this one.

    Nothing is one step, nor what iterates displacements, which both would do, nor steps of which
    more is read than the results.

    Returns:
        label of every result -> value; empty where it does not begin so.
    """
    n, given = len(other.steps), {(a.name, a.default) for a in f.inputs}
    read = inputs_read(program, other)
    wanted = {(a.name, a.default) for a in other.inputs if a.name in read}
    if not 1 < n < len(f.steps) or not wanted <= given or "q0" in read:
        return ()
    *begin, last = other.steps
    found = f.steps[n - 1]
    if not (isinstance(last, Apply) and isinstance(found, Apply)):
        return ()
    if (*begin, replace(last, targets=found.targets)) != f.steps[:n]:
        return ()
    made = {t.name for step in begin for t in step.targets}
    later = {o.name for step in f.steps[n:] for o in step.operands}
    values = {o.name: v for o, v in zip(last.targets, found.targets, strict=True)}
    if made & (later | {o.name for o in f.outputs}) or values.keys() != {
        o.name for o in other.outputs
    }:
        return ()
    return tuple((o.label, values[o.name]) for o in other.outputs)
