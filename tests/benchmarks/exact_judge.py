"""Answers to programs of whole numbers, judged with fractions wherever rounding could decide."""

from enum import StrEnum
from fractions import Fraction
from itertools import combinations

import numpy as np
from integer_program import Array, IntegerProgram, Units
from numpy.typing import NDArray
from scipy.optimize import linprog, nnls

from bemcontact.formulations.local_solver.result import QPResult, QPStatus

CLEAR = 1e-6
"""A residual above this is no rounding: the numbers of the programs are whole and small."""
CLOSE = 1e-9
"""A product of unit vectors below this may be zero."""
NEAR = 1e-8
"""An exact point is next to one of doubles if no component differs by more, relative to the largest."""
FAR = 1e6
"""Terms of the gradient and of constraints near their bounds beyond this have lost too many digits to be judged."""

Row = list[Fraction]


class Verdict(StrEnum):
    """What is true of an answer."""

    RIGHT = "right"
    FALSE_MINIMIZER = "false minimizer"
    FALSE_UNBOUNDED = "false unbounded"
    FALSE_INFEASIBLE = "false infeasible"
    WEAK_RAY = "unbounded, with a ray or a point that hardly shows it"
    UNSETTLED = "not settled by the judge"
    NO_CLAIM = "no claim"


def judge(program: IntegerProgram, units: Units, result: QPResult) -> Verdict:
    """Whether the claim holds for the whole numbers."""
    x = units.columns * result.x
    if result.status is QPStatus.LOCAL_MINIMIZER:
        verdict = _of_minimizer(program, x)
        exact = verdict if verdict is Verdict.RIGHT else _at_working_set(program, units, x, result.working_set)
        return verdict if exact is Verdict.UNSETTLED else exact
    if result.status is QPStatus.UNBOUNDED and result.ray is not None:
        return _of_ray(program, x, units.columns * result.ray, result.working_set)
    if result.status is QPStatus.INFEASIBLE and result.certificate is not None:
        return _of_certificate(program, units.rows * result.certificate[x.size :])
    return Verdict.NO_CLAIM


def violation(program: IntegerProgram, x: Array) -> float:
    """The largest, relative to the bound or to 1e-4 of the terms."""
    G = program.normals
    values, outside = G @ x, 0.0
    terms = np.maximum(1.0, 1e-4 * (np.abs(G) @ np.abs(x)))
    for bound, sign in ((program.lower, 1.0), (program.upper, -1.0)):
        there = np.isfinite(bound)
        excess = sign * (bound - values)[there] / np.maximum(terms, np.abs(bound))[there]
        outside = max(outside, float(excess.max(initial=0.0)))
    return outside


def _of_minimizer(program: IntegerProgram, x: Array) -> Verdict:
    """A local minimizer: quickly where strict multipliers and curvatures are clear, else exactly."""
    if violation(program, x) > CLEAR:
        return Verdict.FALSE_MINIMIZER
    if _too_far(program, x):
        return Verdict.UNSETTLED
    equal, inwards, _ = _active(program, x)
    gradient = program.H @ x + program.c
    multipliers, residual = _multipliers(gradient, equal, inwards)
    size = max(1.0, float((np.abs(program.H) @ np.abs(x) + np.abs(program.c)).max()))
    if residual > CLEAR * size:
        return Verdict.FALSE_MINIMIZER
    strong = inwards[multipliers > 1e-7 * size]
    N = _null_space(np.vstack([equal, strong]))
    if N.shape[1] == 0 or np.linalg.eigvalsh(N.T @ program.H @ N)[0] > -CLOSE:
        return Verdict.RIGHT
    return _exactly(program, x)


def _too_far(program: IntegerProgram, x: Array) -> bool:
    """Whether digits are lost in the gradient or in a constraint that is not clearly inside its bounds."""
    values, terms = program.normals @ x, np.abs(program.normals) @ np.abs(x)
    doubtful = np.minimum(values - program.lower, program.upper - values) <= CLEAR * terms
    return max(float((np.abs(program.H) @ np.abs(x)).max()), float(terms[doubtful].max(initial=0.0))) > FAR


