"""The commands of `pne-gen` for review: explain and diff."""

from __future__ import annotations

from typing import Annotated

import typer

from pne_sym.backends import registry
from pne_sym.cli.console import Report
from pne_sym.cli.faults import DIFFERENT, told
from pne_sym.cli.options import Debug, Source


def explain(
    source: Source,
    equation: Annotated[
        str | None,
        typer.Argument(
            metavar="EQUATION",
            show_default=False,
            help="Its id, such as ups-K5, or the name it defines. Default: list all.",
        ),
    ] = None,
    stage: Annotated[
        str | None,
        typer.Option(
            "--stage",
            metavar="STAGE",
            show_default=False,
            help="spec: the specification's full form (JSON). derivation: the equation. "
            f"{', '.join(registry.stages()[2:])}: its statements. "
            "Default: the equation and the program's.",
        ),
    ] = None,
    transitively: Annotated[
        bool,
        typer.Option("--all", "-a", help="Follow what it uses and what uses it to the end."),
    ] = False,
    debug: Debug = False,
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


def diff(  # noqa: PLR0913, PLR0917 - one option each
    before: Annotated[str, typer.Argument(metavar="A", help=_VERSION)],
    after: Annotated[str, typer.Argument(metavar="B", help="Likewise.")],
    as_json: Annotated[bool, typer.Option("--json", help="Answer in JSON.")] = False,
    as_markdown: Annotated[
        bool, typer.Option("--markdown", help="Answer in Markdown, for a pull request.")
    ] = False,
    tolerance: Annotated[
        float,
        typer.Option("--tolerance", min=0.0, help="Relative; values nearer than this are equal."),
    ] = 1e-9,
    run: Annotated[
        bool,
        typer.Option(
            "--run",
            help="Execute the Python, and compile and execute the C, of folders: only of those "
            "whose code you would run.",
        ),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Tell only by exit code.")] = False,
    debug: Debug = False,
) -> None:
    """Compare two versions of a model by meaning.

    Function by function and equation by equation: identical text, different text with
    equal values, or different values, and where first along the derivation; what changed
    in parameters, coordinates and operation counts. Values are compared at random
    parameters and states. Exit code 0: interface and values are the same. 1: different,
    or not all was compared.

    Folders that are equal to the byte are identical. Otherwise each is compared with what
    this pne-gen prints from the specification in its manifest: where that is what stands
    there, our own text is run in its place; where not, the files and lines are told, and
    values are not compared. Nothing of a folder is executed or compiled without --run.
    """
    with told(debug=debug):
        from pne_sym.generation import InputError
        from pne_sym.review import diff_text
        from pne_sym.review.compare import compare
        from pne_sym.review.versions import find_version

        if as_json and as_markdown:
            raise InputError("--json and --markdown exclude each other")
        versions = find_version(before), find_version(after)
        found = compare(*versions, tolerance=tolerance, run=run)
        if as_json:
            lines = iter([diff_text.as_json(found)])
        else:
            lines = diff_text.as_markdown(found) if as_markdown else diff_text.as_text(found)
        for line in () if quiet else lines:
            Report().difference(line)
        if not found.equal:
            raise typer.Exit(DIFFERENT)
