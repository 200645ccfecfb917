"""The picture of an answer: pressure and gap along the contact zones, the deformed shape."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array, IntArray
from bemcontact.bem import reference_element
from bemcontact.bem.condense import BoundaryState
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.report.figures.marks import draw_ground
from bemcontact.report.figures.page import (
    BLACK,
    BLUE,
    BODY,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    VERMILION,
    frame_plan,
    labelled,
    new_page,
    plain,
    shortened,
    wrapped,
)
from bemcontact.report.formatting import number, units_of, with_unit

PIECE_COLOURS = (VERMILION, BLUE, GREEN, PURPLE, ORANGE, SKY)
VISIBLE = 0.05
"""Share of the body's size at which the largest displacement can be seen well; smaller ones are magnified."""

NEAR = 0.15
"""Share of the body's size up to which the rigid surface across a gap is shown."""

CLOSED = 1e-9
"""Gap over the displacement scale that is round-off."""


@dataclass(frozen=True, kw_only=True)
class Piece:
    """An unbroken piece of boundary in one contact zone: its points in order, and how it is drawn."""

    label: str
    order: int
    index: IntArray

    @property
    def colour(self) -> str:
        """Its colour; there are six."""
        return PIECE_COLOURS[self.order % len(PIECE_COLOURS)]

    @property
    def dashes(self) -> str:
        """Its line style: an unbroken line is never drawn over another."""
        return "dashed" if self.order else "solid"


def figure_of_result(result: Result) -> Figure:
    """Compose a page with pressure, gap and, where the body is known, its deformed shape."""
    width, height = _extent(result.boundary) if result.boundary else (0.0, 0.0)
    wide = width > 1.6 * height
    inches = 12 if result.boundary else 7
    figure = new_page(inches, 7)
    grid = figure.add_gridspec(2, 2 if result.boundary else 1)
    pressure = figure.add_subplot(grid[0, 0])
    gap = figure.add_subplot(grid[0, 1] if wide else grid[1, 0], sharex=pressure)
    draw_pressure(pressure, result)
    draw_gap(gap, result)
    if result.boundary:
        draw_deformed(figure.add_subplot(grid[1, :] if wide else grid[:, 1]), result)
    verdict = "certified" if result.certified else "NOT certified"
    title = f"{wrapped(result.contact.name, 6 * inches)}: {result.solution.formulation}, {verdict}"
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold", color=BLACK if result.certified else VERMILION)
    return figure


def draw_pressure(axes: Axes, result: Result) -> None:
    """Draw the contact pressure, per undeformed length, over the distance along each contact zone."""
    pressure, contact = result.solution.pressure, result.contact
    _draw_along(axes, result, pressure)
    axes.set_ylabel(labelled("pressure", units_of(contact).stress) + "\nper undeformed length")
    axes.set_ylim(top=1.18 * float(pressure.max(initial=0.0)) or 1.0)
    peak = result.footprint.peak
    if peak is not None:
        nearest = int(np.argmin(np.hypot(*(contact.points - np.array(peak.at)).T)))
        s = float(contact.arc_position[nearest])
        low, high = axes.get_xlim()
        side = "left" if s < low + 0.15 * (high - low) else "right" if s > high - 0.15 * (high - low) else "center"
        text = f"peak {with_unit(number(peak.pressure), plain(units_of(contact).stress))}"
        axes.annotate(text, (s, peak.pressure), xytext=(0, 7), textcoords="offset points", ha=side, color=BLACK)


def draw_gap(axes: Axes, result: Result) -> None:
    """Draw the gap over the distance along each contact zone; round-off is not blown up to a curve."""
    gap, scale = _gap(result), result.contact.scales.displacement
    _draw_along(axes, result, gap)
    axes.set_ylabel(labelled("gap", units_of(result.contact).length))
    tell_closed(axes, float(np.abs(gap).max(initial=0.0)), scale)


def tell_closed(axes: Axes, widest: float, scale: float) -> None:
    """Write that all gaps are closed, and leave room, where the widest is round-off beside the scale."""
    if widest <= CLOSED * scale:
        axes.set_ylim(-0.1 * scale, scale)
        axes.text(0.5, 0.5, "closed everywhere", transform=axes.transAxes, ha="center", color=BLACK)


