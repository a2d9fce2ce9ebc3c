"""The commands of `pne-gen` for review: explain and diff."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import click
from click.exceptions import Exit

from pne_sym.backends import registry
from pne_sym.cli.console import Report
from pne_sym.cli.faults import DIFFERENT, told
from pne_sym.cli.options import debug_flag, flag, source_argument, valued

if TYPE_CHECKING:
    from pne_sym.review.collection import Options
    from pne_sym.review.difference import Comparison
    from pne_sym.review.sources import Source


@click.command
@source_argument
@click.argument(
    "equation",
    metavar="[EQUATION]",
    required=False,
    help="Its id, such as ups-root_1, or the name it defines. Default: list all.",
)
@valued(
    "--stage STAGE",
    "spec: the specification's full form (JSON). derivation: the equation. "
    f"{', '.join(registry.stages()[2:])}: its statements. "
    "Default: the equation and the program's.",
)
@flag("--all -a transitively", "Follow what it uses and what uses it to the end.")
@debug_flag
def explain(
    source: str, equation: str | None, stage: str | None, transitively: bool, debug: bool
) -> None:
    """Explain an equation of a derivation.

    What it says, by which law, from which equations, which ones use it, and its
    statements in the code. Without EQUATION: the chapters and their equations.
    """
    with told(debug=debug):
        from pne_sym.generation import InputError, find

        if stage is not None:
            registry.check_stage(stage)
        manipulator, report = find(source), Report()
        if stage == "spec":
            from pne_sym.review.explain_text import spec_text

            if equation is not None:
                raise InputError("--stage spec shows the whole specification; leave EQUATION out")
            report.line(spec_text(manipulator))
            return
        from pne_sym.pipeline import compile_bundle
        from pne_sym.review.explain import UnknownEquationError
        from pne_sym.review.explain_text import stage_lines

        bundle = compile_bundle(manipulator)
        try:
            for line in stage_lines(bundle, stage, equation, transitively=transitively):
                report.line(line)
        except UnknownEquationError as error:
            raise InputError(str(error)) from error


_VERSION = (
    "A name in the catalogue, a spec file, a generated folder, or REVISION:PATH of one in git, "
    "such as HEAD~1:robots/my_robot.toml or main:generated/stewart."
)


@click.command
@click.argument("before", metavar="A", help=_VERSION)
@click.argument("after", metavar="B", help="Likewise.")
@flag("--json as_json", "Answer in JSON.")
@flag("--markdown as_markdown", "Answer in Markdown, for a pull request.")
@valued(
    "--tolerance NUMBER",
    "Relative; values nearer than this are equal.",
    type=click.FloatRange(0.0),
    default=1e-9,
    show_default=True,
)
@flag(
    "--run",
    "Execute the Python, and compile and execute the C, of folders: only of those "
    "whose code you would run.",
)
@click.option(
    "--c/--no-c",
    default=True,
    show_default=True,
    help="With --run: compile and execute the C too.",
)
@valued(
    "--as PATH label",
    "What A and B are called: a/PATH, b/PATH; twice where B was renamed. For git, which "
    "names temporary files.",
    multiple=True,
)
@flag("--quiet -q", "Tell only by exit code.")
@debug_flag
def diff(  # noqa: PLR0913, PLR0917 - one option each
    before: str,
    after: str,
    as_json: bool,
    as_markdown: bool,
    tolerance: float,
    run: bool,
    c: bool,
    label: tuple[str, ...],
    quiet: bool,
    debug: bool,
) -> None:
    """Compare two versions of a model by meaning.

    What was done first: the specification, field by field, in words. Then what it means:
    equations new, gone, changed; functions whose values differ at equal parameters; the
    effect on required forces, the least eigenvalue of M, the condition of H. Any two
    models can be compared; legs and joints are matched by name and likeness. Exit code 0:
    interface and values are the same. 1: different, or not all was compared.

    A and B may be folders of models (generated folders, specifications), and /dev/null
    stands for a model that is not there.

    Folders that are equal to the byte are identical. Otherwise each is compared with what
    this pne-gen prints from the specification in its manifest: where that is what stands
    there, our own text is run in its place; where not, the files and lines are told, and
    values are not compared. Nothing of a folder is executed or compiled without --run.
    """
    with told(debug=debug):
        from pne_sym.generation import InputError
        from pne_sym.review.collection import Options
        from pne_sym.review.sources import find_source

        if as_json and as_markdown:
            raise InputError("--json and --markdown exclude each other")
        labels = (f"a/{label[0]}", f"b/{label[-1]}") if label else ("", "")
        sources = find_source(before, labels[0]), find_source(after, labels[1])
        form = "json" if as_json else "markdown" if as_markdown else "text"
        equal, lines = _answer(*sources, Options(tolerance, run, c), form)
        for line in () if quiet else lines:
            Report().difference(line)
        if not equal:
            raise Exit(DIFFERENT)


def _answer(
    before: Source, after: Source, options: Options, form: str
) -> tuple[bool, Iterable[str]]:
    """Whether all is equal, and the lines of the answer."""
    from pne_sym.review import collection, diff_text, markdown

    if before.models is None and after.models is None and not (before.is_none or after.is_none):
        found = collection.compared(before, after, options)
        one: dict[str, Callable[[Comparison], Iterable[str]]] = {
            "json": lambda c: [diff_text.as_json(c)],
            "markdown": markdown.as_markdown,
            "text": diff_text.as_text,
        }
        return found.equal, one[form](found)
    parts = collection.compare_sources(before, after, options)
    if form == "json":
        lines: Iterable[str] = [collection.as_json(before, after, parts)]
    else:
        text = form == "text"
        lines = collection.as_text(before, after, parts) if text else markdown.comment(parts)
    return all(p.is_equal for p in parts), lines
