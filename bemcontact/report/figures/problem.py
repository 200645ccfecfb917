"""The picture of a problem: geometry, mesh, conditions, loads, rigid surfaces and tools."""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.path import Path
from scipy.spatial import KDTree

from bemcontact.analysis.check import contours
from bemcontact.arrays import Array
from bemcontact.bem.boundary_values import applied_traction
from bemcontact.bem.mesh import Mesh, element_curves
from bemcontact.problems import (
    AxisFields,
    BodySurface,
    Circle,
    Condition,
    DeflectedContour,
    Edge,
    Field,
    Plane,
    Polyline,
    Problem,
    Spline,
)
from bemcontact.problems.bodies import named_loops
from bemcontact.problems.conditions import Along, Springs
from bemcontact.report.figures.page import (
    BLACK,
    BLUE,
    BODIES,
    GREEN,
    GREY,
    PURPLE,
    VERMILION,
    add_path,
    frame_plan,
    new_page,
    settle,
    short_label,
    without_glyph_warnings,
    wrapped,
)
from bemcontact.report.figures.symbols import (
    Ground,
    Name,
    covered_by,
    draw_arrows,
    draw_ground,
    draw_rollers,
    draw_springs,
    joined,
    place_arrow,
    place_names,
)
from bemcontact.report.formatting import (
    NEGLIGIBLE,
    prescribed,
    tool_in_words,
    volume_loads,
)

Displacement = Callable[[Array], Array]
"""Points (k, 2) of the undeformed boundary -> how far (k, 2) they are displaced."""

ROLES = {"may touch": VERMILION, "bonded": PURPLE, "held": BLUE, "loaded": GREEN, "free": BLACK}
"""Role of an edge -> color."""
APART = 0.6
"""Least distance of an arrow from those between places where the load jumps, over the distance of arrows."""
ALONG = 0.3
"""Largest share of a traction across the edge with which it is drawn as one along the edge."""
FREE = Condition(traction=AxisFields(x=Field(constant=0.0)))
"""Condition of an edge without a stated one."""
FLUSH = 1e-6
"""Gap over the body's size between a plane and an edge that lies in it."""
MANY = 4
"""Number of elastic bodies up to which each edge has its name; of more, edges with room for it have one."""
MANY_EDGES = 16
"""Number of edges up to which each has its name; of more, short ones that are free have one where there is room."""
SHORT = 0.2
"""Length over the body's size of an edge that has too little room for its name; it may stand beyond the ends."""


def figure_of_problem(problem: Problem, mesh: Mesh, note: str = "") -> Figure:
    """Compose a page with geometry, mesh, conditions and rigid surfaces, and a note below the title if given."""
    if problem.load_cases and not any(problem.factors().values()):
        without = f"load cases are not drawn; --case draws one of {', '.join(problem.case_names)}"
        note = "\n".join(filter(None, [note, without]))
    low, high = mesh.nodes.min(axis=0), mesh.nodes.max(axis=0)
    width, height = (high - low) / (high - low).max()
    inches = 3.6 + 7.0 * max(width, 0.5)
    figure = new_page(inches, 1.8 + 7.0 * max(height, 0.3))
    axes = figure.add_subplot()
    title = "\n".join(wrapped(line, int(7 * inches)) for line in (problem.title, note) if line)
    axes.set_title(title, loc="left", fontweight="bold")
    draw_problem(axes, problem, mesh)
    return figure


