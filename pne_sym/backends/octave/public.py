"""Public functions: the steps as they stand, and the functions that users call."""

from __future__ import annotations

import textwrap
from functools import reduce

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.octave.functions import column
from pne_sym.backends.steps import StepText, described
from pne_sym.program.public import Argument, Default, PublicFunction

EXPRESSIONS = {
    **dict.fromkeys(("multiply", "scale"), "{0} .* {1}"),
    "dot": "sum({0} .* {1}, 1)",
    "times": "{f}matrix_times({0}, {1})",
    "entry": "{0}({numbers}, :)",
    "extend": "[{0}; zeros({rest}, n)]",
    "take": "{0}({numbers}, :, :)",
    "take_columns": "{0}(:, {numbers}, :)",
    "transposed": "permute({0}, [2, 1, 3])",
    "beside": "cat(2, {0}, {1})",
    "join": "cat(1, {0}, {1})",
    "inverse_root": "1.0 ./ {f}root({0})",
    "scale_columns": "{0} .* reshape({1}, [1, size({1})])",
    "divide_rows": "{0}; {targets}({numbers}, :, :) = {targets}({numbers}, :, :) ./ "
    "reshape({1}, [1, 1, n])",
    "clear_at": "{0}; {targets}({numbers}, :) = 0",
    "add_at": "{0}; {targets}({numbers}, :) = {targets}({numbers}, :) + {1}",
    "unlimited": "{0}; {targets}({numbers}, :) = {targets}({numbers}, :) + Inf",
    "not_negative": "all({0} >= 0, 1) + 0 * sum({0}, 1)",
    "wrap_turns": "{0}; {targets}({numbers}, :) = pi - mod(pi - {targets}({numbers}, :), 2.0 * pi)",
    "saddle": "cat(1, cat(2, {0}, -{1}), cat(2, permute({1}, [2, 1, 3]), "
    "zeros(size({1}, 2), size({1}, 2), n)))",
    "singular_values": "{f}decomposed({0})",
    "impossible": "NaN({n}, n)",
    "split": "deal({0}(1:{n}, :, :), {0}({n} + 1:end, :, :))",
    "resolve": "{f}resolve({0}, {1}, {n})",
    "null_basis": "{f}null_basis({0}, {n})",
    "spread": "deal(prod({0}(1:{n}, :), 1), {f}where({0}(1, :) ~= 0, {0}({n}, :) ./ {0}(1, :), 0))",
    "least_entry": "min({0}, [], 1) + 0 ./ ~any(isnan({0}), 1)",
}
"""Operations that are more than a call of a function in templates/octave."""


class Public(StepText):
    """Writes steps as statements, and what users call as facts for the template."""

    apply = "{targets} = {value};"
    several, known, alone = "[{}]", "0 ./ ~isnan({})", "n"
    first = 1
    comment = "% {}"

    def __init__(self, bundle: Bundle) -> None:
        super().__init__(bundle.program)
        f = self.internal = f"{bundle.name}.internal."
        first = "\nstatus = status + (status == 0) .* found;"  # the first cause that is met stays
        self.expressions = {n: text.replace("{f}", f) for n, text in EXPRESSIONS.items()}
        self.call = f"{f}{{name}}({{operands}})"
        self.made = f"status = {f}flag(status, {{code}}, {{target}});"
        self.run = f"[{{each}}, found] = {f}run_{{function}}(model, {{inputs}});{first}"
        self.search = (
            f"[{{target}}, found] = {f}search_{{residual}}(model, {{start}}{{given}});{first}"
        )
        self.closing = f"[q, found] = {f}closed(model, X, q0);{first}"
        self.name, self.home_q = bundle.name, column(bundle.coordinates.home[1])

    def exported(self, function: PublicFunction) -> dict[str, object]:
        """What users call: names of arguments and results, help, the number of states."""
        names = [a.name for a in function.required] + ["p"] * function.needs_model
        taken = (function.name, *(a.name for a in function.inputs))
        results = ["value" if a.label in taken else a.label for a in function.outputs]
        told = [described(a.name, a, _shape(a)) for a in function.required]
        told += [f"p: parameters, by default {self.name}.parameters()."] * function.needs_model
        told += [described(a.name, a, _shape(a), "those at home") for a in function.optional]
        told += map(described, results, function.outputs, map(_shape, function.outputs))
        sizes = [f"size({a.name}, {len(_core(a)) + 1})" for a in function.required]
        sizes += [f"size({a.name}, 2) + isempty({a.name})" for a in function.optional]
        notes = (line for note in function.notes for line in textwrap.wrap(note, 92))
        return {
            "f": function,
            "names": [*names, *(a.name for a in function.optional)],
            "results": results,
            "help": [*notes, *told],
            "arguments": ["model"] * function.needs_model + [*map(self._argument, function.inputs)],
            "states": reduce(lambda a, b: f"{self.internal}states({a}, {b})", sizes),
        }

    def _argument(self, a: Argument) -> str:
        given = f"'{a.name}', {a.name}"
        if a.default is None:
            return f"{self.internal}argument({given}, {list(_core(a))}, n)"
        known = {Default.HOME_Q: self.home_q, Default.REST: "[reshape(eye(3), 9, 1); zeros(9, 1)]"}
        default = known.get(a.default, f"{a.default}({a.value.size}, 1)")
        return f"{self.internal}optional({given}, {default}, {str(a.positive).lower()}, n)"


def _shape(a: Argument) -> str:
    return " x ".join((*map(str, _core(a)), "n"))


def _core(a: Argument) -> tuple[int, ...]:
    """The shape of one state: a number is a column with one entry."""
    return a.value.shape or (1,)
