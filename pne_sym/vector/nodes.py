"""The nodes of the vector algebra: immutable, hashable, built simplified.

Only the simplifications that keep a derivation readable are applied when a node
is built: zeros vanish, scalar factors move outwards, nested sums are flattened.
Nothing is ever expanded into components here.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias

import sympy as sp
from sympy.core.symbol import Str

Scalar: TypeAlias = Any


class _Printable:
    """Plain text of a node, Name(arg, ...): SymPy's printers know other classes of these names."""

    args: tuple[Any, ...]

    def _sympystr(self, printer: Any) -> str:
        return f"{type(self).__name__}({', '.join(printer.doprint(arg) for arg in self.args)})"


class Vector(_Printable, sp.Basic):
    """A vector in the plane or in space."""

    def __add__(self, other: Vector) -> Vector:
        return vector_sum((self, other))

    def __sub__(self, other: Vector) -> Vector:
        return vector_sum((self, -other))

    def __neg__(self) -> Vector:
        return scale(sp.S.NegativeOne, self)

    def __mul__(self, factor: Any) -> Vector:
        return scale(sp.sympify(factor), self)

    __rmul__ = __mul__

    def __truediv__(self, divisor: Any) -> Vector:
        return scale(1 / sp.sympify(divisor), self)


class Tensor(_Printable, sp.Basic):
    """A linear map of vectors (a second-order tensor)."""

    def __add__(self, other: Tensor) -> Tensor:
        return tensor_sum((self, other))

    def __sub__(self, other: Tensor) -> Tensor:
        return tensor_sum((self, -other))

    def __neg__(self) -> Tensor:
        return scale_tensor(sp.S.NegativeOne, self)

    def __mul__(self, factor: Any) -> Tensor:
        return scale_tensor(sp.sympify(factor), self)

    __rmul__ = __mul__

    def __truediv__(self, divisor: Any) -> Tensor:
        return scale_tensor(1 / sp.sympify(divisor), self)

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
        return scale(factor_a * factor_b, super().__new__(cls, a, b))


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
        return scale_tensor(factor, super().__new__(cls, a))


class Outer(Tensor):
    """The tensor product a b^T: (a b^T) c = a (b . c)."""

    def __new__(cls, a: Vector, b: Vector) -> Tensor:
        """Build simplified."""
        if ZeroVector in (a, b):
            return ZeroTensor
        factor_a, a = split_scale(a)
        factor_b, b = split_scale(b)
        return scale_tensor(factor_a * factor_b, super().__new__(cls, a, b))


class Compose(Tensor):
    """The product A B of two tensors (build with `@`)."""


class Transpose(Tensor):
    """The transpose of a tensor."""

    def __new__(cls, a: Tensor) -> Tensor:
        """Build simplified."""
        if a in (ZeroTensor, Identity) or (isinstance(a, TensorSymbol) and a.is_symmetric):
            return a
        factor, a = split_tensor_scale(a)
        if isinstance(a, Transpose):
            return scale_tensor(factor, a.args[0])
        if isinstance(a, Skew):
            return scale_tensor(-factor, a)
        if isinstance(a, Outer):
            return scale_tensor(factor, Outer(a.args[1], a.args[0]))
        return scale_tensor(factor, super().__new__(cls, a))


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
        factor, a = split_tensor_scale(a)
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


def split_scale(a: Vector) -> tuple[Scalar, Vector]:
    """A vector as scalar factor and rest."""
    return (a.args[0], a.args[1]) if isinstance(a, VectorScale) else (sp.S.One, a)


def split_tensor_scale(a: Tensor) -> tuple[Scalar, Tensor]:
    """A tensor as scalar factor and rest."""
    return (a.args[0], a.args[1]) if isinstance(a, TensorScale) else (sp.S.One, a)


def scale(factor: Scalar, a: Vector) -> Vector:
    """Scalar times vector."""
    if factor == 0 or a == ZeroVector:
        return ZeroVector
    if isinstance(a, VectorScale):
        factor, a = factor * a.args[0], a.args[1]
    if isinstance(a, VectorAdd) and factor == -1:
        return vector_sum(-term for term in a.args)
    return a if factor == 1 else VectorScale(factor, a)


def scale_tensor(factor: Scalar, a: Tensor) -> Tensor:
    """Scalar times tensor."""
    if factor == 0 or a == ZeroTensor:
        return ZeroTensor
    if isinstance(a, TensorScale):
        factor, a = factor * a.args[0], a.args[1]
    if isinstance(a, TensorAdd) and factor == -1:
        return tensor_sum(-term for term in a.args)
    return a if factor == 1 else TensorScale(factor, a)


def vector_sum(terms: Iterable[Vector]) -> Vector:
    """Sum of vectors; flattened, zeros dropped, order kept."""
    flat: list[Vector] = []
    for term in terms:
        flat.extend(term.args if isinstance(term, VectorAdd) else (term,))
    flat = [term for term in flat if term != ZeroVector]
    if len(flat) < 2:
        return flat[0] if flat else ZeroVector
    return VectorAdd(*flat)


def tensor_sum(terms: Iterable[Tensor]) -> Tensor:
    """Sum of tensors; flattened, zeros dropped, order kept."""
    flat: list[Tensor] = []
    for term in terms:
        flat.extend(term.args if isinstance(term, TensorAdd) else (term,))
    flat = [term for term in flat if term != ZeroTensor]
    if len(flat) < 2:
        return flat[0] if flat else ZeroTensor
    return TensorAdd(*flat)


def apply(a: Tensor, v: Vector) -> Vector:
    """A tensor applied to a vector."""
    if a == ZeroTensor or v == ZeroVector:
        return ZeroVector
    factor_a, a = split_tensor_scale(a)
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
    factor_a, a = split_tensor_scale(a)
    factor_b, b = split_tensor_scale(b)
    product = b if a == Identity else a if b == Identity else Compose(a, b)
    return scale_tensor(factor_a * factor_b, product)