def draw_problem(axes: Axes, problem: Problem, mesh: Mesh) -> None:
    """Draw the bodies with their mesh, conditions and rigid surfaces; each edge has its name and conditions.

    Of many bodies each has its name, and only edges with room for it have theirs.
    """
    _fill_body(axes, problem)
    _draw_mesh(axes, problem, mesh)
    outline = [edge.points(np.linspace(0, 1, 60)) for edge in problem.edges]
    surfaces = [*_draw_surfaces(axes, problem, mesh)]
    symbols = [*draw_supports(axes, problem), *draw_loads(axes, problem), *covered_by(surfaces)]
    symbols += draw_weights(axes, problem) if problem.several else []
    tools = [*draw_tools(axes, problem)]
    drawn = np.concatenate([*outline, *symbols, *(covered for covered, _ in tools)])
    slender = np.ptp(drawn, axis=0).min() < np.ptp(drawn, axis=0).max() / 3
    frame_plan(axes, drawn, problem.units.length, margin=0.12 if slender else 0.06)
    _draw_legend(axes, problem)
    crowded = len(problem.parts) > MANY
    names = [*(name for _, name in tools), *_draw_rotation(axes, problem)]
    edges = [_name(problem, edge, i, crowded) for i, part in enumerate(problem.parts) for edge in part.edges]
    names = [*body_names(problem, polygons_of(problem)), *names, *edges] if crowded else [*names, *edges]
    settle(axes)
    with without_glyph_warnings():
        grounds = [item for item in surfaces if isinstance(item, Ground)]
        taken = place_names(axes, names, drawn, polygons_of(problem), grounds)
        if not problem.several and (weight := _weights(problem)[0]).any():
            place_arrow(axes, "$g$", weight, drawn, taken)


def role(problem: Problem, edge: str) -> str:
    """Role of an edge: one of `ROLES`."""
    if any(edge in (*problem.edges_of(zone), *problem.opposite_edges(zone)) for zone in problem.zones):
        return "may touch"
    if any(edge in problem.bonded_edges(name) for name in problem.bonded):
        return "bonded"
    conditions = [condition for _, condition in _acting(problem, edge)]
    if not conditions:
        return "free"
    return "held" if any(condition.holds for condition in conditions) else "loaded"


def _acting(problem: Problem, edge: str) -> Iterator[tuple[float, Condition]]:
    """Conditions on an edge with their factors: those of the problem and of the load cases that act."""
    if edge in problem.edge_conditions:
        yield 1.0, problem.edge_conditions[edge]
    for case, factor in problem.factors().items():
        if edge in problem.load_cases[case].conditions:
            yield factor, problem.load_cases[case].conditions[edge]


def _weights(problem: Problem) -> list[Array]:
    """The weight (2,) of a unit of volume of each elastic body, with the load cases that act."""
    factors = [1.0, *(problem.factors().get(case, 0.0) for case in problem.load_cases)]
    return [
        _total(
            [
                factor * loads.gravity.density * np.array(loads.gravity.acceleration)
                for factor, loads in zip(factors, of_part, strict=True)
                if loads.gravity
            ],
            np.zeros(2),
        )
        for of_part in zip(*problem.volume_loads, strict=True)
    ]


def draw_weights(axes: Axes, problem: Problem, displacement: Displacement = np.zeros_like) -> Iterator[Array]:
    """Draw an arrow from the middle of each elastic body along its weight, all to one scale; yield what they cover."""
    weights = _weights(problem)
    largest = max(float(np.hypot(*weight)) for weight in weights)
    for loops, weight in zip(polygons_of(problem), weights, strict=True):
        if weight.any():
            middle = (loops[0].min(axis=0) + loops[0].max(axis=0))[None] / 2
            arrow = 0.1 * problem.size / largest * weight[None]
            tail = middle + displacement(middle) - arrow / 2
            yield draw_arrows(axes, tail, arrow, GREEN)
            behind = -8 * weight / np.hypot(*weight)
            axes.annotate(
                "$g$", tail[0], behind, textcoords="offset points", ha="center", va="center", color=GREEN, zorder=6
            )


def _total(parts: list[Array], none: Array) -> Array:
    """The sum of what load cases add; zero where they cancel up to round-off, of which no arrow is drawn."""
    total, size = np.sum([none, *parts], axis=0), np.sum([none, *map(np.abs, parts)], axis=0)
    return np.where(np.abs(total) > NEGLIGIBLE * size.max(initial=0.0), total, 0.0)


def _fill_body(axes: Axes, problem: Problem) -> None:
    """Fill the bodies; holes run the other way round and so stay empty."""
    for loops, color in zip(polygons_of(problem), fills(problem), strict=True):
        path = Path.make_compound_path(*(Path(loop, closed=True) for loop in loops))
        add_path(axes, path, facecolor=color, edgecolor="none", zorder=0)


