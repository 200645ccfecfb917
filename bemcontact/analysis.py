"""From a problem to a judged result: condense, solve, assess, recover. The only file that sees both halves."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import bemcontact
from bemcontact.assessment.certificate import Certificate, certify
from bemcontact.assessment.footprint import Footprint, footprint
from bemcontact.assessment.residual import Residuals, residuals
from bemcontact.bem.condense import Body, body_of
from bemcontact.bem.condense import condense as condense_body
from bemcontact.bem.recovery import BoundaryState, boundary_state
from bemcontact.contact import CondensedContact, ContactSolution, Weights
from bemcontact.errors import ProblemError
from bemcontact.formulations import FORMULATIONS, FormulationOptions
from bemcontact.problem.problem import Problem

FEW_POINTS = 5
"""Points under pressure below which a contact is not resolved: three make a parabola, two more its ends."""
SMOOTH = 0.2
"""Sine of the angle at the end of a zone below which the boundary goes on smoothly."""
LARGE_PRESSURE = 0.5
"""Peak pressure over Young's modulus beyond which nothing is left of small displacements."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Result:
    """A contact solution, judged.

    Parameters
    ----------
    problem : what was asked, or None if a condensed problem was
    contact : the condensed problem
    solution : what the formulation found
    weights : of the objective
    objective : pᵀJδ with these weights, recomputed [p L²]
    residuals, certificate : the judgement, recomputed from the condensed problem
    footprint : contact intervals, peak, resultant
    boundary : displacement and traction on the whole boundary, or None if no boundary stands behind `contact`
    degrees_of_freedom : two for each node of the mesh, or None likewise
    notes : what a person should know: of the condensation, of the solver, of the mesh
    seconds : spent on each stage
    """

    problem: Problem | None
    contact: CondensedContact
    solution: ContactSolution
    weights: Weights
    objective: float
    residuals: Residuals
    certificate: Certificate
    footprint: Footprint
    boundary: BoundaryState | None
    degrees_of_freedom: int | None
    notes: tuple[str, ...]
    seconds: dict[str, float]

    def __repr__(self) -> str:
        """One line: name, formulation, verdict, peak."""
        peak = "no contact" if self.footprint.peak is None else f"peak pressure {self.footprint.peak.pressure:.6g}"
        verdict = "certified" if self.certified else self.certificate.kind.value
        return f"<Result of {self.contact.name!r} by {self.solution.formulation}: {verdict}, {peak}>"

    @property
    def certified(self) -> bool:
        """Whether this is proved to be the solution, and the only one."""
        return self.certificate.certified

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Which contact points (n,) are in contact, by `CondensedContact.touching`."""
        return self.contact.touching(self.solution.pressure, self.solution.displacement)

    @property
    def equilibrium_slack(self) -> float | None:
        """How far the discrete equations are from equilibrium, relative to the loads; None without a boundary."""
        return None if self.boundary is None else self.boundary.equilibrium_slack

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        contact, solution, judged = self.contact, self.solution, self.residuals
        return {
            "name": contact.name,
            "version": bemcontact.__version__,
            "formulation": solution.formulation,
            "solver": solution.solver,
            "status": solution.status.name.lower(),
            "certified": self.certified,
            "units": dict(contact.units),
            "dof": self.degrees_of_freedom,
            "contact_nodes": contact.size,
            "free_rigid_motions": contact.free_motions,
            "motion_names": list(contact.motion_names),
            "motion_load": contact.motion_load.tolist(),
            "rigid_amplitudes": solution.rigid_amplitudes.tolist(),
            "notes": list(self.notes),
            "nodes": contact.points.tolist(),
            "normals": contact.normals.tolist(),
            "zone": [contact.zone_names[i] for i in contact.zone],
            "weights": self.weights.value,
            "tributary_lengths": contact.weights.tolist(),
            "initial_gap": contact.initial_gap.tolist(),
            "pressure": solution.pressure.tolist(),
            "gap": (contact.initial_gap + solution.displacement).tolist(),
            "normal_displacement": solution.displacement.tolist(),
            "resultant": list(self.footprint.resultant.force),
            "resultant_moment": self.footprint.resultant.moment,
            "intervals": [
                {"zone": interval.zone, "start": list(interval.start), "end": list(interval.end)}
                for interval in self.footprint.intervals
            ],
            "peak": None
            if self.footprint.peak is None
            else {"pressure": self.footprint.peak.pressure, "at": list(self.footprint.peak.at)},
            "objective": self.objective,
            "iterations": solution.iterations,
            "polished": solution.polished,
            "scales": contact.scales._asdict(),
            "residuals": {
                "penetration": judged.penetration,
                "tension": judged.tension,
                "complementarity": judged.complementarity,
                "equilibrium": judged.equilibrium,
                "stiffness_rows": judged.stiffness_rows,
                "balance": judged.balance,
                "force_balance": judged.force_balance,
                "work": judged.work,
                "equilibrium_slack": self.equilibrium_slack,
            },
            "certificate": {
                "kind": self.certificate.kind.value,
                "smallest_eigenvalue": self.certificate.smallest_eigenvalue,
                "error_bound": self.certificate.error_bound,
                "words": self.certificate.words,
            },
            "convexity": solution.smallest_eigenvalue,
            "boundary": None
            if self.boundary is None
            else {
                "points": self.boundary.points.tolist(),
                "displacement": self.boundary.displacement.tolist(),
                "traction": self.boundary.traction.tolist(),
                "edge": [self.boundary.edge_names[i] for i in self.boundary.edge],
            },
            "seconds": self.seconds,
        }

    def to_json(self, indent: int | None = 2) -> str:
        """Write `to_dict` as JSON; every number in it is finite."""
        return json.dumps(self.to_dict(), indent=indent, allow_nan=False, ensure_ascii=False)


@dataclass
class _Stopwatch:
    """Seconds spent on each stage."""

    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what is inside."""
        begin = time.perf_counter()
        yield
        self.seconds[name] = time.perf_counter() - begin


