"""Bulges of a spline between its points, which are seldom meant."""

from collections.abc import Iterator

import numpy as np

from bemcontact.bem.body import Body
from bemcontact.problems.surface_lines import Spline


def bulging(body: Body, least: float, reach: float = np.inf) -> Iterator[str]:
    """Note a spline that bulges between its points by more than `least` [L], no farther from contact points than that.

    `reach` [L] is the distance from contact points beyond which a bulge does not matter.
    """
    for number, (name, zone) in enumerate(body.problem.zones.items()):
        if not isinstance(zone.surface, Spline):
            continue
        nodes = body.mesh.nodes[body.points.node[body.points.zone == number]]
        excess, places = zone.surface.bulges
        near = np.array([np.hypot(*(nodes - place).T).min() for place in places]) <= reach + excess
        i = int(np.argmax(np.where(near, excess, 0.0)))
        if near[i] and excess[i] > least:
            x, y = places[i].tolist()
            how_far = f"{excess[i]:.2g} {body.problem.units.length}".rstrip()
            yield (
                f"the spline of '{name}' bulges by {how_far} at ({x:.5g}, {y:.5g}), between two of its points, beside "
                "the line through them; put several points on a flat part, close to where it ends, or use a polyline"
            )
