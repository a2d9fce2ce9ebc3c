"""Two derivations compared equation by equation, by text and by value.

An equation is judged *locally*: what it uses is given the values of the version
before, so that one mistake shows at its own place and not in all that follows.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pne_sym.derivation import Derivation, Equation, names_in
from pne_sym.review.alignment import Alignment
from pne_sym.review.difference import EquationDifference, Gap, Verdict, by_text
from pne_sym.review.equation_text import (
    basis_facts,
    components,
    formula,
    frame_text,
    relation_formula,
    summed_types,
    text_of,
)
from pne_sym.review.evaluation import Situation, State, Structure, assembled, by_array
from pne_sym.review.measure import gap_between
from pne_sym.review.naming import Names
from pne_sym.review.plain import plain

Sample = tuple[Situation, Situation]
"""A state of both versions."""


class DerivationComparer:
    """Compares two derivations at common samples.

    Equations are matched through the alignment of legs and joints. Those of the same text
    say the same; others are judged by their values, given those before of all they use.
    """

    def __init__(
        self,
        before: Derivation,
        after: Derivation,
        samples: Sequence[Sample],
        tolerance: float,
        alignment: Alignment,
    ) -> None:
        self.a, self.b = Structure(before), Structure(after)
        self.tolerance = tolerance
        self.names = Names(self.a, self.b, alignment)
        known = (*self.b.givens, *self.b.equations)
        self.matched = {
            n: self.names.partner[n]
            for n in known
            if n in self.names.partner and self._comparable(self.names.partner[n], n)
        }
        self.before = [State(self.a, at) for at, _ in samples]
        self.after = [State(self.b, at) for _, at in samples]
        self.local = [
            State(self.b, new.at, self._lender(old))
            for old, new in zip(self.before, self.after, strict=True)
        ]
        self.moved = set(self._turned_branches())

    def compare(self) -> tuple[EquationDifference, ...]:
        """All equations: given quantities first, then in order of the derivation after."""
        if self.before:
            self._match_renamed()
        found = [*self._givens(), *(self._equation(e) for e in self.b.derivation.equations())]
        kept = set(self.matched.values())
        gone = (e for e in self.a.derivation.equations() if e.name not in kept)
        found += (self._told(e, Verdict.REMOVED, before=formula(e)) for e in gone)
        outputs = self._outputs() if self.before else ()
        return (*found, *self._relations(), *self._bases(), *outputs)

    def _relations(self) -> Iterator[EquationDifference]:
        """Relations between whole arrays, by their text; functions are compared by value."""
        old, new = ({r.id: r for r in s.derivation.relations} for s in (self.a, self.b))
        for id_ in dict.fromkeys((*new, *old)):
            texts = [relation_formula(of[id_]) if id_ in of else "" for of in (old, new)]
            title = (new.get(id_) or old[id_]).title
            yield EquationDifference(id_, id_, title, "", *by_text(*texts))

    # ---- who is who -------------------------------------------------------------------

    def _turned_branches(self) -> Iterator[str]:
        """Signs of assembly branches that are others, or new."""
        tables = [s.derivation.parameters.branches for s in (self.a, self.b)]
        for name, (leg_type, signs) in tables[1].items():
            of, old = tables[0].get(self.names.partner.get(name, ""), ("", ()))
            before = dict(zip(self.a.legs.get(of, ()), old, strict=True))
            for leg, sign in zip(self.b.legs[leg_type], signs, strict=True):
                if leg in self.names.legs and before.get(self.names.legs[leg]) != sign:
                    yield name

    def _common_legs(self, before: str, after: str) -> tuple[int | None, ...]:
        """Legs after that have the quantity in both versions; (None,) of the platform's."""
        if (before in self.a.leg_type) != (after in self.b.leg_type):
            return ()
        old = set(self.a.legs_of(before))
        legs = self.names.legs
        return tuple(k for k in self.b.legs_of(after) if k is None or legs.get(k) in old)

    def _old(self, leg: int | None) -> int | None:
        return None if leg is None else self.names.legs[leg]

    def _comparable(self, before: str, after: str) -> bool:
        """Whether both exist, of one kind, with legs in common."""
        both_equations = before in self.a.equations and after in self.b.equations
        both_given = before in self.a.givens and after in self.b.givens
        return (both_equations or both_given) and bool(self._common_legs(before, after))

    def _lender(self, old: State) -> Any:
        def borrow(name: str, leg: int | None) -> Any:
            partner = self.matched.get(name)
            if partner is None or leg not in self._common_legs(partner, name):
                return None
            return old.value(partner, self._old(leg))

        return borrow

    def _match_renamed(self) -> None:
        """Match what has a new name by law and value: in order, each with the first that agrees."""
        taken = set(self.matched.values())
        free = [n for n in (*self.a.givens, *self.a.equations) if n not in taken]
        for name in (*self.b.givens, *self.b.equations):
            if name in self.matched:
                continue
            for candidate in free:
                if self._alike(candidate, name) and self._agree(candidate, name):
                    self.matched[name] = self.names.partner[name] = candidate
                    free.remove(candidate)
                    break

    def _alike(self, before: str, after: str) -> bool:
        if not self._comparable(before, after):
            return False
        old, new = self.a.equations.get(before), self.b.equations.get(after)
        return old is None or new is None or old.law == new.law

    def _agree(self, before: str, after: str) -> bool:
        old, new, legs = self._values(before, after)
        if not old or np.shape(old[0]) != np.shape(new[0]) or not np.any(old):
            return False
        return self._beyond(gap_between(old, new, legs=legs)) is None

    # ---- values -------------------------------------------------------------------------

    def _values(
        self, before: str, after: str, expr: Any = None
    ) -> tuple[list[Any], list[Any], list[int | None]]:
        """Values before, and after (also of another expression) given those before.

        They run over samples and common legs.
        """
        old, new, legs = [], [], []
        for state, local in zip(self.before, self.local, strict=True):
            for leg in self._common_legs(before, after):
                old.append(state.value(before, self._old(leg)))
                new.append(local.own(after, leg) if expr is None else local.of(expr, leg))
                legs.append(leg)
        return old, new, legs

    def _gap(self, before: str, after: str, expr: Any = None) -> Gap | None:
        """Local gap of a definition, or of another expression of the same value."""
        old, new, legs = self._values(before, after, expr)
        return self._beyond(gap_between(old, new, floor=self._size(after), legs=legs))

    def _beyond(self, gap: Gap | None) -> Gap | None:
        """A gap that is more than rounding."""
        return gap if gap is not None and gap.size > self.tolerance else None

    def _size(self, name: str) -> float:
        """Size of the terms that a quantity is made of."""
        equation = self.b.equations.get(name)
        size = 0.0
        for used in names_in(equation.rhs) if equation else ():
            if used in self.matched:
                leg = self._common_legs(self.matched[used], used)[0]
                size = max([size, *(float(np.max(np.abs(s.value(used, leg)))) for s in self.local)])
        return max(size, size * size)

    def _follows(self, before: str, after: str) -> bool:
        """Whether the value differs once all differences before have their effect."""
        legs = self._common_legs(before, after)
        old = [s.value(before, self._old(leg)) for s in self.before for leg in legs]
        new = [s.value(after, leg) for s in self.after for leg in legs]
        return self._beyond(gap_between(old, new, floor=self._size(after))) is not None

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
            self.moved.add(after.name)
            return self._told(after, Verdict.ADDED, after=formula(after))
        before = self.a.equations[partner]
        same = text_of(before) == self._renamed_text(before, after)
        gap, notes = (None, []) if same or not self.before else self._worst(before, after)
        if gap is not None:
            verdict = Verdict.DIFFERENT
        elif same:
            verdict = Verdict.IDENTICAL
        else:
            verdict = Verdict.EQUAL if self.before else Verdict.CHANGED
        used = names_in(after.rhs)
        if gap is None and used & self.moved and self.before and self._follows(partner, after.name):
            verdict = Verdict.FOLLOWS
            notes += [] if same else ["also rewritten, with equal values"]
        if verdict in (Verdict.DIFFERENT, Verdict.FOLLOWS):
            self.moved.add(after.name)
        note = "; ".join((*notes, *self._notes(before, after)))
        if same:
            return self._told(after, verdict, note=note)
        texts = {"before": formula(before), "after": formula(after)}
        return self._told(after, verdict, gap=gap, note=note, **texts)

    def _renamed_text(self, before: Equation, after: Equation) -> tuple[str, str]:
        """The text after, with the names before."""
        return text_of(after, before.name, self.names.expression)

    def _notes(self, before: Equation, after: Equation) -> Iterator[str]:
        """What else is not as it was."""
        if before.name not in (after.name, self.names.found.get(after.name)):
            yield f"renamed: {before.name} -> {after.name}"
        if before.id != after.id:
            yield f"was {before.id}"
        if (before.law, before.reference) != (after.law, after.reference):
            yield f"law: {before.law}, {before.reference} -> {after.law}, {after.reference}"
        for leg_type in summed_types(after.rhs):
            legs = self.b.legs.get(leg_type, ())
            old = self.a.legs.get(self.names.alignment.types.get(leg_type, ""), ())
            if old and len(old) != len(legs):
                count = f"{len(legs)} leg{'s' * (len(legs) > 1)}"
                yield f"a sum over {count}, was over {len(old)}"

    def _worst(self, before: Equation, after: Equation) -> tuple[Gap | None, list[str]]:
        """First gap among the definition, its other forms and its conditions."""
        gap = self._gap(before.name, after.name)
        if gap is not None:
            return gap, []
        for form in after.forms:
            gap = self._gap(before.name, after.name, form)
            if gap is not None:
                return gap, [f"in the form {plain(form)}"]
        if text_of(before)[1] != self._renamed_text(before, after)[1]:
            return self._condition_gap(before, after)
        return None, []

    def _condition_gap(self, before: Equation, after: Equation) -> tuple[Gap | None, list[str]]:
        kinds = [[(c.status, c.power) for c in e.conditions] for e in (before, after)]
        if kinds[0] != kinds[1]:
            return Gap(float("inf"), "the conditions", 0.0, 0.0), ["conditions added or removed"]
        legs = self._common_legs(before.name, after.name)
        for old, new in zip(before.conditions, after.conditions, strict=True):
            for was, now in ((old.value, new.value), (old.scale, new.scale)):
                a = [s.of(was, self._old(leg)) for s in self.before for leg in legs]
                b = [s.of(now, leg) for s in self.local for leg in legs]
                if (gap := self._beyond(gap_between(a, b))) is not None:
                    return gap, [f"in the condition on {plain(now)}"]
        return None, []

    # ---- what is given, bases, outputs -----------------------------------------------------

    def _givens(self) -> Iterator[EquationDifference]:
        """Given quantities whose components differ, and frames that stand otherwise."""
        turned = self._turned_frames()
        for name, given in self.b.givens.items():
            partner = self.matched.get(name)
            if partner is None:
                self.moved.add(name)
                continue
            old = self.a.givens[partner]
            chain = set(self.b.ancestors(given.frame or None))
            text = self.names.as_before(components(given.components))
            same_frame = self.names.partner.get(given.frame, given.frame) == old.frame
            same = text == components(old.components) and same_frame
            if same and not chain & turned:
                continue
            gap = self._gap(partner, name) if self.before else None
            if gap is None and (same or self.before):
                continue
            self.moved.add(name)
            if same:
                continue
            before, after = (f"{components(g.components)} in {g.frame}" for g in (old, given))
            verdict = Verdict.CHANGED if gap is None else Verdict.DIFFERENT
            meaning = self.b.derivation.notation[name].meaning
            about = ("given", name, meaning, self.b.leg_type.get(name, ""), verdict)
            yield EquationDifference(*about, before, after, gap)

    def _turned_frames(self) -> set[str]:
        """Frames after whose text is another, or that have no counterpart."""
        found = set()
        for name, frame in self.b.frames.items():
            old = self.a.frames.get(self.names.partner.get(name, name))
            if old is None or frame_text(old) != self.names.as_before(frame_text(frame)):
                found.add(name)
        return found

    def _bases(self) -> Iterator[EquationDifference]:
        """Reciprocal bases that are solved otherwise: the facts that are others."""
        old = {x.id: basis_facts(x) for x in self.a.derivation.bases}
        for x in self.b.derivation.bases:
            facts, known = basis_facts(x), old.get(self.names.partner.get(x.id, x.id))
            if known is None:
                continue
            other = [k for k, v in facts.items() if known[k] != self.names.as_before(v)]
            if other:
                sides = ["\n".join(f"{k}: {of[k]}" for k in other) for of in (known, facts)]
                note = "data of the lowering; values are compared by function"
                about = (x.id, "reciprocal basis", "how it is solved", x.id, Verdict.CHANGED)
                yield EquationDifference(*about, sides[0], sides[1], note=note)

    def _outputs(self) -> Iterator[EquationDifference]:
        """Where quantities stand in the arrays that the code returns."""
        legs = {k: k for k in self.a.type_of_leg}
        if self.names.legs != legs or legs.keys() != self.b.type_of_leg.keys():
            return  # the places of legs that are new or gone are not those before
        old, new = (by_array(s.derivation) for s in (self.a, self.b))
        for array in sorted(old.keys() & new.keys()):
            if str(old[array]) == self.names.as_before(str(new[array])):
                continue
            a = [assembled(s, old[array]) for s in self.before]
            b = [assembled(s, new[array]) for s in self.local]
            places = sorted({place for each in (*a, *b) for place in each})
            rows = ([[each.get(p, 0.0) for p in places] for each in x] for x in (a, b))
            if (gap := self._beyond(gap_between(*rows))) is not None:
                gap = replace(gap, where=str(list(places[int(gap.where.strip("[]"))])))
            verdict = Verdict.EQUAL if gap is None else Verdict.DIFFERENT
            about = ("output", array, "where the values stand in the array", "", verdict)
            yield EquationDifference(*about, gap=gap)
