"""The boundary of a body as a surface: closest places, corners, and the faces that hold points."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from several_bodies import block, elastic, polygon, problem, rigid

from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.boundary import Boundary
from bemcontact.problems.surface_lines import Polyline

ROOF = (np.array([0.6, 0.8]), np.array([-0.6, 0.8]))
"""Normals on both sides of a ridge, from right to left."""


def surface(body):
    spec = problem({"body": elastic(block((0, 1), (2, 3), (2,) * 4)), "other": body}, touch=["body", "other"])
    found = spec.zones["touch"].surface
    assert isinstance(found, BodySurface)
    return found


def square():
    return surface(rigid(block((-1, 2), (0, 2))))


def test_the_gap_is_the_distance_and_negative_inside():
    feet = square().feet(np.array([[0.5, 3.0], [0.5, 1.5], [3.0, 3.0]]))
    assert np.allclose(feet.gap, [1.0, -0.5, np.sqrt(2)])
    assert np.allclose(feet.normals, [[0, 1], [0, 1], [np.sqrt(0.5), np.sqrt(0.5)]])
    assert feet.corner.tolist() == [False, False, True]


def test_places_on_the_normals_at_a_corner_are_told_from_those_inside_an_edge():
    """They have the distance along the normal of the edge, as the last pair of two blocks of equal width needs."""
    feet = square().feet(np.array([[2.0, 2.5], [2.4, 2.0], [1.9, 2.5]]))
    assert np.allclose(feet.normals, [[0, 1], [1, 0], [0, 1]])
    assert np.allclose(feet.gap, [0.5, 0.4, 0.5])
    assert feet.at_corner.tolist() == [True, True, False]


@pytest.mark.parametrize("deep", [0.4, 0.6, 3.0])
def test_a_place_beside_the_body_is_outside_of_some_of_its_edges_too(deep):
    """The shank of a bolt in a washer: of its top alone the nearest place is the corner, however deep the shank is."""
    boundary = Boundary(**block((0, 9), (0, 4)))
    top = tuple(edge for edge in boundary.edges if edge.name == "top")
    own = BodySurface(body="washer", elastic=True, edges=top, loops=boundary.loops)
    feet = own.feet(np.array([[-0.5, 4 - deep], [0.5, 4 - deep]]))
    assert np.allclose(feet.gap, [np.hypot(0.5, deep), -deep])


@given(st.floats(0, 6.28), st.floats(-100, 100))
def test_the_place_beyond_a_corner_is_found_in_turned_bodies(angle, away):
    """Round-off may put the closest place of one that goes on straight beyond a corner on either side of the corner."""
    c, s = np.cos(angle), np.sin(angle)

    def at(x, y):
        return [float(away + c * x - s * y), float(away + s * x + c * y)]

    boundary = Boundary(**polygon(bottom=at(-1, 0), right=at(2, 0), top=at(2, 2), left=at(-1, 2)))
    turned = BodySurface(body="b", elastic=True, edges=boundary.edges, loops=boundary.loops)
    assert turned.feet(np.array([at(2.1, 2), at(-1.3, 2), at(2, 2.5)])).at_corner.all()


def test_a_convex_corner_presses_on_a_smooth_boundary_along_its_normal():
    """As a polyline does: the force of a symmetric wedge on a straight edge has no part along the edge."""
    own = surface(rigid(polygon(left=(1, 0), under=(-2, -2.25), right=(4, -2.25))))
    straight = np.array([[[0.0, 1.0], [0.0, 1.0]]])
    faces = own.faces(np.array([[1.0, 0.0]]), straight, np.zeros(1))
    assert np.allclose(faces.normals, [0.0, 1.0], atol=1e-15)
    tilted = np.array([[[0.8, 0.6], [0.8, 0.6]]])  # not between the normals of the flanks, but beside the right one
    assert np.allclose(own.faces(np.array([[1.0, 0.0]]), tilted, np.zeros(1)).normals, ROOF[0])


@pytest.mark.parametrize("side", [0, 1])
def test_each_side_of_a_corner_in_a_concave_one_has_the_face_that_it_is_turned_to(side):
    edges = {"floor": (-1, -1), "right": (6, -1), "seat": (6, 2), "wall": (0, 2), "top": (0, 5), "back": (-1, 5)}
    faces = surface(rigid(polygon(**edges))).faces(
        np.array([[0.0, 2.0]]), np.array([[[1.0, 0.0], [0.0, 1.0]]]), np.zeros(1)
    )
    assert np.allclose(faces.normals[0, [0, 2]][side], np.eye(2)[side])


def notch(angle):
    """A block with a notch in its upper side whose faces rise by an angle in degrees."""
    y = 2 * np.tan(np.radians(angle))
    return polygon(
        bottom=(-6, -6), right=(6, -6), shoulder=(6, 0), face=(2, 0), other=(0, -y), left_shoulder=(-2, 0), left=(-6, 0)
    )


@pytest.mark.parametrize("angle", [45.0, 60.0, 65.0])
def test_beside_a_convex_corner_the_faces_are_those_of_the_same_polyline(angle):
    """A straight face that goes on beyond the corner of the notch cannot come to lie on the shoulder."""
    t = np.tan(np.radians(angle))
    up, normal = np.array([1.0, t]) / np.hypot(1, t), np.array([-t, 1.0]) / np.hypot(1, t)
    points = np.array([2.0, 0.0]) + np.array([-0.5, -1e-3, 0.0, 1e-4, 1e-2, 0.3])[:, None] * up + 1e-3 * normal
    inward = np.broadcast_to(normal, (len(points), 2, 2))
    line = Polyline(points=((-6, 0), (-2, 0), (0, -2 * t), (2, 0), (6, 0)))
    own, other = (item.faces(points, inward, np.zeros(len(points))) for item in (surface(rigid(notch(angle))), line))
    for one, same in zip(own, other, strict=True):
        assert np.allclose(one, same, rtol=0, atol=1e-12)
    assert np.allclose(own.normals, normal)


@pytest.mark.parametrize("angle", [55.0, 62.0])
def test_each_side_of_a_corner_of_the_first_body_has_its_own_normal(angle):
    """Common normals at both corners of a symmetric notch mirror each other: no shoulder is taken for a face."""
    y = 2 * np.tan(np.radians(angle))
    wedge = polygon(face=(0, -y), side=(2.2, 0.1 * y), top=(2.2, 2), left_side=(-2.2, 2), left_face=(-2.2, 0.1 * y))
    bodies = {"base": elastic(notch(angle)), "wedge": elastic(wedge)}
    own = problem(bodies, 0.05, c=["base", "wedge"]).zones["c"].surface
    assert isinstance(own, BodySurface)
    down, s, c = np.array([0.0, -1.0]), np.sin(np.radians(angle)), np.cos(np.radians(angle))
    inward = np.array([[down, [s, -c]], [[-s, -c], down]])  # in the order of the boundary
    faces = own.faces(np.array([[2.0, 0.0], [-2.0, 0.0]]), inward, np.zeros(2))
    assert np.allclose(faces.normals[0, 2], [s, -c], rtol=0, atol=1e-12)
    assert np.allclose(faces.normals[1, 0], [-s, -c], rtol=0, atol=1e-12)
