"""Kinds of joints that close a leg at the platform, one file each; found by themselves."""

from pne_sym.model.kind import import_all
from pne_sym.model.platform_kinds.interface import PlatformJointKind

import_all(__name__, __path__)

__all__ = ["PlatformJointKind"]