def _active(program: IntegerProgram, x: Array, close: float = CLEAR) -> tuple[Array, Array, list[tuple[int, float]]]:
    """Normals of equalities, of other active constraints (inwards), and the number and bound of each."""
    G, lower, upper = program.normals, program.lower, program.upper
    values = G @ x
    equality = lower == upper
    low, high = (
        np.isfinite(bound) & ~equality & (np.abs(values - bound) <= close * np.maximum(1.0, np.abs(bound)))
        for bound in (lower, upper)
    )
    named = [(int(i), float(lower[i])) for i in np.flatnonzero(equality | low)]
    named += [(int(i), float(upper[i])) for i in np.flatnonzero(high)]
    return G[equality], np.vstack([G[low], -G[high]]), named


def _multipliers(gradient: Array, equal: Array, inwards: Array) -> tuple[Array, float]:
    """Multipliers >= 0 of the inequalities, and the largest component of the gradient that is left over."""
    normals = np.vstack([equal, -equal, inwards])
    if len(normals) == 0:
        return np.zeros(0), float(np.abs(gradient).max())
    try:
        y, _ = nnls(normals.T, gradient)
    except RuntimeError:
        y = linprog(np.ones(len(normals)), A_eq=normals.T, b_eq=gradient).x
        y = np.zeros(len(normals)) if y is None else y
    return y[2 * len(equal) :], float(np.abs(gradient - normals.T @ y).max())


def _null_space(rows: Array) -> Array:
    """Orthonormal columns; a singular value below 1e-9 is none, or is decided by fractions if it is no rounding."""
    if len(rows) == 0:
        return np.eye(rows.shape[1])
    _, sizes, V = np.linalg.svd(rows)
    if ((sizes > 1e-15 * sizes[0]) & (sizes < 1e-6 * sizes[0])).any():
        return _exact_null_space(rows)
    return V[int(np.sum(sizes > CLOSE)) :].T


def _exact_null_space(rows: Array) -> Array:
    """The null space of the rows as they are, by one solution in fractions for each free unknown."""
    homogeneous, found = [[*row, Fraction(0)] for row in _exact(rows)], []
    for unit in np.eye(rows.shape[1]):
        solution = solved_exactly(homogeneous, unit.size, [Fraction(float(v)) for v in unit])
        found.append([float(v) for v in solution or []])
    basis = np.array([d for d in found if any(d)]).reshape(-1, rows.shape[1])
    U, sizes, _ = np.linalg.svd(basis.T / np.abs(basis).max(axis=1, initial=0.0), full_matrices=False)
    return U[:, sizes > 1e-15 * sizes.max(initial=0.0)]


def _exactly(program: IntegerProgram, x: Array) -> Verdict:
    """Whether an exact first-order point next to x has a direction of its critical cone that falls."""
    point = _exact_point(program, x)
    if point is None:
        return Verdict.UNSETTLED
    near = np.array([float(value) for value in point])
    if np.abs(near - x).max() > 1e-4 * max(1.0, float(np.abs(x).max())) or violation(program, near) > 1e-12:
        return Verdict.UNSETTLED
    equal, inwards, _ = _active(program, near, 1e-12)
    gradient = program.H @ near + program.c
    if _multipliers(gradient, equal, inwards)[1] > 1e-8 * max(1.0, float(np.abs(gradient).max())):
        return Verdict.FALSE_MINIMIZER
    exact_gradient = [
        sum((Fraction(float(h)) * v for h, v in zip(row, point, strict=True)), Fraction(float(b)))
        for row, b in zip(program.H, program.c, strict=True)
    ]
    rows = [*_exact(equal), exact_gradient]
    return _of_cone(program.H, rows, inwards)


