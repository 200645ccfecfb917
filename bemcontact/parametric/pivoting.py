"""The one-sided derivative of a contact state, and the state followed along a line of offsets and loads.

Derivative. At a state with strongly active points S (p > 0), weakly active points W (p = 0 = δ) and open points the
derivative along a change (q̇, ḟ) of offset and load is the solution of the mixed complementarity problem

    δ̇ = 0 on S,  0 <= ṗ ⟂ δ̇ >= 0 on W,  ṗ = 0 elsewhere,  ℓᵀṗ = -ḟ,  δ̇ = q̇ + M ṗ + R ȧ

(Robinson's generalized equations; Facchinei and Pang, "Finite-Dimensional Variational Inequalities and Complementarity
Problems", 2003, section 5.4, for strongly regular solutions). S and the motions are eliminated by one factorization.
Where S alone does not hold the body, points B of W join them, on which pressure and gap change places, as in
`bemcontact.formulations.complementarity.standard_form`.

Path. Between two breakpoints the points in contact stay the same and the state is linear. At a breakpoint points become
weakly active, and the derivative says which of them are in contact afterwards. This is parametric principal pivoting
(Cottle, Pang and Stone, "The Linear Complementarity Problem", 1992, section 4.5), in which a block of several points is
settled at once. On each piece state and derivative are solved for anew from the points in contact: no error adds up.
If the load has moved beyond the support, the body tips at constant load until another point holds it: the pressure
stays, the position jumps.
"""

from dataclasses import replace
from typing import Self

import numpy as np
import scipy
from scipy.linalg import eigvalsh, null_space, qr

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.assessment.definiteness import Definiteness
from bemcontact.cached import cached_property
from bemcontact.contact.load_cases import Change
from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError, SingularSystemError, SolverError
from bemcontact.formulations.active_set import EPS, ContactBlock
from bemcontact.formulations.lemke import equilibrating, lemke
from bemcontact.formulations.open_position import farthest
from bemcontact.formulations.scaling import ScaledContact
from bemcontact.frozen import frozen

WEAK = 1e-10
"""Pressure over the size of the numbers in it, and gap over the gap of the point under this size, that count as zero.

A point of a short element closes a small gap by a large pressure only.
"""
RANK = 1e-9
"""Fraction of a motion by which it must move a point, so that the point holds it."""
UNCARRIED = 1e-12
"""Fraction of the change of load that may remain without support."""
STILL = 1e-13
"""Rate over the size of the numbers in it that counts as zero."""

NOT_HELD = "the points in contact do not hold the body, so that its position is not determined"
NOT_UNIQUE = "the contact state may go on in more than one way here, as the compliance does not rule out"
NO_WAY = "no contact state was found to continue this one: the path turns back or ends here"


@frozen
class Rate:
    """Derivative of a state, dimensionless: ṗ (n,), δ̇ (n,), ȧ (k,), with the points in contact just after."""

    pressure: Array
    gap: Array
    amplitudes: Array
    block: ContactBlock


