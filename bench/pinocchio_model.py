"""The mechanism in Pinocchio: a tree of platform and legs, closed at the platform joints."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from bench.cases import BUILD, Array, Case, States
from bench.programs import C_SOURCES, Program, compiled
from pne_sym.model.manipulator import Body, JointKind, Space

FREE, SLIDE_X, SLIDE_Y, TURN_Z, REVOLUTE, PRISMATIC = range(6)
ROUNDS = 10
DEFINES = " ".join(
    f"-D{name}"
    for name in (
        "BOOST_MPL_LIMIT_LIST_SIZE=30",
        "BOOST_MPL_LIMIT_VECTOR_SIZE=30",
        "BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
        "BOOST_FUSION_INVOKE_MAX_ARITY=12",
        "PINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION",
    )
)
"""As Pinocchio's own package defines: its joints are more than Boost's lists hold by default."""
NOTHING = Body()


@dataclass(frozen=True)
class TreeJoint:
    """A joint of the tree and the body that it moves.

    Attributes:
        parent: number of the joint before it; 0: the base.
        kind: one of the constants above.
        axis: in its own frame.
        rotation: of its frame in that of the parent.
        place: of its frame in that of the parent, m.
        body: what it moves.
    """

    parent: int
    kind: int
    axis: Any
    rotation: Array
    place: Any
    body: Body

    def numbers(self) -> Array:
        """As pinocchio.cpp reads them."""
        body = self.body
        parts = (self.axis, self.rotation, self.place, body.mass, body.centre_of_mass, body.inertia)
        return np.concatenate([[self.parent, self.kind], *(np.ravel(p) for p in parts)])


class Tree:
    """The tree of a mechanism with legs of revolute and prismatic joints."""

    def __init__(self, case: Case) -> None:
        self.case, manipulator = case, case.manipulator
        self.spatial = manipulator.space is Space.SPATIAL
        kinds = (FREE,) if self.spatial else (SLIDE_X, SLIDE_Y, TURN_Z)
        self.joints = [
            TreeJoint(k, kind, (0, 0, 1), np.eye(3), (0, 0, 0), NOTHING)
            for k, kind in enumerate(kinds[:-1])
        ]
        last = TreeJoint(
            len(kinds) - 1, kinds[-1], (0, 0, 1), np.eye(3), (0, 0, 0), manipulator.platform
        )
        self.joints.append(last)
        self.platform, self.task = len(kinds), 6 if self.spatial else 3
        self.ends = [self._add_leg(k) for k in range(len(manipulator.legs))]

    def _add_leg(self, number: int) -> int:
        leg, parent = self.case.manipulator.legs[number], 0
        for k, joint in enumerate(leg.joints):
            frame = np.array(leg.base_frame) if k == 0 else np.eye(3)
            place = frame @ np.array(joint.offset)
            place = place + np.array(leg.base_point) if k == 0 else place
            kind = REVOLUTE if joint.kind is JointKind.REVOLUTE else PRISMATIC
            self.joints.append(TreeJoint(parent, kind, joint.axis, frame, place, joint.link))
            parent = len(self.joints)
        return parent

    @property
    def actuated(self) -> Array:
        """Places of the actuated joints in the tree's velocity."""
        return self.task + np.array(self.case.module().ACTUATED)

    def configurations(self, s: States) -> Array:
        """q of the tree, with the displacements that close the legs."""
        m = self.case.module()
        pose = np.array(s.X)
        if self.spatial:
            pose[:, 3:] /= np.linalg.norm(pose[:, 3:], axis=1, keepdims=True)
        return np.hstack([pose, m.inverse_kinematics(s.X)])

    def numbers(self, s: States) -> Array:
        """All that pinocchio.cpp reads."""
        manipulator = self.case.manipulator
        parts: list[ArrayLike] = []
        parts += [[self.task], manipulator.gravity, [len(self.joints)]]
        parts += [joint.numbers() for joint in self.joints]
        parts.append([len(self.ends)])
        first = self.task
        for end, leg in zip(self.ends, manipulator.legs, strict=True):
            parts.append([first, len(leg.joints), 3 if self.spatial else 2])
            parts += [[end], leg.platform_joint.offset, [self.platform], leg.platform_point]
            first += len(leg.joints)
        parts += [[len(self.actuated)], self.actuated, [len(s.X)]]
        rows = np.hstack([self.configurations(s), s.V, s.A])
        return np.concatenate([np.ravel(np.asarray(p, dtype=float)) for p in (*parts, rows)])


