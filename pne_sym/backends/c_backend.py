"""The C back end: a header and a source file in C99 that need libm only."""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_functions import LANES, FunctionText, FunctionWriter
from pne_sym.backends.c_model import (
    default_values,
    model_fields,
    number,
    parameter_checks,
    parameter_fields,
    prepare_body,
)
from pne_sym.backends.c_once import Once
from pne_sym.backends.c_operations import OPERATIONS, biggest, results_of, runs_in_lanes
from pne_sym.backends.c_parts import least_values
from pne_sym.backends.c_public import Caller, c_functions
from pne_sym.backends.c_sizes import count_of, one_state, sizes_of
from pne_sym.backends.c_solve import Eliminations
from pne_sym.backends.c_stage_texts import stage_texts
from pne_sym.backends.c_stages import Stages
from pne_sym.backends.c_statements import Titles
from pne_sym.backends.c_steps import Steps
from pne_sym.backends.c_sums import with_common_sums
from pne_sym.backends.c_support import needed
from pne_sym.backends.c_text import Routine, indented, wrapped
from pne_sym.backends.describe import Described, describe
from pne_sym.backends.templating import render
from pne_sym.program.count import count_block
from pne_sym.program.ir import Closure, Function

_SUPPORT = ("linear", "rectangular", "operations", "bounds", "rotations", "iteration")
"""Templates of plain C, of which a module gets what it needs."""


class CClosure(NamedTuple):
    """Legs of a type whose displacements are found by iteration.

    Attributes:
        of: their positions in q.
        rows: conditions of a leg.
        call: of the function that gives its residual and Jacobian.
    """

    of: Closure
    rows: int
    call: str


class CView(NamedTuple):
    """Ready strings and numbers for the templates.

    Attributes:
        coordinates: contents of the flat vectors, lines of the header's comment.
        parameters, model: members of the structures.
        prototypes: lines of every function that users call.
        defaults, home_x, home_q: initialisers.
        checks, prepare: statements of the preparation; `checked`: what these checks need.
        closures: legs whose displacements are found by iteration.
        support: operations that the texts need.
        texts: all functions.
        sizes: name -> number.
        least: what is not singular is larger -> name.
        narrow: how functions of one state are declared, where that is said.
        calling: whether legs call sine or cosine for what is solved.
        lanes: number of states that run side by side.
    """

    coordinates: tuple[str, ...]
    parameters: tuple[str, ...]
    model: tuple[str, ...]
    prototypes: tuple[tuple[str, ...], ...]
    defaults: tuple[str, ...]
    home_x: str
    home_q: str
    checks: tuple[str, ...]
    checked: str
    prepare: str
    closures: tuple[CClosure, ...]
    support: str
    texts: tuple[str, ...]
    sizes: dict[str, str]
    least: dict[str, str]
    narrow: str
    calling: bool
    lanes: int = LANES


class CBackend:
    """Emits NAME.h and NAME.c."""

    operations = OPERATIONS

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        d, view = describe(bundle), _view(bundle)
        return {
            f"{bundle.name}.h": render("c/header.h.jinja", view=view, d=d),
            f"{bundle.name}.c": render("c/source.c.jinja", view=view, d=d),
        }


def _view(bundle: Bundle) -> CView:
    """What the templates print."""
    functions, shared = _texts(bundle)
    closures = _closures(bundle, functions)
    steps, routines = _steps(bundle, functions)
    users = [Caller(bundle.name, f, *routines[f.of.name]) for f in c_functions(bundle)]
    closing = {closure.of.function for closure in closures}
    texts = [
        "/* ---- what functions of the state share; v: values for others ---- */",
        *shared,
        *(f.text for n, f in functions.items() if n in closing),
        *([_closing(bundle, closures)] if closures else []),
        "/* ---- functions of the state: M, Z, H and the like ---- */",
        *(f.text for n, f in functions.items() if n not in closing),
        "/* ---- what users call, as steps over these ---- */",
        *steps,
        "/* ---- one state, and batches ---- */",
        *("\n".join(user.definitions()) for user in users),
    ]
    checks, titles = tuple(parameter_checks(bundle)), Titles(bundle)
    operators = needed(support(bundle, biggest(bundle)), texts)
    home = bundle.coordinates.home
    return CView(
        coordinates=_coordinate_lines(describe(bundle)),
        parameters=tuple(parameter_fields(bundle)),
        model=tuple(model_fields(bundle)),
        prototypes=tuple(tuple(user.prototypes()) for user in users),
        defaults=tuple(default_values(bundle)),
        home_x=", ".join(map(number, map(str, home[0]))),
        home_q=", ".join(map(number, map(str, home[1]))),
        checks=checks,
        checked=needed(render("c/checks.c.jinja"), (*checks, operators)),
        prepare=titles.told("\n".join(indented(prepare_body(bundle)))),
        closures=closures,
        support=operators,
        texts=tuple(map(titles.told, texts)),
        sizes=_sizes(bundle),
        least=least_values(bundle),
        narrow=one_state(bundle),
        calling=_calls(bundle),
    )


