"""Types of arrays, the reading of arrays that users give, lengths of vectors, and remainders without rounding."""

import math
from collections.abc import Callable, Iterator, Mapping
from math import fsum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bemcontact.checks.arguments import LARGEST_NUMBER, is_real, shown
from bemcontact.errors import ProblemError

Array = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]
ComplexArray = NDArray[np.complex128]
ObjectArray = NDArray[np.object_]

_DOUBLE = np.dtype(np.float64)

BLOCK = 32
"""Rows of which products are held at a time, so that they stay in the cache."""
NO_ANGLE = 1e-12
"""Cosine of the angle to a residual up to which a column does not make it smaller."""

Dimensions = tuple[int | None, ...]
"""Shape of an array that is needed; None is any length."""


def real_array(value: Any, what: str, shape: Dimensions | None = None, *, finite: bool = True) -> Array:
    """Read an array of real numbers, which errors call `what`; `ProblemError` says what is wrong with it.

    Refused are other shapes, masked entries, truth values, texts, complex numbers, and entries that are not finite or
    too large to compute with, unless `finite` is False. The array is not copied if it is one already.
    """
    array = value if type(value) is np.ndarray else _as_array(value, what)
    if array.dtype != _DOUBLE:
        if array.dtype.kind == "O" and all(is_real(entry) for entry in array.flat):
            array = _as_floats(array, what)
        if array.dtype.kind not in "iuf" and array.size:
            raise ProblemError(f"{what} must contain real numbers; found {_described(value, array)}")
        array = np.asarray(array, dtype=float)
    if shape not in (None, array.shape):
        _ensure_shape(array, what, shape)
    if finite and array.size and not np.vdot(array, array) <= LARGEST_NUMBER**2:  # which tells enough of nearly all
        _ensure_moderate(array, what)
    return array


def whole_array(value: Any, what: str, shape: Dimensions | None = None) -> IntArray:
    """Read an array of whole numbers, as `real_array` does."""
    array = _as_array(value, what)
    if array.dtype.kind not in "iu" and array.size:
        raise ProblemError(f"{what} must contain whole numbers; found {_described(value, array)}")
    _ensure_shape(array, what, shape)
    return np.asarray(array, dtype=np.int64)


def flag_array(value: Any, what: str, shape: Dimensions | None = None) -> BoolArray:
    """Read an array of truth values, as `real_array` does."""
    array = _as_array(value, what)
    if array.dtype.kind != "b" and array.size:
        raise ProblemError(f"{what} must contain True and False; found {_described(value, array)}")
    _ensure_shape(array, what, shape)
    return np.asarray(array, dtype=bool)


def read_arrays(
    instance: Any,
    shapes: Mapping[str, Dimensions | None],
    prefix: str = "",
    reader: Callable[..., NDArray[Any]] = real_array,
) -> None:
    """Read fields of a frozen dataclass as arrays with given shapes; errors call them by the prefix and their names."""
    own = vars(instance)
    for name, shape in shapes.items():
        own[name] = reader(own[name], prefix + name, shape)


def freeze_arrays(instance: Any) -> None:
    """Replace the arrays of a frozen dataclass by read-only copies, but for those that are read-only and no views."""
    own = vars(instance)
    for name, value in own.items():
        if isinstance(value, np.ndarray) and (value.flags.writeable or value.base is not None):
            own[name] = value.copy()
            own[name].setflags(write=False)


def magnitudes(vectors: Array) -> Array:
    """Lengths (...) of vectors (..., 2)."""
    return np.hypot(vectors[..., 0], vectors[..., 1])


def scalar_products(one: Array, other: Array) -> Array:
    """Scalar products (...) of vectors (..., 2): a sum over an axis of two takes several times longer."""
    return one[..., 0] * other[..., 0] + one[..., 1] * other[..., 1]


def norm(vector: Array) -> float:
    """Length of a vector (n,), in a fraction of the time of `np.linalg.norm`, which takes any shape."""
    return math.sqrt(vector @ vector)


def row_norms(matrix: Array) -> Array:
    """Lengths (n,) of rows (n, k)."""
    return np.sqrt((matrix * matrix).sum(axis=1))


def indices(mask: BoolArray) -> IntArray:
    """Indices (k,) where a mask (n,) is true, in a fraction of the time of `np.flatnonzero`, which takes any shape."""
    return mask.nonzero()[0]


