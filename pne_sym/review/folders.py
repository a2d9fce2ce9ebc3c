"""The files of a generated folder, on disk or in git: all of them, as bytes, bounded.

A folder may be a stranger's: links are not followed, only regular files are
opened, and there is a limit to their number, size and depth.
"""

from __future__ import annotations

import os
import stat
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from pne_sym.generation import InputError
from pne_sym.model.files import MAX_BYTES

LARGEST_FILE = 4 * MAX_BYTES
LARGEST_FOLDER = 16 * MAX_BYTES
MOST_FILES = 500
DEEPEST = 8
_GIT_TIME = 30.0


@dataclass(frozen=True)
class Entry:
    """A file of a folder.

    Attributes:
        kind: "file"; "link", which is not followed; or "other".
        content: of a file; of a link its target.
    """

    kind: str
    content: bytes = b""


Folder = dict[str, Entry]
"""Path below the folder, with / -> what stands there; sorted."""


def read_folder(folder: Path, most: int | None = None) -> Folder:
    """Every file below a folder on disk.

    Args:
        folder: where.
        most: so many files at most; by default `MOST_FILES`.

    Raises:
        InputError: a file cannot be read, or there is more than the limits allow.
    """
    found: Folder = {}
    size = 0
    try:
        for name, path in _walk(folder, "", 0):
            found[name] = _read(path)
            size += len(found[name].content)
            _check(str(folder), len(found), size, most)
    except OSError as error:
        raise InputError(f"cannot read {error.filename or folder}: {error.strerror}") from error
    return dict(sorted(found.items()))


def _check(label: str, count: int, size: int, most: int | None) -> None:
    most = most or MOST_FILES
    if count > most:
        raise InputError(f"{label[:100]} has more than {most} files")
    if size > LARGEST_FOLDER:
        raise InputError(f"{label[:100]} is larger than {LARGEST_FOLDER} bytes")


def _walk(folder: Path, start: str, depth: int) -> Iterator[tuple[str, Path]]:
    if depth > DEEPEST:
        raise InputError(f"{folder} is nested more than {DEEPEST} levels deep")
    with os.scandir(folder) as entries:
        for entry in entries:
            if entry.is_dir(follow_symlinks=False):
                yield from _walk(Path(entry.path), f"{start}{entry.name}/", depth + 1)
            else:
                yield start + entry.name, Path(entry.path)


def _read(path: Path) -> Entry:
    """A file, opened without following a link and without waiting for a pipe's writer."""
    mode = path.lstat().st_mode
    if stat.S_ISLNK(mode):
        return Entry("link", os.fsencode(path.readlink()))
    if not stat.S_ISREG(mode):
        return Entry("other")
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    with open(descriptor, "rb") as stream:  # noqa: PTH123 - of a descriptor
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            return Entry("other")
        content = stream.read(LARGEST_FILE + 1)
    if len(content) > LARGEST_FILE:
        raise InputError(f"{path} is larger than {LARGEST_FILE} bytes")
    return Entry("file", content)


_KINDS = {"100644": "file", "100755": "file", "120000": "link"}


def read_tree(label: str, tree: str, most: int | None = None) -> Folder:
    """Every file of a tree in git.

    Args:
        label: what the user called it.
        tree: REVISION:PATH of a folder.
        most: so many files at most; by default `MOST_FILES`.

    Raises:
        InputError: git cannot read it, or there is more than the limits allow.
    """
    listed, size = [], 0
    for line in git(label, "ls-tree", "-r", "-l", "-z", "--full-tree", tree).split(b"\0")[:-1]:
        about, _, name = line.partition(b"\t")
        mode, _, digest, length = about.decode().split()
        bytes_ = int(length) if length.isdigit() else 0
        path = os.fsdecode(name)
        if bytes_ > LARGEST_FILE:
            raise InputError(f"{label[:100]}: {path[:100]} is larger than {LARGEST_FILE} bytes")
        if len(PurePosixPath(path).parts) > DEEPEST + 1:
            raise InputError(f"{label[:100]} is nested more than {DEEPEST} levels deep")
        size += bytes_
        listed.append((path, _KINDS.get(mode, "other"), digest))
        _check(label, len(listed), size, most)
    contents = _blobs(label, [digest for _, kind, digest in listed if kind != "other"])
    return {
        path: Entry(kind, contents.get(digest, b"") if kind != "other" else b"")
        for path, kind, digest in sorted(listed)
    }


def _blobs(label: str, digests: list[str]) -> dict[str, bytes]:
    """Contents of files in git by their digests, in one process."""
    asked = "".join(f"{digest}\n" for digest in digests).encode()
    said = git(label, "cat-file", "--batch", given=asked) if digests else b""
    found, place = {}, 0
    for digest in digests:
        end = said.index(b"\n", place)
        size = int(said[place:end].split()[2])
        found[digest] = said[end + 1 : end + 1 + size]
        place = end + 2 + size
    return found


def git(label: str, *arguments: str, given: bytes | None = None) -> bytes:
    """Output of a git command that only reads.

    Args:
        label: what the user called what is asked for.
        arguments: of git.
        given: its standard input.

    Raises:
        InputError: it fails; the message has git's reason.
    """
    try:
        done = subprocess.run(  # noqa: S603
            ["git", *arguments],  # noqa: S607 - the user's git
            input=given or b"",
            capture_output=True,
            timeout=_GIT_TIME,
            check=False,
        )
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        raise InputError(f"git cannot be asked for {label[:100]!r}: {error}") from error
    if done.returncode:
        reason = done.stderr.decode(errors="replace").strip().splitlines()
        raise InputError(
            f"git has no {label[:100]!r}: {reason[0] if reason else 'no reason given'}"
        )
    return done.stdout
