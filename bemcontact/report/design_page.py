"""The page of a designed gap, and its table: what was asked, what is reached, what is proved, the surface to use."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from bemcontact.arrays import Array
from bemcontact.errors import ProblemError
from bemcontact.modelling.gap_design.designed_gap import MEASURED, GapDesign, LoadState
from bemcontact.modelling.gap_design.relief import Relief
from bemcontact.problems import Units
from bemcontact.report.contact_words import units_of
from bemcontact.report.formatting import number, sentence_case, with_unit, zero_if_negligible
from bemcontact.report.page import picture, template
from bemcontact.report.verdicts import NOT_LOOKED_AT, Verdict, overall
from bemcontact.serialization import csv_text
from bemcontact.version import __version__

CAPTIONS = {
    "pressure": "Pressure along the zone, without and with the profile",
    "profile": "The profile; positive values take material away from the rigid surface",
}
"""Name of a picture -> its caption."""
NOT_ESTIMATED = (
    "A design knows the pressure at the contact points of one mesh, and nothing between them. Solve the problem with "
    "the designed surface, and look at its error bars."
)
"""What is said on the errors of the mesh."""


def design_verdicts(design: GapDesign) -> tuple[Verdict, Verdict, Verdict]:
    """Verdicts on the contact states with the profile, on the optimum, and on the mesh."""
    if design.verified:
        words = (
            "Solved again with the profile, each load state has one contact state, which is proved, and the designed "
            f"pressure{f', to {design.difference:.0e} of the peak' if design.difference else ''}."
        )
        equations = Verdict("Equations", "good", "verified", words)
    else:
        said = dict.fromkeys(state.certificate.words for state in design.after)
        words = f"Pressures differ from those designed by {design.difference:.0e} of the peak. {' '.join(said)}"
        equations = Verdict("Equations", "bad", "not as designed", words)
    bound = number(design.lower_bound)
    if design.proved_optimal:
        words = f"No profile within the bounds does better than {bound}, the lower bound of the convex relaxation."
        optimum = Verdict("Optimum", "good", "proved", words)
    else:
        gap = f", which is {100 * (1 - design.lower_bound / design.value):.2g} % less" if design.value else ""
        words = f"No profile within the bounds goes below {bound}{gap}. Whether one reaches it is not known."
        optimum = Verdict("Optimum", "fair", "not proved", words)
    return equations, optimum, Verdict("Mesh", "fair", "not assessed", NOT_ESTIMATED)


def render(design: GapDesign, pictures: Mapping[str, bytes], relief: Relief | None = None) -> str:
    """Write the page of a design as HTML that needs no other file.

    `pictures` are SVG files by name as of `figures.figures_of_design`; the page has the bounds if they are given.
    """
    contact, verdicts = design.before[0].contact, design_verdicts(design)
    surface, refusal = _surface(design)
    return template("design.html").render(
        name=contact.name,
        version=__version__,
        verdicts=verdicts,
        overall=overall(verdicts),
        headline=[*_headline(design, units_of(contact))],
        goal=f"{MEASURED[design.goal]} was made as small as possible",
        zone=design.zone,
        extent=[number(float(end)) for end in design.arc_position[[0, -1]]],
        points=len(design.points),
        bounds=[] if relief is None else [*_bounds(relief, units_of(contact))],
        pictures=[picture(svg, CAPTIONS[name], f"{contact.name}. {CAPTIONS[name]}.") for name, svg in pictures.items()],
        states=[*_states(design, units_of(contact))],
        words=design.words,
        units=units_of(contact),
        surface=surface,
        refusal=refusal,
        not_looked_at=NOT_LOOKED_AT,
    )


def _headline(design: GapDesign, units: Units) -> Iterator[tuple[str, str, str]]:
    """Name, value and remark of the numbers at the head of the page."""
    highest, before = (max(states, key=lambda state: state.peak) for states in (design.after, design.before))
    yield (
        "Peak pressure",
        _peak(highest, units),
        f"at the contact points; before: {_peak(before, units)}{_change(before, highest, ', ')}",
    )
    yield (
        "Lower bound of the goal",
        with_unit(number(design.lower_bound), units.stress),
        "for any profile within bounds",
    )
    if design.von_mises is not None:
        limit = "" if design.von_mises_limit is None else f", limit {number(design.von_mises_limit)}"
        yield (
            "Von Mises stress",
            with_unit(number(design.von_mises), units.stress),
            f"at most, at the given points{limit}",
        )
    profile = design.profile[design.points]
    largest = float(np.abs(profile).max())
    low, high = (number(zero_if_negligible(float(end), largest)) for end in (profile.min(), profile.max()))
    yield "Profile", with_unit(f"{low} to {high}", units.length), f"on {design.zone}"


def _peak(state: LoadState, units: Units) -> str:
    """Write the peak of a load state; one at a sharp edge is a number of the mesh."""
    peak = with_unit(number(state.peak), units.stress)
    return f"infinite in theory, {peak} on this mesh" if state.infinite else peak


def _change(before: LoadState, after: LoadState, start: str = "") -> str:
    """Write by how much the peak changes, after a start; empty if one of the two is no number of the body."""
    if before.infinite or after.infinite or not before.peak:
        return ""
    return f"{start}{100 * (after.peak / before.peak - 1):+.1f} %"


def _bounds(relief: Relief, units: Units) -> Iterator[tuple[str, str, str]]:
    """What is bounded, the least and the largest value with units."""
    of_curvature = f"1/{units.length}" if units.length else ""
    pairs = {
        "profile": (relief.lower, relief.upper, units.length),
        "slope": (*_both(relief.slope), ""),
        "curvature": (*_both(relief.curvature), of_curvature),
        "coefficients": (*(relief.coefficients or (None, None)), ""),
    }
    for name, (least, largest, unit) in pairs.items():
        if least is not None or largest is not None:
            yield name, _limit(least, unit), _limit(largest, unit)


def _both(limits: float | tuple[float, float] | None) -> tuple[float | None, float | None]:
    """The least and the largest value that ± a number or a pair means."""
    if limits is None or isinstance(limits, tuple):
        return limits or (None, None)
    return -limits, limits


def _limit(value: Any, unit: str) -> str:
    """Write a bound, or from where to where those of the points go."""
    if value is None:
        return "none"
    values: Array = np.asarray(value, float)
    low, high = number(float(values.min())), number(float(values.max()))
    return with_unit(low if low == high else f"{low} … {high}", unit)


def _states(design: GapDesign, units: Units) -> Iterator[dict[str, str]]:
    """Peak before and after, change, force, and verdict of each load state."""
    zone = int(design.before[0].contact.zone[design.points[0]])
    for order, (before, after) in enumerate(zip(design.before, design.after, strict=True), 1):
        force = float(np.hypot(*after.contact.resultants(after.pressure)[zone]))
        factors = zip(after.contact.cases.names, after.contact.cases.factors.tolist(), strict=True)
        acting = " + ".join(f"{number(factor)} {name}" for name, factor in factors if factor)
        yield {
            "name": f"{order}: {acting}" if acting else f"{order}",
            "before": _peak(before, units),
            "after": _peak(after, units),
            "change": _change(before, after) or "none",
            "force": with_unit(number(force), units.line_force),
            "verdict": sentence_case(after.certificate.heading),
            "quality": "good" if after.certificate.certified else "bad",
        }


def _surface(design: GapDesign) -> tuple[str, str]:
    """The designed surface as YAML, or why there is none."""
    try:
        return design.to_yaml(), ""
    except ProblemError as error:
        return "", f"{sentence_case(str(error))}."


def design_csv(design: GapDesign) -> str:
    """Write a line for each contact point of the zone: arc position, place, profile, and pressures by load state."""
    contact, states = design.before[0].contact, range(1, len(design.before) + 1)
    pressures = (f"pressure_{when}_{state}" for state in states for when in ("before", "after"))
    pairs = zip(design.before, design.after, strict=True)
    columns = [contact.arc_position, *contact.points.T, design.profile, *(it.pressure for pair in pairs for it in pair)]
    at = contact.in_order(np.flatnonzero(contact.zone == contact.zone[design.points[0]]))
    return csv_text(["arc", "x", "y", "profile", *pressures], np.stack(columns, axis=1)[at].tolist())
