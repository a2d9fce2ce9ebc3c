"""Derivations in review: an equation explained, two versions of a model compared by meaning."""
