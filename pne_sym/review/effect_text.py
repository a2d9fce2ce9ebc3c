"""Effects of a change in words of engineers."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from pne_sym.review.difference import Effect

_SHOWN = 8


def effect_lines(effects: Iterable[Effect]) -> Iterator[str]:
    """What changed, at home and around it; what did not in one line."""
    effects = list(effects)
    if not effects:
        return
    if not any(e.changed for e in effects):
        yield "  none on required forces, the least eigenvalue of M, the condition of H"
        return
    for where in dict.fromkeys(e.where for e in effects):
        group = [e for e in effects if e.where == where]
        changed = sorted((e for e in group if e.changed), key=_order)
        if not changed:
            continue
        yield f"  {where}"
        shown = changed[:_SHOWN]
        width = max(len(e.what) for e in shown)
        for e in shown:
            yield f"    {e.what:<{width}}  {_told(e)}"
        if len(changed) > _SHOWN:
            yield f"    and {len(changed) - _SHOWN} others"
        if same := [e.what for e in group if not e.changed]:
            yield f"    unchanged: {_several(same)}"


def _order(e: Effect) -> bool:
    """Forces first; as they stand where there are few."""
    return not e.what.startswith("required")


def _told(e: Effect) -> str:
    if e.note:
        return e.note
    unit = f" {e.unit}" if e.unit else ""
    if e.before is None:
        return f"{_number(e.after)}{unit}; no counterpart before"
    if e.after is None:
        return f"{_number(e.before)}{unit} before; no counterpart after"
    return f"{_number(e.before)} -> {_number(e.after)}{unit}{_percent(e.before, e.after)}"


def _number(value: float | None) -> str:
    if value is None or math.isnan(value):
        return "no value"
    return f"{value:.4g}"


def _percent(a: float, b: float) -> str:
    """How much larger a figure is, in size; as a factor where a percentage is hard to read."""
    if not (math.isfinite(a) and math.isfinite(b)) or a == 0.0:
        return ""
    if abs(a + b) <= 1e-9 * abs(a):
        return " (opposite sign)"
    ratio = abs(b) / abs(a)
    told = f"{100.0 * (ratio - 1.0):+.3g} %" if ratio < 10.0 else f"{ratio:.3g} times"
    return f" ({told}{' in size' if a * b < 0 else ''})"


def _several(names: list[str]) -> str:
    """Many of one kind in few words."""
    forces = [n for n in names if n.startswith("required") and " of leg " in n]
    if len(forces) < 3:
        return ", ".join(names)
    others = [n for n in names if n not in forces]
    return ", ".join([f"{len(forces)} required forces", *others])
