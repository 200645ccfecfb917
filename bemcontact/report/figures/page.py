"""The page that pictures stand on: colours, formats, axes with units."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import wrap

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bemcontact.arrays import Array
from bemcontact.files import output

FORMATS = (".png", ".svg", ".pdf")
"""Endings of the files that can be written."""

DATES = {"svg": "Date", "pdf": "CreationDate"}
"""Format -> the key of its metadata that would make each file another."""

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
    """Write a figure in the format that the file name's ending says, whole or not at all; the same each time."""
    ensure_known_format(path)
    ending = path.suffix.lower()[1:]
    undated = {DATES[ending]: None} if ending in DATES else {}
    with output.whole_file(path) as temporary, rc_context({"svg.hashsalt": "bemcontact"}), without_glyph_warnings():
        figure.savefig(temporary, format=ending, dpi=160, bbox_inches="tight", pad_inches=0.15, metadata=undated)


@contextmanager
def without_glyph_warnings() -> Iterator[None]:
    """Draw a box for a letter that the font lacks, and say nothing."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph", UserWarning)
        yield


def new_page(width: float, height: float) -> Figure:
    """Make an empty figure of this size in inches."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def plain(text: str) -> str:
    """Take away the meaning of what matplotlib would read as mathematics."""
    return text.replace("\\", r"\\").replace("$", r"\$") if "$" in text else text


def wrapped(text: str, columns: int) -> str:
    """Break a user's text into three lines of so many letters at most, and take the meaning of mathematics away."""
    return plain("\n".join(wrap(text, columns, max_lines=3, placeholder=" …")))


def shortened(text: str, columns: int) -> str:
    """Cut a user's text to so many letters, and take the meaning of mathematics away."""
    return plain(text if len(text) <= columns else f"{text[: columns - 1]}…")


def labelled(quantity: str, unit: str) -> str:
    """Write a quantity with its unit, if there is one."""
    return f"{quantity} [{plain(unit)}]" if unit else quantity


def frame_plan(axes: Axes, drawn: Array, unit: str) -> None:
    """Show all drawn points (k, 2) of a plan with some air around them, more around slender ones; one scale."""
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    longest = float((high - low).max())
    air = longest * (0.12 if (high - low).min() < longest / 3 else 0.06)
    axes.set_xlim(low[0] - air, high[0] + air)
    axes.set_ylim(low[1] - air, high[1] + air)
    axes.set_aspect("equal")
    axes.set_xlabel(labelled("x", unit))
    axes.set_ylabel(labelled("y", unit))
    axes.spines[["top", "right"]].set_visible(False)
