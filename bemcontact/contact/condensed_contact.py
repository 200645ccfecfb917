"""The waist of the package: a condensed contact problem.

The boundary-element core makes a `CondensedContact`, and the formulations solve it. Neither side knows the other.
Lengths and stresses are in the user's units.
"""

import os
from collections.abc import Mapping
from dataclasses import field, replace
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.arrays import Array, BoolArray, IntArray, freeze_arrays, real_array, whole_array
from bemcontact.cached import cached_property
from bemcontact.checks.arguments import file_path, instance_of, load_factors, whole_number
from bemcontact.checks.attributes import WithHints
from bemcontact.contact import archive
from bemcontact.contact.consistency import (
    ensure_arrays,
    ensure_independent,
    ensure_labels,
    ensure_numbers,
    ensure_parts_fit,
)
from bemcontact.contact.free_motions import (
    ContactScales,
    MotionAlgebra,
    StiffnessRows,
    fix_gauge,
    stiffness_rows,
    typical_scales,
)
from bemcontact.contact.load_cases import Change, LoadCases, Pinned, Tools
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.options import Weights, named

CANCELLED = 64 * float(np.finfo(float).eps)
"""Fraction of the terms of a sum below which the sum is round-off."""
PRESSED = 1e-10
"""Fraction of the peak up to which a pressure is round-off: the tension that the certificate allows is as large."""
PEAK = 1e-12
"""Fraction of T below which the largest pressure is round-off, so that nothing touches."""


