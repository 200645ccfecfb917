"""The boundary of a body as a surface: closest places, corners, and the faces that hold points."""

import numpy as np
import pytest
from several_bodies import block, elastic, polygon, problem, rigid

ROOF = (np.array([0.6, 0.8]), np.array([-0.6, 0.8]))
"""Normals on both sides of a ridge, from right to left."""


def surface(body):
    spec = problem({"body": elastic(block((0, 1), (2, 3), (2,) * 4)), "other": body}, touch=["body", "other"])
    return spec.zones["touch"].surface


def square():
    return surface(rigid(block((-1, 2), (0, 2))))


def test_the_gap_is_the_distance_and_negative_inside():
    feet = square().feet([[0.5, 3.0], [0.5, 1.5], [3.0, 3.0]])
    assert np.allclose(feet.gap, [1.0, -0.5, np.sqrt(2)])
    assert np.allclose(feet.normals, [[0, 1], [0, 1], [np.sqrt(0.5), np.sqrt(0.5)]])
    assert feet.corner.tolist() == [False, False, True]


def test_places_on_the_normals_at_a_corner_are_told_from_those_inside_an_edge():
    """They have the distance along the normal of the edge, as the last pair of two blocks of equal width needs."""
    feet = square().feet([[2.0, 2.5], [2.4, 2.0], [1.9, 2.5]])
    assert np.allclose(feet.normals, [[0, 1], [1, 0], [0, 1]])
    assert np.allclose(feet.gap, [0.5, 0.4, 0.5])
    assert feet.at_corner.tolist() == [True, True, False]


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
