"""Functions of a program: straight-line code over rows of states, legs in the first dimension.

What is written is MATLAB, in the part of the language that Octave has too.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.scalar import Dialect, ScalarPrinter
from pne_sym.backends.straight import Forms, StraightText
from pne_sym.program.evaluate import TOLERANCE


class Code(StraightText):
    """Writes statements; values are L x n over legs and states, 1 x n over states."""

    comment = "%"
    forms = Forms(
        assign="{name} = {value};",
        prepared="model.{name}",
        entry="{vector}({k}, :)",
        legs="{vector}({places}, :)",
        field="given.{field}({place})",
        leg_field="reshape(given.{field}({place}, :), [{legs}, 1])",
        signs="[{values}]'",
        total="sum(({value}) + zeros({legs}, 1), 1)",
        demand="{status} = {status} | any(~({good}), 1);",  # a state fails where a leg fails
        good={
            "unreachable": "{value} >= 0",
            "invalid": "{value} > 0 & isfinite({value})",
            "singular": "{size} > {tolerance} * ({scale})",
        },
        tolerance={power: repr(TOLERANCE**power) for power in (1, 2)},
        store="flat_{array}({places}, :) = {value};",
        leg_store="flat_{array}({places}, :) = ({value}) + zeros({legs}, n);",
        first=1,
    )

    def __init__(self, bundle: Bundle) -> None:
        own = {"sqrt": "root", "acos": "arccos", "Min": "least"}
        names = {name: f"{bundle.name}.internal.{mine}" for name, mine in own.items()}
        names |= {"Abs": "abs", "sin": "sin", "cos": "cos", "atan2": "atan2"}
        super().__init__(bundle, ScalarPrinter(Dialect(names, "{}")))

    def of(self, expr: Any) -> str:
        """A scalar expression, entry by entry; no name begins with an underscore."""
        text = super().of(expr).replace("*", ".*").replace("/", "./")
        return re.sub(r"\b_", "tmp_", text)


def column(values: Iterable[float]) -> str:
    """Numbers in a column; shortest digits that read back the same."""
    return f"[{'; '.join(repr(float(v) + 0.0) for v in values)}]"
