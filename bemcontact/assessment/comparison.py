"""Formulations side by side: their solutions, objectives and differences, and which is the contact state.

The direct solution of the complementarity problem is the reference; it has no objective, and so no weights.
"""

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np

from bemcontact.assessment.certificate import NOT_SOLVED, Certificate
from bemcontact.assessment.contender import (
    OF_DIRECT,
    Attempt,
    Contender,
    ContenderRecord,
    Outcome,
    assess,
    contender,
    contender_record,
)
from bemcontact.assessment.matrices import WeightedCompliance, condition, weighted_compliance
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.known_motions import KnownMotions
from bemcontact.contact.record import ContactRecord, contact_record
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen, frozen_value
from bemcontact.options import Weights
from bemcontact.serialization import Leaf, Record, Recorded
from bemcontact.version import __version__
from bemcontact.views import Tabular

SAME = 1e-6
"""Difference of two pressures over the peak from which they are two states and not one."""
ROUND_OFF = 1e-12
"""Difference of pressures over the peak that the verdict calls round-off: it varies with the threads of a machine."""
MANY = 4
"""Number of contenders above which those that agree are counted and not named."""


@frozen_value
class Difference(Leaf):
    """Difference of the pressures of two contenders."""

    one: str
    """Label of the first."""
    other: str
    """Label of the second."""
    largest: float
    """Largest |p - p'| over the peak pressure of the direct solution, or over T where nothing touches."""
    mean_square: float
    """Weighted root mean square of p - p' over that of the direct solution."""
    unpolished: float
    """As `largest`, of the first's pressure before the active-set step that follows its solver."""


class MatricesRecord(Record):
    """Numbers of the condensed matrices."""

    condition: float
    """Condition in the 2-norm of the scaled matrix that is inverted for the stiffness rows."""
    weighted: tuple[WeightedCompliance, ...]
    """Numbers of J M for each of the weights that are compared, the tributary ones first."""


class ComparisonRecord(Record):
    """Formulations side by side on one mesh."""

    name: str
    """Name of the problem."""
    version: str
    """Version of bemcontact."""
    certified: bool
    """Whether the direct solution and all contenders are proved to be the contact state, the only one."""
    heading: str
    """What is proved of the solution of the equations on this mesh, in a few words."""
    verdict: str
    """What the comparison shows, in sentences."""
    agreement: float | None
    """Largest difference from the direct solution of contenders that meet all conditions, over the peak."""
    contact: ContactRecord
    """The contact points."""
    contenders: list[ContenderRecord]
    """Formulations in the order asked."""
    reference: ContenderRecord
    """Direct solution of the complementarity problem."""
    differences: tuple[Difference, ...]
    """Differences of all pairs, those with the direct solution first."""
    matrices: MatricesRecord
    """Numbers that decide which formulations are convex."""


@frozen
class Comparison(Recorded, Tabular):
    """Formulations of one condensed problem side by side."""

    contact: CondensedContact
    """The condensed problem."""
    reference: Contender
    """The direct solution."""
    contenders: tuple[Contender, ...]
    """The formulations, in the order asked."""
    differences: tuple[Difference, ...]
    """Differences of all pairs that have a pressure, those with the reference first."""
    matrices: tuple[WeightedCompliance, ...]
    """Numbers of J M for each of the weights, the tributary ones first."""
    condition: float
    """Condition of the matrix that is inverted for the stiffness rows."""
    verdict: str
    """What the comparison shows, in sentences."""

    def __repr__(self) -> str:
        """One line: name, contenders, verdict."""
        labels = ", ".join(contender.label for contender in self.contenders)
        return f"<Comparison of {self.contact.name!r}: {labels}; {self.verdict}>"

    @property
    def everyone(self) -> tuple[Contender, ...]:
        """The contenders, the reference last."""
        return (*self.contenders, self.reference)

    @property
    def certified(self) -> bool:
        """Whether the reference and every contender are proved to be the solution."""
        return all(contender.certified for contender in self.everyone)

    @property
    def agreement(self) -> float | None:
        """Largest difference from the reference of contenders that meet all conditions; None if there is none."""
        meeting = [item.label for item in self.contenders if item.verdict.outcome.meets_conditions]
        return max((item.largest for name in meeting if (item := self.difference(name))), default=None)

    @property
    def heading(self) -> str:
        """What is proved of the solution of the equations on this mesh, in a few words."""
        direct, failing = self.reference, sum(not item.certified for item in self.contenders)
        heading = NOT_SOLVED if direct.assessment is None else direct.assessment.certificate.heading
        if not (direct.certified and failing):
            return heading
        return f"{heading}, but {failing} of {len(self.contenders)} formulations did not find it"

    def difference(self, label: str) -> Difference | None:
        """How far a contender is from the reference; None if it has no pressure, or is the reference."""
        pair = (label, self.reference.label)
        return next((item for item in self.differences if (item.one, item.other) == pair), None)

    def record(self) -> ComparisonRecord:
        """Return the JSON form of the comparison."""
        return ComparisonRecord(
            name=self.contact.name,
            version=__version__,
            certified=self.certified,
            heading=self.heading,
            verdict=self.verdict,
            agreement=self.agreement,
            contact=contact_record(self.contact),
            contenders=[contender_record(self.contact, item) for item in self.contenders],
            reference=contender_record(self.contact, self.reference),
            differences=self.differences,
            matrices=MatricesRecord(condition=self.condition, weighted=self.matrices),
        )