def _calls(bundle: Bundle) -> bool:
    """Whether legs call libm for the forces that are solved for."""
    blocks = bundle.program.functions["required"].blocks
    return any(block.leg_type and count_block(block).trig for block in blocks)


def _sizes(bundle: Bundle) -> dict[str, str]:
    """Names of sizes: those of the header by their short names, and numbers of legs."""
    prefix = bundle.name.upper()
    legs = {count_of(leg): str(n) for leg, n in bundle.leg_counts.items()}
    return {n: str(k) if n == "NL" else f"{prefix}_{n}" for n, k in sizes_of(bundle).items()} | legs


def support(bundle: Bundle, big: int) -> str:
    """All that a module may need of written-out C, for matrices of so many rows and columns."""
    c = bundle.coordinates
    return "\n".join(
        render(
            f"c/{name}.c.jinja",
            big=big,
            quaternion=c.position if c.has_quaternion else None,
            sizes=c.sizes,
        )
        for name in _SUPPORT
    )


def _coordinate_lines(d: Described) -> tuple[str, ...]:
    named = (
        ("X", d.pose_text),
        ("V, A", d.rate_text),
        ("tau", d.tau_text),
        ("wrench", d.wrench_text),
    )
    return tuple(line for name, text in named for line in wrapped(f"{name}: {text}", "    "))


def _closures(bundle: Bundle, functions: dict[str, FunctionText]) -> tuple[CClosure, ...]:
    """Legs whose displacements are found by iteration."""
    found = []
    for closure in bundle.program.closures:
        residual = f"residual_{closure.leg_type}"
        arrays = {residual: "residual", f"jacobian_{closure.leg_type}": "jacobian"}
        call = functions[closure.function].one.call_with({"joints": "q", **arrays})
        found.append(CClosure(closure, bundle.program.shapes[residual][1], call))
    return tuple(found)


def _closing(bundle: Bundle, closures: tuple[CClosure, ...]) -> str:
    """The iterations on the loop closure."""
    return render(
        "c/closure.c.jinja",
        name=bundle.name,
        closures=closures,
        turning=[j for c in closures for j in c.of.turning],
        given=bundle.program.given,
        sizes=bundle.coordinates.sizes,
    )


def _run(bundle: Bundle) -> dict[str, Function]:
    """The program's functions that are run."""
    program = bundle.program
    run = {name for f in program.public for name in f.functions}
    run |= {closure.function for closure in program.closures}
    return {n: with_common_sums(f) for n, f in program.functions.items() if n in run}


def _texts(bundle: Bundle) -> tuple[dict[str, FunctionText], list[str]]:
    """Functions of the program, for states side by side where a public one wants it; the shared."""
    program, functions = bundle.program, _run(bundle)
    stages = Stages(functions.values())
    printed = [f for f in program.public if any(o.value.size for o in f.outputs)]
    single = Counter(name for f in printed for name in f.functions)
    lanes = Counter(name for f in printed if runs_in_lanes(f) for name in f.functions)
    summed = {name for f in program.public for name in results_of(f).values()}
    writers = [
        FunctionWriter(bundle, f, stages, summed=name in summed) for name, f in functions.items()
    ]
    once = Once(routine for writer in writers for routine in writer.routines())
    texts = {w.name: w.text(once, single[w.name], lanes[w.name]) for w in writers}
    return texts, [*stage_texts(bundle, stages), *once.texts()]


def _steps(
    bundle: Bundle, functions: dict[str, FunctionText]
) -> tuple[list[str], dict[str, tuple[Routine, Routine | None]]]:
    """Texts of the public functions' steps, and the routines that run them: one state, lanes."""
    texts: list[str] = []
    routines: dict[str, tuple[Routine, Routine | None]] = {}
    eliminations = Eliminations()
    for function in bundle.program.public:
        if not any(o.value.size for o in function.outputs):
            continue
        found = []
        for lanes in [False, True] if runs_in_lanes(function) else [False]:
            runs = {n: functions[n].run(lanes=lanes) for n in function.functions}
            parts = {name: one for name, (one, _) in routines.items()}
            steps = Steps(bundle, function, runs, parts, eliminations, lanes=lanes)
            found.append(steps.routine())
            texts += [*eliminations.taken(), *steps.before, "\n".join(found[-1].definition())]
        routines[function.name] = (found[0], found[1] if len(found) > 1 else None)
    return texts, routines
