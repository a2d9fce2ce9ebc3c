"""Edits of generated folders: each is found, whatever it is and wherever it stands."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest

from pne_sym.review.difference import Verdict
from tests.review.folders import Edit, compared, diff, edit, pair, texts
from tests.sampling import sampled

MODEL = "planar_3rpr"
FILES = ("__init__.py", *(f"{MODEL}.{kind}" for kind in ("c", "h", "json", "md", "py")))
PER_FILE = 9


def replaced(old: str, new: str) -> Edit:
    return lambda text: text.replace(old, new, 1)


def substituted(pattern: str, new: str) -> Edit:
    return lambda text: re.sub(pattern, new, text, count=1)


def appended(code: str) -> Edit:
    return lambda text: text + code


NAMED: dict[str, tuple[str, Edit]] = {
    "the wrench's sign": (
        "planar_3rpr.py",
        substituted(r"required - wrench", r"required + wrench"),
    ),
    "another rotation": (
        "planar_3rpr.py",
        substituted(r"(def rotation\(X\):\n)", r"\1    return 7\n"),
    ),
    "a tolerance": ("planar_3rpr.py", substituted(r"_TOLERANCE = \S+", "_TOLERANCE = 1e-30")),
    "the wrench's moments": (
        "planar_3rpr.py",
        substituted(r"(def _steps_forward_dynamics\((?:.*\n)*?    add_1 = .* )w", r"\g<1>1.5 * w"),
    ),
    "code at import": ("planar_3rpr.py", appended("\nimport os\nos.umask(0o777)\n")),
    "M for others than the runner": (
        "planar_3rpr.py",
        appended("\nif __name__ != 'model':\n    def M(X, p=None):\n        return 2.0\n"),
    ),
    "M in the package": (
        "__init__.py",
        appended("\n_M = M\n\n\ndef M(X, p=None):\n    return 1.001 * _M(X, p)\n"),
    ),
    "gravity in C": ("planar_3rpr.c", replaced("-9.81", "-9.80")),
    "a sum over legs in C": (
        "planar_3rpr.c",
        substituted(r"(INLINE real total\(.*\n(?:.*\n)*?    return )sum", r"\1(real)1.001 * sum"),
    ),
    "a size in the header": ("planar_3rpr.h", substituted(r"(_NV) 3\b", r"\1 4")),
    "a formula of the report": ("planar_3rpr.md", replaced("\\times", "\\cdot")),
    "an operation count": ("planar_3rpr.json", substituted(r'"mul": (\d+)', r'"mul": 1\1')),
    "a digest": ("planar_3rpr.json", substituted(r'("spec": ")[0-9a-f]', r"\1g")),
    "the specification": ("planar_3rpr.json", substituted(r'("mass": )\d', r"\g<1>7")),
}
VALUES = {  # function of which --run tells another value
    "the wrench's sign": "inverse_dynamics",
    "another rotation": "rotation",
    "the wrench's moments": "forward_dynamics",
    "M for others than the runner": "M",
    "M in the package": "M",
    "gravity in C": "C: Z",
    "a sum over legs in C": "C: M",
    "a size in the header": "C: sizes",
}


@pytest.mark.parametrize("case", NAMED)
def test_a_named_edit_is_found(case: str, tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    file, change = NAMED[case]
    edit(after / file, change)
    done = diff(before, after)
    assert done.exit_code == 1, done.output
    assert f"{file}: differs, line" in done.output
    assert "values not compared" in done.output
    assert diff(after, before, "--quiet").exit_code == 1


def test_all_files_are_edited() -> None:
    assert sorted(texts(MODEL)) == sorted(FILES)


def mutated(text: str, rng: random.Random) -> str:
    """The text with one line changed: a number, a sign, a name, a blank, or the line as such."""
    lines = text.split("\n")
    while True:
        k = rng.randrange(len(lines))
        line = lines[k]
        changed = rng.choice(
            [
                re.sub(r"\d(?!.*\d)", lambda m: str((int(m[0]) + 1) % 10), line),
                line.translate(str.maketrans("+-<>", "-+><")),
                re.sub(r"[a-z](?=[^a-z]*$)", "q", line),
                f"{line} ",
                line.swapcase(),
                None,
                f"{line}\n{line}",
            ]
        )
        made = lines[:k] + ([] if changed is None else [changed]) + lines[k + 1 :]
        if "\n".join(made) != text:
            return "\n".join(made)


@pytest.mark.parametrize("file", FILES)
def test_sampled_lines_of_every_file(file: str, tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    right = (after / file).read_text()
    rng = random.Random(f"{file} 0")
    for k in range(PER_FILE):
        (after / file).write_text(mutated(right, rng))
        done = diff(before, after)
        assert done.exit_code in (1, 2), (k, done.output)
        if done.exit_code == 2:  # a manifest that is none any more
            assert file.endswith(".json"), done.output
        else:
            assert f"{file}: differs, line" in done.output, k
        assert done.exception is None or isinstance(done.exception, SystemExit)


def test_there_are_enough_edits() -> None:
    assert len(FILES) * PER_FILE >= 50
    assert {Path(f).suffix for f in FILES} == {".py", ".c", ".h", ".md", ".json"}


@pytest.mark.parametrize("case", sampled(VALUES, 3))
def test_run_locates_other_values(case: str, tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    file, change = NAMED[case]
    edit(after / file, change)
    found = compared(before, after, run=True)
    assert not found.equal
    assert found.not_compared == ""
    different = {b.name for b in found.blocks if b.verdict is Verdict.DIFFERENT}
    assert VALUES[case] in different
    if case == "the wrench's sign":
        assert different == {"inverse_dynamics"}
        block = next(b for b in found.blocks if b.name == "inverse_dynamics")
        assert block.gap is not None
        assert "with" in block.gap.where
    assert [f.path for f in found.files] == [file]
    assert any("by its own account" in note for note in found.notes)


def test_equal_values_by_its_own_account_are_no_equality(tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    edit(after / "planar_3rpr.py", appended("\n# a remark\n"))
    found = compared(before, after, run=True)
    assert {b.verdict for b in found.blocks} == {Verdict.EQUAL, Verdict.IDENTICAL}
    assert not found.equal
    assert diff(before, after, "--run").exit_code == 1


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("notes.txt", "notes.txt: differs, only after"),
        ("sub/deeper.py", "sub/deeper.py: differs, only after"),
        ("__pycache__/planar_3rpr.cpython-311.pyc", "Python may run it in place of the module"),
    ],
)
def test_another_file_counts(name: str, part: str, tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    (after / name).parent.mkdir(exist_ok=True)
    (after / name).write_text("anything")
    done = diff(before, after)
    assert done.exit_code == 1
    assert part in done.output
    (before / name).parent.mkdir(exist_ok=True)
    (before / name).write_text("anything")
    done = diff(before, after)
    assert (done.exit_code, done.exception) == (0, None)
    assert "equal: identical text" in done.output


@pytest.mark.parametrize("file", FILES)
def test_a_missing_file_counts(file: str, tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    (after / file).unlink()
    done = diff(before, after)
    assert done.exit_code == (2 if file.endswith(".json") else 1)


def test_the_same_edit_on_both_sides_is_no_reason_to_trust_the_rest(tmp_path: Path) -> None:
    """Two folders, equal where pne-gen printed something else: another file decides."""
    before, after = pair(tmp_path, MODEL)
    for folder in (before, after):
        edit(folder / "planar_3rpr.py", appended("\n# a remark\n"))
    assert diff(before, after).exit_code == 0
    edit(after / "planar_3rpr.md", appended("\n"))
    done = diff(before, after)
    assert done.exit_code == 1
    assert "planar_3rpr.py, line" in done.output


def test_a_line_that_acts_on_the_terminal_or_the_reader_is_escaped(tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    edit(after / "planar_3rpr.md", lambda text: f"\x1b[2J\u202e{'x' * 5000}\n{text}")
    done = diff(before, after)
    assert done.exit_code == 1
    assert "\\x1b[2J\\u202e" in done.output
    assert "\x1b" not in done.output
    assert max(map(len, done.output.split("\n"))) < 500


def test_c_can_be_left_out_which_is_said(tmp_path: Path) -> None:
    before, after = pair(tmp_path, MODEL)
    file, change = NAMED["gravity in C"]
    edit(after / file, change)
    done = diff(before, after, "--run", "--no-c")
    assert done.exit_code == 1
    assert re.search(r"^  C +not compared; left out by --no-c$", done.output, re.MULTILINE)
    assert "C: Z" not in done.output


def test_a_statement_of_the_code_is_placed_at_its_equation(tmp_path: Path) -> None:
    """A planted fault of the lowering in a folder, of which nothing is run."""
    before, after = pair(tmp_path, MODEL)
    ids = re.findall(r"^ +# \((rpr-\w+)\)", texts(MODEL)["planar_3rpr.py"], re.MULTILINE)
    wanted = ids[len(ids) // 2]
    edit(after / "planar_3rpr.py", substituted(rf"(# \({wanted}\).*\n.* = )", r"\1-"))
    done = diff(before, after)
    assert done.exit_code == 1
    assert re.search(rf"planar_3rpr\.py: differs, line \d+, under \({wanted}\)", done.output)
    assert re.search(rf"first at planar_3rpr\.py line \d+, under \({wanted}\)", done.output)
