"""No symbol with two meanings in one report."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import pytest

from pne_sym import manipulators
from pne_sym.backends.glyphs import Glyph
from pne_sym.backends.report.names import per_leg_names
from pne_sym.derivation import Derivation, names_in
from pne_sym.mechanics.derive import derive
from tests import models

# What the report's own statements are written in, and of which dimension it is.
STANDING = {
    "X": "coordinates", "V": "velocities", "A": "accelerations", "F": "N",
    r"\tau": "actuator", r"\lambda": "multiplier", "M": "matrix", "Z": "matrix", "H": "matrix",
    "R": "required", "E": "identity",
}  # fmt: skip
# Letters whose dimension depends on what moves along the joint, or on the method: of these names.
OF_JOINTS = {
    "q": r"q_\d", "y": r"y_\d", "v": r"v_", "w": r"wn?_", "o": r"o_|mu_c", "K": r"K|rho2|root",
    "S": r"S|xi?_|p[xy]_|residual|from_centre|(d\d*_)?rel", r"\Gamma": r"(d\d*_)?Gamma",
    r"\mathcalM": "D_", r"\gamma": r"d_Gamma", r"\Delta": r"disc|volume",
    "n": r"n_c|f_c|n_m|p[xy]_", "P": r"(d\d_)?P_",
    r"\Lambda": "L_c", r"\Pi": "P_c", "H": "Hk?_", "M": "M_|d_P", "Z": "Z_", "R": "R_",
    r"\upsilon": "m", r"\chi": "phi_c", r"\iota": "gamma_c", r"\delta": "root",
    r"\mathcalG": "d_G", r"\mathcalC": "d_c", r"\Xi": "d_N", r"\Upsilon": "d_f",
    "G": r"(d\d*_)?G", "c": r"(d\d*_)?c", "l": r"u[num]_|uu_|d_",
}  # fmt: skip
WEIGHT = re.compile(r"\\(mathbf|boldsymbol|mathrm)(?![a-z])|[{}\s]")
DOTS = re.compile(r"\\d?dot(?![a-z])")
OF_ANGLE = re.compile(r"\\(cos|sin)(?![a-z])")
SAME = {r"\varphi": r"\phi", r"\varepsilon": r"\epsilon", r"\vartheta": r"\theta"}


@cache
def derived(name: str) -> Derivation:
    return derive(models.catalogue(name))


def written(latex: str) -> tuple[str, str]:
    """Letter, and letter with dots and scripts: without weight and braces."""
    letter = WEIGHT.sub("", OF_ANGLE.sub("", DOTS.sub("", Glyph.of(latex).base)))
    return SAME.get(letter, letter), re.sub(r"[{}\s]", "", WEIGHT.sub("", latex))


def scopes(d: Derivation) -> Iterator[tuple[str, set[str]]]:
    """Names of the platform and of every leg type, those of the platform with each."""
    used: dict[str, set[str]] = defaultdict(set)
    for chapter in d.chapters:
        for e in chapter.equations:
            parts = (e.lhs, e.rhs, *e.forms)
            used[chapter.leg_type or ""] |= {n for p in parts for n in names_in(p)}
    for e in d.rotations():
        used[d.notation[e.name].leg_type] |= {e.name, *e.uses}
    for info in d.leg_types:
        of_others = {n for n, owner in per_leg_names(d).items() if owner != info.name}
        yield info.name, (used[info.name] | used[""]) - of_others


def clashes(d: Derivation) -> Iterator[str]:
    """Symbols that differ at most in weight, and letters of several dimensions."""
    for where, names in scopes(d):
        seen: dict[str, str] = {}
        kinds: dict[str, dict[str, str]] = defaultdict(dict)
        for letter, what in STANDING.items():
            kinds[letter][what] = "the report"
        for name in sorted(names):
            quantity = d.notation[name]
            letter, whole = written(quantity.latex)
            short = name.removeprefix(f"{where}_")
            if short.startswith(("unit", "z0_")):  # the same three directions, and axes, again
                continue
            other = seen.setdefault(whole, name)
            if other != name and not re.fullmatch(r"e_\d", short):  # parallel axes
                yield f"{where}: {other} and {name} are both written {quantity.latex}"
            if not DOTS.search(quantity.latex) and r"^{(" not in quantity.latex:
                unit = quantity.unit.replace("rad", "1").replace("-", "1")
                of_joints = letter in OF_JOINTS and re.match(OF_JOINTS[letter], short)
                kinds[letter]["of joints" if of_joints else unit] = name
        for letter, of in kinds.items():
            if len(of) > 1 and set(of) - {"matrix", "required", "of joints"}:
                yield f"{where}: {letter} means {of}"


@pytest.mark.parametrize("name", manipulators.names())
def test_one_meaning(name: str) -> None:
    assert not list(clashes(derived(name)))


@pytest.mark.parametrize(
    ("name", "latex", "told"),
    [
        ("potential", "V", "V means"),  # joule, and the vector of velocities
        ("rrrs_q", r"\mathbf F", "F means"),  # a vector in m, and actuator forces
        ("rrrs_rho_1", r"\mathbf S^x_1", "both written"),
    ],
)
def test_two_meanings_are_seen(name: str, latex: str, told: str) -> None:
    d = derived("hybrid_3rrrs")
    changed = {**d.notation, name: replace(d.notation[name], latex=latex)}
    assert any(told in text for text in clashes(replace(d, notation=changed)))