def comparison(
    contact: CondensedContact,
    reference: Attempt,
    attempts: Sequence[Attempt],
    *,
    infinite: Sequence[str] = (),
    motions: Callable[[ContactSolution, Certificate], KnownMotions] | None = None,
) -> Comparison:
    """Assess the solutions of formulations, without trust in a solver, and put them side by side.

    The reference is the attempt of the direct solver. No peak is stated if it is known to be infinite. `motions` gives
    what is known of the free motions of a solution, if that is more than the contact points tell. `ProblemError` if the
    problem does not carry the weights asked for.
    """
    motions = motions or (lambda solution, _: KnownMotions.of(contact, solution))
    asked = [item.options.weights for item in attempts if item.options.uses("weights")]
    weights = [*dict.fromkeys([Weights.TRIBUTARY, *asked])]
    penalties = tuple(dict.fromkeys(item.options.penalty for item in attempts if item.options.uses("penalty")))
    matrices = {item: weighted_compliance(contact, item) for item in weights}
    assessments = [
        None
        if item.solution is None
        else assess(contact, item.solution, weights, penalties, infinite=infinite, motions=motions)
        for item in (reference, *attempts)
    ]
    direct, *contenders = (
        contender(item, own, assessments[0], matrices)
        for item, own in zip((reference, *attempts), assessments, strict=True)
    )
    differences = _differences(contact, direct, contenders)
    return Comparison(
        contact=contact,
        reference=direct,
        contenders=tuple(contenders),
        differences=differences,
        matrices=tuple(matrices.values()),
        condition=condition(contact),
        verdict=_verdict(direct, contenders, differences),
    )


def _differences(
    contact: CondensedContact, direct: Contender, contenders: Sequence[Contender]
) -> tuple[Difference, ...]:
    """Differences of all pairs, those with the reference first."""
    solved = [direct] if direct.verdict.outcome.meets_conditions else []
    solutions = {item.label: item.solution for item in [*contenders, *solved] if item.solution is not None}
    basis = next(reversed(solutions.values())).pressure if solutions else np.zeros(contact.size)
    peak = contact.peak(basis) or contact.scales.pressure
    size = float(np.sqrt(contact.weights @ basis**2)) if contact.peak(basis) else 0.0
    size = size or peak * float(np.sqrt(contact.weights.sum()))
    pairs = sorted(combinations(solutions, 2), key=lambda pair: pair[1] != direct.label)
    return tuple(
        _difference(contact, (one, solutions[one]), (other, solutions[other]), peak, size) for one, other in pairs
    )


def _difference(
    contact: CondensedContact,
    one: tuple[str, ContactSolution],
    other: tuple[str, ContactSolution],
    peak: float,
    size: float,
) -> Difference:
    """Difference of two solutions with their labels, over a peak pressure and a mean square."""
    (label, solution), (against, basis) = one, other
    apart = solution.pressure - basis.pressure
    own = solution.pressure if solution.unpolished is None else solution.unpolished
    return Difference(
        one=label,
        other=against,
        largest=float(np.abs(apart).max()) / peak,
        mean_square=float(np.sqrt(contact.weights @ apart**2)) / size,
        unpolished=float(np.abs(own - basis.pressure).max()) / peak,
    )


def _verdict(direct: Contender, contenders: Sequence[Contender], differences: Sequence[Difference]) -> str:
    """The result of a comparison as a whole, in sentences."""
    solving = [item for item in contenders if item.verdict.outcome.solves]
    labels = {item.label for item in [*solving, direct]}
    apart = max((item.largest for item in differences if {item.one, item.other} <= labels), default=0.0)
    outcome, sentences = direct.verdict.outcome, []
    if not outcome.meets_conditions:
        did = f", but {_listed(solving, len(contenders))} did" if solving else ""
        sentences.append(f"{OF_DIRECT[outcome]}{did}")
    elif solving and (apart <= SAME or outcome is not Outcome.SOLVES_PERHAPS_NOT_ALONE):
        agree = "agrees" if len(solving) == 1 else "agree"
        difference = "round-off" if apart <= ROUND_OFF else f"{apart:.1e} of the largest pressure"
        who = _listed(solving, len(contenders))
        sentences.append(f"{who} {agree} with the direct solution to {difference}, after a last exact step")
    elif solving:
        sentences.append(
            f"{_listed([*solving, direct], 0)} meet all conditions, but differ by {apart:.1e} of the largest pressure"
        )
    for failure in (Outcome.NOT_THE_SOLUTION, Outcome.LEFT_OPEN, Outcome.REFUSED):
        if failing := [item for item in contenders if item.verdict.outcome is failure]:
            sentences.append(f"{failure}: {_listed(failing, 0)}")
    if outcome.meets_conditions:
        sentences.append(OF_DIRECT[outcome])
    return f"{'; '.join(sentences)}."


def _listed(contenders: Sequence[Contender], of: int) -> str:
    """Name contenders, as QP1, QP2 and QP3; of many only their number."""
    if of > MANY:
        return f"all {of}" if len(contenders) == of else f"{len(contenders)} of {of}"
    *first, last = (item.label for item in contenders)
    return f"{', '.join(first)} and {last}" if first else last
