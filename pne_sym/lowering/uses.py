"""How many equations use a quantity, of those that outputs need."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from pne_sym.derivation import Equation, Output, names_in


def uses(definition: Mapping[str, Equation], outputs: Iterable[Output]) -> Counter[str]:
    """By name, how many equations and outputs have it on their right-hand side."""
    stack = [name for output in outputs for name in sorted(names_in(output.value))]
    found = Counter(stack)
    seen: set[str] = set()
    while stack:
        name = stack.pop()
        if name in definition and name not in seen:
            seen.add(name)
            used = sorted(names_in(definition[name].rhs))
            found.update(used)
            stack += used
    return found
