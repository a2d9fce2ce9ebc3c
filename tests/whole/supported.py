"""Entries of the catalogue: all, and one of each kind."""

from __future__ import annotations

from pne_sym import manipulators

SUPPORTED = manipulators.names()

SAMPLE = (
    "fivebar_offset",
    "hybrid_3prps",
    "spherical_3ups",
    "tripod_3rps",
)
"""One of each kind, where all would take long."""
