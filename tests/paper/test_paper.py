"""The four worked examples of the paper: the engine against the printed formulas.

As corrected they agree to rounding; with the errata E1 to E4 left in they do not.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.full_form import to_full_form
from tests.models import catalogue, live_parameters, module
from tests.oracle.projection import project
from tests.paper.engine import leg_quantities
from tests.paper.figures import (
    EXAMPLES,
    dofs,
    errata,
    figures,
    leg_table,
    platform_table,
    relative,
    spread,
)
from tests.paper.printed import (
    PRINTED,
    Array,
    assemble_point,
    assemble_spatial,
    columns,
)
from tests.paper.sampling import (
    NAMES,
    Sample,
    gravity,
    platform,
    point_legs,
    samples,
    spatial_legs,
)

TOLERANCE = 1e-10
PAGE = Path(__file__).parents[2] / "docs" / "paper-check.md"


def legs_of(sample: Sample) -> list[Any]:
    return list(spatial_legs(sample) if len(sample.X) == 7 else point_legs(sample))


def generated(sample: Sample) -> tuple[Any, Any]:
    """The generated module, and the sample's numbers as its parameters."""
    nominal = catalogue(sample.manipulator.name)
    return module(nominal), live_parameters(nominal, sample.manipulator)


def derived(sample: Sample) -> Iterator[tuple[Any, Array, Array]]:
    """Per leg: the paper's leg, and the derivation's Q and U with the last link's mass."""
    form = to_full_form(sample.manipulator)
    for index, leg in enumerate(legs_of(sample)):
        turning = len(sample.X) == 7
        wanted = ("Q", "U", "u_1") if turning else ("Q", "U")
        found = leg_quantities(sample, form, index, wanted)
        Q, U = found["Q"], found["U"]
        if sample.manipulator.name != "tripod_3rps":
            mass = sample.manipulator.legs[index].joints[-1].link.mass
            Q = Q + mass * np.eye(3)
            U = U + mass * (found.get("u_1", np.zeros(3)) - gravity(sample))
        size = len(leg.U())
        yield leg, Q[:size, :size], U[:size]


def corrected(sample: Sample) -> tuple[Array, Array, Array]:
    """M and Z by the paper's formulas, and the directions in which the platform moves."""
    if len(sample.X) == 2:
        payload, g = sample.manipulator.platform.mass, gravity(sample)[:2]
        M, Z, _ = assemble_point(point_legs(sample), payload, g)
        return M, Z, np.eye(2)
    legs = spatial_legs(sample)
    along = dofs(legs) if sample.manipulator.name == "tripod_3rps" else np.eye(6)
    return (*assemble_spatial(platform(sample), legs), along)


@pytest.mark.parametrize("name", NAMES)
def test_legs_of_the_derivation(name: str) -> None:
    """Q and U as the report states them."""
    count = 0
    for sample in samples(name)[:50]:
        for leg, Q, U in derived(sample):
            assert relative(Q, leg.Q()) < TOLERANCE
            assert relative(U, leg.U()) < TOLERANCE
            count += 1
    assert count >= 100


@pytest.mark.parametrize("name", NAMES)
def test_leg_forces_of_the_generated_code(name: str) -> None:
    """F = h tau + k lambda - Q a_p - U, for accelerations of the platform origin."""
    for sample in samples(name):
        model, p = generated(sample)
        legs = legs_of(sample)
        size = len(legs[0].U())
        A = np.zeros((size + 1, len(sample.V)))
        A[1:, :size] = np.eye(size)
        efforts = model.inverse_dynamics(sample.X, sample.V, A, p)
        tau, lam = efforts if name == "tripod_3rps" else (efforts, None)
        forces = model.leg_reactions(sample.X, sample.V, A, p)[..., :size]
        actuators = iter(range(tau.shape[-1]))
        for index, leg in enumerate(legs):
            given = sum(tau[:, [next(actuators)]] * h for h in leg.h())
            if lam is not None:
                given = given + lam[:, [index]] * leg.k
            passive = given - forces[:, index]
            scale = 1.0 + np.max(np.abs(given)) / np.max(np.abs(leg.U()))  # cancelled above
            assert relative(passive[0], leg.U()) < TOLERANCE * scale
            assert relative((passive[1:] - passive[0]).T, leg.Q()) < TOLERANCE * scale


