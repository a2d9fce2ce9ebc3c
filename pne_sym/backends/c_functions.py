"""C code of the program's functions: structures, parts, and what runs the parts."""

from __future__ import annotations

from math import prod

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_parts import Parts, vector_name
from pne_sym.backends.c_text import Routine, comment, indented, listing
from pne_sym.program.count import count_function
from pne_sym.program.ir import Block, Function

LANES = 8


def function_text(bundle: Bundle, function: Function) -> tuple[str, Routine]:
    """The text of a function of the program, and the routine that runs it."""
    return _FunctionWriter(bundle, function).text()


class _FunctionWriter:
    def __init__(self, bundle: Bundle, function: Function) -> None:
        self.bundle = bundle
        self.f = function
        self.name = function.name
        self.parts = Parts(bundle, function)
        self.before = self.parts.before()
        self.legs = [(b, self.parts.over(b), self.parts.place(b)) for b in self.parts.legs]
        self.after = self.parts.after() if self.parts.last else None

    def text(self) -> tuple[str, Routine]:
        """All routines, each after what it calls."""
        n = count_function(self.f, self.bundle.leg_counts)
        lines = comment(
            f"---- {self.name}: {n.mul} mul, {n.add} add, {n.div} div, {n.sqrt} sqrt, "
            f"{n.trig} trig, every leg counted ----"
        )
        lines += [*self._structures(), "", *self.before.definition(), ""]
        for _, over, place in self.legs:
            lines += [*over.definition(), "", *place.definition(), ""]
        if self.after:
            lines += [*self.after.definition(), ""]
        run = self._run()
        return "\n".join([*lines, *run.definition()]), run

    def _structures(self) -> list[str]:
        """What passes from part to part, and what the legs give."""
        fields = [f"{n}[LANES]" for n in self.parts.passed_fields()]
        if self.parts.sums:
            fields.append(f"sum[{len(self.parts.sums)}][LANES]")
        lines = _structure(f"{self.name}_values", fields or ["none[1]"])
        for block in self.parts.legs:
            width = max(LANES, self.bundle.leg_counts[block.leg_type])
            lines += _structure(
                f"{self.name}_results_{block.leg_type}", self.parts.results(block, width)
            )
        return lines

    # ---- what runs the parts -------------------------------------------------------------

    def _run(self) -> Routine:
        """The parts one after another, for one state or for as many as there are lanes."""
        body = [
            f"clear({a}, {prod(self.bundle.program.shapes[a])}*w);"
            for a in self.f.arrays
            if not self.parts.is_full(a)
        ]
        body.append(self.before.call())
        for block, over, place in self.legs:
            body += self._run_legs(block, over, place)
        if self.after:
            body.append(self.after.call())
        head = [f"{self.name}_results_{b.leg_type} results_{b.leg_type};" for b in self.parts.legs]
        parameters = [
            "const prepared *m",
            "size_t w",
            *(f"const real *{vector_name(v)}" for v in self.f.inputs),
            *(f"real *{a}" for a in self.f.arrays),
            "verdict *t",
        ]
        routine = Routine.of(f"{self.name}_run", parameters, [*head, *body])
        if any(p.endswith(" *s") for r in (self.before, self.after) if r for p in r.parameters):
            head.insert(0, f"{self.name}_values values, *const s = &values;")
        return Routine(routine.name, routine.parameters, (*head, *body))

    def _run_legs(self, block: Block, over: Routine, place: Routine) -> list[str]:
        count = self.bundle.leg_counts[block.leg_type]
        results = {"o": f"&results_{block.leg_type}"}
        each = f"for (size_t leg = 0; leg < {count}; ++leg) {{"
        legs = {"leg": "0", "legs": "1", "states": "0", "count": str(count), "add": "0"}
        states = {"legs": "0", "states": "1", "count": "w", "add": "1"}
        return [
            "if (w == 1) {  /* the legs side by side */",
            *indented(self._clear_sums(block) if len(block.sums) == 1 else []),
            f"    {over.call_with(results | legs)}",
            f"    {each}",
            f"        {place.call_with({**results, 'first': 'leg'})}",
            "    }",
            *indented(self._sums(block, f"total({{}}, {count})", states="1")),
            "} else {  /* the states side by side */",
            *indented(self._clear_sums(block)),
            f"    {each}",
            f"        {over.call_with(results | states)}",
            f"        {place.call_with({**results, 'first': '0'})}",
            "    }",
            *indented(self._sums(block, "{}[k]", states="w")),
            "}",
        ]

    def _clear_sums(self, block: Block) -> list[str]:
        """Zeros; a single sum has them for one state too, where gcc's analyzer misses the legs'."""
        sums = f"results_{block.leg_type}.sum"
        return [f"memset({sums}, 0, sizeof {sums});"] if block.sums else []

    def _sums(self, block: Block, source: str, states: str) -> list[str]:
        """Sums over the legs, put where the last part finds them."""
        if not block.sums:
            return []
        first = self.parts.sums.index(str(block.sums[0][0]))
        target = f"s->sum[{first} + n][k]" if first else "s->sum[n][k]"
        return [
            f"for (size_t n = 0; n < {len(block.sums)}; ++n) {{",
            f"    for (size_t k = 0; k < {states}; ++k) {{",
            f"        {target} = {source.format(f'results_{block.leg_type}.sum[n]')};",
            "    }",
            "}",
        ]


def _structure(name: str, fields: list[str]) -> list[str]:
    return ["typedef struct {", *indented(listing("real ", fields, ";")), f"}} {name};"]
