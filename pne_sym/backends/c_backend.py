"""The C back end: a header and a source file in C99 that need libm only."""

from __future__ import annotations

from dataclasses import dataclass

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_api import api_table
from pne_sym.backends.c_calls import ApiWriter
from pne_sym.backends.c_functions import LANES, function_text
from pne_sym.backends.c_model import (
    default_values,
    model_fields,
    parameter_checks,
    parameter_fields,
    prepare_body,
)
from pne_sym.backends.c_text import Routine, wrapped
from pne_sym.backends.describe import Described, describe, moment_rows
from pne_sym.backends.templating import render
from pne_sym.program.ir import Closure


@dataclass(frozen=True)
class CClosure:
    """Legs of a type whose displacements are found by iteration.

    Attributes:
        of: their positions in q.
        rows: conditions of a leg.
        call: of the function that gives its gap and Jacobian.
    """

    of: Closure
    rows: int
    call: str


@dataclass(frozen=True)
class CView:
    """Ready strings and numbers for the templates.

    Attributes:
        coordinates: contents of the flat vectors, lines of the header's comment.
        parameters, model: members of the structures.
        prototypes, definitions: lines of every public function.
        defaults, home_x, home_q: initialisers.
        checks, prepare: statements of the preparation.
        has_relations: whether live axes must keep right angles or directions.
        closures: legs whose displacements are found by iteration.
        extra_joints, turning_joints: positions in q of the extra coordinates, and of the
            displacements found by iteration that are angles.
        closure_functions: texts of the functions that these need.
        functions: texts of the other functions of the program.
        calls: calls of such functions in templates, by purpose.
        moment_rows: rows of H and Hk that are moments.
        driven: number of equations from which the forces are found.
        completion: number of equations for the accelerations of passive extra coordinates.
        gathers: whether rows on which nothing acts are found by rank.
        padded: sizes of linear systems, padded, by purpose.
        big: largest number of rows or columns of a least-squares problem.
        q0: where the quaternion begins in X.
        driven_joints, turning_drives, actuator_legs: index tables.
        lanes: number of states that run side by side.
    """

    coordinates: tuple[str, ...]
    parameters: tuple[str, ...]
    model: tuple[str, ...]
    prototypes: tuple[tuple[str, ...], ...]
    definitions: tuple[tuple[str, ...], ...]
    defaults: tuple[str, ...]
    home_x: str
    home_q: str
    checks: tuple[str, ...]
    has_relations: bool
    prepare: tuple[str, ...]
    closures: tuple[CClosure, ...]
    extra_joints: tuple[int, ...]
    turning_joints: tuple[int, ...]
    closure_functions: tuple[str, ...]
    functions: tuple[str, ...]
    calls: dict[str, str]
    moment_rows: tuple[int, ...]
    driven: int
    completion: int
    gathers: bool
    padded: dict[str, int]
    big: int
    q0: int
    driven_joints: tuple[int, ...]
    turning_drives: tuple[int, ...]
    actuator_legs: tuple[int, ...]
    lanes: int = LANES


