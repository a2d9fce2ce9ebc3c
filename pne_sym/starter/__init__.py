"""A first specification from an architecture in words such as 6-UPS, for people to edit.

>>> from pne_sym.starter import starter_text
>>> text = starter_text("my_robot", "3-RPR")
>>> print(text.splitlines()[0])
# Planar 3-RPR manipulator
"""

from pne_sym.starter.notation import parse_legs
from pne_sym.starter.points import PointsFile, Rings
from pne_sym.starter.write import starter_text, write_starter

__all__ = ["PointsFile", "Rings", "parse_legs", "starter_text", "write_starter"]
