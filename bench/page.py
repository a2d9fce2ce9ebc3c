"""docs/benchmark.md and its plots, from results.json alone."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from bench.cases import FUNCTIONS, NAMES, ROOT
from bench.plots import draw
from pne_sym import manipulators

RESULTS = Path(__file__).resolve().parent / "results.json"
STACK = RESULTS.with_name("stack.json")
PAGE = ROOT / "docs" / "benchmark.md"
HEADS = {
    "inverse_dynamics": "inverse dynamics",
    "dynamics": "M, Z, H",
    "forward_dynamics": "forward dynamics",
}


def written(ns: float) -> str:
    """A time to three digits."""
    if ns >= 1e5:
        return f"{ns / 1e6:.2f} ms" if ns >= 1e6 else f"{ns / 1e3:.0f} us"
    return f"{ns / 1e3:.3g} us" if ns >= 1e3 else f"{ns:.3g} ns"


class Table:
    """The rows of a mechanism: who by function."""

    def __init__(self, results: dict[str, Any], mechanism: str) -> None:
        self.rows = [r for r in results["rows"] if r["mechanism"] == mechanism]
        self.peak = results["peak"]
        self.operations = results["operations"][mechanism]
        self.found = {(r["who"], r["compiler"], r["function"]): r for r in self.rows}

    def people(self, *, batch: bool) -> list[tuple[str, str]]:
        """Who was measured, with the compiler, ours first."""
        keys = [(r["who"], r["compiler"]) for r in self.rows if r["who"].endswith("batch") is batch]
        return list(dict.fromkeys(keys))

    def cell(self, who: str, compiler: str, function: str) -> str:
        """Time and its ratio to that of our C by gcc, or what is wrong."""
        row = self.found.get((who, compiler, function))
        if row is None:
            return ""
        if not row["same"]:
            return f"something else: error {row['error']:.0e} ({written(row['ns'])})"
        ours = self.found["ours, batch" if who.endswith("batch") else "ours", "gcc", function]
        return f"{written(row['ns'])} ({row['ns'] / ours['ns']:.3g})"

    def lines(self, *, batch: bool) -> list[str]:
        """The table's lines."""
        lines = []
        for who, compiler in self.people(batch=batch):
            cells = [self.cell(who, compiler, function) for function in FUNCTIONS]
            rows = [r for r in self.rows if (r["who"], r["compiler"]) == (who, compiler)]
            worst = max(row["error"] for row in rows)
            name = who.removesuffix(", batch") + (f", {compiler}" if compiler else "")
            shown = f"{worst:.0e}" if worst else "reference"
            lines.append(f"| {name} | {' | '.join(cells)} | {shown} |")
        return lines

    def shares(self) -> list[str]:
        """Operations per nanosecond of ours, and their share of what the core can do."""
        lines = []
        for who, precision in (("ours", "double"), ("ours, batch", "double")):
            for function, count in self.operations.items():
                row = self.found[who, "gcc", function]
                rate = count / row["ns"]
                share = rate / self.peak[precision]
                lines.append(
                    f"| {who} | {HEADS[function]} | {count} | {rate:.3g} | {100 * share:.0f} % |"
                )
        return lines


def write_page() -> None:
    """Write the page and its plots."""
    results = json.loads(RESULTS.read_text(encoding="utf-8"))
    draw(results, PAGE.parent)
    loader = FileSystemLoader(Path(__file__).resolve().parent)
    environment = Environment(
        loader=loader, undefined=StrictUndefined, trim_blocks=True, keep_trailing_newline=True,
        autoescape=False,  # noqa: S701  (Markdown)
    )  # fmt: skip
    tables = {name: Table(results, name) for name in NAMES if name in results["operations"]}
    stack = json.loads(STACK.read_text(encoding="utf-8"))
    titles = {name: manipulators.load(name).title for name in tables}
    text = environment.get_template("page.md.jinja").render(
        tables=tables, heads=[HEADS[f] for f in FUNCTIONS], stack=stack, titles=titles, **results
    )
    PAGE.write_text(text, encoding="utf-8")
