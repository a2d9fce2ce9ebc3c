"""Derivation -> Program: frames, components, common values, structural zeros."""
