"""What functions of the program share in C: stages that compute once written values.

Statements that several functions make alike stand in one inline routine, which leaves in a
structure what others need of them.  Where a function needs less, the compiler drops the rest.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from pne_sym.backends.c_text import PRINTER, c_name
from pne_sym.backends.waiting import WaitingPrinter, ready, ready_after
from pne_sym.program.ir import Assignment, Function
from pne_sym.program.slices import Slices, read_by, read_in, slices, symbols

_NAME = re.compile(r"[A-Za-z_]\w*")
_MANY = 3  # functions that need not want all of a stage
_FEW = 4  # statements of two functions that are not worth a stage


class Statement(NamedTuple):
    """An assignment with what it is made of: equal ones compute the same in all functions.

    Attributes:
        part: leg type, or "" before the legs.
        assignment: the assignment.
        of: number of the statement that makes each name it reads, of those that are made before.
    """

    part: str
    assignment: Assignment
    of: tuple[tuple[str, int], ...]

    @property
    def key(self) -> tuple[object, ...]:
        """The same for what computes the same under the same name, whatever equation it is for."""
        return self.part, self.assignment.target, self.assignment.expr, self.of


@dataclass
class Stage:
    """Statements of one part that functions share.

    Attributes:
        name: in C.
        part: leg type, or "".
        rank: stages run in this order.
        numbers: of its statements, in order.
        exported: names that others read.
    """

    name: str
    part: str
    rank: tuple[int, int, str]
    numbers: list[int] = field(default_factory=list)
    exported: list[str] = field(default_factory=list)


class Shared:
    """Prints expressions in which some names stand elsewhere.

    Args:
        names: members of a structure.
        prefix: of these members.
        places: other names, with the text of what they are.
        known: name -> cycles until it is known.
    """

    def __init__(
        self,
        names: Collection[str] = (),
        prefix: str = "",
        places: Mapping[str, str] | None = None,
        known: Mapping[str, int] | None = None,
    ) -> None:
        self.texts = {c_name(n): text for n, text in (places or {}).items()}
        self.texts |= {c_name(n): f"{prefix}{c_name(n)}" for n in names}
        self.printer = WaitingPrinter(known) if known else PRINTER

    def text(self, expr: Any) -> str:
        """An expression as text."""
        text, texts = self.printer.text(expr), self.texts
        return _NAME.sub(lambda n: texts.get(n[0], n[0]), text) if texts else text

    def assigned(self, name: str, value: str) -> str:
        """A value given to its place, or to a name of its own."""
        return f"{self.texts.get(c_name(name), f'const real {c_name(name)}')} = {value}"


class Stages:
    """The stages of a model.

    Args:
        functions: that are printed, with common sums.
    """

    def __init__(self, functions: Iterable[Function]) -> None:
        self.statements: list[Statement] = []
        self.numbers: dict[tuple[object, ...], int] = {}
        self.made: dict[str, dict[str, int]] = {}
        self.users: dict[int, set[str]] = {}
        self.kinds: list[frozenset[str]] = []
        self.ready: list[int] = []
        self.parts = {f.name: slices(f) for f in functions}
        self.vectors = _vectors(p.function for p in self.parts.values())
        self.aliases = {n: e for p in self.parts.values() for n, e in aliases(p.function).items()}
        for name, own in self.parts.items():
            self._number(name, own)
        self._givers = self._all_givers()
        self.stage_of = self._stages()
        unique = {id(s): s for s in self.stage_of.values()}
        self.stages = sorted(unique.values(), key=lambda s: s.rank)
        self._export()
        reads = [n for s in self.stages if s.part for n in self.read_before(s)]
        self.layout = tuple(dict.fromkeys(reads))

    # ---- statements ------------------------------------------------------------------------

    def _number(self, function: str, own: Slices) -> None:
        """Give numbers to a function's statements, equal ones the same."""
        made: dict[str, int] = {}
        for part, assignments in _parts(own):
            for a in assignments:
                names = sorted(read_in(a.expr))
                of = tuple((n, made[n]) for n in names if n in made)
                statement = Statement(part, a, of)
                number = self.numbers.setdefault(statement.key, len(self.statements))
                if number == len(self.statements):
                    self.statements.append(statement)
                    self.kinds.append(self._kind(statement, names))
                    self.ready.append(ready(a.expr, self._known(of)))
                made[a.target.name] = number
                self.users.setdefault(number, set()).add(function)
        self.made[function] = made

    def _known(self, of: Iterable[tuple[str, int]]) -> dict[str, int]:
        return {name: self.ready[number] for name, number in of}

    def _kind(self, statement: Statement, names: Iterable[str]) -> frozenset[str]:
        """What it depends on: vectors, and values of legs' own inputs."""
        kind = set[str]().union(*(self.kinds[k] for _, k in statement.of))
        known = {n for n, _ in statement.of}
        for n in names:
            if n not in known and n in self.vectors:
                kind.add(self.vectors[n])
        return frozenset(kind)

    def _stages(self) -> dict[int, Stage]:
        """Stage of every statement that is in one."""
        found: dict[int, Stage] = {}
        stages: dict[tuple[str, frozenset[str], frozenset[str]], Stage] = {}
        count = Counter((s.part, frozenset(self.users[k])) for k, s in enumerate(self.statements))
        by_users = sorted(range(len(self.statements)), key=lambda k: -len(self.users[k]))
        taken = dict[tuple[Any, str], int]()
        for k in by_users:
            statement, users = self.statements[k], frozenset(self.users[k])
            # what it is made of has at least as many users, and has been placed
            whole = all(n in found and self._is_common(found[n]) for _, n in statement.of)
            common = len(users) >= _MANY and whole
            if not common and (len(users) < 2 or count[statement.part, users] < _FEW):
                continue
            key = (statement.part, self.kinds[k] if common else frozenset(),
                   frozenset() if common else users)  # fmt: skip
            place = (statement.part if common else key, statement.assignment.target.name)
            if taken.setdefault(place, k) != k:
                continue
            if not common and any(
                n not in found for _, n in statement.of if self.statements[n].part == statement.part
            ):
                continue
            stage = stages.setdefault(key, _stage(*key))
            found[k] = stage
        for k in sorted(found):
            found[k].numbers.append(k)
        for stage in stages.values():
            if not self._is_common(stage):
                # what reads the most first: then fewer values wait for their use
                stage.rank = (*stage.rank[:1], -len(self.known_in(stage)), stage.name)
        return found

    def _is_common(self, stage: Stage) -> bool:
        return stage.rank[0] < _PAIR // 2

    def _export(self) -> None:
        """Find what is read outside of a stage."""
        outside: set[int] = set()
        for k, statement in enumerate(self.statements):
            stage = self.stage_of.get(k)
            outside |= {
                n for _, n in statement.of if self.stage_of.get(n) is not stage or not stage
            }
        for name, own in self.parts.items():
            made = self.made[name]
            outside |= {made[n] for n in _ends(own) if n in made}
        for stage in self.stages:
            names = [
                self.statements[k].assignment.target.name for k in stage.numbers if k in outside
            ]
            stage.exported = names

    # ---- what is asked ---------------------------------------------------------------------

    def givers(self, part: str, given: object) -> frozenset[str]:
        """Functions whose legs of a type add this to a sum, or store it; "" for behind the legs."""
        return self._givers.get((part, given), frozenset())

    def _all_givers(self) -> dict[tuple[str, object], frozenset[str]]:
        found: dict[tuple[str, object], frozenset[str]] = {}
        for name, own in self.parts.items():
            for block in (*own.legs, *([own.after] if own.after else [])):
                for given in (*block.sums, *block.stores):
                    key = (block.leg_type, given)
                    found[key] = found.get(key, frozenset()) | {name}
        return found

    def read_before(self, stage: Stage) -> list[str]:
        """Names made before the legs that a stage over the legs reads, but for those of inputs."""
        of = [pair for k in stage.numbers for pair in self.statements[k].of]
        return list(dict.fromkeys(n for n, k in of if not self.statements[k].part))

    def assignments(self, stage: Stage) -> list[Assignment]:
        """Statements of a stage."""
        return [self.statements[k].assignment for k in stage.numbers]

    def known_in(self, stage: Stage) -> dict[str, int]:
        """Cycles until what a stage reads is known."""
        return self._known(pair for k in stage.numbers for pair in self.statements[k].of)

    def known(self, function: str) -> dict[str, int]:
        """The same for what a function makes, the sums over its legs and what follows these."""
        own, known = self.parts[function], self._known(self.made[function].items())
        for block in own.legs:
            for s in block.sums:
                wait = ready(s.expr, known)
                known[s.target.name] = max(known.get(s.target.name, 0), wait)
        return ready_after(own.after.assignments if own.after else (), known)

    def used(self, function: str, part: str) -> list[Stage]:
        """Stages that a part of a function runs, in order."""
        made = self.made[function]
        wanted = [self.stage_of[k] for k in made.values() if k in self.stage_of]
        if not part:
            later = (s for s in [*wanted] if s.part)
            wanted += [
                self.stage_of[k] for s in self.with_what_they_need(later) for k in self._before(s)
            ]
        return self.with_what_they_need(s for s in wanted if s.part == part)

    def _before(self, stage: Stage) -> list[int]:
        of = [n for k in stage.numbers for _, n in self.statements[k].of]
        return [n for n in of if not self.statements[n].part and n in self.stage_of]

    def with_what_they_need(self, stages: Iterable[Stage]) -> list[Stage]:
        """Stages with those that they need, of the same part."""
        found: dict[int, Stage] = {}
        waiting = list(stages)
        while waiting:
            stage = waiting.pop()
            if id(stage) in found:
                continue
            found[id(stage)] = stage
            of = {n for k in stage.numbers for _, n in self.statements[k].of}
            needed = {id(s): s for n in of if (s := self.stage_of.get(n))}
            waiting += [s for s in needed.values() if s.part == stage.part]
        return sorted(found.values(), key=lambda s: s.rank)

    def own(self, function: str, assignments: Sequence[Assignment]) -> list[Assignment]:
        """Statements that a function makes itself; names of inputs are none."""
        made = self.made[function]
        rest = (a for a in assignments if made.get(a.target.name, -1) not in self.stage_of)
        return [a for a in rest if a.target.name not in self.aliases]

    def members(self, function: str, part: str) -> set[str]:
        """Names whose values a function has from stages of a part."""
        numbers = {k for k, s in self.stage_of.items() if s.part == part}
        own = {n for n, k in self.made[function].items() if k in numbers}
        others = {n for s in self.used(function, part) for n in s.exported}
        return own | (others - set(self.made[function]))

    def sums(self, function: str) -> list[str]:
        """Sums over the legs, together those that the same functions have."""
        own = self.parts[function].sums
        users = {n: frozenset(f for f, p in self.parts.items() if n in p.sums) for n in own}
        order = list(dict.fromkeys(users.values()))
        return sorted(own, key=lambda n: order.index(users[n]))

    def passed(self, function: str) -> list[str]:
        """Names made before the legs that later parts read; what stages read has a fixed place."""
        own = self.parts[function]
        used = [s for leg in own.legs for s in self.used(function, leg.leg_type)]
        read = {n for s in used for n in self.read_before(s)}
        after = symbols(own.after)
        kept = [n for n in own.passed if n not in self.aliases or n in after]
        return [*self.layout, *(n for n in kept if n not in self.layout)] if read else kept

    def stored(self, function: str) -> set[str]:
        """Those of them that the function has."""
        return self._read_by_stages(function) | set(self.parts[function].passed)

    def read_by_legs(self, function: str) -> set[str]:
        """Those of them that the legs read."""
        legs = self.parts[function].legs
        return self._read_by_stages(function).union(*map(symbols, legs))

    def _read_by_stages(self, function: str) -> set[str]:
        legs = self.parts[function].legs
        used = [s for leg in legs for s in self.used(function, leg.leg_type)]
        return {n for s in used for n in self.read_before(s)}