@frozen
class Tangent:
    """A contact state with its strongly and weakly active points.

    Parameters
    ----------
    strong, weak : S and W, indices of points
    unique : whether sym(JM) is known to be positive definite on the equilibrium space
    before : equations of points that hold the body, S and some of W, if there are any at hand
    """

    scaled: ScaledContact
    strong: IntArray
    weak: IntArray
    unique: bool
    before: ContactBlock | None = None

    @classmethod
    def at(
        cls,
        scaled: ScaledContact,
        pressure: Array,
        gap: Array,
        amplitudes: Array,
        unique: bool,
        before: ContactBlock | None = None,
    ) -> Self:
        """Classify the points of a state: p (n,), δ (n,) and a (k,), dimensionless."""
        least, near = negligible(scaled, pressure, amplitudes)
        loaded, closed = pressure > least, gap <= near
        return cls(
            scaled=scaled,
            strong=np.array(np.flatnonzero(loaded & closed), np.int64),
            weak=np.array(np.flatnonzero(~loaded & closed), np.int64),
            unique=unique,
            before=before,
        )

    @property
    def loaded(self) -> BoolArray:
        """(n,) True on S."""
        return ContactBlock(scaled=self.scaled, points=self.strong).touching

    def escape(self, change: Change) -> Array:
        """The part r (k,) of a change of load that neither S nor W can carry: the least ℓᵀṗ + ḟ by norm.

        Where it is not zero, it is a motion that moves no point of S, closes none of W, and on which the load works.
        """
        ell, load = self.scaled.equilibrium, change.motion_load
        if not (load.any() and self._unresisted.size):
            return np.zeros_like(load)
        free = self._unresisted
        seen, uncarried = free.T @ ell[self.weak].T, free.T @ load
        r = free @ (seen @ scipy.optimize.nnls(seen, -uncarried)[0] + uncarried if self.weak.size else uncarried)
        return r if np.linalg.norm(r) > UNCARRIED * np.linalg.norm(load) else np.zeros_like(load)

    @cached_property
    def _unresisted(self) -> Array:
        """An orthonormal basis (k, ·) of the motions that move no point of S."""
        return self.still(self.strong)

    def idle_motions(self, change: Change) -> Array:
        """An orthonormal basis (k, ·) of the motions that move no point of S, if the change does no work in them."""
        free, load = self._unresisted, change.motion_load
        works = np.abs(free.T @ load).max(initial=0.0) > UNCARRIED * np.linalg.norm(load)
        return free[:, :0] if works else free

    @cached_property
    def open_motions(self) -> Array:
        """An orthonormal basis (k, ·) of the motions that move no point of S and W."""
        return self.still(np.append(self.strong, self.weak)) if self._unresisted.size else self._unresisted

    def still(self, points: IntArray) -> Array:
        """An orthonormal basis (k, ·) of the motions that move none of some points."""
        R = self.scaled.rigid_motions[points]
        k = R.shape[1]
        _, sizes, motions = np.linalg.svd(np.linalg.qr(np.vstack([R, np.zeros((k, k))]), mode="r"))
        return motions[sizes <= RANK].T

    @cached_property
    def held(self) -> ContactBlock:
        """The equations of S and B, as few points of W as hold the body with S, by QR with pivoting; or `before`.

        `ProblemError` where S and W do not hold the body.
        """
        if self.before is not None:
            return self.before
        free, joined = self._unresisted, self.weak[:0]
        if free.size:
            if self.weak.size < free.shape[1]:
                raise ProblemError(NOT_HELD)
            seen = (self.scaled.rigid_motions[self.weak] @ free).T
            factors = qr(seen, mode="r", pivoting=True)
            triangle, order = np.asarray(factors[0]), np.asarray(factors[-1])
            sizes = np.abs(np.diag(triangle))
            if sizes.min() <= RANK:
                raise ProblemError(NOT_HELD)
            joined = self.weak[order[: free.shape[1]]]
        return ContactBlock(scaled=self.scaled, points=np.union1d(self.strong, joined))

    @cached_property
    def exchanged(self) -> IntArray:
        """B: the points of `held` that are not in S."""
        return np.setdiff1d(self.held.points, self.strong, assume_unique=True)

    @cached_property
    def _small(self) -> tuple[IntArray, Array]:
        """The points of W, those of B first, and w = N z on them: z is δ̇ on B, ṗ elsewhere, w the other one."""
        M, A, B = self.scaled.compliance, self.held.points, self.exchanged
        rest, place, b = np.setdiff1d(self.weak, B, assume_unique=True), np.searchsorted(A, B), len(B)
        right = np.zeros((len(self.held.matrix), len(self.weak)))
        right[place, np.arange(b)] = 1.0
        right[: len(A), b:], right[len(A) :, b:] = -M[np.ix_(A, rest)], -self.scaled.equilibrium[rest].T
        inner = self.held.inverse(right)
        below = np.hstack([M[np.ix_(rest, A)], self.scaled.rigid_motions[rest]]) @ inner
        below[:, b:] += M[np.ix_(rest, rest)]
        return np.append(B, rest), np.vstack([inner[place], below])

    def rate(self, change: Change) -> Rate:
        """Find the derivative along a change (q̇, ḟ), free of units.

        `ProblemError` if the state does not determine it: the body is not held, the change of load pulls it off,
        there is no state beside this one in that direction, or there may be several. `SingularSystemError` if the
        equations of contact are singular to working precision.
        """
        if self.escape(change).any():
            raise ProblemError("the points in contact do not carry the change of the load, and the body moves away")
        block = self.after(change)
        (pressure,), (gap,), (amplitudes,) = block.solve(change)
        return Rate(pressure=pressure, gap=gap, amplitudes=amplitudes, block=block)

    def after(self, change: Change) -> ContactBlock:
        """The points in contact just after: S and those of W that the small complementarity problem loads.

        The errors are those of `rate`, except that a load that pulls the body off is not noticed.
        """
        if not self.weak.size:
            return self.held
        points, N = self._small
        b = len(self.exchanged)
        (pressure,), (gap,), (amplitudes,) = self.held.solve(change)
        vector = np.append(pressure[points[:b]], gap[points[b:]])
        vector[np.abs(vector) <= STILL * size_of_terms(change, pressure, amplitudes)] = 0.0
        rows = self.scaled.weights[points]
        matrix, vector = rows[:, None] * N, rows * vector
        end = lemke(matrix, vector)
        if end.status is not Status.SOLVED:
            raise ProblemError(NO_WAY)
        if not self.unique:
            factors = equilibrating(matrix)
            matrix = factors[:, None] * matrix * factors
            if eigvalsh(matrix + matrix.T)[0] <= len(matrix) * EPS * np.abs(matrix).max():
                raise ProblemError(NOT_UNIQUE)
        loaded = points[end.active ^ (np.arange(len(points)) < b)]
        return ContactBlock(scaled=self.scaled, points=np.sort(np.append(self.strong, loaded)))


