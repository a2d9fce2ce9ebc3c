"""A folder is written as a whole, whatever fails and at whichever step."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from pne_sym import writer
from pne_sym.backends import registry
from pne_sym.backends.target import Target
from pne_sym.writer import OutputError, check_output, write_model

MANIFEST = '{"generator": {"name": "pne_sym"}}\n'
OLD = {"robot.py": "x = 1\n", "robot.json": MANIFEST, "robot.h": "\n"}
NEW = {"robot.py": "x = 2\n# \u03c6\u00e9\n", "robot.json": MANIFEST, "robot.c": "int x;\n"}


def content(folder: Path) -> dict[str, str]:
    """Every file below a folder, hidden ones too."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes().decode()
        for path in folder.rglob("*")
        if path.is_file()
    }


def in_model(files: dict[str, str]) -> dict[str, str]:
    return {
        "__init__.py": writer._PACKAGE_INIT,
        **{f"robot/{name}": text for name, text in files.items()},
    }


def test_writes_exactly_the_files_given(tmp_path: Path) -> None:
    out = tmp_path / "deep/out"
    assert write_model(out, "robot", NEW) == out / "robot"
    assert content(out) == in_model(NEW)


def test_bytes_are_utf8_with_the_line_ends_given(tmp_path: Path) -> None:
    write_model(tmp_path, "robot", NEW)
    assert (tmp_path / "robot/robot.py").read_bytes() == b"x = 2\n# \xcf\x86\xc3\xa9\n"


def test_replaces_the_folder_as_a_whole(tmp_path: Path) -> None:
    write_model(tmp_path, "robot", OLD)
    write_model(tmp_path, "robot", NEW)
    assert content(tmp_path) == in_model(NEW)


USERS = {"notes.txt": "mine\n", ".hidden": "mine\n", "sub/robot.py": "mine\n"}


def with_users_files(out: Path) -> Path:
    """A model generated before, with files, folders and a link of the user's among its own."""
    folder = write_model(out, "robot", OLD)
    (folder / "sub/empty").mkdir(parents=True)
    (folder / "link").symlink_to("nowhere")
    for name, text in USERS.items():
        (folder / name).write_text(text)
    return folder


def users_files_stand(folder: Path) -> bool:
    return (folder / "link").is_symlink() and (folder / "sub/empty").is_dir()