def successive(index: IntArray) -> IntArray | slice:
    """A slice where indices follow each other, with which NumPy adds several times faster."""
    if len(index) and (index[1:] - index[:-1] == 1).all():
        return slice(int(index[0]), int(index[-1]) + 1)
    return index


def _as_array(value: Any, what: str) -> NDArray[Any]:
    """The array of NumPy that a value is or can be made into, without masked entries."""
    if type(value) is np.ndarray:
        return value
    if _is_masked(value):
        raise ProblemError(f"{what} has masked entries; fill them with numbers, or leave these points out")
    try:
        return np.asarray(value)
    except Exception:  # lists of unequal length, and whatever an object of the user raises
        raise ProblemError(
            f"{what} cannot be read as an array: found {shown(value)}; give numbers, in rows of equal length"
        ) from None


def _is_masked(value: Any) -> bool:
    """Whether entries are masked, in lists of masked arrays too, of which NumPy would take the numbers behind."""
    if isinstance(value, list | tuple):
        return any(_is_masked(item) for item in value if not isinstance(item, int | float))
    return isinstance(value, np.ma.MaskedArray) and bool(np.ma.getmaskarray(value).any())


def _as_floats(array: NDArray[Any], what: str) -> Array:
    """Fractions, decimals and long integers as floats."""
    try:
        return array.astype(float)
    except (OverflowError, ValueError):
        raise ProblemError(f"{what} has entries that are not finite numbers of double precision; scale them") from None


def _ensure_shape(array: NDArray[Any], what: str, shape: Dimensions | None) -> None:
    """Refuse another shape."""
    if shape is None or array.shape == shape:
        return
    known = tuple([has if want is None else want for want, has in zip(shape, array.shape, strict=False)])
    if array.shape != known or len(shape) != len(known):
        needed = ", ".join("any" if length is None else str(length) for length in shape)
        needed = f"({needed},)" if len(shape) == 1 else f"({needed})"
        raise ProblemError(f"{what} has shape {array.shape} where {needed} is needed")


def _ensure_moderate(array: Array, what: str) -> None:
    """Refuse the first entry that is not finite, or too large."""
    wrong = np.argwhere(~(np.abs(array) <= LARGEST_NUMBER)).tolist()
    if not wrong:
        return
    place = tuple(wrong[0])
    where = f"; [{', '.join(map(str, place))}] is {array[place]:g}" if place else ""
    if np.isfinite(array).all():
        raise ProblemError(f"{what} has entries that are too large to compute with{where}; choose other units")
    raise ProblemError(f"{what} has entries that are not finite numbers{where}")


def _described(value: Any, array: NDArray[Any]) -> str:
    """What was found instead of numbers."""
    kinds = {"b": "truth values", "c": "complex numbers", "U": "texts", "S": "bytes", "f": "numbers with fractions"}
    return f"{kinds.get(array.dtype.kind, 'other objects')} ({shown(value)})"


def exact_remainders(right: Array, rows: Array, x: Array) -> Array:
    """The components of right - rows x, each rounded once: Dekker's products of halves of numbers, and exact sums."""
    remainders = right - rows @ x
    for part, products, lost in _exact_products(rows, x):
        terms = np.concatenate([right[part, None], -products, -lost], axis=1)
        if np.isfinite(terms).all():
            remainders[part] = [fsum(row) for row in terms.tolist()]
    return remainders


