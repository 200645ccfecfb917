"""Where edges are nearest to surfaces: least gaps inside them, and the ends of what is parallel to a surface."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.problems.curves import Segment
from bemcontact.problems.nearest_places import nearest_places
from bemcontact.problems.rigid_surface import Circle, Plane
from bemcontact.problems.surface_lines import Polyline

scales = st.floats(1e-6, 1e6)
turns = st.floats(-3, 3)


def turned(x: float, y: float, scale: float, turn: float) -> tuple[float, float]:
    z = scale * complex(x, y) * complex(1, turn) / abs(complex(1, turn))
    return z.real, z.imag


def edge(scale: float, turn: float) -> Segment:
    return Segment(start=turned(-3, 1, scale, turn), end=turned(5, 1, scale, turn))


@given(st.floats(-2.9, 4.9), scales, turns)
def test_a_round_surface_is_nearest_below_its_center(x, scale, turn):
    circle = Circle(center=turned(x, -2, scale, turn), radius=1.7 * scale, body="outside")
    assert nearest_places(edge(scale, turn), circle) == pytest.approx([(x + 3) / 8], abs=2e-6)


@given(scales, turns)
def test_nothing_is_nearest_along_a_parallel_surface(scale, turn):
    """Round-off decides nothing, whatever the units are."""
    plane = Plane(point=turned(0, 0.3, scale, turn), normal=turned(0, 1, 1.0, turn))
    assert nearest_places(edge(scale, turn), plane) == ()


@given(st.floats(-2.5, 0), st.floats(1, 4.5), scales, turns)
def test_a_parallel_part_has_its_ends(left, right, scale, turn):
    line = [turned(x, y, scale, turn) for x, y in ((left - 1, -1), (left, 0), (right, 0), (right + 1, -1))]
    places = nearest_places(edge(scale, turn), Polyline(points=tuple(line)))
    assert sorted(places) == pytest.approx([(left + 3) / 8, (right + 3) / 8], abs=2e-3)
