"""The page of a result, or of the results of all load cases: what was asked, the answer, what to rely on."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from bemcontact.analysis.case_comparisons import CaseComparisons
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import BEYOND, Result
from bemcontact.contact.stress import INSIDE, ON_BOUNDARY, SHEAR_BELOW, StressPeak
from bemcontact.options import StressMeasure
from bemcontact.problems import Problem, Units
from bemcontact.report.bars import BARS_ARE, NOTHING, accuracy_rows, bars_of, mesh_in_short, with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import (
    UNRESOLVED,
    contact_intervals,
    coordinate_size,
    facts,
    force_errors,
    largest_displacement,
    peak_of,
    peak_place,
    pressed_by,
    resolved_size,
    rotations_of_cases,
    small,
    total_force,
)
from bemcontact.report.figures.load_cases import shown_cases
from bemcontact.report.figures.result import drawn_near
from bemcontact.report.figures.stress import UNIFORM
from bemcontact.report.formatting import (
    NEGLIGIBLE,
    JsonObject,
    load_cases_in_words,
    number,
    problem_in_words,
    sentence_case,
    vector,
    with_unit,
    zero_if_negligible,
    zone_surfaces,
)
from bemcontact.report.page import picture, template
from bemcontact.report.peak_places import level_zones
from bemcontact.report.verdicts import NOT_LOOKED_AT, case_verdicts, overall, result_verdicts
from bemcontact.report.zones import by_case, interval_rows, zone_rows
from bemcontact.version import __version__

ZONE_PICTURES = {"contact": "close-up of the contact, {stress}", "pressure": "pressure", "gap": "gap"}
"""Kind of a picture of one zone -> its caption."""
MOST_PLACES = 6
"""Number of places of infinite stress that are listed."""
CAPTIONS = {
    "problem": "What was asked: each body, what holds and loads it, and what it may touch",
    "contact": "Where the body touches, and how hard; displacements are to scale",
    "contacts": "Where the body touches in each load case; all pressures have one scale",
    "deformed": "{stress} on the deformed shape; the surfaces move with the magnification",
    "forces": "Largest pressure and force of each contact",
}
"""Name of a picture -> its caption."""
MOST_FORCES = 3
"""Most contact zones whose forces are at the head of a page."""
STRESSES = "{stress} on the deformed shape in each load case; all have one scale of colors and one magnification"
"""Caption of the picture "deformed" of load cases."""


def render(
    results: Result | CaseResults,
    pictures: Mapping[str, bytes],
    spec: str | None,
    comparisons: CaseComparisons | None = None,
    stress: StressMeasure = StressMeasure.VON_MISES,
) -> str:
    """Write the page of a result, or of all load cases, as HTML that needs no other file.

    `pictures` are SVG files by name as of `figures.pictures_of`, and `spec` is the text of the spec as run. With
    `comparisons` the page shows whether all formulations agree under the load cases.
    """
    cases = by_case(results)
    first = next(iter(cases.values()))
    verdicts = result_verdicts(results) if isinstance(results, Result) else case_verdicts(results)
    units, alone = units_of(first.contact), first.to_dict() if isinstance(results, Result) else None
    return template("result.html").render(
        name=first.contact.name if isinstance(results, Result) else results.name,
        version=__version__,
        description=[] if first.problem is None else [*_asked(first.problem, alone=alone is not None)],
        formulation=first.solution.formulation,
        verdicts=verdicts,
        overall=overall(verdicts),
        headline=[
            *(_headline(alone, units) if alone else _headline_of_cases(cases, units)),
            *_most_stressed(cases, units),
        ],
        details=[*facts(alone, units)] if alone else [],
        stresses=[(name, *row) for name, result in cases.items() for row in _stresses(result, units)],
        formulations=[] if comparisons is None else [*_formulations(comparisons)],
        cases=[_case(name, result, units) for name, result in cases.items()] if not alone else [],
        zones=[(name, row) for name, result in cases.items() for row in zone_rows(result.to_dict(), units)],
        intervals=[(name, row) for name, result in cases.items() for row in interval_rows(result.to_dict(), units)],
        rotations=[] if alone else [*rotations_of_cases({name: result.to_dict() for name, result in cases.items()})],
        envelope=[*_envelope(cases, units)] if not alone else [],
        bars=[*accuracy_rows(alone["accuracy"], units)] if alone else [],
        bars_are=BARS_ARE,
        surfaces=zone_surfaces(first.problem) if first.problem else [],
        notes=[*_notes(cases)],
        near=sentence_case(drawn_near([*cases.values()])),
        infinite=any(result.accuracy.infinite for result in cases.values()),
        assessed=any(result.accuracy.met is not None for result in cases.values()),
        not_looked_at=NOT_LOOKED_AT,
        body="body" if not first.sides else "first body of each contact",
        pictures=[_picture(name, svg, results, stress) for name, svg in pictures.items()],
        notes_beyond=any(BEYOND in note for result in cases.values() for note in result.notes),
        spec=spec,
    )


def _asked(problem: Problem, *, alone: bool) -> Iterator[str]:
    """The problem in words; under all load cases the permanent loads, and what each load case adds."""
    yield from problem_in_words(problem if alone else problem.model_copy(update={"case": None}))
    if not alone:
        yield from load_cases_in_words(problem)


def _headline(record: JsonObject, units: Units) -> Iterator[tuple[str, str, str]]:
    """Name, value and remark of the numbers at the head of the page."""
    place = peak_place(record, units)
    at = f"{'' if place.startswith('all along') else 'at '}{place}, " if place else ""
    yield "Peak pressure", peak_of(record, units), f"{at}per undeformed length"
    touching = [*contact_intervals(record, units, short=True)]
    if len(touching) == 1:
        yield "Contact", touching[0][1].split(", ends")[0], f"long, in {touching[0][0]}"
    elif touching:
        yield "Contact", f"{len(touching)} places", f"in {', '.join(dict.fromkeys(zone for zone, _ in touching))}"
    yield from _forces(record, units)
    for bar in bars_of(record, "displacement"):
        where = bar["at"] and f"at {vector(bar['at'], units.length, scale=coordinate_size(record))}"
        yield "Largest displacement", largest_displacement(bar, units), where or ""


def _forces(record: JsonObject, units: Units) -> Iterator[tuple[str, str, str]]:
    """The force of all surfaces; of a few zones that press, the size of each, since theirs may cancel."""
    zones = {zone: float(np.hypot(*force)) for zone, force in record["forces"].items()}
    pressing = {zone: size for zone, size in zones.items() if zero_if_negligible(size, pressed_by(record))}
    if not 1 < len(pressing) <= MOST_FORCES:
        remark = "the largest" if len(pressing) > 1 else ""
        yield *total_force(record, units), remark if record["sides"] else "of all surfaces"
        return
    for zone, size in pressing.items():
        errors = force_errors(record, zone)
        value = with_bar(size, sum(errors) / size if errors else None)
        yield f"Force of {zone}", with_unit(value, units.line_force), ""


def _headline_of_cases(cases: Mapping[str, Result], units: Units) -> Iterator[tuple[str, str, str]]:
    """The largest pressure of all load cases, and their number."""
    infinite = [name for name, result in cases.items() if result.accuracy.infinite]
    name = max(cases, key=lambda name: float(cases[name].solution.pressure.max()))
    if infinite:
        all_of_them = len(infinite) == len(cases)
        yield "Largest pressure", "infinite", "in every load case" if all_of_them else f"under {', '.join(infinite)}"
    elif cases[name].footprint.peak is not None:
        yield "Largest pressure", peak_of(cases[name].to_dict(), units), f"under {name}"
    yield "Load cases", f"{len(cases)}", "with combinations"


def _most_stressed(cases: Mapping[str, Result], units: Units) -> Iterator[tuple[str, str, str]]:
    """The largest von Mises stress of all load cases."""
    largest = {name: result.largest_stresses() for name, result in cases.items() if result.boundary is not None}
    infinite = next((name for name, peaks in largest.items() if len(peaks.singular)), None)
    known = [(peak, name) for name, peaks in largest.items() for peak in (peaks.inside, peaks.boundary) if peak]
    value, where = "", ""
    if known:
        peak, name = max(known, key=lambda item: item[0].value)
        place = "on the boundary" if peak is largest[name].boundary else "inside"
        value, where = _stress(peak, units), f"{place}{name and f', under {name}'}"
    if infinite is not None:
        elsewhere = f"; largest maximum away from them {value} {where}" if known else ""
        yield (
            "Largest von Mises stress",
            "infinite",
            f"at corners or edges{infinite and f', under {infinite}'}{elsewhere}",
        )
    elif known:
        yield "Largest von Mises stress", value, where


def _stresses(result: Result, units: Units) -> Iterator[tuple[str, str, str]]:
    """What a largest stress is of, its value and its place; where stress is infinite."""
    if result.boundary is None:
        return
    largest = result.largest_stresses()
    size = float(abs(result.boundary.points).max())
    everywhere = result.triangulated.stress.measured(StressMeasure.VON_MISES)
    if not len(largest.singular) and largest.boundary and np.ptp(everywhere) <= UNIFORM * everywhere.max():
        yield "von Mises", _stress(largest.boundary, units), "the same all over the body"
        return
    for zone, peak in largest.shear.items():
        if peak is not None:
            depth = with_unit(number(peak.depth), units.length)
            yield SHEAR_BELOW.format(zone), _stress(peak, units), f"{_at(peak, units, size)}, {depth} deep"
    if largest.inside is not None:
        yield INSIDE, _stress(largest.inside, units), _at(largest.inside, units, size)
    if (peak := largest.boundary) is not None:
        yield ON_BOUNDARY, _stress(peak, units), f"{_at(peak, units, size)} on {peak.edge}"
    for why in dict.fromkeys(largest.missing.values()):
        yield "; ".join(label for label in largest.missing if largest.missing[label] == why), "none", why
    if len(largest.singular):
        places = [vector((x, y), scale=size) for x, y in largest.singular[:MOST_PLACES].tolist()]
        more = len(largest.singular) - len(places)
        listed = f"{', '.join(places)}{f' and {more} more places' if more else ''}"
        yield "von Mises, at corners and edges", "infinite", f"at {listed}: the values above are those elsewhere"


def _stress(peak: StressPeak, units: Units) -> str:
    """Write a largest stress with its error bar, if it is known."""
    if peak.bar is None:
        return f"{with_unit(number(peak.value, 3), units.stress)}, error not known"
    return with_unit(with_bar(peak.value, peak.bar), units.stress)


def _at(peak: StressPeak, units: Units, size: float) -> str:
    """Write the place of a stress; what is small beside its depth is zero."""
    place = vector(peak.point, units.length, scale=max(size, UNRESOLVED * peak.depth / NEGLIGIBLE))
    return f"at {place}{f' in {peak.body}' if peak.body and not peak.edge else ''}"


def _case(name: str, result: Result, units: Units) -> dict[str, Any]:
    """A row in the table of load cases."""
    record, verdicts = result.to_dict(), result_verdicts(result)
    whose, force = total_force(record, units)
    return {
        "name": name,
        "equations": verdicts[0].word,
        "mesh": mesh_in_short(record["accuracy"]),
        "quality": overall(verdicts),
        "peak": peak_of(record, units) if record["intervals"] else "no contact",
        "place": peak_place(record, units) or NOTHING,
        "force": f"{whose}: {force}" if record["sides"] else force,
    }


def _infinite_at(results: Sequence[Result], zone: str, units: Units) -> str:
    """Where the pressure of a zone is infinite in some results, if this is known."""
    records = [result.to_dict() for result in results]
    places = [
        vector(bar["at"], units.length, scale=resolved_size(record))
        for record in records
        for bar in bars_of(record, "peak")
        if bar["zone"] == zone and bar["at"]
    ]
    return " and ".join(dict.fromkeys(places)) or NOTHING


def _formulations(comparisons: CaseComparisons) -> Iterator[dict[str, Any]]:
    """The verdict on each formulation under each load case, with its difference from the direct solution."""
    for case, level in comparisons.levels.items():
        for contender in level.comparison.contenders:
            difference = level.comparison.difference(contender.label)
            yield {
                "case": case,
                "label": contender.label,
                "outcome": contender.verdict.outcome,
                "words": "" if contender.certified else sentence_case(contender.verdict.words),
                "quality": contender.verdict.outcome.quality,
                "difference": NOTHING if difference is None else small(difference.largest),
            }


def _envelope(cases: Mapping[str, Result], units: Units) -> Iterator[tuple[str, str, str, str]]:
    """Zone, largest peak of all load cases, the load case, and the place."""
    first = next(iter(cases.values()))
    for order, zone in enumerate(first.contact.zone_names):
        infinite = [name for name, result in cases.items() if zone in result.accuracy.infinite]
        if infinite:
            yield zone, "infinite", ", ".join(infinite), _infinite_at([cases[name] for name in infinite], zone, units)
            continue
        own = (first.contact.zone == order).nonzero()[0]
        most = max(cases, key=lambda name: float(cases[name].solution.pressure[own].max()))
        result = cases[most]
        highest = own[int(result.solution.pressure[own].argmax())]
        largest = float(result.solution.pressure[highest])
        x, y = result.contact.points[highest].tolist()
        record = result.to_dict()
        level = zone in level_zones(record, 1.0)
        place = "all along the contact" if level else vector((x, y), units.length, scale=resolved_size(record))
        bar = result.accuracy.peak_bar(zone)
        if largest > 0:
            yield zone, with_unit(with_bar(largest, bar), units.stress), most, place
        else:
            yield zone, "no contact", NOTHING, NOTHING


def _notes(cases: Mapping[str, Result]) -> Iterator[str]:
    """Notes of all results as sentences, each once, with the load cases that have it if not all have."""
    for note in dict.fromkeys(note for result in cases.values() for note in result.notes):
        names = [name for name, result in cases.items() if note in result.notes]
        where = "" if len(names) == len(cases) else f"{', '.join(names)}: "
        yield f"{where}{sentence_case(note)}."


def _picture(name: str, svg: bytes, results: Result | CaseResults, stress: StressMeasure) -> Any:
    """A picture with its caption and text alternative, which names the load cases that it shows."""
    kind, _, number = name.partition("-")
    cases = by_case(results)
    first = next(iter(cases.values()))
    zones = first.contact.zone_names
    of_zone = (
        f"{zones[int(number) - 1]}: {ZONE_PICTURES[kind]}" if number else sentence_case(ZONE_PICTURES.get(kind, ""))
    )
    caption = of_zone if number or name not in CAPTIONS else CAPTIONS[name]
    shows = first.contact.name
    if isinstance(results, CaseResults) and name != "problem":
        drawn = shown_cases(results) if name in ("contacts", "deformed") else [*cases]
        shows = f"{results.name}: {', '.join(drawn)}"
        caption = STRESSES if name == "deformed" else caption
        if len(drawn) < len(cases):
            most = f"the {len(drawn)} of {len(cases)} load cases with the largest forces"
            caption = caption.replace("each load case", most)
    if name == "problem" and first.problem is not None and first.problem.case is not None:
        caption = f"{caption}; with the loads of {first.problem.case}"
    caption = caption.replace("{stress}", stress.words if number else sentence_case(stress.words))
    return name, picture(svg, caption, f"{shows}. {caption}.")
