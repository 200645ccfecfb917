"""Pictures as SVG that stand on light and on dark pages: transparent, the same each time, text as outlines."""

import re
from io import BytesIO

from matplotlib import rc_context
from matplotlib.figure import Figure

from bemcontact.report.figures.page import (
    BLACK,
    BLUE,
    BODY,
    DATES,
    GREEN,
    GREY,
    PURPLE,
    VERMILION,
    without_glyph_warnings,
)

INK = "#e8eaed"
"""What is black on paper, on a dark page."""

IN_THE_DARK = {
    "#000000": INK,
    BLACK: INK,
    "#ffffff": "#16191d",
    BODY: "#2a3038",
    GREY: "#9aa2ac",
    BLUE: "#4ea8de",
    GREEN: "#2fc08f",
    VERMILION: "#f0803c",
    PURPLE: "#dd9cc0",
}
"""Colour on paper -> colour on a dark page, for those that would not be seen there."""


def vector_graphic(figure: Figure) -> bytes:
    """Write a figure as SVG.

    Matplotlib writes colours as style attributes, which a style sheet may overrule. The one put in here does where the
    page around the picture is dark; on paper it never does.

    Parameters
    ----------
    figure : with its canvas

    Returns
    -------
    bytes
        The same for the same figure, whenever it is written.
    """
    stream = BytesIO()
    with rc_context({"svg.hashsalt": "bemcontact", "svg.fonttype": "path"}), without_glyph_warnings():
        figure.savefig(
            stream,
            format="svg",
            transparent=True,
            bbox_inches="tight",
            pad_inches=0.08,
            metadata={DATES["svg"]: None, "Creator": None, "Format": None, "Type": None},
        )
    written = re.sub(r' d="[^"]*"', _rounded, stream.getvalue().decode())
    return written.replace("</style>", f"{_style_sheet()}</style>", 1).encode()


def _style_sheet() -> str:
    """Repaint for a dark page; what has no colour of its own, as most text, takes that of the whole picture."""
    rules = [
        f'[style*="{kind}: {paper}"] {{ {kind}: {dark} !important }}'
        for paper, dark in IN_THE_DARK.items()
        for kind in ("fill", "stroke")
    ]
    dark = "\n".join((f"svg {{ fill: {INK} }}", *rules))
    return f"\nsvg {{ color-scheme: light dark }}\n@media screen and (prefers-color-scheme: dark) {{\n{dark}\n}}\n"


def _rounded(path: re.Match[str]) -> str:
    """Write the points of a path with two decimals, a hundredth of a typographic point, and without needless space."""
    rounded = re.sub(r"-?\d+\.\d+", lambda number: f"{round(float(number[0]), 2) + 0.0:.8g}", path[0])
    return re.sub(r"\s*([MLQCz])\s*", r"\1", rounded)
