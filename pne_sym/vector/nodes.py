"""The nodes of the vector algebra: immutable, hashable, built simplified.

Only the simplifications that keep a derivation readable are applied when a node
is built: zeros vanish, scalar factors move outwards, nested sums are flattened.
Nothing is ever expanded into components here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Generic, TypeAlias, TypeVar

import sympy as sp
from sympy.core.symbol import Str

Scalar: TypeAlias = Any
_Node = TypeVar("_Node", bound="Vector | Tensor")


class _Printable:
    """Plain text of a node, Name(arg, ...): SymPy's printers know other classes of these names."""

    args: tuple[Any, ...]

    def _sympystr(self, printer: Any) -> str:
        return f"{type(self).__name__}({', '.join(printer.doprint(arg) for arg in self.args)})"


class _Linear(Generic[_Node]):
    """What can be added, and multiplied by a scalar."""

    def __add__(self, other: _Node) -> _Node:
        return _total((self, other), _parts_of(other)[0])

    def __sub__(self, other: _Node) -> _Node:
        return self + -other

    def __neg__(self) -> _Node:
        return scale(sp.S.NegativeOne, self)  # type: ignore[type-var, return-value]

    def __mul__(self, factor: Any) -> _Node:
        return scale(sp.sympify(factor), self)  # type: ignore[type-var, return-value]

    __rmul__ = __mul__

    def __truediv__(self, divisor: Any) -> _Node:
        return scale(1 / sp.sympify(divisor), self)  # type: ignore[type-var, return-value]


class Vector(_Linear["Vector"], _Printable, sp.Basic):
    """A vector in the plane or in space."""


class Tensor(_Linear["Tensor"], _Printable, sp.Basic):
    """A linear map of vectors (a second-order tensor)."""

    def __matmul__(self, other: Any) -> Any:
        """The tensor applied to a vector, or composed with a tensor."""
        return apply(self, other) if isinstance(other, Vector) else compose(self, other)


class _Named:
    """A symbol of the algebra; its name is unique within a derivation."""

    args: tuple[Any, ...]

    @property
    def name(self) -> str:
        """The name."""
        return str(self.args[0].name)

    def _sympystr(self, printer: Any) -> str:
        return self.name


class VectorSymbol(_Named, Vector):
    """A named vector."""

    def __new__(cls, name: str | Str) -> VectorSymbol:
        """The vector of this name."""
        return super().__new__(cls, Str(str(name)))  # type: ignore[no-any-return]


class TensorSymbol(_Named, Tensor):
    """A named tensor; `symmetric` is known to the algebra and to the lowering."""

    def __new__(cls, name: str | Str, symmetric: Any = False) -> TensorSymbol:
        """The tensor of this name."""
        return super().__new__(cls, Str(str(name)), sp.sympify(bool(symmetric)))  # type: ignore[no-any-return]

    @property
    def is_symmetric(self) -> bool:
        """Whether the tensor equals its transpose."""
        return bool(self.args[1])


class _ZeroVector(Vector):
    """The zero vector."""


class _ZeroTensor(Tensor):
    """The zero tensor."""


class _Identity(Tensor):
    """The identity tensor E."""


ZeroVector = _ZeroVector()
ZeroTensor = _ZeroTensor()
Identity = _Identity()


class VectorAdd(Vector):
    """A sum of vectors (build with `vector_sum`)."""


class VectorScale(Vector):
    """A scalar times a vector (build with `*`)."""


class Cross(Vector):
    """The cross product a x b in space."""

    def __new__(cls, a: Vector, b: Vector) -> Vector:
        """Build simplified."""
        factor_a, a = split_scale(a)
        factor_b, b = split_scale(b)
        if ZeroVector in (a, b) or a == b:
            return ZeroVector
        return scale(factor_a * factor_b, super().__new__(cls, a, b))  # type: ignore[no-any-return]


class Apply(Vector):
    """A tensor applied to a vector (build with `@`)."""


class Axial(Vector):
    """Axial vector of a tensor: Axial(T) . e_1 = T_32 - T_23 and cyclically.

    For T = integral of (B r) r^T dm it is the moment integral of r x (B r) dm.
    """


class DualVector(Vector):
    """Force part of reciprocal wrench k of a set of screws (v_j; E_1j, E_2j, ...).

    Arguments: k, the vectors v_j, and rows of scalars E_ij.  With the scalars m_ki of
    `DualScalar`: w_k . v_j + sum_i m_ki E_ij = 1 for k = j and 0 otherwise.
    """


class VectorLegSum(Vector):
    """Sum of a vector over the legs of a type (build with `sum_over_legs`)."""


class TensorAdd(Tensor):
    """A sum of tensors (build with `tensor_sum`)."""


class TensorScale(Tensor):
    """A scalar times a tensor (build with `*`)."""


class Skew(Tensor):
    """The tensor of the cross product: Skew(a) b = a x b."""

    def __new__(cls, a: Vector) -> Tensor:
        """Build simplified."""
        if a == ZeroVector:
            return ZeroTensor
        factor, a = split_scale(a)
        return scale(factor, super().__new__(cls, a))  # type: ignore[no-any-return]


class Outer(Tensor):
    """The tensor product a b^T: (a b^T) c = a (b . c)."""

    def __new__(cls, a: Vector, b: Vector) -> Tensor:
        """Build simplified."""
        if ZeroVector in (a, b):
            return ZeroTensor
        factor_a, a = split_scale(a)
        factor_b, b = split_scale(b)
        return scale(factor_a * factor_b, super().__new__(cls, a, b))  # type: ignore[no-any-return]


