"""The driver: manipulator -> derivation -> program -> texts.  Pure; nothing touches the disk."""

from __future__ import annotations

from collections.abc import Collection

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.emission import emit
from pne_sym.backends.registry import chosen
from pne_sym.derivation import Derivation
from pne_sym.home_check import check_home
from pne_sym.influence import completes, without_completion
from pne_sym.lowering.program import lower
from pne_sym.lowering.solve import SingularPatternError
from pne_sym.mechanics.derive import derive
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import Manipulator


def compile_bundle(manipulator: Manipulator) -> Bundle:
    """Derive and lower a manipulator.

    Raises:
        SpecError: the mechanism is outside the method; the message says why.
    """
    bundle = _lowered(manipulator, derive(manipulator))
    if completes(bundle):
        return bundle
    return _lowered(manipulator, without_completion(bundle.derivation))


def _lowered(manipulator: Manipulator, derivation: Derivation) -> Bundle:
    try:
        program = lower(derivation)
    except SingularPatternError as error:
        raise SpecError(
            manipulator.name, "legs", str(error), "legs whose degrees of freedom are independent"
        ) from error
    return Bundle(manipulator, derivation, program)


def compile_model(
    manipulator: Manipulator, targets: Collection[str] | None = None
) -> dict[str, str]:
    """All files of a model's folder: path below it, with slashes -> text.

    Warns with `SpecWarning` where a function has no value at home or at a pose around it.

    Args:
        manipulator: the specification.
        targets: names of back ends; by default "numpy" and "c". Manifest and report are always
            among the files.

    Raises:
        SpecError: the mechanism is outside the method, or its model is not finite at home; the
            message says why.
        TargetError: there is no such target, or it cannot print this model.
    """
    names = None if targets is None else chosen(targets)
    bundle = compile_bundle(manipulator)
    check_home(bundle)
    return emit(bundle, names)
