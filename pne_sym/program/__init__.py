"""Scalar straight-line programs: stages, statements, functions, counts."""
