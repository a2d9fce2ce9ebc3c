"""Text of the public functions of the C module: prototypes, single and batch definitions."""

from __future__ import annotations

from math import prod

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_api import Api
from pne_sym.backends.c_text import Routine, comment, indented, listing, parameter_name


class ApiWriter:
    """Prints a public function."""

    def __init__(self, prefix: str, api: Api) -> None:
        self.prefix = prefix
        self.api = api
        self.real = f"{prefix}_real"

    def head(self, *, batch: bool) -> list[str]:
        """Return type, name, parameters."""
        a, p = self.api, self.prefix
        parameters = [f"const {p}_model *model"] * a.has_model + ["size_t n"] * batch
        parameters += [f"const {self.real} *{i.name}" for i in a.inputs]
        parameters += [f"{self.real} *{o.name}" for o in a.outputs]
        parameters += ["int *status"] * batch
        kind = "size_t" if batch else "int"
        return listing(f"{kind} {p}_{a.name}{'_batch' if batch else ''}(", parameters, ")")

    def prototypes(self) -> list[str]:
        """Comment and both prototypes."""
        a = self.api
        shapes = (", ".join(i.text for i in a.inputs), ", ".join(o.text for o in a.outputs))
        lines = comment(f"{a.meaning}  In: {shapes[0]}.  Out: {shapes[1]}.")
        for batch in (False, True):
            head = self.head(batch=batch)
            lines += [*head[:-1], f"{head[-1]};"]
        return lines

    def definitions(self) -> list[str]:
        """Definition of the batch, and of the single function where it runs lanes of one."""
        single = self._single() if self.api.lanes else []
        return [*single, *self._batch()]

    def _arguments(self, count: str = "") -> list[str]:
        """Arguments of a call, at the state with number `count`."""
        found = []
        for argument in (*self.api.inputs, *self.api.outputs):
            at = f"{argument.name} + {argument.size}*{count}" if count else argument.name
            found.append(f"{argument.name} ? {at} : NULL" if argument.optional and count else at)
        return found

    def _call(self, function: str, arguments: list[str]) -> list[str]:
        return listing(f"{function}(", arguments, ");")

    def _single(self) -> list[str]:
        a = self.api
        model = ["model"] * a.has_model
        return [
            *self.head(batch=False),
            "{",
            "    int code;",
            *indented(self._call(f"{a.name}_any", [*model, "1", *self._arguments(), "&code"])),
            "    return code;",
            "}",
            "",
        ]

    def _batch(self) -> list[str]:
        a = self.api
        model = ["model"] * a.has_model
        call = self._call(
            f"const int code = {self.prefix}_{a.name}", [*model, *self._arguments("i")]
        )
        lines = [
            *self.head(batch=True),
            "{",
            f"    size_t failed = 0{';' if not a.lanes else ', i = 0;'}",
        ]
        if a.lanes:
            lanes = self._call(f"{a.name}_any", [*model, "LANES", *self._arguments("i"), "codes"])
            again = self._call(
                f"codes[k] = {self.prefix}_{a.name}", [*model, *self._arguments("(i + k)")]
            )
            lines += [
                "    for (; i + LANES <= n; i += LANES) {",
                "        int codes[LANES];",
                *indented(lanes, 2),
                "        for (size_t k = 0; k < LANES; ++k) {",
                f"            if (codes[k] != {self.prefix.upper()}_OK) {{",
                *indented(again, 4),
                "            }",
                "        }",
                "        failed += record(codes, LANES, status ? status + i : NULL);",
                "    }",
            ]
        start = "; i < n" if a.lanes else "size_t i = 0; i < n"
        return [
            *lines,
            f"    for ({start}; ++i) {{",
            *indented(call, 2),
            "        failed += record(&code, 1, status ? status + i : NULL);",
            "    }",
            "    return failed;",
            "}",
        ]

    def any(self, bundle: Bundle, run: Routine) -> list[str]:
        """The outputs of one state, or of several side by side, from a function of the program."""
        a, function = self.api, bundle.program.functions[self.api.name]
        sizes = {n: prod(bundle.program.shapes[n]) for n in function.arrays}
        taken = [i for i in a.inputs if i.name != "q0"]
        buffers = [f"{i.name}_in[{i.size}*LANES]" for i in taken]
        if "q" in function.inputs:
            buffers.append(f"joints[{bundle.coordinates.sizes['NJ']}*LANES]")
        buffers += [f"{n}_of[{size}*LANES]" for n, size in sizes.items()]
        body = [
            *listing("real ", buffers, ";"),
            "verdict values, *const t = &values;",
            "start(w, t);",
        ]
        body += [f"{i.name} = take({i.size}, w, {i.name}, {i.name}_in, t);" for i in taken]
        if "q" in function.inputs:
            body.append("close_loops(m, w, X, q0, joints, t);")
        elif len(taken) < len(a.inputs):
            body.append("(void)q0;")
        if "q" not in function.inputs and "m" not in map(parameter_name, run.parameters):
            body.append("(void)m;")
        body.append(run.call_with({n: f"{n}_of" for n in sizes}))
        body += [f"check({sizes[n]}, w, {n}_of, t->overflow);" for n in a.arrays]
        body.append("judge(t, w, code);")
        body += [
            f"deliver({n}_of, {o.size}, w, code, {o.name});"
            for n, o in zip(a.arrays, a.outputs, strict=True)
        ]
        parameters = [
            "const prepared *m",
            "size_t w",
            *(f"const real *{i.name}" for i in a.inputs),
            *(f"real *{o.name}" for o in a.outputs),
            "int *code",
        ]
        return [*listing(f"INLINE void {a.name}_any(", parameters, ")"), "{", *indented(body), "}"]
