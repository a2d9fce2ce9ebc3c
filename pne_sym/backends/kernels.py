"""Kernels: operations that are defined once, as methods on arrays whose states come last.

The definitions in templates/kernels are Python of the array-API standard, as it is printed by the
array-API back end; here they are read and said in another language.  They assign, call and return:
no branches, no writing in place; `self.repeat` is the one loop.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from functools import cache
from typing import ClassVar

from pne_sym.backends.templating import render

_OPERATORS: dict[type[ast.AST], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.USub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.BitAnd: "&",
    ast.BitOr: "|",
    ast.Invert: "~",
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
}
_FILES = tuple(f"kernels/{name}.py.jinja" for name in ("vectors", "quaternions", "bounds"))


def texts(quaternion_at: int | None) -> list[str]:
    """The definitions in templates/kernels, for poses with a quaternion at this place, or none."""
    return [render(name, d={"quaternion_at": quaternion_at}) for name in _FILES]


@cache
def kernels(quaternion_at: int | None = None) -> list[ast.FunctionDef]:
    """The same, read."""
    (holder,) = ast.parse(f"class Kernels:\n{''.join(texts(quaternion_at))}").body
    assert isinstance(holder, ast.ClassDef)
    return [f for f in holder.body if isinstance(f, ast.FunctionDef)]


class KernelText:
    """Writes the lines of a definition, in the forms of a language.

    Attributes:
        operators: those that are written otherwise than in Python.
        calls: functions, methods and constants by name; {0}, {1} ... are operands.
        other: all other methods, of {name} and {operands}, {count} in number; {f} stands for what
            precedes own names.
        entries: entries {first} to {last} of {array}; end: what stands for the last one;
        column: column {k} of a matrix.
        assign: {targets}, one or several, get a {value}; several: more than one of them;
        tuple_of: several values at once; ignored: a target that nobody reads.
        repeat: lines of the loop, of a {name}, its {state}, {going} (the first of that), {count},
            {fixed}.
    """

    operators: ClassVar[Mapping[str, str]]
    calls: ClassVar[Mapping[str, str]]
    other: str
    entries: str
    end: str
    column: str
    assign: str
    several: str
    tuple_of: str
    ignored: str
    repeat: tuple[str, ...]

    def __init__(self, prefix: str) -> None:
        self.prefix = prefix

    def lines(self, function: ast.FunctionDef) -> list[str]:
        """The statements behind the docstring, but for what is returned."""
        statements = [s for s in function.body if isinstance(s, ast.Assign)]
        return [line for s in statements for line in self._assigned(s)]

    def results(self, function: ast.FunctionDef) -> list[str]:
        """What is returned."""
        returned = function.body[-1]
        assert isinstance(returned, ast.Return)
        value = returned.value
        return [self.of(e) for e in (value.elts if isinstance(value, ast.Tuple) else [value]) if e]

    def words(self, function: ast.FunctionDef) -> list[str]:
        """What it is."""
        return [line for line in (ast.get_docstring(function) or "").splitlines() if line]

    def _assigned(self, statement: ast.Assign) -> list[str]:
        (target,), value = statement.targets, statement.value
        if ast.unparse(value) == "self.xp":
            return []
        several = isinstance(target, ast.Tuple)
        names = [self.of(t) for t in (target.elts if isinstance(target, ast.Tuple) else [target])]
        written = [self.ignored if name == "_" else name for name in names]
        left = self.several.format(", ".join(written)) if several else names[0]
        if ast.unparse(value).startswith("self.repeat("):
            return self._repeated(left, value)
        return [self.assign.format(targets=left, value=self.of(value))]

    def _repeated(self, left: str, call: ast.expr) -> list[str]:
        """The loop: a carry that a method makes of itself and of what is fixed."""
        assert isinstance(call, ast.Call)
        method, begin, count, fixed = call.args
        state = [f"at_{k}" for k in range(len(begin.elts))] if isinstance(begin, ast.Tuple) else []
        parts = {
            "name": method.attr if isinstance(method, ast.Attribute) else "",
            "state": ", ".join(state),
            "going": state[0],
            "count": self.of(count),
            "fixed": self._joined(fixed),
            "f": self.prefix,
        }
        both = self.several.format(parts["state"])
        lines = [self.assign.format(targets=both, value=self.of(begin))]
        lines += [line.format(**parts) for line in self.repeat]
        return [
            *lines,
            self.assign.format(targets=left, value=self.tuple_of.format(parts["state"])),
        ]

    def _joined(self, values: ast.expr) -> str:
        assert isinstance(values, ast.Tuple)
        return ", ".join(map(self.of, values.elts))

    def of(self, e: ast.expr) -> str:
        """An expression."""
        match e:
            case ast.BinOp():
                return f"{self._part(e.left)} {self._sign(e.op)} {self._part(e.right)}"
            case ast.Compare():
                return f"{self._part(e.left)} {self._sign(e.ops[0])} {self._part(e.comparators[0])}"
            case ast.UnaryOp():
                return f"{self._sign(e.op)}{self._part(e.operand)}"
            case ast.Tuple():
                return self.tuple_of.format(self._joined(e))
            case ast.Call():
                return self._called(e)
            case ast.Subscript():
                return self._entries(e)
            case ast.Attribute():
                return self.calls[e.attr]
            case ast.Constant():
                return repr(e.value)
        assert isinstance(e, ast.Name), ast.dump(e)
        return e.id

    def _part(self, e: ast.expr) -> str:
        """A part of an expression, in brackets if it is one itself."""
        text = self.of(e)
        return f"({text})" if isinstance(e, ast.BinOp | ast.Compare | ast.UnaryOp) else text

    def _sign(self, operator: ast.AST) -> str:
        sign = _OPERATORS[type(operator)]
        return self.operators.get(sign, sign)

    def _called(self, e: ast.Call) -> str:
        name = e.func.attr if isinstance(e.func, ast.Attribute) else ast.unparse(e.func)
        parts = (a.elts if isinstance(a, ast.Tuple) else [a] for a in e.args)
        operands = [self.of(a) for part in parts for a in part if ast.unparse(a) != "xp"]
        form = self.calls.get(name, self.other)
        facts = {"name": name, "operands": ", ".join(operands), "count": len(operands)}
        return form.format(*operands, **facts, f=self.prefix)

    def _entries(self, e: ast.Subscript) -> str:
        """Rows of an array, all states; a column; a length."""
        if isinstance(e.value, ast.Attribute):
            return self.calls["length"].format(self.of(e.value.value))
        assert isinstance(e.slice, ast.Tuple)
        rows, array = e.slice.elts[0], self.of(e.value)
        if isinstance(e.slice.elts[1], ast.Constant) and e.slice.elts[1].value is not ...:
            return self.column.format(array=array, k=ast.literal_eval(e.slice.elts[1]) + 1)
        if isinstance(rows, ast.Slice):
            first, last = (ast.literal_eval(x) if x else None for x in (rows.lower, rows.upper))
            last = self.end if last is None else last
            return self.entries.format(array=array, first=(first or 0) + 1, last=last)
        k = ast.literal_eval(rows)
        at = self.end if k < 0 else k + 1
        return self.entries.format(array=array, first=at, last=at)
