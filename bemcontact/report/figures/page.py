"""What all pictures share: colors, pieces of the contact zones, axes with units, and files."""

import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.axis import Axis, XAxis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import PathPatch
from matplotlib.path import Path as MplPath
from matplotlib.text import Text
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullLocator, ScalarFormatter

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import escaped_lines
from bemcontact.files import output
from bemcontact.frozen import frozen_value
from bemcontact.options import FormulationName
from bemcontact.report.contact_words import units_of
from bemcontact.report.formatting import number, vector, with_unit

FORMATS = (".png", ".svg", ".pdf")
"""Endings of the files that can be written."""

DATES = {"svg": "Date", "pdf": "CreationDate"}
"""Format -> the key of its metadata that would make each file another."""

OF_FILES: Any = {"svg.hashsalt": "bemcontact", "figure.autolayout": False, "figure.constrained_layout.use": False}
"""Settings for files: names in them are the same each time, and axes stay where they are."""

# The palette of Okabe and Ito, which color-blind people can tell apart.
BLACK, BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY = (
    "#222222", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"
)  # fmt: skip
GREY, BODY = "#7d838c", "#e8ecf2"
BODIES = (BODY, "#f5ecd7", "#dfeee4", "#efe3ee", "#f6e2dc", "#dcebf3")
"""Fills of several bodies, in turn."""

COLOURS = {
    FormulationName.QP1: VERMILION,
    FormulationName.QP2: BLUE,
    FormulationName.QP3: BLACK,
    FormulationName.COMPLEMENTARITY: GREY,
}
CYCLE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)


def ensure_known_format(path: Path) -> None:
    """Raise `ValueError` unless the file name ends in one of `FORMATS`."""
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: the file name of a picture must end in {', '.join(FORMATS[:-1])} or {FORMATS[-1]}")


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the file name's ending; the bytes depend on the figure alone."""
    ensure_known_format(path)
    ending = path.suffix.lower()[1:]
    undated = {DATES[ending]: None} if ending in DATES else {}
    picture = file_content(figure, {}, 0.15, format=ending, dpi=160, metadata=undated)
    with output.whole_file(path) as temporary:
        temporary.write_bytes(picture)


def file_content(figure: Figure, settings: Any, margin: float, **form: Any) -> bytes:
    """Draw a figure as the content of a file, with a margin in inches, without hidden characters in its texts."""
    layout = figure.get_layout_engine()
    if layout is not None and not (isinstance(layout, PageLayout) and layout.settled):
        with without_glyph_warnings():
            layout.execute(figure)
    for text in figure.findobj(Text):
        text.set_text(escaped_lines(text.get_text()))
        text.set_in_layout(True)
    stream = BytesIO()
    with rc_context(OF_FILES), rc_context(settings), without_glyph_warnings():
        figure.set_layout_engine(None)  # names stand beside what they name, and the file shows all of them
        figure.savefig(stream, bbox_inches=figure.get_tightbbox().padded(margin), **form)
    return stream.getvalue()


def settle(axes: Axes) -> None:
    """Lay out the page, so that positions on it are known; names that are placed on it do not change them."""
    page = axes.get_figure(root=True)
    if page is None:
        return
    with without_glyph_warnings():
        page.draw_without_rendering()
    layout = page.get_layout_engine()
    if isinstance(layout, PageLayout):
        layout.settled = True


@contextmanager
def without_glyph_warnings() -> Iterator[None]:
    """Suppress the warning on a letter that the font lacks; a box is drawn for it."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph", UserWarning)
        yield


def new_page(width: float, height: float) -> Figure:
    """Make an empty figure of this size in inches."""
    figure = Figure(figsize=(width, height), layout=PageLayout())
    FigureCanvasAgg(figure)
    return figure


class PageLayout(ConstrainedLayoutEngine):
    """Layout of a page of this program. One that is settled is not laid out again for its file.

    It takes two passes: equal scales change the place of a plan, and with it how high its title stands.
    """

    settled = False

    def execute(self, fig: Figure) -> None:
        """Lay out the page."""
        for _ in range(2):
            super().execute(fig)


def plain(text: str) -> str:
    """Escape what matplotlib would read as mathematics."""
    return text.replace("\\", r"\\").replace("$", r"\$") if "$" in text else text


def wrapped(text: str, columns: int) -> str:
    """Break a user's text into at most three lines of so many letters, and escape mathematics."""
    return plain("\n".join(wrap(text, columns, max_lines=3, placeholder=" …")))


