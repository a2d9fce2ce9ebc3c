"""Stages in C: the structures of shared values, and the routines that compute them."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_stages import Shared, Stage, Stages
from pne_sym.backends.c_statements import entries, leg_input, statements, vector_name
from pne_sym.backends.c_text import Routine, c_name, indented, listing


def stage_routine(bundle: Bundle, stages: Stages, stage: Stage) -> Routine:
    """A stage as a routine, which leaves in v what others read."""
    tables: list[str] = []
    program, part = bundle.program, stage.part
    at = "j" if part else "k"
    own = stages.assignments(stage)
    made = {a.target.name for a in own}
    loads = {n: f"s[{k}*w + j]" for k, n in enumerate(stages.layout) if part}
    users = [p.function for p in stages.parts.values()]
    for function in users:
        loads = entries(bundle, function, at) | loads
        for item in function.leg_inputs.get(part, ()):
            name = item.symbol.name
            if name not in loads and any(item.symbol in a.expr.free_symbols for a in own):
                loads[name] = leg_input(bundle, item, part, tables)
    prepared = {
        n: f"m->{c_name(n)}{'[i]' * bool(of)}"
        for n, of in program.prepared
        if of in ("", part) and n not in made
    }
    known = {n for other in stages.stages for n in other.exported if other.part == part} - made
    loads = {n: text for n, text in loads.items() if n not in made | known}
    shared = Shared(known.union(stage.exported), "v->", prepared, stages.known_in(stage))
    lines = statements(own, shared, loads)
    vectors = dict.fromkeys(v for f in users for v in f.inputs)
    parameters = [
        "const prepared *m",
        *(f"size_t {n}" for n in ("w", "i", at)),
        "const real *s",
        *(f"const real *{vector_name(v)}" for v in vectors),
        f"values{'_' * bool(part)}{part} *v",
    ]
    return Routine.of(stage.name, parameters, [*tables, *lines])


def stage_texts(bundle: Bundle, stages: Stages) -> list[str]:
    """The structures of shared values, and the routines of the stages."""
    texts = []
    for part in dict.fromkeys(s.part for s in stages.stages):
        own = [s for s in stages.stages if s.part == part]
        members = dict.fromkeys(c_name(n) for s in own for n in s.exported)
        lines = listing("real ", list(members), ";", "    ")
        name = f"values{'_' * bool(part)}{part};"
        texts.append("\n".join(["typedef struct {", *indented(lines), f"}} {name}"]))
        texts += ["\n".join(stage_routine(bundle, stages, s).definition()) for s in own]
    return texts
