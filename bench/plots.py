"""The plots of docs/benchmark.md: SVG that is the same for the same results."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("svg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator

STYLE = {
    "svg.hashsalt": "pne_sym",
    "svg.fonttype": "path",
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.3,
}
Curve = Sequence[Sequence[float]]
"""Points: a size, and a time in nanoseconds."""


def _plot(path: Path, xlabel: str, curves: Mapping[str, Curve], ticks: Sequence[int]) -> None:
    with mpl.rc_context(dict[Any, Any](STYLE)):
        figure, axes = plt.subplots(figsize=(9, 4.5), layout="constrained")
        for mark, (label, points) in zip("osv^Dx+*", curves.items(), strict=False):
            x, y = zip(*points, strict=True)
            axes.plot(x, [ns / 1e3 for ns in y], marker=mark, markersize=5, label=label)
        axes.set(xscale="log", yscale="log", xlabel=xlabel, ylabel="time per state [µs]")
        axes.minorticks_off()
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        if ticks:
            axes.set_xticks(ticks, labels=map(str, ticks))
        axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        figure.savefig(path, metadata={"Date": None, "Creator": None})
        plt.close(figure)


def draw(results: Mapping[str, Any], folder: Path) -> None:
    """Growth with the legs and with the states."""
    growth = results["growth"]
    legs = sorted({int(n) for curve in growth["legs"].values() for n, _ in curve})
    _plot(folder / "benchmark_legs.svg", "legs", growth["legs"], legs)
    _plot(folder / "benchmark_states.svg", "states in a call", growth["states"], ())
