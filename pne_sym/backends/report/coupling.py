"""Coupled motors in M, Z and the required force: what is no sum over legs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from pne_sym.backends.report.view import Statement
from pne_sym.derivation import Derivation, Output
from pne_sym.vector.arrays import written

Matrix = Callable[[Sequence[Output], str], tuple[str, ...]]

_MOTION = {
    "actuated_accelerations": r"\ddot{\mathbf q}_a",
    "actuated_bias": r"\ddot{\mathbf q}_a^{\circ}",
}
# letters that no quantity of a derivation has
_K, _N, _S, _R = (rf"\boldsymbol{{\mathcal {letter}}}" for letter in "KDSR")
_SYMBOLS = {
    **_MOTION,
    "H": r"\mathbf H",
    "coupling": _K,
    "ratios": rf"\mathrm{{diag}}({_N})",
    "per_turn": rf"\mathrm{{diag}}({_N})^{{-1}}",
    "rotor_roots": rf"\mathrm{{diag}}({_R})",
    "rotor_columns": _S,
    "actuated_rates": r"\dot{\mathbf q}_a",
    "tau": r"\boldsymbol\tau",
    "motor_rates": r"\dot{\mathbf q}_m",
    "motor_torques": r"\boldsymbol\tau_m",
    "M_rotors": r"\mathbf M_r",
    "Z_rotors": r"\mathbf Z_r",
    "required_rotors": r"\mathbf F_r",
    "tau_rotors": r"\boldsymbol\tau_r",
}
_FORMS = {
    **dict.fromkeys(("product", "times", "multiply", "scale_columns"), r"{0}\,{1}"),
    "transposed": r"{0}^{{\mathsf T}}",
    "solve": r"({0})^{{-1}}\,{1}",
}


def of_rotors(derivation: Derivation, array: str) -> tuple[str, ...]:
    """What stands beside the blocks of an array where rotors are coupled."""
    found = (r for r in derivation.relations if r.id == f"{array}_rotors")
    return tuple(f"+ {_SYMBOLS[r.id]}" for r in found)


def coupling_statements(derivation: Derivation, matrix: Matrix) -> Iterator[Statement]:
    """How coupled motors turn, what they give, and how their rotors are felt: its relations.

    Args:
        derivation: of the model.
        matrix: lines of a block matrix, of outputs and a symbol.
    """
    if not derivation.relations:
        return
    yield Statement(
        "**Coupled motors.** Before their gears, of the ratios "
        f"$`{_N}`$ (1 where there is no motor), the motors turn by the matrix $`{_K}`$ times the "
        f"displacements of the actuated joints, both in the order of $`{_SYMBOLS['tau']}`$."
        f"{_ROOTS if any(r.id == 'rotor_columns' for r in derivation.relations) else ''}",
        (),
    )
    for array, latex in {"rotor_roots": _R, **_MOTION}.items():
        found = [o for o in derivation.outputs if o.array == array]
        if found:
            yield Statement(f"**`{array}`.** {_WORDS[array]}.", matrix(found, latex))
    for relation in derivation.relations:
        yield Statement(
            f'<a id="{relation.id}"></a>**({relation.id})** {relation.title[0].upper()}'
            f"{relation.title[1:]}. *{relation.law.capitalize()}, beyond the paper.*",
            (f"{_SYMBOLS[relation.id]} = {written(relation.rhs, _SYMBOLS, _FORMS)}",),
        )


_WORDS = {
    "rotor_roots": "Roots of the inertias that are felt of the rotors",
    "actuated_accelerations": "Accelerations of the actuated joints",
    "actuated_bias": "The same without the acceleration of the platform",
}
_ROOTS = (
    f" An entry of $`{_R}`$ is the root of the inertia that is felt of a motor's rotor (0 where "
    r"there is no motor), and $`\ddot{\mathbf q}_a=\mathbf H^{\mathsf T}\mathbf A"
    r"+\ddot{\mathbf q}_a^{\circ}`$."
)
