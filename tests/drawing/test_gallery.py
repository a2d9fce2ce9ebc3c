"""docs/gallery.md: the whole catalogue, with the figures that the program gives."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path
from types import ModuleType

import pytest

from pne_sym import manipulators
from pne_sym.pipeline import compile_model

DOCS = Path(__file__).parents[2] / "docs"
REMEDY = "run `make generate` and `make gallery`"
CHEAP = ("fivebar_prismatic", "planar_3rpr", "tripod_3rps")


def load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_gallery", DOCS / "make_gallery.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["make_gallery"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def gallery() -> ModuleType:
    return load()


@pytest.fixture(scope="module")
def sections(gallery: ModuleType) -> dict[str, str]:
    """The page's sections by name."""
    text = gallery.PAGE.read_text(encoding="utf-8")
    parts = text.split("\n### ")[1:]
    return {part.split("\n", 1)[0]: part.split("\n## ")[0] for part in parts}


def test_the_whole_catalogue_is_there(sections: dict[str, str]) -> None:
    assert sorted(sections) == sorted(manipulators.names()), REMEDY


@pytest.mark.parametrize("name", manipulators.names())
def test_pictures_and_links_lead_somewhere(name: str, sections: dict[str, str]) -> None:
    assert f'<img src="gallery/{name}.svg"' in sections[name]
    picture = DOCS / "gallery" / f"{name}.svg"
    assert 1000 < picture.stat().st_size < 95_000
    assert f'<a href="../generated/{name}/{name}.md">' in sections[name]
    assert (DOCS.parent / "generated" / name / f"{name}.md").is_file()


def test_no_picture_is_left_over() -> None:
    found = {path.stem for path in (DOCS / "gallery").iterdir()}
    assert found == set(manipulators.names()), REMEDY


@pytest.mark.parametrize("name", CHEAP)
def test_figures_are_those_of_the_program(
    name: str, gallery: ModuleType, sections: dict[str, str]
) -> None:
    model = manipulators.load(name)
    manifest = json.loads(compile_model(model)[f"{name}.json"])
    written = gallery.page([gallery.entry(model, manifest)])
    section = written.split("\n### ")[1]
    assert section.strip() == sections[name].strip(), REMEDY
    row = next(line for line in written.splitlines() if line.startswith(f"| [{name}]"))
    assert row in gallery.PAGE.read_text(encoding="utf-8").splitlines(), REMEDY


def test_figures_are_those_of_the_generated_models(gallery: ModuleType) -> None:
    """The page and the derivations that it links to are of one run of the generator."""
    models = [manipulators.load(name) for name in manipulators.names()]
    entries = [gallery.entry(model, gallery.manifest(model.name)) for model in models]
    assert gallery.page(entries) == gallery.PAGE.read_text(encoding="utf-8"), REMEDY


def test_a_model_that_is_not_generated(gallery: ModuleType) -> None:
    with pytest.raises(SystemExit, match="`make generate` writes it"):
        gallery.manifest("no_such_model")
