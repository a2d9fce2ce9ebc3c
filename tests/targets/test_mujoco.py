"""A closed Stewart platform in MuJoCo: armature, damping, stiffness, frictionloss, payload.

MuJoCo knows the open tree: a floating platform, and legs that end in balls.  Its equality
constraints weld the balls to the platform; what is possible under them is found from its own
Jacobians, so that the softness of its constraints does not matter: forces along them vanish in the
projection.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any
from xml.etree import ElementTree as ET

import mujoco
import numpy as np

from pne_sym.model.effects import Actuator, Friction, Spring
from pne_sym.model.manipulator import Body, Joint, Leg, Manipulator, PlatformJoint
from pne_sym.model.reader import checked
from tests.models import catalogue, live_parameters, module, state_at
from tests.oracle.coordinates import actuated_indices

Array = np.ndarray
UNTURNED = np.eye(3)
NOTHING = 1e-13
"""Mass and inertia of the balls, which MuJoCo wants above 1e-15."""
SLOW = 0.01
"""Share of the slowest joint's rate that is the velocity scale."""


@cache
def machine() -> Manipulator:
    """The catalogue's Stewart platform with all that MuJoCo has too, in every joint."""
    plain = catalogue("stewart")
    payload = Body(3.0, (0.1, -0.05, 0.2), ((0.1, 0.01, 0.0), (0.01, 0.2, 0.02), (0.0, 0.02, 0.15)))
    legs = [_dressed(leg, k) for k, leg in enumerate(plain.legs)]
    return checked(replace(plain, legs=tuple(legs), payload=payload))


def _dressed(leg: Leg, k: int) -> Leg:
    """Other numbers in every leg and joint."""

    def joint(old: Joint, number: int) -> Joint:
        size = 1.0 + 0.1 * k + 0.3 * number
        motor = Actuator(2e-4 * size, 300.0 - 20.0 * k) if old.actuated else None
        friction, spring = Friction(3.0 * size, 2.0 * size, 1e-3), Spring(40.0 * size, 0.1 * size)
        return replace(old, friction=friction, spring=spring, actuator=motor)

    joints = tuple(joint(old, number) for number, old in enumerate(leg.joints))
    end: PlatformJoint = replace(leg.platform_joint, friction=Friction(1.5 + 0.2 * k))
    return replace(leg, joints=joints, platform_joint=end)


def with_friction(manipulator: Manipulator, **changed: float) -> Manipulator:
    """The same with other numbers in the friction of all joints of the legs."""

    def joint(old: Joint) -> Joint:
        assert old.friction is not None
        return replace(old, friction=replace(old.friction, **changed))

    legs = (replace(leg, joints=tuple(map(joint, leg.joints))) for leg in manipulator.legs)
    return replace(manipulator, legs=tuple(legs))


# ---- the model in MuJoCo's format ------------------------------------------------------


def text(*values: Any) -> str:
    return " ".join(repr(float(v)) for v in np.concatenate([np.ravel(v) for v in values]))


def _body(parent: ET.Element, name: str, at: Sequence[float], rotation: Array = UNTURNED) -> Any:
    axes = np.transpose(rotation)
    return ET.SubElement(parent, "body", name=name, pos=text(at), xyaxes=text(axes[0], axes[1]))


def _inertial(parent: ET.Element, body: Body) -> None:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    inertia = text((xx, yy, zz, xy, xz, yz))
    centre, mass = text(body.centre_of_mass), repr(body.mass)
    ET.SubElement(parent, "inertial", pos=centre, mass=mass, fullinertia=inertia)


def _joint(parent: ET.Element, joint: Joint, at: Any) -> None:
    assert joint.friction is not None
    assert joint.spring is not None
    rotor = joint.actuator
    armature = rotor.rotor_inertia * rotor.gear_ratio**2 if rotor else 0.0
    ET.SubElement(
        parent,
        "joint",
        type="hinge" if joint.turns else "slide",
        axis=text(joint.axis),
        pos=text(at),
        armature=repr(armature),
        damping=repr(joint.friction.viscous),
        frictionloss=repr(joint.friction.coulomb),
        stiffness=repr(joint.spring.stiffness),
        springref=repr(joint.spring.rest),
    )


