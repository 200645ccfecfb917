"""The foot of a contact, directions along it, coordinates, spacing, and how far a body goes."""

from dataclasses import replace

import numpy as np
import pytest
from known_answers import BLOCK, hertz, punch, ring

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.problems import Table
from bemcontact.reference.positions import Frame, coordinates, foot, in_zone, reach, spacing


def along(arc, gap, normals=None, **changes) -> CondensedContact:
    """Points on the x axis with given gaps."""
    n = len(arc)
    bare = CondensedContact.from_compliance(np.eye(n), gap)
    points = np.column_stack([arc, np.zeros(n)])
    given = {} if normals is None else {"normals": np.array(normals, float)}
    return replace(bare, points=points, arc_position=np.array(arc, float), **given, **changes)


def test_foot_is_the_vertex_of_the_parabola():
    x = np.array([0.0, 0.4, 1.1, 1.7, 3.0])
    assert foot(along(x, (x - 1.3) ** 2 + 0.2), None) == pytest.approx((1.3, 0.0), abs=1e-12)


def test_foot_at_the_end_of_a_run_is_its_end():
    x = np.array([0.0, 0.4, 1.1])
    assert foot(along(x, x**2), None) == (0.0, 0.0)
    assert foot(along(x, (x - 2) ** 2), None) == (1.1, 0.0)


def test_foot_across_the_seam_of_a_closed_run():
    """The lowest point is the first of the run, and the vertex lies between it and the last."""
    x = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    signed = np.where(x > 2, x - 5, x)
    contact = along(x, (signed + 0.3) ** 2, run_length=np.array([5.0]))
    contact = replace(contact, points=np.column_stack([signed, 0 * x]))
    assert foot(contact, None) == pytest.approx((-0.3, 0.0), abs=1e-12)


def test_foot_of_a_level_gap_is_its_middle():
    x = np.array([0.0, 0.4, 1.2, 3.0])
    assert foot(along(x, [0.0, 0.0, 0.0, 1.0]), None) == pytest.approx((1.6 / 3, 0.0))


def test_foot_is_that_of_the_zone():
    x = np.array([0.0, 1.0, 2.0, 3.0])
    contact = along(x, [0.0, 1.0, 0.5, 0.2], zone=np.array([0, 0, 1, 1]), zone_names=("a", "b"))
    assert foot(contact, "a") == (0.0, 0.0)
    assert foot(contact, "b") == (3.0, 0.0)
    assert in_zone(contact, "b").tolist() == [False, False, True, True]
    assert in_zone(contact, None).all()


@pytest.mark.parametrize(
    ("normal", "direction"),
    [((0, 1), (1, 0)), ((0, -1), (1, 0)), ((1, 0), (0, 1)), ((-1, 0), (0, 1)), ((0.6, 0.8), (0.8, -0.6))],
)
def test_contact_runs_to_the_right_or_upwards(normal, direction):
    contact = along([0.0, 1.0], [0.0, 1.0], [normal, normal])
    frame = Frame.at(contact, None, (2.0, 3.0))
    assert frame.along == pytest.approx(direction)
    assert frame.distances(np.array([[3.0, 4.0]])) == pytest.approx(sum(direction))
    assert frame.heights(np.array([[3.0, 4.0]])) == pytest.approx(sum(normal))


def table(against: str, **more) -> Table:
    return Table(source="s", against=against, pressure=[(0, 1), (1, 1)], **more)


def test_coordinates():
    points, arc = np.array([[1.0, 2.0], [-1.0, 2.0], [0.0, 4.0]]), np.array([0.0, 3.0, 5.0])
    assert coordinates(table("x"), points, arc).tolist() == [1.0, -1.0, 0.0]
    assert coordinates(table("y"), points, arc).tolist() == [2.0, 2.0, 4.0]
    assert coordinates(table("arc"), points, arc).tolist() == [0.0, 3.0, 5.0]
    assert coordinates(table("angle", center=(0, 1)), points, arc) == pytest.approx([45, 135, 90])
    assert coordinates(table("angle", center=(0, 1), zero=(0, 7)), points, arc) == pytest.approx([-45, 45, 0])


def test_spacing_is_to_the_farther_neighbor_in_the_run():
    contact = along([0.0, 0.5, 2.0, 0.0, 4.0], np.ones(5), run=np.array([0, 0, 0, 1, 1]), run_length=np.full(2, np.inf))
    assert spacing(contact).tolist() == [0.5, 1.5, 1.5, 4.0, 4.0]


@pytest.mark.parametrize(
    ("spec", "center", "expected"),
    [
        (punch(12.0), (0, 12.0), 12.0),  # symmetry on the left, 12 to the right, 12 down
        (BLOCK, (0.5, 0.0), 0.5),  # the near side
        (hertz(), None, 8.0),  # a quarter of the cylinder
        (ring("plane_strain", "pin"), (1.0, 0.0), 1.0),  # the wall of the ring
    ],
)
def test_reach(spec: str, center, expected: float):
    problem = bemcontact.loads(spec)
    contact = bemcontact.condense(problem)
    assert reach(problem.parts, Frame.at(contact, contact.zone_names[0], center)) == pytest.approx(expected, rel=1e-3)
