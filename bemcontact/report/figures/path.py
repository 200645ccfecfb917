"""The picture of a load path: peak, resultant and ends of contact over the parameter."""

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from bemcontact.arrays import Array
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.problems import Problem
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.mesh_study import plan_of
from bemcontact.report.figures.page import (
    BLACK,
    CYCLE,
    QUALITY_COLOURS,
    VERMILION,
    Piece,
    ceiling,
    labeled,
    name_axis,
    new_page,
    pieces_of,
    plain,
    short_label,
)
from bemcontact.report.formatting import number
from bemcontact.report.path_text import path_verdicts
from bemcontact.report.verdicts import in_short, overall

WIDTH, HEIGHT = 5.6, 2.5
"""Inches of each picture."""
PANELS = 8
"""Number of states whose pressure is drawn."""
ROOM = 0.25
"""Room beside the contact in pictures of states, over its extent."""
ROUND_OFF = 1e-12
"""Share of the largest force, or moment, that pressures could have, which is no result."""
SEEN = 0.2
"""Share of the height of a panel from which on a pressure is seen well."""
MOST_WIDE = 5.0
"""Largest width of a line."""
SHADE = 0.15
"""Opacity of stretches in contact."""


def figure_of_path(path: ParameterPath) -> Figure:
    """Draw peak pressure, resultants and ends of contact of each zone over the parameter; dots are breakpoints."""
    zones = path.contact.zone_names
    figure = new_page(WIDTH, HEIGHT * (2 + len(zones)))
    peaks, forces, *ends = figure.subplots(2 + len(zones), 1, sharex=True)
    draw_peaks(peaks, path)
    draw_resultants(forces, path)
    for axes, zone in zip(ends, zones, strict=True):
        draw_interval_ends(axes, path, zone)
    for axes in (peaks, forces, *ends):
        axes.spines[["top", "right"]].set_visible(False)
    name_axis(ends[-1].xaxis, short_label(path.key, 60))
    of_it = [*path_verdicts(path)]
    at = [*(f"at {number(value)}: " for value in (path.start, path.end)), *[""] * (len(of_it) - 3)]
    lines = [where + in_short([verdict]) for where, verdict in zip(at, of_it[1:], strict=True)]
    title = "\n".join((short_label(path.contact.name, 60), in_short(of_it[:1]), *lines))
    peaks.set_title(title, fontsize=10, color=QUALITY_COLOURS[overall(of_it)])
    return figure


def figures_of_path(path: ParameterPath, problem: Problem | None = None) -> dict[str, Figure]:
    """Make the pictures of the page of a path, by name.

    They are "problem" (if it is given), "peak", "force", "moment", "contact-1" and so on for each zone, and "pressure".
    """
    figures = {} if problem is None else {"problem": plan_of(problem)}
    for name, draw in (("peak", draw_peaks), ("force", draw_resultants), ("moment", draw_moments)):
        draw(_panel(figures, name, path), path)
    for number_of_zone, zone in enumerate(path.zones, 1):
        draw_interval_ends(_panel(figures, f"contact-{number_of_zone}", path), path, zone)
    figures["pressure"] = new_page(WIDTH, 6.4)
    draw_states(figures["pressure"], path)
    return figures


def _panel(figures: dict[str, Figure], name: str, path: ParameterPath) -> Axes:
    """Axes of a picture of its own, over the parameter."""
    figures[name] = new_page(WIDTH, 3.2)
    axes = figures[name].add_subplot()
    axes.spines[["top", "right"]].set_visible(False)
    name_axis(axes.xaxis, short_label(path.key, 60))
    return axes


