"""What stands in a model's folder: which files are of a generation, and which are the user's.

The targets' registry tells which paths may be of a generation. Some are by their names alone: those
of the targets that are always or by default written, and those that every model gets of the
targets that the manifest names. Any other is, if it begins with the signature of this package.
"""

from __future__ import annotations

import contextlib
import errno
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from pne_sym.backends import registry
from pne_sym.backends.target import SIGNED_BYTES, is_signed

MODEL_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")
FILE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")
FOLDER_NAME = re.compile(r"[+]?[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")
"""Of a folder in a model's folder; one that begins with + is a package of MATLAB."""
DEEPEST = 4
"""Folders in folders, below a model's own."""
GENERATOR = "pne_sym"
"""Named by the entry `generator` of every manifest that this package writes."""


def check_names(name: str, files: Iterable[str]) -> None:
    """Refuse, with a ValueError, names that could lead out of the model's folder."""
    if not MODEL_NAME.fullmatch(name):
        raise ValueError(f"not a model name: {name!r}")
    paths = set(files)
    for file in paths:
        *folders, last = file.split("/")
        good = FILE_NAME.fullmatch(last) and all(map(FOLDER_NAME.fullmatch, folders))
        if not good or len(folders) > DEEPEST or paths & set(folders_of(file)):
            raise ValueError(f"not a file name: {file!r}")


def folders_of(file: str) -> list[str]:
    """The folders in which a file stands, below the model's own, outermost first.

    >>> folders_of("octave/+stewart/M.m")
    ['octave', 'octave/+stewart']
    """
    parts = file.split("/")[:-1]
    return ["/".join(parts[: k + 1]) for k in range(len(parts))]


def read_file(path: Path, size: int = -1) -> bytes:
    """What a file begins with, or all of it.

    Raises:
        OSError: it cannot be read, or is a pipe or device, for which one could wait for ever.
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise OSError(errno.EINVAL, "Not a regular file", str(path))
    with path.open("rb") as stream:
        return stream.read(size)


class Contents:
    """A model's folder as it stands; its manifest is read once.

    Args:
        folder: it has the model's name; it may be missing.

    Attributes:
        targets: that it was generated with, those of default where the manifest says nothing;
            names may be those of another version.
    """

    def __init__(self, folder: Path) -> None:
        self.folder, self.model = folder, folder.name
        self.manifest = _manifest(folder / f"{folder.name}.json")
        self.targets = recorded_targets(self.manifest)

    @property
    def is_generated(self) -> bool:
        """Whether this package wrote the folder.

        Its manifest tells; or, where that was lost or has the marks of a merge
        conflict, the header of a file: then too the remedy is to generate again.
        """
        if GENERATOR in str(self.manifest.get("generator")):
            return True
        for path in self.folder.glob(f"{self.model}.*"):
            with contextlib.suppress(OSError):
                if _has_header(path):
                    return True
        return False

    @cached_property
    def files(self) -> frozenset[str]:
        """The files that are of some generation, by their paths below the folder, with slashes.

        Raises:
            OSError: it cannot be read whether a file is.
        """
        return frozenset(path for path in self._claimed() if self._is_ours(path))

    def may_replace(self, file: str) -> bool:
        """Whether what stands at the path of a file to be written is of a generation."""
        owners = [t.name for t in registry.TARGETS if t.owns(self.model, file)]
        return not owners or any(o in self.targets for o in owners) or self._is_ours(file)

    def _claimed(self) -> Iterator[str]:
        """Files at paths where some target may write; none that a link leads to."""
        for pattern in sorted({pattern for t in registry.TARGETS for pattern in t.files}):
            for path in self.folder.glob(pattern.format(name=self.model)):
                inside = path.relative_to(self.folder).as_posix()
                linked = any((self.folder / above).is_symlink() for above in folders_of(inside))
                if not linked and (path.is_symlink() or not path.is_dir()):
                    yield inside

    def _is_ours(self, file: str) -> bool:
        path = self.folder / file
        named = registry.is_named(self.model, file, self.targets)
        return named or (path.is_file() and not path.is_symlink() and _has_header(path))


def recorded_targets(manifest: Mapping[str, Any]) -> tuple[str, ...]:
    """The targets that a manifest names; those of default where it names none."""
    names = manifest.get("targets")
    good = isinstance(names, list) and all(isinstance(name, str) for name in names)
    return tuple(names or ()) if good else registry.default()


def _manifest(path: Path) -> Mapping[str, Any]:
    """The manifest as it stands, or nothing."""
    with contextlib.suppress(OSError, ValueError, RecursionError):
        manifest = json.loads(read_file(path))
        return manifest if isinstance(manifest, dict) else {}
    return {}


def _has_header(path: Path) -> bool:
    """Whether a file says that this package wrote it."""
    return is_signed(read_file(path, SIGNED_BYTES))
