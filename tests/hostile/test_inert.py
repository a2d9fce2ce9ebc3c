"""Titles and symbols of an author are text in every generated file, never code or markup."""

from __future__ import annotations

import ast
import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import pne_sym
from pne_sym.backends.describe import safe_text
from pne_sym.generation import find
from pne_sym.model.errors import SpecError
from pne_sym.model.manipulator import Manipulator
from pne_sym.model.reader import checked
from tests.cli.program import tree
from tests.sampling import sampled

WORD = "pwned"
TITLES = [
    f"*/ int {WORD}; /*",
    f"// \\ */ #define {WORD} 1",
    f"??/ */ int {WORD};",
    f'""" + __import__("os").system("touch {WORD}") + """',
    "''' \\N{BULLET} \\x41 \\",
    "{{ 7*7 }} {% for x in y %} {# #}",
    "$(touch pwned) `touch pwned` $HOME ; touch pwned &",
    f"<script>alert({WORD!r})</script><img src=x onerror=alert(1)>",
    "[link](javascript:alert(1)) ![image](http://example.org/x.png)",
    "# heading | table --- *bold* _it_ ~~s~~ <!-- -->",
    r"\input{/etc/passwd} \write18{touch pwned} $x$ $$y$$ $`z`$ \end{math}",
    "%s %n %(x)s {0} {x!r} ${x}",
    "../../../etc/passwd",
    "&lt;b&gt; &#42;&#47;",
    "https://example.org/ www.example.org @someone #1",
]


def titled(title: str) -> Manipulator:
    return checked(replace(find("fivebar_prismatic"), title=title))


@cache
def plain_files() -> dict[str, str]:
    """With a harmless title."""
    return pne_sym.compile_model(titled("A title"))


@pytest.fixture(scope="module", params=sampled(range(len(TITLES)), 3), ids=lambda k: f"title{k}")
def generated(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory):
    title, folder = TITLES[request.param], tmp_path_factory.mktemp("hostile")
    pne_sym.generate(titled(title), folder / "out")
    return title, folder


def test_files_are_those_of_the_model(generated) -> None:
    _, folder = generated
    names = {name.replace("fivebar_prismatic", "NAME") for name in tree(folder)}
    assert names >= {"out/__init__.py", "out/NAME/__init__.py", "out/NAME/NAME.py"}
    assert all(
        re.fullmatch(r"out/(NAME/)?(__init__|NAME)\.(py|c|h|md|json)", name) for name in names
    )


def test_python_has_the_same_code(generated) -> None:
    """All that differs from a harmless title is text of docstrings."""
    _, folder = generated
    text = (folder / "out/fivebar_prismatic/fivebar_prismatic.py").read_text(encoding="utf-8")
    plain = plain_files()["fivebar_prismatic.py"]
    assert stripped(text) == stripped(plain)


def stripped(text: str) -> str:
    """The code alone: without comments (the parser drops them) and docstrings."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.FunctionDef | ast.ClassDef) and node.body:
            first = node.body[0]
            if isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant):
                first.value.value = ""
    return ast.dump(tree)


def test_python_imports_and_nothing_runs(generated) -> None:
    _, folder = generated
    code = "from generated import fivebar_prismatic as m; print(m.M([0.35, 0.6]).shape)"
    (folder / "generated").symlink_to(folder / "out")
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "(2, 2)\n", "")
    assert not (folder / WORD).exists()


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_c_has_the_same_tokens(generated) -> None:
    _, folder = generated
    plain = plain_files()
    for suffix in (".h", ".c"):
        name = f"fivebar_prismatic{suffix}"
        path = folder / "out/fivebar_prismatic" / name
        if not path.exists():
            pytest.skip("no C back end")
        (folder / name).write_text(plain[name])
        (folder / "fivebar_prismatic.h").write_text(plain["fivebar_prismatic.h"])
        assert tokens(path) == tokens(folder / name)


def tokens(path: Path) -> str:
    """What the compiler sees, macros included; trigraphs on, as C99 has them."""
    command = ["gcc", "-std=c99", "-trigraphs", "-E", "-P", "-dD", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return done.stdout


def test_markdown_shows_the_title_and_nothing_of_it_acts(generated) -> None:
    title, folder = generated
    path = folder / "out/fivebar_prismatic/fivebar_prismatic.md"
    lines = path.read_text(encoding="utf-8").splitlines()
    plain = plain_files()["fivebar_prismatic.md"].splitlines()
    differing = [line for line, other in zip(lines, plain, strict=True) if line != other]
    assert differing
    for line in differing:
        start, _, rest = line.partition(" ")
        assert start == "#"
        shown = re.sub(r"(?<!\\)&(lt|gt);", r"\\<", rest)
        acting = re.sub(r"\\[!-/:-@\[-`{-~]", "", shown)  # what a backslash makes plain
        assert not re.search(r"[<>$`\\*_\[\]{}|~&]", acting), line
        assert re.sub(r"\W", "", shown) == re.sub(r"\W", "", title)


def test_manifest_is_plain_json(generated) -> None:
    title, folder = generated
    path = folder / "out/fivebar_prismatic/fivebar_prismatic.json"
    manifest = json.loads(path.read_text(encoding="utf-8"))
    assert manifest["title"] in (title, safe_text(title))


@pytest.mark.parametrize(
    "text",
    [r"\input{x}", "L$", r"\write18", "a b", "<b>", "x^2", r"\theta_{12}", "*/", '"""', "{{ 7 }}",
     "q_1_2", "", "a" * 40, r"\newcommand"],
)  # fmt: skip
def test_symbols_have_a_grammar(text: str) -> None:
    with pytest.raises(SpecError, match="symbols"):
        checked(replace(find("fivebar_prismatic"), symbols=(("q_1", text),)))
