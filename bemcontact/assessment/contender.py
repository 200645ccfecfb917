"""One formulation in a comparison: its attempt, the assessment of its solution, and the verdict."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bemcontact.assessment.certificate import Certificate, CertificateKind, certify
from bemcontact.assessment.footprint import Footprint, FootprintRecord, footprint, footprint_record
from bemcontact.assessment.matrices import WeightedCompliance
from bemcontact.assessment.objectives import Objectives, objectives
from bemcontact.assessment.residual import Residuals, residuals
from bemcontact.assessment.verdict import Outcome, Reached, Verdict, refused, verdict
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import RandomStarts
from bemcontact.contact.record import SolutionRecord, solution_record
from bemcontact.contact.solution import ContactSolution
from bemcontact.options import FormulationName, SolveOptions, Weights
from bemcontact.serialization import Record


@dataclass(frozen=True, kw_only=True, eq=False)
class Attempt:
    """One formulation's attempt at a contact problem."""

    options: SolveOptions
    """Formulation, weights and penalty."""
    label: str
    """Its name in tables and figures."""
    solution: ContactSolution | None
    """Its solution; None if it refused the problem."""
    refusal: str = ""
    """Why it refused, or empty."""
    seconds: float = 0.0
    """Time of the solver."""
    starts: RandomStarts | None = None
    """Ends of searches from random starts, if there were any."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Assessment:
    """All that is recomputed of a solution."""

    solution: ContactSolution
    """What is assessed."""
    objectives: tuple[Objectives, ...]
    """Objectives with each of the weights of the comparison, in their order."""
    residuals: Residuals
    """Residuals of the contact conditions and equations."""
    certificate: Certificate
    """What is proved."""
    footprint: Footprint
    """Where the body touches."""
    peak: float
    """Peak pressure over T."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Contender:
    """One formulation in a comparison."""

    attempt: Attempt
    """What it was asked, and its solution."""
    assessment: Assessment | None
    """Assessment of the solution; None if it refused the problem."""
    objective: float | None
    """Objective of its own statement with its own weights, scaled; None for the direct solution."""
    verdict: Verdict
    """What is shown of its solution."""
    convex: bool | None
    """Whether its program is convex on what equations and equilibrium leave free; None for the direct solution."""

    @property
    def label(self) -> str:
        """What it is called."""
        return self.attempt.label

    @property
    def solution(self) -> ContactSolution | None:
        """Its solution; None if it refused the problem."""
        return self.attempt.solution

    @property
    def certified(self) -> bool:
        """Whether its solution is proved to be the contact state, and the only one."""
        return self.verdict.outcome is Outcome.SOLVES


class AnswerRecord(FootprintRecord, SolutionRecord):
    """Solution of a formulation and what is recomputed of it; lists go contact point by contact point."""

    notes: tuple[str, ...]
    """Remarks of the solver."""
    objectives: tuple[Objectives, ...]
    """Objectives with each of the weights that are compared."""
    residuals: Residuals
    """Residuals of the contact conditions and equations."""
    certificate: Certificate
    """What is proved."""


class ContenderRecord(Record):
    """One formulation of a comparison."""

    label: str
    """What it is called."""
    formulation: FormulationName
    """Statement that was solved."""
    weights: Weights | None
    """Weights of its objective; null for the direct solution, which has none."""
    penalty: float | None
    """Penalty μ of QP2, free of units; null for the others."""
    certified: bool
    """Whether its solution is proved to be the contact state, and the only one."""
    verdict: Verdict
    """What is shown of its solution."""
    objective: float | None
    """Objective of its own statement with its own weights, scaled; null where it has none."""
    convex: bool | None
    """Whether its program is convex on what equations and equilibrium leave free; null for the direct solution."""
    seconds: float
    """Time of the solver."""
    starts: RandomStarts | None
    """Searches from random starts, if any were asked for."""
    answer: AnswerRecord | None
    """Its solution; null if it refused the problem."""


def contender_record(contact: CondensedContact, contender: Contender) -> ContenderRecord:
    """Describe a formulation of a comparison."""
    attempt = contender.attempt
    return ContenderRecord(
        label=contender.label,
        formulation=attempt.options.formulation,
        weights=attempt.options.weights if attempt.options.uses("weights") else None,
        penalty=attempt.options.penalty if attempt.options.uses("penalty") else None,
        certified=contender.certified,
        verdict=contender.verdict,
        objective=contender.objective,
        convex=contender.convex,
        seconds=attempt.seconds,
        starts=attempt.starts,
        answer=None if contender.assessment is None else _answer_record(contact, contender.assessment),
    )


def _answer_record(contact: CondensedContact, assessment: Assessment) -> AnswerRecord:
    """Describe a solution and its assessment."""
    return AnswerRecord(
        **dict(solution_record(contact, assessment.solution)),
        **dict(footprint_record(assessment.footprint)),
        notes=assessment.solution.notes,
        objectives=assessment.objectives,
        residuals=assessment.residuals,
        certificate=assessment.certificate,
    )


def assess(
    contact: CondensedContact, solution: ContactSolution, weights: Sequence[Weights], penalties: tuple[float, ...]
) -> Assessment:
    """Recompute all of a solution; `ProblemError` if the problem does not carry one of the weights."""
    recomputed = residuals(contact, solution)
    return Assessment(
        solution=solution,
        objectives=tuple(objectives(contact, solution, item, penalties) for item in weights),
        residuals=recomputed,
        certificate=certify(contact, solution, recomputed),
        footprint=footprint(contact, solution),
        peak=float(solution.pressure.max(initial=0.0)) / contact.scales.pressure,
    )


def contender(
    attempt: Attempt,
    assessment: Assessment | None,
    direct: Assessment | None,
    matrices: Mapping[Weights, WeightedCompliance],
) -> Contender:
    """Reach the verdict on an attempt, whose assessment and that of the direct solution are None if there is none."""
    options, tributary = attempt.options, matrices[Weights.TRIBUTARY]
    own = matrices[options.weights] if options.uses("weights") else None
    if assessment is None:
        refusal = refused(attempt.refusal, own or tributary, tributary)
        return Contender(
            attempt=attempt, assessment=None, objective=None, verdict=refusal, convex=own.convex if own else None
        )
    objective, reached = _own_objective(options, assessment), None
    if objective is not None:
        known = direct is not None and direct.certificate.kind is not CertificateKind.NOT_A_SOLUTION
        at_contact_state = _own_objective(options, direct) if known and direct is not None else None
        reached = Reached(here=objective, at_contact_state=at_contact_state, peak=assessment.peak)
    search = assessment.solution.search
    return Contender(
        attempt=attempt,
        assessment=assessment,
        objective=objective,
        verdict=verdict(assessment.solution, assessment.certificate, reached, own, tributary),
        convex=search.penalty.convex if search and search.penalty else own.convex if own else None,
    )


def _own_objective(options: SolveOptions, assessment: Assessment) -> float | None:
    """Objective of a statement, with its own weights and penalty, at a solution of any."""
    own = next((item for item in assessment.objectives if item.weights is options.weights), None)
    if own is None or not options.uses("weights"):
        return None
    of_penalty = {item.penalty: item.value for item in own.qp2}
    values = {FormulationName.QP1: own.qp1, FormulationName.QP3: own.qp3}
    return of_penalty[options.penalty] if options.uses("penalty") else values.get(options.formulation)
