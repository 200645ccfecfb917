"""Element ends keep to the sizes asked for, wherever the loop begins and whatever the unit is."""

from collections.abc import Sequence
from itertools import pairwise
from math import ceil

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.adaptivity import sizes
from bemcontact.adaptivity.sizes import (
    GROWTH,
    LEAST,
    NEAREST,
    OUTSIDE,
    RESOLUTION,
    ROUNDING,
    SHORTEST,
    Layers,
    Limit,
    Loop,
    SizeField,
    layer_sizes,
)
from bemcontact.arrays import Array
from bemcontact.problems.boundary import Boundary

WIDTH, HEIGHT = 8.0, 4.0
AROUND = 2 * (WIDTH + HEIGHT)


def size_at(loop: Loop, positions: Array, limits: Array, layers: Sequence[Layers] = ()) -> Array:
    return SizeField(loop=loop, limits=limits, layers=layers).at(positions)


def rectangle(first: int = 0, unit: float = 1.0) -> Loop:
    """A rectangle whose loop begins at one of its four edges."""
    corners = [(0.0, 0.0), (WIDTH, 0.0), (WIDTH, HEIGHT), (0.0, HEIGHT)]
    edges = [{"name": f"edge {i}", "start": [unit * x, unit * y]} for i, (x, y) in enumerate(corners)]
    return Loop(edges=Boundary.model_validate({"outer": edges[first:] + edges[:first]}).loops[0])


def whole(loop: Loop, size: float) -> Limit:
    return Limit(low=0.0, high=loop.length, size=size)


def positions(loop: Loop, ends: dict[str, tuple[float, ...]]) -> Array:
    """Positions of all element ends on a loop, the joints among them."""
    inside = [loop.start_of[edge.name] + edge.length * np.array(ends[edge.name]) for edge in loop.edges]
    return np.unique(np.concatenate([loop.joints, *inside]))


LIMITS = st.lists(
    st.builds(
        lambda low, part, size: (low, low + part, size),
        st.floats(0, AROUND - 1e-3),
        st.floats(0, AROUND / 3),
        st.floats(0.01, 3),
    ),
    max_size=4,
)


@settings(max_examples=60, deadline=None)
@given(LIMITS, st.lists(st.floats(0, AROUND), min_size=2, max_size=8))
def test_the_size_respects_every_limit_and_grows_by_no_more_than_the_growth(rows: list, at: list[float]):
    loop = rectangle()
    limits = np.array([whole(loop, 2.0), *rows])
    size = size_at(loop, np.array(at), limits)
    for low, high, most in limits:
        inside = np.mod(np.array(at) - low, loop.length) <= high - low
        assert (size[inside] <= most * (1 + 1e-12)).all()
    for (p, q), (a, b) in zip(pairwise(at), pairwise(size), strict=True):
        away = min(abs(p - q), loop.length - abs(p - q))
        assert abs(a - b) <= GROWTH * away + 1e-12


@settings(max_examples=60, deadline=None)
@given(LIMITS, LIMITS, st.lists(st.floats(0, AROUND), min_size=1, max_size=8))
def test_the_size_is_the_least_of_all_limits(rows: list, points: list, at: list[float]):
    """Of each limit it is its size, and the growth times the distance beyond its ends, the shorter way around."""
    loop, at = rectangle(), np.array(at)
    limits = np.array([whole(loop, 2.0), *rows, *((low, low, size) for low, _, size in points)])
    places = np.append(at, limits[:, :2].ravel())
    forwards = np.mod(places[:, None] - limits[:, 0], loop.length)
    beyond = np.maximum(np.minimum(loop.length - forwards, forwards - (limits[:, 1] - limits[:, 0])), 0.0)
    least = (limits[:, 2] + GROWTH * beyond).min(axis=1)
    assert size_at(loop, places, limits) == pytest.approx(least, rel=1e-9, abs=1e-12)


@settings(max_examples=40, deadline=None)
@given(LIMITS, st.floats(0, AROUND))
def test_a_loop_has_no_first_position(rows: list, at: float):
    """The size at a position and one turn later is the same, and so it is if the loop begins at another edge."""
    loop, other = rectangle(), rectangle(1)
    limits = np.array([whole(loop, 2.0), *rows])
    turned = limits - [WIDTH, WIDTH, 0.0]
    here = size_at(loop, np.array([at, at + loop.length]), limits)
    assert here[1] == pytest.approx(here[0], rel=1e-9)
    assert size_at(other, np.array([at - WIDTH]), turned)[0] == pytest.approx(here[0], rel=1e-9)


