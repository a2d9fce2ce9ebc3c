"""Two derivations compared equation by equation, by text and by value.

An equation is judged *locally*: what it uses is given the values of the version
before, so that one mistake shows at its own place and not in all that follows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pne_sym.derivation import Derivation, Equation, Output, names_in
from pne_sym.review.difference import EquationDifference, Gap, Verdict
from pne_sym.review.evaluation import State, Structure
from pne_sym.review.measure import gap_between
from pne_sym.review.plain import plain


@dataclass(frozen=True)
class Sample:
    """Parameters of both versions by name, and a state."""

    before: dict[str, Any]
    after: dict[str, Any]
    vectors: dict[str, Any]


class DerivationComparer:
    """Compares two derivations at common samples."""

    def __init__(
        self, before: Derivation, after: Derivation, samples: Sequence[Sample], tolerance: float
    ) -> None:
        self.a, self.b = Structure(before), Structure(after)
        self.tolerance = tolerance
        self.matched = {n: n for n in self._known(self.b) if self._comparable(n, n)}
        self.before = [State(self.a, s.before, s.vectors) for s in samples]
        self.after = [State(self.b, s.after, s.vectors) for s in samples]
        self.local = [
            State(self.b, s.after, s.vectors, self._lender(old))
            for s, old in zip(samples, self.before, strict=True)
        ]

    def compare(self) -> tuple[EquationDifference, ...]:
        """All equations: given quantities first, then in order of the derivation after."""
        self._match_renamed()
        found = [*self._givens(), *(self._equation(e) for e in self.b.derivation.equations())]
        gone = set(self.a.equations) - set(self.matched.values())
        for equation in self.a.derivation.equations():
            if equation.name in gone:
                found.append(self._told(equation, Verdict.REMOVED, before=_formula(equation)))
        return (*found, *self._bases(), *self._outputs())

    # ---- who is who -------------------------------------------------------------------

    @staticmethod
    def _known(s: Structure) -> list[str]:
        return [*s.givens, *s.equations]

    def _common_legs(self, before: str, after: str) -> tuple[int | None, ...]:
        legs = set(self.a.legs_of(before))
        return tuple(leg for leg in self.b.legs_of(after) if leg in legs)

    def _comparable(self, before: str, after: str) -> bool:
        """Whether both exist, of one kind, with legs in common."""
        both_equations = before in self.a.equations and after in self.b.equations
        both_given = before in self.a.givens and after in self.b.givens
        return (both_equations or both_given) and bool(self._common_legs(before, after))

    def _lender(self, old: State) -> Any:
        def borrow(name: str, leg: int | None) -> Any:
            partner = self.matched.get(name)
            if partner is None or leg not in self.a.legs_of(partner):
                return None
            return old.value(partner, leg)

        return borrow

    def _match_renamed(self) -> None:
        """Match what has a new name by value: in order, each with the first that agrees."""
        taken = set(self.matched.values())
        free = [n for n in self._known(self.a) if n not in taken]
        for name in self._known(self.b):
            if name in self.matched:
                continue
            for candidate in free:
                if self._comparable(candidate, name) and self._agree(candidate, name):
                    self.matched[name] = candidate
                    free.remove(candidate)
                    break

    def _agree(self, before: str, after: str) -> bool:
        old, new, legs = self._values(before, after)
        if not old or np.shape(old[0]) != np.shape(new[0]) or not np.any(old):
            return False
        gap = gap_between(old, new, legs=legs)
        return gap is None or gap.size <= self.tolerance

    # ---- values -------------------------------------------------------------------------

    def _values(self, before: str, after: str) -> tuple[list[Any], list[Any], list[int | None]]:
        """Values before, and after given those before; over samples and common legs."""
        old, new, legs = [], [], []
        for state, local in zip(self.before, self.local, strict=True):
            for leg in self._common_legs(before, after):
                old.append(state.value(before, leg))
                new.append(local.own(after, leg))
                legs.append(leg)
        return old, new, legs

    def _gap(self, before: str, after: str, expr: Any = None) -> Gap | None:
        """Local gap of a definition, or of another expression of the same value."""
        old, new, legs = self._values(before, after)
        if expr is not None:
            new = [
                local.of(expr, leg)
                for local in self.local
                for leg in self._common_legs(before, after)
            ]
        gap = gap_between(old, new, floor=self._size(after), legs=legs)
        return gap if gap and gap.size > self.tolerance else None

    def _size(self, name: str) -> float:
        """Size of the terms that a quantity is made of."""
        equation = self.b.equations.get(name)
        size = 0.0
        for used in names_in(equation.rhs) if equation else ():
            if used in self.matched:
                leg = self.b.legs_of(used)[0]
                size = max([size, *(float(np.max(np.abs(s.value(used, leg)))) for s in self.local)])
        return max(size, size * size)

    def _follows(self, before: str, after: str) -> bool:
        """Whether the value differs once all differences before have their effect."""
        legs = self._common_legs(before, after)
        old = [s.value(before, leg) for s in self.before for leg in legs]
        new = [s.value(after, leg) for s in self.after for leg in legs]
        gap = gap_between(old, new, floor=self._size(after))
        return gap is not None and gap.size > self.tolerance

    # ---- equations ----------------------------------------------------------------------

    def _told(self, equation: Equation, verdict: Verdict, **more: Any) -> EquationDifference:
        s = self.a if verdict is Verdict.REMOVED else self.b
        leg_type = s.leg_type.get(equation.name, "")
        return EquationDifference(
            equation.id, equation.name, equation.title, leg_type, verdict, **more
        )

    def _equation(self, after: Equation) -> EquationDifference:
        partner = self.matched.get(after.name)
        if partner is None:
            return self._told(after, Verdict.ADDED, after=_formula(after))
        before = self.a.equations[partner]
        gap, notes = self._worst(before, after)
        same = _text(before) == _text(after)
        if gap is not None:
            verdict = Verdict.DIFFERENT
        elif not same:
            verdict = Verdict.EQUAL
        else:
            verdict = Verdict.IDENTICAL
        if gap is None and self._follows(partner, after.name):
            verdict = Verdict.FOLLOWS
            notes += [] if same else ["also rewritten, with equal values"]
        if before.name != after.name:
            notes.append(f"renamed: {before.name} -> {after.name}")
        if before.id != after.id:
            notes.append(f"was {before.id}")
        if (before.law, before.reference) != (after.law, after.reference):
            notes.append(f"law: {before.law}, {before.reference} -> {after.law}, {after.reference}")
        told = self._told(after, verdict, gap=gap, note="; ".join(notes))
        if same and gap is None:
            return told
        return self._told(
            after,
            verdict,
            before=_formula(before),
            after=_formula(after),
            gap=gap,
            note="; ".join(notes),
        )

    def _worst(self, before: Equation, after: Equation) -> tuple[Gap | None, list[str]]:
        """First gap among the definition, its other forms and its conditions."""
        gap = self._gap(before.name, after.name)
        if gap is not None:
            return gap, []
        for form in after.forms:
            gap = self._gap(before.name, after.name, form)
            if gap is not None:
                return gap, [f"in the form {plain(form)}"]
        if _conditions(before) != _conditions(after):
            return self._condition_gap(before, after)
        return None, []

    def _condition_gap(self, before: Equation, after: Equation) -> tuple[Gap | None, list[str]]:
        kinds = [[(c.trouble, c.power) for c in e.conditions] for e in (before, after)]
        if kinds[0] != kinds[1]:
            return Gap(float("inf"), "the conditions", 0.0, 0.0), ["conditions added or removed"]
        legs = self._common_legs(before.name, after.name)
        for old, new in zip(before.conditions, after.conditions, strict=True):
            for was, now in ((old.value, new.value), (old.scale, new.scale)):
                a = [s.of(was, leg) for s in self.before for leg in legs]
                b = [s.of(now, leg) for s in self.local for leg in legs]
                gap = gap_between(a, b)
                if gap is not None and gap.size > self.tolerance:
                    return gap, [f"in the condition on {plain(now)}"]
        return None, []

    # ---- what is given, bases, outputs -----------------------------------------------------

    def _givens(self) -> Iterator[EquationDifference]:
        for name, given in self.b.givens.items():
            partner = self.matched.get(name)
            gap = self._gap(partner, name) if partner else None
            if gap is not None:
                old = self.a.givens[partner or name]
                yield EquationDifference(
                    "given",
                    name,
                    self.b.derivation.notation[name].meaning,
                    self.b.leg_type.get(name, ""),
                    Verdict.DIFFERENT,
                    f"{old.components} in {old.frame}",
                    f"{given.components} in {given.frame}",
                    gap,
                )

    def _bases(self) -> Iterator[EquationDifference]:
        old, new = ({x.id: str(x) for x in s.derivation.bases} for s in (self.a, self.b))
        for id_ in old.keys() & new.keys():
            if old[id_] != new[id_]:
                yield EquationDifference(
                    id_,
                    "reciprocal basis",
                    "how it is solved",
                    id_,
                    Verdict.CHANGED,
                    old[id_],
                    new[id_],
                    note="data of the lowering; values are compared by block",
                )

    def _outputs(self) -> Iterator[EquationDifference]:
        """Where quantities stand in the arrays that the code returns."""
        old, new = (_by_array(s.derivation) for s in (self.a, self.b))
        for array in sorted(old.keys() & new.keys()):
            if str(old[array]) == str(new[array]):
                continue
            a = [_assembled(s, old[array]) for s in self.before]
            b = [_assembled(s, new[array]) for s in self.local]
            places = sorted({place for each in (*a, *b) for place in each})
            gap = gap_between(*([[each.get(p, 0.0) for p in places] for each in x] for x in (a, b)))
            different = gap is not None and gap.size > self.tolerance
            if gap is not None:
                place = places[int(gap.where.strip("[]"))]
                gap = Gap(gap.size, str(list(place)), gap.before, gap.after)
            yield EquationDifference(
                "output",
                array,
                "where the values stand in the array",
                "",
                Verdict.DIFFERENT if different else Verdict.EQUAL,
                gap=gap if different else None,
            )


def _formula(equation: Equation) -> str:
    forms = "".join(f" = {plain(form)}" for form in equation.forms)
    return f"{equation.name} = {plain(equation.rhs)}{forms}"


def _conditions(equation: Equation) -> str:
    return str([(c.trouble, c.value, c.scale, c.power) for c in equation.conditions])


def _text(equation: Equation) -> tuple[str, ...]:
    return (_formula(equation), _conditions(equation))


def _by_array(derivation: Derivation) -> dict[str, list[Output]]:
    found: dict[str, list[Output]] = {}
    for output in derivation.outputs:
        found.setdefault(output.array, []).append(output)
    return found


def _assembled(state: State, outputs: list[Output]) -> dict[tuple[int, int], float]:
    """Entries of an array by row and column."""
    entries: dict[tuple[int, int], float] = {}
    for o in outputs:
        legs = state.structure.legs[o.leg_type] if o.leg_type else (None,)
        for k, leg in enumerate(legs):
            value = np.asarray(state.of(o.value, leg), dtype=float)
            r0 = o.leg_rows[k] if o.leg_rows else 0
            c0 = o.leg_columns[k] if o.leg_columns else 0
            for i, row in o.rows:
                for j, column in o.columns or ((0, 0),):
                    place = (row + r0, column + c0)
                    entries[place] = _entry(value, i, j, along_row=len(o.columns) > 1)
                    if o.mirrored:
                        entries[place[::-1]] = entries[place]
    return entries


def _entry(value: Any, i: int, j: int, *, along_row: bool) -> float:
    if value.ndim == 0:
        return float(value)
    return float(value[i, j] if value.ndim == 2 else value[j if along_row else i])
