"""The real compiler through the installed program: the same bytes everywhere."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.program import pne_gen, tree


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What is written for the Stewart platform under hash seed 0."""
    out = tmp_path_factory.mktemp("reference")
    done = pne_gen("stewart", "--out", out, real=True, PYTHONHASHSEED="0")
    assert (done.returncode, done.stderr) == (0, "")
    return tree(out)


@pytest.mark.parametrize(
    "variables",
    [
        {
            "PYTHONHASHSEED": "4294967295",
            "TZ": "Pacific/Chatham",
            "USER": "someone",
            "LC_ALL": "C",
            "PYTHONUTF8": "0",
            "PYTHONIOENCODING": "ascii",
            "PYTHONOPTIMIZE": "1",
        },
        pytest.param({"PYTHONHASHSEED": "1"}, marks=pytest.mark.only_in_all),
    ],
    ids=["hash seed, time zone, user, locale and optimisation", "hash seed"],
)
def test_nothing_of_the_surroundings_is_in_the_output(
    variables: dict[str, str], reference: dict[str, bytes], tmp_path: Path
) -> None:
    done = pne_gen("stewart", "--out", "elsewhere", real=True, cwd=tmp_path, **variables)
    assert (done.returncode, done.stderr) == (0, "")
    assert tree(tmp_path / "elsewhere") == reference


def test_no_place_of_this_machine_is_in_the_output(reference: dict[str, bytes]) -> None:
    here = str(Path(__file__).parents[2]).encode()
    assert not [name for name, data in reference.items() if here in data]


def test_line_ends_are_line_feeds_and_the_last_line_has_one(reference: dict[str, bytes]) -> None:
    for name, data in reference.items():
        assert b"\r" not in data, name
        assert data == b"" or data.endswith(b"\n"), name


def test_every_file_of_the_model_is_there(reference: dict[str, bytes]) -> None:
    kinds = ("py", "h", "c", "md", "json")
    expected = {
        "__init__.py",
        "stewart/__init__.py",
        *(f"stewart/stewart.{kind}" for kind in kinds),
    }
    assert set(reference) == expected