def eigen() -> Path | None:
    """The folder of Eigen's headers, or None."""
    places = [os.environ.get("EIGEN", "/usr/include/eigen3"), "/usr/local/include/eigen3"]
    return next((Path(p) for p in places if (Path(p) / "Eigen" / "Core").exists()), None)


def projection_program() -> str | None:
    """Compile Pinocchio's projection, which takes minutes; None where there is no Eigen."""
    headers, prefix = eigen(), Path(pin.__file__).parents[4]
    if headers is None:
        return None
    flags = f"-O3 -w {DEFINES} -I{prefix}/include -I{headers} -L{prefix}/lib"
    libraries = f"-Wl,-rpath,{prefix}/lib -Wl,--no-as-needed -lpinocchio_default"
    return compiled("pinocchio", "g++", [C_SOURCES / "pinocchio.cpp"], f"{flags} {libraries}")


def projection(case: Case, program: str | None) -> list[Program]:
    """Pinocchio's C++ on the tree; nothing where it could not be compiled."""
    if program is None:
        return []
    tree = BUILD / f"{case.name}.tree"
    tree.write_bytes(Tree(case).numbers(case.states()).tobytes())
    return [Program(case, "Pinocchio, projection", "gcc", (program, str(tree), str(ROUNDS)))]


# ---- forward dynamics with constraints, from Python ------------------------------------------


def _model(tree: Tree) -> Any:
    model = pin.Model()
    model.gravity = pin.Motion(np.array(tree.case.manipulator.gravity), np.zeros(3))
    simple = {
        FREE: pin.JointModelFreeFlyer,
        SLIDE_X: pin.JointModelPX,
        SLIDE_Y: pin.JointModelPY,
        TURN_Z: pin.JointModelRZ,
    }
    along = {
        REVOLUTE: pin.JointModelRevoluteUnaligned,
        PRISMATIC: pin.JointModelPrismaticUnaligned,
    }
    for number, j in enumerate(tree.joints):
        joint = (
            along[j.kind](np.array(j.axis, dtype=float)) if j.kind in along else simple[j.kind]()
        )
        placement = pin.SE3(j.rotation, np.array(j.place, dtype=float))
        added = model.addJoint(j.parent, joint, placement, f"joint{number}")
        centre, inertia = np.array(j.body.centre_of_mass), np.array(j.body.inertia)
        model.appendBodyToJoint(
            added, pin.Inertia(j.body.mass, centre, inertia), pin.SE3.Identity()
        )
    return model


def constraint_dynamics(case: Case, s: States) -> Callable[[int], tuple[Array]]:
    """A of the state of a number, by pin.constraintDynamics."""
    tree = Tree(case)
    model, closures = _model(tree), pin.StdVec_RigidConstraintModel()
    for end, leg in zip(tree.ends, case.manipulator.legs, strict=True):
        places = [
            pin.SE3(np.eye(3), np.array(p)) for p in (leg.platform_joint.offset, leg.platform_point)
        ]
        closure = pin.RigidConstraintModel(
            pin.ContactType.CONTACT_3D, model, end, places[0], tree.platform, places[1], pin.LOCAL
        )
        closures.append(closure)
    data, found = model.createData(), pin.StdVec_RigidConstraintData()
    for closure in closures:
        found.append(closure.createData())
    pin.initConstraintDynamics(model, data, closures, found)
    settings = pin.ProximalSettings(1e-12, 1e-10, 10)
    q = tree.configurations(s)
    to_base, bias = np.tile(np.eye(tree.task), (len(q), 1, 1)), np.zeros((len(q), tree.task))
    v, tau = np.zeros((2, len(q), model.nv))
    v[:, : tree.task], v[:, tree.task :] = s.V, case.module().joint_rates(s.X, s.V)
    tau[:, tree.actuated] = s.tau
    if tree.spatial:  # the tree's velocity of the platform is in its own axes
        to_base[:, :3, :3] = to_base[:, 3:, 3:] = case.module().rotation(s.X)
        v[:, :6] = np.einsum("nji,nj->ni", to_base, s.V)
        bias[:, :3] = np.cross(s.V[:, 3:], s.V[:, :3])

    def accelerations(k: int) -> tuple[Array]:
        a = pin.constraintDynamics(model, data, q[k], v[k], tau[k], closures, found, settings)
        return (to_base[k] @ a[: tree.task] + bias[k],)

    return accelerations
