"""Steps of a public function under construction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

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
        if "rotor_roots" in values:
            values |= self._with_rotors(values)
        return [values[a] for a in wanted]

    def _with_rotors(self, values: Mapping[str, Value]) -> dict[str, Value]:
        """M, Z and the required force with the rotors of coupled motors, of those that are there.

        Column m of G = H C^T is what a unit torque of motor m does.  With inertias J along the
        motors, G J G^T is added to M, and G J C qdd to the force, of which Z has the part
        without A.
        """
        found = {}
        columns = self.apply("product", values["H"], self.apply("transposed", values["coupling"]))
        columns = self.apply("scale_columns", columns, values["rotor_roots"])
        if "M" in values:
            both = self.apply("product", columns, self.apply("transposed", columns))
            found["M"] = self.apply("add", values["M"], both)
        for array, motion in (
            ("Z", "actuated_bias"),
            ("required", "actuated_accelerations"),
        ):
            if array in values and motion in values:
                load = self.apply("times", columns, self._of_rotors(values, motion))
                found[array] = self.apply("add", values[array], load)
        return found

    def _of_rotors(self, values: Mapping[str, Value], motion: str) -> Value:
        """Torques of the rotors over the roots of their inertias."""
        turning = self.apply("times", values["coupling"], values[motion])
        return self.apply("multiply", values["rotor_roots"], turning)

    def without_rotors(self, tau: Value, values: Mapping[str, Value]) -> Value:
        """What is left of actuator forces to the legs when coupled rotors are accelerated."""
        if "rotor_roots" not in values:
            return tau
        torques = self._of_rotors(values, "actuated_accelerations")
        torques = self.apply("multiply", values["rotor_roots"], torques)
        taken = self.apply("times", self.apply("transposed", values["coupling"]), torques)
        return self.apply("subtract", tau, taken)

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
