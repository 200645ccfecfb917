"""The picture of a result: contact, deformed shape, pressure and gap."""

from collections.abc import Callable, Iterator, Sequence
from textwrap import wrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpecBase

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
    RoundTicks,
    ceiling,
    cut_words,
    distance_label,
    labeled,
    name_axis,
    new_page,
    only_around,
    pieces_of,
    plain,
    settle,
    short_label,
    wrapped,
)
from bemcontact.report.figures.zone_bars import closed_zones, draw_zone_bars
from bemcontact.report.formatting import with_unit
from bemcontact.report.verdicts import Verdict, in_short, overall, result_verdicts

WIDE, STACKED = 1.6, 2.4
"""Width over height from which a body is wide, and from which its pictures stand one above the other."""
ROW = 3.2
"""Inches of a row of curves."""
PANELS, LARGEST = 4, 3
"""Most contact zones of which each has panels of its own, and how many of more zones have."""
BAR = 0.22
"""Inches of a bar of one of many contacts."""
TALLEST = 6.2
"""Most inches of a picture of the bodies."""
BESIDE = np.array([1.0, 2.0])
"""Inches beside the pictures of contact and deformed shape, for labels and the scale of colors."""
NARROW = 0.15
"""Extent of the contact over that of its zone below which only the part around it is shown."""
WIDTHS = 1.0
"""Widths of the contact that are shown to either side of it, where it is small beside the zone."""
SHORT = 26
"""Letters of a line of a legend below which two stand side by side."""
FEW = 40
"""Points of a piece up to which their dots have full size."""
CLOSED = 1e-9
"""Gap over the displacement scale that is round-off."""


def figure_of_result(result: Result, stress: StressMeasure = StressMeasure.VON_MISES) -> Figure:
    """Compose a page with contact, stress on the deformed shape, where the body is known, and pressure and gap.

    Each of a few zones has a row of its own, with a close-up if its contact is small beside the body. Of many zones
    those with the largest forces and with the largest pressure have one; bars show the largest pressure and the force
    of each, and a line says which are drawn.
    """
    state, zones = result.boundary, result.contact.zone_names
    rows, near = panels_of([result]), close_ups(result)
    names = [zones[0] if zone is None and len(zones) == 1 else zone for zone in rows]
    columns = 3 if any(name in near for name in names) else 2
    inches, bars = 14 if columns == 3 else 12, len(zones) > PANELS
    wide = state is not None and body_extent(state)[0] > STACKED * body_extent(state)[1]
    plans, below = (0 if state is None else 2 if wide else 1), ([0.9 + BAR * len(closed_zones(result))] if bars else [])
    figure = new_page(inches, ROW)
    grid = figure.add_gridspec(plans + len(below) + len(rows), 6)
    title = f"{wrapped(result.contact.name, 6 * inches)}: {result.solution.formulation}"
    heights, writers = list[float](), list[Callable[[], None]]()
    if plans:
        side = None if wide else grid[0, :].subgridspec(1, 3)
        places = [grid[0, :], grid[1, :]] if side is None else [side[0, 0], side[0, 1]]
        contact, shape = map(figure.add_subplot, places)
        contact.set_title("contact pressure, displacements to scale", loc="left", fontsize=10)
        writers.append(sketch_contact(contact, result))
        draw_deformed(shape, result, stress)
        heights, inches = _fit([contact, shape], side, inches, 11.0 if columns == 3 else 9.5)
    if bars:
        peaks = figure.add_subplot(grid[plans, :3])
        draw_zone_bars(peaks, result, "peak")
        forces = figure.add_subplot(grid[plans, 3:], sharey=peaks)
        draw_zone_bars(forces, result, "force")
        name_axis(forces.xaxis, f"{forces.get_xlabel()}\n{drawn_near([result])}".rstrip())
    for row, (zone, name) in enumerate(zip(rows, names, strict=True), plans + len(below)):
        if name is not None and name in near:
            closer = figure.add_subplot(grid[row, :2])
            closer.set_title(f"{short_label(name, 30)}: close-up", loc="left", fontsize=10)
            writers.append(sketch_contact(closer, result, name, stress=stress))
        left, right = (slice(2, 4), slice(4, 6)) if name in near else (slice(0, 3), slice(3, 6))
        pressure = figure.add_subplot(grid[row, left])
        draw_pressure(pressure, result, zone)
        draw_gap(figure.add_subplot(grid[row, right], sharex=pressure), result, zone)
    heights += [*below, *len(rows) * [ROW]]
    grid.set_height_ratios(heights)
    figure.set_size_inches(inches, sum(heights) + 0.8)
    entitle(figure, title, result_verdicts(result), int(9 * inches))
    if writers:
        settle(figure.axes[0])
    for write in writers:
        write()  # the last ones: labels are placed on the page as it is laid out
    return figure


