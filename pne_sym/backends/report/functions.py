"""How the generated functions use the equations, what can fail, what it costs."""

from __future__ import annotations

from collections.abc import Iterator

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.latex import LatexPrinter
from pne_sym.backends.report.blocks import block_matrix
from pne_sym.backends.report.coupling import of_rotors
from pne_sym.backends.report.equations import last_duals
from pne_sym.backends.report.markdown import table
from pne_sym.backends.report.names import leg_title
from pne_sym.backends.report.view import Lines, Statement
from pne_sym.backends.report.words import FUNCTIONS
from pne_sym.derivation import Coordinates, FailureStatus
from pne_sym.program.count import count_block, count_function
from pne_sym.program.ir import Block, Counts

_COUNT_HEAD = ("mul", "add", "div", "sqrt", "sum", "trig")
_R = r"\mathbf R(X, V, A)"
_N = r"\boldsymbol{\mathcal N}"
_W = r"\mathbf F_{\mathrm{ext}}"


def function_statements(bundle: Bundle, printer: LatexPrinter) -> Iterator[Statement]:
    """Inverse and forward dynamics, constraints, extra coordinates."""
    constrained = bundle.coordinates.sizes["NC"] > 0
    yield from _inverse_dynamics(bundle, printer, constrained=constrained)
    yield _forward_dynamics(constrained=constrained)
    yield Statement(
        "**Conditioning**: `condition` returns the singular values of H, moment rows divided by "
        r"$`\ell_b`$ ($`\ell_s`$ where it vanishes), and for every leg the least of the values "
        "that are tested below, over its scale."
        + (" `condition_constrained` does so for [H H_k]." if constrained else ""),
        (),
    )
    yield from _passive_statements(bundle.coordinates)


def _inverse_dynamics(
    bundle: Bundle, printer: LatexPrinter, *, constrained: bool
) -> Iterator[Statement]:
    outputs = [o for o in bundle.derivation.outputs if o.array == "required"]
    required = block_matrix(outputs, _R, printer)
    beside = of_rotors(bundle.derivation, "required")
    unknown = (
        r"\begin{bmatrix}\mathbf H & \mathbf H_k\end{bmatrix}"
        r"\begin{bmatrix}\boldsymbol\tau \\ \boldsymbol\lambda\end{bmatrix}"
        if constrained
        else r"\mathbf H\,\boldsymbol\tau"
    )
    yield Statement(
        "**Inverse dynamics** goes the direct way of Eq. 3: accelerations are numbers, leg forces "
        r"come out as numbers, and the platform's equilibrium gives what is required, "
        r"$`\mathbf R`$; M is never formed.",
        (f"{unknown} = {_R} - {_W},", r"\qquad", *required, *beside),
    )
    actuation, sizes = bundle.coordinates.actuation, bundle.coordinates.sizes
    if actuation.is_determined and sizes["NU"] + sizes["NC"] > actuation.rank:
        yield Statement(
            "There are more unknowns than equations; of all solutions the smallest is taken.", ()
        )


def _forward_dynamics(*, constrained: bool) -> Statement:
    if not constrained:
        return Statement(
            "**Forward dynamics** solves the equations of motion for the acceleration:",
            (rf"\mathbf M\,\mathbf A = \mathbf H\,\boldsymbol\tau + {_W} - \mathbf Z",),
        )
    return Statement(
        "**Forward dynamics** solves the equations of motion together with the constraints, "
        "differentiated twice:",
        (
            r"\begin{bmatrix}\mathbf M & -\mathbf H_k \\",
            r"\mathbf H_k^{\mathsf T} & \mathbf 0\end{bmatrix}",
            r"\begin{bmatrix}\mathbf A \\ \boldsymbol\lambda\end{bmatrix}",
            rf"= \begin{{bmatrix}}\mathbf H\,\boldsymbol\tau + {_W} - \mathbf Z \\",
            r"-\boldsymbol\iota\end{bmatrix},",
            r"\qquad \mathbf H_k^{\mathsf T}\,\mathbf V = \mathbf 0,",
            r"\quad \mathbf H_k^{\mathsf T}\,\mathbf A + \boldsymbol\iota = \mathbf 0",
        ),
    )


def _passive_statements(coordinates: Coordinates) -> Iterator[Statement]:
    """What actuators leave to themselves: by the generic rank of [H Hk]."""
    a, actuators = coordinates.actuation, _actuators(coordinates)
    size = coordinates.sizes["NV"]
    if not a.is_determined:
        yield Statement(
            f"**Too few actuators**: for almost all parameters and poses, {actuators} cannot hold "
            "all rows that are to hold. No forces give any acceleration; inverse dynamics is NaN.",
            (),
        )
    elif a.passive and not a.idle:
        yield Statement(
            "**Passive extra coordinates** are held by the actuators of other joints: "
            f"{actuators} has rank {size} for almost all parameters and poses, so that all rows "
            "are solved, and any of their accelerations has forces.",
            (),
        )
    elif a.passive and not a.is_coupled:
        yield Statement(
            "**Passive extra coordinates** follow from their own rows (Eq. 7); "
            "`complete_acceleration` fills in their accelerations before inverse dynamics:",
            (r"\mathbf M_{yy}\,\ddot{\mathbf y} = -\mathbf M_{yx}\,\mathbf A_x - \mathbf Z_y",),
        )
    elif a.passive:
        yield from _coupled_statements(coordinates)