class CBackend:
    """Emits NAME.h and NAME.c."""

    operations = None

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        d = describe(bundle)
        view = self.view(bundle)
        return {
            f"{bundle.name}.h": render("c/header.h.jinja", view=view, d=d),
            f"{bundle.name}.c": render("c/source.c.jinja", view=view, d=d),
        }

    def view(self, bundle: Bundle) -> CView:
        """What the templates print."""
        d, c, n = describe(bundle), bundle.coordinates, bundle.coordinates.sizes
        functions, runs = _functions(bundle, d)
        closures = _closures(bundle, runs)
        api = [ApiWriter(bundle.name, a) for a in api_table(bundle, d)]
        driven = tuple(c.joints.index(a) for a in c.actuators)
        passive, idle = len(d.actuation.passive), d.actuation.idle
        completion = passive + (idle if d.completes_freely else 0)
        return CView(
            coordinates=_coordinate_lines(d),
            parameters=tuple(parameter_fields(bundle)),
            model=tuple(model_fields(bundle)),
            prototypes=tuple(tuple(a.prototypes()) for a in api),
            definitions=tuple(tuple(a.definitions()) for a in api),
            defaults=tuple(default_values(bundle)),
            home_x=", ".join(f"R({v})" for v in c.home[0]),
            home_q=", ".join(f"R({v})" for v in c.home[1]),
            checks=tuple(parameter_checks(bundle)),
            has_relations=bool(bundle.derivation.parameters.relations),
            prepare=tuple(prepare_body(bundle)),
            closures=closures,
            extra_joints=tuple(joint for joint, _ in bundle.program.given),
            turning_joints=tuple(j for x in closures for j in x.of.turning),
            closure_functions=tuple(t for n, t in functions.items() if _is_closure(n)),
            functions=tuple(t for n, t in functions.items() if not _is_closure(n)),
            calls=_calls(runs),
            moment_rows=moment_rows(bundle),
            driven=len(d.actuation.solved) - d.actuation.surplus,
            completion=completion,
            gathers=d.resolves or n["NU"] > d.actuation.force_rank != len(d.actuation.others),
            padded={
                "drive": _padded(len(d.actuation.solved)),
                "forward": _padded(n["NV"] + n["NC"]),
                "completion": _padded(completion),
            },
            big=max(
                n["NV"],
                n["NU"] + n["NC"],
                *(max(x.rows, x.of.unknowns) for x in closures),
            ),
            q0=c.pose.index("qx") if c.has_quaternion else 0,
            driven_joints=driven,
            turning_drives=tuple(k for k, j in enumerate(driven) if c.turning[j]),
            actuator_legs=tuple(leg for leg, _ in c.actuators),
        )


def _padded(n: int) -> int:
    """Length of a row of a system of n equations with its right side, a multiple of 4."""
    return (n + 4) // 4 * 4


def _coordinate_lines(d: Described) -> tuple[str, ...]:
    named = (
        ("X", d.pose_text),
        ("V, A", d.rate_text),
        ("tau", d.tau_text),
        ("wrench", d.wrench_text),
    )
    return tuple(line for name, text in named for line in wrapped(f"{name}: {text}", "    "))


def _is_closure(function: str) -> bool:
    return function.startswith("closure_")


def _closures(bundle: Bundle, runs: dict[str, Routine]) -> tuple[CClosure, ...]:
    """The legs whose displacements are found by iteration."""
    return tuple(
        CClosure(
            closure,
            bundle.program.shapes[f"gap_{closure.leg_type}"][1],
            runs[f"closure_{closure.leg_type}"].call(w="1", joints="q"),
        )
        for closure in bundle.program.closures
    )


def _functions(bundle: Bundle, d: Described) -> tuple[dict[str, str], dict[str, Routine]]:
    """Texts of the program's functions with what evaluates them, and the routines that run them."""
    texts, runs = {}, {}
    public = {a.name: a for a in api_table(bundle, d) if a.arrays}
    for function in bundle.program.functions.values():
        text, runs[function.name] = function_text(bundle, function)
        if function.name in public:
            writer = ApiWriter(bundle.name, public[function.name])
            text += "\n\n" + "\n".join(writer.any(bundle, runs[function.name]))
        texts[function.name] = text
    return texts, runs


def _calls(runs: dict[str, Routine]) -> dict[str, str]:
    """Calls of the program's functions as the templates need them."""
    one = {"w": "1"}
    return {
        "required": runs["required"].call(required="force"),
        "required_one": runs["required"].call(required="force", **one),
        "dynamics": runs["dynamics"].call(),
        "dynamics_one": runs["dynamics"].call(**one),
        "M_one": runs["M"].call(**one),
        "Z_one": runs["Z"].call(**one),
        "condition_one": runs["condition"].call(**one),
        "legs_one": runs["legs"].call(**one),
        "potential_one": runs["potential"].call(potential="energies + 1", **one),
    }
