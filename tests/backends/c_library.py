"""Compile a generated C module and call it through ctypes."""

from __future__ import annotations

import ctypes
import hashlib
import os
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_backend import CBackend
from pne_sym.backends.c_public import CFunction, c_functions
from pne_sym.backends.describe import field_views
from tests import models

OK, UNREACHABLE, SINGULAR, INVALID, NOT_CONVERGED = range(5)
WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror".split()
FAST = ("-O3", "-march=native", "-fno-math-errno")
QUICK = ("-O0",)
_REALS: dict[str, Any] = {"double": np.float64, "float": np.float32, "long double": np.longdouble}

Array = np.ndarray[Any, Any]


def find_compiler(name: str) -> str:
    """The compiler; without it the test is skipped, in CI it fails."""
    found = shutil.which(name)
    if found is None:
        (pytest.fail if os.environ.get("CI") == "true" else pytest.skip)(f"{name} is not installed")
    return str(found)


def quick_compiler() -> str:
    """For what need not be fast: clang, which takes 0.4 of gcc's time for it, if there is one."""
    return "clang" if shutil.which("clang") else "gcc"


def write_sources(bundle: Bundle, folder: Path) -> Path:
    """Write header and source; returns the source."""
    for name, text in CBackend().emit(bundle).items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder / f"{bundle.name}.c"


def run(*command: str | Path, folder: Path | None = None) -> str:
    """Run a command; the test fails with its messages if it does."""
    done = subprocess.run(
        [str(c) for c in command], capture_output=True, text=True, check=False, cwd=folder
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def compiled(source: Path, compiler: str, flags: Sequence[str]) -> Path:
    """The shared library of a source and its header, compiled once for all tests of a run."""
    texts = [file.read_bytes() for file in (source, source.with_suffix(".h"))]
    key = hashlib.sha256(b"\0".join([*texts, " ".join((compiler, *flags)).encode()])).hexdigest()
    kept = models.KEPT / f"{key[:32]}.so"
    with models.alone(kept):
        if not kept.exists():
            made = source.with_suffix(f".{key[:32]}")
            flags = ["-std=c99", *flags, "-shared", "-fPIC"]
            run(find_compiler(compiler), *flags, source, "-o", made, "-lm")
            models.keep(kept, made.read_bytes())
    return kept


class CLibrary:
    """A compiled model; arrays in, arrays out.

    Attributes:
        api: the public functions by name.
        status: what `prepare` returned.
    """

    def __init__(
        self,
        bundle: Bundle,
        folder: Path,
        real: str = "double",
        compiler: str = "",
        flags: Sequence[str] = FAST,
    ) -> None:
        source, self.name = write_sources(bundle, folder), bundle.name
        compiler = compiler or (quick_compiler() if "-O0" in flags else "gcc")
        library = compiled(source, compiler, (*flags, f"-D{self.name.upper()}_REAL={real}"))
        self.real = np.dtype(_REALS[real])
        self.library = ctypes.CDLL(str(library))
        self.api: dict[str, CFunction] = {f.name: f for f in c_functions(bundle)}
        self.fields = field_views(bundle)
        self.model = ctypes.create_string_buffer(1 << 20)  # larger than any prepared model
        size = sum(int(np.prod(f.shape, dtype=int)) for f in self.fields)
        self.defaults = self._constant("default_params", size)
        self.status = self.prepare(self.defaults)

    def _constant(self, name: str, size: int) -> Array:
        at = ctypes.addressof(ctypes.c_char.in_dll(self.library, f"{self.name}_{name}"))
        text = ctypes.string_at(at, size * self.real.itemsize)
        return np.frombuffer(text, dtype=self.real).copy()

    def constant(self, name: str, size: int) -> Array:
        """An exported array of numbers."""
        return self._constant(name, size)

    def parameters(self, p: Any) -> Array:
        """`Parameters` of the NumPy module as the structure of parameters."""
        parts = [np.ravel(np.asarray(getattr(p, f.name), dtype=self.real)) for f in self.fields]
        return np.concatenate(parts)

    def prepare(self, params: Array) -> int:
        """Prepare the model that later calls use."""
        function = getattr(self.library, f"{self.name}_prepare")
        status: int = function(params.ctypes.data_as(ctypes.c_void_p), self.model)
        return status

    def single(self, name: str, *inputs: Array | None) -> tuple[list[Array], int]:
        """Outputs (flat) and status of a state."""
        api = self.api[name]
        arrays = self._inputs(api, inputs)
        outputs = [np.full(o.size, 77.0, self.real) for o in api.outputs]
        function = getattr(self.library, f"{self.name}_{name}")
        return outputs, int(function(*self._pointers(api, arrays, outputs)))

    def batch(self, name: str, *inputs: Array | None) -> tuple[list[Array], Array]:
        """Outputs (states, flat) and status of every state."""
        api = self.api[name]
        arrays = self._inputs(api, inputs)
        n = next(len(a) for a in arrays if a is not None)
        outputs = [np.full((n, o.size), 77.0, self.real) for o in api.outputs]
        status = np.full(n, -1, np.intc)
        function = getattr(self.library, f"{self.name}_{name}_batch")
        function.restype = ctypes.c_size_t
        pointers = self._pointers(api, arrays, outputs)
        pointers.insert(int(api.has_model), ctypes.c_size_t(n))
        failed = function(*pointers, status.ctypes.data_as(ctypes.c_void_p))
        assert failed == np.count_nonzero(status)
        return outputs, status

    def _inputs(self, api: CFunction, inputs: Sequence[Array | None]) -> list[Array | None]:
        assert len(inputs) == len(api.inputs)
        return [None if a is None else np.ascontiguousarray(a, self.real) for a in inputs]

    def _pointers(
        self, api: CFunction, inputs: Sequence[Array | None], outputs: list[Array]
    ) -> list[Any]:
        found: list[Any] = [self.model] if api.has_model else []
        for array in (*inputs, *outputs):
            found.append(None if array is None else array.ctypes.data_as(ctypes.c_void_p))
        return found
