"""The extension back end: the generated C as a Python module with the functions of NAME.py."""

from __future__ import annotations

from pne_sym.backends.bundle import Bundle
from pne_sym.backends.describe import describe
from pne_sym.backends.ext.header import entries
from pne_sym.backends.ext.public import Bindings
from pne_sym.backends.ext.wrapper import wrapper_text
from pne_sym.backends.python_public import exported, parameters_view, takes_rotation
from pne_sym.backends.target import TargetError
from pne_sym.backends.templating import render


class ExtBackend:
    """Emits NAME_ext.py, which holds the text of NAME.c and NAME.h."""

    operations = None

    def emit(self, bundle: Bundle) -> dict[str, str]:
        """File name -> text.

        Raises:
            TargetError: a public function is not in NAME.h.
        """
        c = _c_files(bundle)
        header, source = f"{bundle.name}.h", f"{bundle.name}.c"
        bindings = Bindings(bundle, entries(c[header], bundle.name))
        wrapper = wrapper_text(bundle, bindings)
        public = [f for f in bundle.program.public if f.is_exported]
        files = ((header, c[header]), (source, c[source]), (f"{bundle.name}_ext.c", wrapper))
        assert not any('"""' in text for _, text in files)
        text = render(
            "ext/module.py.jinja",
            d=describe(bundle),
            exported=exported(bundle),
            parameters=parameters_view(bundle),
            rotates=any(map(takes_rotation, public)),
            measures=any(map(bindings.is_completed, public)),
            entries=[bindings.row(f) for f in public],
            public=[bindings.text(f) for f in public],
            files=files,
        )
        return {f"{bundle.name}_ext.py": text}


def _c_files(bundle: Bundle) -> dict[str, str]:
    """What the C target prints, whichever back end that is."""
    # Imported here: the emission imports back ends, and the registry knows all of them.
    from pne_sym.backends.emission import emit_target  # noqa: PLC0415
    from pne_sym.backends.registry import target  # noqa: PLC0415

    return emit_target(bundle, target("c"))


__all__ = ["ExtBackend", "TargetError"]