class Compose(Tensor):
    """The product A B of two tensors (build with `@`)."""


class Transpose(Tensor):
    """The transpose of a tensor."""

    def __new__(cls, a: Tensor) -> Tensor:
        """Build simplified."""
        if a in (ZeroTensor, Identity) or (isinstance(a, TensorSymbol) and a.is_symmetric):
            return a
        factor, a = split_scale(a)
        if isinstance(a, Transpose):
            return scale(factor, a.args[0])  # type: ignore[no-any-return]
        if isinstance(a, Skew):
            return scale(-factor, a)
        if isinstance(a, Outer):
            return scale(factor, Outer(a.args[1], a.args[0]))
        return scale(factor, super().__new__(cls, a))  # type: ignore[no-any-return]


class TensorLegSum(Tensor):
    """Sum of a tensor over the legs of a type (build with `sum_over_legs`)."""


class _VectorScalar(_Printable, sp.Expr):
    """A scalar made of vectors: a leaf for the scalar algebra of SymPy."""

    is_commutative = True
    is_real = True

    def _eval_derivative(self, symbol: Any) -> Any:
        raise TypeError("a scalar of abstract vectors has no derivative here")


class Dot(_VectorScalar):
    """The scalar product a . b."""

    def __new__(cls, a: Vector, b: Vector) -> Scalar:
        """Build simplified."""
        if ZeroVector in (a, b):
            return sp.S.Zero
        factor_a, a = split_scale(a)
        factor_b, b = split_scale(b)
        return factor_a * factor_b * super().__new__(cls, a, b)


class Trace(_VectorScalar):
    """The trace of a tensor."""

    def __new__(cls, a: Tensor) -> Scalar:
        """Build simplified."""
        factor, a = split_scale(a)
        return sp.S.Zero if a == ZeroTensor else factor * super().__new__(cls, a)


class DualScalar(_VectorScalar):
    """Moment part m_ki of reciprocal wrench k; arguments as of `DualVector`, with i after k."""


class LegSum(_VectorScalar):
    """Sum of a scalar over the legs of a type (build with `sum_over_legs`)."""


def sum_over_legs(value: Any, leg_type: str) -> Any:
    """Sum of a scalar, vector or tensor over the legs of a type."""
    if isinstance(value, Vector):
        return ZeroVector if value == ZeroVector else VectorLegSum(value, Str(leg_type))
    if isinstance(value, Tensor):
        return ZeroTensor if value == ZeroTensor else TensorLegSum(value, Str(leg_type))
    return sp.S.Zero if value == 0 else LegSum(sp.sympify(value), Str(leg_type))


def norm(a: Vector) -> Scalar:
    """Length of a vector."""
    return sp.sqrt(Dot(a, a))


def _parts_of(a: _Node) -> tuple[_Node, Any, Callable[..., _Node]]:
    """Zero, and the nodes of sums and of multiples, of what `a` is one of."""
    vectors, tensors = (ZeroVector, VectorAdd, VectorScale), (ZeroTensor, TensorAdd, TensorScale)
    return vectors if isinstance(a, Vector) else tensors


def split_scale(a: _Node) -> tuple[Scalar, _Node]:
    """A vector or tensor as scalar factor and rest."""
    factor, rest = a.args if isinstance(a, VectorScale | TensorScale) else (sp.S.One, a)
    return factor, rest


def scale(factor: Scalar, a: _Node) -> _Node:
    """Scalar times vector or tensor."""
    zero, total, multiple = _parts_of(a)
    if factor == 0 or a == zero:
        return zero
    own, a = split_scale(a)
    factor = factor * own
    if isinstance(a, total) and factor == -1:
        return _total((-term for term in a.args), zero)
    return a if factor == 1 else multiple(factor, a)


def _total(terms: Iterable[Any], zero: _Node) -> _Node:
    """Sum; flattened, zeros dropped, order kept."""
    _, total, _ = _parts_of(zero)
    flat: list[_Node] = []
    for term in terms:
        flat.extend(term.args if isinstance(term, total) else (term,))
    flat = [term for term in flat if term != zero]
    if len(flat) < 2:
        return flat[0] if flat else zero
    return total(*flat)  # type: ignore[no-any-return]


def vector_sum(terms: Iterable[Vector]) -> Vector:
    """Sum of vectors; flattened, zeros dropped, order kept."""
    return _total(terms, ZeroVector)


def tensor_sum(terms: Iterable[Tensor]) -> Tensor:
    """Sum of tensors, likewise."""
    return _total(terms, ZeroTensor)


def apply(a: Tensor, v: Vector) -> Vector:
    """A tensor applied to a vector."""
    if a == ZeroTensor or v == ZeroVector:
        return ZeroVector
    factor_a, a = split_scale(a)
    factor_v, v = split_scale(v)
    return scale(factor_a * factor_v, v if a == Identity else Apply(a, v))


def compose(a: Tensor, b: Tensor) -> Tensor:
    """The product of two tensors."""
    if ZeroTensor in (a, b):
        return ZeroTensor
    if a == Identity:
        return b
    if b == Identity:
        return a
    factor_a, a = split_scale(a)
    factor_b, b = split_scale(b)
    product = b if a == Identity else a if b == Identity else Compose(a, b)
    return scale(factor_a * factor_b, product)
