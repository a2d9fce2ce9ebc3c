"""Operation counts, against running the generated code with numbers that count."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import Any

import pytest
import sympy as sp

from pne_sym.program.count import count_expression, count_function
from pne_sym.program.ir import Counts, Function
from tests.models import bundle, catalogue, manifest, source
from tests.sampling import SAMPLE, entries, sampled


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


class Mode:
    """What the generated code runs in: it goes over the legs one after another."""

    def __init__(self, tally: Tally, shared: int, loops: list[tuple[int, int]]) -> None:
        self.tally, self.shared, self.loops = tally, shared, loops
        self.sqrt = lambda x: x._after("sqrt")
        self.sin = self.cos = lambda x: x._after("trig")
        self.atan2 = lambda y, x: Number(tally)._after("trig")
        self.least = lambda x, y: Number(tally)._after("add")

    def zeros(self, name: str) -> list[Any]:
        assert name
        return [None] * 500

    def constants(self, name: str) -> Any:
        """Shared values, and values of every leg of each loop."""
        assert name
        return self._numbers(self.shared), [
            [(leg, self._numbers(size)) for leg in range(count)] for count, size in self.loops
        ]

    def _numbers(self, size: int) -> list[Number]:
        return [Number(self.tally)] * size


_FLAGS = ("ok", "valid", "reached", "clear")


class Stripped(ast.NodeTransformer):
    """Code without guards, and without the naming of inputs, which are counted apart."""

    def __init__(self, named: set[str]) -> None:
        self.dropped = {*named, *_FLAGS}

    def visit_Assign(self, node: ast.Assign) -> ast.Assign | None:
        (target,) = node.targets
        return None if isinstance(target, ast.Name) and target.id in self.dropped else node


def unpacked(code: ast.AST, argument: str) -> list[int]:
    """How many values are unpacked from a name, wherever that is done."""
    return [
        len(node.targets[0].elts)
        for node in ast.walk(code)
        if isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Name)
        and node.value.id == argument
        and isinstance(node.targets[0], ast.Tuple)
    ]


def measured(text: str, function: Function, legs: dict[str, int]) -> Tally:
    """Operations of a computation, by running its code."""
    name, tally = f"_run_{function.name}", Tally()
    named = {str(a.target) for a in function.unpack}
    (code,) = (n for n in ast.parse(text).body if isinstance(n, ast.FunctionDef) and n.name == name)
    stripped = ast.fix_missing_locations(ast.Module([Stripped(named).visit(code)], []))
    scope: dict[str, Any] = {n: Number(tally) for n in named} | dict.fromkeys(_FLAGS, True)
    legs_of = [(a, t) for a in function.arrays for t in legs]
    scope |= {f"_{array}_{leg_type}": [range(legs[leg_type])] * 50 for array, leg_type in legs_of}
    exec(compile(stripped, name, "exec"), scope)
    counts = [legs[block.leg_type] for block in function.blocks if block.leg_type]
    loops = list(zip(counts, unpacked(code, "k"), strict=True))
    mode = Mode(tally, sum(unpacked(code, "shared")), loops)
    scope[name](mode, *([Number(tally)] * 50 for _ in function.inputs))
    assert not tally.powers
    return tally


@pytest.mark.parametrize("name", sampled(SAMPLE, 3))
def test_counts_are_those_of_the_code(name: str) -> None:
    manipulator = catalogue(name)
    compiled, text = bundle(manipulator), source(manipulator)
    for function in compiled.program.functions.values():
        counted = count_function(function, compiled.leg_counts)
        assert counted.total > 0
        assert measured(text, function, compiled.leg_counts).counts() == counted, function.name
        stated = manifest(manipulator)["operations"][function.name]
        assert Counts(*(stated[k] for k in ("mul", "add", "div", "sqrt", "trig"))) == counted
        comment = (
            f"# {function.name}: {counted.mul} mul, {counted.add} add, {counted.div} div, "
            f"{counted.sqrt} sqrt, {counted.trig} trig\n"
        )
        assert comment in text


CEILINGS = {
    "delta": (1392, 1023),
    "fivebar_offset": (340, 266),
    "fivebar_prismatic": (166, 144),
    "fivebar_redundant": (347, 290),
    "fivebar_revolute": (336, 280),
    "hexaglide": (3211, 2145),
    "hexapod_6rus": (3721, 2583),
    "hexapod_6ucu": (6480, 3843),
    "hexapod_6uhs": (4447, 2925),
    "hexapod_6x6r": (18828, 9879),
    "hybrid_3crs": (1861, 1341),
    "hybrid_3prps": (1012, 744),
    "hybrid_3rrrs": (2323, 1725),
    "hybrid_3rrrs_redundant": (2686, 1958),
    "planar_3prr": (580, 417),
    "planar_3rpr": (391, 309),
    "planar_3rrr": (643, 513),
    "planar_4rpr": (514, 403),
    "planar_4rpr_free": (520, 403),
    "planar_mixed": (556, 419),
    "planar_redundant": (717, 551),
    "quadrupod": (3064, 2032),
    "sixbar": (454, 365),
    "spherical_3ups": (1353, 969),
    "stewart": (2713, 1887),
    "stewart_7ups": (3140, 2175),
    "stewart_7ups_free": (3159, 2172),
    "stewart_sps": (3727, 2367),
    "tricept": (2637, 1744),
    "tripod_3prs": (1234, 858),
    "tripod_3rps": (1006, 711),
    "tripod_3ups": (858, 675),
    "tripod_3upu": (1986, 1407),
}
"""Operations of `dynamics` and of `required`, roots and divisions included."""


@pytest.mark.parametrize("name", entries(3, keep=("stewart",)))
def test_operations_do_not_grow(name: str) -> None:
    compiled = bundle(catalogue(name))
    for function, most in zip(("dynamics", "required"), CEILINGS[name], strict=True):
        counted = count_function(compiled.program.functions[function], compiled.leg_counts)
        assert counted.total <= most, function


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
