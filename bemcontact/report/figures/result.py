"""The page of a result or of several load cases: contact, pressure, gap, deformed shape, peaks."""

from collections.abc import Sequence
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.report.facts import with_bar
from bemcontact.report.figures.contact import body_extent, draw_contact, draw_deformed
from bemcontact.report.figures.page import (
    BLACK,
    GREY,
    PIECE_COLOURS,
    QUALITY_COLOURS,
    ceiling,
    cut_off,
    labelled,
    new_page,
    pieces_of,
    plain,
    short_label,
    wrapped,
)
from bemcontact.report.formatting import units_of, with_unit
from bemcontact.report.verdicts import Verdict, case_verdicts, in_short, overall, result_verdicts

CLOSED = 1e-9
"""Gap over the displacement scale that is round-off."""


def figure_of_result(result: Result) -> Figure:
    """Compose a page with pressure and gap and, where the body is known, its contact and its deformed shape."""
    state = result.boundary
    if state is None:
        inches, figure, contact = 7, new_page(7, 7), None
        pressure = figure.add_subplot(2, 1, 1)
        gap = figure.add_subplot(2, 1, 2, sharex=pressure)
    else:
        width, height = body_extent(state)
        wide = width > 1.6 * height
        inches, figure = 12, new_page(12, 9.5 if wide else 9)
        grid = figure.add_gridspec(3, 2) if wide else figure.add_gridspec(2, 2)
        contact = figure.add_subplot(grid[0, :] if wide else grid[0, 0])
        contact.set_title("contact pressure, displacements to scale", loc="left", fontsize=10)
        pressure = figure.add_subplot(grid[1, 0] if wide else grid[0, 1])
        gap = figure.add_subplot(grid[1, 1], sharex=pressure)
        draw_deformed(figure.add_subplot(grid[2, :] if wide else grid[1, 0]), result)
    draw_pressure(pressure, result)
    draw_gap(gap, result)
    title = f"{wrapped(result.contact.name, 6 * inches)}: {result.solution.formulation}"
    _entitle(figure, title, result_verdicts(result), 9 * inches)
    if contact is not None:
        draw_contact(contact, result)  # the last one: labels are placed on the page as it is laid out
    return figure


def _entitle(figure: Figure, title: str, of_it: Sequence[Verdict], columns: int) -> None:
    """Write a title with both verdicts in short, in the colour of their quality."""
    short = "\n".join(wrap(in_short(of_it), columns))
    colour = QUALITY_COLOURS[overall(of_it)]
    figure.suptitle(f"{title}; {short}", x=0.01, ha="left", fontweight="bold", color=colour, wrap=True)


def draw_pressure(axes: Axes, result: Result) -> None:
    """Draw the contact pressure, per undeformed length, over the distance along each contact zone.

    An infinite pressure is cut off at three times the mean one.
    """
    pressure, contact, infinite = result.solution.pressure, result.contact, result.accuracy.infinite
    _draw_along(axes, result, pressure)
    axes.set_ylabel(labelled("pressure", units_of(contact).stress) + "\nper undeformed length")
    axes.set_ylim(top=1.18 * float(pressure.max(initial=0.0)) or 1.0)
    if (top := ceiling(contact, pressure, infinite)) is not None:
        cut_off(axes, top, infinite)
    peak = result.footprint.peak
    if peak is not None:
        nearest = int(np.argmin(np.hypot(*(contact.points - np.array(peak.at)).T)))
        s = float(contact.arc_position[nearest])
        low, high = axes.get_xlim()
        side = "left" if s < low + 0.15 * (high - low) else "right" if s > high - 0.15 * (high - low) else "center"
        value = with_bar(peak.pressure, result.accuracy.peak_bar())
        text = f"peak {with_unit(value, plain(units_of(contact).stress))}"
        axes.annotate(text, (s, peak.pressure), xytext=(0, 7), textcoords="offset points", ha=side, color=BLACK)


def draw_gap(axes: Axes, result: Result) -> None:
    """Draw the gap over the distance along each contact zone; round-off is drawn as closed."""
    scale = result.contact.scales.displacement
    gap = np.where(np.abs(gap := _gap(result)) <= CLOSED * scale, 0.0, gap)
    _draw_along(axes, result, gap)
    axes.set_ylabel(labelled("gap", units_of(result.contact).length))
    label_closed(axes, float(np.abs(gap).max(initial=0.0)), scale)


def label_closed(axes: Axes, widest: float, scale: float) -> None:
    """Write that all gaps are closed, and leave room, where the widest is round-off beside the scale."""
    if widest <= CLOSED * scale:
        axes.set_ylim(-0.1 * scale, scale)
        axes.text(0.5, 0.5, "closed everywhere", transform=axes.transAxes, ha="center", color=BLACK)


