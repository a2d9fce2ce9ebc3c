"""The public functions of a derivation, as steps over the functions of its program.

Reference: inverse dynamics Eq. 3, equations of motion Eqs. 5 to 7, constraints Eqs. 36, 37.
"""

from __future__ import annotations

from collections.abc import Callable

from pne_sym.derivation import Coordinates, Derivation
from pne_sym.lowering.public_actuators import actuator_functions
from pne_sym.lowering.public_bounds import bounded_functions
from pne_sym.lowering.public_condition import (
    CONDITION,
    CONDITION_CONSTRAINED,
    conditioning_functions,
    moment_rows,
    scaled_values,
)
from pne_sym.lowering.public_notes import with_notes
from pne_sym.lowering.public_pose import displacement_functions, pose_functions
from pne_sym.program.algorithm import Algorithm
from pne_sym.program.ir import Program
from pne_sym.program.public import (
    Argument,
    Default,
    PublicFunction,
    Run,
    Search,
    Value,
    verify_steps,
    with_readable_names,
)

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


def public_functions(derivation: Derivation, program: Program) -> tuple[PublicFunction, ...]:
    """All functions that users call, each after those that it uses.

    Raises:
        StepError: a function that does not hold together.
    """
    coordinates = derivation.coordinates
    assert coordinates is not None
    guessed = any(not t.is_closed for t in derivation.leg_types)
    writer = Writer(coordinates, program, guessed=guessed)
    rows = moment_rows(derivation, coordinates)
    found = (
        *writer.of_program(),
        *writer.of_dynamics(),
        *writer.of_condition(rows),
        *conditioning_functions(writer, rows),
        *bounded_functions(writer),
        *writer.of_kinematics(),
        *actuator_functions(writer),
        *pose_functions(coordinates),
        *displacement_functions(coordinates),
    )
    arrays = {f.name: f.arrays for f in program.functions.values()}
    found = tuple(with_readable_names(f, arrays) for f in found)
    for function in found:
        verify_steps(function)
    return tuple(with_notes(function, coordinates, guessed=guessed) for function in found)


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

    # ---- arguments ---------------------------------------------------------------------------

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

    # ---- the program's own functions -----------------------------------------------------------

    def of_program(self) -> list[PublicFunction]:
        """What the program computes as it is."""
        rows = (
            ("M", "Inertia matrix M.", "X", "M", ("NV", "NV"), "dynamics"),
            ("Z", "Velocity and gravity terms Z.", "X V", "Z", ("NV",), "dynamics"),
            ("H", "Force transformation H: actuators to task space.", "X", "H", ("NV", "NU"),
             "dynamics"),
            ("Hk", "Directions Hk of the constraint forces lambda (Eq. 36).", "X", "Hk",
             ("NV", "NC"), "constraints"),
            ("constraints",
             "Residuals of the constraints [m, or 1 for angles]; zero on closed loops (Eq. 37).",
             "X", "constraints", ("NC",), "constraints"),
            ("constraint_bias", "The vector bias in Hk^T A + bias = 0.", "X V",
             "constraint_bias", ("NC",), "constraints"),
            ("inverse_kinematics", "Displacements q of all joints.", "X", "q", ("NJ",),
             "kinematics"),
            ("joint_rates", "Rates of all joints.", "X V", "qd", ("NJ",), "kinematics"),
            ("joint_accelerations", "Accelerations of all joints.", "X V A", "qdd", ("NJ",),
             "kinematics"),
        )  # fmt: skip
        found = []
        for name, meaning, inputs, array, dimensions, group in rows:
            if name in self.program.functions:
                a = Algorithm()
                (value,) = a.run(name, self.program, array)
                words = meaning[0].lower() + meaning[1:].rstrip(".")
                out = self.made(value, array, words, *dimensions)
                found.append(
                    self.function(name, meaning, inputs, a, out, group=group, counted=name)
                )
        a = Algorithm()
        M, Z, H = a.run("dynamics", self.program, "M", "Z", "H")
        outputs = (
            self.made(M, "M", "inertia matrix", "NV", "NV"),
            self.made(Z, "Z", "velocity and gravity terms", "NV"),
            self.made(H, "H", "force transformation", "NV", "NU"),
        )
        meaning = "M, Z and H together, sharing the work."
        found.append(self.function("dynamics", meaning, "X V", a, *outputs, counted="dynamics"))
        return found

    # ---- equations of motion ---------------------------------------------------------------------

    def of_dynamics(self) -> list[PublicFunction]:
        """What solves the equations of motion, and what is made of the solution."""
        found = [
            self._inverse_dynamics(),
            self._forward_dynamics(),
            self._complete_acceleration(),
            self._leg_reactions(),
            self._energy(),
        ]
        return [*found, self._null_space()] if self.n["NU"] else found

    def external(self, a: Algorithm) -> Value:
        """The external wrench as a generalised force."""
        return a.apply("extend", self.given("wrench").value, numbers=[self.n["NV"]])

    def forces(
        self,
        a: Algorithm,
        required: Value,
        actuators: list[Value],
        *,
        weighted: bool = False,
        choose: Callable[[Value, Value], Value] | None = None,
    ) -> tuple[Value, ...]:
        """tau, and lambda where there are constraints, with H tau + Hk lambda = required.

        Where actuators are redundant, tau is of least norm, or what `choose` makes of that and the
        matrix that takes all tau with the same effect to the same vector.
        """
        facts = self.c.actuation
        if not facts.is_determined:
            sizes = ("NU", "NC") if self.constrained else ("NU",)
            return tuple(a.apply("impossible", required, numbers=[self.n[k]]) for k in sizes)
        H, Hk, f = self._solved(a, required, actuators)
        if self._is_square(H):
            return self._unique(a, H, Hk, f)
        left = across = None
        if Hk is not None:
            left, across = self._resolved(a, H, Hk)
        tau, matrix = self._least(a, H, f, across, weighted=weighted)
        tau = choose(tau, matrix) if choose else tau
        if Hk is None or left is None:
            return (tau,)
        rest = a.apply("subtract", f, a.apply("times", H, tau))
        system = a.apply("product", left, Hk)
        how = "least_norm" if self.c.overconstrained else "solve"
        return tau, a.apply(how, system, a.apply("times", left, rest))

    def shared_forces(
        self, a: Algorithm, required: Value, actuators: list[Value]
    ) -> tuple[Value, Value]:
        """tau of least norm, and the matrix that takes all tau with its effect to one vector."""
        H, Hk, f = self._solved(a, required, actuators)
        if self._is_square(H):
            return self._unique(a, H, Hk, f)[0], H
        across = self._resolved(a, H, Hk)[1] if Hk else None
        return self._least(a, H, f, across, weighted=False)

    def _resolved(self, a: Algorithm, H: Value, Hk: Value) -> tuple[Value, ...]:
        """Combinations of equations that resolve constraint forces, and that know none of them."""
        both = a.apply("beside", H, Hk) if self.n["NU"] else Hk
        return a.apply_all("resolve", Hk, both, numbers=[self.independent])

    def _solved(
        self, a: Algorithm, f: Value, actuators: list[Value]
    ) -> tuple[Value, Value | None, Value]:
        """H, Hk and the required force in the rows from which forces are found."""
        facts = self.c.actuation
        H, Hk = actuators[0], actuators[1] if self.constrained else None
        if facts.surplus:
            return self._attainable(a, H, Hk, f)
        if facts.solved != self.every:
            H, f = (a.apply("take", v, numbers=facts.solved) for v in (H, f))
            Hk = a.apply("take", Hk, numbers=facts.solved) if Hk else None
        return H, Hk, f

    def _is_square(self, H: Value) -> bool:
        """Whether forces are unique."""
        return self.n["NU"] + self.n["NC"] == H.shape[0] and not self.c.overconstrained

    def _unique(self, a: Algorithm, H: Value, Hk: Value | None, f: Value) -> tuple[Value, ...]:
        if Hk is None:
            return (a.apply("solve", H, f),)
        both = a.apply("solve", a.apply("beside", H, Hk), f)
        return a.apply_all("split", both, numbers=[self.n["NU"]])

    def _least(
        self, a: Algorithm, H: Value, f: Value, across: Value | None, *, weighted: bool
    ) -> tuple[Value, Value]:
        """tau of least (weighted) norm, on rows that constraints do not act on; its matrix."""
        scale = a.apply("inverse_root", self.given("weights").value) if weighted else None
        matrix = a.apply("scale_columns", H, scale) if scale else H
        if across:
            matrix, f = a.apply("product", across, matrix), a.apply("times", across, f)
        least = a.apply("least_norm", matrix, f)
        return a.apply("multiply", scale, least) if scale else least, matrix

    def _attainable(
        self, a: Algorithm, H: Value, Hk: Value | None, f: Value
    ) -> tuple[Value, Value | None, Value]:
        """Combinations of rows that resolve the actuators, and the force nearest to their range."""
        facts = self.c.actuation
        actuators = a.apply("beside", H, Hk) if Hk else H
        rows, idle = a.apply_all("resolve", actuators, actuators, numbers=[facts.rank])
        gap = a.apply("negative", a.apply("times", idle, f))
        effect = a.apply("take_columns", idle, numbers=facts.passive)
        change = a.apply("least_norm", effect, gap)
        f = a.apply("add_at", f, change, numbers=facts.passive)
        Hk = a.apply("product", rows, Hk) if Hk else None
        return a.apply("product", rows, H), Hk, a.apply("times", rows, f)

    def _inverse_dynamics(self) -> PublicFunction:
        a = Algorithm()
        names = ["required", "H", *(["Hk"] if self.constrained else [])]
        required, *actuators = a.run("required", self.program, *names)
        needed = a.apply("subtract", required, self.external(a))
        outputs = self.force_outputs(*self.forces(a, needed, actuators, weighted=True))
        return self.function(
            "inverse_dynamics",
            "Actuator forces tau for the acceleration A, by Eq. 3.",
            "X V A wrench weights",
            a,
            *outputs,
            counted="required",
            also="the solution of the linear equations",
        )

    def force_outputs(self, tau: Value, *rest: Value) -> list[Argument]:
        """The outputs tau and lambda."""
        found = [self.made(tau, "tau", "actuator forces [N or N m]", "NU")]
        return found + [self._multipliers(v) for v in rest]

    def _multipliers(self, value: Value) -> Argument:
        """The output lambda."""
        meaning = "constraint forces [N or N m]"
        if self.c.overconstrained:
            meaning += (
                f", of least norm: {self.c.overconstrained} of the constraints follow from others"
            )
        return self.made(value, "lambda", meaning, "NC")

    def _least_held(
        self, a: Algorithm, M: Value, force: Value, H: Value, constraint: list[Value]
    ) -> tuple[Value, Value]:
        """Acceleration under constraints of which some follow from others, and the least lambda."""
        Hk, bias = constraint
        rows = a.apply("transposed", Hk)
        some, _ = a.apply_all("resolve", rows, rows, numbers=[self.independent])
        own = a.apply("transposed", a.apply("product", some, rows))
        right = a.apply("join", force, a.apply("negative", a.apply("times", some, bias)))
        both = a.apply("solve", a.apply("saddle", M, own), right)
        A, amounts = a.apply_all("split", both, numbers=[self.n["NV"]])
        left, _ = self._resolved(a, H, Hk)
        wanted = a.apply("times", left, a.apply("times", own, amounts))
        return A, a.apply("least_norm", a.apply("product", left, Hk), wanted)

    def _forward_dynamics(self) -> PublicFunction:
        a = Algorithm()
        names = ["M", "Z", "H", *(["Hk", "constraint_bias"] if self.constrained else [])]
        M, Z, H, *constraint = a.run("dynamics", self.program, *names)
        force = a.apply("times", H, self.given("tau").value)
        force = a.apply("subtract", a.apply("add", force, self.external(a)), Z)
        if constraint and self.c.overconstrained:
            A, lam = self._least_held(a, M, force, H, constraint)
            outputs = [self._multipliers(lam)]
        elif constraint:
            Hk, bias = constraint
            right = a.apply("join", force, a.apply("negative", bias))
            both = a.apply("solve", a.apply("saddle", M, Hk), right)
            A, lam = a.apply_all("split", both, numbers=[self.n["NV"]])
            outputs = [self._multipliers(lam)]
        else:
            A, outputs = a.apply("solve", M, force), []
        return self.function(
            "forward_dynamics",
            "Acceleration A under the actuator forces tau and the wrench.",
            "X V tau wrench",
            a,
            self.made(A, "A", "acceleration", "NV"),
            *outputs,
            counted="dynamics",
            also="the solution of the linear equations",
        )

    def _complete_acceleration(self) -> PublicFunction:
        facts, a = self.c.actuation, Algorithm()
        A = self.given("A").value
        if not facts.is_determined and facts.passive:
            done = a.apply("impossible", A, numbers=[self.n["NV"]])
        elif facts.idle == 0 or not (facts.completes and facts.is_determined):
            done = a.apply("same", A)
        else:
            done = self._completed(a, A)
        return self.function(
            "complete_acceleration",
            "A with the entries of passive extra coordinates that the others allow.",
            "X V A wrench",
            a,
            self.made(done, "completed", "acceleration", "NV"),
        )

    def _completed(self, a: Algorithm, A: Value) -> Value:
        facts = self.c.actuation
        unique = facts.idle == len(facts.passive)
        known = a.apply("clear_at", A, numbers=facts.passive) if unique else A
        names = ["M", "Z", "H", *(["Hk"] if self.constrained else [])]
        M, Z, *actuators = a.run("dynamics", self.program, *names)
        needed = a.apply("add", a.apply("times", M, known), Z)
        needed = a.apply("subtract", needed, self.external(a))
        columns = a.apply("take_columns", M, numbers=facts.passive)
        own = a.apply("take", columns, numbers=facts.passive)
        if facts.is_coupled:
            system = a.apply("beside", *actuators) if self.constrained else actuators[0]
            _, idle = a.apply_all("resolve", system, system, numbers=[facts.rank])
            effect, gap = a.apply("product", idle, columns), a.apply("times", idle, needed)
        else:
            effect, gap = own, a.apply("take", needed, numbers=facts.passive)
        if unique:
            change = a.apply("solve", effect, a.apply("negative", gap))
        else:  # least change in the metric of M
            zero = a.apply("extend", a.apply("take", A, numbers=[]), numbers=[len(facts.passive)])
            system = a.apply("saddle", own, a.apply("transposed", effect))
            both = a.apply("solve", system, a.apply("join", zero, a.apply("negative", gap)))
            change, _ = a.apply_all("split", both, numbers=[len(facts.passive)])
        return a.apply("add_at", known, change, numbers=facts.passive)

    def _leg_reactions(self) -> PublicFunction:
        a = Algorithm()
        given = self.program.functions["required"].arrays
        values = dict(zip(given, a.run("required", self.program, *given), strict=True))
        actuators = [values[name] for name in ("H", "Hk") if name in values]
        needed = a.apply("subtract", values["required"], self.external(a))
        tau, *lam = self.forces(a, needed, actuators)
        efforts = [a.without_rotors(tau, values), *lam]
        arrays = self.program.functions["legs"].arrays
        shape = self.program.shapes["leg_force"]
        found = dict(zip(arrays, a.run("legs", self.program, *arrays), strict=True))
        forces = found.get("leg_force")
        assert forces is not None
        legs = {
            "actuator": [leg for leg, _ in self.c.actuators],
            "constraint_direction": self.c.constraints,
        }
        for effort, (array, owners) in zip(efforts, legs.items(), strict=False):
            forces = a.apply("add_forces", forces, effort, found[array], numbers=owners)
        kind = "Force and moment" if self.c.transmits_moments else "Force"
        return self.function(
            "leg_reactions",
            f"{kind} of each leg on the platform at its platform joint, base axes.",
            "X V A wrench",
            a,
            self.made(forces, "forces", "leg on platform [N, N m]", str(shape[0]), str(shape[1])),
            counted="legs",
            also="inverse dynamics",
        )

    def _energy(self) -> PublicFunction:
        a = Algorithm()
        (M,) = a.run("M", self.program, "M")
        (potential,) = a.run("potential", self.program, "potential")
        kinetic = a.apply("half_form", self.given("V").value, M)
        return self.function(
            "energy",
            "Kinetic and potential energy [J]; the latter is zero at the base origin.",
            "X V",
            a,
            self.made(kinetic, "kinetic", "kinetic energy [J]"),
            self.made(
                a.apply("entry", potential, numbers=[0]), "potential", "potential energy [J]"
            ),
        )

    def _null_space(self) -> PublicFunction:
        a = Algorithm()
        (H,) = a.run("H", self.program, "H")
        basis = a.apply("null_basis", H, numbers=[self.c.actuation.force_rank])
        return self.function(
            "null_space",
            "Orthonormal basis of the tau with H tau = 0.",
            "X",
            a,
            self.made(basis, "basis", "columns", "NU", str(basis.shape[1])),
        )

    def of_condition(self, rows: tuple[int, ...]) -> list[PublicFunction]:
        """How far a pose is from singularities."""
        found = [self._condition("condition", CONDITION, ["H"], rows)]
        if self.constrained:
            both = ["H", "Hk"]
            found.append(
                self._condition("condition_constrained", CONDITION_CONSTRAINED, both, rows)
            )
        return found

    def _condition(
        self, name: str, meaning: str, matrices: list[str], rows: tuple[int, ...]
    ) -> PublicFunction:
        a = Algorithm()
        lengths, legs, *found = a.run("condition", self.program, "lengths", "pivots", *matrices)
        sigma = scaled_values(a, found, lengths, self.given("length").value, rows)
        size = str(sigma.shape[0])
        return self.function(
            name,
            meaning,
            "X length",
            a,
            self.made(sigma, "sigma", "singular values, in descending order", size),
            self.made(legs, "legs", "least pivots; a leg is refused at 1.5e-8", str(legs.size)),
            counted="condition",
            also="the singular values",
            gives_status=True,
        )

    # ---- searches --------------------------------------------------------------------------------

    def of_kinematics(self) -> list[PublicFunction]:
        """Poses that are searched for."""
        found = [self._mismatch(), self._slope(), self._forward_kinematics()]
        return [*found, *self._projection()] if self.constrained else found

    def _mismatch(self) -> PublicFunction:
        """Residuals of actuated joints and of constraints."""
        a, joints = Algorithm(), [self.c.joints.index(j) for j in self.c.actuators]
        (q,) = a.run("inverse_kinematics", self.program, "q")
        own = a.apply("take", q, numbers=joints)
        gap = a.apply("subtract", self.given("q_actuated").value, own)
        turning = [k for k, j in enumerate(joints) if self.c.turning[j]]
        if turning:
            gap = a.apply("wrap_turns", gap, numbers=turning)
        if self.constrained:
            (residual,) = a.run("constraints", self.program, "constraints")
            gap = a.apply("join", gap, a.apply("negative", residual))
        out = self.made(gap, "gap", "of actuated joints, then of constraints", str(gap.size))
        return self.function(
            "mismatch", "Residual of the pose.", "X q_actuated", a, out, is_exported=False,
            group="kinematics",
        )  # fmt: skip

    def _slope(self) -> PublicFunction:
        """Transpose of the derivative of what is measured, by a displacement of the pose."""
        a = Algorithm()
        (H,) = a.run("H", self.program, "H")
        if self.constrained:
            (Hk,) = a.run("Hk", self.program, "Hk")
            H = a.apply("beside", H, Hk)
        out = self.made(H, "slope", "columns: what is measured", "NV", str(H.shape[1]))
        return self.function(
            "slope", "Derivative of the residual, negative.", "X", a, out, is_exported=False,
            group="kinematics",
        )  # fmt: skip

    def _forward_kinematics(self) -> PublicFunction:
        a, X = Algorithm(), Value("X_found", (self.n["NQ"],))
        a.steps.append(Search("mismatch", "slope", self.given("X0").value, X, halving=True))
        return self.function(
            "forward_kinematics",
            "X at which the actuated joints stand at q_actuated, by Gauss-Newton from X0.",
            "q_actuated X0",
            a,
            self.made(X, "X", "pose", "NQ"),
            group="kinematics",
        )

    def _projection(self) -> list[PublicFunction]:
        residual = Algorithm()
        (gap,) = residual.run("constraints", self.program, "constraints")
        gap = residual.apply("negative", gap)
        slope = Algorithm()
        (Hk,) = slope.run("Hk", self.program, "Hk")
        a, X = Algorithm(), Value("X_found", (self.n["NQ"],))
        a.steps.append(
            Search("constraint_gap", "constraint_slope", self.given("X").value, X, halving=False)
        )
        return [
            self.function(
                "constraint_gap", "Residual of the constraints, negative.", "X", residual,
                self.made(gap, "gap", "of the constraints", "NC"), is_exported=False,
                group="constraints",
            ),
            self.function(
                "constraint_slope", "Directions of the constraints.", "X", slope,
                self.made(Hk, "slope", "columns", "NV", "NC"), is_exported=False,
                group="constraints",
            ),
            self.function(
                "project", "The nearest pose on which the constraints hold.", "X", a,
                self.made(X, "projected", "pose", "NQ"), group="constraints",
            ),
        ]  # fmt: skip
