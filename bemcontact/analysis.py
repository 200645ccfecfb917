"""From a problem to a judged result: condense, solve, assess, recover. The only file that sees both halves."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from enum import Enum
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

import bemcontact
from bemcontact import remarks
from bemcontact.assessment.certificate import Certificate, certify
from bemcontact.assessment.footprint import Footprint, footprint
from bemcontact.assessment.residual import Residuals, residuals
from bemcontact.bem.condense import body_of
from bemcontact.bem.condense import condense as condense_body
from bemcontact.bem.recovery import BoundaryState, boundary_state
from bemcontact.contact import CondensedContact, ContactSolution, Weights
from bemcontact.errors import ProblemError
from bemcontact.formulations import FORMULATIONS, OPTIONS, Equilibrium, FormulationOptions, Rows, Start
from bemcontact.formulations.starts import RandomStarts, StartChoice, search_from
from bemcontact.problem.problem import Problem

Name = TypeVar("Name", bound=Enum)


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
    starts : where the searches from random starts ended, if several were asked for
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
    starts: RandomStarts | None = None

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
            "search": None if solution.search is None else asdict(solution.search),
            "starts": None if self.starts is None else self.starts.to_dict(),
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
    *,
    penalty: float = 1.0,
    rows: Rows | str = Rows.STIFFNESS,
    equilibrium: Equilibrium | str = Equilibrium.CONSTRAINT,
    start: Start | str = "null",
    seed: int | None = None,
    starts: int | None = None,
) -> Result:
    """Solve a contact problem by one formulation, and judge the answer.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulation : "qp3" (a convex program, then polished), "complementarity" (the direct solver), or "qp1" and "qp2" (a
        local solver over pressures and displacements, then polished)
    weights : the J of the objective, a `Weights` or its name: "tributary", "consistent" or "element_length"
    penalty : μ of QP2, free of units
    rows : how QP1 and QP2 write the equations, a `Rows` or its name: "stiffness" or "compliance"
    equilibrium : of QP2, for bodies with free rigid motions: "constraint", or "penalty" as in [SS92]
    start : of QP1 and QP2: "null", "random", or a `Start` with a pressure (n,) [p] and a displacement (n,) [L]
    seed : of random starts, 0 if not given
    starts : how many random starts; the answer is that of the best end, `Result.starts` has all of them

    Returns
    -------
    Result
        Check `certified`: a solver that fails is a `Status`, not an error.

    Raises
    ------
    ProblemError
        If the problem has no answer, a name is unknown, or the formulation has no use for an option.
    NotConvexError
        If the formulation needs a convex program and this is none.
    """
    _check_kind(problem)
    options = _options(formulation, weights, penalty, rows, equilibrium)
    choice = StartChoice(start=start, seed=seed, count=starts)
    choice.ensure_used(formulation, "start" in OPTIONS[formulation])
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
        solution, ends = choice.search(contact, FORMULATIONS[formulation], options)
    boundary = None
    if condensation is not None:
        with watch.stage("recovery"):
            boundary = boundary_state(condensation, solution.pressure, solution.rigid_amplitudes)
    with watch.stage("assessment"):
        judged = residuals(contact, solution, None if boundary is None else boundary.force_balance)
        certificate = certify(contact, solution, judged)
        where = footprint(contact, solution)
        touching = contact.touching(solution.pressure, solution.displacement)
        notes = (*contact.notes, *solution.notes, *remarks.of_few_points(touching))
        if condensation is not None:
            notes += (*remarks.of_zone_ends(condensation.body, touching), *remarks.of_size(condensation.body, where))
    gap = contact.initial_gap + solution.displacement
    return Result(
        problem=problem if isinstance(problem, Problem) else None,
        contact=contact,
        solution=solution,
        weights=options.weights,
        objective=float(solution.pressure @ contact.weight_matrix(options.weights) @ gap),
        residuals=judged,
        certificate=certificate,
        footprint=where,
        boundary=boundary,
        degrees_of_freedom=None if condensation is None else condensation.body.mesh.degrees_of_freedom,
        notes=notes,
        seconds=watch.seconds,
        starts=ends,
    )


def random_starts(
    problem: Problem | CondensedContact,
    formulation: str = "qp1",
    weights: Weights | str = Weights.TRIBUTARY,
    *,
    count: int = 100,
    seed: int = 0,
    penalty: float = 1.0,
    rows: Rows | str = Rows.STIFFNESS,
    equilibrium: Equilibrium | str = Equilibrium.CONSTRAINT,
) -> RandomStarts:
    """Solve QP1 or QP2 from random starts and tell which minima were found, and how often; nothing is polished.

    Parameters
    ----------
    problem : Problem or CondensedContact
    formulation : "qp1" or "qp2"
    weights, penalty, rows, equilibrium : as of `solve`
    count, seed : of the starts; the same seed gives the same starts

    Returns
    -------
    RandomStarts

    Raises
    ------
    ProblemError
        As of `solve`.
    """
    _check_kind(problem)
    options = _options(formulation, weights, penalty, rows, equilibrium)
    StartChoice(start="random", seed=seed, count=count).ensure_used(formulation, "start" in OPTIONS[formulation])
    contact = problem if isinstance(problem, CondensedContact) else condense(problem)
    return search_from(contact, FORMULATIONS[formulation], options, count, seed)


def _options(
    formulation: str, weights: Weights | str, penalty: float, rows: Rows | str, equilibrium: Equilibrium | str
) -> FormulationOptions:
    """Read the options, and refuse those that the formulation has no use for."""
    if formulation not in FORMULATIONS:
        raise ProblemError(f"there is no formulation '{formulation}'; take one of {', '.join(FORMULATIONS)}")
    options = FormulationOptions(
        weights=_named(Weights, weights, "weights"),
        penalty=penalty,
        rows=_named(Rows, rows, "rows"),
        equilibrium=_named(Equilibrium, equilibrium, "ways of equilibrium"),
    )
    options.ensure_used(formulation, *OPTIONS[formulation])
    return options


def _named(kind: type[Name], name: Name | str, what: str) -> Name:
    """Read a name of a kind."""
    try:
        return kind(name)
    except ValueError:
        raise ProblemError(f"no {what} '{name}'; take one of {', '.join(item.value for item in kind)}") from None
