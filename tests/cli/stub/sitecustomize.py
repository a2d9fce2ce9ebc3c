"""Loaded by every Python process of a test: a small compiler, and faults.

The stub stands for `pne_sym.pipeline`, so that a test of the command line
takes no longer than it must; `PNE_TEST_FAULT` names what is to go wrong.
"""

import ctypes
import errno
import os
import sys
import time
import types
import warnings

FAULT = os.environ.get("PNE_TEST_FAULT", "")
LONG = 7200  # s; longer than a test waits for the program to be interrupted, on any machine


def compile_model(manipulator):
    from pne_sym.model.errors import SpecError, SpecWarning  # noqa: PLC0415

    name = manipulator.name
    if FAULT == "bug":
        raise RuntimeError("two lines\nof text")
    if FAULT == "outside":
        raise SpecError(name, "legs[0]", "outside the method")
    if FAULT == "warning":
        warnings.warn(SpecWarning(f"{name}: unusual inertia"), stacklevel=1)
    if FAULT == "slow compile":
        os.write(2, b"compiling\n")
        time.sleep(LONG)
    version = os.environ.get("PNE_TEST_VERSION", "1")
    return {
        "__init__.py": f"from .{name} import *\n",
        f"{name}.py": f"mass = {manipulator.platform.mass}\nversion = {version}\n",
        f"{name}.c": f"/* {name} */\n" + "int x;\n" * 1000,
        f"{name}.json": f'{{"generator": "pne_sym", "title": "{name}"}}\n',
    }


def slow_sync(descriptor):
    os.write(2, b"writing\n")
    time.sleep(LONG)


def full_disk(descriptor):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def no_library(name):
    raise OSError("no shared C library")


def dying_rename(source, target, *args, **kwargs):
    rename(source, target, *args, **kwargs)
    if str(target).endswith(".pne-old"):
        os._exit(9)


stub = types.ModuleType("pne_sym.pipeline")
stub.compile_model = compile_model
sys.modules["pne_sym.pipeline"] = stub

rename = os.rename
if FAULT == "slow write":
    os.fsync = slow_sync
if FAULT == "full disk":
    os.fsync = full_disk
if FAULT == "crash between renames":
    os.rename = dying_rename
    ctypes.CDLL = no_library  # so that folders are replaced by two renames
