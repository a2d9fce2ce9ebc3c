"""What can be called of a generated C file: its header's prototypes, which are its interface."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """A function of C, for a state and for a batch.

    Attributes:
        name: without the model's prefix.
        has_model: whether the prepared model is its first argument.
        inputs, outputs: names of arrays, in order.
    """

    name: str
    has_model: bool
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def entries(header: str, model: str) -> dict[str, Entry]:
    """Functions that a header declares for a state and for a batch, by name.

    >>> entries('''
    ... int robot_Z(const robot_model *model, const robot_real *X,
    ...     robot_real *Z);
    ... size_t robot_Z_batch(const robot_model *model, size_t n,
    ... ''', "robot")
    {'Z': Entry(name='Z', has_model=True, inputs=('X',), outputs=('Z',))}
    """
    found = {}
    for name, text in re.findall(rf"^int {model}_(\w+)\(([^)]*)\);", header, re.MULTILINE):
        if not re.search(rf"^size_t {model}_{name}_batch\(", header, re.MULTILINE):
            continue
        arguments = [" ".join(a.split()) for a in text.split(",")]
        has_model = arguments[0] == f"const {model}_model *model"
        arrays = [(a.startswith("const "), a.rpartition("*")[2]) for a in arguments[has_model:]]
        inputs = tuple(array for is_input, array in arrays if is_input)
        outputs = tuple(array for is_input, array in arrays if not is_input)
        found[name] = Entry(name, has_model, inputs, outputs)
    return found