def fine_remainders(right: Array, rows: Array, x: Array) -> Array:
    """The components of right - rows x as of numbers with twice as many digits, in a tenth of the time of exact ones.

    Sums of two numbers leave their rounding behind (Knuth), which is added at the end.
    """
    remainders = right - rows @ x
    if 4 * np.count_nonzero(used := x != 0.0) <= 3 * x.size:
        rows, x = rows[:, used], x[used]
    for part, products, lost in _exact_products(rows, x):
        sums, rounding = np.concatenate([right[part, None], -products], axis=1), -lost.sum(axis=1)
        while (half := sums.shape[1] // 2) > 0:
            one, other, rest = sums[:, :half], sums[:, half : 2 * half], sums[:, 2 * half :]
            rounding += sum_remainders(one, other).sum(axis=1)
            sums = np.hstack([one + other, rest]) if rest.size else one + other
        better = sums[:, 0] + rounding
        remainders[part] = np.where(np.isfinite(better), better, remainders[part])
    return remainders


def _exact_products(rows: Array, x: Array) -> Iterator[tuple[slice, Array, Array]]:
    """Products (k, n) of some rows with x, and what rounding took from each."""
    high, low = _halves(x)
    for first in range(0, len(rows), BLOCK):
        part = slice(first, first + BLOCK)
        products = rows[part] * x
        yield part, products, _lost(products, _halves(rows[part]), (high, low))


def product_remainders(one: Array, other: Array) -> Array:
    """What rounding takes from the products of two arrays."""
    return _lost(one * other, _halves(one), _halves(other))


def sum_remainders(one: Array, other: Array) -> Array:
    """What rounding takes from the sums of two arrays."""
    total = one + other
    part = total - one
    return (one - (total - part)) + (other - part)


def _lost(products: Array, one: tuple[Array, Array], other: tuple[Array, Array]) -> Array:
    """What rounding took from products of numbers, of which the halves are given."""
    (upper, lower), (high, low) = one, other
    return lower * low - (((products - upper * high) - lower * high) - upper * low)


def _halves(numbers: Array) -> tuple[Array, Array]:
    """Each number as the sum of two of half as many digits."""
    shifted = (2.0**27 + 1.0) * numbers
    upper = shifted - (shifted - numbers)
    return upper, numbers - upper


def short_svd(matrix: Array) -> tuple[Array, Array]:
    """Singular values (k,), zeros included, and right singular vectors (k, k) of a matrix (n, k)."""
    n, k = matrix.shape
    if k == 0:
        return np.zeros(0), np.zeros((0, 0))
    if k == 1:
        return np.array([norm(matrix[:, 0])]), np.ones((1, 1))
    if n < k:
        matrix = np.concatenate([matrix, np.zeros((k - n, k))])
    return np.linalg.svd(matrix, full_matrices=False)[1:]


def least_squares(columns: Array, right: Array) -> Array:
    """The shortest x (k,) with the least |A x - b|, for columns A (n, k) and b (n,); one row or column needs no SVD."""
    if 1 not in columns.shape:
        return np.asarray(np.linalg.lstsq(columns, right)[0], float)
    along = columns.ravel()
    square = float(along @ along)
    return (right @ columns if columns.shape[1] == 1 else right[0] * along) / (square or 1.0)


def nonnegative_residual(columns: Array, right: Array) -> Array:
    """The residual A x - b (k,) of the x >= 0 (n,) with the least |A x - b|, for columns A (k, n) and b (k,).

    Where it is not zero, no column leads further down: Aᵀr >= 0 and bᵀr = -rᵀr, up to a cosine of `NO_ANGLE`. Not
    `scipy.optimize.nnls`: its import takes longer than a check, and at ties it may report a residual that is too small.

    References
    ----------
    C. L. Lawson and R. J. Hanson, "Solving Least Squares Problems" (1974), chapter 23.
    """
    if len(right) == 1:
        carries = columns > 0.0 if right[0] > 0.0 else columns < 0.0
        return np.zeros(1) if right[0] and carries.any() else -right
    length = np.linalg.norm(columns, axis=0)
    unit = columns[:, length > 0.0] / length[length > 0.0]
    used, x, residual = np.zeros(0, int), np.zeros(0), -right
    while unit.size:
        pull = -(residual @ unit)
        pull[used] = 0.0
        entering = int(pull.argmax())
        size = float(np.linalg.norm(residual))
        if pull[entering] <= NO_ANGLE * size:
            break
        used, x = _fitted(unit, right, np.append(used, entering), np.append(x, 0.0))
        left = unit[:, used] @ x - right
        left -= unit[:, used] @ np.linalg.lstsq(unit[:, used], left)[0]  # a small residual keeps its direction
        if not np.linalg.norm(left) < size:  # only rounding is left
            break
        residual = left
    return residual


def _fitted(unit: Array, right: Array, used: IntArray, x: Array) -> tuple[IntArray, Array]:
    """The columns in use and their x > 0, for the least residual; columns are dropped on the way from x >= 0."""
    while used.size:
        best = np.asarray(np.linalg.lstsq(unit[:, used], right)[0], float)
        falling = best <= 0.0
        if not falling.any():
            return used, best
        steps = np.full(len(x), np.inf)
        steps[falling] = x[falling] / np.where(x == best, 1.0, x - best)[falling]
        x = x + steps.min() * (best - x)
        kept = (x > 0.0) & (steps > steps.min())
        used, x = used[kept], x[kept]
    return used, x


def powers_of_two(sizes: Array) -> Array:
    """The power of two near each size, by which numbers are divided without rounding; 1 for zero."""
    return np.exp2(np.rint(np.log2(np.where(sizes > 0, sizes, 1.0))))
