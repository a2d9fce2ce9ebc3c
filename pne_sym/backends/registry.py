"""The back ends, in the order in which they run."""

from __future__ import annotations

from pne_sym.backends.bundle import Backend
from pne_sym.backends.c_backend import CBackend
from pne_sym.backends.manifest import ManifestBackend
from pne_sym.backends.numpy_backend import NumpyBackend
from pne_sym.backends.report import ReportBackend

BACKENDS: tuple[Backend, ...] = (NumpyBackend(), CBackend(), ManifestBackend(), ReportBackend())
