"""Two folders that are equal to the byte: nothing is derived or run."""

from __future__ import annotations

from pne_sym.review.difference import Comparison
from pne_sym.review.manifests import manifest_of
from pne_sym.review.sources import Source


def identical(before: Source, after: Source, tolerance: float) -> Comparison:
    """The comparison of two folders of the same files.

    Raises:
        InputError: their manifest is at fault.
    """
    manifest_of(before)
    count = len(before.folder or {})
    return Comparison(
        before.label, after.label, tolerance, (0, 0), (), (), (), (), identical_files=count
    )
