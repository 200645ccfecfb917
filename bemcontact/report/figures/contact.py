"""Pictures of the deformed body: the contact to scale with the pressure as a fan, and the magnified shape."""

from collections.abc import Callable, Iterator, Sequence
from itertools import islice

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path
from scipy.spatial import KDTree

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.mesh import element_curves
from bemcontact.frozen import frozen_value
from bemcontact.options import StressMeasure
from bemcontact.problems import Problem
from bemcontact.report.bars import with_bar, without_digits_beyond
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import LEVEL
from bemcontact.report.figures.page import (
    BLACK,
    CUT,
    GREY,
    VERMILION,
    add_path,
    frame_plan,
    name_axis,
    pieces_of,
    plain,
    settle,
    short_label,
    without_glyph_warnings,
    wrapped,
)
from bemcontact.report.figures.problem import (
    Displacement,
    body_names,
    draw_loads,
    draw_supports,
    draw_weights,
    fills,
)
from bemcontact.report.figures.stress import fill_with_stress
from bemcontact.report.figures.surfaces import Surface, surfaces_of
from bemcontact.report.figures.symbols import BACKING, Name, covered_by, draw_arrows, draw_ground, place_names
from bemcontact.report.formatting import with_unit

VISIBLE = 0.005
"""Largest displacement over the size of the body from which on the undeformed outline is drawn."""
TALL, LEAST = 0.3, 0.13
"""Length of the fan over the root of width times height, but at least over the diagonal, of what is shown."""
CROSSING = 0.45
"""Share of the distance at which the normals of a hollow boundary cross that the fan may have."""
BENT = 0.2
"""Turn of the normals of a fan, in radians, from which on their crossing would be seen."""
CLOSE, AROUND = 0.35, 1.0
"""Extent of a contact over that of the body below which it has a close-up, and the extents to either side there."""
APART = 2.0
"""Distance of two contacts over the extent of one from which a close-up shows only one of them."""
NUMBERS = 4
"""Most contacts whose largest pressures are written into the picture of all bodies."""
WHOLE = 0.5
"""Length of a rigid body that is shown beyond the elastic ones, over the size of what is shown."""
ROOM = 1.5
"""Room for a fan and its number over the length of the fan."""
OVERHANG = 0.14
"""Length of a rigid surface beyond its contact zone, and beyond the body, over the size of what is shown."""
HATCH = 0.025
"""Depth of hatching over the size of what is shown."""
SAMPLED = 240
"""Places along a rigid surface beside which its name may stand."""
SEAM = 1e-6
"""Distance of the ends of a line over its extent up to which it is closed."""
MANY_ELEMENTS = 36
"""Number of elements from which their nodes alone show the curves."""


@frozen_value
class Fan:
    """Pressure (j,) on an unbroken stretch of contact, with deformed points (j, 2) and unit normals (j, 2).

    `zone` is the name of its zone.
    """

    feet: Array
    normals: Array
    pressure: Array
    zone: str

    @property
    def peak(self) -> float:
        """Largest pressure."""
        return float(self.pressure.max())

    @property
    def closed(self) -> bool:
        """Whether it goes all round a hole."""
        return bool((self.feet[0] == self.feet[-1]).all())

    @property
    def mean(self) -> float:
        """Mean pressure over the length."""
        steps = np.hypot(*np.diff(self.feet, axis=0).T)
        return float(steps @ (self.pressure[1:] + self.pressure[:-1]) / (2 * steps.sum()))

    def longest(self, scale: float) -> float:
        """Length at the pressure `scale` at which normals that are seen to bend would cross."""
        steps, turns = np.diff(self.feet, axis=0), np.diff(self.normals, axis=0)
        if np.hypot(*turns.T).sum() < BENT:
            return np.inf
        pressure = np.minimum(self.pressure[1:], self.pressure[:-1])  # a normal without pressure has no length
        closing = np.maximum((steps * turns).sum(axis=1) * pressure / scale, 0.0)
        return float(1 / (closing / (steps**2).sum(axis=1)).max()) if closing.any() else np.inf


@frozen_value
class Setting:
    """What pictures side by side share: a window, two corners (2, 2), and the pressure and length of the longest fan.

    A `part` of the body that a close-up shows has no supports and no loads. The longest arrow is that of the largest
    traction in each picture, or of a `load` in all.
    """

    window: Array
    pressure: float
    length: float
    part: bool
    load: float = 0.0

    @property
    def size(self) -> float:
        """Diagonal of the window."""
        return float(np.hypot(*np.ptp(self.window, axis=0)))


