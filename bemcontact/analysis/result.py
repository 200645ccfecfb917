"""The result of a contact problem: its solution and all quantities recomputed from it."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bemcontact.arrays import Array
from bemcontact.assessment.accuracy import Accuracy, together
from bemcontact.assessment.certificate import Certificate
from bemcontact.assessment.footprint import (
    ContactInterval,
    Footprint,
    FootprintRecord,
    Peak,
    footprint_record,
)
from bemcontact.assessment.penetration import Penetration
from bemcontact.assessment.residual import Residuals
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.cached import cached_property
from bemcontact.checks.attributes import ByName
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.multistart import RandomStarts
from bemcontact.contact.record import (
    ContactRecord,
    SolutionRecord,
    UnitsRecord,
    contact_record,
    solution_record,
    units_record,
)
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.contact.stress import EdgeStress, Labels, LargestStresses, Stress, TriangulatedBody
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.options import FormulationName, Weights
from bemcontact.problems.problem import Problem
from bemcontact.problems.units import Units
from bemcontact.serialization import Pair, PairTables, Record, Recorded
from bemcontact.threads import one_thread
from bemcontact.version import __version__
from bemcontact.views import Tabular

ROUND_OFF = 1e-9
"""Relative error that is not worth a word."""

BEYOND = "do not include"
"""What a note says of error bars that leave out its subject."""


class BoundaryRecord(Record):
    """State of the whole boundary, element by element; values at the three nodes of each. JSON names the edges."""

    points: PairTables
    """Undeformed nodes (x, y) [L]."""
    displacement: PairTables
    """Displacement (x, y) [L]."""
    traction: PairTables
    """Force (x, y) on the body per undeformed length [p]; it may jump between elements."""
    edge: list[str]
    """Name of the edge of each element."""


class HeadRecord(Record):
    """First fields of a result, which JSON has before those of its parts."""

    name: str
    """Name of the problem."""
    version: str
    """Version of bemcontact."""
    formulation: FormulationName
    """Statement that was solved."""
    certified: bool
    """Whether this is proved to be the contact state, and the only one, where the body penetrates no rigid surface and
    strains are small."""
    units: UnitsRecord
    """Labels of the units."""
    dof: int | None
    """Number of unknowns of the boundary elements, two for each node; null for a condensed problem."""
    notes: tuple[str, ...]
    """Notes on the problem, its mesh and the solver."""


class ResultRecord(FootprintRecord, SolutionRecord, ContactRecord, HeadRecord):
    """Solution of a contact problem and all quantities recomputed from it; lists are by contact point.

    JSON has the contact points, the solution and the footprint without nesting.
    """

    holds: bool | None
    """Whether it is certified and the mesh is as accurate as was asked; null if mesh errors are not assessed."""
    accuracy: Accuracy
    """Accuracy of the mesh: error bars, and whether they are as small as was asked."""
    weights: Weights
    """Weights of the objective."""
    objective: float
    """Objective pᵀJδ with these weights, recomputed, per thickness [p L²]."""
    starts: RandomStarts | None
    """Searches from random starts, if any were asked for."""
    residuals: Residuals
    """Residuals of the contact conditions and equations."""
    equilibrium_slack: float | None
    """Imbalance of the discrete equations relative to the loads; null for a condensed problem."""
    certificate: Certificate
    """Certificate of the solution."""
    penetration: Penetration | None
    """Where the deformed boundary does not fit a surface or a body, or strains are not small; null if neither, or for a
    condensed problem, whose boundary was not looked at."""
    boundary: BoundaryRecord | None
    """State of the whole boundary; null for a condensed problem."""
    sides: dict[str, tuple[str, str]]
    """The bodies of each contact, first the one on which its force acts; the second is '' for a rigid surface. Empty
    if an only body touches rigid surfaces."""
    seconds: dict[str, float]
    """Time of each stage: "compilation" is that by numba, and in no other stage. Notes say which bodies reuse the
    condensation of another one."""


@frozen
class Result(Recorded, Tabular):
    """A solution of a contact problem and all quantities recomputed from it."""

    problem: Problem | None
    """The problem on its mesh; None if a condensed problem was solved."""
    contact: CondensedContact
    """The condensed problem."""
    solution: ContactSolution
    """The solution as the formulation reports it."""
    weights: Weights
    """Weights of the objective."""
    objective: float
    """Objective pᵀJδ with these weights, recomputed, per thickness [p L²]."""
    residuals: Residuals
    """Residuals of the contact conditions and equations, recomputed from the condensed problem."""
    certificate: Certificate
    """Certificate of the solution."""
    footprint: Footprint
    """Contact intervals, peak pressure and resultant; no peak where it is infinite."""
    penetration: Penetration | None
    """Where the deformed boundary does not fit a surface or a body, or strains are not small; None if neither, or for a
    condensed problem, whose boundary was not looked at."""
    boundary: BoundaryState | None
    """Displacement and traction of the whole boundary; None for a condensed problem."""
    known_motions: KnownMotions
    """What is known of the free motions: `rotations` and `unknown_motions`."""
    degrees_of_freedom: int | None
    """Two for each node of the mesh; None for a condensed problem."""
    notes: tuple[str, ...]
    """Notes on the condensation, the mesh and the solver."""
    accuracy: Accuracy
    """Error bars of the mesh, and whether they are as small as was asked."""
    seconds: dict[str, float]
    """Time of each stage: "compilation" is that by numba, and in no other stage. Notes say which bodies reuse the
    condensation of another one."""
    starts: RandomStarts | None = None
    """Searches from random starts, if any were asked for."""

    def __repr__(self) -> str:
        """One line: name, formulation, verdict, peak."""
        if self.footprint.peak is not None:
            largest, bar = self.footprint.peak.pressure, self.accuracy.peak_bar()
            known = "" if bar is None or bar < ROUND_OFF else f" ± {bar * largest:.2g}"
            peak = f"peak pressure {largest:.6g}{known} {self.units.stress}".rstrip()
        else:
            peak = "infinite peak pressure" if self.footprint.intervals else "no contact"
        equations = self.certificate.heading
        if self.penetration is not None:
            zone = self.penetration.zone
            equations = f"{self.penetration.kind}: '{zone}'" if zone else str(self.penetration.kind)
        by = f"{self.contact.name!r} by {self.solution.formulation}"
        return f"<Result of {by}: {equations}, {self.accuracy.in_short}, {peak}>"

    @property
    def units(self) -> Units:
        """Labels of the units that all numbers are in."""
        return Units(**self.contact.units)

    @property
    def _labels(self) -> Labels:
        """Labels of units of stresses."""
        return Labels(length=self.units.length, stress=self.units.stress)

    @property
    def points(self) -> Array:
        """Undeformed places (n, 2) of the contact points [L]."""
        return self.contact.points

    @property
    def pressure(self) -> Array:
        """Pressure (n,) at the contact points, per undeformed length [p]."""
        return self.solution.pressure

    @property
    def gap(self) -> Array:
        """Gap (n,) at the contact points, zero in contact [L]."""
        return self.contact.initial_gap + self.solution.displacement

    @property
    def peak(self) -> Peak | None:
        """The largest pressure and its place; None without contact, or where it is infinite."""
        return self.footprint.peak

    @property
    def intervals(self) -> tuple[ContactInterval, ...]:
        """Where the body touches: the two ends of each interval."""
        return self.footprint.intervals

    @property
    def forces(self) -> dict[str, Pair]:
        """Force (x, y) of each contact on the body, or on the first of its two bodies, per thickness [p L]."""
        return self.footprint.forces

    @property
    def rotations(self) -> Array | None:
        """Angle (k,) of each free motion, in radians and in the sense of its name; zero in a translation.

        Not a number for a rotation among `unknown_motions`; None for a condensed problem of elastic bodies that touch.
        That of a body that touches elastic ones is the mean rotation of its boundary.
        """
        return self.known_motions.rotations

    @property
    def unknown_motions(self) -> tuple[str, ...]:
        """Names of the free motions whose amount is not known.

        Contact leaves them open, or only slopes and levers as drawn hold them, which move with the body. Of a condensed
        problem they are the former alone.
        """
        return self.known_motions.unknown

    @property
    def certified(self) -> bool:
        """Whether this is proved to be the only solution on the mesh, penetrates no surface, and has small strains."""
        return self.certificate.certified and self.penetration is None

    @property
    def words(self) -> str:
        """The verdict on the equations in sentences: what does not fit, how the solver ended, what is proved."""
        status = self.solution.status
        ending = "" if status is Status.SOLVED else f"The solver: {status.words}. "
        words = ending + self.certificate.words
        return words if self.penetration is None else self.penetration.before(words)

    @property
    def holds(self) -> bool | None:
        """Whether the equations are certified, and the mesh is as accurate as was asked.

        None if they are certified, and mesh errors are not assessed: no accuracy was asked for (accuracy: null), or
        the problem was given condensed, so that neither its mesh nor its boundary was looked at.
        """
        return together((self.certified, self.accuracy.holds))

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Whether each contact point (n,) is in contact, by `CondensedContact.touching`."""
        return self.contact.touching(self.solution.pressure, self.solution.displacement)

    @property
    def equilibrium_slack(self) -> float | None:
        """Imbalance of the discrete equations relative to the loads; None without a boundary."""
        return None if self.boundary is None else self.boundary.equilibrium_slack

    @cached_property
    def _stresses(self):  # its type costs the time of importing it
        """The stress in all bodies; `ProblemError` without a boundary."""
        from bemcontact.analysis.stress_of_bodies import StressOfBodies

        pressed = self._fields_by_zone()[0][:, :, 1] > 0
        assert self.problem is not None
        assert self.boundary is not None
        return StressOfBodies.of(self.problem, self.boundary, pressed, self.accuracy.infinite_places)

    @one_thread
    def stress(self, points: ArrayLike, body: str | None = None) -> Stress:
        """Stress at points inside the body and on its boundary.

        Parameters
        ----------
        points : (k, 2) places (x, y) in the undeformed body [L]
        body : name of the body, if there are several. If None, it is the first one that has the point inside, else the
            first one that has it on its boundary, in the order of `bodies`. So at a point of a contact it is that of
            the two that is stated first, and the stress in the other one is another: name the body that is meant

        Returns
        -------
        Stress
            Components, principal stresses, equivalent stresses [p], and what kind of place each point is. At a corner
            they are the mean of those on either side. Where stress is infinite it is not a number.

        Raises
        ------
        ProblemError
            A point is outside the body, or the result is that of a condensed problem, which has no body.
        """
        return replace(self._stresses.stress(points, body), labels=self._labels)

    @one_thread
    def displacement(self, points: ArrayLike, body: str | None = None) -> Array:
        """Displacement (k, 2) [L] at points inside the body and on its boundary.

        Parameters
        ----------
        points : (k, 2) places (x, y) in the undeformed body [L]
        body : as of `stress`

        Raises
        ------
        ProblemError
            As of `stress`.
        """
        return self._stresses.displacement(points, body)

    @one_thread
    def boundary_stress(self) -> dict[str, EdgeStress]:
        """Stress along each edge by its name: hoop stress with its peak, pressure, shear.

        Raises
        ------
        ProblemError
            The result is that of a condensed problem, which has no boundary.
        """
        stresses = {edge: replace(self._stresses.along(edge), labels=self._labels) for edge in self._stresses.edges}
        return ByName("edge", stresses)

    @one_thread
    def largest_stresses(self) -> LargestStresses:
        """Look for the largest stresses: below each contact, inside the body and along its edges.

        Their error bars are estimated from a solution on another mesh, if those of the pressures are known.

        Raises
        ------
        ProblemError
            The result is that of a condensed problem, which has no body.
        """
        return self._largest_stresses

    @cached_property
    def _largest_stresses(self) -> LargestStresses:
        """`largest_stresses`, which take as long as a solution."""
        from bemcontact.analysis.stress_bars import largest_with_bars

        stresses = self._stresses
        assert self.problem is not None
        return replace(largest_with_bars(self.problem, stresses, self.accuracy), labels=self._labels)

    @cached_property
    def triangulated(self) -> TriangulatedBody:
        """Displacement and stress all over the body, on triangles that fill it.

        Raises
        ------
        ProblemError
            The result is that of a condensed problem, which has no body.
        """
        return self._stresses.filled

    def contact_fields(self) -> tuple[Array, Array]:
        """Pressure (m, 3) [p] and gap (m, 3) [L] at the nodes of each boundary element, of the zone of its edge.

        Off the contact points the pressure is zero, and the gap is not a number.

        Raises
        ------
        ProblemError
            The result is that of a condensed problem, which has no boundary.
        """
        pressures, gaps = self._fields_by_zone()
        order = np.where(np.isnan(gaps), -np.inf, pressures), np.where(np.isnan(gaps), -np.inf, -gaps)
        first = np.lexsort(order[::-1], axis=0)[-1:]
        pressure, gap = (np.take_along_axis(values, first, axis=0)[0] for values in (pressures, gaps))
        return pressure, gap

    def _fields_by_zone(self) -> tuple[Array, Array]:
        """Pressure (zones, m, 3) [p] and gap (zones, m, 3) [L] as of `contact_fields`, in each zone."""
        contact, problem, boundary = self.contact, self.problem, self.boundary
        if problem is None or boundary is None:
            raise ProblemError("the result of a condensed problem has no boundary; solve the problem itself")
        gaps, shape = self.gap, boundary.points.shape[:2]
        pressure, gap = (np.full((len(contact.zone_names), *shape), value) for value in (0.0, np.nan))
        for number, name in enumerate(contact.zone_names):
            edges = [boundary.edge_names.index(edge) for edge in problem.edges_of(name)]
            own = np.flatnonzero(contact.zone == number)
            at = {tuple(contact.points[i]): i for i in own}
            on_run = {(run, *point): i for i in own for run, point in [(contact.run[i], contact.points[i])]}
            for element in np.flatnonzero(np.isin(boundary.edge, edges)):
                places = [*map(tuple, boundary.points[element])]
                run = contact.run[at[places[1]]] if places[1] in at else -1
                for local, place in enumerate(places):
                    if (i := on_run.get((run, *place), at.get(place))) is not None:
                        here = self.solution.pressure[i], gaps[i]
                        pressure[number, element, local], gap[number, element, local] = here
        return pressure, gap

    @property
    def sides(self) -> dict[str, tuple[str, str]]:
        """The bodies of each contact, first the one on which its force acts; empty with an only body or none."""
        if self.problem is None or not self.problem.several:
            return {}
        return {zone: self.problem.touching_bodies(zone) for zone in self.problem.zones}

    def record(self) -> ResultRecord:
        """Return the record that is written as JSON."""
        boundary = self.boundary
        return ResultRecord(
            name=self.contact.name,
            version=__version__,
            formulation=FormulationName(self.solution.formulation),
            certified=self.certified,
            units=units_record(self.contact),
            dof=self.degrees_of_freedom,
            notes=self.notes,
            **dict(contact_record(self.contact)),
            **dict(solution_record(self.contact, self.solution, self.known_motions)),
            **dict(footprint_record(self.footprint)),
            holds=self.holds,
            accuracy=self.accuracy,
            weights=self.weights,
            objective=self.objective,
            starts=self.starts,
            residuals=self.residuals,
            equilibrium_slack=self.equilibrium_slack,
            certificate=self.certificate,
            penetration=self.penetration,
            sides=self.sides,
            boundary=None
            if boundary is None
            else BoundaryRecord(
                points=boundary.points,
                displacement=boundary.displacement,
                traction=boundary.traction,
                edge=[boundary.edge_names[i] for i in boundary.edge],
            ),
            seconds=self.seconds,
        )
