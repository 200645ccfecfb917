"""The regular iterations of both phases on one tableau, as machine code by numba (the extra ``fast``).

The rows of the tableau T (n, n) are directions. The first k are conjugate, zᵀHz = 1, and change nothing that is held.
Of the others, one belongs to each constraint that is held: it moves this one by one, and no other that is held. The
rest are temporary: they change nothing that is held, and their curvature is still to be seen. All these are conjugate
to the first k.

So T g, g the gradient, holds the slopes of the Newton step and the multipliers, and a change of the working set changes
T by a matrix of rank one to three. The rules of pricing and of the ratio test are those of `phase_two` and
`ratio_test`. Phase one moves along one row of T at a time, as the simplex method does.

Nothing is claimed here. Both phases begin where this ends, with factors of their own from the data. It ends early where
an iteration is not regular: on a ray, on what may be rounding, on steps of length zero without end.

Machine code that was kept knows the functions of this file, and the constants of others: a change of those needs a
change here. So all of it is in one file.
"""

import math
from heapq import heapify, heappop
from typing import Any, NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.compilation import compiled
from bemcontact.formulations.local_solver.factorizations import dot
from bemcontact.formulations.local_solver.phase_one import is_violated
from bemcontact.formulations.local_solver.phase_two import ReducedHessian
from bemcontact.formulations.local_solver.progress import PARALLEL, STALLED, SearchState
from bemcontact.formulations.local_solver.ratio_test import FAINT
from bemcontact.formulations.local_solver.statement import EPS, Sides, Statement, largest
from bemcontact.formulations.local_solver.working_set import EQUALITY


def _integers(*numbers: int) -> tuple[Any, ...]:
    """Numbers which numba does not take for constants: for each of those it would compile a function anew."""
    return tuple(np.intp(number) for number in numbers)


TEMPORARY, CONJUGATE = _integers(-1, -2)
"""Owners of rows of T that belong to no constraint."""
NONE, IRREGULAR = _integers(-1, -2)
"""No constraint ends the step, and: constraints that hardly move would have to be looked at."""
CLEAR = 10.0
"""A multiplier of the wrong sign is released if it exceeds the zero of all by this factor."""
ROUNDED, SURE = 100.0, 1e-8
"""A curvature is zero up to the first times EPS n of its terms, and not doubtful above the second of the largest entry
of H."""
SMALL = 1e-7
"""A multiplier of the sum of violations is zero up to this part of its terms."""
LARGE_PIVOT, PIVOT = 0.1, 1e-7
"""Least cosine between a row of T and the normal of a constraint that is held in its place at the start."""
REACHED = 1e-13
"""A Newton step that is no longer than this part of the distance traveled is rounding."""
ROOM = 4
"""Iterations over the number of constraints after which the rest is left to the phases."""


class FlatProgram(NamedTuple):
    """Numbers of a `SearchState` as arrays (n,), (n + m,), which are not changed."""

    H: Array
    c: Array
    A: Array
    lower: Array
    upper: Array
    slack: Array
    equality: BoolArray


class Tableau(NamedTuple):
    """What the iterations change.

    Parameters
    ----------
    T : (n, n)
    owner : (n,) constraint of each row of T
    signs : (n,) -1 where that is at its lower, +1 where it is at its upper bound, else 0
    sides : (n + m,) of what is held, as in `WorkingSet`
    values : (n + m,) [x; A x]
    along : (n + m,) [d; A d] of a step
    passed : (n + m,) whether the ratio test leaves a constraint out
    gradient, slopes : (n,) g and T g
    across : (n,) T a of the normal a of a constraint that enters
    bent : (n,) H d
    work : (n + m,)
    counts : rows of T that are conjugate, iterations, steps of length zero in sequence
    measures : objective, size of a gradient that is zero, distance traveled
    log : (6, room) value, step, constraint that entered, owner of the row moved along, and the rest of a `LogLine`
    """

    T: Array
    owner: IntArray
    signs: Array
    sides: Sides
    values: Array
    along: Array
    passed: BoolArray
    gradient: Array
    slopes: Array
    across: Array
    bent: Array
    work: Array
    counts: IntArray
    measures: Array
    log: Array


