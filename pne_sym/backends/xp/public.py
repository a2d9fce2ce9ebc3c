"""Public functions: the steps as they stand, and the functions that users call."""

from __future__ import annotations

import inspect
import textwrap

from pne_sym.program.ir import Program
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Argument, Default, PublicFunction, Run, Step, renamed

_EXPRESSIONS = {
    "add": "{0} + {1}",
    "subtract": "{0} - {1}",
    "same": "{0}",
    "negative": "-{0}",
    "multiply": "{0} * {1}",
    "entry": "{0}[{n}, ...]",
    "extend": "s.xp.concat(({0}, s.filled(0.0, ({n} - {0}.shape[0],))))",
    "clear_at": "s.add_at({0}, -s.take({0}, {numbers}), {numbers})",
    "add_forces": "s.add_at({0}, {1}[:, None, ...] * {2}, {numbers})",
    "take_columns": "s.transposed(s.take(s.transposed({0}), {numbers}))",
    "inverse_root": "1.0 / s.nonzero(s.sqrt({0}))",
    "split": "{0}[:{n}, ...], {0}[{n}:, ...]",
    "join": "s.xp.concat(({0}, {1}))",
    "beside": "s.xp.concat(({0}, {1}), axis=1)",
    "dot": "s.xp.sum({0} * {1}, axis=0)",
    "scale": "{0} * {1}[None, ...]",
    "scale_columns": "{0} * {1}[None, ...]",
    "half_form": "0.5 * s.xp.sum({0} * s.times({1}, {0}), axis=0)",
}
"""Operations that are an expression; the others are methods of the state in templates/xp."""


def expressions() -> frozenset[str]:
    """Names of the operations that are an expression."""
    return frozenset(_EXPRESSIONS)


def steps_text(program: Program, function: PublicFunction) -> str:
    """The steps as a function of the state and all inputs, which returns a tuple."""
    function = renamed(function, {"s": "s_given"})  # s is the state
    lines = [_step(program, step) for step in function.steps]
    runs = [
        isinstance(s, Run) and "q" in program.functions[s.function].inputs for s in function.steps
    ]
    if any(runs):
        lines.insert(runs.index(True), "q = s.closed(X, q0)")
    outputs = ", ".join(output.value.name for output in function.outputs)
    head = f"def _steps_{function.name}({', '.join(('s', *(a.name for a in function.inputs)))}):"
    return "\n".join((head, textwrap.indent("\n".join([*lines, f"return ({outputs},)"]), "    ")))


def _step(program: Program, step: Step) -> str:
    if isinstance(step, Run):
        inputs = ", ".join(("s", *program.functions[step.function].inputs))
        names = " ".join(f"{target.name}," for target in step.targets)
        return f"{names} = _run_{step.function}({inputs})"
    if isinstance(step, Apply):
        return f"{', '.join(target.name for target in step.targets)} = {_applied(step)}"
    inputs_of = {f.name: [a.name for a in f.inputs if a.name != "X"] for f in program.public}
    given = [
        f"_steps_{name}, ({''.join(f'{n}, ' for n in inputs_of[name])})"
        for name in (step.residual, step.slope)
    ]
    arguments = ", ".join((*given, step.start.name, str(step.halving)))
    return f"{step.target.name} = s.search({arguments})"


def _applied(step: Apply) -> str:
    """An operation at its operands."""
    operands = [operand.name for operand in step.operands]
    if step.operation in _EXPRESSIONS:
        fixed = {"n": (*step.numbers, 0)[0], "numbers": step.numbers}
        return _EXPRESSIONS[step.operation].format(*operands, **fixed)
    if "numbers" in inspect.signature(OPERATIONS[step.operation].compute).parameters:
        operands.append(str(step.numbers))
    return f"s.{step.operation}({', '.join(operands)})"


def public_text(function: PublicFunction) -> str:
    """The function that users call."""
    p = "p" if function.needs_model else "None"
    optional = [f"{a.name}=None" for a in function.optional]
    arguments = [a.name for a in function.required] + ["p=None"] * function.needs_model
    arguments += ["*", *optional] if optional else []
    rows = [f'"{a.name}": ({a.name}, {a.value.shape}, {_default(a)}),' for a in function.inputs]
    lines = [
        f'"""{function.meaning}',
        "",
        *(line for note in function.notes for line in (*textwrap.wrap(note, 92), "")),
        "Args:",
        *(f"    {a.name}: {a.meaning} ({_shape(a)})." for a in function.inputs),
        *["    p: parameters, by default those of the specification."] * function.needs_model,
        "",
        "Returns:",
        *(f"    {a.label}: {a.meaning} ({_shape(a)})." for a in function.outputs),
        '"""',
        "arguments = {  # with shape and default",
        *(f"    {row}" for row in rows),
        "}",
        f"return _call(_steps_{function.name}, {p}, arguments)",
    ]
    head = f"def {function.name}({', '.join(arguments)}):"
    return "\n".join((head, textwrap.indent("\n".join(lines), "    ")))


def _default(argument: Argument) -> str:
    number = {Default.ZEROS: "(0.0,)", Default.ONES: "(1.0,)"}.get(
        argument.default or Default.HOME_Q
    )
    size = argument.value.size
    return "None" if argument.default is None else f"{number} * {size}" if number else "HOME_Q"


def _shape(argument: Argument) -> str:
    return ", ".join(("...", *argument.dimensions))