def draw_states(figure: Figure, path: ParameterPath) -> None:
    """Draw the pressure along the contact zones at evenly spaced values of the parameter, in a panel each.

    All panels have one scale, unless both ends of the path would not be seen in it; an infinite pressure is cut off.
    """
    at = np.linspace(path.path.begins_at, path.path.ends_at, PANELS).tolist()
    states = [path.path.at(t).pressure for t in at]
    tops = [ceiling(path.contact, pressure, path.infinite) or 1.08 * pressure.max(initial=0.0) for pressure in states]
    pieces = [*pieces_of(path.contact, np.any([pressure > 0 for pressure in states], axis=0))]
    alike = max(tops[0], tops[-1]) >= SEEN * max(tops)
    panels = figure.subplots(PANELS // 2, 2, sharex=True, sharey=alike).ravel().tolist()
    for axes, t, pressure in zip(panels, at, states, strict=True):
        for piece in pieces:
            color = CYCLE[int(path.contact.zone[piece.index[0]]) % len(CYCLE)]
            axes.fill_between(piece.arc, pressure[piece.index], 0.0, color=color, alpha=SHADE, linewidth=0)
            axes.plot(piece.arc, pressure[piece.index], color=color, linewidth=1.4, linestyle=piece.dashes)
        axes.set_title(f"at {number(path.value(t))}", fontsize=9, loc="left")
        axes.ticklabel_format(style="plain", useOffset=False)  # a power of ten would stand on the title
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_xlim(*_around_contact(pieces, states))
    for axes, top in zip(panels, tops, strict=True):
        axes.set_ylim(0.0, (max(tops) if alike else top) or 1.0)
    unit = units_of(path.contact)
    figure.supxlabel(labeled("distance along the contact zone", unit.length), fontsize=9)
    cut = f", infinite in {', '.join(path.infinite)}: cut off" if path.infinite else ""
    scales = "" if alike else ", each panel with a scale of its own"
    figure.supylabel(labeled("pressure", unit.stress) + plain(cut) + scales, fontsize=9)
    if len(path.zones) > 1:
        lines = [Line2D([], [], color=CYCLE[order % len(CYCLE)]) for order in range(len(path.zones))]
        names = [short_label(zone, 24) for zone in path.zones]
        figure.legend(lines, names, loc="outside upper center", ncols=3, frameon=False, fontsize=8.5)


def _around_contact(pieces: Sequence[Piece], states: Sequence[Array]) -> tuple[float, float]:
    """Arc positions between which all contact of some states is, with room at either side, but no more than zones."""
    pressed = np.any([pressure > 0 for pressure in states], axis=0)
    zones = np.concatenate([piece.arc for piece in pieces])
    touched = np.concatenate([piece.arc[pressed[piece.index]] for piece in pieces])
    low, high = (touched.min(), touched.max()) if len(touched) else (zones.min(), zones.max())
    air = ROOM * (high - low) or float(np.ptp(zones))
    return max(float(low - air), float(zones.min())), min(float(high + air), float(zones.max()))


def draw_peaks(axes: Axes, path: ParameterPath) -> None:
    """Draw the largest pressure over the parameter, with a mark at each breakpoint; nothing if it is infinite.

    Known errors at breakpoints are bars. Marks are hollow where the error is larger than asked, or not known.
    """
    begin_at_left(axes, path)
    name_axis(axes.yaxis, labeled("peak pressure", units_of(path.contact).stress))
    if path.infinite:
        axes.text(
            0.5, 0.5, f"infinite in {', '.join(path.infinite)}", transform=axes.transAxes, ha="center", color=BLACK
        )
        axes.set_yticks([])
        return
    _draw_line(axes, path, [state.peak or 0.0 for state in path.states], BLACK, "")
    known = ((state.value, state.peak, state.peak * state.peak_bar) for state in path.pressed
             if state.peak is not None and state.peak_bar is not None)  # fmt: skip
    _draw_errors(axes, known, BLACK)
    axes.scatter(
        [state.value for state in path.coarse], [state.peak or 0.0 for state in path.coarse],
        s=14, facecolors="white", edgecolors=VERMILION, linewidth=1.0, zorder=3,
    )  # fmt: skip
    axes.set_ylim(0.0, max(axes.get_ylim()[1], 1.08 * max(state.peak or 0.0 for state in path.states)))


def draw_resultants(axes: Axes, path: ParameterPath) -> None:
    """Draw the size of the force of each contact on the body over the parameter, with errors at breakpoints."""
    sizes = [[float(np.hypot(*force)) for force in state.resultant] for state in path.states]
    _draw_by_zone(axes, path, sizes, _pressing(path))
    for order, zone in enumerate(path.zones):
        forces = (
            (state, float(np.hypot(*state.resultant[order])), bar)
            for state in path.breakpoints for bar in state.bars if bar.quantity == "force" and bar.zone == zone
        )  # fmt: skip
        known = (
            (state.value, size, abs(bar.value) * bar.bar) for state, size, bar in forces
            if bar.value is not None and bar.bar is not None
        )  # fmt: skip
        _draw_errors(axes, known, CYCLE[order % len(CYCLE)])
    name_axis(axes.yaxis, labeled("resultant", units_of(path.contact).line_force))
    axes.set_ylim(bottom=0)


def draw_moments(axes: Axes, path: ParameterPath) -> None:
    """Draw the moment about the origin of the force of each contact on the body over the parameter."""
    lever = float(np.abs(path.contact.points).max())
    _draw_by_zone(axes, path, [[*state.moments] for state in path.states], lever * _pressing(path))
    name_axis(axes.yaxis, labeled("moment about (0, 0)", units_of(path.contact).line_moment))


def _pressing(path: ParameterPath) -> float:
    """A force that no pressure on the path exceeds [p L]."""
    forces = [np.abs(state.resultant).max(initial=0.0) for state in path.states]
    peaks = [state.peak or 0.0 for state in path.states]
    return float(max(forces) + max(peaks) * path.contact.weights.sum())


def _draw_by_zone(axes: Axes, path: ParameterPath, numbers: list[list[float]], scale: float) -> None:
    """Draw a number of each zone, given state by state, over the parameter; round-off beside a scale is zero."""
    begin_at_left(axes, path)
    for order, zone in enumerate(path.zones):
        heights = [row[order] if abs(row[order]) > ROUND_OFF * scale else 0.0 for row in numbers]
        width = 1.4 + 1.6 * (len(path.zones) - 1 - order)  # so that each of equal lines is seen
        _draw_line(axes, path, heights, CYCLE[order % len(CYCLE)], plain(zone), min(width, MOST_WIDE))
    if len(path.zones) > 1:
        axes.legend(frameon=False, fontsize=8.5)


def begin_at_left(axes: Axes, path: ParameterPath) -> None:
    """Let the parameter go from its start at the left to its end at the right, whichever is larger."""
    air = 0.03 * (path.end - path.start)
    axes.set_xlim(path.start - air, path.end + air)


def draw_interval_ends(axes: Axes, path: ParameterPath, zone: str) -> None:
    """Draw where a zone is in contact, by arc position, over the parameter; dots are breakpoints, bars their errors."""
    begin_at_left(axes, path)
    color, stops = CYCLE[path.zones.index(zone) % len(CYCLE)], {state.value for state in path.breakpoints}
    bands = [*_bands(path.states, zone)]
    if bands:
        values, starts, ends = (np.concatenate([[np.nan, *band[i]] for band in bands])[1:] for i in range(3))
        axes.fill_between(values, starts, ends, color=color, alpha=SHADE, linewidth=0)
        for edge in (starts, ends):
            axes.plot(values, edge, color=color, linewidth=1.4)
            marked = [(value, y) for value, y in zip(values.tolist(), edge, strict=True) if value in stops]
            axes.plot(*np.reshape(marked, (-1, 2)).T, color=color, linestyle="none", marker="o", markersize=2.2)
    _draw_errors(axes, _errors_of_ends(path, zone), color)
    name_axis(axes.yaxis, labeled(f"distance along {short_label(zone, 16)}", units_of(path.contact).length))


def _errors_of_ends(path: ParameterPath, zone: str) -> Iterator[tuple[float, float, float]]:
    """Value, arc position and error of each end of contact at a breakpoint where it is known."""
    for state in path.breakpoints:
        both = state.ends(zone)
        for bar in state.bars:
            if bar.quantity in ("start", "end") and bar.zone == zone and bar.bar is not None:
                i = bar.interval or 0
                length = both[1][i] - both[0][i]
                yield state.value, both[bar.quantity == "end"][i], bar.bar * length


def _draw_errors(axes: Axes, known: Iterable[tuple[float, float, float]], color: str) -> None:
    """Draw bars at values, around heights, as long as errors to either side."""
    if bars := [*known]:
        values, heights, errors = np.array(bars).T
        axes.vlines(values, heights - errors, heights + errors, color=color, linewidth=1.0)


def _draw_line(
    axes: Axes, path: ParameterPath, heights: list[float], color: str, label: str, width: float = 1.4
) -> None:
    """Draw a quantity with a dot at each breakpoint."""
    values = [state.value for state in path.states]
    axes.plot(values, heights, color=color, linewidth=width, label=label)
    dots = [(value, y) for state, value, y in zip(path.states, values, heights, strict=True) if state.breakpoint]
    axes.plot(*zip(*dots, strict=True), color=color, linestyle="none", marker="o", markersize=2.6)


def _bands(states: tuple[PathState, ...], zone: str) -> Iterator[tuple[list[float], list[float], list[float]]]:
    """Values, starts and ends of each interval of a zone while the number of intervals stays the same."""
    for count, group in groupby(states, key=lambda state: len(state.ends(zone)[0])):
        together = [*group]
        for i in range(count):
            yield (
                [state.value for state in together],
                [state.ends(zone)[0][i] for state in together],
                [state.ends(zone)[1][i] for state in together],
            )
