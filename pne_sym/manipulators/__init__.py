"""The catalogue: one specification file per manipulator, and no algebra.

>>> from pne_sym import manipulators
>>> manipulators.load("stewart").title
'6-UPS Stewart platform'
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from importlib.resources.abc import Traversable

from pne_sym.model.entry import near
from pne_sym.model.errors import SpecError, show
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import from_text

_SUFFIX = ".toml"
_FEW = 3
"""Names that are offered for a mistaken one."""


@cache
def names() -> tuple[str, ...]:
    """The names of the catalogue, in alphabetical order."""
    files = resources.files(__name__).iterdir()
    return tuple(sorted(f.name.removesuffix(_SUFFIX) for f in files if f.name.endswith(_SUFFIX)))


def path(name: str) -> Traversable:
    """The specification file of a manipulator of the catalogue.

    Raises:
        SpecError: no such name (the message has the nearest ones).
    """
    if name not in names():
        raise _unknown(name)
    return resources.files(__name__) / (name + _SUFFIX)


def _unknown(name: str) -> SpecError:
    """The error for a name that the catalogue does not have: the nearest few of it."""
    like = near(name, names(), _FEW, likeness=0.5)
    parts = [each for each in names() if name and name.lower() in each and each not in like]
    few = [*like, *parts][:_FEW]
    hint = f" (did you mean {' or '.join(few)}?)" if few else ""
    return SpecError(
        "catalogue",
        "",
        f"no manipulator {show(name)}{hint}",
        f"one of the {len(names())} that pne-gen list shows, or a file (.toml, .json)",
    )


def load(name: str) -> Manipulator:
    """A manipulator of the catalogue.

    Raises:
        SpecError: no such name (the message has the nearest ones).
    """
    file = path(name)
    return from_text(file.read_text(encoding="utf-8"), _SUFFIX, file.name)
