"""What writes public functions: their arguments by names, and functions of steps."""

from __future__ import annotations

from pne_sym.derivation import Coordinates
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.ir import Program
from pne_sym.program.public import Argument, Default, PublicFunction, Run, Value

_SIZES = {
    "X": "NQ", "X0": "NQ", "V": "NV", "A": "NV", "tau": "NU", "q": "NJ", "q0": "NJ",
    "q_actuated": "NU", "wrench": "NW", "weights": "NU", "Z": "NV", "length": "",
    "base": "18", "direction": "NV", "wrench_direction": "NW", "tau_min": "NU", "tau_max": "NU",
    "reference": "NU",
}  # fmt: skip
_MEANINGS = {
    "X": "pose, and extra coordinates",
    "X0": "first guess of the pose",
    "V": "velocity",
    "A": "acceleration",
    "tau": "actuator forces [N or N m]",
    "q_actuated": "displacements of the actuated joints [m or rad]",
    "wrench": "external wrench on the platform",
    "weights": "positive weights of the actuator forces: least sum of weights tau^2",
    "length": "by which rows of moments are divided [m]; by default the rms distance of the "
    "platform points from their centroid, or where they coincide the rms size of the legs",
    "base": "motion of the base (R, omega, alpha, a): rotation world_R_base; in base axes its "
    "angular velocity and acceleration, and the acceleration of its origin, without gravity",
    "q0": "first guess of the displacements",
    "direction": "direction of accelerations, of any length",
    "wrench_direction": "direction of external wrenches on the platform, of any length",
    "tau_min": "least actuator forces [N or N m]",
    "tau_max": "largest actuator forces [N or N m]",
    "reference": "actuator forces to be near to [N or N m]",
}
_DEFAULTS = {
    "length": Default.ZEROS,
    "wrench": Default.ZEROS,
    "weights": Default.ONES,
    "q0": Default.HOME_Q,
    "base": Default.REST,
    "reference": Default.ZEROS,
}


class Writer:
    """Writes the public functions of a model."""

    def __init__(self, coordinates: Coordinates, program: Program, *, guessed: bool) -> None:
        self.c, self.n, self.program = coordinates, coordinates.sizes, program
        self.guessed = guessed
        self.constrained = self.n["NC"] > 0
        self.every = tuple(range(self.n["NV"]))
        self.independent = self.n["NC"] - coordinates.overconstrained
        facts = coordinates.actuation
        self.redundancy = (
            self.n["NU"] - (facts.rank - self.independent) if facts.is_determined else 0
        )

    def given(self, name: str) -> Argument:
        """An input."""
        key = _SIZES[name]
        keys = (key,) if key else ()
        value = Value(name, tuple(self.n.get(k) or int(k) for k in keys))
        positive = name in ("weights", "length")
        return Argument(value, keys, _MEANINGS[name], _DEFAULTS.get(name), positive)

    def made(self, value: Value, name: str, meaning: str, *dimensions: str) -> Argument:
        """An output: an array under the name that users know."""
        return Argument(Value(value.name, value.shape), dimensions, meaning, label=name)

    def function(
        self,
        name: str,
        meaning: str,
        inputs: str,
        algorithm: Algorithm,
        *outputs: Argument,
        group: str = "dynamics",
        **more: object,
    ) -> PublicFunction:
        """A function of the model; last come base, where it matters, and q0 for iterations."""
        runs = [self.program.functions[s.function] for s in algorithm.steps if isinstance(s, Run)]
        names = [*inputs.split(), *["base"] * any("base" in f.inputs for f in runs)]
        names += ["q0"] * self.guessed
        arguments = tuple(self.given(n) for n in names)
        steps = tuple(algorithm.steps)
        if more.get("counted") and any("rotor_roots" in f.arrays for f in runs):
            left_out = [more["also"]] if "also" in more else []
            more["also"] = " and ".join(["the products with coupled rotors", *map(str, left_out)])
        return PublicFunction(name, meaning, arguments, outputs, steps, group, **more)  # type: ignore[arg-type]

    def external(self, a: Algorithm) -> Value:
        """The external wrench as a generalised force."""
        return a.apply("extend", self.given("wrench").value, numbers=[self.n["NV"]])
