"""The commands of `pne-gen`."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from pne_sym import comparison, writer
from pne_sym.backends import registry
from pne_sym.cli import drawing, homes, listing, review, starter
from pne_sym.cli.arguments import COMMANDS, GENERATE
from pne_sym.cli.console import Report
from pne_sym.cli.faults import DIFFERENT, told
from pne_sym.cli.options import Decorator, debug_flag, flag, valued
from pne_sym.version import __version__

if TYPE_CHECKING:
    from pne_sym.model.manipulator import Manipulator

# The compiler is imported inside the commands: it brings SymPy, which
# `--help`, `--version` and a mistyped option need not wait for.


def _folder(_context: click.Context, _option: click.Parameter, name: str) -> Path:
    """The path of an option; an empty one, as of a variable not set, is not the working folder."""
    if name == "":
        raise click.BadParameter("the name of the folder is empty; . is the working folder")
    return Path(name)


TARGETS = (
    "What code to write, names with commas between: "
    + "; ".join(f"{t.name}: {t.title}" for t in registry.TARGETS if not t.always)
    + ". Derivation and manifest are always written."
)
DEFAULT_TARGETS = ",".join(registry.default())
ALL_CORES = os.cpu_count() or 1

out_option = valued(
    "--out -o DIR",
    "Folder in which each model gets a folder of its own.",
    callback=_folder,
    default="generated",
    show_default=True,
)
target_option = valued("--target NAMES", TARGETS, default=DEFAULT_TARGETS, show_default=True)
quiet_flag = flag("--quiet -q", "Tell only errors, warnings and differences.")


def jobs_option(default: int) -> Decorator:
    """How many models are worked on at once."""
    says, least = "Models worked on at the same time.", click.IntRange(1)
    return valued("--jobs -j N", says, type=least, default=default, show_default=True)


class _ModelsCommand(click.Command):
    """The command whose name is its argument: the usage line has it once."""

    def collect_usage_pieces(self, *_: object) -> list[str]:
        return ["[OPTIONS]"]


class _Program(click.Group):
    """Lists its commands in the order in which they are defined."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.commands)


def _version(context: click.Context, _option: click.Parameter, wanted: bool) -> None:
    if wanted:
        with told(debug=False):
            Report().line(f"pne-gen {__version__}")
        context.exit()


EXAMPLES = """
\b
Examples:
  pne-gen stewart --out generated/         a model of the catalogue
  pne-gen new my_robot.toml --legs 6-UPS   a first specification, to be edited
  pne-gen my_robot.toml --out generated/   a manipulator of your own
  pne-gen all --out generated/ --jobs 4    the whole catalogue
  pne-gen stewart --target numpy,c,xp      other code too
  pne-gen check stewart --out generated/   is what stands there up to date?
  pne-gen list                             what the catalogue has
  pne-gen home my_robot.toml               closures of the legs at home, all of them
  pne-gen draw stewart --out stewart.svg   a picture of it; --pose, --path
  pne-gen explain stewart ups-root_1       an equation: law, uses, users, code
  pne-gen diff HEAD:my_robot.toml my_robot.toml   what a change means

\b
Exit codes:
  0 done, 1 check or diff found a difference, 2 the input is at fault,
  3 internal error, 130 interrupted, 141 the reader of a pipe left
"""


@click.group(
    cls=_Program,
    epilog=EXAMPLES,
    context_settings={"help_option_names": ["-h", "--help"]},
    subcommand_metavar="NAME_OR_SPEC... | COMMAND [ARGUMENTS]",
)
@click.option(
    "--version",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_version,
    help="Show the version and leave.",
)
def app() -> None:
    """Closed-form dynamics of parallel manipulators.

    From a data file: a readable derivation, and NumPy and C code that stand alone.
    """


@app.command(GENERATE, cls=_ModelsCommand)
@click.argument(
    "sources",
    metavar="NAME_OR_SPEC...",
    nargs=-1,
    required=True,
    help="Names in the catalogue (see pne-gen list) or spec files (.toml, .json).",
)
@out_option
@target_option
@quiet_flag
@debug_flag
def generate(sources: tuple[str, ...], out: Path, target: str, quiet: bool, debug: bool) -> None:
    """Generate models.

    DIR/NAME/ gets the derivation (NAME.md), the NumPy code (NAME.py), the C code
    (NAME.h, NAME.c) and a manifest (NAME.json), or other code (--target). What was
    generated there before, of other targets too, is replaced as a whole; other files in
    the folder stay.
    """
    with told(debug=debug):
        _generate(sources, out, target, jobs=1, quiet=quiet)


@app.command("all")
@out_option
@target_option
@jobs_option(ALL_CORES)
@quiet_flag
@debug_flag
def generate_all(out: Path, target: str, jobs: int, quiet: bool, debug: bool) -> None:
    """Generate the whole catalogue."""
    with told(debug=debug):
        _generate(_catalogue(), out, target, jobs=jobs, quiet=quiet)


@app.command("list")
@debug_flag
def list_models(debug: bool) -> None:
    """List the catalogue.

    Degrees of freedom at home, actuated joints by kind (P prismatic, R revolute, H
    helical), and the legs: count, joints from the base, platform joint. When piped, a line
    is name, title, degrees of freedom, actuators, legs, with tabs between.
    """
    with told(debug=debug):
        rows = [listing.row(model) for model in _find(_catalogue())]
        lines = listing.aligned(rows) if sys.stdout.isatty() else listing.tabbed(rows)
        for line in lines:
            Report().line(line)


