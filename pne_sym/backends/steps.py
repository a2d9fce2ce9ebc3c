"""Steps of public functions as text, and words on what users call, for printers of any language."""

from __future__ import annotations

import inspect
import json
from collections.abc import Mapping

from pne_sym.backends.straight import places
from pne_sym.program.ir import Program
from pne_sym.program.operations import OPERATIONS
from pne_sym.program.public import Apply, Argument, Default, PublicFunction, Run, Search, Step

COMMON = {"add": "{0} + {1}", "subtract": "{0} - {1}", "same": "{0}", "negative": "-{0}"}
"""Operations that are the same expressions in all languages."""


class Citations:
    """Ids of relations between arrays, in comments above their steps.

    A loop has the comment inside, and an empty line stands behind what has none to end it: as
    `backends.target.Syntax` finds statements.

    Args:
        program: has the relations.
        comment: a comment in the language, with {} for its text.
    """

    def __init__(self, program: Program, comment: str) -> None:
        self.titles = {r.id: r.title for r in program.relations}
        self.comment = comment
        self.told = self.open = ""  # the relation that was told last, and that of the next line

    def lines(self, step: Step, lines: list[str]) -> list[str]:
        """Lines of a step, with what is to be said before them."""
        id_ = step.equation if isinstance(step, Apply) and lines else ""
        ends = self.end() if id_ != self.open else []
        if not id_:
            return [*ends, *lines]
        begun = next((k for k, line in enumerate(lines, 1) if line.startswith("for (")), 0)
        said = []
        if begun or id_ != self.open:
            title = f" {self.titles[id_]}" if id_ != self.told else ""
            said = ["    " * bool(begun) + self.comment.format(f"({id_}){title}")]
        self.told, self.open = id_, "" if begun else id_
        return [*([] if begun else ends), *lines[:begun], *said, *lines[begun:]]

    def end(self) -> list[str]:
        """What ends the statements of a relation that is open."""
        found = [""] * bool(self.open)
        self.open = ""
        return found


class StepText:
    """Writes steps, in the forms of a language: texts with the parts in braces, a line each.

    Attributes:
        expressions: operations that are more than a call, by name: {0}, {1} ... are the operands,
            {n} and {numbers} what is fixed, {count} how many numbers, {targets} the results, {rest}
            by how many entries the first of them has more than the first operand.
        call: all others, of {name} and {operands}; what is fixed comes last.
        apply: {targets} get the {value}.
        several: more than one of them.
        made: behind that for each {target}, with its status {code} where it is not finite.
        known: what is finite where an {target} is a number or infinite.
        run: {each} result of a {function} at {inputs}, which calls them {arrays}; {comma} where it
            is one.
        alone: stands for inputs where there are none.
        search: {target} from {start}, of a {residual} and its {slope}, which take {given} and
            {guess} behind the pose, with commas before them; with {halving} of steps or without.
        closing: finds the displacements q.
        first: where arrays begin to count.
        comment: a comment, with {} for its text.
    """

    expressions: Mapping[str, str]
    call: str
    apply: str
    several = "{}"
    made = ""
    known = "{}"
    run: str
    alone = ""
    search: str
    closing: str
    first = 0
    comment: str

    def __init__(self, program: Program) -> None:
        self.program = program
        self.functions = {f.name: f for f in program.public}

    def lines(self, function: PublicFunction) -> list[str]:
        """The steps in order; displacements are closed before the first one that reads them."""
        lines: list[str] = []
        closed = False
        cited = Citations(self.program, self.comment)
        for step in function.steps:
            if isinstance(step, Run) and not closed:
                closed = "q" in self.program.functions[step.function].inputs
                lines += [self.closing] if closed else []
            lines += cited.lines(step, self._step(step))
        return [*lines, *cited.end()]

    def others(self, name: str) -> str:
        """Inputs of a public function behind the pose, with commas before them."""
        return "".join(f", {a.name}" for a in self.functions[name].inputs if a.name != "X")

    def _step(self, step: Step) -> list[str]:
        if isinstance(step, Run):
            found = [target.name for target in step.targets]
            function = self.program.functions[step.function]
            text = self.run.format(
                each=", ".join(found),
                comma="," * (len(found) == 1),
                function=self.called(step.function),
                inputs=", ".join(function.inputs) or self.alone,
                arrays=json.dumps(function.arrays),
            )
            return [text]
        if isinstance(step, Search):
            text = self.search.format(
                target=step.targets[0].name,
                start=step.operands[0].name,
                residual=step.residual,
                slope=step.slope,
                given=self.others(step.residual),
                guess=self.others(step.slope),
                halving=step.halving,
            )
            return [text]
        targets = ", ".join(target.name for target in step.targets)
        targets = targets if len(step.targets) == 1 else self.several.format(targets)
        lines = [self.apply.format(targets=targets, value=self.applied(step))]
        operation = OPERATIONS[step.operation]
        code, known = int(operation.status), self.known if operation.unbounded else "{}"
        names = (known.format(target.name) for target in step.targets)
        made = (self.made.format(target=name, code=code) for name in names)
        return lines + [line for line in made if line and code]

    def called(self, function: str) -> str:
        """A function of the program where it is run."""
        return function

    def numbers(self, step: Apply) -> str:
        """What is fixed."""
        return places(step.numbers, self.first)

    def applied(self, step: Apply) -> str:
        """An operation at its operands."""
        operands, first = [operand.name for operand in step.operands], step.targets[0]
        numbers = self.numbers(step)
        form = {**COMMON, **self.expressions}.get(step.operation, self.call)
        takes = inspect.signature(OPERATIONS[step.operation].compute).parameters
        return form.format(
            *operands,
            name=step.operation,
            operands=", ".join([*operands, *([numbers] if "numbers" in takes else [])]),
            numbers=numbers,
            n=(*step.numbers, 0)[0],
            count=len(step.numbers),
            targets=", ".join(target.name for target in step.targets),
            rest=first.size - (step.operands[0].size if step.operands else 0),
        )


def described(name: str, argument: Argument, shape: str, home: str = "HOME_Q") -> str:
    """Words on an argument or a result.

    Args:
        name: under which users know it.
        argument: what it is.
        shape: in the language.
        home: what the language calls the displacements at home.
    """
    meaning = f"{name}: {argument.meaning}"
    if argument.default and "by default" not in meaning:
        words = {Default.ZEROS: "zero", Default.ONES: "one", Default.REST: "at rest"}
        default = words.get(argument.default, home)
        meaning += f", by default {default}"
    return f"{meaning} ({shape})."
