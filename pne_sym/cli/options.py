"""Arguments and options that several commands have."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from pne_sym.cli.numbers import numbers

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator


Decorator = Callable[[Any], Any]


def valued(usage: str, says: str, **more: Any) -> Decorator:
    """An option with a value: its names, what its value is called, its name in the function.

    Such as "--out -o FILE" or "--as PATH label".

    Args:
        usage: the words.
        says: what it says of itself.
        more: as Click takes it; without a default there is none.
    """
    names = [word for word in usage.split() if word.startswith("-")]
    value, *own = [word for word in usage.split() if not word.startswith("-")]
    return click.option(*names, *own, metavar=value, help=says, **more)


def flag(usage: str, says: str) -> Decorator:
    """An option without a value: its names and, where it is another, its name in the function."""
    return click.option(*usage.split(), is_flag=True, help=says)


def of_option(option: str, text: str, pose_of: Manipulator | None = None) -> list[float]:
    """The numbers of an option; of a pose, X.

    Raises:
        InputError: a piece is no number, or the numbers no pose.
    """
    from pne_sym.generation import InputError

    try:
        found = numbers(text)
        if pose_of is None:
            return found
        from pne_sym import drawing

        return drawing.pose_of(pose_of, found)
    except ValueError as error:  # an InputError is one too
        raise InputError(f"{option}: {error}") from error


debug_flag = flag("--debug", "Show the traceback of an internal error.")
quiet_flag = flag("--quiet -q", "Tell only warnings.")

source_argument = click.argument(
    "source", metavar="NAME_OR_SPEC", help="A name in the catalogue or a spec file (.toml, .json)."
)