@frozen
class CondensedContact(WithHints, MotionAlgebra):
    """An elastic body condensed to its n contact points: u_n = Δ1 + M p + R a with ℓᵀp = -load, [SS92] (35)-(38).

    A contact point is a pair (zone, node): a node in two zones is two points, with two normals, gaps and pressures.
    Arrays are read-only. With k = 0 free rigid motions R, a and the load vanish. M and Δ1 are in the gauge of
    `fix_gauge`. Points are listed zone by zone and, within a zone, run by run in the order of the boundary.

    Parameters
    ----------
    points : (n, 2) undeformed positions [L]
    normals : (n, 2) unit normals of the rigid surface, from the surface into the body; of two elastic bodies the common
        ones, into the first body
    zone : (n,) index into `zone_names`
    run : (n,) number of the unbroken piece of boundary that the point belongs to
    arc_position : (n,) arc length along that piece [L]
    run_length : (number of runs,) its perimeter if the run closes on itself, else infinity [L]
    compliance : (n, n) M, normal displacement per pressure [L/p]
    free_displacement : (n,) Δ1, normal displacement without contact [L]
    rigid_motions : (n, k) R, the free rigid motions seen along the normals
    motion_load : (k,) work of the applied loads in these motions, [p L] for a motion of unit displacement
    initial_gap : (n,) ε [L]
    weights : (n,) tributary weights [L]: Σ w p n is the force of the rigid surface
    zone_weights : (zones, n) parts of the weights that belong to each zone, for a point between two zones, negative
        where the normal is out of the body that the zone names first; None where each point belongs to its zone alone
        [L]
    consistent_weights : (n, n) ∫ h hᵀ ds [L], or None where no mesh stands behind the problem
    element_length_weights : (n,) [L], or None likewise
    held_arc : (number of runs, 2) arc position of a run's ends that a condition holds on the rigid surface, up to which
        there is contact although there is no contact point; not a number for other ends; None if there are none [L]
    held_points : (number of runs, 2, 2) these ends [L], or None likewise
    motion_names : k descriptions of the free motions in words: those of the body, then those of tools
    motion_arms : (k,) distance from the center of a rotation at which its amplitude is the displacement; infinite for a
        translation; None if not known [L]
    tools : rigid surfaces that move; their displacements are part of ε, and their forces part of the load
    cases : load cases; those in effect are part of Δ1, the load and ε
    pinned : motions that move no contact point, in which all loads must balance
    notes : decisions that a user should know
    name, zone_names, units : labels
    """

    name: str = "unnamed"
    zone_names: tuple[str, ...] = ("contact",)
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    motion_names: tuple[str, ...] = ()
    points: Array
    normals: Array
    zone: IntArray
    run: IntArray
    arc_position: Array
    run_length: Array
    compliance: Array
    free_displacement: Array
    initial_gap: Array
    zone_weights: Array | None = None
    consistent_weights: Array | None = None
    element_length_weights: Array | None = None
    held_arc: Array | None = None
    held_points: Array | None = None
    motion_arms: Array | None = None
    tools: Tools = field(default_factory=lambda: Tools.none(0, 0))
    cases: LoadCases = field(default_factory=lambda: LoadCases.none(0, 0, 0))
    pinned: Pinned = field(default_factory=lambda: Pinned.none(0, 0))

    def __post_init__(self) -> None:
        """Refuse what is inconsistent, give empty tools and load cases their shapes, and make arrays read-only."""
        ensure_labels(self)
        ensure_arrays(self)
        for name, kind in (("tools", Tools), ("cases", LoadCases), ("pinned", Pinned)):
            instance_of(getattr(self, name), kind, name, "leave it out if there is none")
        n, k = self.rigid_motions.shape
        if not (len(self.tools) or self.tools.fit(n, k)):
            object.__setattr__(self, "tools", Tools.none(n, k))
        if not (len(self.cases) or self.cases.fit(n, k, len(self.tools))):
            object.__setattr__(self, "cases", LoadCases.none(n, k, len(self.tools)))
        c, t = len(self.cases), len(self.tools)
        fits = self.pinned.load.shape[1] == 1 + c and len(self.pinned.tools) == 3 * t
        if not (fits or len(self.pinned.motions) or self.pinned.magnitude.any()):
            object.__setattr__(self, "pinned", Pinned.none(c, t, self._extent or 1.0))
        ensure_parts_fit(self)
        freeze_arrays(self)

    @classmethod
    def from_compliance(
        cls,
        compliance: ArrayLike,
        offset: ArrayLike,
        weights: ArrayLike | None = None,
        *,
        rigid_motions: ArrayLike | None = None,
        motion_load: ArrayLike | None = None,
        name: str = "unnamed",
    ) -> Self:
        """State a contact problem by numbers: gap = q + M p + R a >= 0, p >= 0, p·gap = 0, ℓᵀp = -load.

        Parameters
        ----------
        compliance : (n, n) M
        offset : (n,) q = ε + Δ1, the gap without contact
        weights : (n,) positive tributary weights, default ones
        rigid_motions : (n, k) R, default none
        motion_load : (k,) load, needed with `rigid_motions`
        name : label

        Returns
        -------
        CondensedContact
            Points lie on the x axis, one unit apart; the gauge is fixed, `initial_gap` is `offset`.

        Raises
        ------
        ProblemError
            Shapes that do not fit, weights that are not positive, or entries that are not finite.
        """
        M = np.atleast_2d(real_array(compliance, "compliance"))
        q = np.atleast_1d(real_array(offset, "offset"))
        n = q.size
        J = np.ones(n) if weights is None else np.atleast_1d(real_array(weights, "weights"))
        R = np.zeros((n, 0)) if rigid_motions is None else real_array(rigid_motions, "rigid_motions")
        R = R.reshape(-1, 1) if R.ndim < 2 else R
        load = np.zeros(R.shape[1:]) if motion_load is None else np.atleast_1d(real_array(motion_load, "motion_load"))
        shapes = M.shape, q.shape, J.shape, R.shape[:1], load.shape, R.ndim
        if shapes != ((n, n), (n,), (n,), (n,), R.shape[1:], 2):
            raise ProblemError(
                f"offset has {n} entries; then compliance needs ({n}, {n}), weights ({n},), rigid_motions ({n}, k), "
                f"motion_load (k,); found {M.shape}, {J.shape}, {R.shape}, {load.shape}"
            )
        ensure_independent(R)
        if not (J > 0).all():
            raise ProblemError(f"weights must be positive; the smallest is {J.min():.3g}")
        gauge = fix_gauge(MotionAlgebra(rigid_motions=R, weights=J, motion_load=load), M, np.zeros(n))
        return cls(
            name=name,
            motion_names=tuple(f"motion {j + 1}" for j in range(R.shape[1])),
            points=np.column_stack([np.arange(n, dtype=float), np.zeros(n)]),
            normals=np.tile([0.0, 1.0], (n, 1)),
            zone=np.zeros(n, int),
            run=np.zeros(n, int),
            arc_position=np.arange(n, dtype=float),
            run_length=np.array([np.inf]),
            compliance=gauge.compliance,
            free_displacement=gauge.free_displacement,
            rigid_motions=R,
            motion_load=load,
            initial_gap=q,
            weights=J,
        )

    def __repr__(self) -> str:
        """One line: name, zones, number of points and free motions."""
        zones = ", ".join(self.zone_names)
        return f"<CondensedContact {self.name!r}: {self.size} points in {zones}; {self.free_motions} free motions>"

    @property
    def size(self) -> int:
        """Number n of contact points."""
        return len(self.initial_gap)

    @property
    def _extent(self) -> float:
        """Half the diagonal [L] of the rectangle around the contact points."""
        return float(np.hypot(*np.ptp(self.points, axis=0))) / 2

    @property
    def free_motions(self) -> int:
        """Number k of rigid motions that contact alone holds."""
        return self.rigid_motions.shape[1]

    @cached_property
    def offset(self) -> Array:
        """The gap q = ε + Δ1 (n,) [L] at p = 0, a = 0."""
        return self.initial_gap + self.free_displacement

    @cached_property
    def scales(self) -> ContactScales:
        """Scales with U = ‖M‖∞ T: the larger of those of the load and of the interference.

        A load that presses a free body needs the balancing pressure. Interference is the penetration without pressure
        at the best position of the body. Wide gaps far from contact do not count. If there is neither, U is the largest
        of the terms that are added up in q: what they leave of each other by round-off is no interference.
        """
        return typical_scales(
            self.compliance, self.offset, self.terms_of_offset, self.rigid_motions, self.balancing_pressure
        )

    @property
    def terms_of_offset(self) -> Array:
        """Sum of the magnitudes (n,) [L] of all that is added up in q: ε, Δ1, load cases and displacements of tools."""
        cases, tools = self.cases, self.tools
        if not (len(cases) or len(tools)):
            return abs(self.free_displacement) + abs(self.initial_gap)
        added, moved = cases.displacement * cases.factors, tools.motions * tools.position
        permanent = abs(self.free_displacement - added.sum(axis=1)) + abs(self.initial_gap - moved.sum(axis=1))
        return permanent + abs(added).sum(axis=1) + abs(moved).sum(axis=1)

    @property
    def net_load(self) -> float:
        """Largest work of the loads in a free motion, over the sum of their magnitudes; 1 if these are not known."""
        total = self.pinned.total(*_acting(self.cases, self.tools))
        return float(abs(self.motion_load).max(initial=0.0)) / total if total > 0 else 1.0

    def with_factors(self, factors: Mapping[str, float]) -> Self:
        """Apply load cases, each by its factor, and no other ones; nothing is condensed anew.

        Parameters
        ----------
        factors : by name of a case

        Returns
        -------
        CondensedContact

        Raises
        ------
        ProblemError
            If there is no such case, a factor is no finite number, or loads act along a motion that nothing resists.
        """
        numbers = load_factors(factors)
        if unknown := [name for name in numbers if name not in self.cases.names]:
            known = ", ".join(self.cases.names) or "none"
            raise ProblemError(f"there is no load case '{unknown[0]}'; there are: {known}")
        given = np.array([numbers.get(name, 0.0) for name in self.cases.names], float)
        step = given - self.cases.factors
        return self.stepped(step, self.cases.position * step, self.cases.force * step).balanced()

    def with_tools(self, position: ArrayLike | None = None, force: ArrayLike | None = None) -> Self:
        """Change the displacements and forces of the tools; nothing is condensed anew.

        Parameters
        ----------
        position : (t, 3) displacements x, y [L] and rotation [rad], as now if None; those of free components are unused
        force : (t, 3) x, y [p L] and moment [p L²], as now if None; those on components that are given are unused

        Returns
        -------
        CondensedContact

        Raises
        ------
        ProblemError
            If the shapes do not fit, a number is not finite, or forces act along a motion that nothing resists.
        """
        tools, steps = self.tools, []
        moves, loads = (
            f"displacements x, y, rotation of {len(tools)} tools",
            f"forces x, y, moment on {len(tools)} tools",
        )
        for what, new, now, used in (
            (moves, position, tools.position, ~tools.free), (loads, force, tools.force, tools.free)
        ):  # fmt: skip
            given = now if new is None else real_array(new, what)
            if given.shape not in ((len(tools), 3), now.shape):
                raise ProblemError(f"tools have {len(tools)} x 3 components; found an array of shape {given.shape}")
            steps.append(np.where(used, given.ravel() - now, 0.0))
        stepped = self.stepped(np.zeros(len(self.cases)), *steps)
        exact = replace(tools, position=tools.position + steps[0], force=tools.force + steps[1])
        return replace(stepped, tools=exact).balanced()

    def balanced(self) -> Self:
        """Refuse loads along a motion that nothing resists, with a `ProblemError`."""
        if violation := self.pinned.violation(*_acting(self.cases, self.tools), self.units):
            raise ProblemError(violation)
        return self

    def stepped(self, factors: Array, position: Array, force: Array) -> Self:
        """Add to the factors (c,), and to the displacements and forces of tools, each (3 t,) or (3 t, j) in j terms.

        The loads may be out of balance. What round-off leaves where terms cancel is zero.
        """
        cases, tools = self.cases, self.tools
        factors = real_array(factors, "factors", (len(cases),))
        position, force = (
            np.atleast_2d(real_array(terms, name).T).T for terms, name in ((position, "position"), (force, "force"))
        )
        for terms, name in ((position, "position"), (force, "force")):
            if len(terms) != tools.position.size:
                raise ProblemError(
                    f"{name} needs {tools.position.size} numbers, three for each tool; found {len(terms)}"
                )
        loads = np.column_stack([cases.motion_load * factors, _terms(tools.amplitudes.T, force)])
        moved = replace(tools, position=_sum(tools.position, position), force=_sum(tools.force, force))
        stepped = replace(cases, factors=cases.factors + factors)
        return replace(
            self,
            cases=stepped,
            tools=moved,
            free_displacement=_sum(self.free_displacement, cases.displacement * factors),
            initial_gap=_sum(self.initial_gap, _terms(tools.motions, position)),
            motion_load=_sum(self.motion_load, loads, self.pinned.total(*_acting(stepped, moved))),
        )

    @property
    def changes(self) -> dict[str, Change]:
        """Changes that need no new condensation, by key path, each per unit: factors of load cases, tools.

        Changes without effect are left out, and changes that would drive a motion that nothing resists.
        """
        cases, tools, pinned = self.cases, self.tools, self.pinned
        unit, units = np.eye(1 + len(cases))[1:], np.eye(3 * len(tools))
        offsets = cases.displacement + tools.motions @ cases.position
        loads = cases.motion_load + tools.amplitudes.T @ cases.force
        of_cases = {
            f"load_cases.{name}": Change(offset, load)
            for name, offset, load, alone, force in zip(
                cases.names, offsets.T, loads.T, unit, cases.force.T, strict=True
            )
            if pinned.violation(alone, force) is None
        }
        moves = zip(tools.keys, np.where(tools.free, 0.0, tools.motions).T, tools.amplitudes, units, strict=True)
        return of_cases | {
            key: Change(offset, load)
            for key, offset, load, alone in moves
            if (offset.any() or load.any()) and pinned.violation(np.zeros(1 + len(cases)), alone) is None
        }

    @cached_property
    def stiffness_rows(self) -> StiffnessRows:
        """K u_n = B p + r, (12), with K = S, B = I, r = S Δ1 + V load; [S, V] the top of [[M, R], [ℓᵀ, 0]]⁻¹.

        `SingularSystemError` where that has no inverse.
        """
        return stiffness_rows(self, self.compliance, self.free_displacement, self.scales)

    def gap(self, pressure: Array, rigid_amplitudes: Array) -> Array:
        """δ = ε + Δ1 + M p + R a, (n,) [L], from p (n,) [p] and a (k,)."""
        p = self._by_point(pressure, "pressure")
        a = real_array(rigid_amplitudes, "rigid_amplitudes", (self.free_motions,), finite=False)
        return self.offset + self.compliance @ p + self.rigid_motions @ a

    def rotations(self, rigid_amplitudes: Array) -> Array | None:
        """Angle (k,) [rad] of each free motion, for amplitudes a (k,) [L]; zero in a translation; None if not known.

        The sense is that of the name, counterclockwise for a body or a tool that turns alone. It is the angle of the
        linear theory, displacement over distance.
        """
        a = real_array(rigid_amplitudes, "rigid_amplitudes", (self.free_motions,), finite=False)
        return None if self.motion_arms is None else a / self.motion_arms + 0.0

    def resultants(self, pressure: Array) -> Array:
        """Σ w p n (..., zones, 2) [p L]: the force of each zone's rigid surface on the body, from p (..., n) [p]."""
        p = self._by_point(pressure, "pressure", 0)
        with np.errstate(invalid="ignore"):  # as in forces
            return (p[..., None, :] * self.weights_by_zone) @ self.normals

    def moments(self, pressure: Array) -> Array:
        """Moments (..., zones) [p L²] of these forces about the origin, counterclockwise, from p (..., n) [p]."""
        p = self._by_point(pressure, "pressure", 0)
        levers = self.points[:, 0] * self.normals[:, 1] - self.points[:, 1] * self.normals[:, 0]
        with np.errstate(invalid="ignore"):  # as in forces
            return (p[..., None, :] * self.weights_by_zone) @ levers

    @property
    def weights_by_zone(self) -> Array:
        """The weights (zones, n) in each zone [L]: zero for points of other zones; signs as of `zone_weights`."""
        if self.zone_weights is not None:
            return self.zone_weights
        return self.weights * (self.zone == np.arange(len(self.zone_names))[:, None])

    @property
    def lengths_by_zone(self) -> Array:
        """The lengths (zones, n) that belong to each point in each zone [L], which are not negative."""
        return np.abs(self.weights_by_zone)

    def forces(self, pressure: Array) -> Array:
        """Forces w p n (..., n, 2) [p L] at the contact points, from p (..., n) [p]."""
        p = self._by_point(pressure, "pressure", 0)
        with np.errstate(invalid="ignore"):  # a solver that failed may leave an infinite pressure
            return (self.weights * p)[..., None] * self.normals

    def tool_reactions(self, pressure: Array) -> Array:
        """Force (t, 3) of the body on each tool: x, y [p L] and moment [p L²], from p (n,) [p]."""
        return (self.tools.motions.T @ (self.weights * self._by_point(pressure, "pressure"))).reshape(-1, 3)

    def _by_point(self, values: Array, what: str, dimensions: int = 1) -> Array:
        """Refuse all but numbers by contact point (n,), or (..., n) where any number of dimensions may come first."""
        array = real_array(values, what, finite=False)
        if array.shape[-1:] != self.initial_gap.shape or (dimensions and array.ndim != dimensions):
            raise ProblemError(f"{what} has shape {array.shape} where ({self.size},) is needed")
        return array

    def in_order(self, index: IntArray) -> IntArray:
        """Contact points (m,) run by run, in the order of the boundary."""
        index = whole_array(index, "index of points", (None,))
        if index.size and not (index.min() >= 0 and index.max() < self.size):
            raise ProblemError(f"points are numbered from 0 to {self.size - 1}; found {index.min()} to {index.max()}")
        return index[np.lexsort((self.arc_position[index], self.run[index]))]

    def points_of_run(self, run: int) -> IntArray:
        """Contact points of a run in the order of the boundary."""
        return self.in_order(np.flatnonzero(self.run == whole_number(run, "number of a run", 0)))

    def at_rest(self) -> Self:
        """Switch all load cases off, and leave all tools undisplaced and unloaded, balanced or not."""
        return self.stepped(-self.cases.factors, -self.tools.position, -self.tools.force)

    def touching(self, pressure: Array, displacement: Array) -> BoolArray:
        """Which points (n,) are in contact, p/T > δ/U, from p (n,) [p] and u_n (n,) [L]; robust to tolerances."""
        return self._touching(self._by_point(pressure, "pressure"), self._by_point(displacement, "displacement"))

    def _touching(self, p: Array, u_n: Array) -> BoolArray:
        """`touching` of arrays by contact point."""
        U, T = self.scales
        return p / T > (self.initial_gap + u_n) / U

    def pressed(self, pressure: Array, displacement: Array) -> BoolArray:
        """Which points (n,) are in contact under pressure that is no round-off beside the peak, nor that beside T."""
        p, u_n = self._by_point(pressure, "pressure"), self._by_point(displacement, "displacement")
        peak = self._peak(p)
        return self._touching(p, u_n) & (p > PRESSED * peak) if peak else np.zeros(self.size, bool)

    def peak(self, pressure: Array) -> float:
        """Largest of the pressures p (n,), [p]; zero if it is round-off beside T."""
        return self._peak(self._by_point(pressure, "pressure"))

    def _peak(self, p: Array) -> float:
        """`peak` of an array by contact point."""
        peak = float(p.max(initial=0.0))
        return peak if peak > PEAK * self.scales.pressure else 0.0

    def weight_matrix(self, weights: Weights) -> Array:
        """The J (n, n) [L] of the objective; `ProblemError` if the problem does not have these weights."""
        match named(Weights, weights, "weights"):
            case Weights.TRIBUTARY:
                return np.diag(self.weights)
            case Weights.CONSISTENT:
                J = self.consistent_weights
            case Weights.ELEMENT_LENGTH:
                J = None if self.element_length_weights is None else np.diag(self.element_length_weights)
        if J is None:
            raise ProblemError(f"the condensed problem carries no {weights} weights; use tributary ones")
        return J

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the problem as one ``.npz`` file, whole or not at all; `OSError` if it cannot be written."""
        archive.write(file_path(path, "the file to write"), self)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read what `save` wrote; `ProblemError` if the file is something else."""
        return archive.read(file_path(path, "the file to read"), cls)


