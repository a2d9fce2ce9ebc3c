"""From what went wrong to one message and an exit code."""

from __future__ import annotations

import contextlib
import sys
import traceback
import warnings
from collections.abc import Iterator

from click.exceptions import Exit

from pne_sym.backends.target import TargetError
from pne_sym.cli.console import discard_output, flush_output, print_message
from pne_sym.writer import OutputError

DIFFERENT = 1
INPUT_AT_FAULT = 2
INTERNAL_ERROR = 3
INTERRUPTED = 130
READER_LEFT = 141
"""What a shell tells of a program that a closed pipe (SIGPIPE) ended."""


@contextlib.contextmanager
def told(*, debug: bool) -> Iterator[None]:
    """Tell warnings and errors in one message each, and leave with the right code.

    Args:
        debug: show the traceback of an internal error.

    Raises:
        Exit: with the exit code, for any error.
    """
    from pne_sym.generation import InputError
    from pne_sym.model.errors import SpecError, SpecNote, SpecWarning

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", SpecWarning)
            warnings.simplefilter("always", SpecNote)
            warnings.showwarning = _show_warning
            with _output_complete():
                yield
    except Exit:
        raise
    except (InputError, SpecError, OutputError, TargetError) as error:
        print_message("error: ", str(error))
        raise Exit(INPUT_AT_FAULT) from error
    except KeyboardInterrupt as error:
        print_message("error: ", "interrupted")
        raise Exit(INTERRUPTED) from error
    except BrokenPipeError as error:
        # Nobody is left to tell.  The work may not be done, nor is the answer known: not 0.
        discard_output()
        raise Exit(READER_LEFT) from error
    except Exception as error:
        _tell_internal_error(error, debug=debug)
        raise Exit(INTERNAL_ERROR) from error


@contextlib.contextmanager
def _output_complete() -> Iterator[None]:
    """Write what is left of the output where its faults can still be told, not at exit."""
    try:
        yield
    except Exit:
        flush_output()
        raise
    flush_output()


def _tell_internal_error(error: Exception, *, debug: bool) -> None:
    if debug:
        traceback.print_exception(error)
    summary = f"{type(error).__name__}: {error}".splitlines()[0]
    print_message("error: ", f"internal error: {summary}")
    if not debug:
        sys.stderr.write("Run it again with --debug for the traceback, and please report it.\n")


def _show_warning(
    message: Warning | str, category: type[Warning], *_: object, **__: object
) -> None:
    """Print a warning in one line; one that is not about the input with its class."""
    from pne_sym.model.errors import SpecNote, SpecWarning

    if issubclass(category, SpecNote):
        print_message("", f"{message}")
        return
    name = "" if issubclass(category, SpecWarning) else f"{category.__name__}: "
    print_message("warning: ", f"{name}{message}")
