"""Element ends graded to ends of contact: their places, their number, and the elements that stay as stated."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bemcontact.adaptivity.fitted_ends import CONTACT_SHARE, fitted_ends, half_way, halved, movement, resolved
from bemcontact.adaptivity.zone_runs import Stretch, ZoneRun
from bemcontact.problem.curves import Edge, Segment


def run_of(lengths: Sequence[float], elements: Sequence[int], *, closed: bool = False, **changes: Any) -> ZoneRun:
    """Straight edges in a row, each with equal elements; of a closed run nobody asks whether it really closes."""
    joints = np.concatenate([[0.0], np.cumsum(lengths)])
    edges = tuple(
        Edge(name=f"edge {i}", curve=Segment(start=(a, 0.0), end=(b, 0.0)), start=(a, 0.0), end=(b, 0.0), elements=n)
        for i, (a, b, n) in enumerate(zip(joints[:-1], joints[1:], elements, strict=True))
    )
    breakpoints = tuple(edge.breakpoints() for edge in edges)
    ends = np.concatenate([[0.0], *(a + e.length * f[1:] for a, e, f in zip(joints, edges, breakpoints, strict=False))])
    known: dict[str, Any] = {"corner": np.zeros(len(joints), bool), "beside": ()}
    return ZoneRun(
        number=0, zone="zone", edges=edges, closed=closed, arc=ends, breakpoints=breakpoints, **known | changes
    )


def touched(start: float, end: float, *, start_free: bool = True, end_free: bool = True) -> Stretch:
    return Stretch(start=start, end=end, start_free=start_free, end_free=end_free)


def ends_of(run: ZoneRun, *stretches: Stretch) -> np.ndarray:
    positions = fitted_ends(run, resolved(run, stretches))
    assert len(positions) < 1.7 * len(run.ends)  # half as many again
    assert positions[0] == 0
    assert positions[-1] == run.length
    assert np.all(np.diff(positions) > 0)
    return positions


def test_one_end_of_contact_in_a_zone():
    """Contact from the start to 3 of 4, 12 elements of 1/3: cubes of eighths inside, and of quarters outside.

    Inside 3 (4³ - 3³)/8³ = 0.22 is shorter than 1/3, but 3 (5³ - 4³)/8³ = 0.36 is not; outside (2³ - 1³)/4³ = 0.11
    and (3³ - 2³)/4³ = 0.30. What is left is cut into equal parts, all stated ones being equal.
    """
    ends = ends_of(run_of([4.0], [12]), touched(0, 3, start_free=False))
    at = int(np.flatnonzero(ends == 3)[0])
    np.testing.assert_allclose(ends[at - 4 : at + 1], 3 - 3 * (np.arange(4, -1, -1) / 8) ** 3, rtol=1e-15)
    np.testing.assert_allclose(ends[at : at + 4], 3 + (np.arange(4) / 4) ** 3, rtol=1e-15)
    np.testing.assert_allclose(ends[: at - 3], np.linspace(0, 3 - 3 / 8, 9), atol=1e-15)  # 2.625 / (1/3), rounded up
    np.testing.assert_allclose(ends[at + 3 :], np.linspace(3 + 27 / 64, 4, 3), rtol=1e-15)


def test_two_ends_of_contact_are_graded_to_from_the_middle():
    ends = ends_of(run_of([6.0], [30]), touched(2, 4))
    np.testing.assert_allclose(ends, 6 - ends[::-1], atol=1e-14)  # alike on both sides
    at = int(np.flatnonzero(ends == 2)[0])
    assert ends[len(ends) - 1 - at] == 4
    lengths = np.diff(ends)[at:]
    np.testing.assert_allclose(lengths[:3] / lengths[0], [1, 7, 19], rtol=1e-9)


@given(st.lists(st.integers(2, 30), min_size=1, max_size=3), st.floats(0.05, 0.45), st.floats(0.5, 0.95))
def test_no_element_is_longer_than_those_stated_in_its_place(elements, start, end):
    """It covers at most one of them, or parts of two that are no more than one together."""
    run = run_of([1.0] * len(elements), elements)
    ends = fitted_ends(run, resolved(run, [touched(start * len(elements), end * len(elements))]))
    assert np.diff(np.interp(ends, run.ends, np.arange(len(run.ends)))).max() <= 1 + 1e-8


@given(st.floats(0.05, 0.45), st.floats(0.5, 0.95), st.integers(20, 60))
def test_a_mirrored_run_has_mirrored_elements(start, end, elements):
    """From 20 elements on, of which eight in a narrow contact and enough outside are half as many again."""
    ends = ends_of(run_of([1.0], [elements]), touched(start, end))
    mirrored = ends_of(run_of([1.0], [elements]), touched(1 - end, 1 - start))
    np.testing.assert_allclose(mirrored, 1 - ends[::-1], atol=1e-12)


@given(st.floats(1e-3, 0.9), st.integers(20, 80))
def test_elements_across_an_end_of_contact_are_not_too_different(end, elements):
    """The open side's first is at most CONTACT_SHARE³ times as long: what is left over by whole numbers is a half."""
    ends = ends_of(run_of([1.0], [elements]), touched(0, end, start_free=False))
    at = int(np.argmin(abs(ends - end)))
    assert (ends[at + 1] - end) / (end - ends[at - 1]) <= 1.5 * CONTACT_SHARE**3