def draw_deformed(axes: Axes, result: Result) -> None:
    """Draw the boundary before and after, in thick lines where it is in contact, and the rigid surfaces if to scale.

    Displacements are magnified by a factor, which is stated. A rigid surface has none; beside a magnified body it would
    seem penetrated or far away, and so it is left out unless the factor is one.

    Parameters
    ----------
    axes : to draw into; limits and aspect are set
    result : with its `boundary`

    Raises
    ------
    ValueError
        If the result has no boundary, as one of a condensed problem.
    """
    state = result.boundary
    if state is None:
        raise ValueError("the result of a condensed problem has no boundary to draw")
    factor = _magnification(state)
    curves = reference_element.values(np.linspace(-1, 1, 9))
    before = curves @ state.points
    after = curves @ (state.points + factor * state.displacement)
    axes.add_collection(LineCollection(list(before), colors=GREY, linewidths=0.9, linestyles="dashed", zorder=2))
    axes.add_collection(LineCollection(list(after), colors=BLACK, linewidths=1.8, zorder=3))
    outline = [Path(loop.reshape(-1, 2), closed=True) for loop in _loops(state, after)]
    axes.add_patch(PathPatch(Path.make_compound_path(*outline), facecolor=BODY, edgecolor="none", zorder=0))
    _draw_touching(axes, result, state, after)
    covered = [before.reshape(-1, 2), after.reshape(-1, 2)]
    size = float(np.hypot(*_extent(state)))
    if factor == 1:
        covered += [draw_ground(axes, *ground, 0.025 * size, GREY) for ground in _ground(result, NEAR * size)]
    unit = units_of(result.contact).length
    frame_plan(axes, np.concatenate(covered), unit)
    largest = with_unit(f"{float(np.hypot(*state.displacement.reshape(-1, 2).T).max()):.3g}", plain(unit))
    scale = "displacements to scale" if factor == 1 else f"displacements × {factor:g}"
    surfaces = "" if factor == 1 else "; rigid surfaces not drawn"
    title = f"deformed shape, {scale} (largest {largest})\nthick: in contact; dashed: undeformed{surfaces}"
    axes.set_title(title, loc="left", fontsize=10)


def _draw_touching(axes: Axes, result: Result, state: BoundaryState, after: Array) -> None:
    """Thicken the halves of elements, drawn as curves (m, 9, 2), whose nodes carry pressure, and dot these nodes."""
    carrying = {tuple(point) for point in result.contact.points[result.touching].tolist()}
    touching = np.array([[tuple(node) in carrying for node in element] for element in state.points.tolist()])
    halves = [*after[touching[:, 0] & touching[:, 1], :5], *after[touching[:, 1] & touching[:, 2], 4:]]
    axes.add_collection(LineCollection(halves, colors=VERMILION, linewidths=3.5, capstyle="round", zorder=4))
    axes.scatter(*after[:, ::4][touching].T, s=10, color=VERMILION, zorder=4)


def _extent(state: BoundaryState) -> tuple[float, float]:
    """Width and height of the body."""
    width, height = np.ptp(state.points.reshape(-1, 2), axis=0)
    return float(width), float(height)


def _loops(state: BoundaryState, curves: Array) -> list[Array]:
    """Split curves (m, 9, 2) where one loop of elements ends and the next begins."""
    breaks = (state.points[1:, 0] != state.points[:-1, 2]).any(axis=1)
    return np.split(curves, np.flatnonzero(breaks) + 1)


def _ground(result: Result, near: float) -> Iterator[tuple[Array, Array]]:
    """Stretches (j, 2) of rigid surface, with normals, so near to the deformed body that they can be shown."""
    contact = result.contact
    moved = contact.tools.motions @ (contact.tools.amplitudes @ result.solution.rigid_amplitudes)
    feet = contact.points - (contact.initial_gap + moved)[:, None] * contact.normals
    shown = _gap(result) <= near
    for piece in pieces_of(contact):
        for stretch in np.split(piece.index, np.flatnonzero(np.diff(shown[piece.index])) + 1):
            if shown[stretch[0]] and len(stretch) > 1:
                yield feet[stretch], contact.normals[stretch]


def _magnification(state: BoundaryState) -> float:
    """Choose 1, 2 or 5 times a power of ten so that the largest displacement can be seen."""
    largest = float(np.hypot(*state.displacement.reshape(-1, 2).T).max())
    size = float(np.hypot(*_extent(state)))
    if largest == 0 or largest >= VISIBLE * size / 2:
        return 1.0
    wanted = VISIBLE * size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step for step in (1, 2, 5) if step * power <= wanted) * power)


def pieces_of(contact: CondensedContact) -> Iterator[Piece]:
    """List the unbroken pieces of all contact zones, in the order of the contact points."""
    for order, run in enumerate(np.unique(contact.run)):
        index = contact.points_of_run(run)
        zone = int(contact.zone[index[0]])
        label = shortened(contact.zone_names[zone], 24)
        if len(np.unique(contact.run[contact.zone == zone])) > 1:
            label += f" ({contact.points[index[0], 0]:.3g}, {contact.points[index[0], 1]:.3g}) on"
        yield Piece(label=label, order=order, index=index)


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