def short_label(text: str, columns: int) -> str:
    """Cut a user's text to so many letters, and escape mathematics."""
    return plain(text if len(text) <= columns else f"{text[: columns - 1]}…")


def labeled(quantity: str, unit: str) -> str:
    """Write a quantity with its unit, if there is one."""
    return f"{quantity} [{plain(unit)}]" if unit else quantity


POWER = re.compile(r" \[\$10\^\{-?\d+\}\$\]|(?<=\[)\$10\^\{-?\d+\}\$ ")
"""A power of ten in the label of an axis: with a unit, or alone."""


class PowerInLabel(ScalarFormatter):
    """Tick labels whose power of ten stands with the unit in the label of the axis, not at the end of the axis.

    Nothing is subtracted from them.
    """

    def __init__(self) -> None:
        """Write tick labels as they are."""
        super().__init__(useOffset=False, useMathText=False)

    def format_ticks(self, values: Any) -> list[str]:
        """Write tick labels, and their power of ten into the label of each axis that has these ticks."""
        texts, axis = super().format_ticks(values), self.axis
        power = int(super().get_offset().partition("e")[2].replace("\N{MINUS SIGN}", "-") or 0)
        if isinstance(axis, Axis):
            own = axis.axes
            shared = own.get_shared_x_axes() if isinstance(axis, XAxis) else own.get_shared_y_axes()
            for axes in shared.get_siblings(own):
                label = (axes.xaxis if isinstance(axis, XAxis) else axes.yaxis).label
                label.set_text(with_power(label.get_text(), power))
        return texts

    def get_offset(self) -> str:
        """Nothing is written at the end of the axis."""
        return ""


def with_power(label: str, power: int) -> str:
    """Write a power of ten into the first line of a label, before its unit; an empty label stays empty."""
    first, *others = POWER.sub("", label).split("\n")
    if power and first:
        ten = f"$10^{{{power}}}$"
        quantity, bracket, unit = first.rpartition("[")
        first = f"{quantity}[{ten} {unit}" if bracket and unit.endswith("]") else f"{first} [{ten}]"
    return "\n".join([first, *others])


def name_axis(axis: Axis, label: str) -> None:
    """Label an axis; a power of ten of its ticks will stand with the unit. Ticks of another kind stay as they are."""
    axis.set_label_text(label)
    if type(axis.get_major_formatter()) is ScalarFormatter:
        axis.set_major_formatter(PowerInLabel())


LETTER = 0.1
"""Inches of a digit of a tick label."""


def add_path(axes: Axes, path: MplPath, **style: Any) -> None:
    """Draw a path; `Axes.add_patch` would look for the limits of each of its thousands of strokes."""
    axes.add_artist(PathPatch(path, **style))
    axes.update_datalim(path.vertices)


class RoundTicks(MaxNLocator):
    """Ticks at round numbers, of a horizontal axis only as many as there is room for their labels."""

    def __init__(self, most: int) -> None:
        """Place at most so many intervals between ticks."""
        self.most = most
        super().__init__(most, steps=[1, 2, 2.5, 5, 10])

    def tick_values(self, vmin: float, vmax: float) -> Any:
        """Round numbers between two limits, and one beyond each."""
        ticks, axis = np.array([vmin, vmax]), self.axis
        page = axis.get_figure(root=True) if isinstance(axis, XAxis) else None
        for count in range(self.most, 0, -1):
            self.set_params(nbins=count)
            ticks = np.asarray(super().tick_values(vmin, vmax))
            if not isinstance(axis, XAxis) or page is None or vmin == vmax:
                break
            shown = ticks[(ticks >= min(vmin, vmax)) & (ticks <= max(vmin, vmax))]
            letters = [len(text) + 1 for text in axis.get_major_formatter().format_ticks(shown.tolist())]
            apart = axis.axes.bbox.width * (shown[1] - shown[0]) / (vmax - vmin) if len(shown) > 1 else np.inf
            if LETTER * page.dpi * max(letters, default=0) <= apart:
                break
        return ticks


