"""Compiled templates are kept, used, and never in the way."""

from __future__ import annotations

from pathlib import Path

import jinja2
import pytest

from pne_sym.backends.templating import _Kept


def rendered(templates: Path) -> str:
    loader = jinja2.FileSystemLoader(templates)
    made = jinja2.Environment(loader=loader, bytecode_cache=_Kept(templates))
    return made.get_template("one.jinja").render(x=2)


@pytest.fixture
def templates(tmp_path: Path) -> Path:
    tmp_path.joinpath("one.jinja").write_text("{{ x }} legs")
    return tmp_path


def test_what_was_compiled_is_taken(templates: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert rendered(templates) == "2 legs"
    assert len(list(templates.joinpath("__pycache__").iterdir())) == 1
    monkeypatch.setattr(jinja2.Environment, "compile", None)
    assert rendered(templates) == "2 legs"


def test_another_text_is_compiled_anew(templates: Path) -> None:
    assert rendered(templates) == "2 legs"
    templates.joinpath("one.jinja").write_text("{{ x }} arms")
    assert rendered(templates) == "2 arms"


@pytest.mark.parametrize("text", ["", "spoilt"])
def test_a_spoilt_one_is_compiled_anew(templates: Path, text: str) -> None:
    rendered(templates)
    (kept,) = templates.joinpath("__pycache__").iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(text.encode() or whole[: len(whole) // 2])
    assert rendered(templates) == "2 legs"


def test_where_nothing_can_be_kept_it_works_all_the_same(templates: Path) -> None:
    templates.joinpath("__pycache__").write_text("a file")
    assert rendered(templates) == "2 legs"
    assert templates.joinpath("__pycache__").read_text() == "a file"