@settings(max_examples=40, deadline=None)
@given(LIMITS)
def test_no_element_is_much_larger_than_the_size_at_its_ends(rows: list):
    """Its length is one step of ∫ds/h, and h grows by no more than `GROWTH`: L <= h (e^G - 1) / G exactly.

    A step of the trapezoidal rule with samples half a size apart adds at most the factor 1 + (G/4)²/(1 - G²/16), and
    a piece is cut into as many elements as it needs but for `ROUNDING` of one: 1.05 if it is one element alone.
    """
    loop = rectangle()
    limits = np.array([whole(loop, 2.0), *rows])
    ends = positions(loop, loop.element_ends(limits, (), ()))
    sizes = size_at(loop, ends, limits)
    most = (np.exp(1.05 * GROWTH) - 1) / GROWTH * (1 + RESOLUTION * GROWTH)
    least = np.minimum(sizes[:-1], sizes[1:])
    assert (np.diff(ends) <= most * least).all()


def test_a_constant_size_gives_equal_elements():
    """ceil(length / size - 0.05) of them: 8 / 1.5 = 5.33 -> 6, 4 / 1.5 = 2.67 -> 3; 4.04 is 4 elements."""
    loop = rectangle()
    for size in (1.5, WIDTH / 4.04):
        ends = loop.element_ends(np.array([whole(loop, size)]), (), ())
        for edge in loop.edges:
            count = ceil(edge.length / size - 0.05)
            assert np.array(ends[edge.name]) == pytest.approx(np.arange(1, count) / count)


def test_each_edge_has_two_elements_at_least():
    loop = rectangle()
    ends = loop.element_ends(np.array([whole(loop, 100.0)]), (), ())
    assert {len(own) + 1 for own in ends.values()} == {LEAST}


@settings(max_examples=40, deadline=None)
@given(LIMITS, st.lists(st.floats(0, AROUND), max_size=3))
def test_marks_are_ends_of_elements(rows: list, marks: list[float]):
    loop = rectangle()
    ends = positions(loop, loop.element_ends(np.array([whole(loop, 2.0), *rows]), (), marks))
    for mark in marks:
        assert np.abs(ends - mark).min() <= 2e-9 * loop.length


@settings(max_examples=40, deadline=None)
@given(st.floats(0, AROUND), st.floats(-14, 0), st.floats(-14, 0), st.sampled_from([1e-6, 1.0, 1e6]))
def test_an_edge_can_be_divided_however_narrow_contact_is(at: float, away: float, width: float, unit: float):
    """A search that runs after contact narrower than round-off must not ask for elements that do not fit."""
    loop = rectangle(unit=unit)
    at, near = at * unit, (at + 10**away) * unit
    layers = [Layers(position=near, width=10**width * unit, count=5.0, after=True)]
    limits = [whole(loop, unit), Limit(low=at, high=at + 10**width * unit, size=10**width / 8 * unit)]
    ends = loop.element_ends(np.array(limits), layers, [at, near])
    outer = [
        {"name": edge.name, "start": list(edge.start), "elements": len(ends[edge.name]) + 1, "ends_at": ends[edge.name]}
        for edge in loop.edges
    ]
    Boundary.model_validate({"outer": outer})
    for inner in ends.values():
        assert np.diff([0.0, *inner, 1.0]).min() >= 0.99 * NEAREST


