"""The rigid motion of a surface beside a body."""

import numpy as np
import pytest

from bemcontact.problems.way import AS_DRAWN, Way

POINTS = np.array([[0.0, 0.0], [1.0, -2.0], [30.0, 4.0]])


@pytest.mark.parametrize("way", [AS_DRAWN, Way(1.0, -2.0), Way(3.0, 0.5, 0.3, (2.0, 1.0))])
def test_there_and_back(way: Way):
    assert way.back(way.forth(POINTS)) == pytest.approx(POINTS, abs=1e-14)
    assert way.turned(way.turned(POINTS), -1.0) == pytest.approx(POINTS, abs=1e-14)


def test_a_turn_is_counterclockwise_about_the_point_that_is_displaced():
    way = Way(1.0, 2.0, np.pi / 2, (3.0, 0.0))
    assert way.forth(np.array([3.0, 0.0])) == pytest.approx([4.0, 2.0])
    assert way.forth(np.array([4.0, 0.0])) == pytest.approx([4.0, 3.0])


def test_the_motion_is_the_difference_of_places_to_first_order():
    """What is left is the square of the turn times the lever."""
    for turn in (1e-3, 1e-4):
        way = Way(1.0, 2.0, turn, (3.0, 0.0))
        left = way.forth(POINTS) - POINTS - way.motion_at(way.forth(POINTS))
        assert abs(left).max() <= turn**2 * 30
