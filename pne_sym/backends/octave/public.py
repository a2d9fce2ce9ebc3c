"""Public functions: the steps as they stand, and the functions that users call."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Iterable

from pne_sym.backends.octave.text import MatlabText, column, define, indices
from pne_sym.program.interpret import inputs_read
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import (
    Apply,
    Argument,
    Default,
    PublicFunction,
    Run,
    Search,
    Step,
    Value,
)

_STATUS = (
    "%   status (1 x n): 0 OK, 1 unreachable, 2 singular, 3 invalid (an argument is not finite,",
    "%   no orientation), 4 not converged; other outputs are NaN unless it is 0.",
)
_EXPRESSIONS = {
    "add": "{0} + {1}",
    "subtract": "{0} - {1}",
    "same": "{0}",
    "negative": "-{0}",
    "multiply": "{0} .* {1}",
    "dot": "sum({0} .* {1}, 1)",
    "scale": "{0} .* {1}",
    "entry": "{0}({numbers}, :)",
    "impossible": "NaN({shape})",
    "extend": "[{0}; zeros({rest}, n)]",
    "take": "{0}({numbers}, :, :)",
    "take_columns": "{0}(:, {numbers}, :)",
    "transposed": "permute({0}, [2, 1, 3])",
    "beside": "cat(2, {0}, {1})",
    "join": "cat(1, {0}, {1})",
    "times": "{f}matrix_times({0}, {1})",
    "half_form": "0.5 * sum({0} .* {f}matrix_times({1}, {0}), 1)",
    "divide_rows": "{0}; {target}({numbers}, :, :) = {target}({numbers}, :, :) ./ "
    "reshape({1}, [1, 1, n])",
    "clear_at": "{0}; {target}({numbers}, :) = 0",
    "add_at": "{0}; {target}({numbers}, :) = {target}({numbers}, :) + {1}",
}
"""Operations that are an expression; the others are functions in templates/octave."""
_COUNTS = ("resolve", "null_basis")
"""Operations whose number is a rank, not a place."""


class Public(MatlabText):
    """Writes the steps of public functions, and what users call."""

    def steps(self, function: PublicFunction) -> str:
        """steps_NAME(model, inputs): the outputs, and the status."""
        functions = self.bundle.program.functions
        vector = function.inputs[0]
        lines = [
            f"n = size({vector.name}, {len(vector.value.shape) + 1});",
            "status = zeros(1, n);",
        ]
        read = inputs_read(self.bundle.program, function)
        lines += [self._blame(a.value, 3) for a in function.inputs if a.name in read]
        closed = False
        for step in function.steps:
            if isinstance(step, Run) and "q" in functions[step.function].inputs and not closed:
                lines += [f"[q, found] = {self.internal}closed(model, X, q0);"]
                lines += ["status(status == 0 & ~found) = 4;"]
                closed = True
            lines += self._step(step)
        for output in function.outputs:
            places = ", ".join([":"] * max(len(output.value.shape), 1))
            lines.append(f"{output.name}({places}, status ~= 0) = NaN;")
        outputs = ", ".join((*(a.name for a in function.outputs), "status"))
        inputs = ", ".join((*self._model(function), *(a.name for a in function.inputs)))
        head = f"[{outputs}] = steps_{function.name}({inputs})"
        return define(head, f"STEPS_{function.name.upper()}  {function.meaning}", lines)

    def _model(self, function: PublicFunction) -> list[str]:
        return ["model"] * function.needs_model

    def _blame(self, value: Value, status: int) -> str:
        return f"status = {self.internal}blame(status, {status}, {value.name});"

    def _step(self, step: Step) -> list[str]:
        first = "status = status + (status == 0) .* found;"
        if isinstance(step, Run):
            inputs = ", ".join(("model", *self.bundle.program.functions[step.function].inputs))
            found = ", ".join((*(t.name for t in step.targets), "found"))
            return [f"[{found}] = {self.internal}run_{step.function}({inputs});", first]
        if isinstance(step, Search):
            inputs = ", ".join(("model", step.start.name, *self.others(step.residual)))
            call = f"{self.internal}{search_name(step)}({inputs})"
            return [f"[{step.target.name}, found] = {call};", first]
        targets = [t.name for t in step.targets]
        target = targets[0] if len(targets) == 1 else f"[{', '.join(targets)}]"
        code = int(OPERATIONS[step.operation].status)
        applied = self._split(step) or [f"{target} = {self._applied(step)};"]
        return [*applied, *(self._blame(t, code) for t in step.targets)]

    def others(self, function: str) -> list[str]:
        """Inputs of a public function beside the pose."""
        (found,) = (f for f in self.bundle.program.public if f.name == function)
        return [a.name for a in found.inputs if a.name != "X"]

    def _split(self, step: Apply) -> list[str]:
        """The first entries, and the rest."""
        if step.operation != "split":
            return []
        (whole,), (first, rest), (n,) = step.operands, step.targets, step.numbers
        return [
            f"{first.name} = {whole.name}(1:{n}, :, :);",
            f"{rest.name} = {whole.name}({n + 1}:{whole.shape[0]}, :, :);",
        ]

    def _applied(self, step: Apply) -> str:
        """An operation at its operands."""
        operands = [operand.name for operand in step.operands]
        if step.operation in _EXPRESSIONS:
            shape = ", ".join(map(str, (*(step.targets[0].shape or (1,)), "n")))
            rest = step.targets[0].size - step.operands[0].size if step.operands else 0
            fixed = {"numbers": indices(step.numbers), "shape": shape, "rest": rest}
            of = {"f": self.internal, "target": step.targets[0].name}
            return _EXPRESSIONS[step.operation].format(*operands, **fixed, **of)
        if "numbers" in inspect.signature(OPERATIONS[step.operation].compute).parameters:
            is_count = step.operation in _COUNTS
            operands.append(str(step.numbers[0]) if is_count else indices(step.numbers))
        return f"{self.internal}{step.operation}({', '.join(operands)})"

    def exported(self, function: PublicFunction) -> str:
        """The function that users call."""
        names = [a.name for a in function.required] + ["p"] * function.needs_model
        names += [a.name for a in function.optional]
        results = [_result(a, function) for a in function.outputs]
        head = f"[{', '.join((*results, 'status'))}] = {function.name}({', '.join(names)})"
        start = len(function.required)
        lines = list(self._help(function, results, names))
        lines += [f"if nargin < {k + 1}, {n} = []; end" for k, n in enumerate(names) if k >= start]
        sizes = [f"size({a.name}, {len(_core(a)) + 1})" for a in function.required]
        sizes += [f"size({a.name}, 2) + isempty({a.name})" for a in function.optional]
        lines.append(f"n = {self.internal}states([{', '.join(sizes)}]);")
        if function.needs_model:
            lines.append(f"model = {self.internal}prepare(p);")
        arguments = self._model(function) + [self._argument(a) for a in function.inputs]
        call = f"{self.internal}steps_{function.name}({', '.join(arguments)})"
        lines.append(f"[{', '.join((*results, 'status'))}] = {call};")
        return define(head, f"{function.name.upper()}  {function.meaning}", lines)

    def _argument(self, a: Argument) -> str:
        if a.default is None:
            shape = f"[{', '.join(map(str, _core(a)))}]"
            return f"{self.internal}argument('{a.name}', {a.name}, {shape}, n)"
        size, positive = a.value.size, str(a.positive).lower()
        default = {
            Default.ZEROS: f"zeros({size}, 1)",
            Default.ONES: f"ones({size}, 1)",
            Default.HOME_Q: column(self.bundle.coordinates.home[1]),
        }[a.default]
        return f"{self.internal}optional('{a.name}', {a.name}, {default}, {positive}, n)"

    def _help(
        self, function: PublicFunction, results: list[str], names: list[str]
    ) -> Iterable[str]:
        outputs = ", ".join((*results, "status"))
        yield "%"
        yield f"%   [{outputs}] = {self.bundle.name}.{function.name}({', '.join(names)})"
        yield "%"
        for note in function.notes:
            yield from (f"%   {line}" for line in textwrap.wrap(note, 92))
        for a in function.required:
            yield f"%   {a.name} ({_shape(a)}): {a.meaning}."
        if function.needs_model:
            yield f"%   p: parameters, by default those of {self.bundle.name}.parameters()."
        for a in function.optional:
            yield f"%   {a.name} ({_shape(a)}): {a.meaning}; by default {a.default}."
        for name, a in zip(results, function.outputs, strict=True):
            yield f"%   {name} ({_shape(a)}): {a.meaning}."
        yield from _STATUS
        yield "%   n states side by side; an argument of one column counts for all of them."
        if len(names) > len(function.required):
            yield "%   [] stands for a default."


def expressions() -> frozenset[str]:
    """Names of the operations that are expressions or statements, searches among them."""
    return frozenset((*_EXPRESSIONS, "split", "search"))


def search_name(step: Search) -> str:
    """Name of the function that searches."""
    return f"search_{step.residual}"


def _result(a: Argument, function: PublicFunction) -> str:
    """The name that users know, unless it is the function's or an argument's own."""
    taken = (function.name, *(i.name for i in function.inputs))
    return "value" if a.label in taken else a.label


def _shape(a: Argument) -> str:
    return " x ".join((*map(str, a.value.shape or (1,)), "n"))


def _core(argument: Argument) -> tuple[int, ...]:
    """The shape of one state: a number is a column with one entry."""
    return argument.value.shape or (1,)