@pytest.mark.parametrize("after", [True, False])
@pytest.mark.parametrize("count", [4.0, 6.0])
def test_layers_grow_with_the_cubes(after: bool, count: float, monkeypatch: pytest.MonkeyPatch):
    """With h = max(w/n³, 3/n w^(1/3) s^(2/3)) the integral ∫ds/h is n (s/w)^(1/3) - c beyond h / 5, c = 2/(3 √3).

    Beyond the layers h grows by `GROWTH`, and the rest of the edge, here as long as the layers, adds a logarithm. So
    the cube roots of the distances of element ends are c and whole numbers of steps. Samples that are a hundredth of h
    apart err by its square; and at the end itself h is that in contact, although the first step may be outside.
    """
    monkeypatch.setattr(sizes, "RESOLUTION", 0.01)
    loop = rectangle()
    layer = Layers(position=4.0, width=2.0, count=count, after=after)
    ends = positions(loop, loop.element_ends(np.array([whole(loop, 100.0)]), [layer], [4.0]))
    side = 1 if after else -1
    for n, way in ((count, side), (count / OUTSIDE, -side)):
        away = np.sort(way * (ends - 4.0))
        roots = n * np.cbrt(away[(away > 0) & (away <= 2.0)] / 2.0)
        start = 2 / (3 * np.sqrt(3))
        whole_edge = n - start + np.log1p(GROWTH * n / 3) / GROWTH
        step = whole_edge / ceil(whole_edge - ROUNDING)
        assert roots == pytest.approx(start + step * np.arange(1, len(roots) + 1), abs=0.01 / 2 * (OUTSIDE**3 - 1))


@settings(max_examples=30, deadline=None)
@given(st.floats(0.3, 3.7), st.floats(0.05, 2.0), st.floats(3, 12), st.booleans())
def test_the_mirror_image_has_the_mirror_image_of_the_ends(at: float, width: float, count: float, after: bool):
    """Of an edge about its middle; also the end of contact itself belongs to the same side of it."""
    loop = rectangle()
    here = Layers(position=at, width=width, count=count, after=after)
    there = Layers(position=WIDTH - at, width=width, count=count, after=not after)
    limits = np.array([whole(loop, 1.7)])
    one, two = (np.array(loop.element_ends(limits, [own], [own.position])["edge 0"]) for own in (here, there))
    assert len(one) == len(two)
    assert 1 - two[::-1] == pytest.approx(one, abs=1e-9)


def test_layers_have_a_shortest_element():
    layer = Layers(position=1.0, width=2.0, count=100.0, after=True)
    assert layer_sizes([layer], np.array([[0.0]]), GROWTH) == 2.0 * SHORTEST


def test_layers_at_the_seam_of_a_loop_reach_to_both_sides():
    """A loop that begins where contact ends has the same size beside the end as one that begins elsewhere."""
    here, there = rectangle(), rectangle(1)
    layer = Layers(position=0.0, width=2.0, count=5.0, after=True)
    other = Layers(position=AROUND - WIDTH, width=2.0, count=5.0, after=True)
    at = np.linspace(-3, 3, 25)
    size = size_at(here, at, np.array([whole(here, 9.0)]), [layer])
    assert size_at(there, at - WIDTH, np.array([whole(there, 9.0)]), [other]) == pytest.approx(size, rel=1e-9)


@settings(max_examples=20, deadline=None)
@given(LIMITS, st.sampled_from([1e-6, 1e-3, 25.4, 1e6]))
def test_the_unit_of_length_does_not_matter(rows: list, unit: float):
    """Element ends are fractions: the same but for round-off, where no count of elements stands on its rounding."""
    one, two = rectangle(), rectangle(unit=unit)
    limits = np.array([whole(one, 2.0), *rows])
    layer = Layers(position=5.0, width=1.0, count=5.0, after=True)
    big = Layers(position=5.0 * unit, width=unit, count=5.0, after=True)
    before = one.element_ends(limits, [layer], [5.0])
    after = two.element_ends(unit * limits, [big], [5.0 * unit])
    assert sum(map(len, after.values())) == pytest.approx(sum(map(len, before.values())), abs=1)
    for name, own in before.items():
        if len(own) == len(after[name]):
            assert after[name] == pytest.approx(own, abs=1e-6)


@settings(max_examples=40, deadline=None)
@given(LIMITS, st.lists(st.floats(0, AROUND), min_size=1, max_size=6))
def test_idle_limits_change_nothing(rows: list, at: list[float]):
    """Nowhere: neither at the ends and the middle of a limit nor at any other place."""
    loop = rectangle()
    limits = np.array([whole(loop, 2.0), *rows])
    kept = loop.without_idle(limits)
    checked = np.concatenate([np.linspace(low, high, 3) for low, high, _ in limits])
    assert size_at(loop, checked, kept) == pytest.approx(size_at(loop, checked, limits), rel=1e-12)
    assert size_at(loop, np.array(at), kept) == pytest.approx(size_at(loop, np.array(at), limits), rel=1e-8)
