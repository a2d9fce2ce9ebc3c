"""Write docs/architecture.svg and the table of packages in docs/architecture.md, from the code.

The stages of the pipeline are functions: what goes in and comes out stands in their annotations.
Which package may import which is the contract of `make check-layers` in pyproject.toml; what a
package is for is the first sentence of its docstring.
"""

from __future__ import annotations

import ast
import inspect
import sys
import tomllib
from collections.abc import Callable
from html import escape
from pathlib import Path

from pne_sym.backends.emission import emit
from pne_sym.lowering.program import lower
from pne_sym.mechanics.derive import derive
from pne_sym.model.reader import from_text
from pne_sym.writer import write_model

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/architecture.md"
PICTURE = ROOT / "docs/architecture.svg"
BEGIN, END = "<!-- packages: make architecture -->", "<!-- end -->"

STAGES: tuple[Callable[..., object], ...] = (from_text, derive, lower, emit, write_model)
"""From a specification to a folder; each takes what the one before gives."""
SAID = {"str": "text of a spec", "dict[str, str]": "files: path, text", "Path": "model's folder"}
"""Annotations that do not say what is meant."""
BOX, GAP, ROW, MARGIN = 118, 62, 44, 16


def layers() -> list[list[str]]:
    """Packages from the highest layer to the lowest, as pyproject.toml has them."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    (contract,) = settings["tool"]["importlinter"]["contracts"]
    return [[name.strip() for name in layer.split("|")] for layer in contract["layers"]]


def purpose(package: str) -> str:
    """The first sentence of a package's docstring."""
    folder = ROOT / "pne_sym" / package
    path = folder / "__init__.py" if folder.is_dir() else folder.with_suffix(".py")
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


def table() -> str:
    """The packages in Markdown, with those that each may import."""
    rows = ["| package | what it is for | may import |", "|---|---|---|"]
    below: list[str] = []
    for layer in reversed(layers()):
        known = ", ".join(f"`{name}`" for name in sorted(below)) or "none of these"
        rows[2:2] = [f"| `{name}` | {purpose(name)} | {known} |" for name in layer]
        below += layer
    return "\n".join(rows)


def picture() -> str:
    """The stages as a row of boxes, what goes in above, and where they stand below."""
    flow = [_word(STAGES[0], first=True), *(_word(stage) for stage in STAGES)]
    width = 2 * MARGIN + len(flow) * BOX + len(STAGES) * GAP
    height = 2 * MARGIN + 3 * ROW
    parts = []
    for k, word in enumerate(flow):
        x = MARGIN + k * (BOX + GAP)
        parts.append(
            f'<rect x="{x}" y="{MARGIN + ROW}" width="{BOX}" height="{ROW}" rx="6" '
            'fill="#eef3fa" stroke="#33527a"/>'
        )
        parts.append(_text(x + BOX / 2, MARGIN + 1.5 * ROW + 5, word))
    for k, stage in enumerate(STAGES):
        x = MARGIN + (k + 1) * BOX + k * GAP
        y = MARGIN + 1.5 * ROW
        tip = x + GAP
        parts.append(f'<path d="M{x} {y}H{tip - 7}" stroke="#33527a" stroke-width="2"/>')
        parts.append(f'<path d="M{tip} {y}l-9 -5v10z" fill="#33527a"/>')
        middle = x + GAP / 2
        parts.append(_text(middle, MARGIN + ROW - 12, f"{stage.__name__}()", bold=True))
        parts.append(_text(middle, MARGIN + 2 * ROW + 22, _place(stage), small=True))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
        f'width="{width}" height="{height}" font-family="sans-serif" role="img">\n'
        "<title>From a specification to a model's folder</title>\n"
        f'<rect width="{width}" height="{height}" fill="white"/>\n'
        + "\n".join(parts)
        + "\n</svg>\n"
    )


def _word(stage: Callable[..., object], *, first: bool = False) -> str:
    """What a stage gives, or takes, by its annotation."""
    found = inspect.signature(stage)
    given = next(iter(found.parameters.values())).annotation
    annotation = given if first else found.return_annotation
    return SAID.get(str(annotation), str(annotation))


def _place(stage: Callable[..., object]) -> str:
    return stage.__module__.removeprefix("pne_sym.").split(".")[0]


def _text(x: float, y: float, words: str, *, bold: bool = False, small: bool = False) -> str:
    size, weight = (12, "normal") if small else (13, "bold" if bold else "normal")
    style = f'font-size="{size}" font-weight="{weight}"'
    fill = "#666" if small else "#111"
    return (
        f'<text x="{x}" y="{y}" text-anchor="middle" fill="{fill}" {style}>{escape(words)}</text>'
    )


def page(text: str) -> str:
    """The page with the table brought up to date."""
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    return f"{before}{BEGIN}\n\n{table()}\n\n{END}{after}"


def main() -> int:
    """Write both."""
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    PICTURE.write_text(picture(), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