def _draw_along(axes: Axes, result: Result, values: Array) -> None:
    """Draw values (n,) along each piece, with full dots where there is contact and empty ones where it is open.

    The later of two equal curves is the thinner one and interrupted, so that both are seen.
    """
    contact, touching = result.contact, result.touching
    axes.axhline(0, color=GREY, linewidth=0.8, zorder=1)
    pieces = [*pieces_of(contact)]
    for piece in pieces:
        s, along, colour = contact.arc_position[piece.index], values[piece.index], piece.colour
        width = 1.5 * (2 - (piece.order + 1) / len(pieces))
        axes.plot(s, along, color=colour, linewidth=width, linestyle=piece.dashes, zorder=2, label=piece.label)
        axes.fill_between(s, along, color=colour, alpha=0.12, linewidth=0, zorder=1)
        faces = np.where(touching[piece.index], colour, "white")
        axes.scatter(s, along, s=8 * width**2, c=faces, edgecolors=colour, linewidths=1.0, zorder=3)
    colours = {contact.zone_names[int(contact.zone[piece.index[0]])]: piece.colour for piece in pieces}
    for interval in result.footprint.intervals:
        width = 3 + 3 * list(colours)[::-1].index(interval.zone)
        axes.hlines(0, interval.start_arc, interval.end_arc, color=colours[interval.zone], linewidth=width, zorder=2)
    axes.set_xlabel(labelled("distance along the contact zone", units_of(result.contact).length))
    axes.spines[["top", "right"]].set_visible(False)
    if len(pieces) > 1:
        axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize=9)


def _gap(result: Result) -> Array:
    """Gap (n,) recomputed from the pressure."""
    return result.contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)


INCHES = 9
DASHES = ("solid", "dashed", "dotted", "dashdot")
"""Line styles of unbroken pieces of boundary."""


def figure_of(results: Result | CaseResults) -> Figure:
    """Compose the page of a result, or of the results of all load cases."""
    return figure_of_result(results) if isinstance(results, Result) else figure_of_cases(results)


def figure_of_cases(cases: CaseResults) -> Figure:
    """Compose a page with the pressures and the peak pressures of all load cases."""
    figure = new_page(INCHES, 6)
    above, below = figure.subplots(2, 1, height_ratios=(3, 1))
    for axes in (above, below):
        axes.spines[["top", "right"]].set_visible(False)
    draw_case_pressures(above, cases)
    draw_case_peaks(below, cases)
    _entitle(figure, f"{wrapped(cases.name, 6 * INCHES)}: all load cases", case_verdicts(cases), 9 * INCHES)
    return figure


def draw_case_pressures(axes: Axes, cases: CaseResults) -> None:
    """Draw the contact pressure of each load case, per undeformed length, over the distance along each piece."""
    first = next(iter(cases.results.values()))
    for order, (name, result) in enumerate(cases.results.items()):
        contact, colour = result.contact, PIECE_COLOURS[order % len(PIECE_COLOURS)]
        width = 2.2 if order < len(PIECE_COLOURS) else 1.2
        for piece in pieces_of(contact):
            along, pressure = contact.arc_position[piece.index], result.solution.pressure[piece.index]
            label, dashes = None if piece.order else short_label(name, 30), DASHES[piece.order % len(DASHES)]
            axes.plot(along, pressure, color=colour, linestyle=dashes, linewidth=width, label=label)
    labels = [f"{DASHES[piece.order % len(DASHES)]}: {piece.label}" for piece in pieces_of(first.contact)]
    if len(labels) > 1:
        axes.set_title("; ".join(labels), loc="left", fontsize=9, color=GREY)
    axes.axhline(0, color=GREY, linewidth=0.8)
    axes.set_xlabel(labelled("distance along the contact zone", units_of(first.contact).length))
    axes.set_ylabel(labelled("pressure", units_of(first.contact).stress) + "\nper undeformed length")
    axes.legend(frameon=False, fontsize=8.5)
    if cases.infinite:
        tops = (
            ceiling(item.contact, item.solution.pressure, item.accuracy.infinite)
            or 1.18 * float(item.solution.pressure.max(initial=0.0))
            for item in cases.results.values()
        )
        zones = dict.fromkeys(zone for item in cases.results.values() for zone in item.accuracy.infinite)
        cut_off(axes, max(tops), [*zones])


def draw_case_peaks(axes: Axes, cases: CaseResults) -> None:
    """Draw a bar for the peak pressure of each load case; an infinite one goes beyond the frame."""
    first = next(iter(cases.results.values()))
    finite = {name: it.footprint.peak.pressure if it.footprint.peak else 0.0 for name, it in cases.results.items()}
    beyond = 2 * max(finite.values()) or 1.0
    peaks = [beyond if name in cases.infinite else peak for name, peak in finite.items()]
    bars_of_peaks = {name: it.accuracy.peak_bar() for name, it in cases.results.items()}
    labels = [
        "infinite" if name in cases.infinite else with_bar(peak, bars_of_peaks[name]) for name, peak in finite.items()
    ]
    colours = [PIECE_COLOURS[order % len(PIECE_COLOURS)] for order in range(len(peaks))]
    bars = axes.barh([short_label(name, 30) for name in cases.results], peaks, color=colours)
    axes.bar_label(bars, labels, padding=3)
    for bar, name in zip(bars, cases.results, strict=True):
        bar.set(hatch="//" if name in cases.infinite else None, alpha=0.5 if name in cases.infinite else 1.0)
    if not any(finite.values()) and cases.infinite:
        axes.set_xticks([])
    axes.margins(x=0.12)
    axes.invert_yaxis()
    axes.set_xlabel(labelled("peak pressure", units_of(first.contact).stress))