def fills(problem: Problem) -> list[str]:
    """Color of each elastic body; of more than there are colors, those with edges of the same lengths share one."""
    if len(problem.parts) <= len(BODIES):
        return [*BODIES[: len(problem.parts)]]
    shapes = [tuple(f"{edge.length / problem.size:.4f}" for edge in part.edges) for part in problem.parts]
    colors = dict(zip(dict.fromkeys(shapes), cycle(BODIES), strict=False))
    return [colors[shape] for shape in shapes]


def body_names(problem: Problem, polygons: Sequence[Sequence[Array]], *, optional: bool = False) -> Iterator[Name]:
    """Names of several elastic bodies, to be placed in the bodies, from the closed polygons (j, 2) of each."""
    if not problem.several:
        return
    for body, (part, loops) in enumerate(zip(problem.parts, polygons, strict=True)):
        low, high = loops[0].min(axis=0), loops[0].max(axis=0)
        shares = np.stack(np.meshgrid(*2 * [np.linspace(0.02, 0.98, 25)]), axis=-1).reshape(-1, 2)
        places = low + shares * (high - low)
        inside = np.logical_xor.reduce([Path(loop).contains_points(places) for loop in loops])
        away = KDTree(np.concatenate(loops)).query(places)[0]
        order = [at for at in np.argsort(-away, kind="stable") if inside[at]]
        yield Name(
            text=wrapped(part.name, 20),
            color=BLACK,
            anchors=places[order],
            directions=np.zeros((len(order), 2)),
            body=body,
            optional=optional,
        )


def polygons_of(problem: Problem) -> list[list[Array]]:
    """Each loop of each elastic body as a fine polygon (j, 2)."""
    return [[np.concatenate([edge.polyline() for edge in loop]) for loop in part.loops] for part in problem.parts]


def _draw_mesh(axes: Axes, problem: Problem, mesh: Mesh) -> None:
    """Draw elements in the color of their edge's role, with large dots at their ends and small ones between."""
    corners = mesh.nodes[mesh.elements]
    colors = [ROLES[role(problem, mesh.edge_names[edge])] for edge in mesh.edge]
    curves = element_curves(corners, 9)
    for edge in np.unique(mesh.edge):
        lines, color = joined(curves[mesh.edge == edge]), ROLES[role(problem, mesh.edge_names[edge])]
        axes.add_collection(LineCollection(lines, colors=color, linewidths=2.2, zorder=3))
    for nodes, diameter in ((corners[:, 0], 4.5), (corners[:, 1], 2.5)):
        axes.scatter(*nodes.T, s=diameter**2, c="white", edgecolors=colors, linewidths=0.9, zorder=4)


def _spread(edge: Edge, size: float, spots: int, fewest: int = 2) -> Array:
    """Choose fractions (k,) of the length of an edge for symbols, about `spots` over the body's size."""
    count = int(np.clip(round(spots * edge.length / size), fewest, spots))
    return (np.arange(count) + 0.5) / count


def _loaded(problem: Problem, edge: Edge) -> Array:
    """Fractions (k,) for arrows: some between places where the load jumps or kinks, and those of `_spread` off them."""
    stops, spread = (
        np.array([0.0, *problem.load_stops(edge), edge.length]) / edge.length,
        _spread(edge, problem.size, 20),
    )
    if len(stops) == 2:
        return spread
    between = (stops[:-1, None] + np.diff(stops)[:, None] * [0.1, 0.5, 0.9]).ravel()
    apart = np.abs(spread[:, None] - between).min(axis=1) > APART / len(spread)
    return np.sort(np.append(spread[apart], between))


