"""Write docs/gallery.md and its pictures from the catalogue: `make gallery`.

Operation counts are those of the compiled programs, from the manifests in generated/ that the
page links to (`make generate` brings them up to date); mobility is that at home.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pne_sym import drawing, manipulators
from pne_sym.mechanics.mobility import CASES, Mobility, mobility
from pne_sym.mechanics.structure import leg_types
from pne_sym.model.manipulator import Manipulator, Space

DOCS = Path(__file__).parent
PAGE = DOCS / "gallery.md"
PICTURES = DOCS / "gallery"
GENERATED = DOCS.parent / "generated"

SPACES = {
    Space.POINT: "a point in the plane",
    Space.PLANAR: "a body in the plane",
    Space.SPATIAL: "a body in space",
    Space.TRANSLATIONAL: "a body in space that keeps its orientation, or a point",
    Space.SPHERICAL: "a body about a fixed centre",
}
INTRODUCTION = """\
# Gallery

The whole catalogue, drawn at home from its own data. `make gallery` writes this page; every
figure on it is the program's own. For one of your own:

```sh
pne-gen draw my_robot.toml --out my_robot.svg    # .svg, .png or .pdf; pip install 'pne-sym[draw]'
pne-gen draw my_robot.toml --pose 0.05,0,0.8,0,0,0.2    # x, y, z, roll, pitch, yaw; or X itself
pne-gen draw my_robot.toml --path poses.csv --out motion.gif    # a pose in each line; or .mp4
```

```python
pne_sym.draw("stewart", "stewart.png", azimuth=-40, elevation=25)
pne_sym.animate("stewart", "motion.gif", poses)  # X of each frame
```

Letters: R revolute, P prismatic, H helical, U universal, S spherical, from the base to the
platform; actuated joints are underlined, `*` marks an extra coordinate. Numbers in circles are the
legs, in the order of q, tau and the columns of H. Degrees of freedom are counted by rank at home.

Operations are those of one evaluation in scalar code: multiplications, additions, divisions and
roots. *Dynamics*: M, Z and H together. *Inverse dynamics*: both sides of its linear system, which
is then solved for the driving forces.
"""


@dataclass(frozen=True)
class Entry:
    """A manipulator's figures.

    Attributes:
        manipulator: the manipulator.
        mobility: at home.
        dynamics: operations of M, Z and H together.
        inverse_dynamics: operations of both sides of the linear system.
        calls: trigonometric calls of both, in this order.
    """

    manipulator: Manipulator
    mobility: Mobility
    dynamics: int
    inverse_dynamics: int
    calls: tuple[int, int]


def entry(manipulator: Manipulator, facts: Mapping[str, Any]) -> Entry:
    """The figures of a manipulator, counts from its manifest."""
    counts = [facts["operations"][name] for name in ("dynamics", "required")]
    totals = [sum(each[kind] for kind in ("mul", "add", "div", "sqrt")) for each in counts]
    calls = counts[0]["trig"], counts[1]["trig"]
    return Entry(manipulator, mobility(manipulator), totals[0], totals[1], calls)


def manifest(name: str) -> dict[str, Any]:
    """What stands in generated/ about a manipulator."""
    path = GENERATED / name / f"{name}.json"
    if not path.is_file():
        sys.exit(f"{path} is missing; `make generate` writes it")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def page(entries: Iterable[Entry]) -> str:
    """The text of the gallery."""
    entries = list(entries)
    parts = [INTRODUCTION, _overview(entries)]
    for space, words in SPACES.items():
        inside = [each for each in entries if each.manipulator.space is space]
        if inside:
            parts.append(f"## Task space: {words}\n")
            parts += [_section(each) for each in inside]
    return "\n".join(parts)


def _overview(entries: list[Entry]) -> str:
    head = "DOF | actuators | constraints | extra | section 3 | dynamics | inverse dynamics |"
    lines = [f"| | {head}", "|---|" + "--:|" * 4 + "---|" + "--:|" * 2]
    for each in entries:
        name, m = each.manipulator.name, each.mobility
        numbers = f"{m.dofs} | {m.actuators} | {m.constraints} | {m.extra}"
        counts = f"{each.dynamics} | {each.inverse_dynamics}"
        lines.append(f"| [{name}](#{name}) | {numbers} | {', '.join(m.cases)} | {counts} |")
    return "\n".join([*lines, ""])


def _section(each: Entry) -> str:
    manipulator, m = each.manipulator, each.mobility
    name = manipulator.name
    rows = [
        ("legs", _legs(manipulator)),
        ("degrees of freedom", str(m.dofs)),
        ("actuators", str(m.actuators)),
        ("constraints", str(m.constraints)),
        ("extra coordinates", str(m.extra) + (f", {m.passive} passive" if m.passive else "")),
        ("section 3 of the paper", "<br>".join(f"{case} {CASES[case]}" for case in m.cases)),
        ("operations, dynamics", _operations(each.dynamics, each.calls[0])),
        ("operations, inverse dynamics", _operations(each.inverse_dynamics, each.calls[1])),
        ("derivation", f'<a href="../generated/{name}/{name}.md">{name}.md</a>'),
    ]
    image = f'<img src="gallery/{name}.svg" height="300" alt="{manipulator.title} at home">'
    lines = [f"### {name}", "", f"{manipulator.title}.", "", "<table>"]
    for k, (term, value) in enumerate(rows):
        picture = f'<td rowspan="{len(rows)}">{image}</td>' if k == 0 else ""
        lines.append(f"<tr>{picture}<td>{term}</td><td>{value}</td></tr>")
    return "\n".join([*lines, "</table>", ""])


def _operations(count: int, calls: int) -> str:
    return f"{count}" + (f" and {calls} trigonometric calls" if calls else "")


def _legs(manipulator: Manipulator) -> str:
    """Such as 6 UPS, actuated joints underlined."""
    parts = []
    for leg_type in leg_types(manipulator):
        text, actuated = "", False
        for letter in leg_type.architecture:
            if letter != "_":
                text += f"<ins>{letter}</ins>" if actuated else letter
            actuated = letter == "_"
        parts.append(f"{leg_type.count} {text}")
    return ", ".join(parts)


def main() -> None:
    """Write the page and the pictures; remove pictures of what is no longer in the catalogue."""
    models = [manipulators.load(name) for name in manipulators.names()]
    PICTURES.mkdir(exist_ok=True)
    for picture in PICTURES.glob("*.svg"):
        if picture.stem not in manipulators.names():
            picture.unlink()
    for model in models:
        drawing.draw(model, PICTURES / f"{model.name}.svg")
    entries = [entry(model, manifest(model.name)) for model in models]
    PAGE.write_text(page(entries), encoding="utf-8")


if __name__ == "__main__":
    main()