def condense(problem: Problem) -> CondensedContact:
    """Condense a body to its contact points.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    CondensedContact

    Raises
    ------
    ProblemError
        If contact cannot hold the body, or conditions contradict each other.
    SingularSystemError
        If the equations of the body have no unique solution.
    """
    _check_kind(problem, Problem)
    return condense_body(body_of(problem)).contact


def _check_kind(problem: object, *kinds: type) -> None:
    """Refuse what is no problem, a file name above all."""
    kinds = kinds or (Problem, CondensedContact)
    if not isinstance(problem, kinds):
        names = " or a ".join(kind.__name__ for kind in kinds)
        raise ProblemError(
            f"a {names} is needed, found {type(problem).__name__}; bemcontact.load reads one from a file"
        )


def solve(
    problem: Problem | CondensedContact,
    formulation: str = "qp3",
    weights: Weights | str = Weights.TRIBUTARY,
) -> Result:
    """Solve a contact problem by one formulation, and judge the answer.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulation : "qp3" (a convex program, then polished) or "complementarity" (the direct solver)
    weights : the J of QP3's objective, a `Weights` or its name: "tributary", "consistent" or "element_length"

    Returns
    -------
    Result
        Check `certified`: a solver that fails is a `Status`, not an error.

    Raises
    ------
    ProblemError
        If the problem has no answer, or `formulation` or `weights` are unknown.
    NotConvexError
        If the formulation needs a convex program and this is none.
    """
    _check_kind(problem)
    if formulation not in FORMULATIONS:
        raise ProblemError(f"there is no formulation '{formulation}'; take one of {', '.join(FORMULATIONS)}")
    weights = _weights(weights)
    watch = _Stopwatch()
    condensation = None
    if isinstance(problem, CondensedContact):
        contact = problem
    else:
        with watch.stage("mesh"):
            body = body_of(problem)
        with watch.stage("condensation"):
            condensation = condense_body(body)
        contact = condensation.contact
    with watch.stage("solution"):
        solution = FORMULATIONS[formulation](contact, FormulationOptions(weights=weights))
    boundary = None
    if condensation is not None:
        with watch.stage("recovery"):
            boundary = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    with watch.stage("assessment"):
        judged = residuals(contact, solution, None if boundary is None else boundary.force_balance)
        certificate = certify(contact, solution, judged)
        where = footprint(contact, solution)
        touching = contact.touching(solution.pressure, solution.displacement)
        notes = (*contact.notes, *solution.notes, *_notes_of(touching))
        if condensation is not None:
            notes += (*_notes_of_zone_ends(condensation.body, touching), *_notes_of_size(condensation.body, where))
    gap = contact.initial_gap + solution.displacement
    return Result(
        problem=problem if isinstance(problem, Problem) else None,
        contact=contact,
        solution=solution,
        weights=weights,
        objective=float(solution.pressure @ contact.weight_matrix(weights) @ gap),
        residuals=judged,
        certificate=certificate,
        footprint=where,
        boundary=boundary,
        degrees_of_freedom=None if condensation is None else condensation.body.mesh.degrees_of_freedom,
        notes=notes,
        seconds=watch.seconds,
    )


def _notes_of(touching: NDArray[np.bool_]) -> Iterator[str]:
    """Say if too few points carry pressure to show its course."""
    carrying = int(np.count_nonzero(touching))
    if 0 < carrying < FEW_POINTS:
        yield (
            f"pressure acts on {carrying} contact point{'s' if carrying > 1 else ''} only: the mesh is too coarse "
            "there to tell how it is distributed; shorten the elements"
        )


def _notes_of_zone_ends(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Say where contact reaches the end of a zone although the boundary goes on smoothly."""
    mesh, points = body.mesh, body.points
    in_zone = np.isin(np.arange(len(mesh.elements)), points.element)
    turn = np.sum(mesh.normals[mesh.before, 2] * mesh.tangents[:, 0], axis=1) / mesh.jacobians[:, 0]
    smooth_end = (in_zone != in_zone[mesh.before]) & (abs(turn) < SMOOTH)
    for i in np.flatnonzero(touching):
        if points.node[i] < len(mesh.elements) and smooth_end[points.node[i]]:
            x, y = mesh.nodes[points.node[i]]
            yield (
                f"contact reaches the end of the zone '{list(body.problem.contact_zones)[points.zone[i]]}' at "
                f"({x:.5g}, {y:.5g}), where the boundary goes on smoothly; make the zone longer"
            )


def _notes_of_size(body: Body, where: Footprint) -> Iterator[str]:
    """Say if the pressure is too large for small displacements."""
    modulus = body.problem.material.young_modulus
    if where.peak is not None and where.peak.pressure > LARGE_PRESSURE * modulus:
        yield (
            f"the peak pressure is {where.peak.pressure / modulus:.2g} times Young's modulus: displacements are not "
            "small, and the linear answer means little"
        )


def _weights(weights: Weights | str) -> Weights:
    """Read the name of weights."""
    try:
        return Weights(weights)
    except ValueError:
        names = ", ".join(item.value for item in Weights)
        raise ProblemError(f"there are no weights '{weights}'; take one of {names}") from None
