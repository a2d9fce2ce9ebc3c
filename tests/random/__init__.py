"""Random mechanisms of every kind, derived, generated and compared with the oracle."""
