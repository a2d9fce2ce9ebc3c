"""Steps of a public function under construction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from pne_sym.program.ir import Program
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Run, Step, Value
from pne_sym.vector.arrays import Applied


class Algorithm:
    """Steps under construction; arrays get names of their own."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._made = Counter[str]()

    def run(self, function: str, program: Program, *wanted: str) -> list[Value]:
        """Run a function of the program; returns some of its arrays, those that it has."""
        values = self.run_all(function, program)
        return [values[a] for a in wanted if a in values]

    def run_all(self, function: str, program: Program) -> dict[str, Value]:
        """Run a function of the program; returns its arrays by name."""
        arrays = program.functions[function].arrays
        values = {a: Value(f"{a}_of_{function}", program.shapes[a]) for a in arrays}
        self.steps.append(Run(function, tuple(values.values())))
        if "rotor_roots" in values:
            values |= self._with_rotors(program, values)
        return values

    def _with_rotors(self, program: Program, values: dict[str, Value]) -> dict[str, Value]:
        """M, Z and the required force with coupled rotors, of those that are there."""
        found = {}
        for array, needed in (
            ("M", "H"),
            ("Z", "actuated_bias"),
            ("required", "actuated_accelerations"),
        ):
            if array in values and needed in values:
                id_ = f"{array}_rotors"
                load = self.relate(program, id_, values)
                found[array] = self.apply("add", values[array], load, equation=id_)
        return found

    def without_rotors(self, program: Program, tau: Value, values: dict[str, Value]) -> Value:
        """What is left of actuator forces to the legs when coupled rotors are accelerated."""
        if "rotor_roots" not in values:
            return tau
        taken = self.relate(program, "tau_rotors", values)
        return self.apply("subtract", tau, taken, equation="tau_rotors")

    def relate(self, program: Program, id_: str, values: dict[str, Value]) -> Value:
        """The steps of a relation between arrays, and of those that it uses.

        Args:
            program: has the relations.
            id_: of the relation.
            values: arrays that there are; those that are made join them.
        """
        if id_ not in values:
            (relation,) = (r for r in program.relations if r.id == id_)
            known = {r.id for r in program.relations}
            for name in relation.uses:
                if name in known:
                    self.relate(program, name, values)
            values[id_] = self._evaluated(relation.rhs, values, id_, name=id_)
        return values[id_]

    def _evaluated(
        self, expr: Applied | str, values: dict[str, Value], equation: str, name: str = ""
    ) -> Value:
        if isinstance(expr, str):
            return values[expr]
        operands = [self._evaluated(o, values, equation) for o in expr.operands]
        return self.apply(expr.operation, *operands, equation=equation, name=name)

    def apply(
        self,
        operation: str,
        *operands: Value,
        numbers: Iterable[int] = (),
        equation: str = "",
        name: str = "",
    ) -> Value:
        """Apply an operation with one result; nothing is done where an array is long enough."""
        if operation == "extend" and operands[0].shape == tuple(numbers):
            return operands[0]
        more = {"equation": equation, "name": name}
        (value,) = self.apply_all(operation, *operands, numbers=numbers, **more)
        return value

    def apply_all(
        self,
        operation: str,
        *operands: Value,
        numbers: Iterable[int] = (),
        equation: str = "",
        name: str = "",
    ) -> tuple[Value, ...]:
        """Apply an operation, which may be of a relation, and may give the array of that name."""
        fixed = tuple(numbers)
        label = name or (f"{operation}_of_{equation}" if equation else operation)
        targets = []
        for shape in OPERATIONS[operation].shapes(tuple(o.shape for o in operands), fixed):
            targets.append(Value(self._name(label, operands, fixed, known=bool(equation)), shape))
        self.steps.append(Apply(operation, operands, tuple(targets), fixed, equation))
        return tuple(targets)

    def _name(
        self, label: str, operands: tuple[Value, ...], numbers: tuple[int, ...], *, known: bool
    ) -> str:
        """A name that other steps do not change: a part by its place, others counted."""
        part = label == "take" and numbers and len(operands[0].shape) == 1
        name = f"{operands[0].name}_from_{numbers[0]}" if part else label
        self._made[name] += 1
        return name if (part or known) and self._made[name] == 1 else f"{name}_{self._made[name]}"