def _of_cone(H: Array, rows: list[Row], inwards: Array) -> Verdict:
    """Whether {d : rows d = 0, inwards d >= 0} has a direction of negative curvature, sought on all its faces."""
    floats = np.array([[float(v) for v in row] for row in rows]).reshape(len(rows), H.shape[0])
    sizes = np.abs(floats).max(axis=1, initial=0.0)
    floats = floats / np.exp2(np.rint(np.log2(np.where(sizes > 0.0, sizes, 1.0))))[:, None]  # which changes no digit
    doubtful = False
    for count in range(min(len(inwards), H.shape[0]) + 1):
        for face in combinations(range(len(inwards)), count):
            N = _null_space(np.vstack([floats, inwards[list(face)]]))
            if N.shape[1] == 0:
                continue
            values, vectors = np.linalg.eigh(N.T @ H @ N)
            for column in np.flatnonzero(values < -CLOSE):
                for d in (N @ vectors[:, column], -(N @ vectors[:, column])):
                    if np.all(inwards @ d >= -CLOSE):
                        exact = _snapped([*rows, *_exact(inwards[list(face)])], d)
                        if _falls_exactly(H, inwards, exact):
                            return Verdict.FALSE_MINIMIZER
                        doubtful = True
    return Verdict.UNSETTLED if doubtful else Verdict.RIGHT


def _falls_exactly(H: Array, inwards: Array, d: Row) -> bool:
    """Whether the direction is in the cone and has negative curvature, in fractions."""
    if any(_product(row, d) < 0 for row in _exact(inwards)):
        return False
    return _product([_product(row, d) for row in _exact(H)], d) < 0


def _exact_point(program: IntegerProgram, x: Array) -> Row | None:
    """Where the active constraints hold and the gradient is a combination of their normals, next to x."""
    solution = _stationary(program, [_rational(v) for v in x], _active(program, x)[2])
    return None if solution is None else solution[1]


def _stationary(program: IntegerProgram, guess: Row, held: list[tuple[int, float]]) -> tuple[Row, Row] | None:
    """Multipliers and a point where the constraints are at these bounds and the gradient is that of the multipliers."""
    numbers, G, k = [number for number, _ in held], program.normals, len(held)
    rows = [
        [*[Fraction(0)] * k, *row, Fraction(float(b))] for row, (_, b) in zip(_exact(G[numbers]), held, strict=True)
    ]
    for i, row in enumerate(_exact(program.H)):
        of_rows = [-Fraction(float(G[number, i])) for number in numbers]
        rows.append([*of_rows, *row, -Fraction(float(program.c[i]))])
    solution = solved_exactly(rows, k + len(guess), [Fraction(0)] * k + guess)
    return None if solution is None else (solution[:k], solution[k:])


def _at_working_set(program: IntegerProgram, units: Units, x: Array, sides: NDArray[np.int8]) -> Verdict:
    """Judge the exact point of the working set in fractions, if it is feasible and x is where it is in these units."""
    solution = _stationary(program, [Fraction(float(v)) for v in x], _held(program, sides))
    if solution is None or not (_is_near(solution[1], x) or _is_where_stated(program, units, x, sides)):
        return Verdict.UNSETTLED
    (multipliers, point), G = solution, program.normals
    bounds = _exact_bounds(program, point)
    if bounds is None:
        return Verdict.UNSETTLED
    equal = program.lower == program.upper
    sizes = np.zeros(sides.size, dtype=object)
    sizes[np.flatnonzero(sides)] = multipliers
    at_lower, at_upper = bounds[0] & ~equal, bounds[1] & ~equal
    if ((sizes * sides.astype(int) > 0) & ~equal).any():  # others may be right where active normals are dependent
        gradient = [_product(row, [*point, Fraction(1)]) for row in _exact(np.column_stack([program.H, program.c]))]
        falls = _slope_falls(gradient, G[equal], np.vstack([G[at_lower], -G[at_upper]]))
        return Verdict.FALSE_MINIMIZER if falls else Verdict.UNSETTLED
    weak = sizes == 0
    return _of_cone(program.H, _exact(G[~weak | equal]), np.vstack([G[at_lower & weak], -G[at_upper & weak]]))