class Limits(NamedTuple):
    """Numbers that do not change in a run: as in `SearchState`, and the largest entry of H."""

    least_terms: float
    tolerance: float
    rounding: float
    long: float
    farthest: float
    top: float
    iterations: int


@compiled(inner=True, reorder=True)
def _dot(a: Array, b: Array) -> float:
    """a·b."""
    product = 0.0
    for i in range(a.size):
        product += a[i] * b[i]
    return product


@compiled(inner=True)
def _times(matrix: Array, vector: Array, product: Array) -> None:
    """The product of a matrix with a vector, row by row."""
    for i in range(matrix.shape[0]):
        product[i] = _dot(matrix[i], vector)


@compiled(inner=True)
def _add_multiple(factor: float, vector: Array, total: Array) -> None:
    """Add a multiple of a vector."""
    for i in range(vector.size):
        total[i] += factor * vector[i]


@compiled(inner=True)
def _divide(row: Array, divisor: float) -> None:
    """Divide a row in place."""
    for i in range(row.size):
        row[i] /= divisor


@compiled(inner=True)
def _combine(factors: Array, rows: Array, total: Array) -> None:
    """Σ factor · row, from the first on."""
    for i in range(total.size):
        total[i] = 0.0
    for i in range(factors.size):
        if factors[i] != 0.0:
            _add_multiple(factors[i], rows[i], total)


@compiled(inner=True)
def _subtract(t: Tableau, factors: Array, row: Array, first: int) -> None:
    """Subtract multiples of a row from those of T from the first on."""
    for i in range(first, factors.size):
        if factors[i] != 0.0:
            _add_multiple(-factors[i], row, t.T[i])


@compiled(inner=True)
def _look_across(p: FlatProgram, t: Tableau, constraint: int) -> None:
    """How much each row of T moves a constraint: `across`."""
    n = p.c.size
    if constraint < n:
        for i in range(n):
            t.across[i] = t.T[i, constraint]
    else:
        _times(t.T, p.A[constraint - n], t.across)


@compiled(inner=True)
def _let_go(t: Tableau, place: int, owner: int) -> None:
    """A row of T belongs to its constraint no longer."""
    constraint = t.owner[place]
    if constraint >= 0:
        t.sides[constraint] = 0
    t.owner[place], t.signs[place] = owner, 0.0


@compiled(inner=True)
def _hold(t: Tableau, place: int, constraint: int, side: int) -> None:
    """A row of T is that of a constraint which enters the working set."""
    _let_go(t, place, constraint)
    if side != EQUALITY:
        t.signs[place] = side
    t.sides[constraint] = side
    n = t.owner.size
    if constraint < n:  # what is zero in truth has no rounding
        for i in range(n):
            t.T[i, constraint] = 0.0
        t.T[place, constraint] = 1.0


@compiled(inner=True)
def _exchange(t: Tableau, place: int, constraint: int, side: int) -> None:
    """The constraint enters, and moves with the row of a place, where no row is conjugate; `across` is used up."""
    moved, t.across[place] = t.across[place], 0.0
    row = t.T[place]
    _divide(row, moved)
    _subtract(t, t.across, row, 0)
    _hold(t, place, constraint, side)


@compiled(inner=True)
def _reflect(t: Tableau) -> float:
    """Reflect the conjugate rows so that the last of them alone moves what enters; by how much it does."""
    k = t.counts[0]
    across = t.across[:k]
    if k == 1:
        return across[0]
    length = math.sqrt(_dot(across, across))
    if length == 0.0:
        return 0.0
    sign = -1.0 if across[k - 1] > 0.0 else 1.0
    last = across[k - 1]
    across[k - 1] -= sign * length
    row = t.work[: t.owner.size]
    _combine(across, t.T, row)
    half = length * (length - sign * last)
    for i in range(k):
        _add_multiple(-across[i] / half, row, t.T[i])
    return sign * length