def _leg(world: ET.Element, equality: ET.Element, leg: Leg, k: int) -> None:
    """A chain of bodies; joints before massless links move the next link with a mass."""
    body, waiting = _body(world, f"base{k}", leg.base_point, leg.base_frame), []
    for j, joint in enumerate(leg.joints):
        waiting.append(joint)
        if joint.link.is_massless:
            continue
        offsets = np.array([waits.offset for waits in waiting])
        body = _body(body, f"link{k}_{j}", offsets.sum(axis=0))
        for i, waits in enumerate(waiting):
            _joint(body, waits, -offsets[i + 1 :].sum(axis=0))
        _inertial(body, joint.link)
        waiting = []
    end = _body(body, f"end{k}", leg.platform_joint.offset)
    friction = leg.platform_joint.friction
    assert friction is not None
    ET.SubElement(end, "joint", type="ball", damping=repr(friction.viscous))
    _inertial(end, Body(NOTHING, (0.0, 0.0, 0.0), (NOTHING * np.eye(3)).tolist()))
    apart = text(-np.array(leg.platform_point), (1.0, 0.0, 0.0, 0.0))
    ET.SubElement(equality, "weld", body1=f"end{k}", body2="platform", relpose=apart)


def mjcf(manipulator: Manipulator) -> str:
    """The mechanism in MuJoCo's format."""
    root = ET.Element("mujoco")
    ET.SubElement(root, "compiler", angle="radian", inertiafromgeom="false")
    # A short step lets frictionloss answer to small rates.
    ET.SubElement(root, "option", gravity=text(manipulator.gravity), timestep="1e-6")
    world, equality = ET.SubElement(root, "worldbody"), ET.SubElement(root, "equality")
    platform = _body(world, "platform", (0.0, 0.0, 0.0))
    ET.SubElement(platform, "freejoint")
    _inertial(platform, manipulator.platform)
    assert manipulator.payload is not None
    _inertial(_body(platform, "payload", (0.0, 0.0, 0.0)), manipulator.payload)
    for k, leg in enumerate(manipulator.legs):
        _leg(world, equality, leg, k)
    defaults = ET.SubElement(ET.SubElement(root, "default"), "joint")
    defaults.set("solreffriction", "2e-6 1")
    return ET.tostring(root, encoding="unicode")


# ---- its motion ----------------------------------------------------------------------------


@dataclass(frozen=True)
class Motion:
    """MuJoCo's tree at a state of the closed mechanism.

    Attributes:
        T: (nv, 6) velocities of the tree by V.
        force: (nv,) generalised forces that the motion takes.
        joints: places of the legs' joints among velocities, in the order of q.
    """

    model: Any
    data: Any
    T: Array
    force: Array
    joints: Array


def _jacobians(model: Any, data: Any, k: int) -> tuple[Array, Array]:
    """Of ball k against the platform: (6, nv) at its centre, and the rate of it."""
    end, platform = (data.body(name).id for name in (f"end{k}", "platform"))
    found = []
    for function in (mujoco.mj_jac, mujoco.mj_jacDot):
        both = []
        for body in (end, platform):
            linear, angular = np.zeros((2, 3, model.nv))
            function(model, data, linear, angular, data.body(end).xpos, body)
            both.append(np.vstack([linear, angular]))
        found.append(both[0] - both[1])
    return found[0], found[1]