def size_of_terms(change: Change, pressure: Array, amplitudes: Array) -> float:
    """Size of the numbers that are added in a rate, or in a state."""
    return float(np.abs(change.offset).max(initial=0.0) + np.abs(pressure).max(initial=0.0) + np.abs(amplitudes).sum())


def negligible(scaled: ScaledContact, pressure: Array, amplitudes: Array) -> tuple[float, Array]:
    """Pressure, and gap (n,) of each point, that count as zero at a state."""
    size = float(1.0 + np.abs(pressure).max(initial=0.0) + np.abs(amplitudes).sum())
    return WEAK * size, np.maximum(WEAK * np.abs(scaled.compliance.diagonal()), STILL) * size


def is_monotone(scaled: ScaledContact) -> bool:
    """Whether sym(JM) is positive definite on the equilibrium space, so that each contact state is the only one."""
    return Definiteness.of(scaled.weights, scaled.compliance, scaled.equilibrium).definite


@frozen
class LinearChange:
    """Offset and load between two ends, s = 0 and s = 1, dimensionless."""

    first: Change
    last: Change

    @property
    def rate(self) -> Change:
        """The change per unit of s."""
        return Change(*(last - first for first, last in zip(self.first, self.last, strict=True)))

    def at(self, s: float) -> Change:
        """Offset and load at s."""
        return Change(*((1 - s) * first + s * last for first, last in zip(self.first, self.last, strict=True)))


@frozen
class State:
    """A contact state on the line: s, p >= 0 (n,), δ >= 0 (n,), a (k,), dimensionless."""

    s: float
    pressure: Array
    gap: Array
    amplitudes: Array


@frozen
class Trail:
    """The breakpoints of a path, from s = 0 on.

    Parameters
    ----------
    states : b of them
    touching : (n,) for each of the b - 1 pieces between them, which points are in contact
    escape : (k,) motion in which the load pulls the body off where the trail ends early, else None
    stop : why it ends early otherwise, else empty
    unique : whether each state is known to be the only one
    """

    states: tuple[State, ...]
    touching: tuple[BoolArray, ...]
    escape: Array | None = None
    stop: str = ""
    unique: bool


def trail_along(scaled: ScaledContact, line: LinearChange, pressure: Array, amplitudes: Array) -> Trail:
    """Follow a state, p (n,) and a (k,) at s = 0, along the line of offsets and loads, as far as it goes.

    The first state of the trail is the limit of those that follow, which differs from the given one where that is not
    unique. `SolverError` if more points enter and leave than can be, which only round-off could cause.
    """
    gap = line.first.offset + scaled.compliance @ pressure + scaled.rigid_motions @ amplitudes
    states = [State(s=0.0, pressure=pressure, gap=np.maximum(gap, 0.0), amplitudes=amplitudes)]
    touching: list[BoolArray] = []
    unique, block, escape, stop = is_monotone(scaled), None, None, ""
    for _ in range(limit := 1000 + 50 * len(pressure)):
        if (state := states[-1]).s >= 1.0:
            break
        tangent = Tangent.at(scaled, state.pressure, state.gap, state.amplitudes, unique, block)
        motion = tangent.escape(line.rate)
        try:
            if motion.any():
                block, following = None, _tipped(scaled, state, tangent, motion)
            elif (drift := _drift(line, state, tangent)) is not None:
                following, loaded = drift
                states.append(following)
                touching.append(loaded)
                block = None
                continue
            else:
                block = tangent.after(line.rate)
                following = _next(line, state.s, block)
        except (ProblemError, SingularSystemError) as error:
            stop = str(error)
            break
        if following is None:  # nor do the places to which it has tipped before hold it
            escape = motion
            while len(states) > 1 and states[-2].s == state.s:
                states.pop()
                touching.pop()
            break
        if following.s == 0.0:
            states.clear()
        else:
            touching.append(tangent.loaded if block is None else block.touching)
        states.append(following)
    else:
        raise SolverError(f"the path was given up after {limit} breakpoints: points keep entering and leaving")
    return Trail(states=tuple(states), touching=tuple(touching), escape=escape, stop=stop, unique=unique)


