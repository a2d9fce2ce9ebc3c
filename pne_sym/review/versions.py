"""Finding a version of a model: by name, spec file, generated folder, or git revision of one."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath

from pne_sym import manipulators
from pne_sym.contents import MODEL_NAME
from pne_sym.generation import InputError, find
from pne_sym.model.files import MAX_BYTES, SUFFIXES, parse, read_file
from pne_sym.model.reader import from_text
from pne_sym.review.folders import Folder, git, read_folder, read_tree
from pne_sym.review.manifests import read_manifest
from pne_sym.review.model import Model, from_folder, from_manipulator


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
            return _folder(text, path.resolve().name, read_folder(path))
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
    place = f"{revision}:{inside}"
    if git(text, "cat-file", "-t", place).strip() == b"tree":
        return _folder(text, PurePosixPath(inside).name, read_tree(text, place))
    suffix = PurePosixPath(inside).suffix
    if suffix.lower() not in SUFFIXES:
        raise InputError(
            f"{text[:100]!r} is a file of kind '{suffix}'; expected a .toml or .json "
            "file, or a generated folder"
        )
    if int(git(text, "cat-file", "-s", place)) > MAX_BYTES:
        raise InputError(f"{text[:100]!r} is larger than {MAX_BYTES} bytes")
    content = _decoded(text, git(text, "cat-file", "blob", place))
    return _specification(text, content, suffix)


def _decoded(what: str, content: bytes) -> str:
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise InputError(f"{what[:200]} is not UTF-8") from error


def _folder(text: str, name: str, folder: Folder) -> Model:
    """A generated folder; its files are called by its own name, or by that of its one manifest."""
    found = [p[:-5] for p in folder if p.endswith(".json") and MODEL_NAME.fullmatch(p[:-5])]
    if name not in found and len(found) == 1 and f"{found[0]}.md" in folder:
        name = found[0]
    entry = folder.get(f"{name}.json")
    if entry is None or entry.kind != "file" or name not in found:
        raise InputError(
            f"{text[:100]!r} is no generated folder: it has no manifest {name[:100]}.json"
        )
    source = f"{text[:100]!r}: its manifest"
    manifest = read_manifest(_decoded(source, entry.content), source)
    if manifest["name"] != name:
        raise InputError(f"{source} {name}.json is of another model, {manifest['name']!r}")
    return from_folder(text, manifest, folder)