def test_joints_of_edges_stay_element_ends():
    run = run_of([1.0, 0.5, 2.5], [3, 2, 7])
    ends = ends_of(run, touched(0, 1.7, start_free=False))
    assert {0.0, 1.0, 1.5, 1.7, 4.0} <= set(ends.tolist())
    stated = run.fractions(ends)
    assert sum(len(inside) + 1 for inside in stated.values()) == len(ends) - 1
    assert all(0 < fraction < 1 for inside in stated.values() for fraction in inside)
    assert stated["edge 2"][0:1] != ()


def test_contact_that_ends_almost_at_a_joint_is_graded_to_the_joint():
    """A distance of a hundredth of an element is not resolved."""
    run = run_of([2.0, 2.0], [8, 8])
    assert resolved(run, [touched(0, 2.002)])[0].end == 2.0
    assert resolved(run, [touched(0, 2.003)])[0].end == 2.003
    assert resolved(run, [touched(1, 3.998)]) == (touched(1, 4.0, end_free=False),)
    assert resolved(run, [touched(0.001, 3)]) == (touched(0, 3, start_free=False),)
    assert resolved(run, [touched(1.999, 2.001)]) == (touched(1.999, 2.001),)  # a contact that is shorter than that


def test_a_corner_at_which_contact_ends_divides_the_zone():
    """Contact from 1.2 to the corner at 2: beyond, all stay as stated but the first: 0.5 beside 0.19 is halved."""
    run = run_of([2.0, 3.0], [10, 6], corner=np.array([False, True, False]))
    ends = ends_of(run, touched(1.2, 2.0, end_free=False))
    np.testing.assert_allclose(ends[ends >= 2], [2, 2.25, *np.linspace(2.5, 5, 6)], rtol=1e-15)
    assert 1.2 in ends


def test_two_contacts_share_the_elements():
    ends = ends_of(run_of([10.0], [40]), touched(1, 3), touched(6, 8))
    assert {1.0, 3.0, 6.0, 8.0} <= set(ends.tolist())
    counts = [np.count_nonzero((ends >= low) & (ends < high)) for low, high in ((1, 3), (6, 8))]
    assert counts[0] == counts[1] > 10  # 8 shares of two times four, of about 12 in all


def test_contacts_that_nearly_meet_share_what_is_between_them():
    ends = ends_of(run_of([10.0], [40]), touched(2, 4.99), touched(5.01, 8))
    between = ends[(ends >= 4.99) & (ends <= 5.01)]
    assert len(between) >= 7  # three elements for each of the ends
    np.testing.assert_allclose(between, 10 - between[::-1], rtol=1e-14)


@pytest.mark.parametrize("shift", [0.0, 3.0, 9.0, -4.0])
def test_a_closed_run_is_divided_alike_wherever_it_begins(shift):
    """The elements in contact do not depend on the seam."""
    run = run_of([12.0], [48], closed=True)
    ends = ends_of(run, touched(4 + shift, 7 + shift))
    turned = np.sort(np.mod(ends[:-1] - shift, 12))
    near = turned[(turned >= 4) & (turned <= 7)]
    np.testing.assert_allclose(near, 11 - near[::-1], atol=1e-13)
    assert len(near) >= 21
    assert near[0] == pytest.approx(4, rel=1e-14)


def test_contact_may_cross_the_seam_of_a_closed_run():
    ends = ends_of(run_of([12.0], [48], closed=True), touched(10, 13))
    assert {0.0, 1.0, 10.0, 12.0} <= set(ends.tolist())


def test_a_closed_run_with_a_corner_where_contact_ends():
    run = run_of([6.0, 6.0], [12, 12], closed=True, corner=np.array([False, True, False]))
    ends = ends_of(run, touched(4, 6, end_free=False))
    assert {4.0, 6.0} <= set(ends.tolist())