@compiled(inner=True)
def _enter(p: FlatProgram, t: Tableau, constraint: int, side: int) -> None:
    """The constraint that ended a Newton step enters: the conjugate rows become one fewer."""
    _look_across(p, t, constraint)
    last = _reflect(t)
    k = t.counts[0] - 1
    _divide(t.T[k], last)
    _subtract(t, t.across, t.T[k], k + 1)
    t.counts[0] = k
    _hold(t, k, constraint, side)


@compiled(inner=True)
def _join(t: Tableau, place: int, curvature: float) -> None:
    """The row of a place becomes conjugate; `bent` is H times it."""
    k, root = t.counts[0], math.sqrt(curvature)
    _let_go(t, place, CONJUGATE)
    for j in range(t.owner.size):
        t.T[place, j], t.T[k, j] = t.T[k, j], t.T[place, j] / root
    t.owner[place], t.signs[place] = t.owner[k], t.signs[k]
    t.owner[k], t.signs[k] = CONJUGATE, 0.0
    t.counts[0] = k + 1
    for i in range(k + 1, t.owner.size):
        _add_multiple(-_dot(t.bent, t.T[i]) / root, t.T[k], t.T[i])


@compiled(inner=True)
def _swap(p: FlatProgram, t: Tableau, place: int, curvature: float, constraint: int, side: int) -> bool:
    """The constraint ended a step along the row of a place, and enters; False if it does not move with T.

    `bent` is H times that row. What is left free of this row and the last conjugate one becomes conjugate if its
    curvature is clearly positive, else temporary.
    """
    _look_across(p, t, constraint)
    moved, k, n = t.across[place], t.counts[0], t.owner.size
    if moved == 0.0:
        return False
    if k == 0:
        _exchange(t, place, constraint, side)
        return True
    last = _reflect(t)
    square = last * last * curvature + moved * moved
    if curvature >= 0.0 or square > 0.5 * moved * moved:
        root = math.sqrt(square)
        for i in range(k, n):
            t.work[i] = _dot(t.bent, t.T[i]) * (last / root)
        free, response = t.T[k - 1], t.T[place]
        for j in range(n):
            free[j], response[j] = (
                (last * response[j] - moved * free[j]) / root,
                (moved * response[j] + last * curvature * free[j]) / square,
            )
        t.work[place] = t.across[place] = 0.0
        for i in range(k, n):
            _add_multiple(-t.work[i], free, t.T[i])
            _add_multiple(-t.across[i], response, t.T[i])
        _hold(t, place, constraint, side)
        return True
    _divide(t.T[k - 1], last)
    _subtract(t, t.across, t.T[k - 1], k)
    t.counts[0] = k - 1
    _let_go(t, place, TEMPORARY)
    _hold(t, k - 1, constraint, side)
    return True


@compiled(inner=True)
def _price(t: Tableau, zero: float) -> tuple[int, float]:
    """The row of T to move along: a temporary one, else that of the multiplier with the wrong sign; NONE if none is."""
    best, place, score, chosen = zero, NONE, zero, NONE
    for i in range(t.counts[0], t.owner.size):
        if t.owner[i] == TEMPORARY:
            if abs(t.slopes[i]) > best:
                best, place = abs(t.slopes[i]), i
        elif t.signs[i] * t.slopes[i] > score:
            score, chosen = t.signs[i] * t.slopes[i], i
    return (place, best) if place != NONE else (chosen, score)


@compiled(inner=True)
def _set_along(p: FlatProgram, t: Tableau, factor: float, place: int) -> float:
    """Set `along` to a multiple of a row of T; the length of it."""
    n = p.c.size
    for i in range(n):
        t.along[i] = factor * t.T[place, i]
    _times(p.A, t.along[:n], t.along[n:])
    return math.sqrt(_dot(t.along[:n], t.along[:n]))


