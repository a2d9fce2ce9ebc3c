"""How an extension module comes to its library: cache, compiler, headers, several processes."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests import models
from tests.backends.c_library import quick_compiler
from tests.backends.ext_module import placed, run

NAME = "planar_3rpr"
USE = "import planar_3rpr_ext as e; print(e.M(e.HOME_X)[0, 0] > 0, e.__name__)"
GOOD = "True planar_3rpr_ext\n"


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty cache, and flags for a quick compilation."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("PNE_SYM_CACHE", str(folder))
    monkeypatch.setenv("PNE_SYM_CFLAGS", "-O0")
    monkeypatch.setenv("CC", quick_compiler())
    return folder


@pytest.fixture
def used(tmp_path: Path) -> Path:
    """A script that uses the module beside it, which stands alone in its folder."""
    folder = tmp_path / "mine"
    folder.mkdir()
    placed(folder, models.catalogue(NAME))
    script = folder / "use.py"
    script.write_text(USE)
    return script


def without_compiler(tmp_path: Path) -> str:
    """A PATH with nothing on it."""
    (tmp_path / "empty").mkdir(exist_ok=True)
    return str(tmp_path / "empty")


def refused(script: Path, **environment: str) -> str:
    """The one line of the ImportError."""
    done = run(script, **environment)
    assert done.returncode == 1
    assert done.stdout == ""
    last = done.stderr.strip().rpartition("ImportError: ")
    assert last[1], done.stderr
    return last[2]


def test_compiled_once_into_the_cache_and_kept_to_oneself(
    cache: Path, used: Path, tmp_path: Path
) -> None:
    assert run(used).stdout == GOOD
    (library,) = cache.iterdir()
    assert re.fullmatch(r"planar_3rpr_ext-[0-9a-f]{16}-[0-9a-f]{16}\.abi3\.so", library.name)
    assert cache.stat().st_mode & 0o777 == 0o700
    before = library.stat().st_mtime_ns
    assert run(used).stdout == GOOD
    assert [path.stat().st_mtime_ns for path in cache.iterdir()] == [before]
    assert run(used, PNE_SYM_CFLAGS="-O1").stdout == GOOD
    assert len(list(cache.iterdir())) == 2
    assert {p.name for p in used.parent.iterdir()} <= {"use.py", f"{NAME}_ext.py", "__pycache__"}


def test_a_changed_text_is_never_served_by_an_older_library(cache: Path, used: Path) -> None:
    assert run(used).stdout == GOOD
    module = used.with_name(f"{NAME}_ext.py")
    text = module.read_text()
    module.write_text(text.replace(f'"{NAME}.c"] = r"""', f'"{NAME}.c"] = r"""\n', 1))
    assert module.read_text() != text
    assert run(used).stdout == GOOD
    assert len(list(cache.iterdir())) == 2


@pytest.mark.parametrize("variable", ["XDG_CACHE_HOME", "HOME"])
def test_the_default_cache_is_the_user_s(
    cache: Path, used: Path, tmp_path: Path, variable: str
) -> None:
    others = {"XDG_CACHE_HOME": "relative", "HOME": str(tmp_path / "nobody")}
    place = tmp_path / "of-user"
    environment = others | {variable: str(place), "PNE_SYM_CACHE": ""}
    assert run(used, **environment).stdout == GOOD
    folder = place / "pne_sym" if variable == "XDG_CACHE_HOME" else place / ".cache" / "pne_sym"
    assert len(list(folder.iterdir())) == 1
    assert folder.stat().st_mode & 0o777 == 0o700


def test_several_processes_at_once(cache: Path, used: Path) -> None:
    processes = [
        subprocess.Popen([sys.executable, str(used)], stdout=subprocess.PIPE, text=True)
        for _ in range(3)
    ]
    assert [p.communicate()[0] for p in processes] == [GOOD] * 3
    assert len(list(cache.iterdir())) == 1


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o1777])
def test_a_cache_that_others_can_write_to_is_refused(cache: Path, used: Path, mode: int) -> None:
    cache.mkdir()
    cache.chmod(mode)
    assert "others can write to it" in refused(used)
    assert list(cache.iterdir()) == []


def test_a_cache_that_cannot_be_is_refused(cache: Path, used: Path) -> None:
    cache.write_text("a file")
    message = refused(used)
    assert message == (
        f"{NAME}_ext: cache folder {cache}: File exists; PNE_SYM_CACHE names another"
    )


def test_without_a_compiler(
    cache: Path, used: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CC")
    message = refused(used, PATH=without_compiler(tmp_path))
    assert message.startswith(f"{NAME}_ext: no C compiler: looked for cc, gcc, clang; name one by")
    message = refused(used, CC="nowhere-cc -m64")
    assert message.startswith(f"{NAME}_ext: no C compiler: CC=nowhere-cc is not found; name one")
    assert f"python {NAME}_ext.py --output FOLDER" in message
    assert list(cache.iterdir()) == []


def test_cc_names_the_compiler_with_its_options(cache: Path, used: Path, tmp_path: Path) -> None:
    compiler, log = shutil.which("gcc") or shutil.which("cc"), tmp_path / "log"
    mine = tmp_path / "my cc"
    mine.write_text(f'#!/bin/sh\necho "$@" >> {log}\nexec {compiler} "$@"\n')
    mine.chmod(0o755)
    assert run(used, CC=f"'{mine}' -DMINE").stdout == GOOD
    assert log.read_text().startswith("-DMINE -std=c11 -O3 ")


def test_a_compiler_that_fails_is_quoted_and_leaves_nothing(cache: Path, used: Path) -> None:
    message = refused(used, PNE_SYM_CFLAGS="-DNO_SUCH -Werror --no-such-option")
    assert "--no-such-option" in message
    assert "failed:" in message
    assert list(cache.iterdir()) == []
    message = refused(used, PNE_SYM_CFLAGS="-O0 -DPLANAR_3RPR_REAL=float")
    assert "the_real_type_must_be_double" in message


def test_without_python_s_headers(cache: Path, used: Path, tmp_path: Path) -> None:
    used.write_text(
        "import sysconfig; path = sysconfig.get_path\n"
        f"sysconfig.get_path = lambda name: {str(tmp_path)!r} if 'incl' in name else path(name)\n"
        f"{USE}"
    )
    message = refused(used)
    assert message.startswith(f"{NAME}_ext: Python.h is not in {tmp_path}: install Python's dev")
    assert list(cache.iterdir()) == []


def test_it_needs_no_package_but_numpy(cache: Path, used: Path) -> None:
    used.write_text(
        "import sys\n"
        "for name in ('cffi', 'setuptools', 'distutils', 'pybind11', 'wheel', 'pip', 'sympy',\n"
        "             'pne_sym', 'scipy', 'jinja2', 'ctypes.util'):\n"
        f"    sys.modules[name] = None\n{USE}"
    )
    assert run(used).stdout == GOOD


def test_compiled_beforehand_for_a_machine_without_a_compiler(
    cache: Path, used: Path, tmp_path: Path
) -> None:
    module = used.with_name(f"{NAME}_ext.py")
    done = run(module, "--output", str(used.parent))
    library = Path(done.stdout.strip())
    assert (done.returncode, done.stderr) == (0, "")
    assert library.parent == used.parent
    assert re.fullmatch(r"planar_3rpr_ext-[0-9a-f]{16}\.abi3\.so", library.name)
    assert not cache.exists()
    assert run(used, PATH=without_compiler(tmp_path)).stdout == GOOD
    assert not cache.exists()
    library.unlink()
    done = run(module)
    assert Path(done.stdout.strip()).parent == cache
    assert run(used).stdout == GOOD
    assert len(list(cache.iterdir())) == 1


def test_what_cannot_be_compiled_beforehand_is_told(
    cache: Path, used: Path, tmp_path: Path
) -> None:
    module = used.with_name(f"{NAME}_ext.py")
    done = run(module, PATH=without_compiler(tmp_path))
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith(f"{NAME}_ext: no C compiler")
    done = run(module, "--output", str(tmp_path / "nowhere"))
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"{NAME}_ext: {tmp_path}/nowhere: No such file or directory\n"
    assert not os.path.lexists(tmp_path / "nowhere")
