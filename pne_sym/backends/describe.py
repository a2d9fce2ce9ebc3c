"""What several back ends say alike: summary, parameters, equation titles, counts."""

from __future__ import annotations

from typing import NamedTuple

from pne_sym.backends.bundle import Bundle
from pne_sym.derivation import Coordinates, Derivation, ParameterField, Rule
from pne_sym.model.manipulator import Manipulator


class FieldView(NamedTuple):
    """One parameter, ready to print.

    Attributes:
        name, unit, meaning: as in the derivation.
        shape: with the legs first, such as (6, 3).
        rows: default values, one text per leg (or one in all).
        zeros: flat indices that are zero by structure.
        rule: what its values must be.
        leg_type: name of the type over whose legs the first index runs, or None.
    """

    name: str
    unit: str
    meaning: str
    shape: tuple[int, ...]
    rows: tuple[str, ...]
    zeros: tuple[int, ...]
    rule: Rule
    leg_type: str | None

    @property
    def per_leg(self) -> bool:
        """Whether the first index runs over the legs of a type."""
        return self.leg_type is not None

    @property
    def core(self) -> tuple[int, ...]:
        """The shape of one leg's entry, or of the whole."""
        return self.shape[1:] if self.per_leg else self.shape

    @property
    def shape_text(self) -> str:
        """The shape for a docstring."""
        return f"shape {self.shape}" if self.shape else "a number"


class Described(NamedTuple):
    """Facts about a model that generated files state.

    Attributes:
        name, title: of the manipulator; the title is safe in comments.
        upper: name in capitals, prefix of C macros.
        sizes: NQ, NV, NU, NC, NW, NJ.
        coordinates: names and order.
        pose_text, rate_text, tau_text, wrench_text: contents of X, V, tau, wrench.
        has_quaternion, is_constrained: features.
        is_numeric: some displacements are found by iteration; functions take q0.
        moves_base: the base moves; functions take its motion.
    """

    name: str
    title: str
    upper: str
    sizes: dict[str, int]
    coordinates: Coordinates
    pose_text: str
    rate_text: str
    tau_text: str
    wrench_text: str
    is_numeric: bool
    moves_base: bool

    @property
    def actuated(self) -> tuple[int, ...]:
        """Places of the actuated joints in q, in the order of tau."""
        return tuple(map(self.coordinates.joints.index, self.coordinates.actuators))

    @property
    def has_quaternion(self) -> bool:
        """Whether orientation is a quaternion."""
        return self.coordinates.has_quaternion

    @property
    def is_constrained(self) -> bool:
        """Whether there are multipliers."""
        return self.sizes["NC"] > 0

    @property
    def quaternion_at(self) -> int | None:
        """Where a quaternion stands in X."""
        c = self.coordinates
        return c.position if c.has_quaternion else None

    @property
    def head(self) -> tuple[str, ...]:
        """What heads of files say: the equation of motion, units, what vectors hold."""
        constrained = " + Hk(X) lambda" if self.is_constrained else ""
        return (
            f"    M(X) A + Z(X, V) = H(X) tau + wrench{constrained}",
            "",
            "SI units, radians.  Linear parts first, then angular; base axes; moments about the",
            "platform origin.",
            "",
            f"X:      {self.pose_text}",
            f"V, A:   {self.rate_text}",
            f"tau:    {self.tau_text}",
            f"wrench: {self.wrench_text}",
        )


def safe_text(text: str) -> str:
    """A user's text, harmless in C comments, Python docstrings and Markdown."""
    kept = "".join(
        ch if ch.isprintable() and ch not in '\\`*_<>{}[]$"#|~^&' else " " for ch in text
    )
    return " ".join(kept.replace("/", " / ").split())[:200]


def describe(bundle: Bundle) -> Described:
    """Facts about a compiled manipulator."""
    c = bundle.coordinates
    extra = c.names_of(c.extras)
    return Described(
        bundle.name,
        safe_text(bundle.manipulator.title),
        bundle.name.upper(),
        c.sizes,
        c,
        ", ".join((*c.pose, *extra)),
        ", ".join((*c.rates, *(f"{e} rate" for e in extra))),
        ", ".join(_in_words(bundle.manipulator, i, j) for i, j in c.actuators),
        ", ".join(c.wrench),
        not all(t.is_closed for t in bundle.derivation.leg_types),
        bundle.manipulator.moving_base,
    )


def _in_words(manipulator: Manipulator, leg: int, joint: int) -> str:
    """A joint by the names of leg and joint, or else their numbers."""
    of = manipulator.legs[leg]
    return f"{of.name or f'leg {leg + 1}'} {of.joints[joint].name or f'joint {joint + 1}'}"


def equation_titles(derivation: Derivation) -> dict[str, str]:
    """Equation id -> title."""
    titles = {e.id: e.title for e in derivation.equations()}
    return titles | {r.id: r.title for r in derivation.relations}


def field_views(bundle: Bundle) -> tuple[FieldView, ...]:
    """All parameters, ready to print."""
    return tuple(_field(f) for f in bundle.derivation.parameters.fields)


def _field(f: ParameterField) -> FieldView:
    rows = [_literal(row) for row in f.default] if f.leg_type else [_literal(f.default)]
    shape = (len(f.default), *f.shape) if f.leg_type else f.shape
    return FieldView(f.name, f.unit, f.meaning, shape, tuple(rows), f.zeros, f.rule, f.leg_type)


def _literal(value: object) -> str:
    """Nested list of floats, shortest digits that read back the same."""
    return repr(value.tolist() if hasattr(value, "tolist") else value).replace("-0.0,", "0.0,")
