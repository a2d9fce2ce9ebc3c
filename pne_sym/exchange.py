"""Two names change places in one step, where the system can do that."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path

_AT_FDCWD = -100
_RENAME_EXCHANGE = 2


def exchange(one: Path, other: Path) -> bool:
    """Let two names of a folder or file change places in a single step.

    Linux has this as `renameat2` with RENAME_EXCHANGE, for which Python has no
    function of its own.

    Args:
        one: a path that exists.
        other: a path that exists on the same file system.

    Returns:
        Whether they have changed places.  False, with both as they were, where
        the system, its C library or the file system has no such step, and where
        it failed: renaming by the usual calls then succeeds or tells why not.
    """
    if sys.platform != "linux":
        return False
    try:
        rename = ctypes.CDLL(None).renameat2
    except (OSError, AttributeError):  # no shared C library, or one without it
        return False
    rename.argtypes = (ctypes.c_int, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_uint)
    paths = (os.fsencode(one), os.fsencode(other))
    failed: int = rename(_AT_FDCWD, paths[0], _AT_FDCWD, paths[1], _RENAME_EXCHANGE)
    return failed == 0
