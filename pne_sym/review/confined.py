"""Limits of a process that runs what nobody has read yet; then that process itself.

`confined.py MEMORY SECONDS FILE_BYTES PROCESSES COMMAND...`: sets hard limits and
becomes COMMAND. It imports nothing of this package.
"""

from __future__ import annotations

import os
import resource
import sys

OPEN_FILES = 64


def main() -> None:
    """Set the limits and go on as the command."""
    memory, seconds, file_bytes, processes = map(int, sys.argv[1:5])
    command = sys.argv[5:]
    limits = {
        resource.RLIMIT_AS: memory,
        resource.RLIMIT_CPU: seconds,
        resource.RLIMIT_FSIZE: file_bytes,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_NOFILE: OPEN_FILES,
    }
    if processes >= 0:
        limits[resource.RLIMIT_NPROC] = processes
    for kind, wanted in limits.items():
        hardest = resource.getrlimit(kind)[1]
        limit = wanted if hardest == resource.RLIM_INFINITY else min(wanted, hardest)
        resource.setrlimit(kind, (limit, limit))
    os.execv(command[0], command)  # noqa: S606 - no shell, as it was given


if __name__ == "__main__":
    main()
