"""What is shown of a formulation's answer, in a word and a sentence."""

from dataclasses import dataclass
from enum import StrEnum

from bemcontact.assessment.certificate import Certificate, CertificateKind
from bemcontact.assessment.matrices import WeightedCompliance
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.options import Weights
from bemcontact.serialization import Leaf

ZERO = 1e-11
"""Scaled objective that is round-off: a residual of 1e-10, times a displacement or pressure of size one."""


class Outcome(StrEnum):
    """What is shown of an answer; `OUTCOMES` says more of each."""

    SOLVES = "solves it"
    SOLVES_PERHAPS_NOT_ALONE = "solves it, perhaps not alone"
    LEFT_OPEN = "left open by round-off"
    NOT_THE_SOLUTION = "not the solution"
    REFUSED = "refused"


@dataclass(frozen=True, kw_only=True)
class OutcomeFacts:
    """What an outcome means, and how it is said."""

    quality: str
    """How good it is: good, fair or bad."""
    solves: bool
    """Whether the answer is a contact state."""
    meets_conditions: bool
    """Whether the answer meets all conditions to their tolerance."""
    predicate: tuple[str, str]
    """What is said of one formulation, and of several."""
    of_direct: str
    """What is said of the direct solution."""


OUTCOMES = {
    Outcome.SOLVES: OutcomeFacts(
        quality="good",
        solves=True,
        meets_conditions=True,
        predicate=("finds the contact state", "find the contact state"),
        of_direct="the direct solution is certified, and there is no other",
    ),
    Outcome.SOLVES_PERHAPS_NOT_ALONE: OutcomeFacts(
        quality="fair",
        solves=True,
        meets_conditions=True,
        predicate=("finds a contact state", "find a contact state"),
        of_direct="the direct solution meets all conditions, but they may have other solutions",
    ),
    Outcome.LEFT_OPEN: OutcomeFacts(
        quality="fair",
        solves=False,
        meets_conditions=True,
        predicate=("is left open by round-off", "are left open by round-off"),
        of_direct="round-off leaves open whether the direct solution is near the contact state",
    ),
    Outcome.NOT_THE_SOLUTION: OutcomeFacts(
        quality="bad",
        solves=False,
        meets_conditions=False,
        predicate=("does not find the contact state", "do not find the contact state"),
        of_direct="the direct solver found no contact state",
    ),
    Outcome.REFUSED: OutcomeFacts(
        quality="bad",
        solves=False,
        meets_conditions=False,
        predicate=("is refused", "are refused"),
        of_direct="the direct solver was refused",
    ),
}


@dataclass(frozen=True, kw_only=True)
class Verdict(Leaf):
    """What is shown of an answer, and why."""

    outcome: Outcome
    """Outcome in a few words."""
    words: str
    """Sentence that says why."""
    reason: str = ""
    """Reason of a failure that lies in the weights, or empty."""


@dataclass(frozen=True, kw_only=True)
class Reached:
    """Objective of a statement at an answer, and at the contact state if that is known; all free of units."""

    here: float
    at_contact_state: float | None
    peak: float

    def __str__(self) -> str:
        """Say that the objective is 0, or how far it is from that of the contact state."""
        round_off = ZERO * max(1.0, self.peak) ** 2
        if self.at_contact_state is None:
            return f"objective {self.here:.2e}"
        zero = abs(self.at_contact_state) <= round_off
        if abs(self.here - self.at_contact_state) <= round_off:
            return (
                f"objective 0 reached ({self.here:.0e})" if zero else f"objective {self.here:.1e}, as that state has it"
            )
        side = "above" if self.here > self.at_contact_state else "below"
        there = "0" if zero else f"{self.at_contact_state:.2e}"
        apart = "" if zero else f"{abs(self.here - self.at_contact_state):.0e} "
        return f"objective {self.here:.2e}, {apart}{side} the {there} of the contact state"


def verdict(
    solution: ContactSolution,
    certificate: Certificate,
    reached: Reached | None,
    matrices: WeightedCompliance | None,
    tributary: WeightedCompliance,
) -> Verdict:
    """Say what is shown of an answer.

    Parameters
    ----------
    solution : of any formulation
    certificate : of that solution
    reached : objective of its own statement, or None if it has none
    matrices : of its own weights, or None if it has none
    tributary : matrices of the tributary weights
    """
    objective = "" if reached is None else f"{reached}, "
    match certificate.kind:
        case CertificateKind.UNIQUE:
            return Verdict(
                outcome=Outcome.SOLVES,
                words=f"solves the contact problem: {objective}all conditions hold, and no other state exists, because "
                f"{_why_unique(certificate)}",
            )
        case CertificateKind.LOCAL:
            return Verdict(
                outcome=Outcome.SOLVES_PERHAPS_NOT_ALONE,
                words=f"solves the contact problem: {objective}all conditions hold; but local only: "
                f"the compliance is not positive definite (smallest eigenvalue "
                f"{certificate.smallest_eigenvalue:.1e}), so that another state may exist",
            )
        case CertificateKind.OPEN:
            return Verdict(
                outcome=Outcome.LEFT_OPEN,
                words=f"meets all conditions to their tolerance: {objective}but in floating-point numbers its pressure "
                "cannot be objective from others that are far from it",
            )
        case CertificateKind.NOT_A_SOLUTION:
            return Verdict(
                outcome=Outcome.NOT_THE_SOLUTION,
                words=_why_not(solution, certificate, reached),
                reason="" if matrices is None else _of_weights(matrices, tributary),
            )


def refused(reason: str, matrices: WeightedCompliance, tributary: WeightedCompliance) -> Verdict:
    """Say that a formulation could not be asked, with what its weights do to the matrices."""
    return Verdict(outcome=Outcome.REFUSED, words=f"{reason}.", reason=_of_weights(matrices, tributary))


def _why_unique(certificate: Certificate) -> str:
    """The reason for uniqueness."""
    if certificate.smallest_eigenvalue is None:
        return "equilibrium alone fixes the pressure"
    return f"the compliance is positive definite (smallest eigenvalue {certificate.smallest_eigenvalue:.1e})"


def _why_not(solution: ContactSolution, certificate: Certificate, reached: Reached | None) -> str:
    """Why an answer is none."""
    ended = {
        Status.SOLVED: "its solver's end is not the contact state",
        Status.LOCAL_MINIMUM: "stationary but not the solution",
    }.get(solution.status, solution.status.words)
    objective = "" if reached is None else f": {reached}"
    return f"{ended}{objective}; {certificate.complaint}."


def _of_weights(matrices: WeightedCompliance, tributary: WeightedCompliance) -> str:
    """What weights other than tributary ones do that those do not."""
    if matrices.weights is Weights.TRIBUTARY:
        return ""
    name, parts = matrices.weights.value.replace("_", "-"), []
    if matrices.negative_weights:
        parts.append(
            f"the {name} weights have {matrices.negative_weights} negative entries, which reward pressure at one "
            "node for a gap at its neighbour, so that the least objective need not be that of the contact state"
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
