"""Contact problems, and how solvers searched, in words."""

from typing import NamedTuple

from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import LocalSearch
from bemcontact.problems import Units
from bemcontact.report.formatting import JsonObject, number, plural


def units_of(contact: CondensedContact) -> Units:
    """Read the labels of the units back from a condensed problem."""
    return Units(length=contact.units.get("length", ""), force=contact.units.get("force", ""))


def search_in_words(search: LocalSearch, contact: CondensedContact) -> str:
    """Start, iterations and curvature of the search of a local solver."""
    first, second, changes = search.phase_one_iterations, search.phase_two_iterations, search.working_set_changes
    sentences = [
        f"from the {search.start}: {first + second} {plural('iteration', first + second)} ({first} to a feasible "
        f"point, {second} from there)",
        f"{changes} {plural('change', changes)} of the working set",
        f"eigenvalues of the whole Hessian: {_inertia(search.inertia)}; of the reduced Hessian: "
        f"{_inertia(search.reduced_inertia_start)} at the feasible point, {_inertia(search.reduced_inertia_end)} at "
        "the end",
    ]
    if search.penalty is not None:
        words = penalty_in_words(search.penalty.to_dict(), units_of(contact))
        kept = " where equilibrium is kept" if contact.free_motions and search.penalty.convexity_limit != 0 else ""
        sentences.append(f"penalty {words.value}, convex{kept} {words.limit}{words.raw_limit}")
    return "; ".join(sentences)


def _inertia(inertia: tuple[int, int, int]) -> str:
    """Write how many eigenvalues are positive, zero and negative."""
    kinds = zip(inertia, ("positive", "zero", "negative"), strict=True)
    return ", ".join(f"{count} {kind}" for count, kind in kinds if count) or "none"


class PenaltyWords(NamedTuple):
    """A penalty μ of QP2, and the largest one for which QP2 is convex, both also in the units of the problem."""

    value: str
    limit: str
    """``for every penalty``, ``for no penalty``, or up to which one."""
    raw_limit: str
    """The last one in the units of the problem."""


def penalty_in_words(penalty: JsonObject, units: Units) -> PenaltyWords:
    """Write the record of a penalty."""
    labels = {"p/L²": f"{units.force}/{units.length}⁴", "1/p": f"{units.length}²/{units.force}"}
    unit = labels[penalty["dimension"]] if units.force and units.length else "in the units of the problem"
    limit, raw = penalty["convexity_limit"], penalty["convexity_limit_raw"]
    value = f"{number(penalty['value'])} ({number(penalty['raw'])} {unit})"
    if not limit:
        return PenaltyWords(value, "for every penalty" if limit is None else "for no penalty", "")
    return PenaltyWords(value, f"up to {number(limit)}", f" ({number(raw)} {unit})")


def held_by(contact: CondensedContact) -> str:
    """Rigid motions that are held by contact."""
    if not contact.free_motions:
        return "all held by conditions"
    return f"held by contact: {', '.join(contact.motion_names)}"