def draw_supports(axes: Axes, problem: Problem, displacement: Displacement = np.zeros_like) -> Iterator[Array]:
    """Draw a clamp as ground, one held axis as rollers that point along it, and springs, displaced.

    Yield what they cover.
    """
    size = problem.size
    for edge in problem.edges:
        condition = problem.edge_conditions.get(edge.name, FREE)
        held = condition.displacement
        if condition.spring is not None:
            yield from _draw_springs(axes, edge, condition.spring, displacement, size)
        if len(held.given) == 2:
            fractions = np.linspace(0, 1, 61)
            points = edge.points(fractions)
            yield draw_ground(axes, points + displacement(points), -edge.normals(fractions), 0.025 * size, BLUE).covered
            continue
        fractions = _spread(edge, size, 8)
        points, normals = edge.points(fractions), edge.normals(fractions)
        for axis in held.given:
            column = "xy".index(axis)
            away = np.zeros_like(normals)
            away[:, column] = np.where(normals[:, column] > -0.01, 1.0, -1.0)
            yield draw_rollers(axes, points + displacement(points), away, 0.02 * size, BLUE)


def _draw_springs(axes: Axes, edge: Edge, springs: Springs, displacement: Displacement, size: float) -> Iterator[Array]:
    """Draw springs that point out of the body, and those along an edge beside it."""
    fractions = _spread(edge, size, 8)
    points, normals = edge.points(fractions), edge.normals(fractions)
    tangents = np.column_stack([-normals[:, 1], normals[:, 0]])
    x, y = np.broadcast_to(np.eye(2)[:, None], (2, *normals.shape))
    ways = {"normal": normals, "tangent": tangents, "x": x, "y": y}
    for way in (ways[name] for name in springs.given):
        outward = np.sum(way * normals, axis=1, keepdims=True)
        beside = np.where(abs(outward) < 0.3, size * (0.024 * normals + 0.02 * way), 0.0)
        away = np.where(outward < 0, -way, way)
        yield draw_springs(axes, points + displacement(points) + beside, away, 0.045 * size, BLUE)


def largest_traction(problem: Problem) -> float:
    """The largest prescribed traction that is drawn [p]."""
    return max(float(np.hypot(*traction.T).max()) for _, traction in _tractions(problem))


def _tractions(problem: Problem) -> list[tuple[Array, Array]]:
    """Fractions (k,) of each edge at which arrows stand, and the prescribed tractions (k, 2) there."""
    across = [_loaded(problem, edge) for edge in problem.edges]
    return [(at, _traction(problem, edge, at)) for edge, at in zip(problem.edges, across, strict=True)]


def draw_loads(
    axes: Axes, problem: Problem, displacement: Displacement = np.zeros_like, largest: float = 0.0
) -> Iterator[Array]:
    """Draw prescribed tractions as arrows to one scale; they end on the body if they push, start there if they pull.

    Tractions along an edge are drawn beside it. The longest arrow is that of the `largest` traction, if this is larger
    than those of the problem.
    """
    size, largest = problem.size, max(largest, largest_traction(problem))
    for edge, (fractions, traction) in zip(problem.edges, _tractions(problem), strict=True):
        if not traction.any():
            continue
        fractions, traction = fractions[traction.any(axis=1)], traction[traction.any(axis=1)]
        points, normals = edge.points(fractions), edge.normals(fractions)
        moved = points + displacement(points)
        pull = (traction * normals).sum(axis=1)
        if (np.abs(pull) <= ALONG * np.hypot(*traction.T)).all():
            fractions = fractions if problem.load_stops(edge) else _spread(edge, size, 8, fewest=1)
            points, normals = edge.points(fractions), edge.normals(fractions)
            arrows = _traction(problem, edge, fractions) * (0.1 * size / largest)
            tails = points + displacement(points) + 0.02 * size * normals - arrows / 2
            yield draw_arrows(axes, tails, arrows, GREEN)
            continue
        arrows = traction * (0.1 * size / largest)
        yield draw_arrows(axes, np.where(pull[:, None] > 0, moved, moved - arrows), arrows, GREEN)


