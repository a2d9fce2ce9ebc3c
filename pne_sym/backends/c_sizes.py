"""Names of sizes in C: what a manipulator has six of stands there as NV, NU or NL.

So a leg or a coordinate more changes a line where these are defined, and none where they are used.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pne_sym.backends.bundle import Bundle
from pne_sym.program.public import Apply, Argument, PublicFunction, Run, Value

_SQUARE = ("NV", "NV")
_ARRAYS = {
    "M": _SQUARE,
    "Z": ("NV",),
    "H": ("NV", "NU"),
    "Hk": ("NV", "NC"),
    "required": ("NV",),
    "leg_force": ("NL",),
    "drive": ("NU",),
    "constraint_direction": ("NC",),
    **dict.fromkeys(("q", "qd", "qdd", "margins", "joints"), ("NJ",)),
    **dict.fromkeys(("motor_rates", "per_turn"), ("NU",)),
    **dict.fromkeys(("legs", "reach", "pivots"), ("NL",)),
}
"""Dimensions of arrays of the program."""

Names = tuple[str, ...]


def sizes_of(bundle: Bundle) -> dict[str, int]:
    """Names of sizes, with those that users know; NL is the number of legs."""
    sizes = {n: k for n, k in bundle.coordinates.sizes.items() if len(n) == len("NV")}
    return {**sizes, "NL": sum(bundle.leg_counts.values())}


def count_of(leg_type: str) -> str:
    """The number of legs of a type."""
    return f"LEGS_OF_{leg_type}"


FEW = 4
"""Legs of a type whose numbers fill half of the longest vector."""


def one_state(bundle: Bundle, kind: str = "") -> str:
    """How functions of one state are declared: where legs are few, they keep to short vectors."""
    short = "NARROW" * (max(bundle.leg_counts.values()) <= FEW)
    return f"{short} {kind}".strip() if kind != "INLINE" else kind


def times(*factors: str | int) -> str:
    """A product.

    >>> times("NV + NC", 1, "LANES"), times(1), times(2, 3), times(0, "NV")
    ('(NV + NC)*LANES', '1', '6', '0')
    """
    number, names = 1, []
    for factor in map(str, factors):
        if factor.isdigit():
            number *= int(factor)
        else:
            names.append(f"({factor})" if " " in factor else factor)
    if not number:
        return "0"
    return "*".join([*([str(number)] if number != 1 or not names else []), *names])


def named(shape: Sequence[int], names: Iterable[str], sizes: dict[str, int]) -> Names:
    """Names of the sizes in a shape, or numbers where these do not fit."""
    known = [*names, *[""] * len(shape)]
    return tuple(
        name if sizes.get(name) == n else str(n) for n, name in zip(shape, known, strict=False)
    )


def array_names(bundle: Bundle, array: str) -> Names:
    """Dimensions of an array of the program."""
    return named(bundle.program.shapes[array], _ARRAYS.get(array, ()), sizes_of(bundle))


def extent(argument: Argument, sizes: dict[str, int]) -> str:
    """Number of entries of what users give or get."""
    return times(*named(argument.value.shape, argument.dimensions, sizes))


class Sizes:
    """Names of the sizes of the arrays of a public function."""

    def __init__(self, bundle: Bundle, function: PublicFunction) -> None:
        self.known = sizes_of(bundle)
        self.of: dict[str, Names] = {}
        for a in (*function.inputs, *function.outputs):
            self.of[a.name] = named(a.value.shape, a.dimensions, self.known)
        for step in function.steps:
            if isinstance(step, Run):
                arrays = bundle.program.functions[step.function].arrays
                for array, target in zip(arrays, step.targets, strict=True):
                    self.of[target.name] = array_names(bundle, array)
            elif isinstance(step, Apply):
                for target in step.targets:
                    self._infer(step, target)

    def names(self, value: Value) -> Names:
        """Of the dimensions of an array."""
        return self.of.get(value.name) or tuple(map(str, value.shape))

    def size(self, value: Value) -> str:
        """Number of entries of an array."""
        return times(*self.names(value))

    def name(self, number: int, values: Iterable[Value]) -> str:
        """A number as a size of these arrays, or the sum of two."""
        names = [n for v in values for n in self.names(v) if not n.isdigit()]
        sums = [f"{a} + {b}" for a in names for b in names if a != b and " " not in a + b]
        found = (n for n in (*names, *sums) if self._value(n) == number)
        return next(found, str(number))

    def _value(self, name: str) -> int:
        return sum(self.known[n] for n in name.split(" + "))

    def _infer(self, step: Apply, target: Value) -> None:
        """Sizes of a result are those of operands, in their order."""
        own = self.of.get(target.name, ())
        if own and not any(n.isdigit() for n in own):
            return
        first, last = step.operands[:1], step.operands[-1:]
        rows = self.names(first[0]) if first else ()
        if step.operation == "transposed":
            self.of[target.name] = rows[::-1]
            return
        likely = [(*rows[:1], *self.names(last[0])[1:]), rows] if rows else []
        names = []
        for k, n in enumerate(target.shape):
            fits = [x[k] for x in likely if k < len(x) and not x[k].isdigit()]
            fits = [x for x in fits if self._value(x) == n]
            names.append(fits[0] if fits else self.name(n, step.operands))
        self.of[target.name] = tuple(names)