def _coupled_statements(coordinates: Coordinates) -> Iterator[Statement]:
    """Passive extra coordinates that actuators act on, but do not hold."""
    a, actuators = coordinates.actuation, _actuators(coordinates)
    unique = len(a.passive) == a.idle
    k = r"\mathbf H & \mathbf H_k" if coordinates.sizes["NC"] else r"\mathbf H"
    residual = rf"{_N}^{{\mathsf T}}\,(\mathbf M\,\mathbf A + \mathbf Z - {_W})"
    change = r"\delta\ddot{\mathbf y}"
    least = (
        rf"{change}^{{\mathsf T}}\,\mathbf M_{{yy}}\,{change} \rightarrow \min,",
        rf"\qquad {_N}^{{\mathsf T}}\,\mathbf M_{{\cdot y}}\,{change} = -{residual}",
    )
    yield Statement(
        f"**Passive extra coordinates**: {actuators} acts on their rows too, but has rank "
        f"{a.rank} of {coordinates.sizes['NV']} for almost all parameters and poses. With columns "
        f"$`{_N}`$ that span what it leaves out, an acceleration has forces only where",
        (
            rf"{_N}^{{\mathsf T}}\begin{{bmatrix}}{k}\end{{bmatrix}} = \mathbf 0,",
            rf"\qquad {residual} = \mathbf 0.",
        ),
    )
    if not a.completes:
        yield Statement(
            r"None of this feels the accelerations $`\ddot{\mathbf y}`$ of these coordinates: it "
            "is a condition on the others, and `complete_acceleration` changes nothing.",
            (),
        )
        return
    yield Statement(
        r"`complete_acceleration` changes the entries $`\ddot{\mathbf y}`$ of these coordinates so "
        "that this holds" + ("." if unique else ", by the least change in the metric of M:"),
        () if unique else least,
    )
    yield Statement(
        "Without that, inverse dynamics holds all other rows, and these "
        + ("as they follow." if not a.surplus else "in least squares."),
        (),
    )


def _actuators(coordinates: Coordinates) -> str:
    return "[H H_k]" if coordinates.sizes["NC"] else "H"


def failures(bundle: Bundle) -> tuple[str, ...]:
    """Impossible states, with the equations where they show."""
    found: dict[FailureStatus, list[str]] = {}
    for equation in bundle.derivation.equations():
        for condition in equation.conditions:
            found.setdefault(condition.status, []).append(equation.id)
    bases = last_duals(bundle.derivation)
    definitions = {e.name: e.id for e in bundle.derivation.equations()}
    singular = [
        *found.get(FailureStatus.SINGULAR, ()),
        *(definitions[name] for name in bases),
    ]
    lines = []
    if FailureStatus.UNREACHABLE in found:
        ids = _links(found[FailureStatus.UNREACHABLE])
        lines.append(f"**Out of reach**: {ids} negative, a leg does not get to its place.")
    if singular:
        lines.append(
            f"**Singular leg**: a divisor of {_links(singular)} (nearly) zero, measured against "
            "the length of the leg's lever arms."
        )
    constrained = bundle.coordinates.sizes["NC"] > 0
    if any(not info.is_closed for info in bundle.derivation.leg_types):
        lines.append(
            "**Not converged**: from the first guess `q0`, Newton's iteration finds no "
            "displacements that close the loops on the assembly branch of home."
        )
    lines += [
        (
            f"**Singular actuation**: {_actuators(bundle.coordinates)} has {_lacking(bundle)}; "
            "inverse dynamics needs that, M, Z and H do not."
        ),
        "**Singular masses**: "
        + (
            "the matrix of accelerations and multipliers has no inverse; forward dynamics needs it."
            if constrained
            else "M has no inverse; forward dynamics needs it."
        ),
        (
            "**Invalid**: an entry of the input is not finite, or a quaternion is zero, "
            "or so long that its squared length overflows."
        ),
    ]
    return tuple(lines)


def _lacking(bundle: Bundle) -> str:
    """The rank that is missing where actuators are singular."""
    a = bundle.coordinates.actuation
    return f"not the rank {a.rank} of other poses" if a.passive and a.idle else "no full rank"


def _links(ids: list[str]) -> str:
    return ", ".join(f"[{i}](#{i})" for i in dict.fromkeys(ids))


def counts(bundle: Bundle) -> Lines:
    """Operations of every function."""
    rows = [
        _row(f"`{f.name}`", _gives(bundle, f.name), count_function(f, bundle.leg_counts))
        for f in bundle.program.functions.values()
    ]
    return table(("Function", "Gives", *_COUNT_HEAD), rows, numbers=len(_COUNT_HEAD))


def _gives(bundle: Bundle, name: str) -> str:
    if any(name == closure.function for closure in bundle.program.closures):
        return "a step of the iteration before the functions of X: residual and its derivative"
    return FUNCTIONS[name]


def parts(bundle: Bundle) -> Lines:
    """Operations of every part of every function, for one leg where it is a leg's."""
    rows = []
    for function in bundle.program.functions.values():
        for k, block in enumerate(function.blocks):
            where = _where(bundle, function.blocks, k)
            rows.append(_row(f"`{function.name}`", where, count_block(block)))
    return table(("Function", "Part", *_COUNT_HEAD), rows, numbers=len(_COUNT_HEAD))


def _where(bundle: Bundle, blocks: tuple[Block, ...], at: int) -> str:
    block = blocks[at]
    if block.leg_type:
        info = next(t for t in bundle.derivation.leg_types if t.name == block.leg_type)
        return f"each {leg_title(info)} leg"
    return "after the legs" if any(b.leg_type for b in blocks[:at]) else "before the legs"


def _row(name: str, what: str, c: Counts) -> tuple[str, ...]:
    return name, what, *(str(v) for v in (c.mul, c.add, c.div, c.sqrt, c.total, c.trig))
