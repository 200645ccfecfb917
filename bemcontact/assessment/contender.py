"""One formulation in a comparison: what it found, all that is recomputed of it, and what it is worth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bemcontact.assessment.certificate import Certificate, CertificateKind, certify
from bemcontact.assessment.footprint import Footprint, footprint
from bemcontact.assessment.matrices import WeightedCompliance
from bemcontact.assessment.objectives import Objectives, objectives
from bemcontact.assessment.residual import Residuals, residuals
from bemcontact.assessment.verdict import Outcome, Reached, Verdict, refused, verdict
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.multistart import RandomStarts
from bemcontact.contact.record import solution_record
from bemcontact.contact.solution import ContactSolution
from bemcontact.options import FormulationName, SolveOptions, Weights


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """What came of options before it is judged.

    Parameters
    ----------
    options : how it was solved
    label : what it is called
    solution : or None if the formulation could not be asked
    refusal : why not, else empty
    seconds : the solver took
    starts : where searches from random starts ended, if there were any
    """

    options: SolveOptions
    label: str
    solution: ContactSolution | None
    refusal: str = ""
    seconds: float = 0.0
    starts: RandomStarts | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Judged:
    """A solution with all that was recomputed of it.

    Parameters
    ----------
    solution : ContactSolution
    objectives : under every weights of the comparison, in their order
    residuals, certificate, footprint : the judgement
    peak : the peak pressure over T
    """

    solution: ContactSolution
    objectives: tuple[Objectives, ...]
    residuals: Residuals
    certificate: Certificate
    footprint: Footprint
    peak: float

    def to_dict(self, contact: CondensedContact) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        return {
            **solution_record(contact, self.solution),
            "notes": list(self.solution.notes),
            "objectives": [item.to_dict() for item in self.objectives],
            "residuals": self.residuals.to_dict(),
            "certificate": self.certificate.to_dict(),
            **self.footprint.to_dict(),
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Contender:
    """One formulation's answer and what it is worth.

    Parameters
    ----------
    found : what came of it
    judged : None if it could not be asked
    objective : of its own statement with its own weights, scaled; None for the direct solution
    verdict : Verdict
    convex : whether its program is convex on what equations and equilibrium leave free; None for the direct solution
    """

    found: Found
    judged: Judged | None
    objective: float | None
    verdict: Verdict
    convex: bool | None

    @property
    def label(self) -> str:
        """What it is called."""
        return self.found.label

    @property
    def certified(self) -> bool:
        """Whether this is proved to be the solution, and the only one."""
        return self.verdict.outcome is Outcome.SOLVES

    def to_dict(self, contact: CondensedContact) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        options, starts = self.found.options, self.found.starts
        return {
            "label": self.label,
            "formulation": options.formulation.value,
            "weights": options.weights.value if options.uses("weights") else None,
            "penalty": options.penalty if options.uses("penalty") else None,
            "certified": self.certified,
            "verdict": self.verdict.to_dict(),
            "objective": self.objective,
            "convex": self.convex,
            "seconds": self.found.seconds,
            "starts": None if starts is None else starts.to_dict(),
            "answer": None if self.judged is None else self.judged.to_dict(contact),
        }


def recomputed(
    contact: CondensedContact, solution: ContactSolution, weights: Sequence[Weights], penalties: tuple[float, ...]
) -> Judged:
    """Recompute all that can be known of a solution.

    Parameters
    ----------
    contact : CondensedContact
    solution : of any formulation
    weights, penalties : of the objectives

    Returns
    -------
    Judged

    Raises
    ------
    ProblemError
        The problem does not carry these weights.
    """
    left = residuals(contact, solution)
    return Judged(
        solution=solution,
        objectives=tuple(objectives(contact, solution, item, penalties) for item in weights),
        residuals=left,
        certificate=certify(contact, solution, left),
        footprint=footprint(contact, solution),
        peak=float(solution.pressure.max(initial=0.0)) / contact.scales.pressure,
    )


def contender(
    found: Found, judged: Judged | None, direct: Judged | None, matrices: Mapping[Weights, WeightedCompliance]
) -> Contender:
    """Say what an answer is worth.

    Parameters
    ----------
    found : the answer
    judged, direct : this answer and the direct solution; None if there is none
    matrices : of the weights of the comparison

    Returns
    -------
    Contender
    """
    options, tributary = found.options, Weights.TRIBUTARY
    own = matrices[options.weights] if options.uses("weights") else None
    if judged is None:
        told = refused(found.refusal, matrices[options.weights], matrices[tributary])
        return Contender(found=found, judged=None, objective=None, verdict=told, convex=own.convex if own else None)
    objective, reached = _own_objective(options, judged), None
    if objective is not None:
        known = direct is not None and direct.certificate.kind is not CertificateKind.NOT_A_SOLUTION
        at_contact_state = _own_objective(options, direct) if known and direct is not None else None
        reached = Reached(here=objective, at_contact_state=at_contact_state, peak=judged.peak)
    told = verdict(judged.solution, judged.certificate, reached, own, matrices[tributary])
    search = judged.solution.search
    convex = search.penalty.convex if search and search.penalty else own.convex if own else None
    return Contender(found=found, judged=judged, objective=objective, verdict=told, convex=convex)


def _own_objective(options: SolveOptions, judged: Judged) -> float | None:
    """The objective of a statement, with its own weights and penalty, at a solution of any."""
    own = next((item for item in judged.objectives if item.weights is options.weights), None)
    if own is None or not options.uses("weights"):
        return None
    of_penalty = dict(own.qp2)
    values = {FormulationName.QP1: own.qp1, FormulationName.QP3: own.qp3}
    return of_penalty[options.penalty] if options.uses("penalty") else values.get(options.formulation)