@pytest.mark.parametrize("closed", [False, True])
def test_beyond_a_corner_at_which_contact_ends_elements_are_halved(closed):
    """From 0.5 to at most twice the 0.1/64 at the other side, though nothing ends beyond."""
    run = run_of([6.0, 6.0], [12, 12], closed=closed, corner=np.array([closed, True, closed]))
    ends = fitted_ends(run, [touched(6, 6.1, start_free=False)])
    at = int(np.flatnonzero(ends == 6)[0])
    before, after = np.diff(ends[at - 1 : at + 2])
    assert after <= before <= 2 * after
    assert np.diff(ends).max() <= 0.5 * (1 + 1e-9)


def test_a_zone_gets_as_many_elements_as_it_needs():
    """Four inside each end of contact and three outside: the first are 1/64 and 1/27 of what they are graded over."""
    ends = fitted_ends(run_of([4.0], [2]), [touched(1, 3)])
    assert len(ends) == 15
    np.testing.assert_allclose(ends[2:5], [1 - 1 / 27, 1, 1 + 1 / 64], rtol=1e-12)


@pytest.mark.parametrize("seam", [0.0, 5.0, 30.0])
def test_the_open_side_of_a_closed_run_has_elements_for_both_its_ends(seam):
    """So the shortest is at most `CONTACT_SHARE`³ times as long as that in contact; twice, as numbers are whole."""
    run = run_of([60.0], [30], closed=True)
    ends = fitted_ends(run, [touched(10 + seam, 27 + seam)])
    at = int(np.argmin(abs(ends - (10 + seam))))
    before, after = np.diff(ends[at - 1 : at + 2])
    assert before / after <= 2 * CONTACT_SHARE**3


def test_a_very_short_contact_has_no_element_that_would_be_refused():
    """Each element has at least a millionth of the run."""
    ends = ends_of(run_of([10.0], [60]), touched(0, 1e-3, start_free=False))
    assert np.diff(ends).min() >= 1e-5 * (1 - 1e-9)


@pytest.mark.parametrize("at", [0, -1])
def test_elements_are_halved_towards_a_short_neighbor(at):
    """4 beside 0.3: 2, 1 and 0.5 twice, which is not more than twice as long."""
    ends = np.array([0.0, 4.0, 9.0]) if at == 0 else np.array([-9.0, -4.0, 0.0])
    lengths = np.diff(halved(ends, 0.3, at))
    np.testing.assert_allclose(lengths if at == 0 else lengths[::-1], [0.5, 0.5, 1, 2, 5], rtol=1e-15)
    assert len(halved(ends, 2.0, at)) == 3


def test_movement_is_measured_in_the_shorter_element_where_the_mesh_is_graded_to():
    """Graded to 3: from 2.994 on, 3/512 before and 1/64 after it."""
    stated = run_of([4.0], [12])
    ends = ends_of(stated, touched(0, 3, start_free=False))
    run = with_ends(stated, ends)
    fitted_to, computed = touched(0, 3, start_free=False), touched(0, 3.001, start_free=False)
    assert movement(run, [computed], [fitted_to]) == pytest.approx(0.001 / (3 / 512), rel=1e-9)
    assert movement(run, [computed], None) == movement(run, [computed], [fitted_to])  # elements grow from there
    assert movement(stated, [computed], None) is None
    assert movement(run, [touched(0.001, 3.001)], None) is None  # nothing crowds to the end of a run
    assert movement(run, [touched(1, 3)], [fitted_to]) is None  # one end more


def test_movement_round_the_seam_of_a_closed_run():
    stated = run_of([12.0], [48], closed=True)
    run = with_ends(stated, ends_of(stated, touched(10, 12.0)))
    assert movement(run, [touched(10, 12)], [touched(-2, 0)]) == pytest.approx(0, abs=1e-12)
    assert half_way(run, [touched(-2, 0.2)], [touched(10, 12)]) == (touched(10, 12.1),)


def test_stretches_of_different_kinds_have_no_mean():
    run = run_of([12.0], [48])
    assert half_way(run, [touched(2, 5)], [touched(3, 6)]) == (touched(2.5, 5.5),)
    assert half_way(run, [touched(2, 5)], [touched(3, 6, end_free=False)]) == (touched(3, 6, end_free=False),)


def with_ends(run: ZoneRun, ends: np.ndarray) -> ZoneRun:
    """A run of one edge on other elements."""
    return replace(run, breakpoints=(ends / run.length,), arc=ends)
