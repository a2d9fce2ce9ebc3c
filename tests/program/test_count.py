"""Operation counts, against running the generated code with numbers that count."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import pytest
import sympy as sp

from pne_sym.program.count import count_expression, count_function
from pne_sym.program.ir import Counts
from tests.models import bundle, catalogue, manifest, source
from tests.whole.supported import SAMPLE


@dataclass
class Tally:
    """Operations done so far."""

    mul: int = 0
    add: int = 0
    div: int = 0
    sqrt: int = 0
    trig: int = 0
    powers: list[object] = field(default_factory=list)

    def counts(self) -> Counts:
        return Counts(self.mul, self.add, self.div, self.sqrt, self.trig)


class Number:
    """A number of no particular value; changing its sign is free."""

    def __init__(self, tally: Tally) -> None:
        self.tally = tally

    def _after(self, operation: str) -> Number:
        setattr(self.tally, operation, getattr(self.tally, operation) + 1)
        return self

    def __add__(self, other: object) -> Number:
        return self._after("add")

    def __mul__(self, other: object) -> Number:
        return self._after("mul")

    def __truediv__(self, other: object) -> Number:
        return self._after("div")

    __radd__ = __sub__ = __rsub__ = __add__
    __rmul__ = __mul__
    __rtruediv__ = __truediv__

    def __neg__(self) -> Number:
        return self

    __abs__ = __neg__

    def __pow__(self, exponent: object) -> Number:
        self.tally.powers.append(exponent)
        return self


class Functions:
    """What the generated code calls."""

    def __init__(self, tally: Tally) -> None:
        self.sqrt = lambda x: x._after("sqrt")
        self.sin = self.cos = lambda x: x._after("trig")
        self.atan2 = lambda y, x: Number(tally)._after("trig")
        self.least = lambda x, y: Number(tally)._after("add")


_TEXT = re.compile(r"^def (_\w+)\((.*)\):\n((?:    .*\n|\n)+)", re.MULTILINE)
_UNPACK = re.compile(
    r"    # [XVA]: named entries\n(?:    [^#\n].*\n)*?(?=    #|    ok = |    return)"
)


def straight_line_code(text: str, name: str) -> dict[str, str]:
    """The functions of one computation, without guards and without the naming of inputs."""
    found = {}
    for match in _TEXT.finditer(text):
        if re.fullmatch(rf"_{name}_\w+", match.group(1)):
            body = re.sub(r"^    ok = .*$", "    ok = True", match.group(3), flags=re.MULTILINE)
            body = _UNPACK.sub("", body)
            found[match.group(1)] = f"def {match.group(1)}({match.group(2)}):\n{body}"
    return found


def defined(code: str, tally: Tally) -> Any:
    """One function, with the names that the cut-out naming of inputs would have made."""
    scope: dict[str, Any] = {
        f"{stem}_{a}": Number(tally)
        for stem in ("t", "t_dot", "t_ddot", "omega", "alpha")
        for a in "xyz"
    }
    scope |= {f"R_{a}{b}": Number(tally) for a in "xyz" for b in "xyz"}
    exec(code, scope)
    return scope[code[len("def ") : code.index("(")]]


def unpacked(code: str, argument: str) -> int:
    """How many values a function unpacks from one of its arguments."""
    names = re.search(rf"^    (?:\(\n)?([^()=]*?),?\s*\)? = {argument}$", code, re.MULTILINE)
    return len(names.group(1).split(",")) if names else 0


def measured(text: str, name: str, legs: dict[str, int]) -> Tally:
    """Operations of a computation, by running its code."""
    total = Tally()
    for function, code in straight_line_code(text, name).items():
        tally = Tally()
        signature = code[code.index("(") + 1 : code.index(")")].split(", ")
        arguments: list[Any] = [
            [Number(tally)] * unpacked(code, a) if a != "f" else Functions(tally) for a in signature
        ]
        for k, a in enumerate(signature):
            if a in ("X", "V", "A"):
                arguments[k] = [Number(tally)] * 50
        result = defined(code, tally)(*arguments)
        times = legs.get(function.removeprefix(f"_{name}_"), 1)
        sums = len(result[1]) if function.removeprefix(f"_{name}_") in legs else 0
        assert not tally.powers
        for operation in ("mul", "add", "div", "sqrt", "trig"):
            done = getattr(tally, operation) + (sums if operation == "add" else 0)
            setattr(total, operation, getattr(total, operation) + times * done)
    return total


@pytest.mark.parametrize("name", SAMPLE)
def test_counts_are_those_of_the_code(name: str) -> None:
    manipulator = catalogue(name)
    compiled, text = bundle(manipulator), source(manipulator)
    for function in compiled.program.functions.values():
        counted = count_function(function, compiled.leg_counts)
        assert counted.total > 0
        assert measured(text, function.name, compiled.leg_counts).counts() == counted, function.name
        stated = manifest(manipulator)["operations"][function.name]
        assert Counts(*(stated[k] for k in ("mul", "add", "div", "sqrt", "trig"))) == counted
        comment = (
            f"# {function.name}: {counted.mul} mul, {counted.add} add, {counted.div} div, "
            f"{counted.sqrt} sqrt, {counted.trig} trig\n"
        )
        assert comment in text


def test_counts_of_expressions() -> None:
    x, y, z = sp.symbols("x y z", real=True)
    cases: list[tuple[Any, Counts]] = [
        (x, Counts()),
        (-x, Counts()),
        (2 * x, Counts(mul=1)),
        (x + y - z, Counts(add=2)),
        (-x * y, Counts(mul=1)),
        (x * y * z, Counts(mul=2)),
        (x / y, Counts(div=1)),
        (1 / y, Counts(div=1)),
        (x * z / y, Counts(mul=1, div=1)),
        (x**2, Counts(mul=1)),
        (x**3, Counts(mul=2)),
        (sp.sqrt(x), Counts(sqrt=1)),
        (1 / sp.sqrt(x), Counts(sqrt=1, div=1)),
        (sp.sin(x + y), Counts(add=1, trig=1)),
        (sp.atan2(x * y, z), Counts(mul=1, trig=1)),
        (x * (y + z) ** 2, Counts(mul=2, add=1)),
    ]
    for expr, expected in cases:
        assert count_expression(expr) == expected, expr
    with pytest.raises(ValueError, match="no power 1/3"):
        count_expression(x ** sp.Rational(1, 3))


def test_totals() -> None:
    counts = Counts(1, 2, 3, 4, 5)
    assert counts.total == 10
    assert counts + counts == counts.times(2) == Counts(2, 4, 6, 8, 10)