def _is_where_stated(program: IntegerProgram, units: Units, x: Array, sides: NDArray[np.int8]) -> bool:
    """Whether x is next to the point of the working set of the program in these units, the rounding of which moves it.

    Powers of ten are no doubles, and rows that are parallel up to 1e-5 move a point by 1e5 times their rounding.
    """
    H, c, A, cl, cu, bl, bu = program.stated(units)
    stated = IntegerProgram(H=H, c=c, A=A, lower=np.concatenate([bl, cl]), upper=np.concatenate([bu, cu]))
    solution = _stationary(stated, [Fraction(float(v)) for v in x / units.columns], _held(stated, sides))
    if solution is None:
        return False
    return _is_near([v * Fraction(float(unit)) for v, unit in zip(solution[1], units.columns, strict=True)], x)


def _is_near(point: Row, x: Array) -> bool:
    """Whether an exact point is next to x."""
    return _distance(point, x) <= NEAR * max(1.0, float(np.abs(x).max()))


def _distance(point: Row, x: Array) -> float:
    """The largest difference of a component."""
    return max(abs(float(v - Fraction(float(w)))) for v, w in zip(point, x, strict=True))


def _exact_bounds(program: IntegerProgram, point: Row) -> tuple[NDArray[np.bool_], NDArray[np.bool_]] | None:
    """Which constraints are at their lower and at their upper bound; None if one is violated."""
    values = [_product(row, point) for row in _exact(program.normals)]
    pairs = list(zip(program.lower, values, program.upper, strict=True))
    if not all(low <= value <= high for low, value, high in pairs):
        return None
    return np.array([low == v for low, v, _ in pairs]), np.array([v == high for _, v, high in pairs])


def _slope_falls(gradient: Row, equal: Array, inwards: Array) -> bool:
    """Whether a direction that all active constraints allow has a negative slope; sought by a linear program."""
    g = np.array([float(v) for v in gradient])
    bounds = [(-1.0, 1.0)] * g.size
    lengths = np.abs(inwards).max(axis=1, keepdims=True, initial=1.0)
    found = linprog(g, -inwards / lengths, np.zeros(len(inwards)), equal, np.zeros(len(equal)), bounds=bounds)
    if found.status != 0 or found.fun > -CLEAR:
        return False
    held = np.abs(inwards @ found.x) <= CLOSE * lengths[:, 0]
    d = _snapped(_exact(np.vstack([equal, inwards[held]])), found.x)
    return all(_product(row, d) >= 0 for row in _exact(inwards)) and _product(gradient, d) < 0


def _snapped(rows: list[Row], d: Array) -> Row:
    """The direction with the components that the rows leave free made rational, the others computed from them."""
    scaled = d / np.abs(d).max()
    homogeneous = [[*row, Fraction(0)] for row in rows]
    solution = solved_exactly(homogeneous, d.size, [_rational(v) for v in scaled])
    return solution if solution is not None else [Fraction(0)] * d.size


def _rational(value: float) -> Fraction:
    """A fraction of a small denominator if there is one near, else the number itself."""
    for limit in (1000, 10**6):
        near = Fraction(value).limit_denominator(limit)
        if abs(float(near) - value) <= 1e-8 * max(1.0, abs(value)):
            return near
    return Fraction(value)


def solved_exactly(rows: list[Row], unknowns: int, guess: Row) -> Row | None:
    """A solution of rows [a | b] a x = b, free unknowns as guessed, by elimination in fractions; None if none."""
    rows, pivots = [list(row) for row in rows], []
    at = 0
    for column in range(unknowns):
        pivot = next((i for i in range(at, len(rows)) if rows[i][column]), None)
        if pivot is None:
            continue
        rows[at], rows[pivot] = rows[pivot], rows[at]
        head = rows[at][column]
        rows[at] = [v / head for v in rows[at]]
        for i, row in enumerate(rows):
            if i != at and (factor := row[column]):
                rows[i] = [v - factor * w for v, w in zip(row, rows[at], strict=True)]
        pivots.append(column)
        at += 1
    if any(row[-1] for row in rows[at:]):
        return None
    x = list(guess)
    fixed = set(pivots)
    for row, column in zip(rows, pivots, strict=False):
        x[column] = row[-1] - sum(
            (row[j] * guess[j] for j in range(unknowns) if j not in fixed and row[j]), Fraction(0)
        )
    return x


