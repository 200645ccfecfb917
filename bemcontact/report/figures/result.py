"""The page of a result or of several load cases: contact, pressure, gap, deformed shape, peaks."""

from collections.abc import Iterator, Sequence
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.arrays import Array, BoolArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.report.bars import with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import LEVEL
from bemcontact.report.figures.contact import body_extent, draw_contact, draw_deformed
from bemcontact.report.figures.page import (
    BLACK,
    GREY,
    PIECE_COLOURS,
    QUALITY_COLOURS,
    Piece,
    ceiling,
    cut_off,
    distance_label,
    labeled,
    new_page,
    pieces_of,
    plain,
    round_ticks,
    short_label,
    wrapped,
)
from bemcontact.report.formatting import with_unit
from bemcontact.report.verdicts import Verdict, case_verdicts, in_short, overall, result_verdicts

PANELS = 4
"""Most contact zones that have panels of their own."""
NARROW = 0.15
"""Extent of the contact over that of its zone below which only the part around it is shown."""
WIDTHS = 1.0
"""Widths of the contact that are shown to either side of it, where it is small beside the zone."""
AROUND = "only around the contact"
CLOSED = 1e-9
"""Gap over the displacement scale that is round-off."""


def figure_of_result(result: Result) -> Figure:
    """Compose a page with pressure and gap and, where the body is known, its contact and its deformed shape.

    Each of a few zones has its own panels, so that small pressures are seen.
    """
    state, zones = result.boundary, result.contact.zone_names
    panels, plans = zones if 1 < len(zones) <= PANELS else (None,), 0
    if state is None:
        inches, figure, contact = 12, new_page(12, 1.0 + 3.2 * len(panels)), None
        grid = figure.add_gridspec(len(panels), 2)
        places = [(figure.add_subplot(grid[row, 0]), grid[row, 1]) for row in range(len(panels))]
    else:
        width, height = body_extent(state)
        plans = 2 if width > 1.6 * height else 1
        inches, figure = 12, new_page(12, (6.3 if plans == 2 else 4.8) + 3.2 * len(panels))
        ratios = [*(plans * [1.0 if plans == 2 else 1.5]), *(len(panels) * [1.0])]
        grid = figure.add_gridspec(plans + len(panels), 2, height_ratios=ratios)
        contact = figure.add_subplot(grid[0, :] if plans == 2 else grid[0, 0])
        contact.set_title("contact pressure, displacements to scale", loc="left", fontsize=10)
        places = [(figure.add_subplot(grid[row, 0]), grid[row, 1]) for row in range(plans, plans + len(panels))]
    for (pressure, beside), zone in zip(places, panels, strict=True):
        draw_pressure(pressure, result, zone)
        draw_gap(figure.add_subplot(beside, sharex=pressure), result, zone)
    if state is not None:
        draw_deformed(figure.add_subplot(grid[1, :] if plans == 2 else grid[0, 1]), result)
    title = f"{wrapped(result.contact.name, 6 * inches)}: {result.solution.formulation}"
    _entitle(figure, title, result_verdicts(result), 9 * inches)
    if contact is not None:
        draw_contact(contact, result)  # the last one: labels are placed on the page as it is laid out
    return figure


def _entitle(figure: Figure, title: str, of_it: Sequence[Verdict], columns: int) -> None:
    """Write a title with both verdicts in short, in the color of their quality."""
    short = "\n".join(wrap(in_short(of_it), columns))
    color = QUALITY_COLOURS[overall(of_it)]
    figure.suptitle(f"{title}; {short}", x=0.01, ha="left", fontweight="bold", color=color, wrap=True)


