"""The generated C computes what the generated NumPy computes, for the whole catalogue."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pne_sym.backends.describe import describe
from tests import models
from tests.backends.c_agreement import assert_agree, vectors
from tests.backends.c_library import FAST, OK, QUICK, CLibrary
from tests.sampling import entries

STATES = 19  # two lanes of 8 states, and a remainder


@pytest.mark.parametrize("name", entries(2, keep=["stewart"]))
def test_catalogue(name: str, tmp_path: Path) -> None:
    nominal, other = models.catalogue(name), models.random_spec(name, 1)
    module, p = models.module(nominal), models.live_parameters(nominal, other)
    library = CLibrary(models.bundle(nominal), tmp_path, flags=FAST if name == "stewart" else QUICK)
    assert library.status == OK
    assert library.prepare(library.parameters(p)) == OK
    states = [models.state_at(other, seed) for seed in range(2)]
    X, q = np.array([s.X for s in states]), np.array([s.q for s in states])
    first = {"q0": q} if describe(models.bundle(nominal)).is_numeric else {}
    q = module.inverse_kinematics(X, p, **first)  # on the branch of the nominal home
    given = vectors(module, X, q, STATES, np.random.default_rng(0))
    assert assert_agree(library, module, given, p) >= 12
