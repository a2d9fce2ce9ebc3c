"""Kinds of joints and of platform joints: one object each, which the rest of the program asks."""

from __future__ import annotations

import copy
import pickle
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pne_sym.model.closure import leg_residual
from pne_sym.model.joint_kinds import JointKind, WrittenJoint
from pne_sym.model.kind import Kind, letters
from pne_sym.model.kinematics import Pose, chain_pose, rotation_about
from pne_sym.model.manipulator import IDENTITY3, ZERO3, Joint, Leg, PlatformJoint
from pne_sym.model.platform_kinds import PlatformJointKind

ROOT = Path(__file__).parents[2]
KINDS: list[Kind] = [*WrittenJoint, *PlatformJointKind]
X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def test_lists_are_in_order() -> None:
    assert letters(JointKind) == "R, P or H"
    assert letters(WrittenJoint) == "R, P, H, U, C or S"
    assert letters(PlatformJointKind) == "S, R, U or rigid"


@pytest.mark.parametrize("kind", KINDS, ids=repr)
def test_a_kind_is_one_object(kind: Kind) -> None:
    assert copy.deepcopy(kind) is pickle.loads(pickle.dumps(kind)) is kind
    family = PlatformJointKind if isinstance(kind, PlatformJointKind) else WrittenJoint
    assert family(kind.letter) is kind is getattr(family, kind.name)
    assert kind == kind.letter == str(kind) == kind.value == f"{kind}"
    assert [other for other in family if kind == other] == [kind]


def test_no_kind_of_this_letter() -> None:
    with pytest.raises(ValueError, match="'Q' is not a valid JointKind"):
        JointKind("Q")
    with pytest.raises(ValueError, match="'U' is not a valid JointKind"):
        JointKind("U")


@pytest.mark.parametrize("kind", list(JointKind), ids=repr)
def test_velocities_are_those_of_the_motion(kind: JointKind) -> None:
    """The interface's turn and advance against the difference of two poses."""
    joint = Joint(kind, (0.6, 0.0, 0.8), (0.1, 0.2, 0.3), 0.07 if kind.pitched else 0.0)
    end = PlatformJoint(PlatformJointKind.SPHERICAL, (0.4, -0.2, 0.5))
    leg = Leg(ZERO3, IDENTITY3, (joint,), end, ZERO3)
    h, chain = 1e-6, chain_pose(leg, [0.3])
    after, before = chain_pose(leg, [0.3 + h]), chain_pose(leg, [0.3 - h])
    velocity, spin = (after.tip - before.tip) / (2 * h), (after.last - before.last) / (2 * h)
    assert np.allclose(chain.velocities[:, 0], velocity, rtol=0, atol=1e-9)
    axial = spin @ chain.last.T
    turning = np.array([axial[2, 1], axial[0, 2], axial[1, 0]])
    assert np.allclose(chain.spins[:, 0], turning, rtol=0, atol=1e-9)
    assert (np.linalg.norm(turning) > 0, kind.is_angle) == (kind.turns, kind.turns)


@pytest.mark.parametrize("kind", list(PlatformJointKind), ids=repr)
def test_right_angles_say_what_closes(kind: PlatformJointKind) -> None:
    """Of the turns that the conditions forbid there are as many as moments are transmitted."""
    stated = {
        "axis_link": X,
        "axis_platform": Z if kind.keeps_right_angle else X,
        "rotation": IDENTITY3,
    }
    joint = PlatformJoint(kind, **{name: stated[name] for name in kind.fields})
    leg = Leg(ZERO3, IDENTITY3, (Joint(JointKind.REVOLUTE, Z),), joint, ZERO3)
    residual, _, by_twist = leg_residual(leg, np.zeros(1), Pose(np.zeros(3), np.eye(3)))
    assert not residual.any()
    assert np.linalg.matrix_rank(by_twist[3:, 3:]) == kind.moments == len(joint.right_angles)


@pytest.mark.parametrize("kind", [k for k in PlatformJointKind if k.fields], ids=repr)
def test_the_angle_is_that_by_which_the_platform_is_turned(kind: PlatformJointKind) -> None:
    stated = {"axis_link": X, "axis_platform": X, "rotation": IDENTITY3}
    if kind.keeps_right_angle:
        stated["axis_platform"] = (0.0, 1.0, 0.0)
    joint = PlatformJoint(kind, **{name: stated[name] for name in kind.fields})
    leg = Leg(ZERO3, IDENTITY3, (Joint(JointKind.REVOLUTE, Z),), joint, ZERO3)
    pose = Pose(np.zeros(3), rotation_about(Z, 0.4))
    residual, *_ = leg_residual(leg, np.zeros(1), pose)
    assert kind.angle(float(np.linalg.norm(residual[3:]))) == pytest.approx(0.4, rel=1e-12)
    assert kind.open


def test_nothing_states_which_kind_but_the_kinds() -> None:
    """What depends on a kind is asked of it; only what stands for nothing stated is named."""
    named = {
        path.relative_to(ROOT).as_posix(): sorted(set(found))
        for path in sorted((ROOT / "pne_sym").rglob("*.py"))
        if path.parent.name not in ("joint_kinds", "platform_kinds")
        and (found := re.findall(r"\b(?:PlatformJoint|Joint)Kind\.[A-Z]+", path.read_text()))
    }
    default = ["PlatformJointKind.REVOLUTE", "PlatformJointKind.SPHERICAL"]
    assert named == {
        "pne_sym/model/legs.py": default,
        "pne_sym/starter/choose.py": default[1:],
        "pne_sym/starter/layout.py": default[:1],
    }


@pytest.mark.parametrize("kind", KINDS, ids=repr)
def test_every_kind_has_a_row_in_the_docs(kind: Kind) -> None:
    page = (ROOT / "docs/spec-format.md").read_text(encoding="utf-8")
    heading = "### Platform joint" if isinstance(kind, PlatformJointKind) else "### Joints"
    section = page.split(heading)[1].split("\n### ")[0]
    name = f"`{kind}`" if str(kind) == kind.word else f"`{kind}` {kind.word}"
    assert section.count(f"\n| {name} ") == 1


def test_a_joint_without_pitch_has_none() -> None:
    joint = Joint(JointKind.REVOLUTE, Z, pitch=3.0)
    assert (joint.turn, joint.advance) == (1.0, 0.0)
    assert (
        replace(joint, kind=JointKind.HELICAL).turn,
        replace(joint, kind=JointKind.PRISMATIC).advance,
    ) == (1.0, 1.0)