def _exact(rows: Array) -> list[Row]:
    """Whole numbers as fractions."""
    return [[Fraction(float(v)) for v in row] for row in rows]


def _product(a: Row, b: Row) -> Fraction:
    return sum((v * w for v, w in zip(a, b, strict=True) if v and w), Fraction(0))


def _of_ray(program: IntegerProgram, x: Array, ray: Array, sides: NDArray[np.int8]) -> Verdict:
    """A ray: recession direction on which the objective falls without end."""
    G, H, d = program.normals, program.H, ray / np.abs(ray).max()
    along, rounding = G @ d, 1e-8 * (np.abs(G) @ np.abs(d))
    falls, rises = np.isfinite(program.lower), np.isfinite(program.upper)
    leaves = (falls & (along < -rounding)) | (rises & (along > rounding))
    held = (falls | rises) & (np.abs(along) <= rounding)
    exact = _snapped(_exact(G[held]), d)
    point = _feasible_point(program, x, exact, sides)
    if leaves.any() or (point is None and violation(program, x) > CLEAR):
        return Verdict.FALSE_UNBOUNDED
    curvature, product = float(d @ H @ d), float(np.abs(d) @ np.abs(H) @ np.abs(d))
    if curvature < -CLEAR * product:  # the nearest direction that meets the rows exactly has it too
        return Verdict.RIGHT
    if _distance(exact, d) > 1e-6:
        return Verdict.UNSETTLED
    if _falls_without_end(program, point, exact):
        return Verdict.RIGHT
    gradient = H @ x + program.c
    terms = float((np.abs(H) @ np.abs(x) + np.abs(program.c)) @ np.abs(d))
    if abs(curvature) <= CLOSE * product and gradient @ d < -CLEAR * terms:
        return Verdict.RIGHT
    least = _least_slope(program, exact)
    if -CLEAR <= least < -CLOSE:
        return Verdict.UNSETTLED
    return Verdict.WEAK_RAY if least < 0.0 else _unbounded_at_all(program)


def _falls_without_end(program: IntegerProgram, point: Row | None, d: Row) -> bool:
    """Whether the objective falls without end along the direction, from a feasible point if it depends on that."""
    along = np.array([_product(row, d) for row in _exact(program.normals)])
    if (along[np.isfinite(program.lower)] < 0).any() or (along[np.isfinite(program.upper)] > 0).any():
        return False
    bent = [_product(row, d) for row in _exact(program.H)]
    curvature, slope = _product(bent, d), _product(_exact(program.c[None])[0], d)
    if curvature or not any(bent):
        return curvature < 0 or (curvature == 0 and slope < 0)  # where H sees nothing, the slope is that of c
    return point is not None and slope + _product(bent, point) < 0


def _least_slope(program: IntegerProgram, d: Row) -> float:
    """Least slope along a straight recession direction from any feasible point, by linear programming; else 0."""
    n, along = program.c.size, [_product(row, d) for row in _exact(program.normals)]
    bent = [_product(row, d) for row in _exact(program.H)]
    stays = all(v >= 0 or low == -np.inf for v, low in zip(along, program.lower, strict=True))
    stays = stays and all(v <= 0 or high == np.inf for v, high in zip(along, program.upper, strict=True))
    if not stays or _product(bent, d) != 0:
        return 0.0
    high, low = np.isfinite(program.upper[n:]), np.isfinite(program.lower[n:])
    A, b = np.vstack([program.A[high], -program.A[low]]), np.r_[program.upper[n:][high], -program.lower[n:][low]]
    bounds = list(zip(program.lower[:n], program.upper[:n], strict=True))
    least = linprog([float(v) for v in bent], A if len(A) else None, b if len(A) else None, bounds=bounds)
    slope = float(_product(_exact(program.c[None])[0], d))
    return {0: (least.fun or 0.0) + slope, 3: -np.inf}.get(least.status, 0.0)


