"""A folder compared with what this pne-gen prints from the specification in its own manifest.

Where the two are equal, the derivation is known and our own text in memory stands
for the folder's. Where not, nothing is concluded from what the folder says.
"""

from __future__ import annotations

import json
import warnings
from dataclasses import replace
from functools import cache

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.emission import emit
from pne_sym.backends.registry import chosen
from pne_sym.backends.target import TargetError
from pne_sym.model.errors import SpecError, SpecWarning, printable
from pne_sym.model.reader import from_mapping
from pne_sym.pipeline import compile_bundle
from pne_sym.review.difference import Deviation
from pne_sym.review.files import as_folder, first_difference
from pne_sym.review.folders import Folder
from pne_sym.review.model import Model


def reproduced(model: Model) -> Model:
    """The version with its derivation, or with where it is not what this pne-gen prints."""
    if model.bundle is not None or model.folder is None:
        return model
    if "specification" not in model.manifest:
        reason = "its manifest, of format 1, does not hold the specification"
        return replace(model, deviations=(Deviation(model.label, "", reason),))
    try:
        bundle, ours = _derived(json.dumps(model.manifest["specification"]), chosen(model.targets))
    except (SpecError, TargetError) as error:
        refused = "the specification in its manifest is refused"
        what = refused if isinstance(error, SpecError) else "its targets"
        reason = printable(f"{what}: {error}", 400)
        return replace(model, deviations=(Deviation(model.label, "", reason),))
    deviations = tuple(_deviations(model, ours))
    return replace(model, deviations=deviations, bundle=None if deviations else bundle)


@cache
def _derived(specification: str, targets: tuple[str, ...]) -> tuple[Bundle, Folder]:
    """The derivation of a full form, and its files; the same on both sides is derived once."""
    bundle = _bundle(specification)
    return bundle, as_folder(emit(bundle, targets))


@cache
def _bundle(specification: str) -> Bundle:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SpecWarning)  # told when it was generated
        return compile_bundle(from_mapping(json.loads(specification), "manifest"))


def _deviations(model: Model, ours: Folder) -> list[Deviation]:
    """Generated files that are missing, too many, or not as printed."""
    assert model.folder is not None
    found = []
    theirs = {p: e for p, e in model.folder.items() if p in ours or model.has_generated(p)}
    for path in sorted({*ours, *theirs}):
        own, other = ours.get(path), theirs.get(path)
        if own == other:
            continue
        if own is None or other is None:
            told = ["missing" if other is None else "would not be printed"]
        elif other.kind != "file":
            told = [f"a {other.kind}"]
        else:
            told = [*first_difference(own.content, other.content)]
        found.append(Deviation(model.label, path, *told))
    return found
