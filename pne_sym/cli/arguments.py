"""A model's name may stand where a command would: which of the two it is.

Options may stand before or after the first word; here the command is put
first, which is what the option parser expects.
"""

from __future__ import annotations

from collections.abc import Sequence

GENERATE = "NAME_OR_SPEC..."
"""Name of the command that is meant where a model stands; no model can have it."""

COMMANDS = ("list", "all", "check", "explain", "diff", "new", "home", "draw")
OPTIONS_WITH_VALUE = (
    *("--out", "-o", "--jobs", "-j", "--target"),
    *("--stage", "--tolerance", "--as", "--legs", "--space"),
    *("--points", "--radii", "--base-angles", "--platform-angles", "--height"),
    *("--pose", "--q", "--path", "--fps", "--azimuth", "--elevation"),
)
_OF_THE_PROGRAM = ("--help", "-h", "--version")


def arrange(arguments: Sequence[str]) -> list[str]:
    """Put the command first; insert the one for models where a model stands.

    >>> arrange(["--out", "generated", "stewart"])
    ['NAME_OR_SPEC...', '--out', 'generated', 'stewart']
    >>> arrange(["--quiet", "check", "stewart"])
    ['check', '--quiet', 'stewart']
    >>> arrange(["help", "draw"])
    ['draw', '--help']
    """
    if arguments and arguments[0] == "help":
        return [*arguments[1:2], "--help"]
    if not arguments or arguments[0] in _OF_THE_PROGRAM:
        return list(arguments)
    position = _first_word(arguments)
    if position is not None and arguments[position] in COMMANDS:
        rest = [*arguments[:position], *arguments[position + 1 :]]
        return [arguments[position], *rest]
    return [GENERATE, *arguments]


def _first_word(arguments: Sequence[str]) -> int | None:
    """Return the position of the first argument that is no option nor its value."""
    position = 0
    while position < len(arguments):
        argument = arguments[position]
        if argument == "--":
            return None
        if not argument.startswith("-"):
            return position
        position += 2 if argument in OPTIONS_WITH_VALUE else 1
    return None
