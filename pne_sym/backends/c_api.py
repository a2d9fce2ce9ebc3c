"""The public functions of the C module: what each computes, its arguments."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import Described
from pne_sym.model.values import ROUNDING
from pne_sym.program.count import count_function


@dataclass(frozen=True)
class Argument:
    """An input or output array of a function.

    Attributes:
        name: of the argument.
        size: number of entries of one state.
        shape: for people.
        optional: NULL stands for "none".
    """

    name: str
    size: int
    shape: str = ""
    optional: bool = False

    @property
    def text(self) -> str:
        """The argument with its shape."""
        return f"{self.name} ({self.shape or self.size}{', or NULL' if self.optional else ''})"


@dataclass(frozen=True)
class Api:
    """A public function; there is one for a state and one for a batch.

    Attributes:
        name: without prefix.
        meaning: what it computes.
        inputs, outputs: arrays, one state after another in a batch.
        arrays: program function and its arrays that are the outputs, or "" where
            a template computes them.
        lanes: whether the batch runs several states side by side.
        has_model: whether the prepared model is the first argument.
    """

    name: str
    meaning: str
    inputs: tuple[Argument, ...]
    outputs: tuple[Argument, ...]
    arrays: tuple[str, ...] = ()
    lanes: bool = False
    has_model: bool = True


def api_table(bundle: Bundle, d: Described) -> tuple[Api, ...]:
    """All public functions, in the order of the header."""
    of_model = (*_program_functions(bundle, d), *_solved(d), *_derived(d))
    if d.is_numeric:
        of_model = tuple(_guessed(a, d) for a in of_model)
    return tuple(_counted(bundle, a) for a in (*of_model, *_helpers(d)))


def _guessed(api: Api, d: Described) -> Api:
    """The function with a first guess of the displacements after the pose."""
    after = next(k for k, i in enumerate(api.inputs, 1) if i.name in ("X", "X0"))
    q0 = Argument("q0", d.sizes["NJ"], "NJ", optional=True)
    return replace(api, inputs=(*api.inputs[:after], q0, *api.inputs[after:]))


def _vectors(d: Described) -> dict[str, Argument]:
    n = d.sizes
    sizes = {"X": "NQ", "V": "NV", "A": "NV", "tau": "NU", "q_actuated": "NU", "X0": "NQ"}
    vectors = {name: Argument(name, n[key], key) for name, key in sizes.items()}
    return vectors | {"wrench": Argument("wrench", n["NW"], "NW", optional=True)}


def _program_functions(bundle: Bundle, d: Described) -> list[Api]:
    """What the program computes as it is."""
    n, v = d.sizes, _vectors(d)
    X, V, A = v["X"], v["V"], v["A"]

    def made(name: str, *shape: str) -> Argument:
        return Argument(name, math.prod(n[s] for s in shape), " x ".join(shape))

    M, Z, H = made("M", "NV", "NV"), made("Z", "NV"), made("H", "NV", "NU")
    branch = "on the assembly branch of home"
    if d.is_numeric:
        branch += "; iterated ones: the closure reached from q0"
    rows: list[tuple[str, str, tuple[Argument, ...], tuple[Argument, ...], tuple[str, ...]]] = [
        ("M", "Inertia matrix M.", (X,), (M,), ("M",)),
        ("Z", "Velocity and gravity terms Z.", (X, V), (Z,), ("Z",)),
        ("H", "Force transformation H: actuators to task space.", (X,), (H,), ("H",)),
        ("Hk", "Directions Hk of the constraint forces lambda.", (X,),
         (made("Hk", "NV", "NC"),), ("Hk",)),
        ("dynamics", "M, Z and H together, sharing the work.", (X, V), (M, Z, H), ("M", "Z", "H")),
        ("constraints",
         "Residuals of the constraints [m, or 1 for angles]; zero where the loops close.", (X,),
         (made("residual", "NC"),), ("constraints",)),
        ("constraint_bias", "The vector bias in Hk^T A + bias = 0.", (X, V),
         (made("bias", "NC"),), ("constraint_bias",)),
        ("inverse_kinematics", f"Displacements q of all joints, {branch}.", (X,),
         (made("q", "NJ"),), ("q",)),
        ("joint_rates", "Rates of all joints.", (X, V), (made("rates", "NJ"),), ("qd",)),
        ("joint_accelerations", "Accelerations of all joints.", (X, V, A),
         (made("accelerations", "NJ"),), ("qdd",)),
    ]  # fmt: skip
    return [Api(*row, lanes=True) for row in rows if row[0] in bundle.program.functions]


def _solved(d: Described) -> list[Api]:
    """What needs the solution of linear equations."""
    n, v = d.sizes, _vectors(d)
    X, V, A, wrench = v["X"], v["V"], v["A"], v["wrench"]
    multipliers = (Argument("lambda", n["NC"], "NC"),) if d.is_constrained else ()
    forces = "Actuator forces tau" + (" and multipliers lambda" if d.is_constrained else "")
    least = ", of least norm" if d.is_redundant else ""
    found = [
        Api(
            "inverse_dynamics",
            f"{forces} for the acceleration A, by Eq. 3{least}.",
            (X, V, A, wrench),
            (v["tau"], *multipliers),
            lanes=d.is_underdriven or not d.by_least_norm,
        ),
        Api(
            "forward_dynamics",
            "Acceleration A under the actuator forces tau and the wrench.",
            (X, V, v["tau"], wrench),
            (A, *multipliers),
            lanes=True,
        ),
    ]
    if d.is_redundant:
        weights = Argument("weights", n["NU"], "NU, positive")
        found.insert(
            1,
            Api(
                "inverse_dynamics_weighted",
                f"{forces} of least sum of weights tau^2.",
                (X, V, A, wrench, weights),
                found[0].outputs,
            ),
        )
    if n["NU"] > d.actuation.force_rank:
        columns = n["NU"] - d.actuation.force_rank
        found.append(
            Api(
                "null_space",
                "Orthonormal basis of the tau with H tau = 0.",
                (X,),
                (Argument("basis", n["NU"] * columns, f"NU x {columns}"),),
            )
        )
    return found


def _completion(d: Described) -> str:
    """What `complete_acceleration` does."""
    if d.is_underdriven and d.actuation.passive:
        return "SINGULAR: with fewer actuators than freedoms no accelerations will do."
    if not d.actuation.passive:
        return "A: there are no passive extra coordinates, whose accelerations would follow."
    if d.actuation.idle and not d.completes:
        return "A: no accelerations of passive extra coordinates bring other forces about."
    if not d.completes:
        return "A: passive extra coordinates are held too, whatever their accelerations."
    if not d.resolves:
        return (
            "A with the entries of passive extra coordinates taken from their own rows, on which "
            "nothing else acts."
        )
    least = ", by the least change in the metric of M" if d.completes_freely else ""
    return (
        "A with other entries of passive extra coordinates, so that M A + Z - wrench is in the "
        f"range of {'[H Hk]' if d.is_constrained else 'H'}{least}."
    )


def _derived(d: Described) -> list[Api]:
    """What is made of other functions."""
    wide = 6 if d.coordinates.transmits_moments else 3
    kind = "Force, then moment," if d.coordinates.transmits_moments else "Force"
    n, v = d.sizes, _vectors(d)
    X, V, A, wrench = v["X"], v["V"], v["A"], v["wrench"]
    found = [
        Api(
            "complete_acceleration",
            _completion(d),
            (X, V, A, wrench),
            (Argument("completed", n["NV"], "NV"),),
        ),
        Api(
            "leg_reactions",
            f"{kind} of each leg on the platform at its platform joint, base axes.",
            (X, V, A, wrench),
            (Argument("forces", wide * d.legs, f"{d.legs} x {wide}"),),
        ),
        Api(
            "energy",
            "Kinetic and potential energy; the latter is zero at the base origin.",
            (X, V),
            (Argument("kinetic", 1), Argument("potential", 1)),
        ),
        Api(
            "forward_kinematics",
            "X at which the driven joints stand at q_actuated, by Gauss-Newton "
            "from X0; extra coordinates that the drives do not determine stay.",
            (v["q_actuated"], v["X0"]),
            (X,),
        ),
    ]
    found += _conditioning(d)
    if d.is_constrained:
        found.append(
            Api(
                "project",
                "The nearest pose on which the constraints hold.",
                (X,),
                (Argument("projected", n["NQ"], "NQ"),),
            )
        )
    return found


def _conditioning(d: Described) -> list[Api]:
    """How far a pose is from singularities."""
    n, X = d.sizes, _vectors(d)["X"]
    legs = Argument("legs", d.legs)

    def sigma(columns: int) -> Argument:
        return Argument("sigma", min(n["NV"], columns))

    found = [
        Api(
            "condition",
            "Singular values of H in descending order, moment rows divided by the rms distance of "
            "the platform points from their centroid; for every leg the least tested pivot as a "
            "fraction of its scale.",
            (X,),
            (sigma(n["NU"]), legs),
        )
    ]
    if d.is_constrained:
        found.append(
            Api(
                "condition_constrained",
                "The same of [H Hk], which inverse dynamics solves.",
                (X,),
                (sigma(n["NU"] + n["NC"]), legs),
            )
        )
    return found


def _helpers(d: Described) -> list[Api]:
    """Helpers for poses, where the space has rotation."""
    if not d.has_rotation:
        return []
    n, v = d.sizes, _vectors(d)
    side = 3 if d.has_quaternion else 2
    position = n["NQ"] - len(d.coordinates.extras) - (4 if d.has_quaternion else 1)
    R = Argument("R", side * side, f"{side} x {side}")
    t = Argument("t", position, str(position), optional=position == 0)
    zero = "; extra coordinates zero" if d.has_extras else ""
    found = [
        Api("rotation", "base_R_platform; a quaternion need not be normalised.", (v["X"],), (R,)),
        Api(
            "pose",
            f"X of the platform at origin t with rotation matrix R{zero}.  INVALID where R has not "
            f"orthonormal rows, to {ROUNDING:g} (float: 1e-5), and determinant +1.",
            (t, R),
            (v["X"],),
        ),
        Api(
            "X_dot",
            "Rate of X at the velocity V.",
            (v["X"], v["V"]),
            (Argument("X_dot", n["NQ"], "NQ"),),
        ),
    ]
    if d.has_quaternion:
        found.insert(
            2,
            Api(
                "pose_from_rpy",
                "X from roll, pitch, yaw about the fixed axes x, y, z, in that order.",
                (t, Argument("rpy", 3)),
                (v["X"],),
            ),
        )
    return [replace(a, has_model=False) for a in found]


_WORK = {
    "inverse_dynamics": "required",
    "inverse_dynamics_weighted": "required",
    "forward_dynamics": "dynamics",
    "leg_reactions": "legs",
    "condition_constrained": "condition",
}


def _counted(bundle: Bundle, api: Api) -> Api:
    """The function with its operation counts in the meaning."""
    name = _WORK.get(api.name, api.name)
    if name not in bundle.program.functions:
        return api
    n = count_function(bundle.program.functions[name], bundle.leg_counts)
    iterated = api.has_model and any(i.name == "q0" for i in api.inputs)
    also = {
        "required": "; the solution of the linear equations apart",
        "dynamics": ""
        if api.name == "dynamics"
        else "; the solution of the linear equations apart",
        "legs": "; inverse dynamics apart",
        "condition": "; the singular values apart",
    }.get(name, "")
    return replace(
        api,
        meaning=f"{api.meaning}  {n.mul} mul, {n.add} add, {n.div} div, {n.sqrt} sqrt, "
        f"{n.trig} trig{also}{'; the iteration of q apart' if iterated else ''}.",
    )
