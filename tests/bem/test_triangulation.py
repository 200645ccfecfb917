"""Triangles that fill a body, judged as a mesh: their sides, their area."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from bodies import arc, even, mesh_of, rectangle, segment

from bemcontact.bem.triangulation import points_on, triangulation

CORNERS = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3), (0, 0)]
BODIES = {
    "thin strip of long elements": [rectangle(50.0, 0.1, even(6), even(1))],
    "graded strip": [rectangle(10.0, 2.0, np.append(0.0, np.geomspace(1e-4, 1.0, 12)), even(2))],
    "ring": [
        [("rim", arc((0, 0), 2.0, 0, 360), even(12))],
        [("hole", arc((0, 0), 1.0, 360, 0), even(12))],
    ],
    "thin ring": [
        [("rim", arc((0, 0), 2.0, 0, 360), even(12))],
        [("hole", arc((0, 0), 1.98, 360, 0), even(12))],
    ],
    "bracket": [[(f"edge {i}", segment(*ends), even(2)) for i, ends in enumerate(pairwise(CORNERS))]],
}


@pytest.mark.parametrize("name", BODIES)
def test_triangles_fill_the_body(name):
    """Each side is shared by two triangles, or is one piece of the boundary; so areas add up to that of the polygon."""
    mesh = mesh_of(*BODIES[name])
    made = triangulation(mesh)
    rim = len(made.element)
    assert made.points[:rim] == pytest.approx(points_on(mesh, made.element, made.xi), abs=1e-15 * mesh.size)
    sides = Counter(
        tuple(sorted(side)) for t in made.triangles.tolist() for side in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))
    )
    outer = [side for side, count in sides.items() if count == 1]
    assert set(sides.values()) == {1, 2}
    assert len(outer) == rim
    assert {i for side in outer for i in side} == set(range(rim))
    a, b, c = np.moveaxis(made.points[made.triangles], 1, 0)
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert areas.min() > 0
    directed = {(t[i], t[(i + 1) % 3]) for t in made.triangles.tolist() for i in range(3)}
    around = np.array([side if side in directed else side[::-1] for side in outer])
    start, end = made.points[around[:, 0]], made.points[around[:, 1]]
    assert areas.sum() == pytest.approx((start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]).sum() / 2, rel=1e-12)


def test_triangles_are_as_small_as_the_elements_beside_them():
    """The sides of triangles at a short element are no longer than about the element."""
    breaks = np.concatenate([[0.0], np.linspace(0.45, 0.55, 41), [1.0]])
    mesh = mesh_of(rectangle(10.0, 5.0, breaks, even(4)))
    made = triangulation(mesh)
    middles = made.points[made.triangles].mean(axis=1)
    sides = made.points[made.triangles] - made.points[np.roll(made.triangles, 1, axis=1)]
    below = (np.abs(middles[:, 0] - mesh.center[0]) < 0.3) & (middles[:, 1] - mesh.nodes[:, 1].min() < 0.02)
    assert below.any()
    assert np.hypot(*np.moveaxis(sides[below], 2, 0)).max() < 2 * 0.025


def test_points_as_close_as_round_off():
    """Element ends that Delaunay's algorithm cannot tell apart are left out: no piece is halved again and again."""
    ends = np.append(0.0, np.geomspace(1e-9, 1.0, 25))
    filled = triangulation(mesh_of(rectangle(10.0, 2.0, ends, even(2))))
    assert len(filled.points) < 3000
    first, second = (filled.points[filled.triangles[:, i]] - filled.points[filled.triangles[:, 0]] for i in (1, 2))
    assert (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]).sum() / 2 == pytest.approx(20, rel=1e-9)
