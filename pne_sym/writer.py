"""Writing a model's folder as a whole.

A folder is written aside, forced to disk and exchanged with the old one in a
single step: at every instant one of the two is in its place, complete.  Where
the system has no such step there are two renames; between these only, the old
folder is beside its place as `.NAME.pne-old`, from where the next run puts it
back.  Files of the old folder that are not of a generation are in the new one
too (see `contents`).
"""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
from collections.abc import Iterator, Mapping, Set
from pathlib import Path

from pne_sym.contents import Contents, check_names, folders_of
from pne_sym.exchange import exchange

if sys.platform != "win32":
    import fcntl

_PACKAGE_INIT = '"""Generated models, one package each."""\n'
_PYTHON_CACHE = "__pycache__"


class OutputError(Exception):
    """The output cannot be written; the message is one line for people."""


def write_model(out: Path, name: str, files: Mapping[str, str]) -> Path:
    """Write `out/name/` as a whole: all of it, or nothing.

    Files there that are not of a generation (see `contents`) stay.
    A new or empty `out` also gets an `__init__.py`, so that it is a package.

    Args:
        out: the output folder; created with its parents when missing.
        name: the model's name.
        files: path below the model's folder, with slashes -> text; written as UTF-8
            with the text's own line ends.

    Returns:
        The model's folder.

    Raises:
        OutputError: the folder cannot be written, or holds something that
            this package did not write.  What stood there is untouched.
        ValueError: a name that could lead out of the folder.
    """
    check_names(name, files)
    content = {file: text.encode("utf-8") for file, text in files.items()}
    folder = out / name
    with readable_errors(folder), _created(out), _locked(out):
        place = _Place(folder)
        place.settle()
        place.check()
        there = Contents(folder)
        _refuse_foreign(there, content.keys())
        is_new = all(path.name.startswith(".") for path in out.iterdir())
        try:
            _write_folder(place.new, content)
            if folder.exists():
                _keep(folder, place.new, there.files | content.keys())
            if is_new:
                _write_package_init(out)
            place.swap()
        finally:
            place.settle()
    return folder


def check_output(out: Path) -> None:
    """Refuse an output folder that can certainly not be written.

    Called before long work, so that it is not done in vain.

    Raises:
        OutputError: `out` is, or stands below, something that is no folder
            or that may not be written.
    """
    with readable_errors(out):
        there = (path for path in (out, *out.parents) if path.exists() or path.is_symlink())
        nearest = next(there, Path())
        if not nearest.is_dir():
            raise OutputError(f"cannot write {out}: {nearest} is not a folder")
        if not os.access(nearest, os.W_OK | os.X_OK):
            raise OutputError(f"cannot write {out}: no permission to write in {nearest}")


class _Place:
    """A model's folder and the two names beside it used to swap it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.new = folder.with_name(f".{folder.name}.pne-tmp")
        self.old = folder.with_name(f".{folder.name}.pne-old")

    def swap(self) -> None:
        """Put the new folder in the place of the old one, which is left over beside it."""
        if not self.folder.exists():
            self.new.rename(self.folder)
        elif not exchange(self.new, self.folder):
            self.folder.rename(self.old)
            self.new.rename(self.folder)
        _sync(self.folder.parent)

    def settle(self) -> None:
        """Put the old folder back if none is in place; remove what is left over.

        Whatever happened before (an error, an interruption, a crash of an
        earlier run), afterwards one whole folder, old or new, is in place.
        """
        if self.old.is_dir() and not self.folder.exists():
            self.old.rename(self.folder)
        for left_over in (self.new, self.old):
            _remove(left_over)

    def check(self) -> None:
        """Refuse to go on where something left over could not be removed."""
        for left_over in (self.new, self.old):
            if left_over.exists() or left_over.is_symlink():
                raise OutputError(
                    f"cannot write {self.folder}: {left_over}, left over from an earlier run, "
                    "cannot be removed; remove it by hand"
                )


@contextlib.contextmanager
def readable_errors(path: Path, verb: str = "write") -> Iterator[None]:
    """Turn an operating system error about `path` into an `OutputError`."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        where = f" ({error.filename})" if error.filename else ""
        raise OutputError(f"cannot {verb} {path}: {reason}{where}") from error