@compiled(inner=True)
def _nearest(p: FlatProgram, t: Tableau, length: float, end: float, long: float) -> tuple[int, float]:
    """As `ratio_test.nearest`, but without a look at what hardly moves."""
    faint, least, at, slow = PARALLEL * length, math.inf, NONE, False
    for i in range(t.along.size):
        if t.passed[i]:
            continue
        speed = abs(t.along[i])
        if speed <= faint:
            slow = slow or speed > FAINT * length
            continue
        step = ((p.upper[i] if t.along[i] > 0.0 else p.lower[i]) - t.values[i]) / t.along[i]
        if step < least:
            least, at = step, i
    if slow and min(end, least) * length > long:
        return IRREGULAR, 0.0
    if at == NONE or least > end:
        return NONE, 0.0
    late, later = least + p.slack[at] / abs(t.along[at]), math.inf
    for second in range(2):
        fastest = 0.0
        for i in range(t.along.size):
            speed = abs(t.along[i])
            if t.passed[i] or speed <= faint:
                continue
            step = ((p.upper[i] if t.along[i] > 0.0 else p.lower[i]) - t.values[i]) / t.along[i]
            if step > late:
                continue
            if second == 0:
                later = min(later, step + p.slack[i] / speed)
            elif step <= later and speed > fastest:
                fastest, least, at = speed, step, i
    return (at, max(least, 0.0)) if least <= end else (NONE, 0.0)


@compiled(inner=True)
def _side(p: FlatProgram, t: Tableau, constraint: int) -> int:
    """As `ratio_test.side_reached`."""
    if p.equality[constraint]:
        return EQUALITY
    return -1 if t.along[constraint] < 0.0 else 1


@compiled(inner=True)
def _move(t: Tableau, step: float, length: float) -> None:
    """As `SearchState.move`."""
    t.counts[2] = 0 if step * length > 1e-11 else t.counts[2] + 1
    if step > 0.0:
        t.measures[2] += step * length
        _add_multiple(step, t.along, t.values)


@compiled(inner=True)
def _write(t: Tableau, value: float, step: float, added: int, owner: int, nonpositive: float) -> None:
    """Log an iteration."""
    line = t.log[:, t.counts[1]]
    line[0], line[1], line[2], line[3], line[5] = value, step, added, owner, nonpositive
    line[4] = t.owner.size - t.counts[0]
    t.counts[1] += 1


@compiled(inner=True)
def _is_at_end(t: Tableau, limits: Limits) -> bool:
    """Whether the iterations are used up, or the steps have no length."""
    return t.counts[1] >= limits.iterations or t.counts[2] > STALLED


@compiled(inner=True)
def _breakpoint(p: FlatProgram, t: Tableau, signs: Array, length: float) -> tuple[int, int, float]:
    """As `phase_one._breakpoint`: the constraint, its side, and the step; NONE if there is none."""
    ahead = []  # breakpoints: time, and what the slope gains there
    for i in range(signs.size):
        towards = -signs[i] * t.along[i]
        if towards > 1e-10 * length:
            bounds = (p.lower[i], p.upper[i]) if signs[i] < 0.0 else (p.upper[i], p.lower[i])
            for far in range(2):
                ahead.append((abs(bounds[far] - t.values[i]) / towards, -towards, i, far))
    heapify(ahead)
    fall, step, at, side = -(1.0 - 1e-12) * _dot(signs, t.along), -math.inf, NONE, 0
    while len(ahead) > 0 and fall > 0.0:
        time, change, i, far = heappop(ahead)
        if time > step:  # the fastest of those at one time comes first
            step, at, side = time, i, _side(p, t, i)
            if far == 0 and side != EQUALITY:
                side = -side
        fall += change
    return (at, side, step) if fall <= 0.0 and step < math.inf else (NONE, 0, 0.0)


