"""Labels go where they cover least."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from bemcontact.report.figures.symbols import COVERED, Box, centered, crowd, draw_ground, least_crowded, overlap

NOTHING = np.zeros((0, 2))


def test_overlap_is_the_common_area():
    a = Box(0, 0, 4, 2)
    assert overlap(a, Box(3, 1, 9, 9)) == 1
    assert overlap(a, Box(4, 0, 5, 2)) == 0
    assert overlap(a, a) == 8
    assert centered(np.array([2.0, 1.0]), (4, 2)) == a


def test_crowd_counts_drawn_points_and_covered_area():
    ink = np.array([[1.0, 1.0], [2.0, 1.0], [9.0, 9.0]])
    assert crowd(Box(0, 0, 4, 2), [], ink) == 2
    assert crowd(Box(0, 0, 4, 2), [Box(0, 0, 2, 2)], NOTHING) == pytest.approx(COVERED / 2)


def test_the_first_free_place_wins():
    centers = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])
    assert least_crowded(centers, (4, 2), [], NOTHING) == 0
    assert least_crowded(centers, (4, 2), [Box(-1, -1, 1, 1)], NOTHING) == 1
    assert least_crowded(centers, (4, 2), [Box(-1, -1, 1, 1)], np.array([[10.0, 0.5]])) == 2


def test_ground_is_hatched_on_the_side_away_from_the_normals():
    axes = Figure().add_subplot()
    points, up = np.array([[0.0, 0.0], [10.0, 0.0]]), np.array([[0.0, 1.0], [0.0, 1.0]])
    covered = draw_ground(axes, points, up, 1.0, "black")
    assert covered[:, 1].max() == 0
    assert -1 <= covered[:, 1].min() < 0
    (hatching,) = axes.patches
    hatches = np.asarray(hatching.get_path().vertices).reshape(-1, 2, 2)
    assert np.ptp(np.diff(hatches[:, 0, 0])) <= 1e-12
    assert np.ptp(hatches[:, 0, 0]) > 9
    assert (hatches[:, 1, 1] < 0).all()
    assert (hatches[:, 0, 1] == 0).all()


def test_the_least_crowded_place_is_that_of_all_points():
    """Only points between the sides of a label are looked at; those on its border do not count."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        ink, centers = rng.integers(0, 60, (300, 2)).astype(float), rng.integers(0, 60, (40, 2)).astype(float)
        taken = [centered(at, (12.0, 6.0)) for at in rng.uniform(0, 60, (3, 2))]
        all_points = [crowd(centered(at, (10.0, 6.0)), taken, ink) for at in centers]
        assert least_crowded(centers, (10.0, 6.0), taken, ink) == int(np.argmin(all_points))
