"""The one Jinja environment: templates hold layout only."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import jinja2

from pne_sym.model.body import RELATIVE
from pne_sym.model.values import LARGEST, ROUNDING, SNAP

LIMITS = {
    "largest": f"{LARGEST:g}",
    "relative": f"{RELATIVE:g}",
    "rounding": f"{ROUNDING:g}",
    "snap": f"{SNAP:g}",
}
"""What the reader of specifications allows, for the checks of parameters at run time."""


def template_folder() -> Path:
    """The templates beside the package (wheel) or at the top of the checkout.

    Raises:
        FileNotFoundError: neither is there.
    """
    package = Path(__file__).resolve().parent.parent
    for folder in (package / "templates", package.parent / "templates"):
        if folder.is_dir():
            return folder
    raise FileNotFoundError("the templates of pne_sym are not installed")


@cache
def environment() -> jinja2.Environment:
    """Strict about undefined names; no autoescape, as no output is HTML."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(template_folder()),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701
    )
    made.globals["limits"] = LIMITS
    return made


def render(template: str, **fields: object) -> str:
    """A template filled with ready strings."""
    return environment().get_template(template).render(**fields)


@cache
def methods(folder: str) -> frozenset[str]:
    """Names of the methods that Python templates of a folder define."""
    texts = (
        path.read_text(encoding="utf-8") for path in template_folder().joinpath(folder).iterdir()
    )
    return frozenset(
        name for t in texts for name in re.findall(r"^    def (\w+)\(self", t, re.MULTILINE)
    )
