"""Public functions in NumPy: the steps as they stand, and the functions that users call."""

from __future__ import annotations

import textwrap

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.numpy_solve import elimination, table
from pne_sym.backends.orders import order_at_home
from pne_sym.backends.python_public import definition, rows
from pne_sym.backends.python_text import WIDTH, unpacked
from pne_sym.backends.scalar import wrap
from pne_sym.backends.steps import StepText
from pne_sym.program.ir import Program
from pne_sym.program.public import Apply, PublicFunction, Run, Step


class Steps(StepText):
    """Writes the steps of public functions, and the solutions of small systems that they call.

    Args:
        bundle: of the model.

    Attributes:
        orders: in which small systems are eliminated at home, each once.
    """

    expressions = {  # noqa: RUF012
        "multiply": "{0} * {1}",
        "entry": "{0}[{n}]",
        "impossible": "_impossible({n}, m.states)",
        "product": 'np.einsum("iks,kjs->ijs", {0}, {1})',
        "transposed": "np.swapaxes({0}, 0, 1)",
        "half_form": '0.5 * np.einsum("is,is->s", {0}, np.einsum("ijs,js->is", {1}, {0}))',
        "dot": "np.sum({0} * {1}, axis=0)",
        **dict.fromkeys(("scale", "scale_columns"), "{0} * {1}"),
        "inverse_root": "1.0 / np.sqrt({0})",
        "take": "{0}[{numbers}]",
        "take_columns": "{0}[:, {numbers}]",
        "beside": "np.concatenate(({0}, {1}), axis=1)",
        "join": "np.concatenate(({0}, {1}))",
        "split": "{0}[:{n}], {0}[{n}:]",
        **{name: f"_{name}({{0}}, {{n}})" for name in ("extend", "null_basis", "spread")},
        "resolve": "_resolve({0}, {1}, {n})",
    }
    call = "_{name}({operands})"
    apply = "{targets} = {value}"
    run = "{each}{comma} = m.run({function}, {arrays}, {inputs})"
    search = (
        "{target} = _search(m, _steps_{residual}, [{start}{given}], "
        "_steps_{slope}, [{start}{guess}], {halving})"
    )
    closing = "q = _closed(m, X, q0)"
    comment = "# {}"

    def __init__(self, bundle: Bundle) -> None:
        super().__init__(bundle.program)
        self.bundle, self.orders = bundle, dict[str, int]()
        self.judged = {n for f in self.functions.values() if f.gives_status for n in f.functions}
        self.function: PublicFunction | None = None

    def text(self, function: PublicFunction) -> str:
        """The steps as a function of a mode and all inputs, states last, which returns a tuple."""
        self.function = function
        lines = self.lines(function)
        outputs = ", ".join(output.value.name for output in function.outputs)
        inputs = ", ".join(("m", *(a.name for a in function.inputs)))
        body = textwrap.indent("\n".join([*lines, f"return ({outputs},)"]), "    ")
        return f"def _steps_{function.name}({inputs}):\n{body}"

    def _step(self, step: Step) -> list[str]:
        """Long lines on several ones; they end within brackets."""
        lines, width = list[str](), WIDTH - 4
        for line in super()._step(step):
            targets, value = line.split(" = ", 1)
            begins = line.find("(") < width
            parts = wrap(line, width, "    ") if begins else unpacked([targets], value, width)
            lines += parts
        return lines

    def called(self, function: str) -> str:
        """A function; where it tells why a state is impossible and nobody asks, only whether."""
        assert self.function is not None
        asks = function not in self.judged or self.function.gives_status
        return f"_run_{function}" if asks else f"_in_one(_run_{function})"

    def numbers(self, step: Apply) -> str:
        """A slice where places that are taken follow each other."""
        n = step.numbers
        if n and step.operation.startswith("take") and n == (*range(n[0], n[0] + len(n)),):
            return f"{n[0]}:{n[-1] + 1}"
        return super().numbers(step)

    def applied(self, step: Apply) -> str:
        """An operation; a system of equations in the order of home, where there is one."""
        if step.operation == "solve" and self.function:
            order = order_at_home(self.bundle, self.function, step)
            if order is not None:
                self.orders.setdefault(table(order), len(order.rows))
                matrix, right = (operand.name for operand in step.operands)
                place = list(self.orders).index(table(order))
                return f"_straight(m, {matrix}, {right}, _ORDERS[{place}])"
        return super().applied(step)

    def solvers(self) -> tuple[str, ...]:
        """The functions that solve systems, by size."""
        return tuple(elimination(n) for n in sorted(set(self.orders.values())))


_PLAIN = {"same", "add", "subtract", "negative", "times", "solve"}
"""Operations that single states do in lists of floats, without arrays."""


def _is_plain(function: PublicFunction) -> bool:
    """Whether a single state needs no arrays."""
    return (
        all(isinstance(s, Run) or _is_plain_step(s) for s in function.steps)
        and "q0" not in {a.name for a in function.inputs}
        and all(o.dimensions for o in function.outputs)
        and not (function.gives_status or function.unbounded)
    )


def _is_plain_step(step: Step) -> bool:
    if not isinstance(step, Apply):
        return False
    vectors = all(len(o.shape) == 1 for o in step.operands)
    return step.operation in _PLAIN and (vectors or step.operation in ("times", "solve"))


def public_text(program: Program, function: PublicFunction) -> str:
    """The function that users call."""
    p = "p" if function.needs_model else "None"
    call = ["return _call(", f'    "{function.name}", _steps_{function.name}, {p},']
    call += [f"    {row}" for row in rows(program, function)]
    call += ["    mode=_Judged,"] * function.gives_status
    call += ["    unbounded=True,"] * function.unbounded
    if _is_plain(function):
        shapes = ", ".join(f"({', '.join(o.dimensions)},)" for o in function.outputs)
        call.append(f"    plain=({shapes},),")
    return definition(function, [*call, ")"])
