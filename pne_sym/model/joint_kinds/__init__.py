"""Kinds of the joints of a leg, one file each; what the files define is found by itself."""

from pne_sym.model.joint_kinds.interface import JointKind, WrittenJoint
from pne_sym.model.kind import import_all

import_all(__name__, __path__)

__all__ = ["JointKind", "WrittenJoint"]