def panels_of(results: Sequence[Result]) -> list[str | None]:
    """Zones that have panels of their own: each of a few, of many the `largest_zones`; None for all."""
    zones = results[0].contact.zone_names
    if len(zones) <= PANELS:
        return [*zones] if len(zones) > 1 else [None]
    return [*largest_zones(results)] or [None]


def largest_zones(results: Sequence[Result]) -> list[str]:
    """Zones with the largest forces of all results, and that with the largest pressure; none without contact."""
    zones, peaks = results[0].contact.zone_names, dict[str, float]()
    forces = {zone: max(float(np.hypot(*result.footprint.forces[zone])) for result in results) for zone in zones}
    for order, zone in enumerate(zones):
        infinite = any(zone in result.accuracy.infinite for result in results)
        own = results[0].contact.zone == order
        peaks[zone] = np.inf if infinite else max(float(it.solution.pressure[own].max()) for it in results)
    most = sorted((zone for zone in zones if forces[zone] > 0), key=lambda zone: -forces[zone])[:LARGEST]
    highest = max(zones, key=lambda zone: (peaks[zone], zone in most))
    return [zone for zone in zones if zone in most or (most and zone == highest)]


def drawn_near(results: Sequence[Result]) -> str:
    """Write which of many contacts have panels of their own; nothing if all have."""
    zones, shown = results[0].contact.zone_names, panels_of(results)
    if len(zones) <= PANELS or None in shown:
        return ""
    forces = [max(float(np.hypot(*result.footprint.forces[zone])) for result in results) for zone in zones]
    why = "the others do not touch"
    if len(shown) < sum(force > 0 for force in forces):
        why = f"the {LARGEST} with the largest forces" + ", and that with the largest pressure" * (len(shown) > LARGEST)
    return f"drawn near: {len(shown)} of {len(zones)} contacts, {why}"


def _fit(plans: Sequence[Axes], side: GridSpecBase | None, inches: float, least: float) -> tuple[list[float], float]:
    """Inches of the rows of two plans, and of the page, at which what they show fills them.

    Plans one above the other get the same horizontal limits; those `side` by side get widths, and the page may be less
    wide, down to the `least`.
    """
    spans = np.array([[np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())] for axes in plans])
    if side is None:
        low, high = min(axes.get_xlim()[0] for axes in plans), max(axes.get_xlim()[1] for axes in plans)
        for axes in plans:
            axes.set_xlim(low, high)
        return [float(np.clip((inches - 2.4) * up / (high - low) + 1.3, 1.9, TALLEST)) for up in spans[:, 1]], inches
    over = spans[:, 0] / spans[:, 1]
    row = float(np.clip((inches - BESIDE.sum()) / over.sum() + 1.3, 2.6, TALLEST))
    widths = (row - 1.3) * over + BESIDE
    side.set_width_ratios([*widths, max(least - widths.sum(), 0.01)])
    return [row], float(np.clip(widths.sum(), least, inches))


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
    top = ceiling(contact, pressure, infinite)
    _draw_along(axes, result, pressure, zone, "" if top is None else cut_words(infinite))
    name_axis(axes.yaxis, labeled("pressure", units_of(contact).stress) + "\nper undeformed length")
    axes.set_ylim(top=1.18 * float(pressure.max(initial=0.0)) or 1.0)
    if top is not None:
        axes.set_ylim(-0.05 * top, top)
    if not pressure.any():
        axes.text(0.5, 0.5, "no contact pressure", transform=axes.transAxes, ha="center", color=BLACK)
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
    gap = result.contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)
    gap = np.where(np.abs(gap) <= CLOSED * scale, 0.0, gap)
    gap = np.where(of_zone(result.contact, zone), gap, 0.0)
    _draw_along(axes, result, gap, zone)
    name_axis(axes.yaxis, labeled("gap", units_of(result.contact).length))
    label_closed(axes, float(np.abs(gap).max(initial=0.0)), scale)


