"""What `pne-gen` does, as functions: find a manipulator, generate it, check it.

>>> from pne_sym.generation import check, generate
>>> generate("stewart", "generated")  # doctest: +SKIP
PosixPath('generated/stewart')
>>> check("stewart", "generated")  # doctest: +SKIP
[]
"""

from __future__ import annotations

import contextlib
import gc
import json
import os
import signal
import traceback
import warnings
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from pne_sym import comparison, writer
from pne_sym.backends import registry
from pne_sym.backends.target import TargetError
from pne_sym.contents import Contents

if TYPE_CHECKING:
    from multiprocessing.context import BaseContext

    from pne_sym.model.manipulator import Manipulator

# The compiler is imported inside the functions: it brings SymPy, and a name
# that is misspelt should be refused before that. So are processes, which one model needs none of.


class InputError(ValueError):
    """What was asked for cannot be done; the message is one line for people."""


class Compiled(NamedTuple):
    """A manipulator and what is generated for it.

    Attributes:
        manipulator: the manipulator.
        files: path below the model's folder -> text.
    """

    manipulator: Manipulator
    files: dict[str, str]


def find(source: str | os.PathLike[str] | Manipulator) -> Manipulator:
    """Return the manipulator that a name, a spec file or an object stands for.

    A text with a dot or a folder separator is the path of a spec file, any
    other a name in the catalogue; a manipulator built in code stands for itself.

    Raises:
        SpecError: no such model (the message has the nearest names), or the
            spec file or the object is at fault.
    """
    from pne_sym import manipulators
    from pne_sym.model.reader import checked, read_spec

    if not isinstance(source, str | os.PathLike):
        return checked(source)
    if isinstance(source, str) and not any(mark in source for mark in (".", "/", os.sep)):
        return manipulators.load(source)
    return read_spec(Path(source))


def generate(
    source: str | os.PathLike[str] | Manipulator,
    out: str | os.PathLike[str],
    targets: Collection[str] | None = None,
) -> Path:
    """Generate a manipulator's folder below `out`, replacing what was generated as a whole.

    Other files in the folder stay.

    Args:
        source: a name in the catalogue, a spec file or a manipulator.
        out: the output folder.
        targets: what code to write, such as ("numpy", "c", "xp"); by default NumPy and C.

    Returns:
        The model's folder.

    Raises:
        SpecError: the source is at fault.
        TargetError: there is no such target, or it cannot print this model.
        OutputError: the folder cannot be written.
    """
    from pne_sym.mechanics.mobility import check_mobility
    from pne_sym.pipeline import compile_model

    manipulator = find(source)
    check_mobility(manipulator)
    files = compile_model(manipulator, targets)
    return writer.write_model(Path(out), manipulator.name, files)


def check(
    source: str | os.PathLike[str] | Manipulator,
    out: str | os.PathLike[str],
    targets: Collection[str] | None = None,
) -> list[comparison.Difference]:
    """Compare a manipulator's folder below `out` with what would be generated.

    Args:
        source: a name in the catalogue, a spec file or a manipulator.
        out: the output folder.
        targets: what code should stand there; by default what the folder's manifest says.

    Returns:
        The differences; none if the folder is up to date.

    Raises:
        SpecError: the source is at fault.
        TargetError: there is no such target, or it cannot print this model.
        OutputError: the folder cannot be read.
    """
    from pne_sym.pipeline import compile_model

    manipulator = find(source)
    names = targets_of(Path(out) / manipulator.name) if targets is None else targets
    files = compile_model(manipulator, names)
    return comparison.check_model(Path(out), manipulator.name, files)


def targets_of(folder: Path) -> tuple[str, ...]:
    """The targets that a model's folder was generated with; those of default where it is missing.

    Raises:
        TargetError: its manifest names one that this version does not have.
    """
    try:
        return registry.chosen(Contents(folder).targets)
    except TargetError as error:
        raise TargetError(f"{folder}: its manifest names its targets: {error}") from error


