"""One version of a model under review, from a specification or from a generated folder."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.manifest import ManifestBackend
from pne_sym.backends.numpy_backend import NumpyBackend
from pne_sym.backends.registry import BACKENDS
from pne_sym.model.manipulator import Manipulator
from pne_sym.pipeline import compile_bundle

_LEG = re.compile(r"legs\[i\]")
_ANCHOR = re.compile(
    r"\*\*\((?P<id>[\w-]+)\)\*\*\s*(?P<title>[^\n]*)\n(?:(?!\*\*\()[^\n]*\n)*?```math\n(?P<math>.*?)\n```",
    re.DOTALL,
)


@dataclass(frozen=True)
class Model:
    """One version of a model.

    Attributes:
        label: what the user called it.
        manifest: the manifest, parsed.
        source: text of the NumPy module.
        report: text of the derivation, where there is one.
        bundle: derivation and program, where it comes from a specification.
        written: the specification as its author wrote it, parsed, where there is one.
    """

    label: str
    manifest: dict[str, Any]
    source: str
    report: str = ""
    bundle: Bundle | None = field(default=None, repr=False)
    written: Mapping[str, Any] | None = field(default=None, repr=False)

    @property
    def parameters(self) -> list[dict[str, Any]]:
        """The manifest's parameters."""
        return list(self.manifest["parameters"])


def from_manipulator(label: str, manipulator: Manipulator) -> Model:
    """Compile a manipulator in memory.

    Raises:
        SpecError: it is outside the method.
    """
    return from_bundle(label, compile_bundle(manipulator))


def from_bundle(label: str, bundle: Bundle) -> Model:
    """A compiled manipulator as a version of a model."""
    return Model(
        label,
        json.loads(ManifestBackend().emit(bundle)[f"{bundle.name}.json"]),
        NumpyBackend().emit(bundle)[f"{bundle.name}.py"],
        bundle=bundle,
    )


def report_of(model: Model) -> str:
    """The derivation as Markdown; emitted for a specification, where a back end does."""
    if model.bundle is None:
        return model.report
    for backend in BACKENDS:
        if backend.name == "report":
            return backend.emit(model.bundle)[f"{model.bundle.name}.md"]
    return ""


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
    """The equations of a report, in order."""
    return [
        Printed(m["id"], m["title"].strip(), m["math"].strip()) for m in _ANCHOR.finditer(report)
    ]


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
