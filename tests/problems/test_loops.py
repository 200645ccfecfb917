"""A closed line that winds once about its middle meets itself nowhere."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.problems.loops import first_meeting, winds_once


def closed(corners):
    """A polyline that ends where it begins."""
    points = np.array(corners, float)
    return np.concatenate([points, points[:1]])


def polygon_of(count, step=1):
    """Corners of a regular polygon, or of a regular star with steps over corners."""
    angles = 2 * np.pi * step * np.arange(count) / count
    return np.column_stack([np.cos(angles), np.sin(angles)])


def test_convex_outlines_of_either_sense_wind_once():
    for count in (3, 4, 17, 400):
        assert winds_once(closed(polygon_of(count)), 1e-9)
        assert winds_once(closed(polygon_of(count)[::-1]), 1e-9)


def test_a_pentagram_an_eight_and_a_spike_do_not():
    assert not winds_once(closed(polygon_of(5, 2)), 1e-9)
    assert not winds_once(closed([(0, 0), (1, 1), (1, 0), (0, 1)]), 1e-9)
    assert not winds_once(closed([(0, 0), (2, 0), (4, 0), (2, 0), (2, 3)]), 1e-9)


def test_sides_nearer_than_the_distance_are_not_sure():
    """A needle has two long sides, 2e-6 apart beside its tip."""
    needle = closed([(-1.0, 0.0), (0.0, -1e-6), (1.0, 0.0), (0.0, 1e-6)])
    assert winds_once(needle, 1e-12)
    assert not winds_once(needle, 1e-5)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.tuples(st.floats(0.1, 1.0), st.floats(0.01, 1.0)), min_size=3, max_size=12), st.floats(0.0, 0.2))
def test_what_winds_once_has_no_meeting(rays, off):
    """The search over all pairs of sides finds none, whatever the corners are, within the distance too."""
    radius, step = np.array(rays).T
    angle = np.cumsum(step) / step.sum() * 2 * np.pi * (1.0 + off)
    line = closed(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
    for distance in (1e-9, 1e-3, 1e-2):
        if winds_once(line, 2 * distance):
            assert first_meeting(line, line, distance, itself=True) is None
