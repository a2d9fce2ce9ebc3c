"""Arguments and options that several commands have."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from pne_sym.cli.numbers import numbers

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator


def unset(usage: str, says: str) -> Any:
    """An option without a default: its names and what its value is called; what it says of itself.

    Such as "--out -o FILE".
    """
    *names, value = usage.split()
    return typer.Option(*names, metavar=value, show_default=False, help=says)


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


Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an internal error.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Tell only warnings.")]

Source = Annotated[
    str,
    typer.Argument(
        metavar="NAME_OR_SPEC", help="A name in the catalogue or a spec file (.toml, .json)."
    ),
]