@compiled(inner=True)
def _hold_rows(p: FlatProgram, t: Tableau, wanted: IntArray) -> None:
    """Hold rows that are wanted, each in place of a temporary row of T."""
    n = p.c.size
    for cosine in (LARGE_PIVOT, PIVOT):  # those that are nearly dependent last
        for constraint in range(n, wanted.size):
            if wanted[constraint] == 0 or t.sides[constraint] != 0:
                continue
            _look_across(p, t, constraint)
            place, best = NONE, 0.0
            for i in range(n):
                if t.owner[i] == TEMPORARY and abs(t.across[i]) > best:
                    place, best = i, abs(t.across[i])
            if place != NONE:
                normal, row = p.A[constraint - n], t.T[place]
                if best * best > cosine * cosine * _dot(normal, normal) * _dot(row, row):
                    _exchange(t, place, constraint, wanted[constraint])


@compiled(inner=True)
def _place_on_rows(p: FlatProgram, t: Tableau, farthest: float) -> bool:
    """Move to the nearest point on the rows that are held; False if it is too far away to keep its digits."""
    n, k, shift = p.c.size, 0, t.bent
    free = np.empty((n, n))  # the temporary rows, made orthonormal
    for j in range(n):
        shift[j] = 0.0
    for i in range(n):
        constraint = t.owner[i]
        if constraint >= n:
            bounds = p.upper if t.sides[constraint] == 1 else p.lower
            _add_multiple(float(bounds[constraint] - t.values[constraint]), t.T[i], shift)
    for i in range(n):
        if t.owner[i] == TEMPORARY:
            row = free[k]
            for j in range(n):
                row[j] = t.T[i, j]
            for j in range(k):
                _add_multiple(-_dot(row, free[j]), free[j], row)
            _divide(row, math.sqrt(_dot(row, row)))
            _add_multiple(-_dot(shift, row), row, shift)
            k += 1
    if not _dot(shift, shift) <= farthest * farthest:
        return False
    _add_multiple(1.0, shift, t.values[:n])
    _times(p.A, t.values[:n], t.values[n:])
    return True


@compiled()
def find_feasible_point(p: FlatProgram, t: Tableau, wanted: IntArray, limits: Limits) -> bool:
    """Phase one, from a tableau without conjugate rows and rows that are wanted: whether the point is feasible."""
    _hold_rows(p, t, wanted)
    if not _place_on_rows(p, t, limits.farthest):
        return False
    n, size = p.c.size, t.values.size
    signs, sum_gradient = t.work, t.gradient
    while True:
        violated = 0
        for i in range(size):
            signs[i] = 0.0
            if t.sides[i] != 0:
                pass
            elif t.values[i] > p.upper[i] + p.slack[i]:
                signs[i] = 1.0
            elif t.values[i] < p.lower[i] - p.slack[i]:
                signs[i] = -1.0
            violated += signs[i] != 0.0
            t.passed[i] = t.sides[i] != 0 or signs[i] != 0.0
        if violated == 0:
            return True
        if _is_at_end(t, limits):
            return False
        _combine(signs[n:], p.A, sum_gradient)
        _add_multiple(1.0, signs[:n], sum_gradient)
        _times(t.T, sum_gradient, t.slopes)
        place, _ = _price(t, SMALL * math.sqrt(violated))
        if place == NONE:
            return False
        length = _set_along(p, t, -1.0 if t.slopes[place] > 0.0 else 1.0, place)
        constraint, side, step = _breakpoint(p, t, signs, length)
        owner = t.owner[place]
        if owner >= 0:
            t.passed[owner] = False
        wall, before = _nearest(p, t, length, math.inf if constraint == NONE else step, limits.long)
        if wall >= 0 and (constraint == NONE or before < step):
            constraint, side, step = wall, _side(p, t, wall), before
        if constraint == NONE or wall == IRREGULAR:
            return False
        _move(t, step, length)
        if constraint == owner:
            t.signs[place], t.sides[owner] = side, side
        else:
            _look_across(p, t, constraint)
            if not abs(t.across[place]) > PARALLEL * length:
                return False
            _exchange(t, place, constraint, side)
        sum_of_violations = 0.0
        for i in range(size):
            sum_of_violations += max(p.lower[i] - t.values[i], t.values[i] - p.upper[i], 0.0)
        _write(t, sum_of_violations, step, constraint, owner, 0.0)


