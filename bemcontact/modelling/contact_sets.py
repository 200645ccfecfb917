"""The convex programs of a design: states of contact that share a profile, with given contact sets or with none.

    gap_l = q_l + S c + M p_l + R a_l >= 0,  p_l >= 0,  ℓᵀp_l = -load_l,  low <= W c <= high    for each load state l

With contact sets A_l given, gap_l = 0 on A_l and p_l = 0 off it: every feasible point is a contact state for each load,
although the profile is unknown. Without them, complementarity is dropped, and the optimum is a lower bound.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

from bemcontact.arrays import Array, freeze_arrays
from bemcontact.contact import CondensedContact, ContactScales
from bemcontact.errors import SolverError
from bemcontact.formulations import qp3
from bemcontact.formulations.scaling import ScaledContact, scaled
from bemcontact.modelling.clarabel import minimise
from bemcontact.modelling.designed_gap import Goal
from bemcontact.modelling.parameters import value_of
from bemcontact.modelling.relief import Profiles

BoolArray = NDArray[np.bool_]

WEAK = 1e-6
"""Scaled pressure or gap that is none to the tolerance of the solver."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Piece:
    """The best profile for given contact sets.

    Parameters
    ----------
    value : scaled goal
    coefficients : (s,) c [L]
    pressures : (loads, n) [p]
    touching : (loads, n) the contact sets
    turns : pairs (load, point) that lie on the edge of the contact set, the most promising ones first
    promising : how many of these the multipliers speak for
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


@dataclass(frozen=True, kw_only=True, eq=False)
class SharedProfile:
    """Load states that share a profile, scaled alike.

    Parameters
    ----------
    states : scaled, without profile
    profiles : to choose from
    scales : displacement [L] and pressure [p]
    goal : to be made small
    """

    states: tuple[ScaledContact, ...]
    profiles: Profiles
    scales: ContactScales
    goal: Goal

    @classmethod
    def of(cls, contacts: Sequence[CondensedContact], profiles: Profiles, goal: Goal) -> "SharedProfile":
        """Scale all states by the largest of their scales."""
        scales = max(contact.scales for contact in contacts)
        states = tuple(scaled(contact, scales) for contact in contacts)
        return cls(states=states, profiles=profiles, scales=scales, goal=goal)

    def measure(self, pressures: Sequence[Array]) -> float:
        """The goal [p] at pressures (n,) [p]."""
        if self.goal is Goal.PEAK:
            return max(float(p.max()) for p in pressures)
        return max(float(np.linalg.norm(self._deviation @ p)) for p in pressures)

    @property
    def _deviation(self) -> Array:
        """D (m, n): |D p| is the root of the weighted mean square deviation on the interval."""
        points, weights = self.profiles.points, self.states[0].weights
        part = weights[points] / weights[points].sum()
        rows = np.zeros((len(points), len(weights)))
        rows[:, points] = np.sqrt(part)[:, None] * (np.eye(len(points)) - part)
        return rows

    def _stated(self) -> "_Program":
        """Variables, expressions, and all constraints but those that contact sets make."""
        U, profiles = self.scales.displacement, self.profiles
        c, top = cp.Variable(profiles.shapes.shape[1]), cp.Variable()
        relief, rows = profiles.shapes @ c, profiles.rows @ c
        low, high = np.isfinite(profiles.low), np.isfinite(profiles.high)
        constraints: list[cp.Constraint] = [rows[low] >= profiles.low[low] / U] if low.any() else []
        constraints += [rows[high] <= profiles.high[high] / U] if high.any() else []
        pressures, motions, gaps = [], [], []
        for state in self.states:
            n, k = state.rigid_motions.shape
            p, a = cp.Variable(n), cp.Variable(k) if k else None
            gap = state.offset + relief + state.compliance @ p
            if a is not None:
                gap = gap + state.rigid_motions @ a
                constraints.append(state.equilibrium.T @ p == -state.motion_load)
            constraints.append(p <= top if self.goal is Goal.PEAK else cp.norm(self._deviation @ p) <= top)
            pressures.append(p)
            motions.append(a)
            gaps.append(gap)
        return _Program(c, top, relief, pressures, motions, gaps, constraints)

    def best_with(self, touching: BoolArray) -> Piece | None:
        """Find the best profile with which the contact sets are those given; None if none is found.

        Parameters
        ----------
        touching : (loads, n)

        Returns
        -------
        Piece or None
        """
        program = self._stated()
        closed, open_ = [], []
        for p, gap, inside in zip(program.pressures, program.gaps, touching, strict=True):
            A, off = np.flatnonzero(inside), np.flatnonzero(~inside)
            closed.append((gap[A] == 0, p[A] >= 0) if len(A) else ())
            open_.append((p[off] == 0, gap[off] >= 0) if len(off) else ())
        every = [constraint for some in (*closed, *open_) for constraint in some]
        problem = cp.Problem(cp.Minimize(program.top), [*program.constraints, *every])
        try:
            minimise(problem)
        except SolverError:  # sets that hardly fit together; others will do
            return None
        if program.top.value is None:
            return None
        promise = np.full(touching.shape, -np.inf)
        for row, inside, shut, free, p, gap in zip(
            promise, touching, closed, open_, program.pressures, program.gaps, strict=True
        ):
            for at, pair, size in ((inside, shut, p.value), (~inside, free, gap.value)):
                if pair:  # on the edge of the set, and what letting it go would gain
                    row[at] = np.where(size[at] <= WEAK, pair[0].dual_value, -np.inf)
        order = [
            divmod(int(i), touching.shape[1]) for i in np.argsort(-promise, axis=None) if promise.flat[i] > -np.inf
        ]
        return Piece(
            value=float(program.top.value),
            coefficients=value_of(program.coefficients) * self.scales.displacement,
            pressures=np.array([value_of(p) for p in program.pressures]) * self.scales.pressure,
            touching=touching,
            turns=tuple(order),
            promising=int((promise > WEAK).sum()),
        )

    def relaxed(self, best: float) -> "Relaxation":
        """Find a value [p] below which the goal cannot be.

        Complementarity is dropped but for what is convex in it: F3 at the designed gap is zero, and in it p·g is at
        least what McCormick's two planes say (Math. Programming 10, 1976, 147-175) for g within its range and, where
        the peak is minimised, p up to the best peak that is known.

        Parameters
        ----------
        best : a value of the goal that is reached [p]

        Returns
        -------
        Relaxation
        """
        U, T = self.scales
        program = self._stated()
        cuts: list[cp.Constraint] = []
        lowest, highest = (limit / U for limit in self.profiles.value_range)
        for state, p, a, gap in zip(self.states, program.pressures, program.motions, program.gaps, strict=True):
            cuts += [p >= 0, gap >= 0]
            weights = np.diag(state.weights)
            eigenvalue = qp3.smallest_eigenvalue(state, weights)
            if eigenvalue is not None and eigenvalue < -qp3.NEGLIGIBLE:
                continue
            product = cp.Variable(len(lowest))
            cuts.append(product >= cp.multiply(lowest, p))
            if self.goal is Goal.PEAK:
                cuts.append(product >= cp.multiply(highest, p) + (best / T) * (program.relief - highest))
            work = qp3.objective(state, weights)
            values, vectors = np.linalg.eigh(work.hessian)
            root = (vectors * np.sqrt(np.maximum(values, 0.0) / 2)).T
            linear = work.pressure @ p + work.constant + (0.0 if a is None else work.amplitudes @ a)
            cuts.append(cp.sum_squares(root @ p) + linear + state.weights @ product <= 0)
        problem = cp.Problem(cp.Minimize(program.top), [*program.constraints, *cuts])
        minimise(problem)
        if program.top.value is None:
            raise SolverError("the convex relaxation of the design has no optimum, although a profile was found")
        pairs = zip(program.pressures, program.gaps, strict=True)
        return Relaxation(
            float(program.top.value) * T,
            value_of(program.coefficients) * U,
            np.array([value_of(p) > value_of(gap) for p, gap in pairs]),
        )


class _Program(NamedTuple):
    """Variables and expressions of a design, scaled."""

    coefficients: cp.Variable
    top: cp.Variable
    relief: cp.Expression
    pressures: list[cp.Variable]
    motions: list[cp.Variable | None]
    gaps: list[cp.Expression]
    constraints: list[cp.Constraint]
