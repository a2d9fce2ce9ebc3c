"""Coupled motors in M, Z and the required force: what is no sum over legs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from pne_sym.backends.report.view import Statement
from pne_sym.derivation import Derivation, Law, Output

Matrix = Callable[[Sequence[Output], str], tuple[str, ...]]

_MOTION = {
    "actuated_accelerations": r"\ddot{\mathbf q}_a",
    "actuated_bias": r"\ddot{\mathbf q}_a^{\circ}",
}
# letters that no quantity of a derivation has
_K, _N, _S, _R = (rf"\boldsymbol{{\mathcal {letter}}}" for letter in "KDSR")
_LOAD = rf"{_S}\,\mathrm{{diag}}({_R})\,{_K}\,"
_BESIDE = {"Z": "actuated_bias", "required": "actuated_accelerations"}


def of_rotors(derivation: Derivation, array: str) -> tuple[str, ...]:
    """What stands beside the blocks of an array where rotors are coupled."""
    made = {o.array for o in derivation.outputs}
    if "rotor_roots" not in made:
        return ()
    if array == "M":
        return (rf"+ {_S}\,{_S}^{{\mathsf T}}",)
    motion = _BESIDE.get(array, "")
    return (f"+ {_LOAD}{_MOTION[motion]}",) if motion in made else ()


def is_coupled(derivation: Derivation) -> bool:
    """Whether motors turn with several joints."""
    return any(o.array == "coupling" for o in derivation.outputs)


def coupling_statements(derivation: Derivation, matrix: Matrix) -> Iterator[Statement]:
    """How coupled motors turn, what they give, and how their rotors are felt.

    Args:
        derivation: of the model.
        matrix: lines of a block matrix, of outputs and a symbol.
    """
    if not is_coupled(derivation):
        return
    law = f"*{Law.COUPLING.value.capitalize()}, beyond the paper.*"
    yield Statement(
        f"**Coupled motors.** Before their gears, of the ratios $`{_N}`$ (1 where there is no "
        f"motor), the motors turn by the matrix $`{_K}`$ times the displacements of the actuated "
        f"joints, in the order of tau, and their torques give tau. {law}",
        (
            rf"\dot{{\mathbf q}}_m = {_N}\,{_K}\,\dot{{\mathbf q}}_a,",
            rf"\qquad \boldsymbol\tau = {_K}^{{\mathsf T}}\,{_N}\,\boldsymbol\tau_m",
        ),
    )
    yield from _rotor_statements(derivation, matrix, law)


def _rotor_statements(derivation: Derivation, matrix: Matrix, law: str) -> Iterator[Statement]:
    """Roots of inertias, columns of S, accelerations of the actuated joints."""
    found = {a: [o for o in derivation.outputs if o.array == a] for a in ("rotor_roots", *_MOTION)}
    if not found["rotor_roots"]:
        return
    yield Statement(
        f"**`rotor_roots`.** A column of $`{_S}`$ is what a motor's unit torque does to the "
        f"platform, times the root $`{_R}`$ of the inertia that is felt of its rotor (0 where "
        "there is no motor); so the rotors have the kinetic energy "
        rf"$`\tfrac12\,\mathbf V^{{\mathsf T}}{_S}\,{_S}^{{\mathsf T}}\mathbf V`$, "
        f"and $`{_ACCELERATED}`$. {law}",
        (*matrix(found["rotor_roots"], _R), r",\qquad", _COLUMNS),
    )
    for array, latex in _MOTION.items():
        if found[array]:
            still = ", without the acceleration of the platform" * (array == "actuated_bias")
            words = f"**`{array}`.** Accelerations of the actuated joints{still}."
            yield Statement(words, matrix(found[array], latex))


_ACCELERATED = r"\ddot{\mathbf q}_a=\mathbf H^{\mathsf T}\mathbf A+\ddot{\mathbf q}_a^{\circ}"
_COLUMNS = rf"{_S} = \mathbf H\,{_K}^{{\mathsf T}}\,\mathrm{{diag}}({_R})"
