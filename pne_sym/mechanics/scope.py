"""What the method covers, checked before anything is derived."""

from __future__ import annotations

import numpy as np

from pne_sym.mechanics.scales import home_lengths
from pne_sym.mechanics.structure import LegType
from pne_sym.model.closure import leg_residual
from pne_sym.model.kinematics import TaskSpace, at_home
from pne_sym.model.manipulator import Manipulator

_DEPENDENT = 1e-9  # smallest relative singular value of independent degrees of freedom


def check_scope(manipulator: Manipulator, leg_type: LegType, space: TaskSpace) -> None:
    """Refuse a leg type that the method does not cover, with the mechanical reason.

    Raises:
        SpecError: more degrees of freedom than the platform joint leaves to be determined and no
            joint marked extra; degrees of freedom that are dependent at home.
    """
    index, leg = leg_type.indices[0], leg_type.model
    dofs = [j for j, joint in enumerate(leg.joints) if not joint.extra]
    moments = 0 if space.planar else leg.platform_joint.kind.moments
    most = (2 if space.planar else 3) + moments
    if len(dofs) > most:
        raise manipulator.fault(
            f"legs[{index}].joints",
            f"{len(dofs)} degrees of freedom where the platform joint leaves {most} to be "
            "determined",
            f"at most {most} joints, or the surplus ones marked extra = true",
        )
    if not dofs:
        raise manipulator.fault(
            f"legs[{index}].joints",
            "no joint left to solve for",
            "at least one joint that is not extra",
        )
    _check_independent(manipulator, leg_type, dofs, planar=space.planar)


def _check_independent(
    manipulator: Manipulator, leg_type: LegType, dofs: list[int], *, planar: bool
) -> None:
    """Refuse a leg whose degrees of freedom are dependent at home."""
    pose, displacements = at_home(manipulator)
    length = home_lengths(manipulator, leg_type).arm
    for index in leg_type.indices:
        _, by_q, _ = leg_residual(manipulator.legs[index], displacements[index], pose)
        columns = np.vstack([by_q[:2] if planar else by_q[:3], length * by_q[3:]])[:, dofs] / length
        sizes = np.linalg.norm(columns, axis=0)
        values = np.linalg.svd(columns / np.where(sizes > 0, sizes, 1.0), compute_uv=False)
        if np.min(sizes) < _DEPENDENT * np.max(sizes) or values[-1] < _DEPENDENT:
            raise manipulator.fault(
                f"legs[{index}]",
                "the leg is singular at home: its degrees of freedom move the platform joint along "
                "dependent directions",
                "a home position off the singularity, or the superfluous joint marked extra = true",
            )