@compiled(inner=True)
def _look(p: FlatProgram, t: Tableau, limits: Limits) -> None:
    """Compute the gradient, what counts as zero beside its terms, and T g."""
    n = p.c.size
    _combine(t.values[:n], p.H, t.gradient)
    terms = max(math.sqrt(_dot(t.gradient, t.gradient) / n), limits.least_terms)
    t.measures[1] = max(limits.tolerance * terms, limits.rounding * t.measures[2])
    _add_multiple(1.0, p.c, t.gradient)
    _times(t.T, t.gradient, t.slopes)


@compiled(inner=True)
def _newton(p: FlatProgram, t: Tableau) -> float:
    """Set `along` to the Newton step; the length of it."""
    n, k = p.c.size, t.counts[0]
    _combine(t.slopes[:k], t.T, t.along[:n])
    for i in range(n):
        t.along[i] = -t.along[i]
    _times(p.A, t.along[:n], t.along[n:])
    return math.sqrt(_dot(t.along[:n], t.along[:n]))


@compiled(inner=True)
def _terms(p: FlatProgram, d: Array) -> float:
    """Size of the numbers whose rounding dᵀHd has, as in `Statement.rounding`."""
    terms, length, bent = 0.0, 0.0, 0.0
    for i in range(d.size):
        if d[i] != 0.0:
            product = 0.0
            for j in range(d.size):
                product += abs(p.H[i, j] * d[j])
            terms += abs(d[i]) * product
            length, bent = max(length, abs(d[i])), max(bent, product)
    return terms + length * bent


@compiled()
def descend(p: FlatProgram, t: Tableau, limits: Limits) -> None:
    """Phase two, until no multiplier is clearly wrong, or an iteration is not regular."""
    n, settled = p.c.size, False
    while not _is_at_end(t, limits):
        _look(p, t, limits)
        k, zero = t.counts[0], t.measures[1]
        for i in range(t.passed.size):
            t.passed[i] = t.sides[i] != 0
        square = _dot(t.slopes[:k], t.slopes[:k])
        if not settled and square * limits.top * n > (0.1 * zero) ** 2:
            length = _newton(p, t)
            if length <= REACHED * max(1.0, t.measures[2]):
                settled = True
                continue
            constraint, step = _nearest(p, t, length, 1.0, limits.long)
            if constraint == IRREGULAR:
                return
            if constraint == NONE:
                step, settled = 1.0, True
            _move(t, step, length)
            if constraint != NONE:
                _enter(p, t, constraint, _side(p, t, constraint))
            t.measures[0] -= step * (1.0 - 0.5 * step) * square
            _write(t, t.measures[0], step, constraint, NONE, 0.0)
            continue
        place, size = _price(t, zero)
        if place == NONE or not size > CLEAR * zero:
            return
        row = t.T[place]
        _combine(row, p.H, t.bent)
        curvature, sure = _dot(row, t.bent), limits.top * _dot(row, row)
        if abs(curvature) <= SURE * sure:
            if abs(curvature) > ROUNDED * EPS * n * _terms(p, row):
                return
            curvature = 0.0
        slope, owner = abs(t.slopes[place]), t.owner[place]
        length = _set_along(p, t, -1.0 if t.slopes[place] > 0.0 else 1.0, place)
        if owner >= 0:
            t.passed[owner] = False
        end = slope / curvature if curvature > 0.0 else math.inf
        constraint, step = _nearest(p, t, length, end, limits.long)
        if constraint == IRREGULAR or (constraint == NONE and curvature <= 0.0):
            return
        step = end if constraint == NONE else step
        _move(t, step, length)
        settled = constraint in (NONE, owner)
        if constraint == NONE:
            _join(t, place, curvature)
        elif constraint == owner:
            side = _side(p, t, constraint)
            t.signs[place], t.sides[owner] = side, side
        elif not _swap(p, t, place, curvature, constraint, _side(p, t, constraint)):
            return
        t.measures[0] += step * (0.5 * step * curvature - slope)
        if curvature > 0.0:
            _write(t, t.measures[0], step / end, constraint, owner, 0.0)
        else:
            _write(t, t.measures[0], step * length, constraint, owner, 1.0)
            if t.owner[place] == TEMPORARY:  # the direction remains free
                t.log[4, t.counts[1] - 1] -= 1.0


