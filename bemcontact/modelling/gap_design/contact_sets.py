"""The convex programs of a design: states of contact that share a profile, with given contact sets or with none.

    gap_l = q_l + S c + M p_l + R a_l >= 0,  p_l >= 0,  ℓᵀp_l = -load_l,  low <= W c <= high    for each load state l

With contact sets A_l given, gap_l = 0 on A_l and p_l = 0 off it: every feasible point is a contact state for each load,
although the profile is unknown. Without them, complementarity is dropped, and the optimum is a lower bound.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import cvxpy as cp
import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, freeze_arrays
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import ContactScales
from bemcontact.contact.stress_operator import StressOperator
from bemcontact.errors import SolverError
from bemcontact.formulations import qp3
from bemcontact.formulations.clarabel import minimize_convex
from bemcontact.formulations.scaling import ScaledContact, scale
from bemcontact.frozen import frozen
from bemcontact.modelling.gap_design.designed_gap import Goal
from bemcontact.modelling.gap_design.relief import Profiles
from bemcontact.modelling.parameters import value_of
from bemcontact.modelling.stress_bounds import ModelStress

WEAK = 1e-6
"""Scaled pressure or gap that is zero to the tolerance of the solver."""
ROOM = 3e-10
"""Fraction of the goal that the gentlest profile may lose."""
DIGITS = 5
"""Decimal places to which promises are compared, so that round-off does not choose between equal ones."""
MARGIN = 1e-6
"""Relative increase of a known value of the goal, so that the relaxation surely admits it."""


@frozen
class BestProfile:
    """The best profile for given contact sets.

    Parameters
    ----------
    value : scaled goal
    coefficients : (s,) c [L]
    pressures : (loads, n) [p]
    touching : (loads, n) the contact sets
    turns : pairs (load, point) that lie on the edge of the contact set, the most promising ones first
    promising : number of these whose multipliers promise a gain
    """

    value: float
    coefficients: Array
    pressures: Array
    touching: BoolArray
    turns: tuple[tuple[int, int], ...]
    promising: int

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)


class Relaxation(NamedTuple):
    """Lower bound of the goal [p], the coefficients (s,) [L] there, and where (loads, n) p is larger than the gap."""

    bound: float
    coefficients: Array
    touching: BoolArray


@frozen
class SharedProfile:
    """Load states that share a profile, scaled alike, and the goal that is minimized.

    Parameters
    ----------
    states : scaled, without profile
    profiles : to choose from
    scales : displacement [L] and pressure [p]
    factors : (c,) of the load cases in each state
    stress : at points where von Mises's stress is bounded or minimized, if it is
    limit : of von Mises's stress there [p], if there is one
    """

    states: tuple[ScaledContact, ...]
    profiles: Profiles
    scales: ContactScales
    goal: Goal
    factors: tuple[Array, ...]
    stress: StressOperator | None = None
    limit: float | None = None

    @classmethod
    def of(
        cls,
        contacts: Sequence[CondensedContact],
        profiles: Profiles,
        goal: Goal,
        stress: StressOperator | None = None,
        limit: float | None = None,
    ) -> "SharedProfile":
        """Scale all states by the largest of their scales."""
        scales = max(contact.scales for contact in contacts)
        states = tuple(scale(contact, scales) for contact in contacts)
        factors = tuple(contact.cases.factors for contact in contacts)
        return cls(
            states=states, profiles=profiles, scales=scales, goal=goal, factors=factors, stress=stress, limit=limit
        )

    def measure(self, pressures: Iterable[Array]) -> float:
        """The goal [p] at pressures (n,) [p]."""
        if self.goal is Goal.PEAK:
            return max(float(p.max()) for p in pressures)
        if self.goal is Goal.VON_MISES:
            return self.von_mises(pressures) or 0.0
        return max(float(np.linalg.norm(self._deviation @ p)) for p in pressures)

    def von_mises(self, pressures: Iterable[Array]) -> float | None:
        """The largest von Mises stress [p] at pressures (n,) [p] of all states; None without points."""
        stress = self.stress
        if stress is None:
            return None
        pairs = zip(pressures, self.factors, strict=True)
        return max(float(stress.at(p, factors=factors).von_mises.max()) for p, factors in pairs)

    def excess(self, pressures: Iterable[Array]) -> float:
        """By how much von Mises's stress is above its limit, over the limit; zero if it is within."""
        return 0.0 if self.limit is None else max(0.0, (self.von_mises(pressures) or 0.0) / self.limit - 1)

    def _stress_bounds(self, p: cp.Variable, factors: Array, top: cp.Variable) -> Iterator[cp.Constraint]:
        """Bound von Mises's stress of a state by its limit, and by the goal if it is that."""
        if self.stress is None:
            return
        T = self.scales.pressure  # rigid amplitudes give no stress
        mises = ModelStress.of(self.stress, T * p, None, cp.Constant(factors) if len(factors) else None, T).scaled_mises
        if self.limit is not None:
            yield mises <= self.limit / T
        if self.goal is Goal.VON_MISES:
            yield mises <= top

    @property
    def _deviation(self) -> Array:
        """D (m, n): |D p| is the root of the weighted mean square deviation on the interval."""
        points, weights = self.profiles.points, self.states[0].weights
        part = weights[points] / weights[points].sum()
        rows = np.zeros((len(points), len(weights)))
        rows[:, points] = np.sqrt(part)[:, None] * (np.eye(len(points)) - part)
        return rows

    @cached_property
    def _program(self) -> "_Program":
        """Variables, expressions, and all constraints except those of contact sets."""
        U, profiles = self.scales.displacement, self.profiles
        c, top = cp.Variable(profiles.shapes.shape[1]), cp.Variable()
        relief, rows = profiles.shapes @ c, profiles.rows @ c
        low, high = np.isfinite(profiles.low), np.isfinite(profiles.high)
        constraints: list[cp.Constraint] = [rows[low] >= profiles.low[low] / U] if low.any() else []
        constraints += [rows[high] <= profiles.high[high] / U] if high.any() else []
        pressures, motions, gaps = [], [], []
        for state, factors in zip(self.states, self.factors, strict=True):
            n, k = state.rigid_motions.shape
            p, a = cp.Variable(n), cp.Variable(k) if k else None
            gap = state.offset + relief + state.compliance @ p
            if a is not None:
                gap = gap + state.rigid_motions @ a
                constraints.append(state.equilibrium.T @ p == -state.motion_load)
            constraints += self._stress_bounds(p, factors, top)
            if self.goal is Goal.PEAK:
                constraints.append(p <= top)
            elif self.goal is Goal.UNIFORM:
                constraints.append(cp.norm(self._deviation @ p) <= top)
            pressures.append(p)
            motions.append(a)
            gaps.append(gap)
        return _Program(c, top, relief, pressures, motions, gaps, constraints)

    @cached_property
    def _sets(self) -> "_Sets":
        """Contact sets as parameters, so that all of them are one program for cvxpy."""
        return _Sets.of(self._program)

    @cached_property
    def _best(self) -> cp.Problem:
        """The best profile for the contact sets."""
        return cp.Problem(cp.Minimize(self._program.top), [*self._program.constraints, *self._sets.constraints])

    @cached_property
    def _pieces(self) -> dict[bytes, BestProfile | None]:
        """What `best_with` has computed, by contact sets: searches from several starts meet."""
        return {}

    def best_with(self, touching: BoolArray) -> BestProfile | None:
        """The best profile with given contact sets (loads, n); None if no solution is computed."""
        key = touching.tobytes()
        if key not in self._pieces:
            self._pieces[key] = self._best_with(touching)
        return self._pieces[key]

    def _best_with(self, touching: BoolArray) -> BestProfile | None:
        """Compute the best profile with contact sets."""
        self._sets.choose(touching)
        try:
            minimize_convex(self._best)
        except SolverError:  # sets that hardly fit together; others will do
            return None
        return None if self._program.top.value is None else self._piece(touching)

    def gentlest(self, piece: BestProfile) -> BestProfile:
        """Find, among profiles with these contact sets that are as good, that of the least mean square.

        The piece itself is returned if no gentler one is computed.
        """
        program = self._program
        self._sets.choose(piece.touching)
        width = np.sqrt(self.states[0].weights / self.states[0].weights.sum())
        as_good = program.top <= piece.value + ROOM * abs(piece.value)
        size = float(np.abs(self.profiles.shapes @ piece.coefficients).max()) / self.scales.displacement
        goal = cp.Minimize(cp.sum_squares(cp.multiply(width / (size or 1.0), program.relief)))
        try:
            minimize_convex(cp.Problem(goal, [*program.constraints, *self._sets.constraints, as_good]))
        except SolverError:
            return piece
        gentler = None if program.top.value is None else self._piece(piece.touching)
        return gentler if gentler is not None and gentler.value <= piece.value + 2 * ROOM * abs(piece.value) else piece

    def _piece(self, touching: BoolArray) -> BestProfile:
        """Take the numbers out of the program that has been solved."""
        program, promise = self._program, self._sets.promise()
        pressures = np.array([value_of(p) for p in program.pressures]) * self.scales.pressure
        edge = [int(i) for i in _descending(promise) if promise.flat[i] > -np.inf]
        return BestProfile(
            value=self.measure(pressures) / self.scales.pressure,
            coefficients=value_of(program.coefficients) * self.scales.displacement,
            pressures=pressures,
            touching=touching,
            turns=tuple(divmod(i, touching.shape[1]) for i in edge),
            promising=int((promise > WEAK).sum()),
        )

    def relaxed(self, best: float) -> Relaxation:
        """Compute a value [p] below which the goal cannot be; `best` [p] is a value that is reached.

        Complementarity is dropped except for its convex consequences: F3 at the designed gap is zero, and in it p·g is
        at least what McCormick's two planes say (Math. Programming 10, 1976, 147-175) for g within its range and, where
        the peak is minimized, p up to the best peak that is known.
        """
        U, T = self.scales
        program = self._program
        signs = [sign for p, gap in zip(program.pressures, program.gaps, strict=True) for sign in (p >= 0, gap >= 0)]
        work = self._work_cuts(program, best * (1 + MARGIN))
        try:
            minimize_convex(cp.Problem(cp.Minimize(program.top), [*program.constraints, *signs, *work]))
        except SolverError:  # the bound without F3 is a lower one, but a bound
            minimize_convex(cp.Problem(cp.Minimize(program.top), [*program.constraints, *signs]))
        pairs = zip(program.pressures, program.gaps, strict=True)
        return Relaxation(
            float(value_of(program.top)) * T,
            value_of(program.coefficients) * U,
            np.array([value_of(p) > value_of(gap) for p, gap in pairs]),
        )

    def _work_cuts(self, program: "_Program", best: float) -> Iterator[cp.Constraint]:
        """F3 <= 0 with McCormick's planes for p·g, where F3 is convex."""
        U, T = self.scales
        lowest, highest = (limit / U for limit in self.profiles.value_range)
        for state, p, a in zip(self.states, program.pressures, program.motions, strict=True):
            weights = np.diag(state.weights)
            eigenvalue = qp3.smallest_eigenvalue(state, weights)
            if eigenvalue is not None and eigenvalue < -qp3.NEGLIGIBLE:
                continue
            product = cp.Variable(len(lowest))
            yield product >= cp.multiply(lowest, p)
            if self.goal is Goal.PEAK:
                yield product >= cp.multiply(highest, p) + (best / T) * (program.relief - highest)
            work = qp3.objective(state, weights)
            values, vectors = np.linalg.eigh(work.hessian)
            root = (vectors * np.sqrt(np.maximum(values, 0.0) / 2)).T
            linear = work.pressure @ p + work.constant + (0.0 if a is None else work.amplitudes @ a)
            yield cp.sum_squares(root @ p) + linear + state.weights @ product <= 0