def _feasible_point(program: IntegerProgram, x: Array, d: Row, sides: NDArray[np.int8]) -> Row | None:
    """An exact feasible point next to x, or a little further along the ray d, with the working set at its bounds."""
    lower, upper, size = program.lower[: x.size], program.upper[: x.size], max(1.0, float(np.abs(x).max()))
    clipped = np.where(np.abs(x - lower) < CLOSE, lower, np.where(np.abs(x - upper) < CLOSE, upper, x))
    for held in (_held(program, sides), _active(program, x, CLEAR)[2], _active(program, x, CLOSE)[2]):
        rows = _exact(program.normals[[number for number, _ in held]])
        rows = [[*row, Fraction(float(bound))] for row, (_, bound) in zip(rows, held, strict=True)]
        for guess in (clipped, x):
            point = solved_exactly(rows, x.size, [Fraction(float(v)) for v in guess])
            for step in (Fraction(0), Fraction(NEAR * size)):
                moved = None if point is None else [v + step * w for v, w in zip(point, d, strict=True)]
                if moved and _distance(moved, x) <= 2 * NEAR * size and _exact_bounds(program, moved) is not None:
                    return moved
    return None


def _held(program: IntegerProgram, sides: NDArray[np.int8]) -> list[tuple[int, float]]:
    """Number and bound of each constraint of a working set."""
    return [(int(i), float(program.upper[i] if sides[i] == 1 else program.lower[i])) for i in np.flatnonzero(sides)]


def _unbounded_at_all(program: IntegerProgram) -> Verdict:
    """Whether some recession direction has negative curvature, or none and an objective that falls along it."""
    falls, rises = np.isfinite(program.lower), np.isfinite(program.upper)
    inwards = np.vstack([program.normals[falls], -program.normals[rises]])
    if _of_cone(program.H, [], inwards) is Verdict.FALSE_MINIMIZER:
        return Verdict.WEAK_RAY
    n = program.c.size
    flat = [*_exact(program.H)]
    A = np.vstack([np.array([[float(v) for v in row] for row in flat])])
    bounds = [(-1.0, 1.0)] * n
    least = linprog(program.c, A_ub=-inwards, b_ub=np.zeros(len(inwards)), A_eq=A, b_eq=np.zeros(n), bounds=bounds)
    return Verdict.WEAK_RAY if least.status == 0 and least.fun < -CLEAR else Verdict.FALSE_UNBOUNDED


def _of_certificate(program: IntegerProgram, of_rows: Array) -> Verdict:
    """Farkas multipliers made rational; where this proves nothing, a linear program decides."""
    lower, upper, largest = program.lower, program.upper, float(np.abs(of_rows).max(initial=0.0))
    y = of_rows / (largest or 1.0)
    used, cancels = y != 0.0, np.abs(program.A.T @ y) <= CLOSE * (np.abs(program.A.T) @ np.abs(y))
    conditions = [[*row, Fraction(0)] for row in _exact(program.A[used][:, cancels].T)]
    of_used = solved_exactly(conditions, int(used.sum()), [Fraction(float(v)) for v in y[used]]) or []
    rows = np.zeros(y.size, dtype=object)
    rows[used] = of_used
    columns = [-_product(row, list(rows)) for row in _exact(program.A.T)]
    total = Fraction(0)
    for y, low, high in zip([*columns, *rows], lower, upper, strict=False):
        bound = low if y > 0 else high
        if y and np.isinf(bound):
            break
        total += y * Fraction(float(bound)) if y else 0
    else:
        if total > 0:
            return Verdict.RIGHT
    return _infeasible_at_all(program)


def _infeasible_at_all(program: IntegerProgram) -> Verdict:
    """By linear programming: data are whole and small, and its tolerance is 1e-7."""
    n, lower, upper = program.c.size, program.lower, program.upper
    high, low = np.isfinite(upper[n:]), np.isfinite(lower[n:])
    A = np.vstack([program.A[high], -program.A[low]])
    b = np.concatenate([upper[n:][high], -lower[n:][low]])
    bounds = list(zip(lower[:n], upper[:n], strict=True))
    status = linprog(np.zeros(n), A if len(A) else None, b if len(A) else None, bounds=bounds).status
    return Verdict.RIGHT if status == 2 else Verdict.FALSE_INFEASIBLE
