"""The commands of `pne-gen` for review: explain and diff."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from pne_sym.cli.console import Report
from pne_sym.cli.faults import told
from pne_sym.cli.options import Debug


class Stage(StrEnum):
    """How far along the pipeline to look."""

    SPEC = "spec"
    DERIVATION = "derivation"
    PROGRAM = "program"
    C = "c"
    NUMPY = "numpy"


def explain(
    source: Annotated[
        str,
        typer.Argument(
            metavar="NAME_OR_SPEC", help="A name in the catalogue or a spec file (.toml, .json)."
        ),
    ],
    equation: Annotated[
        str | None,
        typer.Argument(
            metavar="EQUATION",
            show_default=False,
            help="Its id, such as ups-K5, or the name it defines. Default: list all.",
        ),
    ] = None,
    stage: Annotated[
        Stage | None,
        typer.Option(
            "--stage",
            show_default=False,
            help="spec: the specification's full form (JSON). derivation: the equation. "
            "program, c, numpy: its statements. Default: the equation and the program's.",
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

        manipulator, report = find(source), Report()
        if stage is Stage.SPEC:
            from pne_sym.review.explain_text import spec_text

            if equation is not None:
                raise InputError("--stage spec shows the whole specification; leave EQUATION out")
            report.line(spec_text(manipulator))
            return
        from pne_sym.pipeline import compile_bundle
        from pne_sym.review.explain import UnknownEquationError
        from pne_sym.review.explain_text import NotGeneratedError, stage_lines

        bundle = compile_bundle(manipulator)
        try:
            for line in stage_lines(bundle, stage, equation, transitively=transitively):
                report.line(line)
        except (UnknownEquationError, NotGeneratedError) as error:
            raise InputError(str(error)) from error
