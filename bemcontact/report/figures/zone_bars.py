"""Many contacts at a glance: largest pressure and force of each as bars."""

from typing import Literal

import numpy as np
from matplotlib.axes import Axes

from bemcontact.analysis.result import Result
from bemcontact.report.bars import with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.page import BLACK, GREY, VERMILION, labeled, name_axis, plain, short_label
from bemcontact.report.formatting import with_unit

ROOM = 1.45
"""Length of the axis over the longest bar, whose value is written beside it."""
OPEN = 8
"""Most open contacts that are named."""


def draw_zone_bars(axes: Axes, result: Result, quantity: Literal["peak", "force"]) -> None:
    """Draw the largest pressure, or the force, of each contact that is closed, with its error bar in words.

    A pressure that is infinite has no bar. A line says which contacts are open.
    """
    contact, units = result.contact, units_of(result.contact)
    closed, unit = closed_zones(result), units.stress if quantity == "peak" else units.line_force
    lengths, texts = list[float](), list[str]()
    for zone in closed:
        if quantity == "peak":
            value = float(result.solution.pressure[contact.zone == contact.zone_names.index(zone)].max())
        else:
            value = float(np.hypot(*result.footprint.forces[zone]))
        infinite = quantity == "peak" and zone in result.accuracy.infinite
        known = (bar.bar for bar in result.accuracy.bars if (bar.quantity, bar.zone) == (quantity, zone))
        lengths.append(0.0 if infinite else value)
        texts.append("infinite" if infinite else with_unit(with_bar(value, next(known, None)), plain(unit)))
    rows = range(len(closed))
    axes.barh(rows, lengths, height=0.7, color=VERMILION, alpha=0.55)
    for row, length, text in zip(rows, lengths, texts, strict=True):
        axes.annotate(text, (length, row), (4, 0), textcoords="offset points", va="center", fontsize=8.5, color=BLACK)
    axes.set_yticks(rows, [short_label(zone, 24) for zone in closed])
    axes.set_ylim(len(closed) - 0.4, -0.6)
    axes.set_xlim(0, ROOM * max(lengths, default=0.0) or 1.0)
    name_axis(axes.xaxis, labeled("largest pressure" if quantity == "peak" else "force", unit))
    axes.spines[["top", "right"]].set_visible(False)
    left_open = [short_label(zone, 24) for zone in contact.zone_names if zone not in closed]
    if left_open and quantity == "peak":
        more = [f"{len(left_open) - OPEN} more"] if len(left_open) > OPEN else []
        axes.set_title(f"no contact: {', '.join(left_open[:OPEN] + more)}", loc="left", fontsize=9, color=GREY)


def closed_zones(result: Result) -> list[str]:
    """Names of the zones in which there is pressure; a loose body may touch without any, up to round-off."""
    pressed = np.unique(result.contact.zone[result.solution.pressure > 0]).tolist()
    return [result.contact.zone_names[number] for number in pressed]
