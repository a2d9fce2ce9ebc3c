"""Frozen data: joints, links, legs, platform, manipulator; their reader."""
