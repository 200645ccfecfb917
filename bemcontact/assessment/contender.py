"""One formulation in a comparison: its attempt, the assessment of its solution, and the verdict on it."""

from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum

from bemcontact.assessment.certificate import Certificate, CertificateKind, certify
from bemcontact.assessment.footprint import Footprint, FootprintRecord, footprint, footprint_record
from bemcontact.assessment.matrices import WeightedCompliance
from bemcontact.assessment.residual import Objectives, Residuals, objectives, residuals
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.multistart import RandomStarts
from bemcontact.contact.record import SolutionRecord, solution_record
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.frozen import frozen, frozen_value
from bemcontact.options import FormulationName, SolveOptions, Weights
from bemcontact.serialization import Leaf, Record

ZERO = 1e-11
"""Scaled objective that is round-off: a residual of 1e-10, times a displacement or pressure of size one."""


class Outcome(StrEnum):
    """Whether a solution is the contact state, and what of this is proved."""

    SOLVES = "solves it"
    SOLVES_PERHAPS_NOT_ALONE = "solves it, perhaps not alone"
    LEFT_OPEN = "left open by round-off"
    NOT_THE_SOLUTION = "not the solution"
    REFUSED = "refused"

    @property
    def quality(self) -> str:
        """How good it is: good, fair or bad."""
        return "good" if self is Outcome.SOLVES else "fair" if self.meets_conditions else "bad"

    @property
    def solves(self) -> bool:
        """Whether the answer is a contact state."""
        return self in (Outcome.SOLVES, Outcome.SOLVES_PERHAPS_NOT_ALONE)

    @property
    def meets_conditions(self) -> bool:
        """Whether the answer meets all conditions to their tolerance."""
        return self.solves or self is Outcome.LEFT_OPEN


PREDICATES = {
    Outcome.SOLVES: ("finds the contact state", "find the contact state"),
    Outcome.SOLVES_PERHAPS_NOT_ALONE: ("finds a contact state", "find a contact state"),
    Outcome.LEFT_OPEN: ("is left open by round-off", "are left open by round-off"),
    Outcome.NOT_THE_SOLUTION: ("does not find the contact state", "do not find the contact state"),
    Outcome.REFUSED: ("is refused", "are refused"),
}
"""What is said of one formulation, and of several."""
OF_DIRECT = {
    Outcome.SOLVES: "the direct solution is proved to be the only one",
    Outcome.SOLVES_PERHAPS_NOT_ALONE: "the direct solution meets all conditions, but they may have other solutions",
    Outcome.LEFT_OPEN: "round-off leaves open whether the direct solution is near the contact state",
    Outcome.NOT_THE_SOLUTION: "the direct solver found no contact state",
    Outcome.REFUSED: "the direct solver was refused",
}
"""What is said of the direct solution."""


@frozen_value
class Conclusion(Leaf):
    """Whether a solution is the contact state, and why."""

    outcome: Outcome
    """Outcome in a few words."""
    words: str
    """Sentence that says why."""
    reason: str = ""
    """Reason of a failure that lies in the weights, or empty."""


def objective_in_words(here: float, at_contact_state: float | None, peak: float) -> str:
    """Say that the objective of a statement is 0, or how far it is from that of the contact state, if this is known.

    Objectives and the peak pressure are free of units.
    """
    round_off = ZERO * max(1.0, peak) ** 2
    if at_contact_state is None:
        return f"objective {here:.2e}"
    zero = abs(at_contact_state) <= round_off
    if abs(here - at_contact_state) <= round_off:
        return f"objective 0 reached ({here:.0e})" if zero else f"objective {here:.1e}, as that state has it"
    side = "above" if here > at_contact_state else "below"
    there = "0" if zero else f"{at_contact_state:.2e}"
    apart = "" if zero else f"{abs(here - at_contact_state):.0e} "
    return f"objective {here:.2e}, {apart}{side} the {there} of the contact state"


def conclusion(
    solution: ContactSolution,
    certificate: Certificate,
    reached: str,
    matrices: WeightedCompliance | None,
    tributary: WeightedCompliance,
) -> Conclusion:
    """Assess what is shown of an answer.

    `reached` is the objective of its own statement in words, empty if it has none; `matrices` are those of its own
    weights, None if it has none; `tributary` those of the tributary weights.
    """
    objective = f"{reached}, " if reached else ""
    match certificate.kind:
        case CertificateKind.UNIQUE:
            return Conclusion(
                outcome=Outcome.SOLVES,
                words=f"solves the contact problem: {objective}all conditions hold, and {certificate.why_unique}",
            )
        case CertificateKind.LOCAL:
            return Conclusion(
                outcome=Outcome.SOLVES_PERHAPS_NOT_ALONE,
                words=f"solves the contact problem: {objective}all conditions hold; but local only: "
                f"the compliance is not positive definite (smallest eigenvalue "
                f"{certificate.smallest_eigenvalue:.1e}), so that another state may exist",
            )
        case CertificateKind.OPEN:
            return Conclusion(
                outcome=Outcome.LEFT_OPEN,
                words=f"meets all conditions to their tolerance: {objective}but round-off leaves open whether other "
                "pressures, far from this one, meet them too",
            )
        case CertificateKind.NOT_A_SOLUTION:
            return Conclusion(
                outcome=Outcome.NOT_THE_SOLUTION,
                words=_why_not(solution, certificate, reached),
                reason="" if matrices is None else _of_weights(matrices, tributary),
            )