def computed_contact(**fields: Any) -> CondensedContact:
    """Make a contact problem of all fields as `bem` computes them: shapes, ranges and order are not checked.

    `ProblemError` if there is no contact point, numbers are not finite or too large to compute with, or free motions
    depend on each other.
    """
    contact = object.__new__(CondensedContact)
    vars(contact).update(fields)
    ensure_numbers(contact)
    freeze_arrays(contact)
    return contact


def _terms(matrix: Array, columns: Array) -> Array:
    """All products (m, i j) whose sums by row are matrix (m, i) @ columns (i, j) @ ones."""
    return (matrix[:, :, None] * columns).reshape(len(matrix), columns.size)


def _sum(start: Array, terms: Array, least: float = 0.0) -> Array:
    """Sum (m,) of the start (m,) and terms (m, t); zero if it is round-off beside the terms, or beside a least size."""
    total = start + terms.sum(axis=1)
    size = np.maximum(abs(start) + abs(terms).sum(axis=1), least)
    return np.where(abs(total) > CANCELLED * size, total, 0.0)


def _acting(cases: LoadCases, tools: Tools) -> tuple[Array, Array]:
    """Factors (1 + c,) of what is permanent and of the cases, and the terms (3 t, 1 + c) of the forces on tools."""
    factors = np.concatenate([[1.0], cases.factors])
    if not len(tools):
        return factors, np.zeros((0, len(factors)))
    of_cases = cases.force * cases.factors
    return factors, np.column_stack([_sum(tools.force, -of_cases), of_cases])
