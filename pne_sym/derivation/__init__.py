"""A derivation as data: named equations, the laws behind them, the notation."""

from pne_sym.derivation.equation import (
    Chapter,
    Derivation,
    Equation,
    Law,
    Quantity,
    ReciprocalBasis,
)

__all__ = ["Chapter", "Derivation", "Equation", "Law", "Quantity", "ReciprocalBasis"]
