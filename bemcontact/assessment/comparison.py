"""Formulations side by side: what each found, under every objective, how far apart, and which is the solution.

The direct solution of the complementarity problem is the reference; it has no objective, and so no weights.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from html import escape
from itertools import combinations
from typing import Any

import numpy as np

from bemcontact.assessment.contender import Contender, Found, contender, recomputed
from bemcontact.assessment.matrices import WeightedCompliance, condition, weighted_compliance
from bemcontact.assessment.verdict import Outcome
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.record import contact_record
from bemcontact.contact.solution import ContactSolution
from bemcontact.options import Weights
from bemcontact.version import __version__

SAME = 1e-6
"""Difference of two pressures over the peak from which they are two states and not one."""
MANY = 4
"""Contenders above which those that agree are counted and not named."""
SOLVING = (Outcome.SOLVES, Outcome.SOLVES_PERHAPS_NOT_ALONE)
"""Outcomes of an answer that is a contact state."""
MEETING = (*SOLVING, Outcome.LEFT_OPEN)
"""Outcomes of an answer that meets all conditions."""
OF_DIRECT = {
    Outcome.SOLVES: "the direct solution is certified, and there is no other",
    Outcome.SOLVES_PERHAPS_NOT_ALONE: "the direct solution meets all conditions, but they may have other solutions",
    Outcome.LEFT_OPEN: "round-off leaves open whether the direct solution is near the contact state",
}
"""What the outcome of the direct solution says of the whole."""


@dataclass(frozen=True, kw_only=True)
class Difference:
    """How far the pressures of two contenders are apart.

    Parameters
    ----------
    one, other : their labels
    largest : max |p - p'| over the peak pressure of the reference, or over T where nothing touches
    mean_square : of p - p' in the weighted mean square over the zones, relative to that of the reference likewise
    unpolished : as `largest`, of what the solver of the first found itself before the active-set step that follows it
    """

    one: str
    other: str
    largest: float
    mean_square: float
    unpolished: float


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Comparison:
    """Formulations of one condensed problem side by side.

    Parameters
    ----------
    contact : CondensedContact
    reference : the direct solution
    contenders : the formulations asked for, in the order asked
    differences : of all pairs that have a pressure, those with the reference first
    matrices : of each weights of the comparison, the tributary ones first
    condition : of the matrix that is inverted for the stiffness rows
    verdict : of the whole, in words
    """

    contact: CondensedContact
    reference: Contender
    contenders: tuple[Contender, ...]
    differences: tuple[Difference, ...]
    matrices: tuple[WeightedCompliance, ...]
    condition: float
    verdict: str

    def __repr__(self) -> str:
        """One line: name, contenders, verdict."""
        labels = ", ".join(contender.label for contender in self.contenders)
        return f"<Comparison of {self.contact.name!r}: {labels}; {self.verdict}>"

    def _repr_html_(self) -> str:
        """A table for notebooks: each contender's verdict, objective and distance from the reference."""
        rows = []
        for item in self.everyone:
            difference = self.difference(item.label)
            objective = "" if item.objective is None else f"{item.objective:.1e}"
            off = "" if difference is None else f"{difference.largest:.1e}"
            cells = (item.label, item.verdict.outcome.value, objective, off)
            rows.append(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>")
        head = "".join(
            f"<th>{name}</th>" for name in ("formulation", "verdict", "objective", "off the direct solution")
        )
        caption = f"<caption>{escape(self.contact.name)}: {escape(self.verdict)}</caption>"
        return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"

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
        """The largest `Difference.largest` from the reference of contenders that meet all conditions; None of none."""
        meeting = [item.label for item in self.contenders if item.verdict.outcome in MEETING]
        return max((item.largest for name in meeting if (item := self.difference(name))), default=None)

    @property
    def heading(self) -> str:
        """What is certified, in a few words."""
        if self.certified:
            return "certified"
        if not self.reference.certified:
            return "NOT certified"
        failing = sum(not item.certified for item in self.contenders)
        return f"the contact state is certified, but {failing} of {len(self.contenders)} formulations did not find it"

    def difference(self, label: str) -> Difference | None:
        """How far a contender is from the reference; None if it has no pressure, or is the reference."""
        pair = (label, self.reference.label)
        return next((item for item in self.differences if (item.one, item.other) == pair), None)

    def to_dict(self) -> dict[str, Any]:
        """Give all of it as numbers, lists and texts, ready for JSON."""
        return {
            "name": self.contact.name,
            "version": __version__,
            "certified": self.certified,
            "heading": self.heading,
            "verdict": self.verdict,
            "agreement": self.agreement,
            "contact": contact_record(self.contact),
            "contenders": [contender.to_dict(self.contact) for contender in self.contenders],
            "reference": self.reference.to_dict(self.contact),
            "differences": [asdict(item) for item in self.differences],
            "matrices": {"condition": self.condition, "weighted": [item.to_dict() for item in self.matrices]},
        }

    def to_json(self, indent: int | None = 2) -> str:
        """Write `to_dict` as JSON; every number in it is finite."""
        return json.dumps(self.to_dict(), indent=indent, allow_nan=False, ensure_ascii=False)


def comparison(contact: CondensedContact, reference: Found, found: Sequence[Found]) -> Comparison:
    """Judge what formulations found, and put it side by side; nothing is believed from a solver.

    Parameters
    ----------
    contact : CondensedContact
    reference : the direct solution
    found : of the formulations

    Returns
    -------
    Comparison

    Raises
    ------
    ProblemError
        The problem does not carry the weights asked for.
    """
    asked = [item.options.weights for item in found if item.options.uses("weights")]
    weights = [*dict.fromkeys([Weights.TRIBUTARY, *asked])]
    penalties = tuple(dict.fromkeys(item.options.penalty for item in found if item.options.uses("penalty")))
    matrices = {item: weighted_compliance(contact, item) for item in weights}
    judged = [
        None if item.solution is None else recomputed(contact, item.solution, weights, penalties)
        for item in (reference, *found)
    ]
    base, *contenders = (
        contender(item, own, judged[0], matrices) for item, own in zip((reference, *found), judged, strict=True)
    )
    differences = _differences(contact, base, contenders)
    return Comparison(
        contact=contact,
        reference=base,
        contenders=tuple(contenders),
        differences=differences,
        matrices=tuple(matrices.values()),
        condition=condition(contact),
        verdict=_whole(base, contenders, differences),
    )


def _differences(contact: CondensedContact, base: Contender, judged: Sequence[Contender]) -> tuple[Difference, ...]:
    """Of all pairs, those with the reference first."""
    solved = [base] if base.verdict.outcome in MEETING else []
    found = {item.label: item.judged.solution for item in [*judged, *solved] if item.judged is not None}
    of_base = next(reversed(found.values())).pressure if found else np.zeros(contact.size)
    peak = contact.peak(of_base) or contact.scales.pressure
    size = float(np.sqrt(contact.weights @ of_base**2)) if contact.peak(of_base) else 0.0
    size = size or peak * float(np.sqrt(contact.weights.sum()))
    pairs = sorted(combinations(found, 2), key=lambda pair: pair[1] != base.label)
    return tuple(_difference(contact, (one, found[one]), (other, found[other]), peak, size) for one, other in pairs)


def _difference(
    contact: CondensedContact,
    one: tuple[str, ContactSolution],
    other: tuple[str, ContactSolution],
    peak: float,
    size: float,
) -> Difference:
    """Of two solutions with their labels, over a peak pressure and a mean square."""
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


def _whole(base: Contender, judged: Sequence[Contender], differences: Sequence[Difference]) -> str:
    """What a comparison says as a whole."""
    solving = [item for item in judged if item.verdict.outcome in SOLVING]
    labels = {item.label for item in [*solving, base]}
    apart = max((item.largest for item in differences if {item.one, item.other} <= labels), default=0.0)
    sentences = []
    if base.verdict.outcome is Outcome.NOT_THE_SOLUTION:
        did = f", but {_listed(solving, len(judged))} did" if solving else ""
        sentences.append(f"the direct solver found no contact state{did}")
    elif solving and (apart <= SAME or base.verdict.outcome is not Outcome.SOLVES_PERHAPS_NOT_ALONE):
        agree = "agrees" if len(solving) == 1 else "agree"
        exactly = "exactly" if apart == 0 else f"to {apart:.1e} of the peak"
        sentences.append(f"{_listed(solving, len(judged))} {agree} with the direct solution {exactly}")
    elif solving:
        sentences.append(f"{_listed([*solving, base], 0)} meet all conditions, but differ by {apart:.1e} of the peak")
    for outcome in (Outcome.NOT_THE_SOLUTION, Outcome.LEFT_OPEN, Outcome.REFUSED):
        if failing := [item for item in judged if item.verdict.outcome is outcome]:
            sentences.append(f"{outcome.value}: {_listed(failing, 0)}")
    if base.verdict.outcome in OF_DIRECT:
        sentences.append(OF_DIRECT[base.verdict.outcome])
    return f"{'; '.join(sentences)}."


def _listed(contenders: Sequence[Contender], of: int) -> str:
    """Labels as one says them, QP1, QP2 and QP3; of a great many only how many."""
    if of > MANY:
        return f"all {of}" if len(contenders) == of else f"{len(contenders)} of {of}"
    *first, last = (item.label for item in contenders)
    return f"{', '.join(first)} and {last}" if first else last
