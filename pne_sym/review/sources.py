"""What the user names, read but not yet compiled: a specification, a folder, several, or none."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from pne_sym import manipulators
from pne_sym.contents import MODEL_NAME
from pne_sym.generation import InputError
from pne_sym.model.errors import SpecError
from pne_sym.model.files import MAX_BYTES, SUFFIXES, read_file
from pne_sym.review.folders import MOST_FILES, Entry, Folder, git, read_folder, read_tree

NONE = os.devnull
"""Stands for no model: what git gives for a file that is new or gone."""
MOST_MODELS = 200


@dataclass(frozen=True)
class Source:
    """One version, or several models, as they are stored.

    Attributes:
        label: what to call it.
        name: of the model's folder, or of the file without its suffix.
        content: of a specification.
        suffix: of a specification's file.
        folder: files of a generated folder.
        models: of a folder of models, by name.
    """

    label: str
    name: str = ""
    content: str | None = None
    suffix: str = ""
    folder: Folder | None = None
    models: Mapping[str, Source] | None = None

    @property
    def is_none(self) -> bool:
        """Whether it stands for no model at all."""
        return not self.name


def find_source(text: str, label: str = "") -> Source:
    """Read what the user names.

    Args:
        text: a catalogue name, a spec file, a generated folder, a folder of either,
            REVISION:PATH of one in the git repository of the working folder (PATH from
            the repository's root, or from here where it begins with `./`), or /dev/null.
        label: what to call it; by default as the user does.

    Raises:
        InputError: there is no such thing, or it cannot be read.
        SpecError: likewise, of a spec file.
    """
    label = label or text
    if text == NONE:
        return Source("no model")
    with contextlib.suppress(OSError):
        path = Path(text)
        if path.is_dir():
            files = read_folder(path, MOST_FILES * MOST_MODELS)
            return _folder(text, label, path.resolve().name, files)
        if path.exists():
            return Source(label, path.stem, _content(label, path), path.suffix)
    revision, colon, inside = text.partition(":")
    if colon:
        return _from_git(text, label, revision, inside)
    if text in manipulators.names():
        file = manipulators.path(text)
        return Source(label, text, file.read_text(encoding="utf-8"), Path(file.name).suffix)
    return Source(label, text)


def _content(label: str, path: Path) -> str:
    """Text of a file; faults are told by its label."""
    try:
        return read_file(path)
    except SpecError as error:
        if label == str(path):
            raise
        raise InputError(str(error).replace(str(path), label)) from error


def _from_git(text: str, label: str, revision: str, inside: str) -> Source:
    """A file or folder as it was at a revision."""
    if not revision or revision.startswith("-") or not inside.strip("/"):
        raise InputError(f"{text[:100]!r} is no REVISION:PATH")
    inside = inside.rstrip("/")
    place = f"{revision}:{inside}"
    path = PurePosixPath(inside)
    if git(text, "cat-file", "-t", place).strip() == b"tree":
        return _folder(text, label, path.name, read_tree(text, place, MOST_FILES * MOST_MODELS))
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(
            f"{text[:100]!r} is a file of kind '{path.suffix}'; expected a .toml or .json "
            "file, or a generated folder"
        )
    if int(git(text, "cat-file", "-s", place)) > MAX_BYTES:
        raise InputError(f"{text[:100]!r} is larger than {MAX_BYTES} bytes")
    content = decoded(text, git(text, "cat-file", "blob", place))
    return Source(label, path.stem, content, path.suffix)


def decoded(what: str, content: bytes) -> str:
    """Text of a file.

    Raises:
        InputError: it is not UTF-8.
    """
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{what[:200]} is not UTF-8") from error


def _folder(text: str, label: str, name: str, files: Folder) -> Source:
    """A generated folder, called by its own name or by that of its one manifest; or several."""
    found = [p[:-5] for p in files if p.endswith(".json") and MODEL_NAME.fullmatch(p[:-5])]
    if name not in found and len(found) == 1 and f"{found[0]}.md" in files:
        name = found[0]
    if name in found and files[f"{name}.json"].kind == "file" and f"{name}.toml" not in files:
        if len(files) > MOST_FILES:
            raise InputError(f"{text[:100]} has more than {MOST_FILES} files")
        return Source(label, name, folder=files)
    models = dict(sorted(_models(label, files).items()))
    if not models:
        raise InputError(
            f"{text[:100]!r} is no generated folder: it has no manifest {name[:100]}.json, "
            "and it holds no models"
        )
    if len(models) > MOST_MODELS:
        raise InputError(f"{text[:100]!r} holds more than {MOST_MODELS} models")
    return Source(label, name, models=models)


def _models(label: str, files: Folder) -> dict[str, Source]:
    """Generated folders and specifications that stand in a folder."""
    inner: dict[str, Folder] = {}
    for path, entry in files.items():
        name, slash, rest = path.partition("/")
        if slash:
            inner.setdefault(name, {})[rest] = entry
    found = {
        name: Source(f"{label.rstrip('/')}/{name}", name, folder=own)
        for name, own in inner.items()
        if own.get(f"{name}.json", Entry("other")).kind == "file"
    }
    for path, entry in files.items():
        of = PurePosixPath(path)
        if "/" not in path and entry.kind == "file" and of.suffix.lower() in SUFFIXES:
            place = f"{label.rstrip('/')}/{path}"
            text = entry.content.decode("utf-8-sig", errors="backslashreplace")
            found[of.stem] = Source(place, of.stem, text, of.suffix)
    return found


def same_bytes(before: Source, after: Source) -> bool:
    """Whether two sources are equal to the byte: nothing else needs to be known of them."""
    if before.folder is not None:
        return before.folder == after.folder
    return before.content is not None and before.content == after.content
