"""Entries of the catalogue: all, and one of each kind."""

from __future__ import annotations

from pne_sym import manipulators

SUPPORTED = manipulators.names()

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
