"""Arguments of functions about bounds of actuator forces, and about what is reachable."""

from __future__ import annotations

from typing import Any

import numpy as np


def bounded(m: Any, states: int) -> dict[str, Any]:
    """Directions, bounds within which there are forces, references beyond them, for a model m."""
    rng = np.random.default_rng(7)
    sizes = 1e4 * rng.uniform(0.5, 1.0, (2, states, m.NU))
    return {
        "direction": rng.uniform(-1.0, 1.0, (states, m.NV)),
        "wrench_direction": rng.uniform(-1.0, 1.0, (states, m.NW)),
        "tau_min": -sizes[0],
        "tau_max": sizes[1],
        "reference": 2e4 * rng.uniform(-1.0, 1.0, (states, m.NU)),
    }
