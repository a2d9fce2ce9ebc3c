"""Finding a version of a model: by name, spec file, generated folder, or git revision of one."""

from __future__ import annotations

import contextlib
import json
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import Any

from pne_sym import manipulators
from pne_sym.generation import InputError, find
from pne_sym.model.files import MAX_BYTES, SUFFIXES, parse, read_file
from pne_sym.model.reader import from_text
from pne_sym.review.model import Model, from_manipulator
from pne_sym.writer import GENERATOR

_LARGEST = 4 * MAX_BYTES
_GIT_TIME = 30.0
Read = Callable[[str], str]


def find_version(text: str) -> Model:
    """A version of a model.

    Args:
        text: a catalogue name, a spec file, a generated folder, or REVISION:PATH of a
            spec file or a generated folder in the git repository of the working folder
            (PATH from the repository's root, or from here where it begins with `./`).

    Raises:
        InputError: there is no such thing, or it cannot be read.
        SpecError: the specification is at fault.
    """
    with contextlib.suppress(OSError):
        path = Path(text)
        if path.is_dir():
            return _folder(text, path.resolve().name, lambda name: _read(path / name))
        if path.exists():
            return _specification(text, read_file(path), path.suffix)
    revision, colon, inside = text.partition(":")
    if colon:
        return _from_git(text, revision, inside)
    if text in manipulators.names():
        file = manipulators.path(text)
        return _specification(text, file.read_text(encoding="utf-8"), Path(file.name).suffix)
    return from_manipulator(text, find(text))


def _specification(label: str, content: str, suffix: str) -> Model:
    """A specification compiled, together with what its author wrote."""
    written = parse(content, suffix, label)
    model = from_manipulator(label, from_text(content, suffix, label))
    return replace(model, written=written if isinstance(written, Mapping) else None)


def _from_git(text: str, revision: str, inside: str) -> Model:
    """A file or folder as it was at a revision."""
    if not revision or revision.startswith("-") or not inside.strip("/"):
        raise InputError(f"{text[:100]!r} is no REVISION:PATH")
    inside = inside.rstrip("/")
    kind = _git(text, "cat-file", "-t", f"{revision}:{inside}").strip()
    if kind == "tree":
        return _folder(
            text,
            PurePosixPath(inside).name,
            lambda name: _git(text, "cat-file", "blob", f"{revision}:{inside}/{name}"),
        )
    suffix = PurePosixPath(inside).suffix
    if suffix.lower() not in SUFFIXES:
        raise InputError(
            f"{text[:100]!r} is a file of kind '{suffix}'; expected a .toml or .json "
            "file, or a generated folder"
        )
    content = _git(text, "cat-file", "blob", f"{revision}:{inside}")
    if len(content) > MAX_BYTES:
        raise InputError(f"{text[:100]!r} is larger than {MAX_BYTES} bytes")
    return _specification(text, content, suffix)


def _git(text: str, *arguments: str) -> str:
    """Output of a git command that only reads."""
    try:
        done = subprocess.run(  # noqa: S603
            ["git", *arguments],  # noqa: S607 - the user's git
            capture_output=True,
            timeout=_GIT_TIME,
            check=False,
        )
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        raise InputError(f"git cannot be asked for {text[:100]!r}: {error}") from error
    if done.returncode:
        reason = done.stderr.decode(errors="replace").strip().splitlines()
        raise InputError(f"git has no {text[:100]!r}: {reason[0] if reason else 'no reason given'}")
    try:
        return done.stdout.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{text[:100]!r} is not UTF-8") from error


def _read(path: Path) -> str:
    try:
        with path.open("rb") as stream:
            content = stream.read(_LARGEST + 1)
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from error
    if len(content) > _LARGEST:
        raise InputError(f"{path} is larger than {_LARGEST} bytes")
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is not UTF-8") from error


def _folder(text: str, name: str, read: Read) -> Model:
    """A generated folder: its manifest, NumPy module and report."""
    manifest = _manifest(text, name, read)
    try:
        report = read(f"{name}.md")
    except InputError:
        report = ""
    return Model(text, manifest, read(f"{name}.py"), report)


_NEEDED = ("name", "sizes", "coordinates", "home", "leg_types", "parameters", "operations")


def _manifest(text: str, name: str, read: Read) -> dict[str, Any]:
    try:
        manifest = json.loads(read(f"{name}.json"))
    except ValueError as error:
        if isinstance(error, InputError):
            raise InputError(
                f"{text[:100]!r} is no generated folder: it has no manifest {name}.json"
            ) from error
        raise InputError(f"{text[:100]!r}: its manifest {name}.json is not JSON") from error
    if not isinstance(manifest, dict) or GENERATOR not in str(manifest.get("generator")):
        raise InputError(f"{text[:100]!r}: its manifest {name}.json is not of {GENERATOR}")
    if missing := [key for key in _NEEDED if key not in manifest]:
        raise InputError(f"{text[:100]!r}: its manifest has no {missing[0]!r}")
    return manifest
