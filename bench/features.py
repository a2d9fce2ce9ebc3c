"""What friction, springs, motors and the rest add to inverse dynamics: operations, time of the C.

python bench/features.py [MODEL] [--runs 15]

Operations are those of the program.  Time is that of the C with and without friction (viscous and
Coulomb) and motors at all actuated joints: processes take turns, the median of the ratios of
neighbours counts; for states one by one and for a batch, gcc -O3 -march=native.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from bench.c_speed import build, times
from pne_sym import manipulators
from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_backend import CBackend
from pne_sym.backends.describe import describe
from pne_sym.model.effects import Actuator, Friction, Limits, Spring
from pne_sym.model.manipulator import Body, Joint, Manipulator
from pne_sym.model.reader import checked
from pne_sym.pipeline import compile_bundle
from pne_sym.program.count import count_function

FLAGS = "-O3 -march=native"
LAW = Friction(200.0, 40.0, 1e-3)
ASKED = {"friction": LAW, "actuator": Actuator(1e-4, 1257.0)}
AT_ACTUATORS: dict[str, dict[str, Any]] = {
    "viscous friction": {"friction": Friction(200.0)},
    "Coulomb friction": {"friction": Friction(None, 40.0, 1e-3)},
    "spring": {"spring": Spring(2e3, 1.0)},
    "rotor inertia": {"actuator": Actuator(1e-4, 1257.0)},
    "limits of displacement, rate, effort": {"limits": Limits((-20.0, 20.0), 9.0, 1e4)},
    "viscous and Coulomb friction, rotor inertia": ASKED,
}
PAYLOAD = Body(4.0, (0.1, -0.05, 0.2), ((0.1, 0.0, 0.0), (0.0, 0.1, 0.0), (0.0, 0.0, 0.1)))


def with_all(plain: Manipulator, changes: dict[str, Any]) -> Manipulator:
    """The manipulator with changes at all actuated joints."""

    def changed(joint: Joint) -> Joint:
        return replace(joint, **changes) if joint.actuated else joint

    legs = (replace(leg, joints=tuple(map(changed, leg.joints))) for leg in plain.legs)
    return checked(replace(plain, legs=tuple(legs)))


def variants(plain: Manipulator) -> dict[str, Manipulator]:
    """What is added -> the manipulator with it."""
    found = {what: with_all(plain, changes) for what, changes in AT_ACTUATORS.items()}
    count = sum(joint.actuated for leg in plain.legs for joint in leg.joints)
    rows = tuple(tuple(float(i == j) for j in range(count)) for i in range(count))
    motors = with_all(plain, {"actuator": ASKED["actuator"]})
    found["rotor inertia, motors coupled"] = checked(replace(motors, coupling=rows))
    ends = (replace(e, platform_joint=replace(e.platform_joint, friction=LAW)) for e in plain.legs)
    found["friction in the platform joints"] = checked(replace(plain, legs=tuple(ends)))
    found["payload"] = checked(replace(plain, payload=PAYLOAD))
    found["moving base"] = checked(replace(plain, moving_base=True))
    return found


def operations(bundle: Bundle) -> int:
    """Of inverse dynamics, without the solution of the linear equations."""
    n = count_function(bundle.program.functions["required"], bundle.leg_counts)
    return n.mul + n.add + n.div + n.sqrt + n.trig


def program(bundle: Bundle, folder: Path) -> Path:
    """The benchmark of the C as a program in a folder of its own."""
    folder.mkdir()
    for file, text in CBackend().emit(bundle).items():
        (folder / file).write_text(text, encoding="utf-8")
    constrained = int(bundle.coordinates.sizes["NC"] > 0)
    options = argparse.Namespace(
        compiler="gcc", real="double", multipliers=constrained,
        iterated=int(describe(bundle).is_numeric),
    )  # fmt: skip
    return build(folder, bundle.name, options, FLAGS)


def main() -> None:
    """Print operations by feature, then ratios of times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", nargs="?", default="stewart")
    parser.add_argument("--runs", type=int, default=15)
    options = parser.parse_args()
    plain = manipulators.load(options.model)
    base = compile_bundle(plain)
    before = operations(base)
    print(f"{options.model}, inverse dynamics: {before} operations")
    for what, spec in variants(plain).items():
        more = operations(compile_bundle(spec)) - before
        print(f"  {what}: {more:+d} ({100.0 * more / before:+.1f} %)")
    with tempfile.TemporaryDirectory() as name:
        loaded = compile_bundle(with_all(plain, ASKED))
        pair = [program(b, Path(name) / str(k)) for k, b in enumerate((base, loaded))]
        runs = [[times(each) for each in pair] for _ in range(options.runs)]
    print(f"time with friction and rotors over time without ({FLAGS}, {options.runs} pairs):")
    for function in ("inverse_dynamics", "inverse_dynamics_batch"):
        ratios = sorted(after[function] / without[function] for without, after in runs)
        middle, (least, *_, most) = statistics.median(ratios), ratios
        print(f"  {function}: {middle:.3f} ({least:.3f} to {most:.3f})")


if __name__ == "__main__":
    main()
