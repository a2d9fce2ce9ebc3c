"""A version of a model from where it was found: compiled, or as a folder has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from pne_sym.generation import InputError, find
from pne_sym.model.files import parse
from pne_sym.model.reader import from_text
from pne_sym.review.manifests import manifest_of
from pne_sym.review.model import Model, from_folder, from_manipulator
from pne_sym.review.sources import Source


def version_of(source: Source) -> Model:
    """A version of a model, compiled where it is a specification.

    Raises:
        InputError: it is none, or its manifest is at fault.
        SpecError: the specification is at fault.
    """
    if source.models is not None:
        raise InputError(f"{source.label[:100]!r} is no generated folder: it holds several")
    if source.folder is not None:
        return _folder(source)
    if source.content is None:
        return from_manipulator(source.label, find(source.name))
    return _specification(source.label, source.content, source.suffix)


def _specification(label: str, content: str, suffix: str) -> Model:
    """A specification compiled, together with what its author wrote."""
    written = parse(content, suffix, label)
    model = from_manipulator(label, from_text(content, suffix, label))
    return replace(model, written=written if isinstance(written, Mapping) else None)


def _folder(source: Source) -> Model:
    assert source.folder is not None
    return from_folder(source.label, manifest_of(source), source.folder)
