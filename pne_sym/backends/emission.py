"""The texts of a model's folder: the chosen back ends print."""

from __future__ import annotations

import importlib
from collections.abc import Collection
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from pne_sym.backends import registry
from pne_sym.backends.target import Target, TargetError, is_signed

if TYPE_CHECKING:
    from pne_sym.backends.bundle import Backend, Bundle


def emit(bundle: Bundle, targets: Collection[str] | None = None) -> dict[str, str]:
    """All files of a model's folder: path below it, with slashes -> text; sorted.

    Args:
        bundle: the compiled manipulator.
        targets: names; by default those that `pne-gen` writes by default.

    Raises:
        TargetError: there is no such target, or it lacks an operation that the model needs.
    """
    names = registry.default() if targets is None else registry.chosen(targets)
    bundle = replace(bundle, targets=names)
    files: dict[str, str] = {}
    for each in registry.printing(names):
        files |= emit_target(bundle, each)
    return dict(sorted(files.items()))


def emit_target(bundle: Bundle, of: Target) -> dict[str, str]:
    """The files of one target.

    Raises:
        TargetError: it lacks an operation that the model needs.
    """
    backend = _loaded(of.backend)
    _check_operations(bundle, of, backend)
    files = backend.emit(bundle)
    for path, text in files.items():
        assert of.owns(bundle.name, path), f"{of.name} does not own {path}"
        # Files that are not known by their names alone are recognised by their signature.
        signed = of.always or of.default or is_signed(text.encode())
        assert signed, f"{path} does not say who generated it"
    return files


def _check_operations(bundle: Bundle, of: Target, backend: Backend) -> None:
    """Refuse a model with public functions that a back end cannot print."""
    provided = backend.operations
    if provided is None:
        return
    for function in bundle.program.public:
        if lacking := sorted(function.operations - provided):
            raise TargetError(
                f"{bundle.name}: the target {of.name} cannot print {function.name}: it has no "
                f"operation {', '.join(map(repr, lacking))}; generate without {of.name}"
            )


@cache
def _loaded(backend: str) -> Backend:
    module, _, name = backend.partition(":")
    made: Backend = getattr(importlib.import_module(module), name)()
    return made
