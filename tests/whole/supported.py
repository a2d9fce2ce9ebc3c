"""Which entries of the catalogue the engine handles, and why not the others: the one list."""

from __future__ import annotations

from pne_sym import manipulators

UNSUPPORTED: dict[str, str] = {}
"""Name -> part of the message with which it is refused."""

SUPPORTED = tuple(name for name in manipulators.names() if name not in UNSUPPORTED)

SAMPLE = (
    "fivebar_offset",
    "hexapod_6ucu",
    "hybrid_3prps",
    "hybrid_3rrrs",
    "planar_mixed",
    "spherical_3ups",
    "stewart",
    "stewart_sps",
    "tripod_3rps",
)
"""One of each kind, where all would take long."""