def move(manipulator: Manipulator, X: Array, q: Array, V: Array, A: Array) -> Motion:
    """The tree in the state of the mechanism, and what its acceleration takes."""
    model = mujoco.MjModel.from_xml_string(mjcf(manipulator))
    data = mujoco.MjData(model)
    data.qpos[:3], data.qpos[3:7] = X[:3], X[[6, 3, 4, 5]]
    hinges = np.isin(model.jnt_type, (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE))
    data.qpos[model.jnt_qposadr[hinges]] = q
    mujoco.mj_kinematics(model, data)
    for k in range(len(manipulator.legs)):
        end = data.body(f"end{k}")
        turned = end.xmat.reshape(3, 3).T @ data.body("platform").xmat.reshape(3, 3)
        start = model.jnt_qposadr[model.body_jntadr[end.id]]
        mujoco.mju_mat2Quat(data.qpos[start : start + 4], turned.ravel())
    mujoco.mj_forward(model, data)
    legs = range(len(manipulator.legs))
    own = np.zeros((6, 6))  # angular velocities of a floating body are in its axes
    own[:3, :3], own[3:, 3:] = np.eye(3), data.body("platform").xmat.reshape(3, 3).T
    J = np.vstack([_jacobians(model, data, k)[0] for k in legs])
    T = np.vstack([own, -np.linalg.solve(J[:, 6:], J[:, :6] @ own)])
    data.qvel[:] = T @ V
    mujoco.mj_forward(model, data)
    rates = np.vstack([_jacobians(model, data, k)[1] for k in legs])
    data.qacc[:] = T @ A
    data.qacc[6:] -= np.linalg.solve(J[:, 6:], rates @ data.qvel)
    mujoco.mj_inverse(model, data)
    return Motion(model, data, T, data.qfrc_inverse.copy(), model.jnt_dofadr[hinges])


@cache
def state() -> tuple[Array, ...]:
    s = state_at(machine(), 3)
    return s.X, s.q, s.V, s.A


def test_it_is_the_same_closed_mechanism() -> None:
    """Poses, rates and accelerations of the legs; equality constraints are kept by all motions."""
    X, q, V, A = state()
    moved, m = move(with_friction(machine(), coulomb=0.0), X, q, V, A), module(machine())
    data, model = moved.data, moved.model
    welded = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    assert np.sum(welded) == len(data.efc_type) == 36
    assert np.abs(data.efc_pos[welded]).max() < 1e-14
    J = data.efc_J.reshape(-1, model.nv)[welded]
    assert np.abs(J @ moved.T).max() < 1e-13 * np.abs(J).max() * np.abs(moved.T).max()
    rates, accelerations = data.qvel[moved.joints], data.qacc[moved.joints]
    np.testing.assert_allclose(rates, m.joint_rates(X, V), rtol=0, atol=1e-12)
    np.testing.assert_allclose(accelerations, m.joint_accelerations(X, V, A), rtol=0, atol=1e-11)


def test_inertia_damping_stiffness_armature_payload_and_friction_of_balls() -> None:
    X, q, V, A = state()
    spec, m = with_friction(machine(), coulomb=0.0), module(machine())
    p, moved = live_parameters(machine(), spec), move(spec, X, q, V, A)
    actuated = actuated_indices(spec)
    full = np.zeros((moved.model.nv, moved.model.nv))
    mujoco.mj_fullM(moved.model, moved.data, full)
    for found, wanted in (
        (m.M(X, p), moved.T.T @ full @ moved.T),
        (m.H(X, p), moved.T[moved.joints[actuated]].T),
        (m.M(X, p) @ A + m.Z(X, V, p), moved.T.T @ moved.force),
        (m.H(X, p) @ m.inverse_dynamics(X, V, A, p), moved.T.T @ moved.force),
    ):
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


def test_coulomb_friction_is_frictionloss_at_speed() -> None:
    """What Coulomb friction adds, to 1e-3 of it: joints move at 100 velocity scales or more."""
    X, q, V, A = state()
    m = module(machine())
    slow = SLOW * float(np.abs(m.joint_rates(X, V)).min())
    fast = with_friction(machine(), velocity_scale=slow)
    without = with_friction(machine(), coulomb=0.0)
    forces = [m.Z(X, V, live_parameters(machine(), spec)) for spec in (fast, without)]
    moved = [move(spec, X, q, V, A) for spec in (fast, without)]
    rows = moved[0].data.efc_type == mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF
    assert np.sum(rows) == 18
    wanted = moved[0].T.T @ (moved[0].force - moved[1].force)
    scale = np.abs(wanted).max()
    assert scale > 1.0
    np.testing.assert_allclose(forces[0] - forces[1], wanted, rtol=0, atol=1e-3 * scale)
