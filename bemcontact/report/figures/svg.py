"""Pictures as SVG for light and dark pages, with no more points than can be seen."""

import re
from collections.abc import Iterator, Mapping

import numpy as np
from matplotlib.figure import Figure

from bemcontact.arrays import Array, BoolArray, IntArray
from bemcontact.report.figures.page import (
    AMBER,
    BLACK,
    BLUE,
    BODIES,
    DATES,
    GREEN,
    GREY,
    PURPLE,
    VERMILION,
    file_content,
)

INK = "#e8eaed"
"""Color on a dark page of what is black on paper."""

IN_THE_DARK = {
    "#000000": INK,
    BLACK: INK,
    "#ffffff": "#16191d",
    **dict(zip(BODIES, ("#2a3038", "#3a3426", "#25362d", "#372c37", "#3b2d28", "#22333c"), strict=True)),
    GREY: "#9aa2ac",
    BLUE: "#4ea8de",
    GREEN: "#2fc08f",
    VERMILION: "#f0803c",
    PURPLE: "#dd9cc0",
    AMBER: "#ecc765",
}
"""Color on paper -> color on a dark page, for those that would not be seen there."""
UNSEEN = 4
"""Distance from a line, in hundredths of a typographic point, within which points of it are left out."""


def vector_graphic(figure: Figure) -> bytes:
    """Write a figure as transparent SVG for light and dark pages; the bytes depend on the figure alone.

    Matplotlib writes colors as style attributes, which a style sheet can overrule. The style sheet added here does so
    on dark pages.
    """
    metadata = {DATES["svg"]: None, "Creator": None, "Format": None, "Type": None}
    picture = file_content(figure, {"svg.fonttype": "path"}, 0.08, format="svg", transparent=True, metadata=metadata)
    written = re.sub(r'(?<= d=")[^"]*', _shortened, picture.decode())
    written = re.sub(r'(?<= [xy]=")-?[\d.]+', lambda place: _decimal(round(100 * float(place[0]))), written)
    return written.replace("</style>", f"{_style_sheet()}</style>", 1).encode()


def vector_graphics(figures: Mapping[str, Figure]) -> dict[str, bytes]:
    """Write figures by name, as `vector_graphic` does."""
    return {name: vector_graphic(figure) for name, figure in figures.items()}


def _style_sheet() -> str:
    """Style sheet with the colors for a dark page; text without a color takes that of the whole picture."""
    rules = [
        f'[style*="{kind}: {paper}"] {{ {kind}: {dark} !important }}'
        for paper, dark in IN_THE_DARK.items()
        for kind in ("fill", "stroke")
    ]
    dark = "\n".join((f"svg {{ fill: {INK} }}", *rules))
    return f"\nsvg {{ color-scheme: light dark }}\n@media screen and (prefers-color-scheme: dark) {{\n{dark}\n}}\n"


def _shortened(path: re.Match[str]) -> str:
    """Write a path in hundredths of a point; of straight lines with the points that are needed, one from the other."""
    if "Q" in path[0] or "C" in path[0]:
        rounded = re.sub(r"-?\d+\.\d+", lambda number: _decimal(round(100 * float(number[0]))), path[0])
        return re.sub(r"\s*([MLQCz])\s*", r"\1", rounded)
    return "".join(_lines(path[0]))


def _lines(path: str) -> Iterator[str]:
    """Write each unbroken line of a path."""
    for line in re.findall(r"M([^Mz]*)(z?)", path):
        numbers = np.array(re.findall(r"-?[\d.]+(?:e-?\d+)?", line[0]), float)
        points = np.rint(100 * numbers).astype(int).reshape(-1, 2)
        points = points[needed(points)]
        begin, *steps = (f"{_decimal(x)} {_decimal(y)}" for x, y in [points[0], *np.diff(points, axis=0)])
        yield f"M{begin}l{' '.join(steps)}".replace(" -", "-").removesuffix("l") + line[1]


def needed(points: IntArray) -> BoolArray:
    """Which points (k, 2) a line needs so that none of the others is farther than `UNSEEN` from it.

    References
    ----------
    Douglas and Peucker, Cartographica 10 (1973), 112-122
    """
    kept = np.zeros(len(points), bool)
    kept[[0, -1]] = True
    pairs = [(0, len(points) - 1)]
    while pairs:
        first, last = pairs.pop()
        if last - first < 2:
            continue
        away = _distances(points[first + 1 : last] - points[first], points[last] - points[first])
        farthest = int(away.argmax())
        if away[farthest] > UNSEEN:
            kept[middle := first + 1 + farthest] = True
            pairs += [(first, middle), (middle, last)]
    return kept


def _distances(points: Array, end: Array) -> Array:
    """Distances of points (k, 2) from the line from the origin to an end (2,)."""
    along = np.clip(points @ end / max(int(end @ end), 1), 0, 1)
    return np.hypot(*(points - along[:, None] * end).T)


def _decimal(hundredths: int) -> str:
    """Write a number of hundredths with no needless digit."""
    return re.sub(r"^(-?)0\.", r"\1.", f"{hundredths / 100:.2f}".rstrip("0").rstrip("."))