def label_closed(axes: Axes, widest: float, scale: float) -> None:
    """Write that all gaps are closed, and leave room, where the widest is round-off beside the scale."""
    if widest <= CLOSED * scale:
        axes.set_ylim(-0.1 * scale, scale)
        axes.text(0.5, 0.5, "closed everywhere", transform=axes.transAxes, ha="center", color=BLACK)


def of_zone(contact: CondensedContact, zone: str | None) -> BoolArray:
    """Which points (n,) belong to a zone; all if there is none."""
    return np.isin(contact.zone, [i for i, name in enumerate(contact.zone_names) if zone in (None, name)])


def _draw_along(axes: Axes, result: Result, values: Array, zone: str | None, note: str = "") -> None:
    """Draw values (n,) along each piece of a zone, with dots: full where there is contact, empty where it is open.

    The later of two equal curves is the thinner one and interrupted, so that both are seen. Above the axes stand the
    name of the zone, the note, and below them what the curves are.
    """
    contact, touching = result.contact, result.touching
    axes.axhline(0, color=GREY, linewidth=0.8, zorder=1)
    pieces = [piece for piece in pieces_of(contact, touching) if of_zone(contact, zone)[piece.index[0]]]
    for rank, piece in enumerate(pieces):
        s, along, color = piece.arc, values[piece.index], piece.color
        width = 1.5 * (2 - (rank + 1) / len(pieces))
        dot = 8 * width**2 * min(1.0, FEW / len(s))
        axes.plot(
            s,
            along,
            color=color,
            linewidth=width,
            linestyle="dashed" if rank else "solid",
            zorder=2,
            label=piece.label if touching[piece.index].any() else None,
        )
        axes.fill_between(s, along, color=color, alpha=0.12, linewidth=0, zorder=1)
        faces = np.where(touching[piece.index], color, "white")
        axes.scatter(s, along, s=dot, c=faces, edgecolors=color, linewidths=1.0, zorder=3)
    colors = {contact.zone_names[int(contact.zone[piece.index[0]])]: piece.color for piece in pieces}
    for name, ends in intervals_on(pieces, result):
        axes.hlines(0, *ends, color=colors[name], linewidth=3 + 3 * list(colors)[::-1].index(name), zorder=2)
    name_axis(axes.xaxis, distance_label(contact, pieces))
    axes.spines[["top", "right"]].set_visible(False)
    axes.xaxis.set_major_locator(RoundTicks(7))
    show_around(axes, pieces, [result], values)
    heading = "\n".join(filter(None, ["" if zone is None else short_label(zone, 40), note]))
    handles, labels = axes.get_legend_handles_labels()
    if len(pieces) == 1 or not handles:
        axes.set_title(heading, loc="left", fontsize=10)
        return
    if zone is not None:  # which is named above
        labels = [label.replace(f"{short_label(zone, 24)} (", "from (") for label in labels]
    axes.legend(
        handles, labels, title=heading or None, title_fontsize=10, alignment="left", frameon=False, fontsize=9,
        loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2 if max(map(len, labels)) < SHORT else 1,
        borderpad=0, borderaxespad=0.6,
    )  # fmt: skip


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
    if not 0 < high - low < NARROW * (end - start):
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
    name_axis(axes.xaxis, only_around(axes.get_xlabel()))
