"""Problems to draw, and what has been drawn on axes."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from scipy.spatial import KDTree
from several_bodies import block, elastic, polygon, rigid
from several_bodies import problem as several

from bemcontact.problems import Problem


def line(name: str, start: list[float], elements: int) -> dict:
    return {"name": name, "start": start, "elements": elements}


def block_in_a_corner() -> Problem:
    """A square plate with a hole, pressed into the corner of a floor and a wall that recedes below its middle."""
    hole = {"kind": "arc", "name": "hole", "center": [1, 1], "radius": 0.4, "angles": [360, 0], "elements": 8}
    bottom, right = line("bottom", [0, 0], 4), line("right", [2, 0], 4)
    top, left = line("top", [2, 2], 4), line("left", [0, 2], 4)
    floor = {"kind": "plane", "point": [0, 0], "normal": [0, 2]}
    wall = {"kind": "polyline", "points": [[0, 3], [0, 1.2], [-0.05, 0]]}
    return Problem(
        name="a block, $x$ in a \\corner",
        units={"length": "mm", "force": "N"},
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={"outer": [bottom, right, top, left], "holes": [[hole]]},
        conditions={"top": {"pressure": {"constant": 3, "x": 1}}, "right": {"traction": {"x": -2, "y": 0}}},
        loads={"gravity": {"density": 1e-3, "acceleration": [0, -9.81]}},
        contact_zones={"floor": {"edges": "bottom", "surface": floor}, "wall": {"edges": "left", "surface": wall}},
    )  # pyright: ignore


def beam_over_a_circle() -> Problem:
    """A long clamped beam that bends onto a large circle, with a symmetry condition at its end."""
    outer = [line("under", [0, 0], 12), line("end", [50, 0], 2), line("top", [50, 5], 10), line("clamp", [0, 5], 2)]
    surface = {"kind": "circle", "center": [50, -101], "radius": 100, "body": "outside"}
    return Problem(
        name="beam",
        material={"young_modulus": 2e4, "poisson_ratio": 0.29},
        boundary={"outer": outer},
        conditions={
            "clamp": {"displacement": {"x": 0, "y": 0}},
            "end": {"displacement": {"x": 0}},
            "top": {"traction": {"y": -3.6}},
        },
        contact_zones={"drum": {"edges": ["under"], "surface": surface}},
    )  # pyright: ignore


def seal_in_a_groove() -> Problem:
    """A round body pressed on a floor by a loaded lid; it stands beside a wall, and touches it without pressure."""
    ring = {"kind": "arc", "name": "ring", "center": [0, 0], "radius": 2, "angles": [0, 360], "elements": 32}
    planes = {"floor": ([0, -2], [0, 1]), "wall": ([-2, 0], [1, 0]), "lid": ([0, 2], [0, -1])}
    return Problem(
        name="seal",
        material={"young_modulus": 100, "poisson_ratio": 0.3},
        boundary={"outer": [ring]},
        contact_zones={
            name: {"edges": "ring", "surface": {"kind": "plane", "point": point, "normal": normal}}
            for name, (point, normal) in planes.items()
        },
        tools={"lid": {"zones": "lid", "point": [0, 2], "force": {"y": -5}}},
    )  # pyright: ignore


def strokes(axes: Axes) -> Iterator[np.ndarray]:
    for collection in axes.collections:
        if isinstance(collection, LineCollection):
            yield from map(np.asarray, collection.get_segments())


def outlines(axes: Axes, color: str) -> np.ndarray:
    """All points of the outlines of bodies in a color."""
    patches = (
        patch for patch in axes.patches if isinstance(patch, PathPatch) and patch.get_edgecolor() == to_rgba(color)
    )
    return np.concatenate([np.asarray(patch.get_path().vertices) for patch in patches])


def off(points: np.ndarray, line: np.ndarray) -> float:
    """The largest distance of a point (..., 2) from the nearest of those of a line (j, 2)."""
    return float(KDTree(line).query(points.reshape(-1, 2))[0].max())


def only_axes(figure: Figure) -> Axes:
    (axes,) = figure.axes
    return axes


def grey_lines(axes: Axes) -> list[np.ndarray]:
    return [np.column_stack(line.get_data()) for line in axes.lines if line.get_color() == "#7d838c"]


def curves(axes: Axes) -> dict[str, Line2D]:
    """What the legend names."""
    return {str(line.get_label()): line for line in axes.lines if not str(line.get_label()).startswith("_")}


def drawn(line: Line2D) -> np.ndarray:
    return np.asarray(line.get_ydata(), float)


def hub_on_a_shaft() -> Problem:
    """A quarter of a hub that is pressed on a shaft of radius 2 with an interference of 0.002, not drawn."""
    walls = {"floor": {"displacement": {"y": 0}}, "wall": {"displacement": {"x": 0}}}
    arc = {"kind": "arc", "center": [0, 0], "elements": 8}
    shaft = [
        {"name": "floor", "start": [0, 0], "end": [2, 0], "elements": 3},
        {**arc, "name": "rim", "radius": 2, "angles": [0, 90]},
        {"name": "wall", "elements": 3},
    ]
    hub = [
        {"name": "floor", "start": [2, 0], "end": [4, 0], "elements": 3},
        {**arc, "name": "outside", "radius": 4, "angles": [0, 90]},
        {"name": "wall", "elements": 3},
        {**arc, "name": "bore", "radius": 2, "angles": [90, 0]},
    ]
    bodies = {name: elastic({"outer": edges}, walls) for name, edges in {"shaft": shaft, "hub": hub}.items()}
    return several(bodies, fit={"between": ["shaft/rim", "hub/bore"], "gap": -0.002})


def roller_in_a_groove() -> Problem:
    """A heavy roller in a rigid V-block, which it touches at two places far apart."""
    rim = {"name": "rim", "kind": "arc", "center": [0, 14.142135623730951], "radius": 10, "angles": [90, 450]}
    roller = elastic(
        {"outer": [{**rim, "elements": 128}]}, loads={"gravity": {"density": 1, "acceleration": [0, -0.02]}}
    )
    block = rigid(
        polygon(
            bottom=(-20, -10), right=(20, -10), over=(20, 12), to_the_right=(12, 12), to_the_left=(0, 0),
            beside=(-12, 12), left=(-20, 12),
        )
    )  # fmt: skip
    return several({"roller": roller, "block": block}, seat=["roller", "block"])


def leaves() -> Problem:
    """A long leaf on a short one, both held at one end: too slender for two lines of text."""
    held = {"left": {"displacement": {"x": 0, "y": 0}}}
    long = block((0, 100), (0, 4), (24, 2, 24, 2))
    short = block((0, 60), (-4, 0), (16, 2, 16, 2))
    bodies = {"long": elastic(long, {**held, "right": {"traction": {"y": -0.01}}}), "short": elastic(short, held)}
    return several(bodies, leaves=["short/top", "long/bottom"])


def shaft_in_a_ring_in_a_housing() -> Problem:
    """A rigid shaft presses an elastic ring down in a rigid housing, which is a square with a round hole."""

    def circle(name: str, radius: float, angles: list[float], elements: int) -> dict:
        center = [0, 0]
        return {"name": name, "kind": "arc", "center": center, "radius": radius, "angles": angles, "elements": elements}

    ring = {"outer": [circle("rim", 20, [-90, 270], 32)], "holes": [[circle("bore", 14, [270, -90], 32)]]}
    square = polygon(below=(-30, -30), right=(30, -30), above=(30, 30), left=(-30, 30))
    housing = {"outer": square["outer"], "holes": [[circle("seat", 20.001, [270, -90], 8)]]}
    bodies = {
        "ring": elastic(ring),
        "shaft": rigid({"outer": [circle("shaft", 13.999, [-90, 270], 8)]}),
        "housing": rigid(housing),
    }
    drawn = several(bodies, bore=["ring/bore", "shaft/shaft"], seat=["ring/rim", "housing/seat"])
    return Problem.model_validate({**drawn.to_dict(), "tools": {"shaft": {"zones": "bore", "force": {"y": -5}}}})