def _draw_rotation(axes: Axes, problem: Problem) -> Iterator[Name]:
    """Draw the center of a rotation, and give its symbol a name to be placed there."""
    spin = next((loads.centrifugal for loads in problem.volume_loads[0] if loads.centrifugal), None)
    if spin is None or spin.angular_velocity == 0:
        return
    axes.autoscale(False)
    axes.plot(*spin.center, marker="+", markersize=9, color=BLACK, zorder=5)
    sense = r"$\circlearrowleft\,\omega$" if spin.angular_velocity > 0 else r"$\circlearrowright\,\omega$"
    angle = np.radians(45 + 45 * np.arange(8))
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    yield Name(text=sense, color=BLACK, anchors=np.tile(spin.center, (8, 1)), directions=around)


def _draw_surfaces(axes: Axes, problem: Problem, mesh: Mesh) -> Iterator[Ground | Array]:
    """Draw the rigid surfaces opposite the body with their normals."""
    size, drawn = problem.size, set[str]()
    for name, zone in problem.zones.items():
        body = zone.surface.body if isinstance(zone.surface, BodySurface) else name
        if isinstance(zone.surface, DeflectedContour) or (
            isinstance(zone.surface, BodySurface) and zone.surface.elastic
        ):
            continue
        for points, normals in surface_lines(problem, name, 0.12 * size) if body not in drawn else ():
            yield draw_ground(axes, points, normals, 0.03 * size, GREY)
        drawn.add(body)
        facing = _facing(problem, name)
        gap, normal = zone.surface.closest(facing)
        at = _nearest(gap, size)
        yield draw_arrows(axes, (facing[at] - gap[at] * normal[at])[None], 0.09 * size * normal[at][None], GREY)
    for body in problem.bodies:
        if body not in drawn and not problem.is_elastic(body):  # a refused problem may have such
            for points, normals in outlines(named_loops(problem.boundary_of(body), body)):
                yield draw_ground(axes, points, normals, 0.03 * size, GREY)
    yield from _draw_contours(axes, problem, mesh)