def regular_iterations(progress: SearchState, sides: Sides) -> Sides:
    """Take the regular iterations from a point and a working set (n + m,); `progress` goes on from where they end.

    Returns
    -------
    Sides
        (n + m,) the working set there, or the given one if no iteration has moved the point.
    """
    statement, n = progress.statement, progress.x.size
    p = FlatProgram(
        H=statement.H, c=statement.c, A=statement.A, lower=statement.lower, upper=statement.upper,
        slack=progress.slack, equality=statement.equality,
    )  # fmt: skip
    room = ROOM * progress.values.size
    limits = Limits(
        least_terms=progress.least_terms, tolerance=progress.tolerance, rounding=progress.rounding, long=progress.long,
        farthest=progress.farthest, top=largest(statement.absolute[0]),
        iterations=min(progress.limit - len(progress.lines), room),  # the limit may be too large for machine code
    )  # fmt: skip
    wanted = np.where(statement.equality, EQUALITY, sides.astype(np.intp))
    t, feasible = _start(progress, wanted[:n], room), True
    if np.count_nonzero(wanted[n:]) or is_violated(progress):
        feasible = find_feasible_point(p, t, wanted, limits)
    first = t.counts.item(1)
    if feasible:
        _make_conjugate(t, statement)
        t.measures[0], t.counts[2] = statement.objective(t.values[:n]), 0
        descend(p, t, limits)
    count = t.counts.item(1)
    moved = t.measures.item(2) > progress.far  # an answer at a point with many active constraints stays as it is
    if not moved or not math.isfinite(dot(t.values, t.values)):
        return sides
    progress.take_over(t.values[:n], t.log[:, :count], first)
    return t.sides


def _start(progress: SearchState, bounds: IntArray, room: int) -> Tableau:
    """A tableau of unit vectors: those of variables on their `bounds` (n,) move them, the others are temporary."""
    n, size = bounds.size, progress.values.size
    sides, T, owner, measures = np.zeros(size, dtype=np.int8), np.zeros((n, n)), np.arange(n), np.zeros(3)
    sides[:n], T.reshape(-1)[:: n + 1], owner[bounds == 0], measures[2] = bounds, 1.0, TEMPORARY, progress.far
    return Tableau(
        T=T,
        owner=owner,
        signs=(bounds * (bounds != EQUALITY)).astype(float),
        sides=sides,
        values=progress.values.copy(),
        along=np.empty(size),
        passed=np.empty(size, dtype=bool),
        gradient=np.empty(n),
        slopes=np.empty(n),
        across=np.empty(n),
        bent=np.empty(n),
        work=np.empty(size),
        counts=np.zeros(3, dtype=np.intp),
        measures=measures,
        log=np.empty((6, room)),
    )


def _make_conjugate(t: Tableau, statement: Statement) -> None:
    """Make those temporary rows conjugate on which H is definite, and all others conjugate to them."""
    temporary = t.owner == TEMPORARY
    if not np.count_nonzero(temporary):
        return
    others = ~temporary
    hessian = ReducedHessian(statement, t.T[temporary].T)
    k, left, Z = hessian.size, np.count_nonzero(temporary), hessian.Z.T
    rest = np.concatenate([hessian.left_over.T, t.T[others]])
    owner, signs = t.owner[others], t.signs[others]
    t.T[:k], t.T[k:] = Z, rest - rest.dot(statement.H.dot(hessian.Z)).dot(Z)
    t.owner[:k], t.owner[k:left], t.owner[left:] = CONJUGATE, TEMPORARY, owner
    t.signs[:left], t.signs[left:] = 0.0, signs
    t.counts[0] = k