def frame_plan(axes: Axes, drawn: Array, unit: str, margin: float = 0.06) -> None:
    """Set limits, aspect and labels of a plan so that it shows all drawn points (k, 2) with a margin."""
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    longest = float((high - low).max())
    air = margin * longest
    axes.set_xlim(low[0] - air, high[0] + air)
    axes.set_ylim(low[1] - air, high[1] + air)
    axes.set_aspect("equal")
    for axis, extent in zip((axes.xaxis, axes.yaxis), high - low, strict=True):
        axis.set_major_locator(RoundTicks(max(2, round(6 * min(1.0, 1.5 * extent / longest)))))
    name_axis(axes.xaxis, labeled("x", unit))
    name_axis(axes.yaxis, labeled("y", unit))
    axes.spines[["top", "right"]].set_visible(False)


AMBER = "#8a5a00"
"""Color of a title on paper that only half of its verdicts support."""
QUALITY_COLOURS = {"good": BLACK, "fair": AMBER, "bad": VERMILION}
"""Quality of an answer -> color of the title of its picture."""
CUT = 3.0
"""Multiple of the mean pressure at which pictures cut off one that is infinite."""


def ceiling(contact: CondensedContact, pressure: Array, infinite: Sequence[str]) -> float | None:
    """Largest pressure (of n) to be drawn where that of some zones is infinite; None if none is."""
    if not infinite:
        return None
    singular = np.isin(contact.zone, [contact.zone_names.index(name) for name in infinite])
    pressed = singular & (pressure > 0)
    mean = float(contact.weights[pressed] @ pressure[pressed] / (contact.weights[pressed].sum() or 1.0))
    return max(CUT * mean, 1.18 * float(pressure[~singular].max(initial=0.0))) or None


def cut_off(axes: Axes, top: float, zones: Sequence[str]) -> None:
    """End the frame at a pressure, and write above it that the pressure of zones is infinite."""
    axes.set_ylim(-0.05 * top, top)
    axes.set_title(cut_words(zones), loc="right", pad=16, fontsize=8.5, color=BLACK)


def cut_words(zones: Sequence[str]) -> str:
    """Write that the pressure of zones is infinite, and cut off."""
    return f"infinite in {', '.join(short_label(zone, 24) for zone in zones)}: cut off"


AROUND = "only around the contact"
SEAM = 1e-9
"""Round-off of a perimeter, relative to it."""
PIECE_COLOURS = (VERMILION, BLUE, GREEN, PURPLE, ORANGE, SKY)


@frozen_value
class Piece:
    """An unbroken piece of boundary in one contact zone, with its points (m,) in order.

    One with points all round ends at its first point. Arc positions go on counting across the place where they begin.
    """

    label: str
    order: int
    index: IntArray
    arc: Array
    run: int

    def place_of(self, arc: float, perimeter: float) -> float:
        """Count an arc position as this piece does; only one that closes on itself has a perimeter."""
        return arc + perimeter if arc < self.arc[0] and np.isfinite(perimeter) else arc

    @property
    def color(self) -> str:
        """Color of the piece, one of six."""
        return PIECE_COLOURS[self.order % len(PIECE_COLOURS)]

    @property
    def dashes(self) -> str:
        """Line style; only the first piece has a solid line."""
        return "dashed" if self.order else "solid"