def _draw_contours(axes: Axes, problem: Problem, mesh: Mesh) -> Iterator[Ground | Array]:
    """Draw each edge opposite a deflected contour again, displaced by the gap."""
    size = problem.size
    for name, (feet, normals) in contours(problem, mesh).items():
        for edge in problem.edges_of(name):
            elements = mesh.elements[mesh.edge == mesh.edge_names.index(edge)]
            nodes = np.append(elements[:, :2], elements[-1, 2])
            yield draw_ground(axes, feet[nodes], normals[nodes], 0.03 * size, GREY)
            middle = nodes[len(nodes) // 2][None]
            yield draw_arrows(axes, feet[middle], 0.09 * size * normals[middle], GREY)


def _facing(problem: Problem, zone: str, count: int = 60) -> Array:
    """Points (k, 2) of the boundary that may touch in a zone, in order."""
    names = problem.edges_of(zone) or [edge.name for edge in problem.edges]
    return np.concatenate([problem.edge(name).points(np.linspace(0, 1, count)) for name in names])


def _nearest(gap: Array, size: float) -> int:
    """Index of the middle one of the points that are nearest to a rigid surface, from their gaps (k,)."""
    nearest = np.flatnonzero(gap < gap.min() + FLUSH * size)
    return int(nearest[len(nearest) // 2])


def surface_lines(problem: Problem, zone: str, overhang: float) -> list[tuple[Array, Array]]:
    """The line of a rigid surface as of `surface_line`, or each loop of a rigid body."""
    surface = problem.zones[zone].surface
    return outlines(surface.loops) if isinstance(surface, BodySurface) else [surface_line(problem, zone, overhang)]


def outlines(loops: Sequence[Sequence[Edge]]) -> list[tuple[Array, Array]]:
    """Points (k, 2) of each loop of a body, in order, and unit normals (k, 2)."""
    shares = np.linspace(0, 1, 91)
    return [
        (np.concatenate([it.points(shares) for it in loop]), np.concatenate([it.normals(shares) for it in loop]))
        for loop in loops
    ]


def surface_line(problem: Problem, zone: str, overhang: float) -> tuple[Array, Array]:
    """Points (k, 2) of the rigid surface of a zone, in order, with an overhang at its ends, and unit normals (k, 2).

    A plane that is the face of a punch has no overhang: it ends where the boundary beside the zone lies in it.
    """
    surface, facing, size = problem.zones[zone].surface, _facing(problem, zone), problem.size
    assert not isinstance(surface, DeflectedContour | BodySurface)
    match surface:
        case Plane():
            normal = np.array(surface.unit_normal)
            along = np.array([normal[1], -normal[0]])
            beside = [edge for edge in problem.edges if edge.name not in problem.edges_of(zone)]
            others = np.array([edge.points(np.array([0.5]))[0] for edge in beside]).reshape(-1, 2)
            flush = (others[np.abs(surface.closest(others)[0]) < FLUSH * size] - surface.point) @ along
            s = (facing - surface.point) @ along
            first = s.min() - (0.0 if (flush < s.min()).any() else overhang)
            last = s.max() + (0.0 if (flush > s.max()).any() else overhang)
            return surface.point + np.outer([first, last], along), np.tile(normal, (2, 1))
        case Circle():
            radial = facing - surface.center
            middle = radial.mean(axis=0)
            turn = np.arctan2(middle[0] * radial[:, 1] - middle[1] * radial[:, 0], radial @ middle)
            reach = np.pi if surface.radius < size / 2 else min(np.abs(turn).max() + overhang / surface.radius, np.pi)
            angle = np.arctan2(middle[1], middle[0]) + np.linspace(-reach, reach, 181)
            outward = np.column_stack([np.cos(angle), np.sin(angle)])
            return surface.center + surface.radius * outward, outward if surface.body == "outside" else -outward
        case Polyline():
            points = np.array(surface.points)
            first, last = points[1] - points[0], points[-1] - points[-2]
            points[0] -= overhang * first / np.hypot(*first)
            points[-1] += overhang * last / np.hypot(*last)
            ends = np.stack([points[:-1], points[1:]], axis=1)
            tangents = (ends[:, 1] - ends[:, 0]) / np.hypot(*(ends[:, 1] - ends[:, 0]).T)[:, None]
            normals = np.column_stack([-tangents[:, 1], tangents[:, 0]])
            return ends.reshape(-1, 2), np.repeat(normals, 2, axis=0)
        case Spline():
            curve = surface.curve
            t = np.linspace(0.0, curve.x[-1], 16 * len(surface.points))
            points, tangents = curve(t), curve(t, 1)
            tangents = tangents / np.hypot(*tangents.T)[:, None]
            reach = overhang * tangents[[0, -1]]
            points = np.vstack([points[:1] - reach[:1], points, points[-1:] + reach[1:]])
            tangents = np.vstack([tangents[:1], tangents, tangents[-1:]])
            return points, np.column_stack([-tangents[:, 1], tangents[:, 0]])


def _traction(problem: Problem, edge: Edge, fractions: Array) -> Array:
    """Prescribed traction (k, 2) at fractions (k,) of the length of an edge."""
    points, normals, distance = edge.points(fractions), edge.normals(fractions), fractions * edge.length
    along = Along(distance, distance, edge.length)
    acting = [
        factor * applied_traction(condition, points, normals, along)
        for factor, condition in _acting(problem, edge.name)
    ]
    return _total(acting, np.zeros_like(points))


def _folded(lines: Iterable[str]) -> Iterator[str]:
    """Lines in which the place of a force stands in a line of its own."""
    for line in lines:
        force, over, place = line.partition(" over ")
        yield force
        if over:
            yield f"over {place}"


def _name(problem: Problem, edge: Edge, body: int, crowded: bool) -> Name:
    """Prepare the text at an edge of a body: its name, and what is prescribed there; shorter among many bodies."""
    lines = [*prescribed(problem, edge)]
    contacts = [line for line in lines if line.startswith("may touch")]
    if len(contacts) > 2:
        lines = [f"may touch in {len(contacts)} contacts", *(line for line in lines if line not in contacts)]
    name = edge.name.removeprefix(f"{problem.part_of(edge.name)}/") if crowded else edge.name
    fractions = np.array([0.5, 0.4, 0.6, 0.25, 0.75, 0.12, 0.88])
    anchors, outward = edge.points(fractions), edge.normals(fractions)
    short = edge.length < SHORT * problem.size
    ends = np.array([0.02, 0.98] if short else [])
    slanted = (edge.normals(ends) + edge.directions(ends) * np.sign(ends - 0.5)[:, None]) / np.sqrt(2)
    return Name(
        text="\n".join([wrapped(name, 28), *(_symbols(short_label(line, 40)) for line in _folded(lines))]),
        color=ROLES[role(problem, edge.name)],
        anchors=np.concatenate([anchors, anchors, edge.points(ends)]),
        directions=np.concatenate([-outward, outward, slanted]),
        body=body,
        optional=crowded or (short and not lines and len(problem.edges) > MANY_EDGES),
    )


def _symbols(text: str) -> str:
    """Set u_x, u_y, t_x, t_y as mathematics."""
    return re.sub(r"^([ut]_[xy]) =", r"$\1$ =", text)


def _draw_legend(axes: Axes, problem: Problem) -> None:
    """Explain the colors in the picture, and list the loads on the volume."""
    occurring = {role(problem, edge.name) for edge in problem.edges}
    handles = [Line2D([], [], color=c, linewidth=2.5, label=name) for name, c in ROLES.items() if name in occurring]
    if "loaded" not in occurring and any(any(problem.tool_action(tool).load[:2]) for tool in problem.tools):
        handles.append(Line2D([], [], color=GREEN, linewidth=1.3, label="force on a tool"))
    if problem.contact_zones or not all(map(problem.is_elastic, problem.bodies)):
        handles.append(Line2D([], [], color=GREY, linewidth=1.3, label="rigid surface, normal"))
    handles += [Line2D([], [], linestyle="none", label=load) for load in volume_loads(problem, short=True)]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


REACH = 0.13
"""Length of an arrow over the size of the body."""


def draw_tools(axes: Axes, problem: Problem) -> Iterator[tuple[Array, Name]]:
    """Draw arrows of the force and of the displacement of each tool, with the load cases that act.

    An arrow ends at the point of the tool, or where its first surface is nearest to the body, if it pushes; it starts
    there if it pulls. Yield points (k, 2) that the arrows cover, and the text to be placed beside them.
    """
    for tool in problem.tools:
        place, normal = _place(problem, tool)
        action = problem.tool_action(tool)
        covered = [place[None]]
        for components, color in ((action.position, BLUE), (action.load, GREEN)):
            if not any(components[:2]):
                continue
            arrow = REACH * problem.size * np.array(components[:2]) / np.linalg.norm(components[:2])
            tail = place - arrow if arrow @ normal > 0 else place
            covered.append(draw_arrows(axes, tail[None], arrow[None], color))
        phrases = tool_in_words(action, problem.units).split("; ")
        lines = (phrase.replace(", ", ",\n") if len(phrase) > 28 else phrase for phrase in phrases)
        yield np.concatenate(covered), _tool_name("\n".join([wrapped(tool, 28), *lines]), any(action.free), covered[-1])


def _place(problem: Problem, tool: str) -> tuple[Array, Array]:
    """Position (2,) of the force on a tool, and the normal (2,) of its surface into the body."""
    stated = problem.tools[tool]
    zone, facing = problem.zones[stated.zones[0]], _facing(problem, stated.zones[0], 61)
    if isinstance(zone.surface, DeflectedContour):
        foot, normal = facing[len(facing) // 2], np.array(zone.surface.unit_direction)
    else:
        gap, normals = zone.surface.closest(facing)
        at = _nearest(gap, problem.size)
        foot, normal = facing[at] - gap[at] * normals[at], normals[at]
    return (foot if stated.point is None else np.array(stated.point)), normal


def _tool_name(text: str, loaded: bool, covered: Array) -> Name:
    """The text of a tool, around the arrow that is drawn last."""
    angle = np.radians(45 * np.arange(8))
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    return Name(
        text=text,
        color=GREEN if loaded else BLUE,
        anchors=np.repeat(covered, 8, axis=0),
        directions=np.tile(around, (len(covered), 1)),
    )