@pytest.mark.parametrize("links", [True, False], ids=["links", "no links"])
def test_the_user_s_files_stay(
    links: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = with_users_files(tmp_path)
    (folder / "__pycache__").mkdir()
    (folder / "__pycache__/robot.pyc").write_text("old")
    (folder / "notes.txt").chmod(0o600)
    os.utime(folder / "notes.txt", (1e9, 1e9))

    def refused(*_: object, **__: object) -> None:
        raise OSError(errno.EPERM, "Operation not permitted")

    if not links:
        monkeypatch.setattr(os, "link", refused)
    write_model(tmp_path, "robot", NEW)
    assert content(folder) == NEW | USERS
    assert users_files_stand(folder)
    stat = (folder / "notes.txt").stat()
    assert (stat.st_mtime, stat.st_mode & 0o777, stat.st_nlink) == (1e9, 0o600, 1)


def test_a_folder_in_the_place_of_a_file_is_not_replaced(tmp_path: Path) -> None:
    folder = write_model(tmp_path, "robot", OLD)
    (folder / "robot.c").mkdir()
    (folder / "robot.c/mine.c").write_text("mine\n")
    with pytest.raises(OutputError, match=r"robot/robot\.c is a folder"):
        write_model(tmp_path, "robot", NEW)
    assert content(folder) == OLD | {"robot.c/mine.c": "mine\n"}


def test_other_models_and_files_stay(tmp_path: Path) -> None:
    write_model(tmp_path, "other", OLD)
    (tmp_path / "__init__.py").write_text("mine\n")
    write_model(tmp_path, "robot", NEW)
    assert content(tmp_path / "other") == OLD
    assert (tmp_path / "__init__.py").read_text() == "mine\n"


def test_a_folder_with_other_things_is_not_made_a_package(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    write_model(tmp_path, "robot", NEW)
    assert not (tmp_path / "__init__.py").exists()


# --- what is not ours -----------------------------------------------------------


@pytest.mark.parametrize(
    "found",
    [
        {"notes.txt": "mine"},
        {"robot.py": "import pne_sym\n"},
        {"robot.json": "{}"},
        {"robot.json": '{"generator": "another"}'},
        {"robot.json": '["pne_sym"]'},
        {"robot.json": "\ud800".encode("utf-8", "surrogatepass")},
    ],
)
def test_a_folder_of_someone_else_is_refused(found: dict[str, str | bytes], tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    folder.mkdir()
    for name, text in found.items():
        (folder / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    before = {path: path.read_bytes() for path in folder.iterdir()}
    with pytest.raises(OutputError, match="refusing to replace"):
        write_model(tmp_path, "robot", NEW)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    "found",
    [
        {},
        {"robot.json": MANIFEST},
        {"robot.json": "<<<<<<< HEAD\n", "robot.py": "# Generated by pne_sym 0.1.0\n"},
        {"robot.c": "/* Generated by pne-gen. */\n"},
    ],
)
def test_a_folder_of_ours_is_replaced_also_damaged(found: dict[str, str], tmp_path: Path) -> None:
    folder = tmp_path / "robot"
    folder.mkdir()
    for name, text in found.items():
        (folder / name).write_text(text)
    write_model(tmp_path, "robot", NEW)
    assert content(folder) == NEW


def test_a_symbolic_link_is_not_followed(tmp_path: Path) -> None:
    write_model(tmp_path / "elsewhere", "robot", OLD)
    (tmp_path / "out").mkdir()
    (tmp_path / "out/robot").symlink_to(tmp_path / "elsewhere/robot")
    with pytest.raises(OutputError, match="it is not a folder"):
        write_model(tmp_path / "out", "robot", NEW)
    assert content(tmp_path / "elsewhere") == in_model(OLD)


@pytest.mark.parametrize(
    "name",
    [
        "",
        ".",
        "..",
        "../robot",
        "a/b",
        "a\\b",
        "/robot",
        "a.b",
        "-a",
        "_a",
        "a\n",
        "a" * 65,
        "\u03c6",
    ],
)
def test_a_model_name_cannot_lead_out(name: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not a model name"):
        write_model(tmp_path / "out", name, NEW)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "name",
    [
        *(
            "",
            ".",
            "..",
            "../x.py",
            "/etc/x",
            ".hidden",
            "a\\b",
            "a\x00b",
            "a/../x.py",
            "a/..",
            "a/",
        ),
        *("a//b.py", "./b.py", "a/./b.py", "a/.git/b", "+/b.py", "+../b.py", "++a/b.py", "-a/b.py"),
        *("a/b\\c.py", "a\n/b.py", "a/+b.py", "1/2/3/4/5/b.py", "a/" + 101 * "b", "\u03c6/b.py"),
    ],
)
def test_a_file_name_cannot_lead_out(name: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not a file name"):
        write_model(tmp_path / "out", "robot", {name: ""})
    assert list(tmp_path.iterdir()) == []


# --- output paths -----------------------------------------------------------------


@pytest.mark.parametrize("use", [check_output, lambda out: write_model(out, "robot", NEW)])
@pytest.mark.parametrize("where", ["file", "file/below", "broken", "broken/below", "x" * 300])
def test_an_unusable_output_path_is_one_line(
    use: Callable[[Path], object], where: str, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "broken").symlink_to(tmp_path / "nowhere" / "at all")
    with pytest.raises(OutputError) as refused:
        use(tmp_path / where)
    assert re.fullmatch(r"cannot write .+: .+", str(refused.value))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["broken", "file"]


def test_a_usable_output_path_is_left_alone(tmp_path: Path) -> None:
    check_output(tmp_path)
    check_output(tmp_path / "not/yet")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", ["pne-old", "pne-tmp"])
def test_what_stands_in_the_way_is_named(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder left over from an earlier run that cannot be removed."""
    write_model(tmp_path, "robot", OLD)
    left_over = tmp_path / f".robot.{suffix}"
    left_over.mkdir()
    (left_over / "file").write_text("")
    with monkeypatch.context() as patch:
        patch.setattr(writer.shutil, "rmtree", lambda *_, **__: None)
        with pytest.raises(OutputError) as refused:
            write_model(tmp_path, "robot", NEW)
    assert f"{left_over}, left over from an earlier run, cannot be removed" in str(refused.value)
    assert content(tmp_path / "robot") == OLD
    write_model(tmp_path, "robot", NEW)
    assert content(tmp_path) == in_model(NEW)


def test_read_only_folders_are_removed_too(tmp_path: Path) -> None:
    folder = with_users_files(tmp_path)
    (folder / "sub").chmod(0o500)
    write_model(tmp_path, "robot", NEW)
    assert (folder / "sub").stat().st_mode & 0o777 == 0o500
    assert sorted(path.name for path in tmp_path.iterdir()) == ["__init__.py", "robot"]


# --- failures and interruptions at every step ---------------------------------------


@pytest.fixture(params=["one step", "two renames"])
def swap(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder is put in its place in either way."""
    if request.param == "two renames":
        monkeypatch.setattr(writer, "exchange", lambda *_: False)


class Saboteur:
    """Lets the n-th step that changes the disk fail, before or after it is done."""

    def __init__(
        self, patch: pytest.MonkeyPatch, at: int, error: BaseException, *, after: bool
    ) -> None:
        self.steps = 0
        self._at, self._error, self._after = at, error, after
        for owner, name in (
            (Path, "mkdir"),
            (Path, "open"),
            (os, "fsync"),
            (Path, "rename"),
            (writer, "exchange"),
            (os, "link"),
            (writer.shutil, "rmtree"),
        ):
            patch.setattr(owner, name, self._guarded(getattr(owner, name)))

    def _guarded(self, step: Callable[..., object]) -> Callable[..., object]:
        def guarded(*args: object, **kwargs: object) -> object:
            self.steps += 1
            if self.steps != self._at:
                return step(*args, **kwargs)
            if self._after:
                result = step(*args, **kwargs)
                if isinstance(result, io.IOBase):
                    result.close()
            raise self._error

        return guarded


def sabotage(
    tmp_path: Path, at: int, error: BaseException, *, after: bool, files: dict[str, str] = NEW
) -> bool:
    """Write with the n-th step failing; return whether there is such a step."""
    with pytest.MonkeyPatch.context() as patch:
        saboteur = Saboteur(patch, at, error, after=after)
        with contextlib.suppress(OutputError, KeyboardInterrupt):
            write_model(tmp_path, "robot", files)
        return saboteur.steps >= at


ERRORS = [KeyboardInterrupt(), OSError(errno.ENOSPC, "No space left on device")]


@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("error", ERRORS, ids=["interrupted", "disk full"])
def test_whatever_step_fails_a_whole_folder_is_there(
    swap: None, error: BaseException, after: bool, tmp_path: Path
) -> None:
    for at in range(1, 100):
        out = tmp_path / str(at)
        write_model(out, "robot", OLD)
        there_was_such_a_step = sabotage(out, at, error, after=after)
        found = content(out / "robot")
        assert found in (OLD, NEW), f"step {at}"
        # A further run cleans up, also where the failing step was a clean-up itself.
        write_model(out, "robot", OLD)
        assert content(out) == in_model(OLD), f"step {at}"
        if not there_was_such_a_step:
            assert found == NEW
            assert at > 15
            return
    pytest.fail("no end of steps")


@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("error", ERRORS, ids=["interrupted", "disk full"])
def test_whatever_step_fails_the_user_s_files_are_there(
    swap: None, error: BaseException, after: bool, tmp_path: Path
) -> None:
    for at in range(1, 100):
        out = tmp_path / str(at)
        folder = with_users_files(out)
        there_was_such_a_step = sabotage(out, at, error, after=after)
        assert content(folder) in (OLD | USERS, NEW | USERS), f"step {at}"
        assert users_files_stand(folder), f"step {at}"
        write_model(out, "robot", NEW)
        assert content(folder) == NEW | USERS, f"step {at}"
        if not there_was_such_a_step:
            return
    pytest.fail("no end of steps")


@pytest.mark.parametrize("error", ERRORS, ids=["interrupted", "disk full"])
def test_what_fails_before_the_swap_leaves_no_trace(
    swap: None, error: BaseException, tmp_path: Path
) -> None:
    write_model(tmp_path, "robot", OLD)
    before = content(tmp_path)
    steps = 3 * len(NEW)  # creating the folder, then opening and forcing each file
    for at in range(4, steps):
        assert sabotage(tmp_path, at, error, after=False)
        assert content(tmp_path) == before, f"step {at}"
        assert sorted(path.name for path in tmp_path.iterdir()) == ["__init__.py", "robot"]


CRASHING = """
import os, sys
from pathlib import Path
from pne_sym import writer

at, out = int(sys.argv[1]), Path(sys.argv[2])
steps = 0

def crash(frame, event, arg):
    global steps
    if event == "line" and frame.f_code.co_filename == writer.__file__:
        steps += 1
        if steps == at:
            os._exit(9)
    return crash

sys.settrace(crash)
writer.write_model(out, "robot", {files})
""".replace("{files}", repr(NEW))


@pytest.mark.slow
def test_after_a_crash_at_any_line_a_further_run_finds_a_whole_folder(tmp_path: Path) -> None:
    """The process ends at once, as by a power cut, at every third line of the writer."""
    for at in range(1, 1000, 3):
        out = tmp_path / str(at)
        write_model(out, "robot", OLD)
        crashed = subprocess.run([sys.executable, "-c", CRASHING, str(at), out], check=False)
        place = writer._Place(out / "robot")
        place.settle()
        assert content(out) in (in_model(OLD), in_model(NEW)), f"line {at}"
        if crashed.returncode == 0:
            assert at > 60
            return
        assert crashed.returncode == 9
    pytest.fail("no end of lines")


def test_two_processes_at_once_leave_one_whole_folder(tmp_path: Path) -> None:
    script = (
        "import sys; from pathlib import Path; from pne_sym.writer import write_model\n"
        "for _ in range(40): write_model(Path(sys.argv[1]), 'robot', "
        "{'robot.py': sys.argv[2], 'robot.json': " + repr(MANIFEST) + "})"
    )
    processes = [
        subprocess.Popen([sys.executable, "-c", script, tmp_path, text]) for text in ("a\n", "b\n")
    ]
    assert [process.wait() for process in processes] == [0, 0]
    found = content(tmp_path)
    assert found.pop("robot/robot.py") in ("a\n", "b\n")
    assert found == {"__init__.py": writer._PACKAGE_INIT, "robot/robot.json": MANIFEST}


# --- folders in the folder, and files that are known by their signature ------------------

SIGNED = "% Generated by pne_sym\n"
DEEP = NEW | {
    "octave/README.txt": SIGNED,
    "octave/+robot/M.m": SIGNED + "new\n",
    "octave/+robot/H.m": SIGNED,
}
OLD_DEEP = OLD | {
    "octave/+robot/M.m": SIGNED + "old\n",
    "octave/+robot/gone.m": SIGNED,
    "robot_mat.m": "stale, known by its name\n",
    "robot.json": '{"generator": {"name": "pne_sym"}, "targets": ["mat"]}\n',
}


@pytest.fixture
def mat(monkeypatch: pytest.MonkeyPatch) -> None:
    """A target with a folder in the folder."""
    files = ("{name}_mat.m", "octave/+{name}/*.m", "octave/README.txt")
    monkeypatch.setattr(registry, "TARGETS", (*registry.TARGETS, Target("mat", "", "", files)))


def put(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def test_folders_are_made_and_stale_files_in_them_removed(mat: None, tmp_path: Path) -> None:
    folder = write_model(tmp_path, "robot", OLD_DEEP)
    assert content(folder) == OLD_DEEP
    write_model(tmp_path, "robot", DEEP)
    assert content(folder) == DEEP
    write_model(tmp_path, "robot", NEW)
    assert content(folder) == NEW
    assert not (folder / "octave").exists()


def test_the_user_s_files_in_folders_of_ours_stay(mat: None, tmp_path: Path) -> None:
    folder = write_model(tmp_path, "robot", OLD_DEEP)
    mine = {"octave/+robot/mine.m": "mine\n", "octave/mine/robot.py": "mine\n"}
    put(folder, mine)
    (folder / "octave/empty").mkdir()
    (folder / "octave/link").symlink_to("nowhere")
    (folder / "octave/+robot").chmod(0o700)
    for files in (DEEP, NEW, DEEP):
        write_model(tmp_path, "robot", files)
        assert content(folder) == files | mine
        assert (folder / "octave/empty").is_dir()
        assert (folder / "octave/link").is_symlink()
        assert (folder / "octave/+robot").stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("name", ["octave/+robot/M.m", "octave/README.txt"])
def test_what_is_not_signed_is_not_replaced(name: str, mat: None, tmp_path: Path) -> None:
    folder = write_model(tmp_path, "robot", OLD)
    put(folder, {name: "mine\n"})
    with pytest.raises(OutputError, match=rf"refusing to replace .*{re.escape(name)}: pne-gen did"):
        write_model(tmp_path, "robot", DEEP)
    assert content(folder) == OLD | {name: "mine\n"}
    write_model(tmp_path, "robot", NEW)
    assert content(folder) == NEW | {name: "mine\n"}


def test_what_the_manifest_tells_of_is_replaced_also_damaged(mat: None, tmp_path: Path) -> None:
    folder = write_model(tmp_path, "robot", OLD_DEEP)
    put(folder, {"octave/+robot/M.m": "<<<<<<< HEAD\n"})
    write_model(tmp_path, "robot", DEEP)
    assert content(folder) == DEEP


def test_signed_files_are_ours_also_without_a_manifest(mat: None, tmp_path: Path) -> None:
    folder = write_model(tmp_path, "robot", DEEP)
    put(folder, {"robot.json": "<<<<<<< HEAD\n", "robot.py": SIGNED, "robot_mat.m": "mine\n"})
    write_model(tmp_path, "robot", NEW)
    assert content(folder) == NEW | {"robot_mat.m": "mine\n"}


@pytest.mark.parametrize("place", ["octave", "octave/+robot"])
@pytest.mark.parametrize("thing", ["link", "broken link", "file"])
def test_what_stands_in_the_place_of_a_folder(
    thing: str, place: str, mat: None, tmp_path: Path
) -> None:
    """A link is not followed: what it leads to is not ours, whoever wrote it."""
    folder, elsewhere = write_model(tmp_path / "out", "robot", OLD), tmp_path / "elsewhere"
    put(elsewhere, {"M.m": SIGNED, "+robot/M.m": SIGNED, "README.txt": SIGNED})
    before = content(elsewhere)
    (folder / place).parent.mkdir(exist_ok=True)
    if thing == "file":
        (folder / place).write_text(SIGNED)
    else:
        (folder / place).symlink_to(elsewhere if thing == "link" else "nowhere")
    with pytest.raises(OutputError, match=rf"{re.escape(place)} is no folder; remove or rename"):
        write_model(tmp_path / "out", "robot", DEEP)
    write_model(tmp_path / "out", "robot", NEW)
    assert (folder / place).is_symlink() == (thing != "file")
    assert (folder / place).is_file() == (thing == "file")
    assert content(elsewhere) == before


def test_a_file_cannot_be_a_folder_too(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="not a file name"):
        write_model(tmp_path, "robot", {"a": "", "a/b": ""})
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("error", ERRORS, ids=["interrupted", "disk full"])
def test_whatever_step_fails_folders_in_the_folder_are_whole(
    mat: None, swap: None, error: BaseException, after: bool, tmp_path: Path
) -> None:
    mine = {"octave/+robot/mine.m": "mine\n"}
    for at in range(1, 100):
        out = tmp_path / str(at)
        folder = write_model(out, "robot", OLD_DEEP)
        put(folder, mine)
        there_was_such_a_step = sabotage(out, at, error, after=after, files=DEEP)
        assert content(folder) in (OLD_DEEP | mine, DEEP | mine), f"step {at}"
        write_model(out, "robot", DEEP)
        assert content(folder) == DEEP | mine, f"step {at}"
        if not there_was_such_a_step:
            assert at > 25
            return
    pytest.fail("no end of steps")
