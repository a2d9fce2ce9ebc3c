"""The mechanism in MuJoCo: the same tree, its platform joints as equality constraints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from bench.cases import Array, Case, States
from pne_sym.model.manipulator import Body, JointKind, Leg, Space

HARD = {"solref": "0.002 1", "solimp": "0.9999 0.9999 0.001"}
"""Constraints nearly as stiff as the solver takes them; they stay soft."""


def text(*values: Any) -> str:
    """Numbers, with all digits."""
    return " ".join(repr(float(v)) for v in np.concatenate([np.ravel(v) for v in values]))


def _inertial(parent: ET.Element, body: Body, *, planar: bool) -> None:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    # In the plane only izz matters, and MuJoCo wants inertias of real bodies.
    inertia = text((zz, zz, zz, 0, 0, 0) if planar else (xx, yy, zz, xy, xz, yz))
    centre, mass = text(body.centre_of_mass), repr(body.mass)
    ET.SubElement(parent, "inertial", pos=centre, mass=mass, fullinertia=inertia)


def _leg(world: ET.Element, leg: Leg, number: int, *, planar: bool) -> None:
    """A chain of bodies; joints before massless links move the next link with a mass."""
    axes = np.transpose(leg.base_frame)
    frame = {"pos": text(leg.base_point), "xyaxes": text(axes[0], axes[1])}
    body = ET.SubElement(world, "body", frame)
    waiting: list[dict[str, str]] = []
    at = np.zeros(3)
    for joint in leg.joints:
        at = at + np.array(joint.offset)
        kind = "hinge" if joint.kind is JointKind.REVOLUTE else "slide"
        waiting.append({"type": kind, "axis": text(joint.axis)})
        if joint.link.is_massless:
            continue
        body = ET.SubElement(body, "body", pos=text(at))
        for given in waiting:
            ET.SubElement(body, "joint", given)
        _inertial(body, joint.link, planar=planar)
        waiting, at = [], np.zeros(3)
    ET.SubElement(body, "site", name=f"end{number}", pos=text(leg.platform_joint.offset))


def mjcf(case: Case) -> str:
    """The model in MuJoCo's format."""
    manipulator = case.manipulator
    root = ET.Element("mujoco")
    ET.SubElement(root, "compiler", angle="radian")
    option = ET.SubElement(root, "option", gravity=text(manipulator.gravity), jacobian="dense")
    ET.SubElement(option, "flag", contact="disable", warmstart="disable")
    world, equality = ET.SubElement(root, "worldbody"), ET.SubElement(root, "equality")
    platform = ET.SubElement(world, "body", name="platform")
    planar = manipulator.space is not Space.SPATIAL
    if not planar:
        ET.SubElement(platform, "freejoint")
    else:
        for kind, axis in (("slide", "1 0 0"), ("slide", "0 1 0"), ("hinge", "0 0 1")):
            ET.SubElement(platform, "joint", type=kind, axis=axis)
    _inertial(platform, manipulator.platform, planar=planar)
    for k, leg in enumerate(manipulator.legs):
        ET.SubElement(platform, "site", name=f"seat{k}", pos=text(leg.platform_point))
        _leg(world, leg, k, planar=planar)
        ET.SubElement(equality, "connect", HARD, site1=f"end{k}", site2=f"seat{k}")
    return ET.tostring(root, encoding="unicode")


class _Closed:
    """The model at states that keep the constraints; tree velocities are given to it."""

    def __init__(self, case: Case, s: States) -> None:
        m, self.s = case.module(), s
        self.model: Any = mujoco.MjModel.from_xml_string(mjcf(case))
        self.data: Any = mujoco.MjData(self.model)
        self.spatial = case.manipulator.space is Space.SPATIAL
        task = 6 if self.spatial else 3
        self.actuated = task + np.array(m.ACTUATED)
        pose, V, A = (np.array(a) for a in (s.X, s.V, s.A))
        self.turn: Array | None = None
        if self.spatial:  # angular velocities of a floating body are in its axes
            self.turn = turn = m.rotation(s.X)
            pose = pose[:, [0, 1, 2, 6, 3, 4, 5]]
            pose[:, 3:] /= np.linalg.norm(pose[:, 3:], axis=1, keepdims=True)
            for a in (V, A):
                a[:, 3:] = np.einsum("nji,nj->ni", turn, a[:, 3:])
        self.qpos = np.hstack([pose, m.inverse_kinematics(s.X)])
        self.qvel = np.hstack([V, m.joint_rates(s.X, s.V)])
        self.qacc = np.hstack([A, m.joint_accelerations(s.X, s.V, s.A)])
        rows = np.arange(3 * len(case.manipulator.legs))
        self.rows = rows if self.spatial else rows[rows % 3 < 2]
        self.selection = np.eye(self.model.nv)[:, self.actuated]

    def _set(self, k: int) -> None:
        self.data.qpos[:], self.data.qvel[:] = self.qpos[k], self.qvel[k]

    def inverse_dynamics(self, k: int) -> tuple[Array]:
        """The tree's forces, shared out among actuators and constraints."""
        self._set(k)
        self.data.qacc[:] = self.qacc[k]
        mujoco.mj_inverse(self.model, self.data)
        closures = self.data.efc_J.reshape(-1, self.model.nv)[self.rows]
        both = np.hstack([self.selection, closures.T])
        return (np.linalg.solve(both, self.data.qfrc_inverse)[: len(self.actuated)],)

    def forward_dynamics(self, k: int) -> tuple[Array]:
        """MuJoCo's own acceleration, with constraints that give."""
        self._set(k)
        self.data.qfrc_applied[self.actuated] = self.s.tau[k]
        mujoco.mj_forward(self.model, self.data)
        A = self.data.qacc[: self.s.A.shape[1]].copy()
        if self.turn is not None:
            A[3:] = self.turn[k] @ A[3:]
        return (A,)


def in_mujoco(case: Case, s: States) -> Iterator[tuple[str, Callable[[int], Any]]]:
    """Keys, and what computes the state of a number."""
    closed = _Closed(case, s)
    yield "MuJoCo, mj_inverse inverse_dynamics", closed.inverse_dynamics
    yield "MuJoCo, mj_forward forward_dynamics", closed.forward_dynamics
