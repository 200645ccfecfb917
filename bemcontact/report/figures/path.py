"""The picture of a load path: peak, resultant and ends of contact over the parameter."""

from collections.abc import Iterator
from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.page import BLACK, CYCLE, QUALITY_COLOURS, labeled, new_page, plain, short_label
from bemcontact.report.formatting import number
from bemcontact.report.path_verdicts import path_verdicts
from bemcontact.report.verdicts import in_short, overall

WIDTH, HEIGHT = 5.6, 2.5
"""Inches of each picture."""
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
    ends[-1].set_xlabel(short_label(path.key, 60))
    of_it = [*path_verdicts(path)]
    at = [*(f"at {number(value)}: " for value in (path.start, path.end)), *[""] * (len(of_it) - 3)]
    lines = [where + in_short([verdict]) for where, verdict in zip(at, of_it[1:], strict=True)]
    title = "\n".join((short_label(path.contact.name, 60), in_short(of_it[:1]), *lines))
    peaks.set_title(title, fontsize=10, color=QUALITY_COLOURS[overall(of_it)])
    return figure


def draw_peaks(axes: Axes, path: ParameterPath) -> None:
    """Draw the largest pressure over the parameter, with a dot at each breakpoint; nothing if it is infinite."""
    axes.set_ylabel(labeled("peak pressure", units_of(path.contact).stress))
    if path.infinite:
        axes.text(
            0.5, 0.5, f"infinite in {', '.join(path.infinite)}", transform=axes.transAxes, ha="center", color=BLACK
        )
        axes.set_yticks([])
        return
    _draw_line(axes, path, [state.peak or 0.0 for state in path.states], BLACK, "")
    axes.set_ylim(bottom=0)


def draw_resultants(axes: Axes, path: ParameterPath) -> None:
    """Draw the size of the force of each rigid surface on the body over the parameter."""
    zones = path.contact.zone_names
    for order, zone in enumerate(zones):
        sizes = [float(np.hypot(*state.resultant[order])) for state in path.states]
        _draw_line(axes, path, sizes, CYCLE[order % len(CYCLE)], plain(zone))
    axes.set_ylabel(labeled("resultant", units_of(path.contact).line_force))
    axes.set_ylim(bottom=0)
    if len(zones) > 1:
        axes.legend(frameon=False, fontsize=8.5)


def draw_interval_ends(axes: Axes, path: ParameterPath, zone: str) -> None:
    """Draw where a zone is in contact, by arc position, over the parameter."""
    color = CYCLE[path.contact.zone_names.index(zone) % len(CYCLE)]
    for values, starts, ends in _bands(path.states, zone):
        axes.fill_between(values, starts, ends, color=color, alpha=SHADE, linewidth=0)
        for edge in (starts, ends):
            axes.plot(values, edge, color=color, linewidth=1.4)
    axes.set_ylabel(labeled(f"contact of {short_label(zone, 16)}", units_of(path.contact).length))


def _draw_line(axes: Axes, path: ParameterPath, heights: list[float], color: str, label: str) -> None:
    """Draw a quantity with a dot at each breakpoint."""
    values = [state.value for state in path.states]
    axes.plot(values, heights, color=color, linewidth=1.4, label=label)
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
