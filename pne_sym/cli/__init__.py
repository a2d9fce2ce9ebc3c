"""The command line `pne-gen`: thin; every command is a function of the library first."""

from __future__ import annotations

import atexit
import gc
import sys
from collections.abc import Sequence

from pne_sym.cli.arguments import arrange


def main(argv: Sequence[str] | None = None) -> None:
    """Run `pne-gen` and leave the process with its exit code.

    Args:
        argv: the arguments after the program's name; default those of the process.

    Raises:
        SystemExit: always. 0 done, 1 a check found a difference, 2 the input
            is at fault, 3 an internal error, 130 interrupted, 141 the
            reader of a pipe left.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    keep_what_is_made()
    try:
        from pne_sym.cli.app import app
        from pne_sym.cli.console import discard_output, prepare_streams

        prepare_streams()
        app(arrange(arguments), prog_name="pne-gen")
    except KeyboardInterrupt:
        sys.stderr.write("pne-gen: interrupted\n")
        sys.exit(130)
    except OSError as error:
        # The commands tell theirs: this is help that cannot be written.
        discard_output()
        sys.stderr.write(f"pne-gen: error: cannot write to standard output: {error.strerror}\n")
        sys.exit(2)


def keep_what_is_made() -> None:
    """Look for cyclic garbage only every million objects, and no more at the end.

    What a run makes lives until its end: the collector would go through it again and again.
    """
    gc.set_threshold(1_000_000)
    atexit.register(gc.freeze)