def setting_of(results: Sequence[Result], zone: str | None = None) -> Setting:
    """Choose what shows the deformed body, or the contact of a zone, in all results; fans are long and do not cross."""
    states = [result.boundary for result in results if result.boundary is not None]
    fans = [
        [fan for fan in _fans(result, result.boundary) if zone in (None, fan.zone)]
        for result in results if result.boundary is not None
    ]  # fmt: skip
    part = zone is not None and any(fans)
    if zone is not None and part:
        windows = [_around(_region(own)) for own in fans if own]
    else:
        windows = [_curves(state)[1].reshape(-1, 2) for state in states]
    places = np.concatenate(windows)
    window = np.array([places.min(axis=0), places.max(axis=0)])
    pressure = max((fan_scale(own) for own in fans if own), default=1.0)
    width, height = np.ptp(window, axis=0)
    length = max(TALL * float(np.sqrt(width * height)), LEAST * float(np.hypot(width, height)))
    crossings = [CROSSING * fan.longest(pressure) for own in fans for fan in own]
    return Setting(window=window, pressure=pressure, length=min([length, *crossings]), part=part)


def _peak_text(fan: Fan, fans: Sequence[Fan], bar: float | None) -> str:
    """The largest pressure of a piece of contact, with the error bar of its zone if it may be the largest there."""
    largest = fan.peak >= max(other.peak for other in fans if other.zone == fan.zone) - (bar or 0.0)
    return with_bar(fan.peak, bar) if largest else without_digits_beyond(fan.peak, bar)


def close_ups(result: Result, share: float = CLOSE) -> list[str]:
    """Names of the zones whose contact is smaller than this share of the body, so that only a close-up shows it."""
    state = result.boundary
    if state is None:
        return []
    size = max(body_extent(state))
    fans = [*_fans(result, state)]
    return [
        zone for zone in result.contact.zone_names if (own := [fan for fan in fans if fan.zone == zone])
        and float(np.ptp(_region(own), axis=0).max()) < share * size
    ]  # fmt: skip


def draw_contact(
    axes: Axes,
    result: Result,
    zone: str | None = None,
    stress: StressMeasure | None = None,
) -> None:
    """Draw the deformed body to scale, its supports and loads, the rigid surfaces, and the pressure as a fan.

    The fan lies outside the body, along the normals of the rigid surface. The largest pressure of each unbroken piece
    of contact is written beside it; one that is infinite is cut off and written as such. Of a `zone` only its contact
    is drawn, with as much of the body to either side, without supports and loads; if it has several contacts far from
    each other, that with the largest pressure. Of many zones only the largest pressure is written, with its zone. With
    a `stress` the body is filled with its contours. `ValueError` for the result of a condensed problem.
    """
    write = sketch_contact(axes, result, zone, stress=stress)
    settle(axes)
    write()