def _next(line: LinearChange, s: float, block: ContactBlock) -> State:
    """Continue with the same points in contact until a pressure or a gap is zero, or to the end of the line."""
    touching, rate = block.touching, line.rate
    pressures, gaps, amplitudes = block.solve(line.at(s), rate)
    values, rates = np.where(touching, pressures, gaps)
    step, blocking = first_zero(values, rates, STILL * size_of_terms(rate, pressures[1], amplitudes[1]))
    small = np.where(touching, *negligible(block.scaled, pressures[0], amplitudes[0]))
    if s + step >= 1.0 or (values + (1.0 - s) * rates >= -small).all():  # at the end all pressures may vanish
        step, blocking = 1.0 - s, np.zeros_like(touching)
    reached = np.where(blocking, 0.0, np.maximum(values + step * rates, 0.0))
    return State(
        s=1.0 if not blocking.any() else s + step,
        pressure=np.where(touching, reached, 0.0),
        gap=np.where(touching, 0.0, reached),
        amplitudes=amplitudes[0] + step * amplitudes[1],
    )


def _drift(line: LinearChange, state: State, tangent: Tangent) -> tuple[State, BoolArray] | None:
    """Continue along motions that contact leaves open; None where it leaves none.

    Points of W may hold the body, or lie beside its way as a wall beside a squeezed body: where they do not go on to
    hold it, they are the latter.
    """
    if not tangent.strong.size:
        return None
    if tangent.open_motions.size:
        return _drifted(line, state, tangent, tangent.open_motions)
    idle = tangent.idle_motions(line.rate)
    if not idle.size:
        return None
    try:
        if not tangent.still(tangent.after(line.rate).points).size:
            return None
    except ProblemError:
        pass
    try:
        return _drifted(line, state, tangent, idle)
    except ProblemError:
        return None


def _drifted(line: LinearChange, state: State, tangent: Tangent, ways: Array) -> tuple[State, BoolArray]:
    """Continue where motions (k, ·) are open: until a pressure is zero, or no position penetrates nothing any more.

    The pressures do not depend on the position. With it come the points in contact. Points without pressure that these
    motions move are not. `ProblemError` if there is no step.
    """
    scaled, rate = tangent.scaled, line.rate
    held = null_space(ways.T)
    seen, place = scaled.rigid_motions @ ways, ways.T @ state.amplitudes
    loose = ~tangent.loaded & (np.abs(seen).max(axis=1) > RANK)
    fixed = replace(scaled, rigid_motions=scaled.rigid_motions @ held, motion_load=held.T @ scaled.motion_load)
    offset, load = line.at(state.s)
    now, rate = Change(offset + seen @ place, held.T @ load), Change(rate.offset, held.T @ rate.motion_load)
    gap = np.where(loose, np.inf, state.gap)
    block = Tangent.at(fixed, state.pressure, gap, held.T @ state.amplitudes, tangent.unique).after(rate)
    touching = block.touching
    pressures, gaps, amplitudes = block.solve(now, rate)
    values, rates = np.where(touching, pressures, gaps)
    values = np.maximum(values, 0.0)
    rates[np.abs(rates) <= STILL * size_of_terms(rate, pressures[1], amplitudes[1])] = 0.0
    step, moved = farthest(values, rates, np.where(touching[:, None], 0.0, seen), 1.0 - state.s)
    if step <= WEAK * (1.0 - state.s):
        raise ProblemError(NOT_HELD)
    reached = np.maximum(values + step * rates + np.where(touching, 0.0, seen @ moved), 0.0)
    small = np.where(touching, *negligible(fixed, pressures[0], amplitudes[0]))
    reached[reached <= small] = 0.0
    following = State(
        s=1.0 if step >= 1.0 - state.s else state.s + step,
        pressure=np.where(touching, reached, 0.0),
        gap=np.where(touching, 0.0, reached),
        amplitudes=held @ (amplitudes[0] + step * amplitudes[1]) + ways @ (place + moved),
    )
    return following, touching


def _tipped(scaled: ScaledContact, state: State, tangent: Tangent, motion: Array) -> State | None:
    """Let the body move under a constant load until a point closes; None if none does."""
    closed, opening = np.append(tangent.strong, tangent.weak), scaled.rigid_motions @ motion
    opening[closed] = np.maximum(opening[closed], 0.0)
    step, blocking = first_zero(state.gap, opening, RANK * float(np.linalg.norm(motion)))
    if not blocking.any():
        return None
    gap = np.where(blocking, 0.0, state.gap + step * opening)
    return State(s=state.s, pressure=state.pressure, gap=gap, amplitudes=state.amplitudes + step * motion)


def first_zero(values: Array, rates: Array, still: float) -> tuple[float, BoolArray]:
    """Largest step of values >= 0 at their rates until one is zero, and which ones are; infinite if none falls.

    Rates up to `still` count as zero.
    """
    falling = rates < -still
    steps = np.full(len(values), np.inf)
    steps[falling] = np.maximum(values[falling], 0.0) / -rates[falling]
    step = float(steps.min(initial=np.inf))
    return step, falling & (steps <= step)
