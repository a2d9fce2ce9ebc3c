"""C that is measured: ours as it is generated, by hand, and CasADi's."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from bench.casadi_code import prepared_vector, write_casadi
from bench.cases import BUILD, Case
from bench.programs import C_SOURCES, FAST, SINGLE, SMALL, Program, compiled, write_states

ROUNDS = 30
OURS = {
    "ours": "",
    "ours, float": "-D{upper}_REAL=float",
    "ours, LANES=1": "-D{upper}_LANES=1",
}
"""What is defined, by what it is called."""


def compilers() -> list[str]:
    """Those that are installed."""
    return [name for name in ("gcc", "clang") if shutil.which(name)]


def flags_of(case: Case, code: str, header: str) -> str:
    """What speed.c wants to know."""
    m = case.module()
    defines = {"MODEL": case.name, "UPPER": case.name.upper(), "CODE": code}
    defines |= {"HEADER": f'"{header}"', "LAMBDA": str(int(m.NC > 0))}
    said = " ".join(f"-D{name}={value}" for name, value in defines.items())
    return f"{FAST} {said} -I{case.folder} -I{C_SOURCES}"


def our_program(case: Case, who: str = "ours", compiler: str = "gcc") -> Program:
    """The generated C by a compiler."""
    sources = (C_SOURCES / "speed.c", case.folder / f"{case.name}.c")
    flags = f"{flags_of(case, case.name, case.name + '.h')} {OURS[who]}"
    program = compiled(
        f"{case.name}-{who}-{compiler}".replace(", ", "-"),
        compiler,
        sources,
        flags.format(upper=case.name.upper()),
    )
    return Program(
        case, who, compiler, _command(case, program), SINGLE if "float" in who else SMALL
    )


def hand_program(case: Case, compiler: str) -> Program:
    """The Stewart platform by hand."""
    sources = (C_SOURCES / "speed.c", case.folder / "stewart.c", C_SOURCES / "hand_stewart.c")
    flags = f"{flags_of(case, 'hand_stewart', 'hand_stewart.h')} -DBY_HAND -Wno-psabi"
    program = compiled(f"hand-{compiler}", compiler, sources, flags)
    return Program(case, "by hand", compiler, _command(case, program))


def casadi_program(case: Case, compiler: str) -> Program:
    """CasADi's C, which `write_casadi` has written."""
    sources = (C_SOURCES / "speed.c", case.folder / "casadi_code.c")
    flags = f"{flags_of(case, 'casadi', 'casadi_code.h')} -DCASADI -w"
    program = compiled(f"{case.name}-casadi-{compiler}", compiler, sources, flags)
    return Program(case, "CasADi", compiler, _command(case, program))


def _command(case: Case, program: str) -> tuple[str, ...]:
    """With the states, which are written at first use."""
    m, states = case.module(), BUILD / f"{case.name}.states"
    sizes = (m.NQ, m.NV, m.NU, m.NC)
    write_states(states, case.states(), sizes, prepared_vector(case))
    return (program, str(states), str(ROUNDS))


def c_programs(case: Case) -> list[Program]:
    """Every C of a mechanism by every compiler, compiled two at a time."""
    write_casadi(case)
    jobs: list[Callable[[], Program]] = []
    for compiler in compilers():
        jobs += [partial(our_program, case, who, compiler) for who in OURS]
        jobs += [partial(hand_program, case, compiler)] if case.name == "stewart" else []
        jobs.append(partial(casadi_program, case, compiler))
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(lambda job: job(), jobs))


def peak() -> dict[str, float]:
    """Multiplications and additions per nanosecond of this core."""
    program = compiled("peak", compilers()[0], [C_SOURCES / "peak.c"], FAST)
    rates = []
    for _ in range(9):
        lines = subprocess.run([program], capture_output=True, text=True, check=True).stdout
        rates.append({line.split()[0]: float(line.split()[1]) for line in lines.splitlines()})
    return {name: round(float(np.median([r[name] for r in rates])), 2) for name in rates[0]}
