"""The picture of several load cases: their pressures over one another, and a bar for each peak."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.report.figures.page import BLACK, GREY, VERMILION, labelled, new_page, shortened, wrapped
from bemcontact.report.figures.pieces import PIECE_COLOURS, pieces_of
from bemcontact.report.figures.result import figure_of_result
from bemcontact.report.formatting import units_of

INCHES = 9
DASHES = ("solid", "dashed", "dotted", "dashdot")
"""Line styles of unbroken pieces of boundary."""


def figure_of(found: Result | CaseResults) -> Figure:
    """Compose the page of an answer, or of the answers to all load cases."""
    return figure_of_result(found) if isinstance(found, Result) else figure_of_cases(found)


def figure_of_cases(found: CaseResults) -> Figure:
    """Compose a page with the pressures and the peak pressures of all load cases."""
    figure = new_page(INCHES, 6)
    above, below = figure.subplots(2, 1, height_ratios=(3, 1))
    for axes in (above, below):
        axes.spines[["top", "right"]].set_visible(False)
    draw_case_pressures(above, found)
    draw_case_peaks(below, found)
    verdict = "all certified" if found.certified else "NOT all certified"
    title = f"{wrapped(found.name, 6 * INCHES)}: {verdict}"
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold", color=BLACK if found.certified else VERMILION)
    return figure


def draw_case_pressures(axes: Axes, found: CaseResults) -> None:
    """Draw the contact pressure of each load case, per undeformed length, over the distance along each piece."""
    first = next(iter(found.results.values()))
    for number, (name, result) in enumerate(found.results.items()):
        contact, colour = result.contact, PIECE_COLOURS[number % len(PIECE_COLOURS)]
        width = 2.2 if number < len(PIECE_COLOURS) else 1.2
        for piece in pieces_of(contact):
            along, pressure = contact.arc_position[piece.index], result.solution.pressure[piece.index]
            label, dashes = None if piece.order else shortened(name, 30), DASHES[piece.order % len(DASHES)]
            axes.plot(along, pressure, color=colour, linestyle=dashes, linewidth=width, label=label)
    labels = [f"{DASHES[piece.order % len(DASHES)]}: {piece.label}" for piece in pieces_of(first.contact)]
    if len(labels) > 1:
        axes.set_title("; ".join(labels), loc="left", fontsize=9, color=GREY)
    axes.axhline(0, color=GREY, linewidth=0.8)
    axes.set_xlabel(labelled("distance along the contact zone", units_of(first.contact).length))
    axes.set_ylabel(labelled("pressure", units_of(first.contact).stress) + "\nper undeformed length")
    axes.legend(frameon=False, fontsize=8.5)


def draw_case_peaks(axes: Axes, found: CaseResults) -> None:
    """Draw a bar for the peak pressure of each load case."""
    first = next(iter(found.results.values()))
    peaks = [result.footprint.peak.pressure if result.footprint.peak else 0.0 for result in found.results.values()]
    colours = [PIECE_COLOURS[number % len(PIECE_COLOURS)] for number in range(len(peaks))]
    bars = axes.barh([shortened(name, 30) for name in found.results], peaks, color=colours)
    axes.bar_label(bars, fmt="%.5g", padding=3)
    axes.margins(x=0.12)
    axes.invert_yaxis()
    axes.set_xlabel(labelled("peak pressure", units_of(first.contact).stress))