def sketch_contact(
    axes: Axes,
    result: Result,
    zone: str | None = None,
    setting: Setting | None = None,
    stress: StressMeasure | None = None,
    *,
    numbers: bool = True,
) -> Callable[[], None]:
    """Draw as `draw_contact` does, and return what writes numbers and names; call it when the whole page is settled.

    The setting is that of the result alone if there is none for several.
    """
    state, problem, units = result.boundary, result.problem, units_of(result.contact)
    if state is None or problem is None:
        raise ValueError("the result of a condensed problem has no boundary to draw")
    bodies = _draw_bodies(axes, problem, state)
    loops = [loop for own in bodies for loop in own]
    setting = setting or setting_of([result], zone)
    window, size, part = setting.window, setting.size, setting.part
    every = [fan for fan in _fans(result, state) if not part or zone == fan.zone]
    fans = [fan for fan in every if not part or _seen(fan, window)]
    reach = size if part else OVERHANG * size
    surfaces = [*surfaces_of(result, problem, reach)]
    grounds = [draw_ground(axes, it.points, it.normals, HATCH * size, GREY) for it in surfaces]
    covered = [framed(ground.covered, it, window, size) for ground, it in zip(grounds, surfaces, strict=True)]
    symbols = list[Array]()
    if not part:
        displacement = _displacement(state)
        symbols = [*draw_supports(axes, problem, displacement), *draw_loads(axes, problem, displacement, setting.load)]
        symbols += draw_weights(axes, problem, displacement)
    infinite, scale, length = result.accuracy.infinite, setting.pressure, setting.length
    names, tips, largest = list[Name](), list[Array](), ""
    touched = {fan.zone for fan in fans}
    for fan in fans:
        tips.append(fan.feet - length * np.minimum(fan.pressure / scale, 1.0)[:, None] * fan.normals)
        _draw_fan(axes, fan, tips[-1], 0.03 * size)
        crowded = len(touched) > NUMBERS
        if not numbers or (crowded and fan.peak < max(other.peak for other in fans)):
            continue  # numbers of more contacts could not be told apart
        if fan.zone not in infinite:
            text = with_unit(_peak_text(fan, fans, result.accuracy.peak_bar(fan.zone)), plain(units.stress))
            if crowded:
                largest = f"\nlargest pressure: {short_label(fan.zone, 24)}, {text}"
                continue
            names.append(_label(fan, tips[-1], text, cut=fan.peak > scale * (1 + LEVEL)))
        elif fan.peak == max(other.peak for other in fans if other.zone == fan.zone):
            names.append(_label(fan, tips[-1], "infinite", cut=True))
    beyond = [fan.feet + ROOM * (tip - fan.feet) for fan, tip in zip(fans, tips, strict=True)]
    drawn = np.concatenate([window, *beyond, *([] if part else covered), *symbols])
    frame_plan(axes, drawn, units.length)
    if not part:
        names += [*body_names(problem, bodies, optional=True), *_surface_names(axes, problem, surfaces, HATCH * size)]
    if len(fans) < len(every):
        largest += f"\n{len(fans)} of {len(every)} contacts of this zone"
    if largest:
        name_axis(axes.xaxis, axes.get_xlabel() + largest)
    if stress is not None:
        fill_with_stress(axes, result, stress, window=window if part else None)

    def write() -> None:
        with without_glyph_warnings():
            inked = [*loops, *covered_by(grounds), *symbols, *map(_inked, fans, tips)]
            place_names(axes, names, np.concatenate(inked), bodies, grounds)
        for text in axes.texts:
            text.set_bbox(BACKING)

    return write


def _surface_names(axes: Axes, problem: Problem, surfaces: Sequence[Surface], depth: float) -> Iterator[Name]:
    """Names of rigid bodies, and of other rigid surfaces by their zones, where there are several things to tell apart.

    They are placed in what is rigid, as far as it is shown, or behind its hatching of a depth.
    """
    lines: dict[str, list[Surface]] = {}
    for surface in surfaces:
        lines.setdefault(surface.name, []).append(surface)
    if len(lines) + len(problem.parts) < 3:
        return
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    shares = np.stack(np.meshgrid(*2 * [np.linspace(0.02, 0.98, 25)]), axis=-1).reshape(-1, 2)
    for name, own in lines.items():
        along, away = (np.concatenate(parts) for parts in zip(*map(_sampled, own), strict=True))
        shown = ((along > low) & (along < high)).all(axis=1)
        along, away = along[shown], away[shown]
        places, closed = np.zeros((0, 2)), all(_closes(it) for it in own)
        if closed:
            corner, end = (side(np.concatenate([it.points for it in own]), axis=0) for side in (np.min, np.max))
            places = np.maximum(corner, low) + shares * (np.minimum(end, high) - np.maximum(corner, low))
            solid = np.logical_xor.reduce([Path(it.points).contains_points(places) for it in own])
            places = places[solid]
            if len(places) and len(along):
                places = places[np.argsort(-KDTree(along).query(places)[0], kind="stable")]
        if not len(along) and not len(places):
            continue
        some = np.unique(np.linspace(0, max(len(along) - 1, 0), 16).astype(int)) if len(along) else []
        behind, before = (along - depth * away)[some], along[some if closed else []]
        yield Name(
            text=wrapped(name, 20),
            color=BLACK,
            anchors=np.concatenate([places, behind, before]),
            directions=np.concatenate([np.zeros_like(places), -away[some], away[some if closed else []]]),
            optional=True,
        )


def _sampled(surface: Surface) -> tuple[Array, Array]:
    """Evenly spaced points (k, 2) of a line, and its normals there."""
    s = np.concatenate([[0.0], np.hypot(*np.diff(surface.points, axis=0).T).cumsum()])
    at = np.linspace(0, s[-1], SAMPLED)
    points = np.column_stack([np.interp(at, s, surface.points[:, i]) for i in (0, 1)])
    return points, surface.normals[np.clip(np.searchsorted(s, at), 0, len(s) - 1)]


def _closes(surface: Surface) -> bool:
    """Whether a line goes round something rigid."""
    ends = surface.points[[0, -1]]
    if np.hypot(*(ends[1] - ends[0])) > SEAM * np.hypot(*np.ptp(surface.points, axis=0)):
        return False
    outward = surface.points - surface.points.mean(axis=0)
    return surface.body or bool((outward * surface.normals).sum() > 0)


