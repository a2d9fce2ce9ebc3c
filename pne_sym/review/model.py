"""One version of a model under review, from a specification or from a generated folder."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_backend import CBackend
from pne_sym.backends.manifest import ManifestBackend
from pne_sym.backends.numpy_backend import NumpyBackend
from pne_sym.backends.registry import BACKENDS
from pne_sym.backends.report import ReportBackend
from pne_sym.model.manipulator import Manipulator
from pne_sym.pipeline import compile_bundle
from pne_sym.review.difference import Deviation
from pne_sym.review.files import as_folder
from pne_sym.review.folders import Folder

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
        source: text of the NumPy module.
        bundle: derivation and program, where this pne-gen has derived it: from a
            specification, or from that in the manifest of a folder which is what this
            pne-gen prints.
        written: the specification as its author wrote it, parsed, where there is one.
        folder: all files, where it comes from a folder.
        deviations: where the folder is not what this pne-gen prints.
    """

    label: str
    name: str
    manifest: dict[str, Any]
    source: str
    bundle: Bundle | None = field(default=None, repr=False)
    written: Mapping[str, Any] | None = field(default=None, repr=False)
    folder: Folder | None = field(default=None, repr=False)
    deviations: tuple[Deviation, ...] = ()

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
        return as_folder(printed(self._derived))

    @property
    def python(self) -> dict[str, bytes]:
        """The NumPy package that is run: our own text wherever there is one."""
        if self.bundle is None:
            return self._of_folder
        texts = NumpyBackend().emit(self.bundle) | {f"{self.name}.py": self.source}
        return {name: text.encode() for name, text in texts.items()}

    @property
    def c(self) -> dict[str, bytes]:
        """Header and source that are compiled: our own text wherever there is one."""
        if self.bundle is None:
            names = (f"{self.name}.h", f"{self.name}.c")
            return {name: self._of_folder.get(name, b"") for name in names}
        return {name: text.encode() for name, text in CBackend().emit(self.bundle).items()}

    @property
    def report(self) -> str:
        """The derivation as Markdown."""
        if self.bundle is None:
            return self._of_folder.get(f"{self.name}.md", b"").decode(errors="replace")
        return ReportBackend().emit(self.bundle)[f"{self.name}.md"]

    @property
    def _of_folder(self) -> dict[str, bytes]:
        assert self.folder is not None
        return {path: e.content for path, e in self.folder.items() if e.kind == "file"}

    @property
    def _derived(self) -> Bundle:
        assert self.bundle is not None
        return self.bundle


def printed(bundle: Bundle) -> dict[str, str]:
    """All files of a model's folder."""
    texts: dict[str, str] = {}
    for backend in BACKENDS:
        texts |= backend.emit(bundle)
    return texts


def from_manipulator(label: str, manipulator: Manipulator) -> Model:
    """Compile a manipulator in memory.

    Raises:
        SpecError: it is outside the method.
    """
    return from_bundle(label, compile_bundle(manipulator))


def from_bundle(label: str, bundle: Bundle) -> Model:
    """A compiled manipulator as a version of a model."""
    name = bundle.name
    return Model(
        label,
        name,
        json.loads(ManifestBackend().emit(bundle)[f"{name}.json"]),
        NumpyBackend().emit(bundle)[f"{name}.py"],
        bundle=bundle,
    )


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