def _why_not(solution: ContactSolution, certificate: Certificate, reached: str) -> str:
    """The reason why an answer is not the contact state."""
    ended = {
        Status.SOLVED: "its solver's end is not the contact state",
        Status.LOCAL_MINIMUM: "stationary but not the solution",
    }.get(solution.status, solution.status.words)
    objective = f": {reached}" if reached else ""
    return f"{ended}{objective}; {certificate.violation}."


def _of_weights(matrices: WeightedCompliance, tributary: WeightedCompliance) -> str:
    """The effect of weights other than the tributary ones, where those do not have it."""
    if matrices.weights is Weights.TRIBUTARY:
        return ""
    name, parts = matrices.weights.value.replace("_", "-"), []
    if matrices.negative_weights:
        parts.append(
            f"the {name} weights have {matrices.negative_weights} negative entries, so that the objective can "
            "be negative, and its least value need not be that of the contact state"
        )
    if matrices.saddle:
        parts.append(
            f"the work of the {name} weights in the body's free rigid motions does not follow from equilibrium, so "
            "that the objective is a saddle in pressures and motions"
        )
    if tributary.convex and matrices.smallest_eigenvalue is not None and not matrices.definite:
        parts.append(
            f"J M with the {name} weights is indefinite on the equilibrium space (eigenvalues from "
            f"{matrices.smallest_eigenvalue:.1e} to {matrices.largest_eigenvalue:.1e}), although the body is elastic: "
            "these weights do not measure work"
        )
    return "; ".join(parts)


@frozen
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


@frozen
class Assessment:
    """Everything that is recomputed of a solution."""

    solution: ContactSolution
    """What is assessed."""
    motions: KnownMotions
    """What is known of its free motions."""
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


@frozen
class Contender:
    """One formulation in a comparison."""

    attempt: Attempt
    """What it was asked, and its solution."""
    assessment: Assessment | None
    """Assessment of the solution; None if it refused the problem."""
    objective: float | None
    """Objective of its own statement with its own weights, scaled; None for the direct solution."""
    verdict: Conclusion
    """Whether its solution is the contact state, and why."""
    convex: bool | None
    """Whether its program is convex on what equations and equilibrium leave free; None for the direct solution."""

    @property
    def label(self) -> str:
        """Name in tables and pictures."""
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
    """Name in tables and pictures."""
    formulation: FormulationName
    """Statement that was solved."""
    weights: Weights | None
    """Weights of its objective; null for the direct solution, which has none."""
    penalty: float | None
    """Penalty μ of QP2, free of units; null for the others."""
    certified: bool
    """Whether its solution is proved to be the contact state, and the only one."""
    verdict: Conclusion
    """Whether its solution is the contact state, and why."""
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
        **dict(solution_record(contact, assessment.solution, assessment.motions)),
        **dict(footprint_record(assessment.footprint)),
        notes=assessment.solution.notes,
        objectives=assessment.objectives,
        residuals=assessment.residuals,
        certificate=assessment.certificate,
    )


def assess(
    contact: CondensedContact,
    solution: ContactSolution,
    weights: Sequence[Weights],
    penalties: tuple[float, ...],
    *,
    infinite: Sequence[str] = (),
    motions: Callable[[ContactSolution, Certificate], KnownMotions],
) -> Assessment:
    """Recompute everything of a solution; there is no peak if that of a zone is known to be infinite.

    `motions` gives what is known of the free motions of a solution.

    `ProblemError` if the problem does not carry one of the weights.
    """
    recomputed = residuals(contact, solution)
    certificate = certify(contact, solution, recomputed)
    return Assessment(
        solution=solution,
        motions=motions(solution, certificate),
        objectives=tuple(objectives(contact, solution, item, penalties) for item in weights),
        residuals=recomputed,
        certificate=certificate,
        footprint=footprint(contact, solution, infinite=infinite),
        peak=float(solution.pressure.max(initial=0.0)) / contact.scales.pressure,
    )


def contender(
    attempt: Attempt,
    assessment: Assessment | None,
    direct: Assessment | None,
    matrices: Mapping[Weights, WeightedCompliance],
) -> Contender:
    """Reach the verdict on an attempt; its assessment and that of the direct solution are None if there is none."""
    options, tributary = attempt.options, matrices[Weights.TRIBUTARY]
    own = matrices[options.weights] if options.uses("weights") else None
    if assessment is None:
        reason = _of_weights(own or tributary, tributary)
        refusal = Conclusion(outcome=Outcome.REFUSED, words=f"{attempt.refusal}.", reason=reason)
        return Contender(
            attempt=attempt, assessment=None, objective=None, verdict=refusal, convex=own.convex if own else None
        )
    objective, reached = _own_objective(options, assessment), ""
    if objective is not None:
        known = direct is not None and direct.certificate.kind is not CertificateKind.NOT_A_SOLUTION
        at_contact_state = _own_objective(options, direct) if known and direct is not None else None
        reached = objective_in_words(objective, at_contact_state, assessment.peak)
    search = assessment.solution.search
    return Contender(
        attempt=attempt,
        assessment=assessment,
        objective=objective,
        verdict=conclusion(assessment.solution, assessment.certificate, reached, own, tributary),
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