def draw_pressure(axes: Axes, result: Result, zone: str | None = None) -> None:
    """Draw the contact pressure, per undeformed length, over the distance along one contact zone, or along each.

    An infinite pressure is cut off at three times the mean one.
    """
    contact, infinite = result.contact, [name for name in result.accuracy.infinite if zone in (None, name)]
    pressure = np.where(_of_zone(contact, zone), result.solution.pressure, 0.0)
    _draw_along(axes, result, pressure, zone)
    axes.set_ylabel(labeled("pressure", units_of(contact).stress) + "\nper undeformed length")
    axes.set_ylim(top=1.18 * float(pressure.max(initial=0.0)) or 1.0)
    if (top := ceiling(contact, pressure, infinite)) is not None:
        cut_off(axes, top, infinite)
    if infinite or not pressure.any():
        return
    highest = np.flatnonzero(pressure >= (1 - LEVEL) * pressure.max())
    peak = int(highest[len(highest) // 2])
    piece = next(piece for piece in pieces_of(contact, result.touching) if peak in piece.index)
    s, (low, high) = float(piece.arc[list(piece.index).index(peak)]), axes.get_xlim()
    side = "left" if s < low + 0.3 * (high - low) else "right" if s > high - 0.3 * (high - low) else "center"
    value = with_unit(with_bar(float(pressure.max()), result.accuracy.peak_bar(zone)), plain(units_of(contact).stress))
    axes.annotate(
        f"peak {value}", (s, pressure[peak]), xytext=({"left": 5, "right": -5}.get(side, 0), 7),
        textcoords="offset points", ha=side, color=BLACK,
    )  # fmt: skip


def draw_gap(axes: Axes, result: Result, zone: str | None = None) -> None:
    """Draw the gap over the distance along one contact zone, or along each; round-off is drawn as closed."""
    scale = result.contact.scales.displacement
    gap = np.where(np.abs(gap := _gap(result)) <= CLOSED * scale, 0.0, gap)
    gap = np.where(_of_zone(result.contact, zone), gap, 0.0)
    _draw_along(axes, result, gap, zone)
    axes.set_ylabel(labeled("gap", units_of(result.contact).length))
    label_closed(axes, float(np.abs(gap).max(initial=0.0)), scale)


def label_closed(axes: Axes, widest: float, scale: float) -> None:
    """Write that all gaps are closed, and leave room, where the widest is round-off beside the scale."""
    if widest <= CLOSED * scale:
        axes.set_ylim(-0.1 * scale, scale)
        axes.text(0.5, 0.5, "closed everywhere", transform=axes.transAxes, ha="center", color=BLACK)


def _of_zone(contact: CondensedContact, zone: str | None) -> BoolArray:
    """Which points (n,) belong to a zone; all if there is none."""
    return np.isin(contact.zone, [i for i, name in enumerate(contact.zone_names) if zone in (None, name)])


def _draw_along(axes: Axes, result: Result, values: Array, zone: str | None) -> None:
    """Draw values (n,) along each piece of a zone, with dots: full where there is contact, empty where it is open.

    The later of two equal curves is the thinner one and interrupted, so that both are seen.
    """
    contact, touching = result.contact, result.touching
    axes.axhline(0, color=GREY, linewidth=0.8, zorder=1)
    pieces = [piece for piece in pieces_of(contact, touching) if _of_zone(contact, zone)[piece.index[0]]]
    for rank, piece in enumerate(pieces):
        s, along, color = piece.arc, values[piece.index], piece.color
        width = 1.5 * (2 - (rank + 1) / len(pieces))
        axes.plot(
            s,
            along,
            color=color,
            linewidth=width,
            linestyle="dashed" if rank else "solid",
            zorder=2,
            label=piece.label,
        )
        axes.fill_between(s, along, color=color, alpha=0.12, linewidth=0, zorder=1)
        faces = np.where(touching[piece.index], color, "white")
        axes.scatter(s, along, s=8 * width**2, c=faces, edgecolors=color, linewidths=1.0, zorder=3)
    colors = {contact.zone_names[int(contact.zone[piece.index[0]])]: piece.color for piece in pieces}
    intervals = [*intervals_on(pieces, result)]
    for name, ends in intervals:
        axes.hlines(0, *ends, color=colors[name], linewidth=3 + 3 * list(colors)[::-1].index(name), zorder=2)
    axes.set_xlabel(distance_label(contact, pieces))
    axes.spines[["top", "right"]].set_visible(False)
    axes.xaxis.set_major_locator(round_ticks(7))
    _zoom(axes, pieces, [ends for _, ends in intervals], values)
    if zone is not None:
        axes.set_title(
            short_label(zone, 40), loc="left", fontsize=10, pad=16 if zone in result.accuracy.infinite else 6
        )
    if len(pieces) > 1:
        axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize=9)


def intervals_on(pieces: Sequence[Piece], result: Result) -> Iterator[tuple[str, tuple[float, float]]]:
    """Zone and ends of each interval of contact on pieces, in their arc positions."""
    by_run = {piece.run: piece for piece in pieces}
    for interval in result.footprint.intervals:
        if interval.run in by_run:
            start = by_run[interval.run].place_of(interval.start_arc, interval.perimeter)
            yield interval.zone, (start, start + interval.end_arc - interval.start_arc)


def window_around(pieces: Sequence[Piece], intervals: Sequence[tuple[float, float]]) -> tuple[float, float] | None:
    """Arc positions about a contact that is small beside its pieces of boundary; None if it is not."""
    start, end = min(piece.arc[0] for piece in pieces), max(piece.arc[-1] for piece in pieces)
    low = min((begin for begin, _ in intervals), default=start)
    high = max((finish for _, finish in intervals), default=end)
    if high - low >= NARROW * (end - start):
        return None
    air = WIDTHS * (high - low)
    return max(low - air, start), min(high + air, end)


def _zoom(axes: Axes, pieces: Sequence[Piece], intervals: Sequence[tuple[float, float]], values: Array) -> None:
    """Show only what lies about a contact that is small beside its pieces of boundary, and say so."""
    window = window_around(pieces, intervals)
    if window is None:
        return
    shown = np.concatenate(
        [np.interp(np.linspace(*window, 200), piece.arc, values[piece.index], left=0, right=0) for piece in pieces]
    )
    axes.set(xlim=window, ylim=(-0.05 * shown.max() or None, 1.1 * shown.max() or None))
    axes.set_xlabel(f"{axes.get_xlabel()}\n{AROUND}")


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
    first, touching = next(iter(cases.results.values())), np.any([it.touching for it in cases.results.values()], axis=0)
    pieces = [*pieces_of(first.contact, touching)]
    for order, (name, result) in enumerate(cases.results.items()):
        color = PIECE_COLOURS[order % len(PIECE_COLOURS)]
        width = 2.2 if order < len(PIECE_COLOURS) else 1.2
        for piece in pieces:
            label, dashes = None if piece.order else short_label(name, 30), DASHES[piece.order % len(DASHES)]
            pressure = result.solution.pressure[piece.index]
            axes.plot(piece.arc, pressure, color=color, linestyle=dashes, linewidth=width, label=label)
    labels = [f"{DASHES[piece.order % len(DASHES)]}: {piece.label}" for piece in pieces]
    if len(labels) > 1:
        axes.set_title("; ".join(labels), loc="left", fontsize=9, color=GREY)
    axes.axhline(0, color=GREY, linewidth=0.8)
    axes.set_xlabel(distance_label(first.contact, pieces))
    axes.set_ylabel(labeled("pressure", units_of(first.contact).stress) + "\nper undeformed length")
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
    colors = [PIECE_COLOURS[order % len(PIECE_COLOURS)] for order in range(len(peaks))]
    bars = axes.barh([short_label(name, 30) for name in cases.results], peaks, color=colors)
    axes.bar_label(bars, labels, padding=3)
    for bar, name in zip(bars, cases.results, strict=True):
        bar.set(hatch="//" if name in cases.infinite else None, alpha=0.5 if name in cases.infinite else 1.0)
    if not any(finite.values()) and cases.infinite:
        axes.set_xticks([])
    axes.margins(x=0.12)
    axes.invert_yaxis()
    axes.set_xlabel(labeled("peak pressure", units_of(first.contact).stress))
