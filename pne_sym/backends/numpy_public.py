"""Public functions in NumPy: the steps as they stand, and the functions that users call."""

from __future__ import annotations

import textwrap

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.numpy_solve import elimination, table
from pne_sym.backends.orders import order_at_home
from pne_sym.backends.python_public import definition, rows
from pne_sym.backends.python_text import WIDTH, unpacked
from pne_sym.backends.scalar import wrap
from pne_sym.backends.steps import COMMON, Citations
from pne_sym.program.ir import Program
from pne_sym.program.public import Apply, PublicFunction, Run, Search, Step

_EXPRESSIONS = {
    **COMMON,
    "multiply": "{0} * {1}",
    "entry": "{0}[{n}]",
    "impossible": "_impossible({n}, m.states)",
    "product": 'np.einsum("iks,kjs->ijs", {0}, {1})',
    "transposed": "np.swapaxes({0}, 0, 1)",
    "half_form": '0.5 * np.einsum("is,is->s", {0}, np.einsum("ijs,js->is", {1}, {0}))',
    "dot": "np.sum({0} * {1}, axis=0)",
    "scale": "{0} * {1}",
    "scale_columns": "{0} * {1}",
    "inverse_root": "1.0 / np.sqrt({0})",
    "extend": "_extended({0}, {n})",
    "take": "{0}[{places}]",
    "take_columns": "{0}[:, {places}]",
    "add_at": "_added_at({0}, {1}, {numbers})",
    "clear_at": "_cleared_at({0}, {numbers})",
    "beside": "np.concatenate(({0}, {1}), axis=1)",
    "join": "np.concatenate(({0}, {1}))",
    "split": "{0}[:{n}], {0}[{n}:]",
    "add_forces": "_with_forces({0}, {1}, {2}, {numbers})",
    "wrap_turns": "_wrapped({0}, {numbers})",
    "unlimited": "_unlimited({0}, {numbers})",
    "divide_rows": "_rows_divided({0}, {1}, {numbers})",
    "choose_length": "_chosen_length({0}, {1})",
    "resolve": "_resolve({0}, {1}, {n})",
    "null_basis": "_null_basis({0}, {n})",
    "spread": "_spread({0}, {n})",
    "turn_quaternion": "_turned({0}, {1})",
}
"""Operations that are more than a call of a function of their name in templates/numpy."""
_CALLED = (
    "times", "not_negative", "solve", "saddle", "least_norm", "singular_values", "least_entry",
    "factors_within", "factors_of_some", "nearest_within", "rotation_of_quaternion",
    "quaternion_of_rotation", "angle_of_rotation", "rotation_of_angle", "quaternion_of_rpy",
    "quaternion_rate", "turn_between",
)  # fmt: skip
OPERATIONS = frozenset((*_EXPRESSIONS, *_CALLED, "search"))


class Orders:
    """The orders in which small systems are eliminated at home, each once.

    Args:
        bundle: of the model.
    """

    def __init__(self, bundle: Bundle) -> None:
        self.bundle = bundle
        self.tables: list[str] = []
        self.sizes = set[int]()

    def named(self, function: PublicFunction, step: Apply) -> str:
        """The order of a system of a function, as code; empty where there is none."""
        order = order_at_home(self.bundle, function, step)
        if order is None:
            return ""
        self.sizes.add(len(order.rows))
        text = table(order)
        if text not in self.tables:
            self.tables.append(text)
        return f"_ORDERS[{self.tables.index(text)}]"

    def functions(self) -> tuple[str, ...]:
        """The functions that solve systems, by size."""
        return tuple(elimination(n) for n in sorted(self.sizes))


def steps_text(program: Program, function: PublicFunction, orders: Orders) -> str:
    """The steps as a function of a mode and all inputs, states last, which returns a tuple."""
    judged = set() if function.gives_status else judged_functions(program)
    lines, cited = list[str](), Citations(program, "# {}")
    for step in function.steps:
        if isinstance(step, Apply):
            order = orders.named(function, step) if step.operation == "solve" else ""
            targets = ", ".join(target.name for target in step.targets)
            text = _wrapped(f"{targets} = {applied(step, order)}")
        else:
            text = _step(program, step, judged)
        lines += cited.lines(step, text)
    if _closes(program, function):
        lines.insert(0, "q = _closed(m, X, q0)")
    outputs = ", ".join(output.value.name for output in function.outputs)
    head = f"def _steps_{function.name}({', '.join(('m', *(a.name for a in function.inputs)))}):"
    return "\n".join((head, textwrap.indent("\n".join([*lines, f"return ({outputs},)"]), "    ")))


