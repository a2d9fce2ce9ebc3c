"""Arguments and options that several commands have."""

from __future__ import annotations

from typing import Annotated

import typer

Debug = Annotated[bool, typer.Option("--debug", help="Show the traceback of an internal error.")]

Source = Annotated[
    str,
    typer.Argument(
        metavar="NAME_OR_SPEC", help="A name in the catalogue or a spec file (.toml, .json)."
    ),
]