@app.command("check")
@click.argument(
    "sources",
    metavar="[NAME_OR_SPEC]...",
    nargs=-1,
    help="Default: every model that stands in DIR, if the catalogue has them all; "
    "models of your own are named by their spec files. all: the whole catalogue.",
)
@out_option
@valued(
    "--target NAMES",
    "What code should stand there, as for generating. "
    "Default: what each folder was generated with, as its manifest says.",
)
@jobs_option(1)
@quiet_flag
@debug_flag
def check(
    sources: tuple[str, ...], out: Path, target: str | None, jobs: int, quiet: bool, debug: bool
) -> None:
    """Tell what in DIR is not up to date.

    Compares with what would be generated and writes nothing. Exit code 0: up to date.
    1: it differs; the differences are shown, and the command that mends them.
    """
    with told(debug=debug):
        names = None if target is None else registry.chosen(target)
        report = Report(quiet=quiet)
        if not _check(_wanted(sources, out), out, names, jobs=jobs, report=report):
            raise Exit(DIFFERENT)


for command in (starter.new, homes.home, review.explain, review.diff, drawing.draw):
    app.add_command(command)


def _catalogue() -> tuple[str, ...]:
    from pne_sym import manipulators

    return manipulators.names()


def _check_command(word: str) -> None:
    """Refuse what is no model and looks like a command that was mistyped."""
    from pne_sym.generation import InputError
    from pne_sym.model.entry import near
    from pne_sym.model.errors import show

    if word in _catalogue() or "." in word or "/" in word:
        return
    if command := near(word, COMMANDS, 1, likeness=0.7):
        raise InputError(
            f"no command or manipulator {show(word)}; did you mean pne-gen {command[0]}?"
        )


def _wanted(sources: Sequence[str], out: Path) -> Sequence[str]:
    """What `check` compares: what is named, or what stands there."""
    from pne_sym.generation import InputError

    if "all" in sources:
        return _catalogue()
    if sources:
        return tuple(dict.fromkeys(sources))
    found = comparison.models_in(out)
    if not found:
        raise InputError(f"no generated model stands in {out}; name what should")
    if unknown := sorted(set(found) - set(_catalogue())):
        raise InputError(
            f"{out / unknown[0]} is of no model in the catalogue; name its spec file, "
            "and the other models to check"
        )
    return found


def _find(sources: Sequence[str]) -> list[Manipulator]:
    """Read every source before any work, so that a fault in the last costs nothing."""
    from pne_sym.generation import InputError, find

    found: dict[str, str] = {}
    models = []
    for source in dict.fromkeys(sources):
        model = find(source)
        if model.name in found:
            raise InputError(f"{found[model.name]} and {source} are both named {model.name!r}")
        found[model.name] = source
        models.append(model)
    return models


def _generate(sources: Sequence[str], out: Path, target: str, *, jobs: int, quiet: bool) -> None:
    """Generate models, once nothing is left that can be refused before the work."""
    from pne_sym.generation import compile_many, remarks

    targets, report = registry.chosen(target), Report(quiet=quiet)
    writer.check_output(out)
    _check_command(sources[0])
    models = _find(sources)
    with report.progress(len(models)) as step:
        compiling = compile_many(models, jobs, {model.name: targets for model in models})
        for model in models:
            step.working_on(model.name)
            compiled = next(compiling)
            said = remarks(compiled)
            folder = writer.write_model(out, compiled.manipulator.name, compiled.files)
            size = sum(len(text.encode()) for text in compiled.files.values())
            report.line(f"wrote {folder}: {len(compiled.files)} files, {size / 1000:.0f} kB")
            for line in said:
                report.line(f"  {line}")
            step.done()


def _check(
    sources: Sequence[str], out: Path, targets: tuple[str, ...] | None, *, jobs: int, report: Report
) -> bool:
    """Report every difference; return whether there is none."""
    from pne_sym.generation import compile_many, targets_of

    models = _find(sources)
    differing = {}
    wanted = {m.name: targets_of(out / m.name) if targets is None else targets for m in models}
    with report.progress(len(models)) as step:
        compiling = compile_many(models, jobs, wanted)
        for source, model in zip(sources, models, strict=True):
            step.working_on(model.name)
            compiled, name = next(compiling), model.name
            differences = comparison.check_model(out, name, compiled.files)
            for difference in differences:
                report.difference(f"{difference.kind}: {out / difference.path}")
                for line in difference.diff.split("\n")[:-1]:
                    report.difference(line)
            if differences:
                differing[source] = wanted[name]
            else:
                report.line(f"up to date: {out / name}")
            step.done()
    for names in dict.fromkeys(differing.values()):
        report.difference(f"to mend it: {_mending(differing, names, out)}")
    return not differing


def _mending(differing: Mapping[str, tuple[str, ...]], names: tuple[str, ...], out: Path) -> str:
    """The command that generates anew what differs, of the sources with these targets."""
    sources = [source for source, its in differing.items() if its == names]
    options = ["--target", ",".join(names)] if names != registry.default() else []
    return shlex.join(["pne-gen", *sources, "--out", str(out), *options])
