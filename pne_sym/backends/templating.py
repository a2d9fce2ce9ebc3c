"""The one Jinja environment: templates hold layout only."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import cache
from importlib.util import cache_from_source
from pathlib import Path
from typing import Any

import jinja2
from jinja2.bccache import Bucket

from pne_sym.model.body import RELATIVE
from pne_sym.model.coupling import LEAST
from pne_sym.model.values import LARGEST, ROUNDING, SNAP
from pne_sym.program import distribution, interpret, iteration, linear
from pne_sym.program.array_operations import TINY
from pne_sym.program.pose_operations import ORTHONORMAL

LIMITS = {
    "largest": f"{LARGEST:g}",
    "relative": f"{RELATIVE:g}",
    "rounding": f"{ROUNDING:g}",
    "snap": f"{SNAP:g}",
    "independent": f"{LEAST:g}",
}
"""What the reader of specifications allows, for the checks of parameters at run time."""
FIXED = {
    "pivot": linear.PIVOT,
    "orthonormal": ORTHONORMAL,
    "tiny": TINY,
    "turns": distribution.TURNS,
    "steps": iteration.STEPS,
    "longest": iteration.LONGEST,
    "steady": iteration.STEADY,
    "search_steps": interpret.SEARCH_STEPS,
    "halvings": interpret.HALVINGS,
    "found": interpret.FOUND,
    "close": interpret.CLOSE,
}
"""What the definitions of operations and iterations fix."""


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


class _Kept(jinja2.FileSystemBytecodeCache):
    """Keeps compiled templates where Python would keep compiled modules, if that can be written."""

    def __init__(self, templates: Path) -> None:
        super().__init__(str(Path(cache_from_source(str(templates / "template"))).parent))

    def load_bytecode(self, bucket: Bucket) -> None:
        """Take one that is kept."""
        with suppress(OSError):
            super().load_bytecode(bucket)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep one; whoever may not write there compiles it again."""
        with suppress(OSError):
            Path(self.directory).mkdir(parents=True, exist_ok=True)
            super().dump_bytecode(bucket)


@cache
def environment() -> jinja2.Environment:
    """Strict about undefined names; no autoescape, as no output is HTML."""
    made = jinja2.Environment(
        loader=jinja2.FileSystemLoader(template_folder()),
        bytecode_cache=None if sys.dont_write_bytecode else _Kept(template_folder()),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,  # noqa: S701
        optimized=False,  # each template is rendered once or twice: no constants worth folding
    )
    made.globals["limits"] = LIMITS
    made.globals["fixed"] = FIXED
    return made


def render(template: str, **fields: object) -> str:
    """A template filled with ready strings."""
    return environment().get_template(template).render(**fields)


@cache
def defined(folder: str, pattern: str) -> frozenset[str]:
    """Names of the functions that the templates of a folder define, by a pattern of their heads."""
    files = sorted(template_folder().joinpath(folder).iterdir())
    found = (re.findall(pattern, f.read_text(encoding="utf-8"), re.MULTILINE) for f in files)
    return frozenset(name for names in found for name in names)


def words(text: str) -> set[str]:
    """Names in MATLAB code that stand neither beside a dot nor in comments or texts."""
    code = re.sub(r"%.*", "", re.sub(r"(?<=[(\[,= ])'[^'\n]*'", "", text))
    return set(re.findall(r"(?<![\w.])[A-Za-z]\w*\b(?!\.)", code))


def reached(
    users: Iterable[Any], parts: Mapping[str, Any], named: Callable[[Any], Iterable[str]]
) -> list[str]:
    """Names of the parts that users need, directly or not, in the order of the parts.

    Args:
        users: texts or trees.
        parts: others, by the names under which they are used.
        named: names that occur in one.
    """
    new = {name for user in users for name in named(user)} & set(parts)
    found = set[str]()
    while new:
        found |= new
        new = {name for one in new for name in named(parts[one])} & set(parts) - found
    return [name for name in parts if name in found]
