"""Targets: what the registry says of a back end is so, and one that lacks something says so."""

from __future__ import annotations

import re
from dataclasses import replace
from fnmatch import fnmatchcase
from itertools import combinations
from pathlib import Path

import pytest

from pne_sym.backends import registry
from pne_sym.backends.emission import emit, emit_target
from pne_sym.backends.target import Target, TargetError
from pne_sym.backends.xp import XpBackend
from pne_sym.contents import check_names
from pne_sym.review.code import passages
from tests.backends import columns
from tests.models import bundle, catalogue, texts

MODELS = ("planar_3rpr", "tripod_3prs")
TARGETS = pytest.mark.parametrize("target", registry.TARGETS, ids=lambda t: t.name)


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        ("numpy,c", ("numpy", "c")),
        (" xp , c,c", ("c", "xp")),
        (["c", "numpy"], ("numpy", "c")),
        (("xp",), ("xp",)),
    ],
)
def test_names_are_taken_in_one_order(names: str | list[str], expected: tuple[str, ...]) -> None:
    assert registry.chosen(names) == expected


@pytest.mark.parametrize(
    "names", ["", " ", [], "numpy,", ",", "numpy c", "NumPy", "report", "x" * 99]
)
def test_what_is_no_target_is_refused_with_what_is_allowed(names: str | list[str]) -> None:
    with pytest.raises(TargetError, match=r"no target .*allowed are numpy, c, xp") as refused:
        registry.chosen(names)
    assert len(str(refused.value)) < 120


@TARGETS
@pytest.mark.parametrize("name", MODELS)
def test_a_target_writes_files_of_its_own_only(target: Target, name: str) -> None:
    made = emit_target(bundle(catalogue(name)), target)
    assert made
    check_names(name, made)
    for path in made:
        assert [t.name for t in registry.TARGETS if t.owns(name, path)] == [target.name]
        assert registry.is_claimed(name, path)
        always = target.always or target.default
        assert registry.is_named(name, path, ()) == always
        assert registry.is_named(name, path, (target.name,)) == ("*" not in "".join(target.files))
    for pattern in target.files:
        assert any(fnmatchcase(path, pattern.format(name=name)) for path in made), pattern
    assert all(any(target.has_code(name, path) for path in made) for _ in target.code)
    assert bool(target.code) == (target.syntax is not None)


def test_targets_share_no_file() -> None:
    for one, other in combinations(registry.TARGETS, 2):
        assert not set(one.files) & set(other.files)


def test_default_targets_are_not_told_by_the_manifest() -> None:
    compiled = bundle(catalogue("planar_3rpr"))
    source, manifest = texts(catalogue("planar_3rpr"))
    files = emit(compiled)
    assert sorted(files) == [
        "__init__.py",
        *(f"planar_3rpr.{s}" for s in ("c", "h", "json", "md", "py")),
    ]
    assert (files["planar_3rpr.py"], files["planar_3rpr.json"]) == (source, manifest)
    assert emit(compiled, ("c", "numpy")) == files
    assert '"targets"' not in manifest


def test_other_targets_are_told_and_change_nothing_else() -> None:
    compiled = bundle(catalogue("planar_3rpr"))
    default, more, one = (
        emit(compiled),
        emit(compiled, ("numpy", "c", "xp")),
        emit(compiled, ["xp"]),
    )
    line = '"targets": ["numpy", "c", "xp"],\n'
    assert more["planar_3rpr.json"].replace(line, "") == default["planar_3rpr.json"]
    assert {p: t for p, t in more.items() if p in default and not p.endswith(".json")} == {
        p: t for p, t in default.items() if not p.endswith(".json")
    }
    assert set(more) - set(default) == {"planar_3rpr_xp.py"}
    assert sorted(one) == ["planar_3rpr.json", "planar_3rpr.md", "planar_3rpr_xp.py"]
    assert '"targets": ["xp"],\n' in one["planar_3rpr.json"]


# --- operations -------------------------------------------------------------------


def test_what_xp_says_that_it_prints_it_prints() -> None:
    """Operations that are no expression are methods that stand in the module."""
    needed = frozenset[str]()
    for name in MODELS:
        compiled = bundle(catalogue(name))
        needed |= frozenset().union(*(f.operations for f in compiled.program.public))
        (text,) = XpBackend().emit(compiled).values()
        called = set(re.findall(r"\bs\.(\w+)\(", text))
        assert called <= set(re.findall(r"^    def (\w+)\(self", text, re.MULTILINE))
    assert "search" in needed
    assert len(needed) > 20
    assert needed <= XpBackend().operations


def test_a_back_end_that_lacks_an_operation_says_so() -> None:
    poor = replace(columns.TARGET, name="poor", backend="tests.backends.columns:PoorBackend")
    with pytest.raises(TargetError) as refused:
        emit_target(bundle(catalogue("planar_3rpr")), poor)
    message = str(refused.value)
    assert "\n" not in message
    found = re.fullmatch(
        r"planar_3rpr: the target poor cannot print (\w+): it has no operation '(\w+)'.*; "
        r"generate without poor",
        message,
    )
    assert found is not None
    functions = {f.name: f for f in bundle(catalogue("planar_3rpr")).program.public}
    assert found[2] in functions[found[1]].operations


def test_a_back_end_that_writes_what_it_does_not_own_is_found() -> None:
    other = replace(columns.TARGET, files=("columns/README.txt",), code=(), syntax=None)
    with pytest.raises(AssertionError, match="does not own columns/"):
        emit_target(bundle(catalogue("planar_3rpr")), other)


@pytest.mark.parametrize(("name", "most"), [("xp", 700), ("octave", 700)])
def test_what_a_back_end_costs(name: str, most: int) -> None:
    """Lines in its folders, blank ones and docstrings too; nothing else names it."""
    root = Path(__file__).parents[2]
    own = [root / "pne_sym/backends" / name, root / "templates" / name]
    files = {p.name: p.read_text(encoding="utf-8") for f in own for p in f.iterdir() if p.is_file()}
    assert 300 < sum(text.count("\n") for text in files.values()) <= most
    others = [p for p in (root / "pne_sym").rglob("*.py") if own[0] not in p.parents]
    named = [p.name for p in others if f"backends.{name}" in p.read_text(encoding="utf-8")]
    assert named == ["registry.py"]


# --- syntax ----------------------------------------------------------------------


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("target", [t for t in registry.TARGETS if t.code], ids=lambda t: t.name)
def test_under_every_equation_s_comment_there_are_its_statements(target: Target, name: str) -> None:
    compiled = bundle(catalogue(name))
    assert target.syntax is not None
    code = {p: t for p, t in emit_target(compiled, target).items() if target.has_code(name, p)}
    heads = re.findall(r"^\s*\S+ \(([\w-]+)\) ", "\n".join(code.values()), re.MULTILINE)
    ids = set(heads) & {e.id for e in compiled.derivation.equations()}
    assert len(ids) > 20
    for equation in ids:
        found = passages(code, equation, target.syntax)
        assert found, equation
        for passage in found:
            assert all(passage.functions)
            assert re.search(r" \+?=|^stored\[|^(gather|KEEP(_OF_LEG)?)\(", passage.lines[0])
            for line in passage.lines:
                assert not re.match(
                    r"return|s\.(require|settle|total)|ok\b|def |/\*|#|[\w ,]+\*/", line
                ), line
