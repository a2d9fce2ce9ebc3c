"""The extension back end: the generated C as a Python module with the functions of NAME.py."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.c_backend import CBackend
from pne_sym.backends.c_public import CFunction
from pne_sym.backends.describe import field_views
from pne_sym.backends.ext.public import Bindings
from pne_sym.backends.python_public import module_facts, takes_rotation
from pne_sym.backends.templating import render
from pne_sym.program.public import Argument


class ExtBackend:
    """Emits NAME_ext.py, which holds the text of NAME.c and NAME.h."""

    operations = CBackend.operations

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text."""
        c = CBackend().emit(bundle)
        header, source = f"{bundle.name}.h", f"{bundle.name}.c"
        bindings = Bindings(bundle)
        wrapper = _wrapper(bundle, bindings)
        files = ((header, c[header]), (source, c[source]), (f"{bundle.name}_ext.c", wrapper))
        assert not any('"""' in text for _, text in files)
        text = render(
            "ext/module.py.jinja",
            **module_facts(bundle),
            rotates=any(map(takes_rotation, bindings.public)),
            measures=any(map(bindings.is_completed, bindings.public)),
            entries=[bindings.row(f) for f in bindings.public],
            public=[bindings.text(f) for f in bindings.public],
            files=files,
        )
        return {f"{bundle.name}_ext.py": text}


def _wrapper(bundle: Bundle, bindings: Bindings) -> str:
    """NAME_ext.c: the functions of Python in C, with tables of their arguments, over NAME.h."""
    bound = bindings.bound
    return render(
        "ext/wrapper.c.jinja",
        name=bundle.name,
        fields=[f.name for f in field_views(bundle)],
        functions=[_function(c) for c in bound],
        inputs=max(len(c.inputs) for c in bound),
        outputs=max(len(c.outputs) for c in bound),
    )


def _function(c: CFunction) -> dict[str, object]:
    """What the template prints of a function of C."""
    of = {a.name: a for a in c.of.inputs}
    sizes = (len(c.inputs), len(c.outputs))
    arrays = [f"{way}[{k}]" for way, n in zip(("in", "out"), sizes, strict=True) for k in range(n)]
    facts = (c.has_model, c.of.gives_status, takes_rotation(c.of), *sizes)
    return {
        "name": c.name,
        "has_model": c.has_model,
        "facts": ", ".join(str(int(fact)) for fact in facts),
        "inputs": ", ".join(_array(of[i.name]) for i in c.inputs),
        "outputs": ", ".join(map(_array, c.of.outputs)),
        "arrays": ", ".join(arrays),
    }


def _array(a: Argument) -> str:
    """Initialiser of what is known of an array."""
    shape = ", ".join(map(str, a.value.shape)) or "0"
    optional = a.default is not None or a.value.size == 0
    return f"{{{len(a.value.shape)}, {{{shape}}}, {int(optional)}, {int(a.positive)}}}"
