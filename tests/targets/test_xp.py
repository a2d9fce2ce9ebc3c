"""What only array-API modules promise: derivatives, batched parameters, blocks, impossible rows."""

from __future__ import annotations

from typing import Any

import dask.array
import jax
import jax.numpy as jnp
import numpy as np
import pytest
import torch

from pne_sym.program import linear
from tests import models
from tests.targets.modules import vectors, xp_module
from tests.whole.test_complex import cases, moving

jax.config.update("jax_enable_x64", True)


def pair(name: str) -> tuple[Any, Any, dict[str, Any]]:
    """Array-API module, NumPy module and arguments of a catalogue entry."""
    manipulator = models.catalogue(name)
    m = models.module(manipulator)
    return xp_module(manipulator), m, vectors(m, 5)


def first(found: Any) -> Any:
    return found[0] if isinstance(found, tuple) else found


@pytest.mark.parametrize(
    ("name", "function", "arguments"),
    [
        ("stewart", "inverse_dynamics", "X V A"),
        ("stewart", "forward_kinematics", "q_actuated X0"),
        ("stewart_7ups", "inverse_dynamics", "X V A"),
        ("tripod_3prs", "forward_dynamics", "X V tau"),
        ("hexapod_6x6r", "inverse_kinematics", "X"),
    ],
)
def test_derivatives_are_difference_quotients(name: str, function: str, arguments: str) -> None:
    x, _, given = pair(name)
    at = [jnp.asarray(given[a][0]) for a in arguments.split()]

    def of(v: Any) -> Any:
        return first(getattr(x, function)(v, *at[1:]))

    forward, backward = (np.asarray(d(of)(at[0])) for d in (jax.jacfwd, jax.jacrev))
    step = 1e-6
    rows = [(of(at[0] + step * e) - of(at[0] - step * e)) / (2 * step) for e in jnp.eye(len(at[0]))]
    wanted = np.stack(rows, axis=-1)
    scale = np.max(np.abs(wanted))
    np.testing.assert_allclose(forward, wanted, rtol=0, atol=1e-6 * scale)
    np.testing.assert_allclose(backward, forward, rtol=0, atol=1e-9 * scale)


@pytest.mark.parametrize("function", ["inverse_dynamics", "forward_dynamics", "M", "H"])
def test_an_impossible_row_spoils_its_own_gradient_only(function: str) -> None:
    x, _, given = pair("stewart")
    X = given["X"].copy()
    X[1, 3:], X[2], X[3, :3] = 0.0, np.nan, (x._PARAMETERS["ups_base_point"][0][0])
    X[3, :3] -= np.array(x._PARAMETERS["ups_platform_point"][0][0])
    X[3, 3:] = 0.0, 0.0, 0.0, 1.0
    others = [given[n] for n in ("V", "A")] if "dynamics" in function else []

    def loss(X: Any, p: Any) -> Any:
        found = first(getattr(x, function)(X, *map(jnp.asarray, others), p))
        return jnp.sum(jnp.where(jnp.isfinite(found), found, 0.0))

    p = x.parameters(jnp)
    by_state, by_parameter = jax.grad(loss, (0, 1))(jnp.asarray(X), p)
    good = jnp.asarray(X[[0, 4]])
    others = [v[[0, 4]] for v in others]
    wanted_state, wanted_parameter = jax.grad(loss, (0, 1))(good, p)
    np.testing.assert_allclose(by_state[jnp.asarray([0, 4])], wanted_state, rtol=1e-9)
    for name, wanted in wanted_parameter.items():
        atol = 1e-9 * float(jnp.max(jnp.abs(wanted))) + 1e-12
        np.testing.assert_allclose(by_parameter[name], wanted, rtol=1e-9, atol=atol, err_msg=name)