@pytest.mark.parametrize("name", NAMES[:2])
def test_five_bars(name: str) -> None:
    """M, Z, H of sections 4.1 and 4.2, right as printed."""
    for sample in samples(name):
        model, p = generated(sample)
        payload, g = sample.manipulator.platform.mass, gravity(sample)[:2]
        expected = assemble_point(point_legs(sample), payload, g)
        for found, right in zip(model.dynamics(sample.X, sample.V, p), expected, strict=True):
            assert relative(found, right) < TOLERANCE


@pytest.mark.parametrize("name", EXAMPLES)
def test_platforms(name: str) -> None:
    """M, Z, H or Hs, and Hk of sections 5.2 and 5.4."""
    for sample in samples(name):
        model, p = generated(sample)
        legs = spatial_legs(sample)
        M, Z, _ = corrected(sample)
        found = model.dynamics(sample.X, sample.V, p)
        for matrix, right in zip(
            found, (M, Z, columns(legs, [leg.h() for leg in legs])), strict=True
        ):
            assert relative(matrix, right) < TOLERANCE
        if name == "tripod_3rps":
            assert (
                relative(model.Hk(sample.X, p), columns(legs, [[leg.k] for leg in legs]))
                < TOLERANCE
            )
            assert max(abs(leg.S @ leg.k) for leg in legs) < 1e-12  # Eq. 37
            bias = model.constraint_bias(sample.X, sample.V, p)
            u_1 = [np.cross(leg.omega, np.cross(leg.omega, leg.q)) for leg in legs]
            right = np.array([leg.k @ u for leg, u in zip(legs, u_1, strict=True)])
            assert relative(bias, right) < TOLERANCE


@pytest.mark.parametrize("name", EXAMPLES)
def test_errata_fail(name: str) -> None:
    """Each erratum alone spoils U and Z; the engine sides with the corrected formulas."""
    group = samples(name)[:20]
    for kind in errata(name):
        printed = frozenset({kind})
        legs = spread(relative(U, leg.U(printed)) for s in group for leg, _, U in derived(s))
        assert legs.maximum > 1e-2
        wrong = []
        for sample in group:
            model, p = generated(sample)
            Z = assemble_spatial(platform(sample), spatial_legs(sample), printed)[1]
            wrong.append(relative(model.Z(sample.X, sample.V, p), Z))
        assert spread(wrong).median > 1e-4


@pytest.mark.parametrize("name", NAMES)
def test_the_oracle_decides(name: str) -> None:
    """Body poses differentiated exactly, and a projection: neither the engine nor the paper."""
    for sample in samples(name)[:20]:
        q = np.array(sample.manipulator.home.q)
        decided = project(sample.manipulator, sample.X, q, sample.V)
        M, Z, along = corrected(sample)
        assert relative(along @ M @ along.T, along @ decided.M @ along.T) < TOLERANCE
        assert relative(along @ Z, along @ decided.Z) < TOLERANCE
        if name in EXAMPLES:
            wrong = assemble_spatial(platform(sample), spatial_legs(sample), PRINTED)[1]
            assert relative(along @ wrong, along @ decided.Z) > 1e-4


@pytest.mark.parametrize("name", EXAMPLES)
def test_where_the_norm_does_no_harm(name: str) -> None:
    """E4 is wrong only where the leg turns against k."""
    assert figures(name).forwards.maximum < 1e-14
    assert figures(name).backwards.median > 0.05


@pytest.mark.parametrize("name", EXAMPLES)
def test_terms_that_vanish(name: str) -> None:
    """E7: terms that are printed although they are zero."""
    assert max(leg.vacuous() for s in samples(name) for leg in spatial_legs(s)) < 1e-13


def test_the_slide_of_a_prps_leg_carries_all_links() -> None:
    """E3 is an error of m_d u_2 along k, no more and no less."""
    for sample in samples("hybrid_3prps"):
        for leg in spatial_legs(sample):
            u_1 = np.cross(leg.omega, np.cross(leg.omega, leg.q))
            error = leg.U() - leg.U(frozenset({"E3"}))
            assert np.allclose(error, leg.m_slide * (leg.k @ u_1) * leg.k, atol=1e-12)


@pytest.mark.parametrize("name", EXAMPLES)
def test_statics_are_right_as_printed(name: str) -> None:
    """At rest the errata have no effect: they concern velocities only."""
    for sample in samples(name)[:20]:
        at_rest = sample._replace(V=np.zeros(6))
        for leg in spatial_legs(at_rest):
            assert relative(leg.U(PRINTED), leg.U()) < 1e-14


@pytest.mark.parametrize("table", [leg_table, platform_table])
def test_the_page_tells_these_figures(table: Any) -> None:
    assert table() in PAGE.read_text(encoding="utf-8")
