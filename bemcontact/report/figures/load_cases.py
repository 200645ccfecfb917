"""The picture of all load cases: contact and stress of each, their pressures and the envelope of these."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.options import StressMeasure
from bemcontact.report.bars import with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.contact import (
    body_extent,
    close_ups,
    setting_of,
    sketch_contact,
)
from bemcontact.report.figures.deformed import draw_shape, in_words, magnification
from bemcontact.report.figures.page import (
    GREY,
    PIECE_COLOURS,
    ceiling,
    cut_off,
    distance_label,
    labeled,
    name_axis,
    new_page,
    pieces_of,
    plain,
    settle,
    short_label,
    wrapped,
)
from bemcontact.report.figures.result import (
    ROW,
    WIDE,
    drawn_near,
    entitle,
    of_zone,
    panels_of,
    show_around,
)
from bemcontact.report.figures.stress import SAME, add_bar, color_scale, fill_body
from bemcontact.report.formatting import with_unit
from bemcontact.report.verdicts import case_verdicts

INCHES = 12
MOST = 9
"""Largest number of load cases that have pictures of their own."""
TINY = 0.12
"""Extent of the contact over that of the body below which close-ups are drawn instead of bodies."""
APART = 0.5
"""Extent of the close-up of the contacts of all load cases over that of the body from which on bodies are drawn."""
DASHES = ("solid", "dashed", "dotted", "dashdot")
"""Line styles of unbroken pieces of boundary."""
ENVELOPE = "largest of all"
"""Name of the envelope in legends."""


def figure_of_cases(cases: CaseResults, stress: StressMeasure = StressMeasure.VON_MISES) -> Figure:
    """Compose a page with contact and stress of each load case, and the pressures of all with their envelope."""
    shown, first = shown_cases(cases), next(iter(cases.results.values()))
    panels = panels_of([*cases.results.values()])
    columns, rows, height = grid_of(len(shown), first, INCHES)
    bodies = 2 * [rows * height] if rows else []
    heights = [*bodies, ROW * len(panels)]
    figure = new_page(INCHES, 0.8 + sum(heights))
    *above, below = figure.subfigures(len(heights), 1, height_ratios=heights, squeeze=False)[:, 0]
    for row, zone in enumerate(panels):
        draw_case_pressures(below.add_subplot(len(panels), 1, row + 1), cases, zone)
    if words := drawn_near([*cases.results.values()]):
        below.suptitle(words, x=0.01, ha="left", fontsize=10, color=GREY)
    entitle(figure, f"{wrapped(cases.name, 6 * INCHES)}: all load cases", case_verdicts(cases), 9 * INCHES)
    if above:
        draw_case_contacts(
            places_of(above[0], len(shown), rows, columns), {name: cases.results[name] for name in shown}
        )
        draw_case_stresses(places_of(above[1], len(shown), rows, columns), cases, shown, stress)
    return figure


def places_of(figure: Figure | SubFigure, count: int, rows: int, columns: int) -> list[Axes]:
    """So many axes, row by row."""
    return [figure.add_subplot(rows, columns, place) for place in range(1, count + 1)]


def shown_cases(cases: CaseResults) -> list[str]:
    """Names of the load cases that have pictures of their own: all, or those with the largest forces."""
    if next(iter(cases.results.values())).boundary is None:
        return []
    weight = {
        name: sum(np.hypot(*force) for force in result.footprint.forces.values())
        for name, result in cases.results.items()
    }
    most = sorted(weight, key=lambda name: -weight[name])[:MOST]
    return [name for name in cases.results if name in most]


def grid_of(count: int, first: Result, inches: float) -> tuple[int, int, float]:
    """Columns, rows, and inches of a row of the pictures of so many results, side by side in a width in inches."""
    if not count or first.boundary is None:
        return 1, 0, 0.0
    width, height = body_extent(first.boundary)
    columns = 2 if count in (2, 4) or width > 2 * WIDE * height else min(count, 3)
    return columns, -(-count // columns), float(np.clip(0.9 * inches / columns * height / width + 1.0, 1.8, 4.5))


def draw_case_contacts(places: Sequence[Axes], cases: Mapping[str, Result]) -> None:
    """Draw the contact of results, each with its name; the bodies of all have one scale, and so have their fans.

    If the only zone is small beside the body in all of them, and at much the same place, close-ups are drawn.
    """
    results = [*cases.values()]
    zone = close_zone(results)
    setting, writers = setting_of(results, zone), list[Callable[[], None]]()
    for axes, (name, result) in zip(places, cases.items(), strict=True):
        axes.set_title(f"{short_label(name, 30)}\n{_peak(result)}", loc="left", fontsize=9)
        writers.append(sketch_contact(axes, result, zone, setting, numbers=False))  # there is no room for more
    _align(places, framed=zone is not None)
    settle(places[0])
    for write in writers:
        write()


def draw_case_stresses(places: Sequence[Axes], cases: CaseResults, shown: Sequence[str], stress: StressMeasure) -> None:
    """Draw a stress on the deformed shape of load cases; all have one magnification and one scale of colors.

    A ring marks the largest stress of each, crosses places where it is infinite.
    """
    results = [cases.results[name] for name in shown]
    factor = magnification(results)
    scale, marked = color_scale(results, stress, factor), {"dashed: undeformed": None}
    for axes, name, result in zip(places, shown, results, strict=True):
        draw_shape(axes, result, factor)
        drawn, words, largest = fill_body(axes, result, scale, factor)
        below = words if words == SAME else largest and f"largest {largest}"
        title = f"{short_label(name, 30)}\n{below}".rstrip()
        if words != SAME:
            marked[words] = None
        axes.set_title(title, loc="left", fontsize=9)
        if axes is places[-1]:
            add_bar(places, drawn, result, scale)
    _align(places, framed=False)
    figure = places[0].get_figure(root=False)
    assert figure is not None
    title = f"deformed shapes, {in_words(factor, results)}\n{'; '.join(marked)}"
    figure.suptitle(title, x=0.01, ha="left", fontsize=10)


def close_zone(results: Sequence[Result]) -> str | None:
    """The only zone, if one close-up shows its contact under all load cases."""
    first, touching = results[0], [result for result in results if result.touching.any()]
    zones = first.contact.zone_names
    if first.boundary is None or len(zones) != 1 or not all(close_ups(result, TINY) for result in touching):
        return None
    shown = np.ptp(setting_of(results, zones[0]).window, axis=0).max()
    return zones[0] if shown < APART * max(body_extent(first.boundary)) else None


def _align(places: Sequence[Axes], *, framed: bool) -> None:
    """Give axes equal limits, so that bodies have one scale and one place; those without a frame have no ticks."""
    (left, right), (low, high) = (np.array([axes.axis()[side : side + 2] for axes in places]).T for side in (0, 2))
    for axes in places:
        axes.set(xlim=(left.min(), right.max()), ylim=(low.min(), high.max()))
        if not framed:
            axes.set(xticks=[], yticks=[], xlabel="", ylabel="")
            axes.spines[:].set_visible(False)


def _peak(result: Result) -> str:
    """The largest pressure of a load case in few words."""
    peak = result.footprint.peak
    if result.accuracy.infinite:
        return f"infinite in {', '.join(short_label(zone, 20) for zone in result.accuracy.infinite)}"
    if peak is None:
        return "no contact"
    return with_unit(with_bar(peak.pressure, result.accuracy.peak_bar()), plain(units_of(result.contact).stress))


def draw_case_pressures(axes: Axes, cases: CaseResults, zone: str | None = None) -> None:
    """Draw the contact pressure of each load case over the distance along a zone, or along each, with the envelope."""
    results = cases.results
    first, touching = next(iter(results.values())), np.any([it.touching for it in results.values()], axis=0)
    here = of_zone(first.contact, zone)
    pieces = [piece for piece in pieces_of(first.contact, touching) if here[piece.index[0]]]
    largest = np.max([np.maximum(it.solution.pressure, 0.0) for it in results.values()], axis=0)
    for order, piece in enumerate(pieces):
        axes.fill_between(
            piece.arc, largest[piece.index], color=GREY, alpha=0.18, linewidth=0, zorder=1,
            label=None if order or len(results) == 1 else ENVELOPE,
        )  # fmt: skip
    for order, (name, result) in enumerate(results.items()):
        color = PIECE_COLOURS[order % len(PIECE_COLOURS)]
        width = 1.4 + 3.6 * (1 - (order + 1) / len(results))  # so that each of equal curves is seen
        for number, piece in enumerate(pieces):
            label, dashes = None if number else short_label(name, 30), DASHES[number % len(DASHES)]
            pressure = result.solution.pressure[piece.index]
            axes.plot(piece.arc, pressure, color=color, linestyle=dashes, linewidth=width, label=label)
    if len(pieces) > 1:
        labels = [f"{DASHES[number % len(DASHES)]}: {piece.label}" for number, piece in enumerate(pieces)]
        axes.set_title("; ".join(labels), loc="left", fontsize=9, color=GREY)
    elif zone is not None:
        axes.set_title(short_label(zone, 40), loc="left", fontsize=10)
    axes.axhline(0, color=GREY, linewidth=0.8)
    axes.spines[["top", "right"]].set_visible(False)
    name_axis(axes.xaxis, distance_label(first.contact, pieces))
    name_axis(axes.yaxis, labeled("pressure", units_of(first.contact).stress) + "\nper undeformed length")
    show_around(axes, pieces, [*results.values()], largest)
    axes.legend(frameon=False, fontsize=8.5, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    infinite = [name for name in cases.infinite if zone is None or zone in results[name].accuracy.infinite]
    if infinite:
        tops = (
            ceiling(it.contact, it.solution.pressure, it.accuracy.infinite)
            or 1.18 * float(it.solution.pressure[here].max(initial=0.0))
            for it in results.values()
        )
        zones = dict.fromkeys(name for it in results.values() for name in it.accuracy.infinite if zone in (None, name))
        cut_off(axes, max(tops), [*zones])