def test_parameters_carry_batch_dimensions() -> None:
    x, m, given = pair("stewart")
    masses = np.linspace(8.0, 16.0, 5)
    p = x.parameters(np) | {"platform_mass": masses}
    found = x.inverse_dynamics(given["X"], given["V"], given["A"], p)
    across = x.M(given["X"][:, None], p)
    assert across.shape == (5, 5, 6, 6)
    for k, mass in enumerate(masses):
        own = m.Parameters(platform_mass=mass)
        state = [given[n][k] for n in ("X", "V", "A")]
        np.testing.assert_allclose(found[k], m.inverse_dynamics(*state, own), rtol=1e-11)
        np.testing.assert_allclose(across[:, k], m.M(given["X"], own), rtol=1e-11, atol=1e-13)


def test_jax_transforms() -> None:
    x, m, given = pair("stewart")
    state = [jnp.asarray(given[n]) for n in ("X", "V", "A")]
    wanted = m.inverse_dynamics(*(given[n] for n in ("X", "V", "A")))
    p = x.parameters(jnp)
    run = jax.jit(jax.vmap(x.inverse_dynamics, (0, 0, 0, None)))
    np.testing.assert_allclose(run(*state, p), wanted, rtol=1e-11)
    masses = jnp.linspace(8.0, 16.0, 5)
    mapped = jax.vmap(lambda X, mass: x.M(X, p | {"platform_mass": mass}))(state[0], masses)
    np.testing.assert_allclose(mapped, x.M(state[0], p | {"platform_mass": masses}), rtol=1e-12)


def test_torch_gradients_are_jax_s() -> None:
    x, _, given = pair("stewart")
    X = torch.tensor(given["X"], requires_grad=True)
    x.inverse_dynamics(X, *(torch.tensor(given[n]) for n in ("V", "A"))).sum().backward()
    others = [jnp.asarray(given[n]) for n in ("V", "A")]
    wanted = jax.grad(lambda X: x.inverse_dynamics(X, *others).sum())(jnp.asarray(given["X"]))
    np.testing.assert_allclose(X.grad.numpy(), wanted, rtol=1e-9, atol=1e-9)


def test_dask_by_blocks_of_states() -> None:
    x, m, given = pair("stewart")
    X, V = (dask.array.from_array(given[n], chunks=(2, -1)) for n in ("X", "V"))
    Z = dask.array.map_blocks(x.Z, X, V, dtype=float, chunks=(X.chunks[0], (x.NV,)))
    np.testing.assert_allclose(Z.compute(), m.Z(given["X"], given["V"]), rtol=1e-11, atol=1e-12)


def test_a_pivot_near_the_threshold_counts_as_in_numpy() -> None:
    x, m, _ = pair("stewart")
    rng, count = np.random.default_rng(1), 400
    a, b = rng.uniform(-1.0, 1.0, (count, 6, 6)), rng.uniform(-1.0, 1.0, (count, 6))
    a[:, 5] = a[:, 4]
    a[:, 5, 2] += np.logspace(-14.0, -10.0, count)
    state = x._State.__new__(x._State)
    state.xp, state.dtype, state.flags, state.lead = np, np.float64, [], (count,)
    state.ok, state.pivot = np.ones(count, dtype=bool), 2.0**-39
    rows, sides = np.moveaxis(a, 0, -1), b.T
    state.solve(rows, sides)
    wanted, least = np.isfinite(m._solve(rows, sides)).all(axis=0), linear.least_pivot(a)
    near = np.abs(least - linear.PIVOT) < 0.03 * linear.PIVOT  # eps^(3/4), there to two digits
    assert np.sum(near) < 10
    assert min(np.sum(wanted), np.sum(~wanted)) > 50
    np.testing.assert_array_equal(state.ok[~near], wanted[~near])


def test_complex_numbers_are_refused() -> None:
    for spec in (moving(), models.catalogue("tripod_3prs")):
        for function, argument, values in cases(spec):
            call = getattr(xp_module(spec), function.name)
            with pytest.raises(ValueError, match=rf"^{argument.name} has type complex128"):
                call(**{**values, argument.name: values[argument.name] + 0j})