def pieces_of(contact: CondensedContact, touching: BoolArray) -> Iterator[Piece]:
    """List the unbroken pieces of all contact zones, in the order of the contact points.

    No stretch of points that touch (n,) is cut in two where a piece closes on itself, unless all of it touches.
    """
    for order, run in enumerate(np.unique(contact.run).tolist()):
        index = contact.points_of_run(run)
        zone = int(contact.zone[index[0]])
        label = short_label(contact.zone_names[zone], 24)
        if len(np.unique(contact.run[contact.zone == zone])) > 1:
            label += f" ({contact.points[index[0], 0]:.3g}, {contact.points[index[0], 1]:.3g}) on"
        index, arc = _once_round(contact, index, touching[index])
        yield Piece(label=label, order=order, index=index, arc=arc, run=run)


def distance_label(contact: CondensedContact, pieces: Sequence[Piece]) -> str:
    """Label of the axis along some pieces: where one begins, and distances beyond the length of one that is closed."""
    unit = units_of(contact).length
    first = pieces[0].index[int(np.argmin(contact.arc_position[pieces[0].index]))]
    begins = len(pieces) == 1 and float(contact.arc_position[first]) == 0.0
    x, y = contact.points[first].tolist()
    begin = f"\nfrom {vector((x, y), scale=float(abs(contact.points).max()))}" * begins
    rounds = (float(contact.run_length[piece.run]) for piece in pieces)
    beyond = [length for piece, length in zip(pieces, rounds, strict=True) if piece.arc[-1] > length * (1 + SEAM)]
    label = labeled("distance along the contact zone", unit) + begin
    if not beyond:
        return label
    around = plain(with_unit(number(beyond[0]), unit))
    return f"{label}\nfrom {around} on it goes round again"


def only_around(label: str) -> str:
    """Add to the label of an axis that only the part around the contact is shown."""
    return f"{label}{'; ' if label.endswith(')') else chr(10)}{AROUND}"


def _once_round(contact: CondensedContact, index: IntArray, touching: BoolArray) -> tuple[IntArray, Array]:
    """Points (m,) of a run and their arc positions; a closed run begins and ends at one point that touches nothing.

    If a stretch of it has no points, as a round body turns away from a plane, it begins and ends there.
    """
    arc, perimeter, m = contact.arc_position[index], contact.run_length[contact.run[index[0]]], len(index)
    if not np.isfinite(perimeter):
        return index, arc
    steps, lengths = np.diff(arc, append=arc[0] + perimeter), contact.weights[index]
    pointless = np.where(steps > lengths + np.roll(lengths, -1), steps, 0.0)
    if pointless.any():
        around = np.arange(m) + int(pointless.argmax()) + 1
        return index[around % m], arc[around % m] + around // m * perimeter
    first = 0
    if (touching[0] or touching[-1]) and not touching.all():
        begins = np.flatnonzero(touching & ~np.roll(touching, -1))  # last points before the open stretches
        ends = np.array([np.argmax(np.roll(touching, -begin - 1)) + begin + 1 for begin in begins.tolist()])
        place = np.concatenate([arc, arc + perimeter])
        widest = int(np.argmax(place[ends] - place[begins]))
        begin, end = int(begins[widest]), int(ends[widest])
        middle = (place[begin] + place[end]) / 2
        first = begin + 1 + int(np.argmin(np.abs(place[begin + 1 : end] - middle)))
    around = np.arange(first, first + m + 1)
    turns = around // m - first // m
    return index[around % m], arc[around % m] + turns * perimeter


def show_decades(axes: Axes) -> None:
    """Make the vertical axis logarithmic with a few decades; a text says so if all values are zero."""
    if not any((np.asarray(line.get_ydata(), float) > 0).any() for line in axes.lines):
        axes.text(0.5, 0.5, "zero, to the last digit", transform=axes.transAxes, ha="center", color=BLACK)
        return
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(numticks=7))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0e}"))


def legend_below(axes: Axes) -> None:
    """Put the legend below the axes, where it covers nothing."""
    axes.spines[["top", "right"]].set_visible(False)
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        columns = 3 if max(map(len, labels)) < 14 else 2 if max(map(len, labels)) < 30 else 1
        below = -0.2 - 0.08 * axes.get_xlabel().count("\n")
        axes.legend(loc="upper center", bbox_to_anchor=(0.45, below), ncols=columns, frameon=False, fontsize=8.5)