def remarks(compiled: Compiled) -> list[str]:
    """What there is to know of a manipulator: its mobility, and legs without a closed form.

    Warns with `SpecWarning` where the actuators do not hold the mechanism.
    """
    from pne_sym.mechanics.mobility import check_mobility

    lines = [str(check_mobility(compiled.manipulator))]
    manifest = json.loads(compiled.files.get(f"{compiled.manipulator.name}.json", "{}"))
    for leg_type in manifest.get("leg_types", []):
        for joint, reason in leg_type.get("no_closed_form", {}).items():
            lines.append(
                f"{leg_type['architecture']} legs: joint {joint} has no closed-form inverse "
                f"kinematics ({reason}); it is found by iteration from q0"
            )
    return lines


def compile_many(
    manipulators: Iterable[Manipulator],
    jobs: int = 1,
    targets: Mapping[str, Collection[str]] | None = None,
) -> Iterator[Compiled]:
    """Compile manipulators, in their order, in up to `jobs` processes at once.

    Args:
        manipulators: what to compile.
        jobs: how many at once.
        targets: of each, by its name; those of default where it is not there.

    Raises:
        SpecError, InputError: a manipulator is outside the method.
        TargetError: there is no such target, or it cannot print a model.
    """
    wanted = targets or {}
    todo = tuple((item, wanted.get(item.name)) for item in manipulators)
    jobs = min(jobs, len(todo))
    if jobs <= 1:
        from pne_sym.pipeline import compile_model

        yield from (Compiled(item, compile_model(item, names)) for item, names in todo)
        return
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    context = _workers()
    pool = ProcessPoolExecutor(
        jobs, mp_context=context, initializer=gc.set_threshold, initargs=gc.get_threshold()
    )
    try:
        with _interrupts_held():  # the first of these starts the workers
            outcomes = [pool.submit(_compile_in_worker, *each) for each in todo]
        for outcome in outcomes:
            yield outcome.result().result()
    except BaseException:
        # Nobody waits for the rest: the workers only compute, they write nothing.  Nothing is
        # cancelled: the pool, told that its workers are gone, fails at what is cancelled already.
        for process in multiprocessing.active_children():
            process.terminate()
        raise
    finally:
        pool.shutdown()


def _workers() -> BaseContext:
    """How workers start: where the system can, from one process that has the compiler."""
    import multiprocessing

    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    backends = {target.backend.partition(":")[0] for target in registry.TARGETS if target.default}
    context.set_forkserver_preload(["pne_sym.pipeline", *sorted(backends)])
    return context


class _Outcome(NamedTuple):
    """What a worker process found, in a form that any error survives."""

    compiled: Compiled | None = None
    warnings: tuple[tuple[str, type[Warning]], ...] = ()
    input_error: str | None = None
    internal_error: str | None = None

    def result(self) -> Compiled:
        for message, category in self.warnings:
            warnings.warn(message, category, stacklevel=2)
        if self.input_error is not None:
            raise InputError(self.input_error)
        if self.compiled is None:
            raise RuntimeError(f"a worker process failed\n{self.internal_error}")
        return self.compiled


def _compile_in_worker(manipulator: Manipulator, targets: Collection[str] | None) -> _Outcome:
    from pne_sym.model.errors import SpecError
    from pne_sym.pipeline import compile_model

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            compiled = Compiled(manipulator, compile_model(manipulator, targets))
        except (SpecError, TargetError) as error:
            return _Outcome(input_error=str(error))
        except Exception:  # noqa: BLE001 - told by the parent
            return _Outcome(internal_error=traceback.format_exc())
    return _Outcome(compiled, tuple((str(each.message), each.category) for each in caught))


@contextlib.contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold back Ctrl-C; processes started meanwhile never get it.

    The terminal sends it to every process.  The parent ends the workers; did
    they get it too, each would end with a traceback of its own.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