_PAIR = 100


def _stage(part: str, kind: frozenset[str], users: frozenset[str]) -> Stage:
    words = sorted(users or kind or {"model"})
    rank = _PAIR - len(users) if users else len(kind)
    name = "_".join(["stage", *([part] if part else []), *words])
    return Stage(name, part, (rank, 0, name))


def aliases(function: Function) -> dict[str, str]:
    """Names of entries of inputs -> the entry, such as V_0."""
    return {
        a.target.name: a.expr.name
        for a in function.unpack
        if a.expr.is_Symbol and a.expr.name.rpartition("_")[0] in function.inputs
    }


def _vectors(functions: Iterable[Function]) -> dict[str, str]:
    """Names of entries of input vectors, and of inputs of legs -> the vector."""
    found: dict[str, str] = {}
    for f in functions:
        for a in f.unpack:
            for n in [s.name for s in a.expr.free_symbols]:
                if n.rpartition("_")[0] in f.inputs:
                    found[n] = n.rpartition("_")[0]
        found |= {n: found[e] for n, e in aliases(f).items()}
        found |= {i.symbol.name: i.vector for own in f.leg_inputs.values() for i in own}
    return found


def _parts(own: Slices) -> list[tuple[str, tuple[Assignment, ...]]]:
    """Assignments before the legs, and over the legs of each type, without names of inputs."""
    named = aliases(own.function)
    first = own.before.assignments if own.before else ()
    unpack = tuple(a for a in own.function.unpack if a.target.name not in named)
    return [("", unpack + first), *((b.leg_type, b.assignments) for b in own.legs)]


def _ends(own: Slices) -> set[str]:
    """Names that are read by others than assignments, or behind the legs."""
    ends = (end for block in (own.before, *own.legs) if block for end in block.ends)
    return read_by((*own.function.unpack_checks, *ends)) | symbols(own.after)
