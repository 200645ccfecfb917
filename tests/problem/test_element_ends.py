"""Element ends along an edge: at given places, graded towards a place, dense at an end of contact."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.problem.curves import Edge, Segment
from bemcontact.problem.element_ends import cubic_ends, graded_ends, graded_lengths, moved_onto

PLACES = st.lists(st.integers(1, 99), min_size=1, max_size=4, unique=True).map(lambda places: sorted(places))


@given(PLACES, st.integers(5, 20), st.floats(1, 50), st.sampled_from(["start", "end", "both", "middle"]))
def test_elements_end_exactly_at_given_places(places, elements, ratio, towards):
    fractions = [place / 100 for place in places]
    ends = graded_ends(elements, ratio, towards, fractions)
    assert len(ends) == elements + 1
    assert (ends[0], ends[-1]) == (0.0, 1.0)
    assert np.all(np.diff(ends) > 0)
    assert set(fractions) <= set(ends.tolist())


def test_ends_between_places_keep_their_proportions():
    """Of four equal elements the first end goes to 0.3; from 0.3 to 1 are three equal ones."""
    np.testing.assert_allclose(
        graded_ends(4, 1.0, "start", [0.3]), [0, 0.3, 0.3 + 0.7 / 3, 0.3 + 1.4 / 3, 1], rtol=1e-15
    )


@given(st.lists(st.floats(0.01, 0.99), min_size=1, max_size=3, unique=True), st.integers(4, 7))
def test_the_nearest_ends_move(places, elements):
    """Comparison with all choices, by the sum of squared distances."""
    places, ends = sorted(places), np.linspace(0, 1, elements + 1)
    moved = moved_onto(ends, places)
    chosen = [int(np.flatnonzero(moved == place)[0]) for place in places]
    least = min(
        sum((ends[i] - place) ** 2 for i, place in zip(way, places, strict=True))
        for way in combinations(range(1, elements), len(places))
    )
    assert sum((ends[i] - place) ** 2 for i, place in zip(chosen, places, strict=True)) == pytest.approx(
        least, abs=1e-15
    )


def test_as_many_places_as_inner_ends_are_all_ends():
    places = [0.001, 0.01, 0.1, 0.9]
    assert graded_ends(5, 1.0, "start", places).tolist() == [0, *places, 1]


def test_elements_shrink_towards_the_middle():
    lengths = graded_lengths(5, 4.0, "middle")
    np.testing.assert_allclose(lengths / lengths[2], [4, 2, 1, 2, 4], rtol=1e-14)  # ratio 4 in two steps


@given(st.floats(0.05, 0.95), st.integers(2, 30), st.floats(1, 100))
def test_elements_shrink_towards_a_place_by_one_factor(place, elements, ratio):
    ends = graded_ends(elements, ratio, place)
    at = int(np.flatnonzero(ends == place)[0])
    lengths = np.diff(ends)
    longer = max(at, elements - at)
    growth = ratio ** (1 / max(longer - 1, 1))
    np.testing.assert_allclose(lengths[:at][:-1] / lengths[:at][1:], growth, rtol=1e-8)
    np.testing.assert_allclose(lengths[at:][1:] / lengths[at:][:-1], growth, rtol=1e-8)


def test_grading_towards_the_middle_place_is_symmetric():
    ends = graded_ends(8, 20.0, 0.5)
    np.testing.assert_allclose(ends, 1 - ends[::-1], atol=1e-15)
    lengths = np.diff(ends)
    assert lengths.max() / lengths.min() == pytest.approx(20, rel=1e-12)
    assert set(np.argsort(lengths)[:2].tolist()) == {3, 4}


@pytest.mark.parametrize("elements", [1, 2, 5, 21])
def test_ends_towards_contact_are_cubes(elements):
    np.testing.assert_allclose(cubic_ends(elements, both=False), (np.arange(elements + 1) / elements) ** 3, rtol=1e-14)


def test_ends_between_two_contact_ends_are_cubes_on_both_sides():
    """Four elements: (1/2)³ and 1 of the half; five: the middle one straddles the half at (4/5)³."""
    np.testing.assert_allclose(cubic_ends(4, both=True), [0, 1 / 16, 0.5, 15 / 16, 1], rtol=1e-15)
    np.testing.assert_allclose(cubic_ends(5, both=True)[:3], [0, 0.5 * 0.4**3, 0.5 * 0.8**3], rtol=1e-14)
    np.testing.assert_allclose(cubic_ends(5, both=True), 1 - cubic_ends(5, both=True)[::-1], atol=1e-16)


@pytest.mark.parametrize("both", [False, True])
@pytest.mark.parametrize("elements", [40, 51, 500])
def test_elements_have_the_smallest_length(elements, both):
    lengths = np.diff(cubic_ends(elements, both=both, shortest=1e-3))
    assert lengths[0] == pytest.approx(1e-3, rel=1e-12)
    assert lengths.min() == pytest.approx(1e-3, rel=1e-9)
    assert lengths.sum() == pytest.approx(1, rel=1e-14)
    coarse = cubic_ends(4, both=both, shortest=1e-3)
    np.testing.assert_array_equal(coarse, cubic_ends(4, both=both))  # long enough anyway


def test_refinement_cuts_the_elements_between_the_places():
    edge = Edge(
        name="edge", curve=Segment(start=(0, 0), end=(2, 0)), start=(0, 0), end=(2, 0), elements=3, ends_at=(0.1, 0.4)
    )
    np.testing.assert_allclose(edge.breakpoints(2), [0, 0.05, 0.1, 0.25, 0.4, 0.7, 1], rtol=1e-15)
