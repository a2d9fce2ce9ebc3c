"""Fuzz target: `pne-gen` on broken specifications, through its own entry point, by the thousand.

    python tests/fuzz/fuzz.py --cases 100000 --seed 0

Every case ends with exit code 0, or with 2, one line on standard error and no file; in time, and
without a traceback.  What is accepted reads back the same from its full form and is valid by the
published schema.  The compiler is replaced by one that writes a line; `--derive N` derives every
Nth accepted manipulator too.  A case is made from seed and number alone: `--first K --cases 1`
repeats one.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import multiprocessing
import os
import signal
import sys
import tempfile
import time
import tomllib
import traceback
import types
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jsonschema

ROOT = Path(__file__).parents[2]
if str(ROOT) not in sys.path:
    sys.path.insert(0, str(ROOT))

from pne_sym.cli import main as pne_gen_main  # noqa: E402
from pne_sym.model.errors import SpecError  # noqa: E402
from pne_sym.model.reader import from_mapping, from_text, to_full_form  # noqa: E402
from pne_sym.model.schema import json_schema  # noqa: E402
from tests.fuzz.mutate import make_case  # noqa: E402

SECONDS = 20
CHUNK = 250
VALIDATOR = jsonschema.Draft202012Validator(json_schema())


class HangError(BaseException):
    """A case took longer than `SECONDS`."""


@dataclass(frozen=True)
class Tally:
    """What came of some cases.

    Attributes:
        accepted, refused: how many.
        slowest: s.
        failures: case number and what was wrong with it.
    """

    accepted: int
    refused: int
    slowest: float
    failures: tuple[tuple[int, str], ...]


def run_cases(seed: int, first: int, count: int, derive_every: int = 0) -> Tally:
    """Run some cases in this process."""
    accepted = refused = 0
    slowest, failures = 0.0, []
    with tempfile.TemporaryDirectory() as folder, stub_compiler():
        for index in range(first, first + count):
            begin = time.perf_counter()
            content, suffix = make_case(seed, index)
            try:
                with limited(SECONDS), tempfile.TemporaryDirectory(dir=folder) as own:
                    fine = check_case(Path(own), content, suffix)
                    if fine and derive_every and index % derive_every == 0:
                        check_derivation(content, suffix)
            except (Exception, HangError):  # noqa: BLE001 - told with the case
                failures.append((index, traceback.format_exc(limit=-3)))
                continue
            slowest = max(slowest, time.perf_counter() - begin)
            accepted, refused = accepted + fine, refused + (not fine)
    return Tally(accepted, refused, slowest, tuple(failures))


def check_case(folder: Path, content: bytes, suffix: str) -> bool:
    """Give one specification to the program; return whether it is accepted."""
    path, out = folder / f"case{suffix}", folder / "out"
    path.write_bytes(content)
    code, said, told = pne_gen(str(path), "--out", str(out), "--quiet")
    assert said == "", f"said {said!r}"
    assert "Traceback" not in told
    assert all(c.isprintable() or c == "\n" for c in told), f"told {told!r}"
    files = sorted(str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file())
    if code == 2:
        errors = [line for line in told.splitlines() if not line.startswith("pne-gen: warning: ")]
        assert len(errors) == 1, f"told {told!r}"
        assert errors[0].startswith(f"pne-gen: error: {path}: "), f"told {told!r}"
        assert files == [path.name], f"left {files}"
        assert not out.exists(), "left the output folder"
        return False
    assert code == 0, f"exit code {code}: {told}"
    check_accepted(content, suffix)
    assert all(file == path.name or file.startswith("out/") for file in files), f"wrote {files}"
    return True


def check_accepted(content: bytes, suffix: str) -> None:
    """What is accepted is the same from its full form, and valid by the schema."""
    text = content.decode("utf-8-sig")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        manipulator = from_text(text, suffix, "fuzz")
        full = to_full_form(manipulator)
        assert from_mapping(full, "again") == manipulator, "its full form reads differently"
    data = json.loads(text) if suffix == ".json" else tomllib.loads(text)
    for form in (without_nulls(data), full):
        for error in VALIDATOR.iter_errors(form):
            raise AssertionError(f"the schema refuses {error.json_path}: {error.message[:200]}")


def check_derivation(content: bytes, suffix: str) -> None:
    """The derivation of an accepted manipulator is made or refused."""
    from pne_sym.mechanics.derive import derive  # noqa: PLC0415 - brings SymPy

    with warnings.catch_warnings(), contextlib.suppress(SpecError):
        warnings.simplefilter("ignore")
        derive(from_text(content.decode("utf-8-sig"), suffix, "fuzz"))


def without_nulls(value: Any) -> Any:
    """JSON null counts as left out; a schema has no word for that."""
    if isinstance(value, dict):
        return {key: without_nulls(item) for key, item in value.items() if item is not None}
    return [without_nulls(item) for item in value] if isinstance(value, list) else value


def pne_gen(*arguments: str) -> tuple[int, str, str]:
    """Run the program's entry point here; return exit code, output, errors."""
    said, told = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(told):
        try:
            pne_gen_main(arguments)
        except SystemExit as leaving:
            code = leaving.code if isinstance(leaving.code, int) else 0
    return code, said.getvalue(), told.getvalue()


@contextlib.contextmanager
def stub_compiler() -> Iterator[None]:
    """A compiler that writes a line, so that the front of the program is what is tested."""
    stub = types.ModuleType("pne_sym.pipeline")
    stub.compile_model = lambda model, _: {f"{model.name}.py": "x = 1\n"}  # type: ignore[attr-defined]
    before = sys.modules.get("pne_sym.pipeline")
    sys.modules["pne_sym.pipeline"] = stub
    try:
        yield
    finally:
        del sys.modules["pne_sym.pipeline"]
        if before is not None:
            sys.modules["pne_sym.pipeline"] = before


@contextlib.contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise `HangError` in what takes longer, in time of the processor: others do not count."""

    def stop(*_: object) -> None:
        raise HangError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def main() -> int:
    """Run all cases over all cores; 1 where one failed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--cases", type=int, default=100_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--derive", type=int, default=0, metavar="N")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    wanted = parser.parse_args()
    begin = time.perf_counter()
    starts = range(wanted.first, wanted.first + wanted.cases, CHUNK)
    last = wanted.first + wanted.cases
    todo = [(wanted.seed, k, min(CHUNK, last - k), wanted.derive) for k in starts]
    tallies = []
    with multiprocessing.get_context("spawn").Pool(wanted.jobs) as pool:
        for done, tally in enumerate(pool.imap_unordered(_run, todo), 1):
            tallies.append(tally)
            for index, what in tally.failures:
                print(f"case {index} of seed {wanted.seed} failed:\n{what}", flush=True)
            if sys.stdout.isatty():
                print(f"\r{done * CHUNK} cases", end="", flush=True)
    failed = sum(len(tally.failures) for tally in tallies)
    print(
        f"fuzz: {wanted.cases} cases, seed {wanted.seed}: "
        f"{sum(tally.refused for tally in tallies)} refused, "
        f"{sum(tally.accepted for tally in tallies)} accepted, {failed} failed; "
        f"slowest {max(tally.slowest for tally in tallies):.2f} s, "
        f"in all {time.perf_counter() - begin:.0f} s"
    )
    return 1 if failed else 0


def _run(arguments: tuple[int, int, int, int]) -> Tally:
    return run_cases(*arguments)


if __name__ == "__main__":
    sys.exit(main())
