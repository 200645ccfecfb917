"""What a formulation's answer is worth, in a word and a sentence, and what a whole comparison says."""

from dataclasses import dataclass
from enum import Enum

from bemcontact.assessment.certificate import Certificate, CertificateKind
from bemcontact.assessment.matrices import WeightedCompliance
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.options import Weights

ZERO = 1e-11
"""Scaled objective that is round-off: a residual of 1e-10, times a displacement or pressure of size one."""


class Outcome(Enum):
    """What has been shown of an answer."""

    SOLVES = "solves it"
    SOLVES_PERHAPS_NOT_ALONE = "solves it, perhaps not alone"
    LEFT_OPEN = "left open by round-off"
    NOT_THE_SOLUTION = "not the solution"
    REFUSED = "refused"


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """An outcome, a sentence that says why, and the deeper reason where the weights are to blame, else empty."""

    outcome: Outcome
    words: str
    reason: str = ""

    def to_dict(self) -> dict[str, str]:
        """Give all as texts, ready for JSON."""
        return {"outcome": self.outcome.value, "words": self.words, "reason": self.reason}


@dataclass(frozen=True, kw_only=True)
class Reached:
    """The objective of a statement at an answer, and at the contact state if that is known; all free of units."""

    here: float
    at_contact_state: float | None
    peak: float

    def __str__(self) -> str:
        """Both in words: objective 0 reached, or what it is instead of what."""
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
    """Say what an answer is worth.

    Parameters
    ----------
    solution : of any formulation
    certificate : of that solution
    reached : the objective of its own statement; None where it has none
    matrices, tributary : of its own weights, None likewise, and of the tributary ones

    Returns
    -------
    Verdict
    """
    told = "" if reached is None else f"{reached}, "
    match certificate.kind:
        case CertificateKind.UNIQUE:
            return Verdict(
                outcome=Outcome.SOLVES,
                words=f"solves the contact problem: {told}all conditions hold, and no other state exists, because "
                f"{_why_unique(certificate)}",
            )
        case CertificateKind.LOCAL:
            return Verdict(
                outcome=Outcome.SOLVES_PERHAPS_NOT_ALONE,
                words=f"solves the contact problem: {told}all conditions hold; but local only: "
                f"the compliance is not positive definite (smallest eigenvalue "
                f"{certificate.smallest_eigenvalue:.1e}), so that another state may exist",
            )
        case CertificateKind.OPEN:
            return Verdict(
                outcome=Outcome.LEFT_OPEN,
                words=f"meets all conditions to their tolerance: {told}but in floating-point numbers its pressure "
                "cannot be told from others that are far from it",
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
    }.get(solution.status, solution.status.value)
    told = "" if reached is None else f": {reached}"
    return f"{ended}{told}; {certificate.complaint}."


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
