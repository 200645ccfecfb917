"""The page that pictures stand on: colours, formats, axes with units."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from bemcontact.report import output

Array = NDArray[np.float64]

FORMATS = (".png", ".svg", ".pdf")
"""Endings of the files that can be written."""

# The palette of Okabe and Ito, which colour-blind people can tell apart.
BLACK, BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY = (
    "#222222", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"
)  # fmt: skip
GREY, BODY = "#7d838c", "#e8ecf2"


def ensure_known_format(path: Path) -> None:
    """Raise `ValueError` unless the file name ends in one of `FORMATS`."""
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: a picture is written as {', '.join(FORMATS)}; end the file name in one of them")


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format that the file name's ending says, whole or not at all."""
    ensure_known_format(path)
    with output.whole_file(path) as temporary:
        figure.savefig(temporary, format=path.suffix.lower()[1:], dpi=160, bbox_inches="tight", pad_inches=0.15)


def new_page(width: float, height: float) -> Figure:
    """Make an empty figure of this size in inches."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def plain(text: str) -> str:
    """Take away the meaning of what matplotlib would read as mathematics."""
    return text.replace("\\", r"\\").replace("$", r"\$") if "$" in text else text


def labelled(quantity: str, unit: str) -> str:
    """Write a quantity with its unit, if there is one."""
    return f"{quantity} [{plain(unit)}]" if unit else quantity


def frame_plan(axes: Axes, drawn: Array, unit: str) -> None:
    """Show all drawn points (k, 2) of a plan with some air around them, x and y to one scale."""
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    air = 0.06 * float((high - low).max())
    axes.set_xlim(low[0] - air, high[0] + air)
    axes.set_ylim(low[1] - air, high[1] + air)
    axes.set_aspect("equal")
    axes.set_xlabel(labelled("x", unit))
    axes.set_ylabel(labelled("y", unit))
    axes.spines[["top", "right"]].set_visible(False)