@contextlib.contextmanager
def _created(out: Path) -> Iterator[None]:
    """Create the output folder; on failure remove again what was created."""
    created = [path for path in (out, *out.parents) if not path.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
        yield
    except BaseException:
        for path in created:
            with contextlib.suppress(OSError):
                path.rmdir()
        raise


@contextlib.contextmanager
def _locked(out: Path) -> Iterator[None]:
    """Keep other processes from writing below `out` at the same time."""
    if sys.platform == "win32":
        yield
        return
    descriptor = os.open(out, os.O_RDONLY)
    try:
        with contextlib.suppress(OSError):  # some network file systems have no locks
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _refuse_foreign(there: Contents, files: Set[str]) -> None:
    """Refuse to replace what this package did not write."""
    folder = there.folder
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise OutputError(
            f"cannot write {folder}: it is not a folder; remove it or use another --out"
        )
    if folder.exists() and any(folder.iterdir()) and not there.is_generated:
        raise OutputError(
            f"refusing to replace {folder}: pne-gen did not write it "
            f"(it has no manifest {folder.name}.json); remove it or use another --out"
        )
    for name in sorted({above for file in files for above in folders_of(file)}):
        if (path := folder / name).is_symlink() or (path.exists() and not path.is_dir()):
            raise OutputError(f"cannot write {folder}: {path} is no folder; remove or rename it")
    for name in sorted(files):
        if (path := folder / name).is_dir() and not path.is_symlink():
            raise OutputError(f"cannot write {folder}: {path} is a folder; remove or rename it")
        if (path.exists() or path.is_symlink()) and not there.may_replace(name):
            raise OutputError(
                f"refusing to replace {path}: pne-gen did not write it; remove or rename it"
            )


def _remove(folder: Path) -> None:
    """Remove a folder as far as that can be done, its read-only folders too."""
    if folder.is_symlink():  # what it points to is not ours
        return
    for root, _, _ in os.walk(folder):
        with contextlib.suppress(OSError):
            Path(root).chmod(0o700)
    shutil.rmtree(folder, ignore_errors=True)


def _write_folder(folder: Path, content: Mapping[str, bytes]) -> None:
    folder.mkdir()
    folders = sorted({above for file in content for above in folders_of(file)})
    for name in folders:  # the outer ones come first
        (folder / name).mkdir()
    for file, data in content.items():
        _write_file(folder / file, data)
    for name in (*reversed(folders), "."):
        _sync(folder / name)


def _keep(folder: Path, new: Path, left_out: Set[str], start: str = "") -> None:
    """Let the user's files of a folder stand in its successor too.

    A file gets a second link, so that it stays the same file; where a file
    system has no links it is copied.

    Args:
        folder: the old folder, or a folder in it.
        new: its successor.
        left_out: files of a generation, below the old folder.
        start: where this folder is below it: "", or a path that ends with a slash.
    """
    for path in sorted(folder.iterdir()):
        target, name = new / path.name, start + path.name
        if path.name == _PYTHON_CACHE or _is_emptied(path, name, left_out):
            continue
        if path.is_dir() and not path.is_symlink():
            target.mkdir(exist_ok=True)
            _keep(path, target, left_out, f"{name}/")
            shutil.copystat(path, target)
            continue
        try:
            os.link(path, target, follow_symlinks=False)
        except OSError:
            shutil.copy2(path, target, follow_symlinks=False)
            if not target.is_symlink():
                _sync(target)
    _sync(new)


def _is_emptied(path: Path, name: str, left_out: Set[str]) -> bool:
    """Whether nothing of the user's is there: a generated file, or a folder of such files only."""
    if name in left_out or path.is_symlink() or not path.is_dir():
        return name in left_out
    return any(file.startswith(f"{name}/") for file in left_out) and all(
        each.name == _PYTHON_CACHE or _is_emptied(each, f"{name}/{each.name}", left_out)
        for each in path.iterdir()
    )


def _write_file(path: Path, data: bytes) -> None:
    with path.open("xb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())


def _write_package_init(out: Path) -> None:
    path = out / "__init__.py"
    try:
        _write_file(path, _PACKAGE_INIT.encode())
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def _sync(path: Path) -> None:
    """Force a folder's entries, or a file, to disk, where the system can."""
    with contextlib.suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
