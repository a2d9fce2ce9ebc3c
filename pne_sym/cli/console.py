"""What `pne-gen` says: results on standard output, all else on standard error.

On a terminal there is colour, and progress where work is long; in a pipe or a
file there are plain lines.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, TextIO

from pne_sym.writer import OutputError

if TYPE_CHECKING:
    from rich.progress import Progress

# rich is imported where there is a terminal: pipes and files need not wait for it.

_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
_DIFF_STYLES = (("+++", "bold"), ("---", "bold"), ("@@", "cyan"), ("+", "green"), ("-", "red"))


def prepare_streams() -> None:
    """Let a character that the terminal lacks be shown escaped, not fail."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def flush_output() -> None:
    """Write what is left of standard output.

    Raises:
        OutputError: it cannot be written.
    """
    with _output_errors():
        sys.stdout.flush()


def discard_output() -> None:
    """Let what is left of standard output, which nobody takes, go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


_STYLES = {"error: ": "bold red", "warning: ": "yellow", "": "cyan"}


def print_message(kind: str, message: str) -> None:
    """Print one message on standard error: an "error: ", a "warning: ", or what was chosen ("")."""
    _print(sys.stderr, f"pne-gen: {kind}", message, _STYLES[kind])


class Report:
    """Says what is being done and what came out.

    Attributes:
        quiet: only errors, warnings and differences are told.
    """

    def __init__(self, *, quiet: bool = False) -> None:
        self.quiet = quiet
        self._live: Progress | None = None

    def line(self, text: str) -> None:
        """Print a line of result, unless quiet."""
        if self.quiet:
            return
        if self._live is not None and sys.stdout.isatty():
            from rich.text import Text

            self._live.console.print(Text(_visible(text)), soft_wrap=True)
        else:
            with _output_errors():
                _print(sys.stdout, "", text, "")

    def difference(self, line: str) -> None:
        """Print a line of a unified diff, also if quiet."""
        style = next((style for start, style in _DIFF_STYLES if line.startswith(start)), "")
        with _output_errors():
            _print(sys.stdout, "", line, style)

    @contextlib.contextmanager
    def progress(self, total: int) -> Iterator[Step]:
        """Show progress through `total` models, on a terminal and unless quiet."""
        if self.quiet or not sys.stderr.isatty():
            yield Step()
            return
        with _progress(total) as progress:
            self._live = progress
            try:
                yield Step(progress, total)
            finally:
                self._live = None


def _progress(total: int) -> Progress:
    """The display on standard error."""
    from rich import progress as rich
    from rich.console import Console

    columns = [rich.SpinnerColumn(), rich.TextColumn("{task.description}")]
    if total > 1:
        columns += [rich.BarColumn(), rich.MofNCompleteColumn()]
    return rich.Progress(
        *columns,
        rich.TimeElapsedColumn(),
        console=Console(stderr=True),
        transient=True,
        redirect_stdout=False,
        redirect_stderr=False,
    )


class Step:
    """Moves the progress display, where there is one."""

    def __init__(self, progress: Progress | None = None, total: int = 0) -> None:
        self._progress = progress
        self._task = progress.add_task("", total=total) if progress else None

    def working_on(self, text: str) -> None:
        """Show what is being worked on."""
        if self._progress is not None and self._task is not None:
            self._progress.update(self._task, description=_visible(text))

    def done(self) -> None:
        """Count one model as done."""
        if self._progress is not None and self._task is not None:
            self._progress.advance(self._task)


@contextlib.contextmanager
def _output_errors() -> Iterator[None]:
    """Tell a full disk and the like under standard output in one line."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        discard_output()
        reason = error.strerror or str(error)
        raise OutputError(f"cannot write to standard output: {reason}") from error


def _print(stream: TextIO, start: str, text: str, style: str) -> None:
    """Print plain text; `start` alone is styled where there is one."""
    if not stream.isatty():
        stream.write(f"{start}{_visible(text)}\n")
        return
    from rich.console import Console
    from rich.text import Text

    line = Text(start, style) + Text(_visible(text), "" if start else style)
    Console(file=stream).print(line, soft_wrap=True)


def _visible(text: str) -> str:
    """Escape control characters, so that no name in a message acts on the terminal."""
    return _CONTROL.sub(lambda match: f"\\x{ord(match[0]):02x}", text)
