"""One version of a model under review, from a specification or from a generated folder."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from pne_sym.backends import registry
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.emission import emit, emit_target
from pne_sym.backends.target import is_signed
from pne_sym.contents import recorded_targets
from pne_sym.generation import InputError, find
from pne_sym.model.files import parse
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import from_text
from pne_sym.pipeline import compile_bundle
from pne_sym.review.difference import Deviation
from pne_sym.review.files import as_folder
from pne_sym.review.folders import Folder
from pne_sym.review.manifests import manifest_of
from pne_sym.review.sources import Source

_LEG = re.compile(r"legs\[i\]")
_ANCHOR = re.compile(r"\*\*\((?P<id>[\w-]+)\)\*\*\s*(?P<title>.*)")
_LONGEST_REPORT = 50_000
"""Lines of a report that are read."""
_LONGEST_HEAD = 1000


@dataclass(frozen=True)
class Model:
    """One version of a model.

    Attributes:
        label: what the user called it.
        name: of the model; of a folder what its files are called by.
        manifest: the manifest, parsed and checked.
        bundle: derivation and program, where this pne-gen has derived it: from a
            specification, or from that in the manifest of a folder which is what this
            pne-gen prints.
        written: the specification as its author wrote it, parsed, where there is one.
        folder: all files, where it comes from a folder.
        deviations: where the folder is not what this pne-gen prints.
        targets: what code it consists of; of a folder those that its manifest names.
    """

    label: str
    name: str
    manifest: dict[str, Any]
    bundle: Bundle | None = field(default=None, repr=False)
    written: Mapping[str, Any] | None = field(default=None, repr=False)
    folder: Folder | None = field(default=None, repr=False)
    deviations: tuple[Deviation, ...] = ()
    targets: tuple[str, ...] = field(default_factory=registry.default)
    _printed: dict[str, dict[str, bytes]] = field(default_factory=dict, init=False, repr=False)
    """Our own text by target, printed once."""

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """The manifest's parameters."""
        return list(self.manifest["parameters"])

    @property
    def functions(self) -> dict[str, Any]:
        """The manifest's public functions; none in format 1."""
        return dict(self.manifest.get("functions", {}))

    @cached_property
    def files(self) -> Folder:
        """All files: of the folder, or those that would be generated."""
        if self.folder is not None:
            return self.folder
        assert self.bundle is not None
        return as_folder(emit(self.bundle, self.targets))

    def of_target(self, name: str) -> dict[str, bytes]:
        """The files of a target: our own text wherever there is one."""
        if self.bundle is None:
            owner = registry.target(name)
            return {p: text for p, text in self._of_folder.items() if owner.owns(self.name, p)}
        if name not in self._printed:
            texts = emit_target(self.bundle, registry.target(name))
            self._printed[name] = {p: text.encode() for p, text in texts.items()}
        return self._printed[name]

    def has_generated(self, path: str) -> bool:
        """Whether a file is there and of a generation: a user's is not."""
        entry = self.files.get(path)
        if entry is None or self.folder is None:
            return entry is not None
        signed = is_signed(entry.content) and registry.is_claimed(self.name, path)
        return signed or registry.is_named(self.name, path, self.targets)

    @property
    def python(self) -> dict[str, bytes]:
        """The NumPy package that is run; of a folder all its files."""
        if self.bundle is None:
            return self._of_folder
        return self.of_target("numpy")

    @property
    def c(self) -> dict[str, bytes]:
        """Header and source that are compiled."""
        missing = dict.fromkeys((f"{self.name}.h", f"{self.name}.c"), b"")
        return missing | self.of_target("c")

    @property
    def report(self) -> str:
        """The derivation as Markdown."""
        return self.of_target("report").get(f"{self.name}.md", b"").decode(errors="replace")

    @property
    def _of_folder(self) -> dict[str, bytes]:
        assert self.folder is not None
        return {path: e.content for path, e in self.folder.items() if e.kind == "file"}


def from_manipulator(label: str, manipulator: Manipulator) -> Model:
    """Compile a manipulator in memory.

    Raises:
        SpecError: it is outside the method.
    """
    return from_bundle(label, compile_bundle(manipulator))


def from_bundle(label: str, bundle: Bundle) -> Model:
    """A compiled manipulator as a version of a model."""
    manifest = emit_target(bundle, registry.target("manifest"))[f"{bundle.name}.json"]
    return Model(label, bundle.name, json.loads(manifest), bundle)


def version_of(source: Source) -> Model:
    """A version of a model, compiled where it is a specification, else as a folder has it.

    Raises:
        InputError: it is none, or its manifest is at fault.
        SpecError: the specification is at fault.
    """
    if source.models is not None:
        raise InputError(f"{source.label[:100]!r} is no generated folder: it holds several")
    if source.folder is not None:
        manifest = manifest_of(source)
        targets = recorded_targets(manifest)
        return Model(source.label, source.name, manifest, folder=source.folder, targets=targets)
    if source.content is None:
        return from_manipulator(source.label, find(source.name))
    text = source.content, source.suffix, source.label
    written = parse(*text)
    model = from_manipulator(source.label, from_text(*text))
    return replace(model, written=written if isinstance(written, Mapping) else None)


@dataclass(frozen=True)
class Printed:
    """An equation as a report prints it."""

    id: str
    title: str
    formula: str

    @property
    def left(self) -> str:
        """The left-hand side."""
        text = self.formula.replace("\\begin{aligned}", "").replace("&", "")
        return " ".join(text.partition("=")[0].split())


def printed_equations(report: str) -> list[Printed]:
    """The equations of a report, in order: the first display after a line with an id."""
    found: list[Printed] = []
    head: re.Match[str] | None = None
    formula: list[str] | None = None
    for line in report.split("\n", _LONGEST_REPORT)[:_LONGEST_REPORT]:
        if formula is not None and line.startswith("```"):
            if head is not None:
                text = "\n".join(formula).strip()
                found.append(Printed(head["id"], head["title"].strip(), text))
            head = formula = None
        elif formula is not None:
            formula.append(line)
        elif line.startswith("```math"):
            formula = []
        else:
            head = _ANCHOR.search(line[:_LONGEST_HEAD]) or head
    return found


def paths_of(parameter: dict[str, Any]) -> list[str]:
    """Where a parameter stands in the full form, one path per leg; it may be but one."""
    if "legs" not in parameter:
        return [str(parameter["path"])]
    return [_LEG.sub(f"legs[{leg}]", parameter["path"], count=1) for leg in parameter["legs"]]


def by_path(model: Model, values: dict[str, Any]) -> dict[str, Any]:
    """Values of parameters by name, taken apart to one per path of the full form."""
    found: dict[str, Any] = {}
    for parameter in model.parameters:
        value = np.array(values[parameter["name"]], dtype=float)
        rows = value if "legs" in parameter else [value]
        found |= dict(zip(paths_of(parameter), rows, strict=True))
    return found


def by_name(model: Model, values: dict[str, Any]) -> dict[str, Any]:
    """The inverse of `by_path`; entries that are zero by structure are set to zero."""
    found = {}
    for parameter in model.parameters:
        rows = [np.array(values[path], dtype=float) for path in paths_of(parameter)]
        for row in rows:
            row.reshape(-1)[list(parameter.get("zero_by_structure", ()))] = 0.0
        found[parameter["name"]] = (np.array(rows) if "legs" in parameter else rows[0]).tolist()
    return found
