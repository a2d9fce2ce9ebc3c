"""Text of our own, told from a folder's by its isolation, is run in the process of its test.

To start a Python with NumPy, and to compile the module again, takes longer than to call it. Folders
are run as for users here; so is all text by the program, in `tests/cli`.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from functools import cache
from types import ModuleType
from typing import Any

import pytest

from pne_sym.review import runner, values
from pne_sym.review.execution import Answer, _parsed, execute
from pne_sym.review.sandbox import Isolation


@cache
def _module(name: str, text: bytes) -> ModuleType:
    made = ModuleType(name)
    exec(compile(text, f"<{name}.py>", "exec"), made.__dict__)
    return made


def _executed(
    label: str,
    model: str,
    files: Mapping[str, bytes],
    request: dict[str, Any],
    isolation: Isolation | None,
) -> Answer:
    if isolation is not Isolation.NONE:
        return execute(label, model, files, request, isolation)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        said = runner.answered(_module(model, files[f"{model}.py"]), request)
    return _parsed(json.dumps(said).encode(), request)


@pytest.fixture(autouse=True)
def own_text_in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(values, "execute", _executed)
