"""Live axes that are perpendicular or parallel by structure stay so, or are refused."""

from __future__ import annotations

from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.model.full_form import to_full_form
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import from_mapping
from tests.backends.c_library import INVALID, OK, QUICK, CLibrary
from tests.models import bundle, catalogue, module
from tests.oracle.closure import assemble
from tests.oracle.comparison import relative_error
from tests.oracle.projection import project
from tests.oracle.specs import from_dict
from tests.whole.cases import Array


def turn(vector: Any) -> Array:
    """Rotation matrix of a rotation vector."""
    angle = float(np.linalg.norm(vector))
    x, y, z = np.asarray(vector) / angle
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k))


@cache
def tilted() -> Manipulator:
    """The Stewart platform with other axes of the legs' frames, so that joint axes are live."""
    form: dict[str, Any] = deepcopy(to_full_form(catalogue("stewart")))
    Q = turn([0.3, 0.5, -0.2])
    for leg in form["legs"]:
        leg["base_frame"] = (np.array(leg["base_frame"]) @ Q.T).tolist()
        for joint in leg["joints"]:
            for field in ("axis", "offset"):
                joint[field] = (Q @ joint[field]).tolist()
            link = joint["link"]
            link["centre_of_mass"] = (Q @ link["centre_of_mass"]).tolist()
            tensor = Q @ link["inertia"] @ Q.T
            link["inertia"] = ((tensor + tensor.T) / 2).tolist()
    return from_mapping({**form, "name": "tilted"}, "tilted")


AXES = tuple(f"ups_joint{j}_axis" for j in (1, 2, 3))


def turned(by: dict[str, Array]) -> dict[str, Array]:
    """Axes turned by rotations."""
    p = module(tilted()).Parameters()
    return {name: getattr(p, name) @ R.T for name, R in by.items()}


def spec_with(axes: dict[str, Array]) -> Manipulator:
    """The tilted platform's specification with other axes, read without checks."""
    form: dict[str, Any] = deepcopy(to_full_form(tilted()))
    for name, values in axes.items():
        for leg, axis in zip(form["legs"], values, strict=True):
            leg["joints"][AXES.index(name)]["axis"] = axis.tolist()
    return from_dict(form)


def status(library: CLibrary, p: Any, axes: dict[str, Array]) -> int:
    """What C says of the parameters with these axes."""
    params, start = library.parameters(p), 0
    for field in library.fields:
        size = int(np.prod(field.shape, dtype=int))
        if field.name in axes:
            params[start : start + size] = axes[field.name].reshape(-1)
        start += size
    return library.prepare(params)


def test_axes_that_keep_their_angles() -> None:
    """All turned alike, or one about its neighbour: right, as generated anew."""
    model, e2 = module(tilted()), module(tilted()).Parameters().ups_joint2_axis[0]
    R = turn([0.1, -0.05, 0.08])
    for by in (dict.fromkeys(AXES, R), {AXES[0]: turn(0.2 * e2)}, {AXES[2]: turn(-0.1 * e2)}):
        axes = turned(by)
        p, spec = model.Parameters(**axes), spec_with(axes)
        X, q = assemble(spec, np.array(model.HOME_X), np.array(model.HOME_Q))
        V = np.linspace(-1.0, 1.2, 6)
        oracle = project(spec, X, q, V)
        for found, wanted in zip(
            model.dynamics(X, V, p), (oracle.M, oracle.Z, oracle.H), strict=True
        ):
            assert relative_error(found, wanted) < 1e-9


def test_axes_that_do_not(tmp_path: Path) -> None:
    model = module(tilted())
    p = model.Parameters()
    library = CLibrary(bundle(tilted()), tmp_path, flags=QUICK)
    assert library.status == OK
    assert status(library, p, {}) == OK
    for name in AXES:
        axes = turned({name: turn([0.01, 0.02, -0.01])})
        with pytest.raises(
            ValueError, match=r"ups_joint\d_axis must be perpendicular to ups_joint"
        ):
            p.replace(**axes)
        assert status(library, p, axes) == INVALID
    for size, good in ((0.5e-9, True), (2e-9, False)):
        axes = {AXES[0]: p.ups_joint1_axis + size * p.ups_joint2_axis}
        assert (status(library, p, axes) == OK) == good
        if good:
            p.replace(**axes)
        else:
            with pytest.raises(ValueError, match="ups_joint1_axis must be perpendicular"):
                p.replace(**axes)