def _descending(promise: Array) -> IntArray:
    """Flat indices from the largest down; those that differ by round-off only stay in their order."""
    largest = np.abs(promise[np.isfinite(promise)]).max(initial=0.0) or 1.0
    return np.argsort(-np.round(promise / largest, DIGITS), axis=None, kind="stable")


class _Program(NamedTuple):
    """Variables and expressions of a design, scaled."""

    coefficients: cp.Variable
    top: cp.Variable
    relief: cp.Expression
    pressures: list[cp.Variable]
    motions: list[cp.Variable | None]
    gaps: list[cp.Expression]
    constraints: list[cp.Constraint]


class _Sets(NamedTuple):
    """Contact sets of load states as constraints: gap = 0 and p >= 0 inside, p = 0 and gap >= 0 outside.

    Parameters
    ----------
    inside : (n,) one in the set and zero off it, for each load state
    zero : the equations
    signed : (n,) what is not negative
    """

    inside: list[cp.Parameter]
    zero: list[cp.Constraint]
    signed: list[cp.Expression]

    @classmethod
    def of(cls, program: _Program) -> "_Sets":
        """State them for a program."""
        inside = [cp.Parameter(p.size, nonneg=True) for p in program.pressures]
        parts = list(zip(inside, program.pressures, program.gaps, strict=True))
        zero: list[cp.Constraint] = [cp.multiply(on, gap) + cp.multiply(1 - on, p) == 0 for on, p, gap in parts]
        return cls(inside, zero, [cp.multiply(on, p) + cp.multiply(1 - on, gap) for on, p, gap in parts])

    @property
    def constraints(self) -> list[cp.Constraint]:
        """The equations and inequalities of the contact sets."""
        return [*self.zero, *(signed >= 0 for signed in self.signed)]

    def choose(self, touching: BoolArray) -> None:
        """Set the contact sets (loads, n)."""
        for parameter, inside in zip(self.inside, touching, strict=True):
            parameter.value = inside.astype(float)

    def promise(self) -> Array:
        """First-order gain (loads, n) of switching a point; minus infinity off the edge of contact."""
        gains = np.array([np.asarray(zero.dual_value, float) for zero in self.zero])
        return np.where(np.array([value_of(signed) for signed in self.signed]) <= WEAK, gains, -np.inf)
