"""The targets, in the order in which they print; a new one is an entry here.

All others (writer, comparison, review, command line) ask here for what they need of a back end:
names, files, syntax. Back ends themselves are imported when they print (`emission`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

from pne_sym.backends.target import Syntax, Target, TargetError

_PYTHON = Syntax(
    comments=("#",),
    function=r"def (\w+)\(",
    ends=r"(?:ok|valid|reached|clear|sums|return|shared|def|for|if)\b|out_\w+ = |[{}]",
)
_ARRAYS = Syntax(
    comments=("#",),
    function=r"def (\w+)\(",
    ends=r"(?:return|found|def)\b|s\.(?:require|settle)\(|\w+ = s\.(?:total|take)\(|[{}]",
)
_C = Syntax(
    comments=("/*", "//"),
    closing="*/",
    function=r"[A-Za-z_][\w\s*]*?\b(\w+)\(",
    ends=r"(?:ok|return|for|if|SHORT_IN_VECTORS)\b|[{}]|#if|#end",
)
_MATLAB = Syntax(
    comments=("%",),
    function=r"function (?:[^=(]*= )?(\w+)\(",
    ends=r"(?:flat|array)_\w+ = |model\.|\w+ = (?:sum\(\(|(?:[XVAq]|base)\()"
    r"|(?:singular|invalid|unreachable) =|(?:status(?! = \w+\.internal\.flag\()|end)\b",
)

TARGETS: tuple[Target, ...] = (
    Target(
        "numpy",
        "Python that needs numpy only",
        "pne_sym.backends.numpy_backend:NumpyBackend",
        files=("{name}.py", "__init__.py"),
        code=("{name}.py",),
        syntax=_PYTHON,
        default=True,
        runs=True,
    ),
    Target(
        "c",
        "C99 that needs libm only",
        "pne_sym.backends.c_backend:CBackend",
        files=("{name}.h", "{name}.c"),
        code=("{name}.c",),
        syntax=_C,
        default=True,
        runs=True,
    ),
    Target(
        "xp",
        "Python on arrays of NumPy, JAX, PyTorch, CuPy",
        "pne_sym.backends.xp:XpBackend",
        files=("{name}_xp.py",),
        code=("{name}_xp.py",),
        syntax=_ARRAYS,
    ),
    Target(
        "octave",
        "functions for MATLAB, Simulink and Octave",
        "pne_sym.backends.octave:OctaveBackend",
        files=("octave/+{name}/*.m", "octave/+{name}/+internal/*.m"),
        code=("octave/+{name}/+internal/*.m",),
        syntax=_MATLAB,
    ),
    Target(
        "ext",
        "Python that compiles the C: NumPy's functions, fast",
        "pne_sym.backends.ext:ExtBackend",
        files=("{name}_ext.py",),
    ),
    Target(
        "manifest",
        "what the model consists of, for programs",
        "pne_sym.backends.manifest:ManifestBackend",
        files=("{name}.json",),
        always=True,
    ),
    Target(
        "report",
        "the derivation, for people",
        "pne_sym.backends.report:ReportBackend",
        files=("{name}.md",),
        always=True,
    ),
)


_BEFORE = ("spec", "derivation", "program")
"""Stages of `pne-gen explain` before the targets."""


def choices() -> tuple[str, ...]:
    """The names that `--target` takes."""
    return tuple(target.name for target in TARGETS if not target.always)


def default() -> tuple[str, ...]:
    """The targets that are written unless others are chosen."""
    return tuple(target.name for target in TARGETS if target.default)


def stages() -> tuple[str, ...]:
    """What can be explained: the specification, the equations, the program, targets' code."""
    return (*_BEFORE, *(target.name for target in TARGETS if target.code))


def check_stage(name: str) -> None:
    """Refuse what is no stage.

    Raises:
        TargetError: the message has those that there are.
    """
    if name not in stages():
        raise TargetError(f"no stage {name[:40]!r}; allowed are {', '.join(stages())}")


def chosen(names: str | Iterable[str]) -> tuple[str, ...]:
    """Names of targets in their order, each once.

    Args:
        names: or a text of names with commas between.

    Raises:
        TargetError: there is no such target, or none is named.

    >>> chosen("c, numpy")
    ('numpy', 'c')
    """
    wanted = [n.strip() for n in names.split(",")] if isinstance(names, str) else list(names)
    allowed = ", ".join(choices())
    if wanted in ([], [""]):
        raise TargetError(f"no target is named; allowed are {allowed}, with commas between")
    for name in wanted:
        if name not in choices():
            raise TargetError(
                f"no target {name[:40]!r}; allowed are {allowed}, with commas between"
            )
    return tuple(name for name in choices() if name in wanted)


def printing(names: Collection[str]) -> tuple[Target, ...]:
    """The targets of these names, and those that are always written."""
    return tuple(t for t in TARGETS if t.always or t.name in names)


def target(name: str) -> Target:
    """The target of a name.

    Raises:
        TargetError: there is none.
    """
    for each in TARGETS:
        if each.name == name:
            return each
    raise TargetError(f"no target {name[:40]!r}")


def is_named(model: str, path: str, generated: Collection[str]) -> bool:
    """Whether a file in a model's folder is of a generation by its name alone.

    Args:
        model: its name.
        path: below its folder, with slashes.
        generated: targets that the folder was generated with.
    """
    return any(
        t.names(model, path) for t in TARGETS if t.always or t.default or t.name in generated
    )


def is_claimed(model: str, path: str) -> bool:
    """Whether some target may write such a file; it did if the file is signed."""
    return any(t.owns(model, path) for t in TARGETS)
