"""Assembly as machine code by numba (the extra ``fast``): each pair of a block of points and an element at once.

The integrals are those of `kernels` and `influence`, with the same rules, limits and closed forms. NumPy computes them
as products of matrices, for a few points of each block. Here every pair is computed, and goes straight into the columns
of the system. The machine code releases the lock of the interpreter, so that threads share the work.

Blocks of points have their numbers in one array of rows of constant length STRIDE, which a compiler sees apart. It
computes several points at once where indices are unsigned: a signed one might count from the end of the array.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from bemcontact.arrays import Array, ComplexArray, IntArray
from bemcontact.bem.flat import FlatColumns, FlatElements, FlatPoints, FlatRules
from bemcontact.bem.kernels import Factors
from bemcontact.compilation import compiled
from bemcontact.threads import share_out, workers

STRIDE = 264
"""Largest block of points: an odd number of lanes, so that the rows of a lane share no places of a cache."""
LANES = 8
"""Points that share a rule near an element, and that are computed at once."""
WORTH_A_THREAD = 128
"""Points from which the blocks of a thread take longer than its start."""
SHARED_RULE_RHO = 4.0
"""Bernstein parameter from which all points of a block share a rule."""
SHARED_BY_LANES = 2.5
"""Bernstein parameter from which LANES points share a rule without their own roots."""
SUMMED = 4
"""Elements whose known tractions and displacements are summed by themselves."""
STRAIGHT = 1e-16
"""Least c2 over c1 of an element with a second root."""
MANTISSA, HALF = 0x000FFFFFFFFFFFFF, 0x3FE0000000000000
"""Bits of the mantissa of a double, and of the number 1/2."""


def _rows(first: int, count: int) -> tuple[Any, ...]:
    """Where rows of the array of a block begin."""
    return tuple(np.uint64(row * STRIDE) for row in range(first, first + count))


TAU_X, TAU_Y, SQUARE, COS, SIN, FRACTION = _rows(0, 6)
"""τ at the middle node, then parts of the integrands."""
A_RE, A_IM, S_IM, S_RE, LOG, M_RE, M_IM = (_rows(first, 3) for first in range(6, 27, 3))
"""A, S with B = 2i S, L and M for each shape function."""
CARRIED = _rows(27, 4)
"""Re A, Im A, Im S, Re S of the last node of the element before, which are added to those of the first node."""
PARTS = 31
"""Rows of the array of a block."""
UNSIGNED_LANES = np.uint64(LANES)


@compiled(inner=True)
def _tier(rho: float, limits: Array) -> int:
    """As `reference_element.tier`."""
    tier = len(limits)
    while tier > 0 and rho >= limits[tier - 1]:
        tier -= 1
    return tier


@compiled(inner=True)
def _bernstein(root: complex) -> float:
    """As `reference_element.bernstein_parameter`; a sum of the distances from both foci needs no complex root."""
    half = (abs(root - 1) + abs(root + 1)) / 2
    return half + math.sqrt(max(half * half - 1, 0.0))


@compiled(inner=True)
def _at_nodes(points: FlatPoints, j: int, elements: FlatElements, e: int) -> tuple[complex, complex, complex]:
    """τ = ζ - z of a point at the three nodes; the difference to the base keeps the digits of short elements."""
    base, offset = points.base[j], points.offset[j]
    return (elements.z[e, 0] - base) - offset, (elements.z[e, 1] - base) - offset, (elements.z[e, 2] - base) - offset


@compiled(inner=True)
def _nearest_root(t0: complex, t1: complex, t2: complex, c1: complex, c2: complex) -> tuple[float, complex]:
    """As `kernels.nearest_root`: local coordinate of the nearest node, and the step from there to the root."""
    q0, q1, q2 = abs(t0), abs(t1), abs(t2)
    start, at = 0.0, t1
    if q0 <= q1 and q0 <= q2:
        start, at = -1.0, t0
    elif q2 < q1:
        start, at = 1.0, t2
    slope = c1 + 2 * c2 * start
    root = np.sqrt(slope * slope - 4 * c2 * at)
    if slope.real * root.real + slope.imag * root.imag < 0:
        root = -root
    return start, -2 * at / (slope + root)


@compiled(inner=True)
def _regular(
    w: Array, bits: IntArray, first: int, last: int, n: int, xi: Array, shapes: Array,
    c1: complex, c2: complex, with_U: bool,
) -> None:  # fmt: skip
    """Add the sums of a Gauss rule with n points for the points first...last of a block, whole lanes.

    The logarithm is computed here, from the exponent and the mantissa, so that it is computed for several points at
    once. It is right to the last digit but one for all numbers that are not subnormal.
    """
    c1x, c1y, c2x, c2y = c1.real, c1.imag, c2.real, c2.imag
    for lane in range(np.uint64(first), np.uint64(last), UNSIGNED_LANES):
        for g in range(n):
            x, n0, n1, n2 = xi[g], shapes[g, 0], shapes[g, 1], shapes[g, 2]
            px, py, dx, dy = x * (c1x + x * c2x), x * (c1y + x * c2y), c1x + 2 * x * c2x, c1y + 2 * x * c2y
            for k in range(UNSIGNED_LANES):
                i = lane + k
                u, v = w[TAU_X + i] + px, w[TAU_Y + i] + py
                square = u * u + v * v
                inverse = 1 / square
                cos, sin = (u * u - v * v) * inverse, 2 * u * v * inverse
                along, normal = (dx * u + dy * v) * inverse, (dy * u - dx * v) * inverse
                w[SQUARE + i], w[COS + i], w[SIN + i] = square, cos, sin
                sin, cos = sin * normal, cos * normal
                w[A_RE[0] + i] += n0 * along
                w[A_RE[1] + i] += n1 * along
                w[A_RE[2] + i] += n2 * along
                w[A_IM[0] + i] += n0 * normal
                w[A_IM[1] + i] += n1 * normal
                w[A_IM[2] + i] += n2 * normal
                w[S_IM[0] + i] += n0 * sin
                w[S_IM[1] + i] += n1 * sin
                w[S_IM[2] + i] += n2 * sin
                w[S_RE[0] + i] += n0 * cos
                w[S_RE[1] + i] += n1 * cos
                w[S_RE[2] + i] += n2 * cos
            if with_U:
                for k in range(UNSIGNED_LANES):
                    i = lane + k
                    number = bits[SQUARE + i]
                    bits[FRACTION + i] = (number & MANTISSA) | HALF
                    w[SQUARE + i] = (number >> 52) - 1022
                for k in range(UNSIGNED_LANES):
                    i = lane + k
                    mantissa, exponent = w[FRACTION + i], w[SQUARE + i]
                    small = 1.0 if mantissa < 0.7071067811865476 else 0.0
                    mantissa, exponent = mantissa + mantissa * small, exponent - small
                    t = (mantissa - 1) / (mantissa + 1)
                    y = t * t
                    p = 1 / 15 + y * (1 / 17 + y * (1 / 19 + y * (1 / 21)))
                    p = 1 / 7 + y * (1 / 9 + y * (1 / 11 + y * (1 / 13 + y * p)))
                    log = exponent * 0.34657359027997264 + t * (1 + y * (1 / 3 + y * (1 / 5 + y * p)))  # ln|τ|
                    cos, sin = w[COS + i], w[SIN + i]
                    w[LOG[0] + i] += n0 * log
                    w[LOG[1] + i] += n1 * log
                    w[LOG[2] + i] += n2 * log
                    w[M_RE[0] + i] += n0 * cos
                    w[M_RE[1] + i] += n1 * cos
                    w[M_RE[2] + i] += n2 * cos
                    w[M_IM[0] + i] += n0 * sin
                    w[M_IM[1] + i] += n1 * sin
                    w[M_IM[2] + i] += n2 * sin


@compiled(inner=True)
def _split_off(
    w: Array, i: int, c1: complex, c2: complex, r: complex, minus: complex, plus: complex, on: bool,
    log_ratio: complex, turn0: complex, turn2: complex, rules: FlatRules,
) -> None:  # fmt: skip
    """The integrals of one pair as in `kernels.with_root_split_off`, written to w; `on`: the root is conj(r) too."""
    d = c1 + c2 * r
    tier = 0
    if abs(c2) > STRAIGHT * abs(c1):
        tier = _tier(_bernstein(-c1 / c2 - r), rules.rho)
    i0, i1, i2, h0, h1, h2 = 0j, 0j, 0j, 0j, 0j, 0j
    l0, l1, l2 = 0.0, 0.0, 0.0
    for g in range(rules.order[tier]):
        x, weight = rules.xi[tier, g], rules.weights[tier, g]
        u, v = c2.real * x + d.real, c2.imag * x + d.imag
        square = u * u + v * v
        inverse = weight / square
        one_over = complex(u * inverse, -v * inverse)
        h = complex((u * u - v * v) * inverse, 2 * u * v * inverse)
        log = 0.5 * weight * math.log(square)
        i0, i1, i2 = i0 + one_over, i1 + x * one_over, i2 + x * x * one_over
        h0, h1, h2 = h0 + h, h1 + x * h, h2 + x * x * h
        l0, l1, l2 = l0 + log, l1 + x * log, l2 + x * x * log
    a0 = r * minus / 2 * log_ratio + minus + c2 * (i2 - i1) / 2
    a1 = -minus * plus * log_ratio - 2 * r + c2 * (i0 - i2)
    a2 = r * plus / 2 * log_ratio + plus + c2 * (i2 + i1) / 2
    if not on:
        s = r.conjugate()
        at_s = c2.conjugate() * s + d.conjugate()
        difference = 2j * (c2 * d.conjugate()).imag / at_s
        pole = (c2 * s + d) / at_s * log_ratio.conjugate() + difference * i0.conjugate()
        h2 += (s - r) * (pole * s * s + h1 + s * h0)
        h1 += (s - r) * (pole * s + h0)
        h0 += (s - r) * pole
    first, last = 0j, 0j
    if plus != 0:
        first = -plus * np.log(-plus)
    if minus != 0:
        last = -minus * np.log(-minus)
    l0 += (last - first - 2).real
    l1 += (last * (1 + r) / 2 - first * (r - 1) / 2 - r).real
    l2 += (last * (1 + r + r * r) / 3 - first * (1 - r + r * r) / 3 - (2 / 3 + 2 * r * r) / 3).real
    b0, b1, b2 = 0.5 * h0 - h1 - turn0, 2 * h1, -0.5 * h0 - h1 + turn2
    m0, m1, m2 = (h2 - h1) / 2, h0 - h2, (h2 + h1) / 2
    j = np.uint64(i)
    w[A_RE[0] + j], w[A_RE[1] + j], w[A_RE[2] + j] = a0.real, a1.real, a2.real
    w[A_IM[0] + j], w[A_IM[1] + j], w[A_IM[2] + j] = a0.imag, a1.imag, a2.imag
    w[S_IM[0] + j], w[S_IM[1] + j], w[S_IM[2] + j] = -b0.real / 2, -b1.real / 2, -b2.real / 2
    w[S_RE[0] + j], w[S_RE[1] + j], w[S_RE[2] + j] = b0.imag / 2, b1.imag / 2, b2.imag / 2
    w[LOG[0] + j], w[LOG[1] + j], w[LOG[2] + j] = (l2 - l1) / 2, l0 - l2, (l2 + l1) / 2
    w[M_RE[0] + j], w[M_RE[1] + j], w[M_RE[2] + j] = m0.real, m1.real, m2.real
    w[M_IM[0] + j], w[M_IM[1] + j], w[M_IM[2] + j] = m0.imag, m1.imag, m2.imag


@compiled(inner=True)
def _near_singular(
    w: Array, i: int, points: FlatPoints, j: int, elements: FlatElements, e: int, rules: FlatRules
) -> None:
    """As `kernels.beside_element`, integrated."""
    c1, c2 = elements.c1[e], elements.c2[e]
    t0, t1, t2 = _at_nodes(points, j, elements, e)
    start, step = _nearest_root(t0, t1, t2, c1, c2)
    minus, plus = (start - 1) + step, (start + 1) + step
    ratio, turn0, turn2 = np.log(minus / plus), t0 / t0.conjugate(), t2 / t2.conjugate()
    _split_off(w, i, c1, c2, start + step, minus, plus, False, ratio, turn0, turn2, rules)


@compiled(inner=True)
def _singular(w: Array, i: int, x: float, c1: complex, c2: complex, rules: FlatRules) -> None:
    """As `kernels.on_element`, integrated, for a point at the local coordinate x of the element."""
    if abs(x) == 1:
        ratio = complex(-x * math.log(2 * abs(c1 + 2 * x * c2)), 0.0)
    else:
        ratio = complex(math.log((1 - x) / (1 + x)), -math.pi)
    here = x * (c1 + x * c2)
    t0, t2 = (c2 - c1) - here, (c2 + c1) - here
    turn0, turn2 = 0j, 0j
    if x != -1:
        turn0 = t0 / t0.conjugate()
    if x != 1:
        turn2 = t2 / t2.conjugate()
    r = complex(x, 0.0)
    _split_off(w, i, c1, c2, r, r - 1, r + 1, True, ratio, turn0, turn2, rules)


@compiled(inner=True)
def _disc(points: FlatPoints, first: int, last: int) -> tuple[complex, float]:
    """As `skeleton.disc`, of points from the first to before the last."""
    middle = (points.base[first] + points.base[last - 1]) / 2
    radius = 0.0
    for j in range(first, last):
        radius = max(radius, abs((points.base[j] - middle) + points.offset[j]))
    return middle, radius


@compiled(inner=True)
def _least_rho(c0: complex, c1: complex, c2: complex, middle: complex, radius: float) -> float:
    """A lower bound of ρ for all points of a disc, as in `Influence`."""
    a1, a2, distance = abs(c1), abs(c2), max(abs(c0 - middle) - radius, 0.0)
    r = 2 * distance / (a1 + math.sqrt(a1 * a1 + 4 * a2 * distance))
    return r + math.sqrt(r * r - 1) if r > 1 else 1.0


@compiled(inner=True)
def _integrate(
    w: Array, bits: IntArray, tiers: IntArray, first: int, R: int, middle: ComplexArray, radius: Array,
    points: FlatPoints, elements: FlatElements, e: int, with_U: bool, rules: FlatRules,
) -> None:  # fmt: skip
    """All integrals of R points from the first one on with one element; discs of all points, then of each LANES."""
    c1, c2, mid = elements.c1[e], elements.c2[e], elements.z[e, 1]
    padded = (R + LANES - 1) // LANES * LANES
    for i in range(padded):
        j = first + min(i, R - 1)
        tau = (mid - points.base[j]) - points.offset[j]
        w[i], w[STRIDE + i] = tau.real, tau.imag
    w[A_RE[0] : CARRIED[0] if with_U else LOG[0]] = 0
    rho = _least_rho(mid, c1, c2, middle[0], radius[0])
    if rho > SHARED_RULE_RHO:
        tier = _tier(rho, rules.rho if with_U else rules.rho_of_t)
        _regular(w, bits, 0, padded, rules.order[tier], rules.xi[tier], rules.shapes[tier], c1, c2, with_U)
        return
    closed = len(rules.rho)
    for lane in range(0, padded, LANES):
        highest, some = 0, False
        part = 1 + lane // LANES
        rho = _least_rho(mid, c1, c2, middle[part], radius[part])
        if rho > SHARED_BY_LANES:
            tier = _tier(rho, rules.rho if with_U else rules.rho_of_t)
            n, xi, shapes = rules.order[tier], rules.xi[tier], rules.shapes[tier]
            _regular(w, bits, lane, lane + LANES, n, xi, shapes, c1, c2, with_U)
            continue
        for i in range(lane, lane + LANES):
            j = first + min(i, R - 1)
            t0, t1, t2 = _at_nodes(points, j, elements, e)
            start, step = _nearest_root(t0, t1, t2, c1, c2)
            tier = _tier(_bernstein(start + step), rules.rho)
            for on in range(points.on_start[j], points.on_start[j + 1]):
                if points.on_element[on] == e:
                    tier = closed + 1
            tiers[i] = tier
            if tier < closed:
                highest, some = max(highest, tier), True
        if some:
            n, xi, shapes = rules.order[highest], rules.xi[highest], rules.shapes[highest]
            _regular(w, bits, lane, lane + LANES, n, xi, shapes, c1, c2, with_U)
        for i in range(lane, min(lane + LANES, R)):
            j = first + i
            if tiers[i] == closed:
                _near_singular(w, i, points, j, elements, e, rules)
            elif tiers[i] > closed:
                for on in range(points.on_start[j], points.on_start[j + 1]):
                    if points.on_element[on] == e:
                        _singular(w, i, points.on_local[on], c1, c2, rules)


@compiled(inner=True)
def _first_of(rows: IntArray) -> int:
    """The first of rows that follow each other, -1 if they do not or one is missing."""
    return rows[0] if rows.min() >= 0 and rows[-1] - rows[0] == len(rows) - 1 else -1


@compiled(inner=True)
def _add(
    target: Array, w: Array, a: int, factor_a: float, b: int, factor_b: float, c: int, factor_c: float, constant: float
) -> None:
    """Add factors times three rows of w, and a constant, to one number for each point."""
    for i in range(np.uint64(len(target))):
        target[i] += factor_a * w[a + i] + factor_b * w[b + i] + factor_c * w[c + i] + constant


@compiled(inner=True)
def _add_to_rows(
    line: Array, rows: IntArray, first: int, w: Array,
    a: int, factor_a: float, b: int, factor_b: float, c: int, factor_c: float, constant: float,
) -> None:  # fmt: skip
    """Add as `_add` to the places `rows` (R,) of a column, -1 for none; `first` as of `_first_of`."""
    if first >= 0:
        _add(line[first : first + len(rows)], w, a, factor_a, b, factor_b, c, factor_c, constant)
        return
    for i in range(np.uint64(len(rows))):
        if rows[i] >= 0:
            line[rows[i]] += factor_a * w[a + i] + factor_b * w[b + i] + factor_c * w[c + i] + constant


@compiled(inner=True)
def _add_node(
    out: Array, sums: Array, rows_x: IntArray, rows_y: IntArray, first_x: int, first_y: int, w: Array, k: int,
    node: int, columns: FlatColumns, factor: Factors,
) -> None:  # fmt: skip
    """Add F of local node k to the columns of the node, and to the sums where its displacement is known."""
    along, normal, sin, cos = A_RE[k], A_IM[k], S_IM[k], S_RE[k]
    for axis in range(2):
        if axis == 0:
            x, fx, cx, y, fy, cy = normal, factor.normal, cos, along, factor.tangential, sin
            gx, gy = -factor.skew, -factor.skew
        else:
            x, fx, cx, y, fy, cy = along, -factor.tangential, sin, normal, factor.normal, cos
            gx, gy = -factor.skew, factor.skew
        column = columns.displacement[node, axis]
        if column >= 0:
            _add_to_rows(out[column], rows_x, first_x, w, x, fx, cx, gx, cx, 0.0, 0.0)
            _add_to_rows(out[column], rows_y, first_y, w, y, fy, cy, gy, cy, 0.0, 0.0)
        for s in range(len(sums)):
            u = columns.known[s, node, axis]
            if u != 0:
                _add(sums[s, 0], w, x, u * fx, cx, u * gx, cx, 0.0, 0.0)
                _add(sums[s, 1], w, y, u * fy, cy, u * gy, cy, 0.0, 0.0)


@compiled(inner=True)
def _add_tractions(
    out: Array, sums: Array, rows_x: IntArray, rows_y: IntArray, first_x: int, first_y: int, w: Array, e: int, k: int,
    columns: FlatColumns, factor: Factors, share: float,
) -> None:  # fmt: skip
    """Add G times traction of local node k to the columns that it belongs to, and to the sums where it is known."""
    log, cos, sin, t = LOG[k], M_RE[k], M_IM[k], factor.turn
    for at in range(columns.start[3 * e + k], columns.start[3 * e + k + 1]):
        line, x, y = out[columns.column[at]], columns.x[at], columns.y[at]
        _add_to_rows(line, rows_x, first_x, w, log, -factor.log * x, cos, t * x, sin, t * y, t * share * x)
        _add_to_rows(line, rows_y, first_y, w, log, -factor.log * y, cos, -t * y, sin, t * x, t * share * y)
    for s in range(len(sums)):
        x, y = columns.traction[s, e, k, 0], columns.traction[s, e, k, 1]
        if x != 0 or y != 0:
            _add(sums[s, 0], w, log, -factor.log * x, cos, t * x, sin, t * y, t * share * x)
            _add(sums[s, 1], w, log, -factor.log * y, cos, -t * y, sin, t * x, t * share * y)


@compiled(inner=True)
def _flush(out: Array, sums: Array, rows_x: IntArray, rows_y: IntArray, first: int) -> None:
    """Add sums of some elements to the right sides, and begin anew: shorter sums have smaller rounding errors."""
    for s in range(len(sums)):
        for i in range(len(rows_x)):
            if rows_x[i] >= 0:
                out[first + s, rows_x[i]] += sums[s, 0, i]
            if rows_y[i] >= 0:
                out[first + s, rows_y[i]] += sums[s, 1, i]
    sums[:] = 0


@compiled()
def add_rows(
    out: Array, starts: IntArray, step: int,
    points: FlatPoints, elements: FlatElements, columns: FlatColumns, rules: FlatRules, factor: Factors,
) -> None:  # fmt: skip
    """Add the equations of some blocks of points to the transposed system, matrix and right sides one below the other.

    Parameters
    ----------
    out : (columns, rows); added to
    starts, step : first point of each block, and the number of its points, at most `STRIDE`
    """
    w = np.zeros(PARTS * STRIDE)
    bits = w.view(np.int64)
    tiers = np.zeros(STRIDE, np.int64)
    middle, radius = np.zeros(1 + STRIDE // LANES, np.complex128), np.zeros(1 + STRIDE // LANES)
    m, c = len(elements.node), len(points.base)
    for first in starts:
        R = min(step, c - first)
        rows_x, rows_y = points.row[0, first : first + R], points.row[1, first : first + R]
        first_x, first_y = _first_of(rows_x), _first_of(rows_y)
        sums = np.zeros((len(columns.known), 2, R))
        middle[0], radius[0] = _disc(points, first, first + R)
        for lane in range(0, R, LANES):
            part = 1 + lane // LANES
            middle[part], radius[part] = _disc(points, first + lane, first + min(lane + LANES, R))
        carried = False
        for e in range(m):
            with_U = columns.loaded[e] != 0
            _integrate(w, bits, tiers, first, R, middle, radius, points, elements, e, with_U, rules)
            carry = e + 1 < m and elements.node[e + 1, 0] == elements.node[e, 2]
            for part, (start, _, end) in enumerate((A_RE, A_IM, S_IM, S_RE)):
                if carried:
                    for i in range(np.uint64(R)):
                        w[start + i] += w[CARRIED[part] + i]
                if carry:
                    for i in range(np.uint64(R)):
                        w[CARRIED[part] + i] = w[end + i]
            carried = carry
            for k in range(3):
                if k < 2 or not carry:
                    node = elements.node[e, k]
                    _add_node(out, sums, rows_x, rows_y, first_x, first_y, w, k, node, columns, factor)
                if with_U:
                    _add_tractions(
                        out, sums, rows_x, rows_y, first_x, first_y, w, e, k, columns, factor, rules.share[k]
                    )
            if e % SUMMED == SUMMED - 1 or e == m - 1:
                _flush(out, sums, rows_x, rows_y, columns.first_known)
        for i in range(R):
            node = points.corner[first + i]
            if node < 0:
                continue
            value = -factor.normal * elements.angle[node]
            for axis in range(2):
                at = points.row[axis, first + i]
                if at < 0:
                    continue
                if columns.displacement[node, axis] >= 0:
                    out[columns.displacement[node, axis], at] += value
                for s in range(len(columns.known)):
                    out[columns.first_known + s, at] += columns.known[s, node, axis] * value


def block_size(count: int) -> int:
    """Points of each block of so many in all: whole lanes, in as few blocks as can be, but one for each thread."""
    blocks, threads = math.ceil(count / STRIDE), count // WORTH_A_THREAD
    if threads > blocks:
        blocks = max(blocks, min(workers(), threads))
    return LANES * math.ceil(count / (LANES * blocks))


def add_all(
    out: Array, points: FlatPoints, elements: FlatElements, columns: FlatColumns, rules: FlatRules, factor: Factors
) -> None:
    """Add the equations of all points, as `add_rows`, in several threads."""
    step = block_size(len(points.base))

    def work(starts: Sequence[int]) -> None:
        add_rows(out, np.array(starts, np.int64), step, points, elements, columns, rules, factor)

    starts = range(0, len(points.base), step)
    if len(starts) > 1:
        work(())  # compiles in this thread, which knows who waits for it
    share_out(work, starts)