def framed(ground: Array, surface: Surface, window: Array, size: float) -> Array:
    """The points (k, 2) of a drawn surface, moved into what is shown of it around a window, two corners (2, 2)."""
    reach = (WHOLE if surface.body else OVERHANG) * size
    return np.clip(ground, window[0] - reach, window[1] + reach)


def _inked(fan: Fan, tips: Array) -> Array:
    """Points (k, 2) all over a fan."""
    at = np.linspace(0, len(tips) - 1, max(4 * len(tips), 50))
    rows = [[np.interp(at, np.arange(len(line)), line[:, i]) for i in (0, 1)] for line in (fan.feet, tips)]
    feet, ends = np.moveaxis(np.array(rows), 1, 2)
    return (feet + np.linspace(0, 1, 9)[:, None, None] * (ends - feet)).reshape(-1, 2)


def _draw_bodies(axes: Axes, problem: Problem, state: BoundaryState) -> list[list[Array]]:
    """Draw the deformed bodies, and undeformed outlines where they differ visibly; return loops (j, 2) of each."""
    before, after = _curves(state)
    draw_outlines(axes, problem, state, after)
    if float(np.abs(after - before).max()) > VISIBLE * float(np.ptp(after.reshape(-1, 2), axis=0).max()):
        undeformed = outline_of(state, before)
        add_path(axes, undeformed, facecolor="none", edgecolor=GREY, linewidth=0.9, linestyle="dashed")
    return [[loop.reshape(-1, 2) for loop in loops] for loops in bodies_of(problem, state, after)]


def draw_outlines(axes: Axes, problem: Problem, state: BoundaryState, curves: Array) -> None:
    """Draw each elastic body from curves (m, c, 2) of its elements."""
    for loops, color in zip(bodies_of(problem, state, curves), fills(problem), strict=True):
        outline = _path(loops)
        add_path(axes, outline, facecolor=color, edgecolor="none", zorder=0)
        add_path(axes, outline, facecolor="none", edgecolor=BLACK, linewidth=1.8, zorder=3)


def _curves(state: BoundaryState) -> tuple[Array, Array]:
    """Curves (m, c, 2) of the elements before and after the deformation."""
    samples = 5 if len(state.points) < MANY_ELEMENTS else 3
    return element_curves(state.points, samples), element_curves(state.points + state.displacement, samples)


def _draw_fan(axes: Axes, fan: Fan, tips: Array, spacing: float) -> None:
    """Fill the fan between its feet and tips (j, 2), with thin arrows so far apart."""
    rim = tips if fan.closed else np.concatenate([fan.feet[:1], tips, fan.feet[-1:]])
    axes.fill(*np.concatenate([fan.feet, tips[::-1]]).T, color=VERMILION, alpha=0.35, linewidth=0, zorder=4)
    axes.plot(*rim.T, color=VERMILION, linewidth=1.6, zorder=4)
    axes.plot(*fan.feet.T, color=VERMILION, linewidth=2.8, solid_capstyle="butt", zorder=4)
    s = np.concatenate([[0.0], np.hypot(*np.diff(fan.feet, axis=0).T).cumsum()])
    count = round(s[-1] / spacing)
    at = (np.arange(count) + 0.5) * s[-1] / max(count, 1)
    tails, heads = (np.column_stack([np.interp(at, s, line[:, i]) for i in (0, 1)]) for line in (tips, fan.feet))
    draw_arrows(axes, tails, heads - tails, VERMILION)


def _fans(result: Result, state: BoundaryState) -> Iterator[Fan]:
    """The stretches of the contact zones that carry pressure, each with an open point at either end."""
    contact, solution = result.contact, result.solution
    touching = contact.pressed(solution.pressure, solution.displacement)
    pressure = np.where(touching, solution.pressure, 0.0)
    nodes, moved = state.points.reshape(-1, 2), (state.points + state.displacement).reshape(-1, 2)
    places = dict(zip(map(tuple, nodes.tolist()), moved, strict=True))
    feet = np.array([places[x, y] for x, y in contact.points.tolist()])
    for piece in pieces_of(contact, touching):
        index = piece.index
        pressed = touching[index]
        shown = pressed | np.append(pressed[1:], False) | np.insert(pressed[:-1], 0, False)
        for stretch in np.split(index, np.flatnonzero(np.diff(shown)) + 1):
            if touching[stretch].any():
                yield Fan(
                    feet=feet[stretch], normals=contact.normals[stretch], pressure=pressure[stretch],
                    zone=contact.zone_names[int(contact.zone[stretch[0]])],
                )  # fmt: skip


