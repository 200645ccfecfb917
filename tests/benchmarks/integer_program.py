"""Small quadratic programs of whole numbers, and the same in units that are powers of ten."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
INF = np.inf


@dataclass(frozen=True, kw_only=True)
class IntegerProgram:
    """Minimize cᵀx + ½xᵀHx subject to lower <= [x; A x] <= upper, all numbers whole, bounds infinite where absent."""

    H: Array
    c: Array
    A: Array
    lower: Array
    upper: Array

    @property
    def normals(self) -> Array:
        """[I; A], (n + m, n)."""
        return np.vstack([np.eye(self.c.size), self.A])

    def stated(self, units: "Units") -> tuple[Array, ...]:
        """H, c, A, cl, cu, bl, bu in these units, as `minimize_qp` takes them."""
        n, D, E, unit = self.c.size, units.columns, units.rows, units.objective
        bl, cl = self.lower[:n] / D, E * self.lower[n:]
        bu, cu = self.upper[:n] / D, E * self.upper[n:]
        return unit * (D[:, None] * self.H * D), unit * (D * self.c), E[:, None] * self.A * D, cl, cu, bl, bu


@dataclass(frozen=True, kw_only=True)
class Units:
    """Powers of ten: x = columns times the x of these units; factors of the rows and of the objective."""

    columns: Array
    rows: Array
    objective: float


def plain_units(program: IntegerProgram) -> Units:
    """No change of units."""
    return Units(columns=np.ones(program.c.size), rows=np.ones(len(program.A)), objective=1.0)


def random_units(program: IntegerProgram, rng: np.random.Generator) -> Units:
    """Powers of ten of random range: of the columns, of the rows, of both, and of the objective."""
    widths = rng.choice([0, 3, 8], size=3, p=[0.3, 0.3, 0.4])
    n, m = program.c.size, len(program.A)
    columns, rows, objective = (
        np.power(10.0, rng.integers(-width, width + 1, size)).astype(float)
        for width, size in zip(widths, (n, m, 1), strict=True)
    )
    return Units(columns=columns, rows=rows, objective=float(objective[0]))


def random_program(rng: np.random.Generator) -> IntegerProgram:
    """Whole numbers from -2 to 2 in H of low or full rank and in A; many zeros, ties and degenerate points."""
    n, m = int(rng.integers(2, 7)), int(rng.integers(0, 8))
    A = rng.integers(-2, 3, (m, n)) * (rng.random((m, n)) < rng.choice([0.4, 0.8, 1.0]))
    if m > 1 and rng.random() < 0.2:
        A[-1] = A[0] * rng.choice([-2, -1, 1, 2])
    base = rng.integers(-3, 4, n) if rng.random() < 0.7 else np.zeros(n, dtype=int)
    lower, upper = _bounds(np.concatenate([base, A @ base]), n, rng)
    return IntegerProgram(
        H=_hessian(n, rng).astype(float),
        c=(rng.integers(-2, 3, n) * (rng.random() < 0.7)).astype(float),
        A=A.astype(float),
        lower=lower,
        upper=upper,
    )


def degenerate_program(rng: np.random.Generator) -> IntegerProgram:
    """A first-order point, often 0, with many active constraints, few of them with a multiplier.

    The form is copositive on the critical cone of this point, or copositive less a square, so that a multiplier or a
    curvature taken for more than it is makes the difference.
    """
    n, m = int(rng.integers(2, 7)), int(rng.integers(1, 6))
    A = rng.integers(-2, 3, (m, n)) * (rng.random((m, n)) < rng.choice([0.4, 0.8, 1.0]))
    if m > 1 and rng.random() < 0.3:
        A[-1] = A[0] * rng.choice([-2, -1, 1, 2]) + (A[1] if rng.random() < 0.5 else 0)
    base = rng.integers(-3, 4, n) * (rng.random() < 0.3)
    normals, size = np.vstack([np.eye(n, dtype=int), A]), n + m
    active = rng.random(size) < np.where(np.arange(size) < n, rng.choice([0.2, 0.6]), 0.8)
    inwards = rng.choice([-1, 1], size) * active
    multipliers = rng.integers(1, 4, size) * (rng.random(size) < rng.choice([0.1, 0.3, 0.6])) * inwards
    H = _edge_of_copositive(inwards[:, None] * normals, multipliers != 0, rng)
    values, far = normals @ base, rng.integers(0, 5, (2, size)).astype(float)
    far[rng.random((2, size)) < 0.6] = INF
    lower, upper = np.where(inwards > 0, values, values - far[0]), np.where(inwards < 0, values, values + far[1])
    equal = (inwards > 0) & (rng.random(size) < 0.1)
    upper[equal] = lower[equal]
    c = normals.T @ multipliers - H @ base
    return IntegerProgram(H=H.astype(float), c=c.astype(float), A=A.astype(float), lower=lower, upper=upper)


def endless_program(rng: np.random.Generator) -> IntegerProgram:
    """A convex program that is unbounded: on a ray v that all constraints allow the form is flat and c falls."""
    n, m = int(rng.integers(2, 7)), int(rng.integers(1, 6))
    v, j = rng.integers(-2, 3, n), int(rng.integers(n))
    v[j] = 1
    level = np.eye(n, dtype=int) - np.outer(v, np.eye(n, dtype=int)[j])  # rows times this vanish on v
    B = rng.integers(-2, 3, (int(rng.integers(1, n + 1)), n)) @ level
    A = rng.integers(-2, 3, (m, n)) * (rng.random((m, n)) < 0.7)
    A = np.where((rng.random(m) < 0.5)[:, None], A @ level, A)
    c = rng.integers(-2, 3, n) @ level
    c[j] -= int(rng.integers(1, 4))
    normals = np.vstack([np.eye(n, dtype=int), A])
    values, room = normals @ rng.integers(-2, 3, n), rng.integers(0, 4, (2, n + m))
    absent, along = rng.random((2, n + m)) < np.array([[0.4], [0.5]]), normals @ v
    return IntegerProgram(
        H=(B.T @ B).astype(float),
        c=c.astype(float),
        A=A.astype(float),
        lower=np.where(absent[0] | (along < 0), -INF, values - room[0]),
        upper=np.where(absent[1] | (along > 0), INF, values + room[1]),
    )


def resting_program(rng: np.random.Generator) -> tuple[IntegerProgram, Array, NDArray[np.bool_]]:
    """A program with a point of zero gradient and active constraints; the point, and which of its zeros are free."""
    n, m = int(rng.integers(2, 5)), int(rng.integers(1, 4))
    A, free = rng.integers(-2, 3, (m, n)), rng.random(n) < 0.8
    x, B = rng.integers(-3, 4, n) * ~free, rng.integers(-2, 3, (n, n))
    values, side = np.concatenate([x, A @ x]).astype(float), rng.integers(-1, 3, n + m)
    side[:n] *= ~free
    program = IntegerProgram(
        H=(np.outer(free, free) * (B + B.T)).astype(float),
        c=np.zeros(n),
        A=A.astype(float),
        lower=np.where(side > 0, values, -INF),
        upper=np.where(np.isin(side, (-1, 2)), values, INF),
    )
    return program, x.astype(float), free


def narrow_program(rng: np.random.Generator, level: int = 1000) -> IntegerProgram:
    """A program whose rows are in part parallel to others up to one in `level`, most of them active at one point."""
    n, m = int(rng.integers(2, 6)), int(rng.integers(2, 7))
    A = rng.integers(-2, 3, (m, n)) * (rng.random((m, n)) < rng.choice([0.4, 0.8, 1.0]))
    alike, other, changed = rng.random(m) < 0.5, rng.integers(0, m, m), rng.integers(0, n, m)
    A = np.where(alike[:, None], level * A[other], A)
    A[np.arange(m), changed] += alike * rng.integers(-1, 2, m)
    x, H = rng.integers(-3, 4, n), _hessian(n, rng)
    values, room = np.concatenate([x, A @ x]), rng.integers(0, 5, (2, n + m)) * (rng.random((2, n + m)) < 0.2)
    lower, upper = (values - room[0]).astype(float), (values + room[1]).astype(float)
    absent = rng.random((2, n + m)) < 0.4
    lower[absent[0]], upper[absent[1]] = -INF, INF
    c = rng.integers(-2, 3, n) if rng.random() < 0.5 else -H @ x
    return IntegerProgram(H=H.astype(float), c=c.astype(float), A=A.astype(float), lower=lower, upper=upper)


def _edge_of_copositive(
    inwards: NDArray[np.int64], strong: NDArray[np.bool_], rng: np.random.Generator
) -> NDArray[np.int64]:
    """Products of inward normals, any products with the strong ones, a square, and often less another square."""
    size, n = inwards.shape
    of_weak = inwards * ~strong[:, None]
    products = rng.integers(0, 2, (size, size)) * (rng.random((size, size)) < 0.3)
    H = of_weak.T @ products @ of_weak + (inwards * strong[:, None]).T @ rng.integers(-2, 3, (size, n))
    b, e = rng.integers(-2, 3, (2, n)) * (rng.random((2, 1)) < 0.6)
    return H + H.T + np.outer(b, b) - np.outer(e, e)


def _hessian(n: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """A symmetric matrix: zero, of rank one or two, semidefinite, bilinear, or any."""
    kind = int(rng.integers(7))
    B = rng.integers(-2, 3, (n, n))
    b, e = B[:, :1], B[:, 1:2]
    bilinear = np.triu(B * (rng.random((n, n)) < 0.4), 1)
    few = -np.diag((rng.random(n) < 0.3).astype(int))
    forms = (np.zeros((n, n), dtype=int), b @ b.T - e @ e.T, -b @ b.T, B @ B.T, bilinear + bilinear.T, B + B.T, few)
    return forms[kind]


def _bounds(values: NDArray[np.int64], n: int, rng: np.random.Generator) -> tuple[Array, Array]:
    """Bounds of which most let the given values pass, many of them at the bound itself; few equalities."""
    size = values.size
    room = rng.integers(0, 5, (2, size)) * (rng.random((2, size)) < 0.6)
    lower, upper = (values - room[0]).astype(float), (values + room[1]).astype(float)
    free = rng.random((2, size)) < rng.choice([0.3, 0.5, 0.7])
    lower[free[0]], upper[free[1]] = -INF, INF
    moved = rng.random(size) < 0.05
    lower[moved], upper[moved] = lower[moved] + 2, upper[moved] + 2
    equal = (rng.random(size) < np.where(np.arange(size) < n, 0.03, 0.12)) & np.isfinite(lower)
    upper[equal] = lower[equal]
    return lower, upper
