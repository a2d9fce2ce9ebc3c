"""Tests of pne_sym."""

import pne_sym  # noqa: F401  (before SymPy: it settles how much SymPy keeps)
