"""Kernels in MATLAB: arrays as they are, states in the last dimension."""

from __future__ import annotations

from pne_sym.backends.kernels import KernelText
from pne_sym.program.linear import PIVOT


class Kernels(KernelText):
    """Writes definitions of templates/kernels."""

    operators = {"*": ".*", "/": "./", "!=": "~="}  # noqa: RUF012
    calls = {  # noqa: RUF012
        **{name: f"{name}({{0}}, 1)" for name in ("sum", "any", "all")},
        **{name: f"{name}({{0}}, [], 1)" for name in ("max", "min")},
        **{name: f"{name}({{0}})" for name in ("abs", "isfinite", "sqrt", "sin", "cos")},
        **dict.fromkeys(("number", "_constant"), "{0}"),
        "minimum": "min({0}, {1})",
        "maximum": "max({0}, {1})",
        "atan2": "atan2({0}, {1})",
        "cross": "cross({0}, {1}, 1)",
        "concat": "cat(1, {operands})",
        "outer": "reshape({0}, [size({0}, 1), 1, size({0}, 2)]) .* reshape({1}, [1, size({1})])",
        "times": "{f}matrix_times({operands})",
        "eye": "((1:size({0}, 1))' == 1:size({0}, 1))",
        "length": "size({0}, 1)",
        "transposed": "permute({0}, [2, 1, 3])",
        "stack": "reshape(cat(1, {operands}), [size({0}, 1), {count}, size({0}, 2)])",
        "inf": "Inf",
        "tiny": "0.0",
        "pivot": repr(PIVOT),
    }
    other = "{f}{name}({operands})"
    entries = "{array}({first}:{last}, :)"
    end = "end"
    column = "reshape({array}(:, {k}, :), [size({array}, 1), size({array}, 3)])"
    assign = "{targets} = {value};"
    several, tuple_of, ignored = "[{}]", "deal({})", "~"
    repeat = (
        "for turn = 1:{count}",
        "    [{state}] = {f}{name}({state}, {fixed});",
        "    if ~any({going}), break, end",
        "end",
    )
