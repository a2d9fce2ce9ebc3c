"""Public functions: the steps as they stand, and the functions that users call."""

from __future__ import annotations

import inspect
import textwrap

from pne_sym.program.ir import Program
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Argument, Default, PublicFunction, Run, Search, Step


def steps_text(program: Program, function: PublicFunction) -> str:
    """The steps as a function of the state and all inputs, which returns a tuple."""
    known = {f.name: f for f in program.public}
    lines, closed = [], False
    for step in function.steps:
        if isinstance(step, Run) and "q" in program.functions[step.function].inputs and not closed:
            lines.append("q = _closed(s, X, q0)")
            closed = True
        lines.append(_step(program, known, step))
    outputs = ", ".join(output.value.name for output in function.outputs)
    lines.append(f"return ({outputs},)")
    inputs = ", ".join(("s", *(a.name for a in function.inputs)))
    head = f"def _steps_{function.name}({inputs}):"
    return "\n".join((head, textwrap.indent("\n".join(lines), "    ")))


def _step(program: Program, known: dict[str, PublicFunction], step: Step) -> str:
    if isinstance(step, Run):
        inputs = ", ".join(("s", *program.functions[step.function].inputs))
        names = "".join(f"{target.name}, " for target in step.targets)
        return f"{names.rstrip()} = _run_{step.function}({inputs})"
    if isinstance(step, Apply):
        operands = ", ".join(("s", *(operand.name for operand in step.operands)))
        numbers = f", numbers={step.numbers}" if takes_numbers(step) else ""
        names = ", ".join(target.name for target in step.targets)
        return f"{names} = _{step.operation}({operands}{numbers})"
    return _search(known, step)


def takes_numbers(step: Apply) -> bool:
    """Whether the operation is told something that is fixed at generation."""
    return "numbers" in inspect.signature(OPERATIONS[step.operation].compute).parameters


def _search(known: dict[str, PublicFunction], step: Search) -> str:
    def given(name: str) -> str:
        names = [a.name for a in known[name].inputs if a.name != "X"]
        return f"_steps_{name}, ({''.join(f'{n}, ' for n in names)})"

    target, start = step.target.name, step.start.name
    found = f"{given(step.residual)}, {given(step.slope)}"
    return f"{target} = _search(s, {found}, {start}, {step.halving})"


def public_text(function: PublicFunction) -> str:
    """The function that users call."""
    names = [a.name for a in function.required]
    optional = [a.name for a in function.optional]
    arguments = [*names, *(["p=None"] if function.needs_model else [])]
    arguments += ["*", *(f"{n}=None" for n in optional)] if optional else []
    shapes = ", ".join(f'"{a.name}": ({a.value.shape}, {_default(a)})' for a in function.inputs)
    given = ", ".join(f'"{a.name}": {a.name}' for a in function.inputs)
    p = "p" if function.needs_model else "None"
    return "\n".join(
        (
            f"def {function.name}({', '.join(arguments)}):",
            *_docstring(function),
            f"    shapes = {{{shapes}}}",
            f"    given = {{{given}}}",
            f"    return _call(_steps_{function.name}, {p}, shapes, given)",
        )
    )


def _default(argument: Argument) -> str:
    if argument.default is None:
        return "None"
    if argument.default is Default.HOME_Q:
        return "HOME_Q"
    value = "0.0" if argument.default is Default.ZEROS else "1.0"
    return f"({value},) * {argument.value.size}"


def _docstring(function: PublicFunction) -> list[str]:
    """What it does, its arguments and results with their shapes."""
    lines = [f'    """{function.meaning}', "", "    Args:"]
    for a in function.inputs:
        optional = {"": "", "zeros": "; default zeros", "ones": "; default ones"}
        note = optional.get(a.default or "", "; default those at home")
        lines.append(f"        {a.name}: {a.meaning} ({_shape(a)}){note}.")
    if function.needs_model:
        lines.append("        p: parameters, by default those of the specification.")
    lines += ["", "    Returns:"]
    lines += [f"        {_result(a)}" for a in function.outputs]
    return [*lines, '    """']


def _shape(argument: Argument) -> str:
    return ", ".join(("...", *argument.dimensions))


def _result(argument: Argument) -> str:
    return f"{argument.meaning} ({_shape(argument)})."
