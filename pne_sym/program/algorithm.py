"""Steps of a public function under construction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from pne_sym.program.ir import Program
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Run, Step, Value


class Algorithm:
    """Steps under construction; arrays get names of their own."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._made = Counter[str]()

    def run(self, function: str, program: Program, *wanted: str) -> list[Value]:
        """Run a function of the program; returns some of its arrays."""
        arrays = program.functions[function].arrays
        values = {a: Value(f"{a}_of_{function}", program.shapes[a]) for a in arrays}
        self.steps.append(Run(function, tuple(values.values())))
        return [values[a] for a in wanted]

    def apply(self, operation: str, *operands: Value, numbers: Iterable[int] = ()) -> Value:
        """Apply an operation with one result."""
        (value,) = self.apply_all(operation, *operands, numbers=numbers)
        return value

    def apply_all(
        self, operation: str, *operands: Value, numbers: Iterable[int] = ()
    ) -> tuple[Value, ...]:
        """Apply an operation."""
        fixed = tuple(numbers)
        targets = []
        for shape in OPERATIONS[operation].shapes(tuple(o.shape for o in operands), fixed):
            targets.append(Value(self._name(operation, operands, fixed), shape))
        self.steps.append(Apply(operation, operands, tuple(targets), fixed))
        return tuple(targets)

    def _name(self, operation: str, operands: tuple[Value, ...], numbers: tuple[int, ...]) -> str:
        """A name that other steps do not change: a part by its place, others counted."""
        part = operation == "take" and numbers and len(operands[0].shape) == 1
        name = f"{operands[0].name}_from_{numbers[0]}" if part else operation
        self._made[name] += 1
        return name if part and self._made[name] == 1 else f"{name}_{self._made[name]}"