def fan_scale(fans: Sequence[Fan]) -> float:
    """The pressure at which fans have their full length: the largest, unless it is far above the mean."""
    return min(max(fan.peak for fan in fans), CUT * max(fan.mean for fan in fans))


def _region(fans: Sequence[Fan]) -> Array:
    """Deformed points (k, 2) of the fan of the largest pressure, with those that are not far away beside its extent."""
    feet = max(fans, key=lambda fan: fan.peak).feet
    others = [fan.feet for fan in fans if not (fan.feet[0] == feet[0]).all()]
    while near := [
        other for other in others if KDTree(feet).query(other)[0].min() <= APART * np.ptp(feet, axis=0).max()
    ]:
        feet = np.concatenate([feet, *near])
        others = [other for other in others if not any(other is one for one in near)]
    return feet


def _seen(fan: Fan, window: Array) -> bool:
    """Whether a window, two corners (2, 2), shows some of a fan."""
    return bool(((fan.feet >= window[0]) & (fan.feet <= window[1])).all(axis=1).any())


def _around(feet: Array) -> Array:
    """Corners (2, 2) of the square around a contact."""
    middle, extent = (feet.min(axis=0) + feet.max(axis=0)) / 2, float(np.ptp(feet, axis=0).max())
    return middle + np.array([[-1.0], [1.0]]) * (0.5 + AROUND) * extent


def _label(fan: Fan, tips: Array, text: str, *, cut: bool) -> Name:
    """Text on the peak of a fan, to be placed beyond its tip in the middle of a level stretch, or in a hole."""
    highest = np.flatnonzero(fan.pressure >= (1 - LEVEL) * fan.peak)
    at = int(highest[len(highest) // 2])
    outward, across = -fan.normals[at], fan.normals[at, ::-1] * (1, -1)
    turns = np.radians((0, 45, -45, 90, -90, 22, -22, 67, -67, 110, -110))[:, None]
    directions = np.cos(turns) * outward + np.sin(turns) * across
    anchors, area = np.tile(tips[at], (len(turns), 1)), np.concatenate([fan.feet, tips[::-1]])
    if fan.closed:
        text, area = text.replace(" ", "\n"), tips
        anchors, directions = np.vstack([tips.mean(axis=0), anchors]), np.vstack([np.zeros(2), directions])
    elif np.isfinite(fan.longest(fan.peak)):  # in a hole there is little room
        text = text.replace(" ±", "\n±")
    text += ",\nfan cut off" if cut else ""
    return Name(text=text, color=BLACK, anchors=anchors, directions=directions, named=tips, area=area)


def _displacement(state: BoundaryState) -> Displacement:
    """Displacement of any point of the boundary: that of the nearest of some on each element."""
    nearest = KDTree(element_curves(state.points, 17).reshape(-1, 2))
    displacement = element_curves(state.displacement, 17).reshape(-1, 2)
    return lambda points: displacement[nearest.query(points)[1]]


def body_extent(state: BoundaryState) -> tuple[float, float]:
    """Width and height of the body."""
    width, height = np.ptp(state.points.reshape(-1, 2), axis=0)
    return float(width), float(height)


def outline_of(state: BoundaryState, curves: Array) -> Path:
    """Join curves (m, c, 2) to one path of closed loops; holes run the other way round and so stay empty."""
    return _path(_loops_of(state, curves))


def _path(loops: Sequence[Array]) -> Path:
    """Join loops of curves (j, c, 2) to one path."""
    lines = (np.vstack([loop[:, :-1].reshape(-1, 2), loop[:1, 0]]) for loop in loops)
    return Path.make_compound_path(*(Path(line, closed=True) for line in lines))


def bodies_of(problem: Problem, state: BoundaryState, curves: Array) -> list[list[Array]]:
    """Loops of curves (j, c, 2) of each elastic body."""
    loops, counts = iter(_loops_of(state, curves)), [len(part.loops) for part in problem.parts]
    return [list(islice(loops, count)) for count in counts]


def _loops_of(state: BoundaryState, curves: Array) -> list[Array]:
    """Split curves (m, c, 2) where one loop of elements ends and the next begins."""
    first, breaks = 0, list[int]()
    for element, end in enumerate(state.points[:, 2]):
        if (end == state.points[first, 0]).all():  # the next loop may begin at the same place, on another body
            first = element + 1
            breaks.append(first)
    return np.split(curves, breaks[:-1])
