"""Statements on arrays of any namespace, of a state s: the legs are a leading dimension."""

from __future__ import annotations

from typing import Any

import sympy as sp

from pne_sym.backends.python_text import PythonText
from pne_sym.backends.scalar import Dialect, ScalarPrinter
from pne_sym.backends.steps import StepText
from pne_sym.backends.straight import Forms

_NAMES = {"sqrt": "s.sqrt", "nonzero": "s.nonzero", "atan2": "s.atan2"}
_NAMES |= {"sin": "xp.sin", "cos": "xp.cos", "Abs": "abs", "Min": "xp.minimum"}
PRINTER = ScalarPrinter(Dialect(_NAMES, "{}"))
_nonzero = sp.Function("nonzero", real=True)


class Code(PythonText):
    """Writes functions of a program; roots and divisors go through the guards of s."""

    forms = Forms(
        prepared='s.prepared["{name}"]',
        entry="{vector}[{k}, ...]",
        legs="s.take({vector}, {places})",
        field='s.field("{field}")[{place}, ...]',
        signs="s.unbatched([{values}])",
        total="s.total({value}, {legs})",
        demand="s.require({good})",
        good={  # what is not finite is found where a function ends
            "unreachable": "{value} >= 0.0",
            "invalid": "{value} > 0.0",
            "singular": "{size} > {tolerance} * ({scale})",
        },
        tolerance={1: "s.tolerance", 2: "s.tolerance * s.tolerance"},
        store='stored["{array}"].append(({places}, {value}))',
        leg_store='stored["{array}"].append(({places}, {value}))',
    )

    def of(self, expr: Any) -> str:
        """A scalar expression."""
        guarded = sp.sympify(expr).replace(
            lambda e: e.is_Pow and e.exp.is_negative, lambda e: 1 / _nonzero(e.base**-e.exp)
        )
        return super().of(guarded)


class Steps(StepText):
    """Writes the steps of public functions."""

    expressions = {  # noqa: RUF012
        "multiply": "{0} * {1}",
        "entry": "{0}[{n}, ...]",
        "extend": "s.xp.concat(({0}, s.filled(0.0, ({rest},))))",
        "clear_at": "s.add_at({0}, -s.take({0}, {numbers}), {numbers})",
        "add_forces": "s.add_at({0}, {1}[:, None, ...] * {2}, {numbers})",
        "take_columns": "s.transposed(s.take(s.transposed({0}), {numbers}))",
        "unlimited": "s.add_at({0}, s.filled(s.xp.inf, ({count},)), {numbers})",
        "not_negative": "s.xp.astype(s.xp.all({0} >= 0.0, axis=0), s.dtype)",
        "dot": "s.xp.sum({0} * {1}, axis=0)",
        "inverse_root": "1.0 / s.nonzero(s.sqrt({0}))",
        "split": "{0}[:{n}, ...], {0}[{n}:, ...]",
        "join": "s.xp.concat(({0}, {1}))",
        "beside": "s.xp.concat(({0}, {1}), axis=1)",
        **dict.fromkeys(("scale", "scale_columns"), "{0} * {1}[None, ...]"),
        "impossible": "s.filled(s.xp.nan, {numbers})",
        "saddle": "s.xp.concat((s.xp.concat(({0}, -{1}), axis=1), s.xp.concat((s.transposed({1}), "
        "s.filled(0.0, ({1}.shape[1], {1}.shape[1]))), axis=1)))",
    }
    call = "s.{name}({operands})"
    apply = "{targets} = {value}"
    run = "{each}{comma} = _run_{function}(s, {inputs})"
    search = (
        "{target} = s.search(_steps_{residual}, [{start}{given}], "
        "_steps_{slope}, [{start}{guess}], {halving})"
    )
    closing = "q = s.closed(X, q0)"
    comment = "# {}"
