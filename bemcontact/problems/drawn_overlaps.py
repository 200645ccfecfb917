"""Bodies that are drawn over each other: one on another, one inside another, or outlines that cross."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.errors import Issue, KeyPath
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.boundary import Boundary, size_of_edges
from bemcontact.problems.curves import Edge
from bemcontact.problems.stated_bodies import StatedBodies

SAME_PLACE = 1e-6
"""Distance of two outlines over the size of the body up to which they are at the same place: users round."""
OVERLAP = 1e-4
"""Depth over the size of the smaller body from which two bodies overlap: less may be rounded coordinates that touch."""
SAMPLES = 65
"""Places of an edge whose depth is measured first."""
PARTS = 4
"""Parts into which a step between two places is divided where the other body may be deeper."""
ROUNDS = 3
"""Rounds of such divisions: a bar that crosses an edge is found if it is wider than 1/4000 of it."""
WHERE_ROUND_OFF = 1e-9
"""Coordinate over the size of the body that is written as zero."""


class Depth(NamedTuple):
    """How deep places of a body are in another one.

    Parameters
    ----------
    most, least : largest and smallest depth [L], negative outside
    at : (2,) the deepest place [L]
    """

    most: float
    least: float
    at: Array


class DrawnBody(NamedTuple):
    """A body as it is drawn.

    Parameters
    ----------
    name : of the body
    edges : its edges, with their own names
    surface : its whole boundary
    size : diameter of its bounding box [L]
    """

    name: str
    edges: tuple[Edge, ...]
    surface: BodySurface
    size: float

    @property
    def box(self) -> tuple[Array, Array]:
        """Corners (2,) and (2,) of a box around the body [L]."""
        lines = np.vstack([edge.polyline() for edge in self.edges])
        return lines.min(axis=0), lines.max(axis=0)


def drawn_body(name: str, boundary: Boundary) -> DrawnBody:
    """A body as its boundary draws it."""
    surface = BodySurface(body=name, elastic=False, edges=boundary.edges, loops=boundary.loops)
    return DrawnBody(name, boundary.edges, surface, size_of_edges(boundary.edges))


def overlap_issues(problem: StatedBodies) -> list[Issue]:
    """Issues of bodies that lie exactly on others; else of bodies that overlap others which they do not touch."""
    pairs = [*_pairs_close_by(problem)]
    return [*_on_others(problem, pairs)] or [*_over_others(problem, pairs)]


def _pairs_close_by(problem: StatedBodies) -> Iterator[tuple[DrawnBody, DrawnBody]]:
    """Pairs of bodies whose bounding boxes meet; the one that is stated later comes first."""
    bodies = [drawn_body(name, problem.boundary_of(name)) for name in problem.bodies]
    boxes = [body.box for body in bodies]
    for number, (body, (low, high)) in enumerate(zip(bodies, boxes, strict=True)):
        for other, (its_low, its_high) in zip(bodies[:number], boxes[:number], strict=True):
            if (low <= its_high).all() and (its_low <= high).all():
                yield body, other


def _on_others(problem: StatedBodies, pairs: Sequence[tuple[DrawnBody, DrawnBody]]) -> Iterator[Issue]:
    """Issues of bodies at the place of others: a copy that is left where its original is, say; one for each body."""
    reported = set[str]()
    for body, other in pairs:
        if body.name not in reported and _lies_on(body, other) and _lies_on(other, body):
            reported.add(body.name)
            spec = problem.bodies[body.name]
            path: KeyPath = ("bodies", body.name)
            if spec.copy_of is None:
                remedy = "move one of them, or leave one out"
            elif spec.rotate or spec.shift != (0.0, 0.0):
                remedy = "its shift and rotate leave it where that body is; give other ones"
            else:
                remedy = "give shift or rotate"
            path = path if spec.copy_of is None else (*path, "copy_of")
            yield Issue(path=path, message=f"'{body.name}' lies exactly on '{other.name}'; {remedy}")


def _lies_on(body: DrawnBody, other: DrawnBody) -> bool:
    """Whether the whole boundary of a body lies in that of another one, with the bodies on the same side of it."""
    if abs(body.size - other.size) > SAMPLES * SAME_PLACE * body.size:
        return False
    fractions = np.linspace(0, 1, SAMPLES)[1:-1]
    for edge in body.edges:
        feet = other.surface.feet(edge.points(fractions))
        if (abs(feet.gap) > SAME_PLACE * body.size).any():
            return False
        if (np.sum(feet.normals * edge.normals(fractions), axis=1) < 0).any():
            return False
    return True


def _over_others(problem: StatedBodies, pairs: Sequence[tuple[DrawnBody, DrawnBody]]) -> Iterator[Issue]:
    """Issues of bodies that overlap others with which no contact and no bond joins them."""
    joined = {frozenset(problem.sides_of(name)) for name in (*problem.contacts, *problem.bonded)}
    for body, other in pairs:
        both = body.name, other.name
        if frozenset(both) in joined or not any(map(problem.is_elastic, both)):
            continue
        least = OVERLAP * min(body.size, other.size)
        depths = [(body, other, depth_in(body, other, least)), (other, body, depth_in(other, body, least))]
        inner, outer, deepest = max(depths, key=lambda item: item[2].most)
        if deepest.most <= least:
            continue
        for one, around, depth in depths:
            if depth.least > -least and depth.most > least:
                what = f"'{one.name}' is drawn inside '{around.name}', and no contact between them is stated"
                yield Issue(path=("bodies", one.name), message=f"{what}; move one of them")
                break
        else:
            deep = f"'{inner.name}' is {_length(problem, deepest.most)} deep in '{outer.name}'"
            what = f"'{body.name}' and '{other.name}' overlap: as drawn, {deep} at {_place(deepest.at, body.size)}"
            contact = f"contacts: {{NAME: {{between: [{inner.name}, {outer.name}]}}}}"
            message = f"{what}, and nothing joins them; move one of them, or state {contact} for an interference"
            yield Issue(path=("bodies", body.name), message=message)


def depth_in(body: DrawnBody, other: DrawnBody, least: float) -> Depth:
    """How deep the boundary of a body is in another body; a depth [L] below the least one need not be exact."""
    found = [_of_edge(edge, other.surface, least) for edge in body.edges]
    deepest = max(found, key=lambda depth: depth.most)
    return Depth(deepest.most, min(depth.least for depth in found), deepest.at)


def _of_edge(edge: Edge, surface: BodySurface, least: float) -> Depth:
    """How deep an edge is in a body. Between two places it may be deeper by half their distance, but not by more."""
    at = np.linspace(0, 1, SAMPLES)
    depth = -surface.feet(edge.points(at)).gap
    for _ in range(ROUNDS):
        bound = (depth[:-1] + depth[1:] + edge.length * np.diff(at)) / 2
        deeper = np.flatnonzero(bound > max(least, depth.max()))
        if not len(deeper):
            break
        steps = np.arange(1, PARTS) / PARTS
        new = (at[deeper, None] + steps * (at[deeper + 1] - at[deeper])[:, None]).ravel()
        order = np.argsort(every := np.append(at, new), kind="stable")
        at, depth = every[order], np.append(depth, -surface.feet(edge.points(new)).gap)[order]
    deepest = int(depth.argmax())
    return Depth(float(depth[deepest]), float(depth.min()), edge.points(at[[deepest]])[0])


def _length(problem: StatedBodies, value: float) -> str:
    return f"{value:.2g} {problem.units.length}".strip()


def _place(at: Array, size: float) -> str:
    x, y = np.where(abs(at) > WHERE_ROUND_OFF * size, at, 0.0).tolist()
    return f"({x:.5g}, {y:.5g})"
