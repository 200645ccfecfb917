"""The picture of a result: contact, deformed shape, pressure and gap."""

from collections.abc import Iterator, Sequence
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array, BoolArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.options import StressMeasure
from bemcontact.report.bars import with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import LEVEL
from bemcontact.report.figures.contact import body_extent, close_ups, sketch_contact
from bemcontact.report.figures.deformed import draw_deformed
from bemcontact.report.figures.page import (
    BLACK,
    GREY,
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
from bemcontact.report.figures.symbols import settle
from bemcontact.report.formatting import with_unit
from bemcontact.report.verdicts import Verdict, in_short, overall, result_verdicts

WIDE = 1.6
"""Width over height of a body from which its pictures stand one above the other."""
ROW = 3.2
"""Inches of a row of curves."""
PANELS = 4
"""Most contact zones that have panels of their own."""
NARROW = 0.15
"""Extent of the contact over that of its zone below which only the part around it is shown."""
WIDTHS = 1.0
"""Widths of the contact that are shown to either side of it, where it is small beside the zone."""
AROUND = "only around the contact"
CLOSED = 1e-9
"""Gap over the displacement scale that is round-off."""


def figure_of_result(result: Result, stress: StressMeasure = StressMeasure.VON_MISES) -> Figure:
    """Compose a page with contact, stress on the deformed shape, where the body is known, and pressure and gap.

    Each of a few zones has a row of its own, with a close-up if its contact is small beside the body.
    """
    state, zones = result.boundary, result.contact.zone_names
    rows, near = zones if 1 < len(zones) <= PANELS else (None,), close_ups(result)
    columns = 3 if near and (rows[0] is not None or len(zones) == 1) else 2
    inches = 14 if columns == 3 else 12
    plans, heights = 0, list[float]()
    if state is not None:
        width, height = body_extent(state)
        plans = 2 if width > WIDE * height else 1
        heights = plans * [float(np.clip((1.0 if plans == 2 else 0.45) * inches * height / width + 1.0, 2.2, 4.6))]
    figure = new_page(inches, sum(heights) + 0.8 + ROW * len(rows))
    grid = figure.add_gridspec(plans + len(rows), 6, height_ratios=[*heights, *len(rows) * [ROW]])
    contact = figure.add_subplot(grid[0, :] if plans == 2 else grid[0, :3]) if plans else None
    closer = dict[str, Axes]()
    for row, zone in enumerate(rows, plans):
        name = zones[0] if zone is None else zone
        if columns == 3 and name in near:
            closer[name] = figure.add_subplot(grid[row, :2])
        thirds = (slice(2, 4), slice(4, 6)) if columns == 3 else (slice(0, 3), slice(3, 6))
        pressure = figure.add_subplot(grid[row, thirds[0]])
        draw_pressure(pressure, result, zone)
        draw_gap(figure.add_subplot(grid[row, thirds[1]], sharex=pressure), result, zone)
    if plans:
        draw_deformed(figure.add_subplot(grid[1, :] if plans == 2 else grid[0, 3:]), result, stress)
    title = f"{wrapped(result.contact.name, 6 * inches)}: {result.solution.formulation}"
    entitle(figure, title, result_verdicts(result), 9 * inches)
    if contact is not None:
        contact.set_title("contact pressure, displacements to scale", loc="left", fontsize=10)
        for name, axes in closer.items():
            axes.set_title(f"{short_label(name, 30)}: close-up", loc="left", fontsize=10)
        writers = [sketch_contact(contact, result)]
        writers += [sketch_contact(axes, result, name, stress=stress) for name, axes in closer.items()]
        settle(contact)
        for write in writers:
            write()  # the last ones: labels are placed on the page as it is laid out
    return figure


def entitle(figure: Figure, title: str, of_it: Sequence[Verdict], columns: int) -> None:
    """Write a title with both verdicts in short, in the color of their quality."""
    short = "\n".join(wrap(in_short(of_it), columns))
    color = QUALITY_COLOURS[overall(of_it)]
    figure.suptitle(f"{title}; {short}", x=0.01, ha="left", fontweight="bold", color=color, wrap=True)


def draw_pressure(axes: Axes, result: Result, zone: str | None = None) -> None:
    """Draw the contact pressure, per undeformed length, over the distance along one contact zone, or along each.

    An infinite pressure is cut off at three times the mean one.
    """
    contact, infinite = result.contact, [name for name in result.accuracy.infinite if zone in (None, name)]
    pressure = np.where(of_zone(contact, zone), result.solution.pressure, 0.0)
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
    gap = np.where(of_zone(result.contact, zone), gap, 0.0)
    _draw_along(axes, result, gap, zone)
    axes.set_ylabel(labeled("gap", units_of(result.contact).length))
    label_closed(axes, float(np.abs(gap).max(initial=0.0)), scale)


def label_closed(axes: Axes, widest: float, scale: float) -> None:
    """Write that all gaps are closed, and leave room, where the widest is round-off beside the scale."""
    if widest <= CLOSED * scale:
        axes.set_ylim(-0.1 * scale, scale)
        axes.text(0.5, 0.5, "closed everywhere", transform=axes.transAxes, ha="center", color=BLACK)


def of_zone(contact: CondensedContact, zone: str | None) -> BoolArray:
    """Which points (n,) belong to a zone; all if there is none."""
    return np.isin(contact.zone, [i for i, name in enumerate(contact.zone_names) if zone in (None, name)])


def _draw_along(axes: Axes, result: Result, values: Array, zone: str | None) -> None:
    """Draw values (n,) along each piece of a zone, with dots: full where there is contact, empty where it is open.

    The later of two equal curves is the thinner one and interrupted, so that both are seen.
    """
    contact, touching = result.contact, result.touching
    axes.axhline(0, color=GREY, linewidth=0.8, zorder=1)
    pieces = [piece for piece in pieces_of(contact, touching) if of_zone(contact, zone)[piece.index[0]]]
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
    for name, ends in intervals_on(pieces, result):
        axes.hlines(0, *ends, color=colors[name], linewidth=3 + 3 * list(colors)[::-1].index(name), zorder=2)
    axes.set_xlabel(distance_label(contact, pieces))
    axes.spines[["top", "right"]].set_visible(False)
    axes.xaxis.set_major_locator(round_ticks(7))
    show_around(axes, pieces, [result], values)
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


def show_around(axes: Axes, pieces: Sequence[Piece], results: Sequence[Result], values: Array) -> None:
    """Show only what lies about the contacts of results, if they are small beside the pieces of boundary; say so."""
    window = window_around(pieces, [ends for result in results for _, ends in intervals_on(pieces, result)])
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
