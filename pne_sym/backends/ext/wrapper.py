"""The functions of Python in C: tables of the arguments, calls of the generated functions."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import field_views
from pne_sym.backends.ext.header import Entry
from pne_sym.backends.ext.public import Bindings
from pne_sym.backends.python_public import takes_rotation
from pne_sym.backends.templating import render
from pne_sym.program.public import Argument, PublicFunction


def wrapper_text(bundle: Bundle, bindings: Bindings) -> str:
    """NAME_ext.c: a Python module over NAME.h."""
    bound = bindings.bound
    return render(
        "ext/wrapper.c.jinja",
        name=bundle.name,
        fields=[f.name for f in field_views(bundle)],
        functions=[_function(f, entry) for f, entry in bound],
        inputs=max(len(entry.inputs) for _, entry in bound),
        outputs=max(len(entry.outputs) for _, entry in bound),
    )


def _function(f: PublicFunction, entry: Entry) -> dict[str, object]:
    """What the template prints of a function of C."""
    inputs = {a.name: a for a in f.inputs}
    arrays = [f"in[{k}]" for k in range(len(entry.inputs))]
    arrays += [f"out[{k}]" for k in range(len(entry.outputs))]
    return {
        "name": entry.name,
        "has_model": entry.has_model,
        "facts": ", ".join(
            str(int(fact))
            for fact in (
                entry.has_model,
                f.gives_status,
                takes_rotation(f),
                len(entry.inputs),
                len(entry.outputs),
            )
        ),
        "inputs": ", ".join(_array(inputs[name]) for name in entry.inputs),
        "outputs": ", ".join(_array(output) for output in f.outputs),
        "arrays": ", ".join(arrays),
    }


def _array(a: Argument) -> str:
    """Initialiser of what is known of an array."""
    shape = ", ".join(map(str, a.value.shape)) or "0"
    optional = a.default is not None or a.value.size == 0
    return f"{{{len(a.value.shape)}, {{{shape}}}, {int(optional)}, {int(a.positive)}}}"
