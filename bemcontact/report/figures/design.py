"""The picture of a designed gap: pressure without and with the profile, and the profile."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.arrays import Array, IntArray
from bemcontact.modelling.gap_design.designed_gap import GapDesign
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.page import CYCLE, GREY, labeled, name_axis, new_page, plain

WIDTH = 5.2
"""Inches of a picture on a page."""


def figure_of_design(design: GapDesign) -> Figure:
    """Draw the pressure of all load states without and with the profile, and the profile, over arc length."""
    figure = new_page(6.4, 6.2)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 2])
    draw_relief(below, design)
    draw_relieved_pressure(above, design)
    above.set_title(plain(f"{design.before[0].contact.name}: {design.goal.value} on {design.zone}"), fontsize=10)
    return figure


def figures_of_design(design: GapDesign) -> dict[str, Figure]:
    """Make the pictures of the page of a design: "pressure" and "profile"."""
    figures = {name: new_page(WIDTH, 3.4) for name in ("pressure", "profile")}
    draw_relieved_pressure(figures["pressure"].add_subplot(), design)
    name_axis(figures["pressure"].axes[0].xaxis, _distance(design))
    draw_relief(figures["profile"].add_subplot(), design)
    return figures


def draw_relieved_pressure(axes: Axes, design: GapDesign) -> None:
    """Draw pressure over arc length, dashed without and solid with the profile.

    The frame ends at three times the peak with the profile. A text gives a larger peak without it, and says if it is
    infinite.
    """
    at, arc = _points(design)
    for number, (before, after) in enumerate(zip(design.before, design.after, strict=True)):
        color = CYCLE[number % len(CYCLE)]
        state = f", state {number + 1}" if len(design.after) > 1 else ""
        axes.plot(arc, before.pressure[at], color=color, linestyle="dashed", linewidth=1.2, label=f"without{state}")
        axes.plot(arc, after.pressure[at], color=color, marker=".", linewidth=1.5, label=f"with profile{state}")
    highest = min(design.peak_before, 3 * design.peak) or 1.0
    axes.set_ylim(-0.03 * highest, 1.08 * highest)
    if design.peak_before > highest:
        infinite = any(state.infinite for state in design.before)
        up_to = (
            f"infinite in theory without,\n{design.peak_before:.4g} on this mesh"
            if infinite
            else (f"up to {design.peak_before:.4g} without")
        )
        axes.text(0.98, 0.95, up_to, ha="right", va="top", transform=axes.transAxes)
    name_axis(axes.yaxis, labeled("pressure", units_of(design.before[0].contact).stress))
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8.5)


def draw_relief(axes: Axes, design: GapDesign) -> None:
    """Draw the profile over arc length."""
    at, arc = _points(design)
    axes.fill_between(arc, design.profile[at], 0.0, color=GREY, alpha=0.25, linewidth=0)
    axes.plot(arc, design.profile[at], color=GREY, marker=".", linewidth=1.5)
    name_axis(axes.xaxis, _distance(design))
    name_axis(axes.yaxis, labeled("profile", units_of(design.before[0].contact).length))
    axes.spines[["top", "right"]].set_visible(False)


def _distance(design: GapDesign) -> str:
    """Label of the axis along the zone."""
    return labeled("distance along the contact zone", units_of(design.before[0].contact).length)


def _points(design: GapDesign) -> tuple[IntArray, Array]:
    """Indices of the contact points of the zone, in order, and their arc positions; runs one after the other."""
    contact = design.before[0].contact
    at = contact.in_order(np.flatnonzero(contact.zone == contact.zone[design.points[0]]))
    return at, contact.arc_position[at]