def _closes(program: Program, function: PublicFunction) -> bool:
    """Whether displacements are iterated first."""
    runs = (s for s in function.steps if isinstance(s, Run))
    return any("q" in program.functions[s.function].inputs for s in runs)


def judged_functions(program: Program) -> set[str]:
    """Functions of the program that tell why a state is impossible."""
    return {n for f in program.public if f.gives_status for n in f.functions}


def _step(program: Program, step: Run | Search, judged: set[str]) -> list[str]:
    if isinstance(step, Run):
        names = [target.name for target in step.targets]
        function = program.functions[step.function]
        arrays = ", ".join(f'"{array}"' for array in function.arrays)
        arrays = f"({arrays}{',' * (len(function.arrays) == 1)})"
        run = f"_run_{step.function}"
        run = f"_in_one({run})" if step.function in judged else run
        given = ", ".join((run, arrays, *function.inputs))
        return unpacked(names, f"m.run({given})", WIDTH - 4)
    inputs_of = {f.name: [a.name for a in f.inputs if a.name != "X"] for f in program.public}
    given, guess = (f"({''.join(f'{n}, ' for n in inputs_of[n])})".replace(", )", ",)")
                    for n in (step.residual, step.slope))  # fmt: skip
    functions = f"_steps_{step.residual}, _steps_{step.slope}"
    arguments = f"{functions}, {step.operands[0].name}, {given}, {guess}, {step.halving}"
    return _wrapped(f"{step.targets[0].name} = _search(m, {arguments})")


def _wrapped(line: str) -> list[str]:
    return wrap(line, WIDTH - 4, "    ")


def applied(step: Apply, order: str = "") -> str:
    """An operation at its operands; for a system of equations, in an order where there is one."""
    operands = [operand.name for operand in step.operands]
    if order:
        return f"_straight(m, {', '.join(operands)}, {order})"
    if step.operation == "extend" and step.operands[0].shape == step.targets[0].shape:
        return operands[0]
    form = _EXPRESSIONS.get(step.operation, f"_{step.operation}({', '.join(operands)})")
    return form.format(
        *operands,
        n=(*step.numbers, 0)[0],
        numbers=list(step.numbers),
        places=_places(step.numbers),
    )


def _places(numbers: tuple[int, ...]) -> str:
    """A slice where places follow each other, else a list."""
    if numbers and numbers == tuple(range(numbers[0], numbers[0] + len(numbers))):
        return f"{numbers[0]}:{numbers[-1] + 1}" if len(numbers) > 0 else "[]"
    return str(list(numbers))


_PLAIN = {"same", "add", "subtract", "negative", "times", "solve"}
"""Operations that single states do in lists of floats, without arrays."""


def _is_plain(program: Program, function: PublicFunction) -> bool:
    """Whether a single state needs no arrays."""
    return (
        all(isinstance(s, Run) or _is_plain_step(s) for s in function.steps)
        and not _closes(program, function)
        and all(o.dimensions for o in function.outputs)
        and not (function.gives_status or function.unbounded)
    )


def _is_plain_step(step: Step) -> bool:
    if not isinstance(step, Apply):
        return False
    if step.operation == "extend":
        return step.operands[0].shape == step.targets[0].shape
    vectors = all(len(o.shape) == 1 for o in step.operands)
    return step.operation in _PLAIN and (vectors or step.operation in ("times", "solve"))


def public_text(program: Program, function: PublicFunction) -> str:
    """The function that users call."""
    p = "p" if function.needs_model else "None"
    call = ["return _call(", f'    "{function.name}", _steps_{function.name}, {p},']
    call += [f"    {row}" for row in rows(program, function)]
    call += ["    mode=_Judged,"] * function.gives_status
    call += ["    unbounded=True,"] * function.unbounded
    if _is_plain(program, function):
        shapes = ", ".join(f"({', '.join(o.dimensions)},)" for o in function.outputs)
        call.append(f"    plain=({shapes},),")
    return definition(function, [*call, ")"])
