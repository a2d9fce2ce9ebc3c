"""Tests of pne_sym."""

import gc

import pne_sym  # noqa: F401  (before SymPy: it settles how much SymPy keeps)

# Expressions are millions of small objects, next to none of them in a cycle: to look for cycles
# less often takes 6 % off what is derived here.
gc.set_threshold(50_000, 20, 100)
