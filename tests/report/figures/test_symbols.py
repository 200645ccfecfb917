"""Labels go where they cover least."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.report.figures.page import new_page, settle
from bemcontact.report.figures.symbols import (
    COVERED,
    Box,
    Ground,
    Name,
    centered,
    crowd,
    draw_ground,
    least_crowded,
    overlap,
    place_names,
)

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
    covered = draw_ground(axes, points, up, 1.0, "black").covered
    assert covered[:, 1].max() == 0
    assert -1 <= covered[:, 1].min() < 0
    (hatching,) = axes.patches
    hatches = np.asarray(hatching.get_path().vertices).reshape(-1, 2, 2)
    assert np.ptp(np.diff(hatches[:, 0, 0])) <= 1e-12
    assert np.ptp(hatches[:, 0, 0]) > 9
    assert (hatches[:, 1, 1] < 0).all()
    assert (hatches[:, 0, 1] == 0).all()


def floor(axes: Axes, height: float = 0.0) -> Ground:
    """A rigid floor at a height, all along axes from 0 to 10."""
    points, up = np.array([[0.0, height], [10.0, height]]), np.array([[0.0, 1.0], [0.0, 1.0]])
    return draw_ground(axes, points, up, 0.3, "black")


@pytest.mark.parametrize("held_up", [0.0, 0.01])
def test_a_name_stands_before_the_rigid_line_that_its_anchor_touches(held_up: float):
    """Both sides are as near and as free; the one behind the line would name what is rigid."""
    axes = new_page(5.0, 5.0).add_subplot()
    axes.set(xlim=(0, 10), ylim=(-5, 5))
    ground = floor(axes)
    settle(axes)
    anchors, directions = np.tile([5.0, held_up], (2, 1)), np.array([[0.0, -1.0], [0.0, 1.0]])
    up_first, down_first = (
        Name(text="foot", color="black", anchors=anchors, directions=order) for order in (directions[::-1], directions)
    )
    for name in (up_first, down_first):
        place_names(axes, [name], np.zeros((0, 2)), [], [ground])
    place_names(axes, [down_first], np.zeros((0, 2)), [])  # nothing is known of the line
    assert [text.get_position()[1] > 0 for text in axes.texts] == [True, True, False]


def test_no_name_stands_on_hatching():
    """Two floors, so near to each other that the places beside the anchor are on the hatching of the upper one."""
    axes = new_page(5.0, 5.0).add_subplot()
    axes.set(xlim=(0, 10), ylim=(-5, 5))
    grounds = [floor(axes), floor(axes, 0.7)]
    settle(axes)
    name = Name(text="foot", color="black", anchors=np.array([[5.0, 0.0]]), directions=np.array([[0.0, 1.0]]))
    place_names(axes, [name], np.concatenate([it.covered for it in grounds]), [], grounds)
    box = axes.texts[0].get_window_extent()
    for ground in grounds:
        assert not any(box.contains(*axes.transData.transform(point)) for point in ground.covered)


def test_no_line_to_a_name_goes_through_another_name():
    """The first name takes the only way up; the second one, far from its anchor, is led to around it."""
    axes = new_page(5.0, 5.0).add_subplot()
    axes.set(xlim=(0, 10), ylim=(0, 10))
    body = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 2.0], [0.0, 2.0], [0.0, 0.0]])
    settle(axes)
    at, up = np.array([[5.0, 2.0]]), np.array([[0.0, 1.0]])
    names = [Name(text="first name", color=color, anchors=at, directions=up) for color in ("red", "blue", "green")]
    place_names(axes, names, body, [[body]])
    for line in axes.lines:
        (own,) = [text for text in axes.texts if text.get_color() == line.get_color()]
        way = axes.transData.transform(np.linspace(*np.asarray(line.get_xydata()), 50))
        others = [text.get_window_extent() for text in axes.texts if text is not own]
        assert not any(box.contains(*point) for box in others for point in way)


def test_the_least_crowded_place_is_that_of_all_points():
    """Only points between the sides of a label are looked at; those on its border do not count."""
    rng = np.random.default_rng(1)
    for _ in range(20):
        ink, centers = rng.integers(0, 60, (300, 2)).astype(float), rng.integers(0, 60, (40, 2)).astype(float)
        taken = [centered(at, (12.0, 6.0)) for at in rng.uniform(0, 60, (3, 2))]
        all_points = [crowd(centered(at, (10.0, 6.0)), taken, ink) for at in centers]
        assert least_crowded(centers, (10.0, 6.0), taken, ink) == int(np.argmin(all_points))


def test_a_wide_name_stands_at_the_side_where_it_is_nearest():
    """The border is too near for it to stand in the middle above its anchor; aslant it would be far."""
    axes = new_page(5.0, 5.0).add_subplot()
    axes.set(xlim=(0, 10), ylim=(0, 10))
    settle(axes)
    ways = np.array([[np.sqrt(0.5), np.sqrt(0.5)], [0.0, 1.0]])
    name = Name(text="a name that is wide", color="black", anchors=np.tile([1.0, 5.0], (2, 1)), directions=ways)
    place_names(axes, [name], NOTHING, [])
    assert 5 < axes.texts[0].get_position()[1] < 6


@pytest.mark.parametrize("fits", [True, False])
def test_a_name_without_room_beside_it_stands_on_what_it_names_if_it_fits(fits: bool):
    """The first name takes the room below both; the second one stands in the middle of its area."""
    axes = new_page(5.0, 5.0).add_subplot()
    axes.set(xlim=(0, 10), ylim=(0, 10))
    settle(axes)
    area = np.array([[2.0, 2.0], [8.0, 2.0], [8.0, 6.0 if fits else 2.1], [2.0, 6.0 if fits else 2.1]])
    below, down = np.array([[5.0, 2.0]]), np.array([[0.0, -1.0]])
    first = Name(
        text="a name that takes\nthe whole of the room\nthere is", color="black", anchors=below, directions=down
    )
    place_names(axes, [first, replace(first, text="number", area=area)], NOTHING, [])
    assert (axes.texts[1].get_position() == pytest.approx((5, 4))) == fits


def test_a_name_that_covers_what_is_drawn_has_a_backing():
    """Arrows fill the page in one picture, and none is drawn in the other."""
    for ink in (NOTHING, np.random.default_rng(1).uniform(0, 10, (1000, 2))):
        axes = new_page(5.0, 5.0).add_subplot()
        axes.set(xlim=(0, 10), ylim=(0, 10))
        settle(axes)
        name = Name(text="load", color="black", anchors=np.array([[5.0, 5.0]]), directions=np.array([[0.0, 1.0]]))
        place_names(axes, [name], ink, [])
        assert (axes.texts[0].get_bbox_patch() is not None) == bool(len(ink))
