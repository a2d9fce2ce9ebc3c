"""Manipulator -> Derivation: leg kinematics, Newton-Euler, platform, assembly."""
