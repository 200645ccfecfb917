"""Pictures of a comparison along the contact zones: pressures, gaps and differences of all contenders."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from bemcontact.analysis.mesh_study import MeshLevel
from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.assessment.comparison import SAME, Contender
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.frozen import frozen_value
from bemcontact.options import FormulationName
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.page import (
    BLACK,
    COLOURS,
    GREY,
    PURPLE,
    Piece,
    ceiling,
    cut_off,
    distance_label,
    labeled,
    legend_below,
    name_axis,
    only_around,
    pieces_of,
    plain,
    short_label,
    show_decades,
)
from bemcontact.report.figures.result import intervals_on, label_closed, window_around
from bemcontact.report.formatting import number, with_unit

DASHES = ("solid", (0, (5, 1.5)), (0, (1.5, 1)), (0, (6, 1.5, 1.5, 1.5)))
"""Line styles of the contenders of one formulation, in turn."""
WIDEST, THINNEST = 8.0, 1.1
"""Line widths: the direct solution is the widest curve, below all others."""
SPACE = 0.08
"""Space between two pieces of the contact zones, over the length of all of them."""
BEYOND = 1.3
"""Height of the frame over the peak of the direct solution."""


@frozen_value
class SharedCurve:
    """Curve of contenders with visibly equal values."""

    contenders: tuple[Contender, ...]
    width: float
    dashes: str | tuple[int, tuple[float, ...]]

    @property
    def color(self) -> str:
        """Color of the formulation."""
        return COLOURS[self.contenders[0].attempt.options.formulation]

    @property
    def label(self) -> str:
        """Label in the legend."""
        more = len(self.contenders) - 1
        return plain(self.contenders[0].label) + (f" and {more} more" if more else "")

    @property
    def solution(self) -> ContactSolution:
        """Solution of the first contender."""
        assessment = self.contenders[0].assessment
        assert assessment is not None  # nothing else is made a curve of
        return assessment.solution


def draw_pressures(axes: Axes, level: MeshLevel) -> None:
    """Draw the pressures of all contenders, the direct solution and the references along the contact zones.

    The direct solution is a wide band below the other curves. A reference out of its range is gray. Curves far above
    the direct solution are cut off, and their peaks are written above the frame. An infinite pressure is cut off at
    three times the mean one.
    """
    contact, unit = level.answer.contact, units_of(level.answer.contact).stress
    along, curves = _Along(answer=level.answer), _curves(level)
    for curve in curves:
        along.plot(axes, curve.solution.pressure, curve)
    infinite, direct = level.answer.accuracy.infinite, level.answer.solution.pressure
    top = ceiling(contact, direct, infinite)
    known = [float(np.abs(direct).max(initial=0.0))]
    for item in level.expected:
        color, label = (PURPLE, item.name) if item.in_range else (GREY, f"{item.name}, out of its range")
        if np.isfinite(item.pressure).any():
            along.line(axes, item.pressure, color, short_label(label, 40))
            known.append(float(np.nanmax(item.pressure)))
        elif item.peak is not None and not item.infinite:
            axes.axhline(
                item.peak, color=color, linewidth=1.2, linestyle="dotted", label=short_label(f"{label}: peak", 40)
            )
            known.append(item.peak)
    maxima = {curve.label: float(curve.solution.pressure.max(initial=0.0)) for curve in curves}
    if top is None:
        _cut_off(axes, maxima, BEYOND * max(known), unit)
    else:
        _cut_off(axes, {}, top, unit)
        cut_off(axes, top, infinite)
    name_axis(axes.yaxis, labeled("pressure", unit) + "\nper undeformed length")
    along.finish(axes)


def draw_gaps(axes: Axes, level: MeshLevel) -> None:
    """Draw the gaps of all contenders along the contact zones, and the initial gap."""
    contact, unit = level.answer.contact, units_of(level.answer.contact).length
    along, maxima = _Along(answer=level.answer), dict[str, float]()
    for curve in _curves(level):
        gap = contact.initial_gap + curve.solution.displacement
        along.plot(axes, gap, curve)
        maxima[curve.label] = float(gap.max())
    along.line(axes, contact.initial_gap, BLACK, "initial gap")
    answer = contact.initial_gap + level.answer.solution.displacement
    largest = max(float(contact.initial_gap.max()), float(answer.max()), contact.scales.displacement)
    _cut_off(axes, maxima, BEYOND * largest, unit)
    name_axis(axes.yaxis, labeled("gap", unit))
    along.finish(axes)
    widest = max(float(np.abs(contact.initial_gap).max(initial=0.0)), *map(abs, maxima.values()))
    label_closed(axes, widest, contact.scales.displacement)


def draw_differences(axes: Axes, level: MeshLevel) -> None:
    """Draw |p - p'| over the largest pressure for each contender, with p' the direct solution; zero is not drawn."""
    along, direct = _Along(answer=level.answer), level.answer.solution.pressure
    peak = along.contact.peak(direct) or along.contact.scales.pressure
    for curve in _curves(level, merged=False):
        difference = np.abs(curve.solution.pressure - direct) / peak
        if difference.any():
            along.plot(axes, np.where(difference > 0, difference, np.nan), curve, marker=".")
    show_decades(axes)
    axes.set_ylabel("difference of pressure from the direct\nsolution, over its largest value")
    along.finish(axes)


@frozen_value
class _Along:
    """Pieces of the contact zones, laid out one after the other on one axis."""

    answer: Result

    @property
    def contact(self) -> CondensedContact:
        """The contact points."""
        return self.answer.contact

    @cached_property
    def pieces(self) -> list[Piece]:
        """Pieces in the order of the contact points; of one whose contact is small only what is around it."""
        return [self._around_contact(piece) for piece in pieces_of(self.contact, self.answer.touching)]

    def _around_contact(self, piece: Piece) -> Piece:
        """The part of a piece that is shown: one point more than the window, so that no curve ends within it."""
        window = window_around([piece], [ends for _, ends in intervals_on([piece], self.answer)])
        if window is None:
            return piece
        first, last = np.searchsorted(piece.arc, window[0], "right") - 1, np.searchsorted(piece.arc, window[1]) + 1
        part = slice(max(int(first), 0), int(last))
        return replace(piece, index=piece.index[part], arc=piece.arc[part])

    @cached_property
    def shifts(self) -> list[float]:
        """Shift of each piece along the axis [L]."""
        arcs = [piece.arc for piece in self.pieces]
        lengths = [float(np.ptp(arc)) for arc in arcs]
        starts = np.cumsum([0.0, *(length + SPACE * sum(lengths) for length in lengths)])
        return [float(start - arc[0]) for start, arc in zip(starts, arcs, strict=False)]

    def stretches(self, values: Array) -> Iterator[tuple[Array, Array]]:
        """Positions and values (n,) on each piece."""
        for piece, shift in zip(self.pieces, self.shifts, strict=True):
            yield piece.arc + shift, values[piece.index]

    def plot(self, axes: Axes, values: Array, curve: SharedCurve, marker: str = "") -> None:
        """Draw values (n,) of a contender."""
        for order, (s, along) in enumerate(self.stretches(values)):
            label = "_" if order else curve.label
            axes.plot(
                s,
                along,
                color=curve.color,
                linewidth=curve.width,
                linestyle=curve.dashes,
                marker=marker,
                label=label,
                alpha=0.45 if curve.width == WIDEST else 1.0,
                solid_capstyle="butt",
            )

    def line(self, axes: Axes, values: Array, color: str, label: str) -> None:
        """Draw values (n,) that no solver found."""
        for order, (s, along) in enumerate(self.stretches(values)):
            shown = "_" if order else label
            axes.plot(s, along, color=color, linewidth=1.4, linestyle=(0, (2.5, 2)), label=shown, zorder=2.5)

    def finish(self, axes: Axes) -> None:
        """Name the axis, and the pieces if there are several."""
        whole = sum(len(piece.index) for piece in self.pieces) == self.contact.size
        label = distance_label(self.contact, self.pieces)
        name_axis(axes.xaxis, label if whole else only_around(label))
        if len(self.pieces) > 1:
            self._name_pieces(axes)
        legend_below(axes)

    def _name_pieces(self, axes: Axes) -> None:
        """Label each piece, with distances from its own start."""
        ticks, labels = [], []
        for piece, shift in zip(self.pieces, self.shifts, strict=True):
            s = piece.arc
            own = [tick for tick in MaxNLocator(3).tick_values(s[0], s[-1]) if s[0] <= tick <= s[-1] * (1 + 1e-9)]
            ticks += [tick + shift for tick in own]
            labels += [f"{tick:.4g}" for tick in own]
            middle = float(s[0] + s[-1]) / 2 + shift
            at_top = axes.get_xaxis_transform()
            axes.text(middle, 1.02, piece.label, transform=at_top, ha="center", va="bottom", fontsize=9, color=BLACK)
        axes.set_xticks(ticks, labels)


def _curves(level: MeshLevel, *, merged: bool = True) -> list[SharedCurve]:
    """Curves from the direct solution on, each thinner than the one before; equal ones of a formulation are merged."""
    compared = level.comparison
    everyone = [item for item in (compared.reference, *compared.contenders) if item.assessment is not None]
    groups = list[list[Contender]]()
    for item in everyone:
        alike = next((group for group in groups if merged and _alike(group[0], item, level)), None)
        if alike is None:
            groups.append([item])
        else:
            alike.append(item)
    widths = [WIDEST, *np.linspace(5.0, THINNEST, max(len(groups) - 1, 1))]
    curves, seen = list[SharedCurve](), dict[FormulationName, int]()
    for group, width in zip(groups, widths, strict=False):
        name = group[0].attempt.options.formulation
        order = seen.get(name, 0)
        seen[name] = order + 1
        curves.append(SharedCurve(contenders=tuple(group), width=float(width), dashes=DASHES[order % len(DASHES)]))
    return curves


def _alike(one: Contender, other: Contender, level: MeshLevel) -> bool:
    """Whether two contenders of the same formulation have the same pressure, as far as can be seen."""
    if one.assessment is None or other.assessment is None:
        return False
    apart = float(np.abs(one.assessment.solution.pressure - other.assessment.solution.pressure).max())
    contact = level.answer.contact
    peak = contact.peak(level.answer.solution.pressure) or contact.scales.pressure
    return one.attempt.options.formulation is other.attempt.options.formulation and apart <= SAME * peak


def _cut_off(axes: Axes, maxima: dict[str, float], top: float, unit: str) -> None:
    """Limit the frame to values up to `top`, and write the larger ones above it."""
    beyond = [
        f"{label} up to {with_unit(number(value), plain(unit))}" for label, value in maxima.items() if value > top
    ]
    axes.axhline(0, color=GREY, linewidth=0.8, zorder=1)
    if beyond:
        axes.set_ylim(-0.1 * top, top)
        axes.set_title("beyond the frame: " + "\n".join(beyond), loc="left", fontsize=8, color=BLACK)
