"""Models that are new or gone, and folders of models: one answer for all of them."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from pne_sym.generation import InputError
from pne_sym.review.diff_text import in_full
from pne_sym.review.difference import Comparison
from pne_sym.review.manifests import manifest_of
from pne_sym.review.markdown import Part, part_of
from pne_sym.review.sources import Source, same_bytes


@dataclass(frozen=True)
class Options:
    """How versions are compared; as `compare` has them."""

    tolerance: float
    run: bool
    c: bool


def compare_sources(before: Source, after: Source, options: Options) -> list[Part]:
    """What is told of every model of two sources, of which one may be none.

    A model that cannot be compared is told as such; the others are compared all the same.

    Raises:
        InputError: a folder of models is to be compared with a single one.
    """
    sides = []
    for mine, other in ((before, after), (after, before)):
        if mine.models is None and other.models is not None and not mine.is_none:
            raise InputError(
                f"{mine.label[:100]!r} is one model, {other.label[:100]!r} holds several"
            )
        single = {} if mine.is_none else {mine.name: mine}
        sides.append(single if mine.models is None else dict(mine.models))
    names = sorted(sides[0].keys() | sides[1].keys())
    if before.is_none != after.is_none:
        known = after if before.is_none else before
        names = names if known.models is not None else [known.name]
    return [_told(name, sides[0].get(name), sides[1].get(name), options) for name in names]


def _told(name: str, before: Source | None, after: Source | None, options: Options) -> Part:
    from pne_sym.backends.target import TargetError
    from pne_sym.model.errors import SpecError, printable

    try:
        if before is not None and after is not None:
            if before.folder is None and same_bytes(before, after):
                return Part(name, "equal: identical text", is_equal=True)
            return part_of(name, compared(before, after, options))
        known = after if after is not None else before
        assert known is not None
        what = "new model" if before is None else "deleted"
        return Part(name, f"{what}: {_described(known)}")
    except Exception as error:  # noqa: BLE001 - the others are compared all the same
        is_input = isinstance(error, InputError | SpecError | TargetError)
        told = f"{'' if is_input else f'internal error: {type(error).__name__}: '}{error}"
        return Part(name, f"cannot be compared: {printable(told, 400)}")


def compared(before: Source, after: Source, options: Options) -> Comparison:
    """Two versions of a model; nothing of two folders of the same files is derived or run.

    Raises:
        InputError: one is no model, or its manifest is at fault.
        SpecError: a specification is at fault.
    """
    if before.folder is not None and same_bytes(before, after):
        manifest_of(before)
        labels, count = (before.label, after.label), len(before.folder)
        return Comparison(*labels, options.tolerance, identical_files=count)
    from pne_sym.review.compare import compare
    from pne_sym.review.model import version_of

    versions = version_of(before), version_of(after)
    return compare(*versions, **vars(options))


def _described(source: Source) -> str:
    """A model in one line."""
    from pne_sym.review.model import version_of

    m = version_of(source).manifest
    sizes, counted = m["sizes"], Counter[str]()
    for t in m["leg_types"]:
        counted[t["architecture"]] += len(t["legs"])
    legs = ", ".join(f"{n} {architecture}" for architecture, n in counted.items())
    actuators = f"{sizes['NV']} degrees of freedom, {sizes['NU']} actuators"
    return f"{m['title']} ({m['space']}; legs: {legs}; {actuators})"


def as_text(before: Source, after: Source, parts: list[Part]) -> Iterator[str]:
    """Lines of plain text: equal models together, then one after the other."""
    yield f"--- {before.label}"
    yield f"+++ {after.label}"
    equal = [p.name for p in parts if p.is_equal]
    if equal:
        yield f"equal: {', '.join(equal)}"
    for part in (p for p in parts if not p.is_equal):
        yield ""
        headline = f"{part.name}: {part.headline}"
        yield from in_full(headline, part.measured, part.sections, part.notes)


def as_json(before: Source, after: Source, parts: list[Part]) -> str:
    """Plain data as JSON."""
    told = {
        "before": before.label,
        "after": after.label,
        "equal": all(p.is_equal for p in parts),
        "models": {p.name: {"equal": p.is_equal, "headline": p.headline} for p in parts},
    }
    return json.dumps(told, indent=1, ensure_ascii=False)
