"""The pictures for the page of a result or of all load cases, and the one picture of either."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.options import StressMeasure
from bemcontact.report.figures.contact import body_extent, close_ups, draw_contact
from bemcontact.report.figures.deformed import draw_deformed
from bemcontact.report.figures.load_cases import (
    draw_case_contacts,
    draw_case_pressures,
    draw_case_stresses,
    figure_of_cases,
    grid_of,
    places_of,
    shown_cases,
)
from bemcontact.report.figures.mesh_study import plan_of
from bemcontact.report.figures.page import new_page
from bemcontact.report.figures.result import BAR, PANELS, draw_gap, draw_pressure, figure_of_result, panels_of
from bemcontact.report.figures.zone_bars import closed_zones, draw_zone_bars

WIDTH = 5.4
"""Inches of a picture on a page: its text can be read on a telephone, and two stand side by side."""
DOUBLE = 1.8 * WIDTH
"""Inches of a wide picture, which has the whole width of a page."""


def figure_of(results: Result | CaseResults, stress: StressMeasure = StressMeasure.VON_MISES) -> Figure:
    """Compose the page of a result, or of the results of all load cases, with contours of a stress."""
    return figure_of_result(results, stress) if isinstance(results, Result) else figure_of_cases(results, stress)


def pictures_of(results: Result | CaseResults, stress: StressMeasure = StressMeasure.VON_MISES) -> dict[str, Figure]:
    """Make the pictures for the page of a result or of all load cases, by name.

    Names are "problem", "contact" or "contacts", and "deformed" (if a body is known), and for each zone "pressure-1",
    and of a result "gap-1", and "contact-1" if it needs a close-up. Of many zones those that `drawn_near` names
    have such pictures, and "forces" shows all of a result.
    """
    first = results if isinstance(results, Result) else next(iter(results.results.values()))
    figures, near = dict[str, Figure](), [] if isinstance(results, CaseResults) else close_ups(results)
    if first.problem is not None:
        figures["problem"] = plan_of(first.problem)
    if isinstance(results, CaseResults):
        if shown_cases(results):
            figures["contacts"] = figure_of_contacts(results)
            figures["deformed"] = figure_of_stresses(results, stress)
    elif first.boundary is not None:
        figures["contact"], axes = _page(first)
        draw_contact(axes, first)
        figures["deformed"], axes = _page(first)
        draw_deformed(axes, first, stress)
    zones = [*first.contact.zone_names]
    if isinstance(results, Result) and len(zones) > PANELS:
        figures["forces"] = new_page(DOUBLE, 0.9 + BAR * len(closed_zones(first)))
        peaks, forces = figures["forces"].subplots(1, 2, sharey=True)
        draw_zone_bars(peaks, results, "peak")
        draw_zone_bars(forces, results, "force")
    panels = panels_of([results] if isinstance(results, Result) else [*results.results.values()])
    numbers = [f"-{zones.index(zone or zones[0]) + 1}" if zone or len(zones) == 1 else "" for zone in panels]
    for zone, number in zip(panels, numbers, strict=True):
        if (zone or zones[0]) in near and number:
            figures[f"contact{number}"], axes = _page()
            draw_contact(axes, first, zone or zones[0], stress=stress)
    for zone, number in zip(panels, numbers, strict=True):
        figures[f"pressure{number}"], axes = _page(height=3.6)
        if isinstance(results, CaseResults):
            draw_case_pressures(axes, results, zone)
            _legend_outside(axes)
            continue
        draw_pressure(axes, results, zone)
        figures[f"gap{number}"], axes = _page(height=3.6)
        draw_gap(axes, results, zone)
    return figures


def figure_of_contacts(cases: CaseResults) -> Figure:
    """Compose a picture with the contact of each load case alone."""
    shown = shown_cases(cases)
    return figure_of_states({name: cases.results[name] for name in shown})


def figure_of_states(results: Mapping[str, Result]) -> Figure:
    """Compose a picture with the contact of each of some results of a problem, by name."""
    figure, places = _small_multiples([*results.values()])
    draw_case_contacts(places, results)
    return figure


def figure_of_stresses(cases: CaseResults, stress: StressMeasure = StressMeasure.VON_MISES) -> Figure:
    """Compose a picture with the stress on the deformed shape of each load case alone."""
    shown = shown_cases(cases)
    figure, places = _small_multiples([cases.results[name] for name in shown])
    draw_case_stresses(places, cases, shown, stress)
    return figure


def _small_multiples(results: Sequence[Result]) -> tuple[Figure, list[Axes]]:
    """A page with axes for each result: as wide as other pictures for a few, or twice as wide."""
    count, first = len(results), results[0]
    inches = WIDTH if grid_of(count, first, WIDTH)[0] < 3 else DOUBLE
    columns, rows, height = grid_of(count, first, inches)
    figure = new_page(inches, rows * height)
    return figure, places_of(figure, count, rows, columns)


def _legend_outside(axes: Axes) -> None:
    """Move the legend below everything else on the page."""
    own, page = axes.get_legend(), axes.get_figure(root=True)
    if own is not None and page is not None:
        own.remove()
        page.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2, frameon=False, fontsize=8.5)


def _page(result: Result | None = None, height: float = 4.2) -> tuple[Figure, Axes]:
    """A picture for one axes; that of a long body is wide."""
    width = WIDTH
    if result is not None and result.boundary is not None:
        across, up = body_extent(result.boundary)
        width, height = (DOUBLE, 3.4) if across > 2.5 * up else (WIDTH, 4.4)
    figure = new_page(width, height)
    return figure, figure.add_subplot()
