"""The picture of a contact: body and rigid surfaces where they are, and a fan as long as the pressure is large."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from drawings import (
    block_in_a_corner,
    grey_lines,
    hub_on_a_shaft,
    leaves,
    off,
    outlines,
    roller_in_a_groove,
    seal_in_a_groove,
    shaft_in_a_ring_in_a_housing,
    strokes,
)
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.tri import TriContourSet
from tool_problems import of_peaks

from bemcontact import spec
from bemcontact.analysis import solve as analysis
from bemcontact.options import StressMeasure
from bemcontact.report import figures
from bemcontact.report.figures.page import BLACK, BODIES, GREY, VERMILION, new_page
from bemcontact.report.figures.surfaces import THROUGH, TURN, reach_through

MODELS = Path(__file__).parents[3] / "models"


@cache
def solved(name: str, case: str | None = None) -> analysis.Result:
    problem = spec.load(MODELS / f"{name}.yaml", variant="stated mesh")
    return analysis.solve(problem if case is None else problem.with_case(case))


def drawn(result: analysis.Result) -> Axes:
    axes = Figure(figsize=(4, 4)).add_subplot()
    figures.draw_contact(axes, result)
    return axes


def lines(axes: Axes, color: str) -> list[np.ndarray]:
    return [np.asarray(line.get_xydata()) for line in axes.lines if line.get_color() == color]


@pytest.mark.parametrize("name", ["cylinder_on_plane", "bolt_in_plate", "cantilever_flat_surface"])
def test_fan_is_as_long_as_the_pressure_is_large(name: str):
    """Along the normals, outside of the body, from the displaced points."""
    result = solved(name)
    contact, pressure, state = result.contact, result.solution.pressure, result.boundary
    rim, feet = lines(drawn(result), VERMILION)
    tips, stretch = rim[1:-1], [int(np.argmin(np.hypot(*(_displaced(result) - foot).T))) for foot in feet]
    assert state is not None
    assert set(np.flatnonzero(result.touching)) <= set(stretch)
    assert feet == pytest.approx(_displaced(result)[stretch], abs=1e-12 * 100)
    length = ((feet - tips) * contact.normals[stretch]).sum(axis=1)
    assert length / length.max() == pytest.approx((pressure * result.touching)[stretch] / pressure.max(), abs=1e-9)
    assert feet - length[:, None] * contact.normals[stretch] == pytest.approx(tips, abs=1e-9 * length.max())


def _displaced(result: analysis.Result) -> np.ndarray:
    """Contact points (n, 2) after deformation, one by one."""
    state = result.boundary
    assert state is not None
    moved = state.points + state.displacement
    return np.array([moved[(state.points == point).all(axis=-1)][0] for point in result.contact.points])


def test_surface_meets_the_body_where_it_touches():
    """The rigid plane is 1 cm below the beam: the body is drawn as it is deformed, and the fan begins on the plane."""
    axes = drawn(solved("cantilever_flat_surface"))
    (plane,) = lines(axes, GREY)
    assert plane[:, 1] == pytest.approx(-1)
    feet = lines(axes, VERMILION)[1]
    assert feet[1:, 1] == pytest.approx(-1, abs=1e-9)  # the first one is open
    assert plane[:, 0].min() < feet[:, 0].min()
    assert plane[:, 0].max() > feet[:, 0].max()


def test_tools_are_drawn_where_they_have_come_to():
    """The raised table is at 0.1, turned by 0.0002 about its left end; the press follows it."""
    result = solved("gallery/body_between_two_tools", "raised")
    table, press = lines(drawn(result), GREY)
    assert table[:, 1] == pytest.approx(0.1 + 0.0002 * (table[:, 0] + 30), abs=1e-6)
    assert np.diff(press[:, 1]) / np.diff(press[:, 0]) == pytest.approx(0.0002, rel=1e-6)


def test_punch_ends_where_the_boundary_beside_it_lies_in_its_face():
    (face,) = lines(drawn(solved("gallery/eccentric_punch", "in the middle")), GREY)
    assert np.sort(face[:, 0]) == pytest.approx([-5, 5])


@pytest.mark.parametrize(
    ("name", "zones"), [("gallery/three_zones", 3), ("gallery/shrink_fit", 1), ("gallery/rolling_polygon", 2)]
)
def test_peak_of_each_zone_is_written_with_its_unit(name: str, zones: int):
    result = solved(name)
    contact, pressure = result.contact, result.solution.pressure
    texts = [text.get_text().split(",")[0].split() for text in drawn(result).texts if text.get_text()[0].isdigit()]
    peaks = [pressure[contact.zone == zone].max() for zone in range(zones)]
    assert [float(value) for value, _ in texts] == pytest.approx(peaks, rel=1e-4)  # five figures
    assert {unit for _, unit in texts} == {"MPa"}


def test_fan_of_a_singular_pressure_is_cut_off_and_stated_to_be():
    """At three times the mean pressure of 200 MPa; the mean is that of straight lines between points."""
    axes = drawn(solved("gallery/flat_punch"))
    assert [text.get_text().split(",\n")[1] for text in axes.texts] == ["fan cut off"]
    rim, feet = lines(axes, VERMILION)
    heights = rim[1:-1, 1] - feet[:, 1]
    middle = solved("gallery/flat_punch").solution.pressure[np.argmin(feet[:, 0])]
    assert (heights == heights.max()).sum() > 1
    assert heights[np.argmin(feet[:, 0])] / heights.max() == pytest.approx(middle / (3 * 200), rel=0.05)


@pytest.mark.parametrize("name", ["gallery/hertz_small", "gallery/flat_punch"])
def test_close_up_shows_the_contact_and_its_width_to_either_side(name: str):
    """The open point at its end belongs to what is shown of the contact; a margin is added."""
    result, axes = solved(name), Figure(figsize=(4, 4)).add_subplot()
    (zone,) = figures.close_ups(result)
    figures.draw_contact(axes, result, zone)
    x = _displaced(result)[result.touching, 0]
    assert 3 * np.ptp(x) <= np.ptp(axes.get_xlim()) < 3.6 * np.ptp(x)
    assert axes.get_xlim()[0] < x.min() - np.ptp(x)
    assert axes.get_xlim()[1] > x.max() + np.ptp(x)
    assert np.ptp(drawn(result).get_xlim()) > np.ptp(result.boundary.points[..., 0])


def test_contact_that_is_seen_on_the_whole_body_has_no_close_up():
    assert figures.close_ups(solved("gallery/shrink_fit")) == []
    assert figures.close_ups(solved("gallery/three_zones")) == ["drum", "table", "wall"]


def test_fan_of_a_hole_leaves_its_middle_free():
    """The normals of the pin meet at its center; the fan ends before."""
    rim, _ = lines(drawn(solved("gallery/shrink_fit")), VERMILION)
    assert np.hypot(*rim.T).min() > 4


def test_undeformed_outline_is_drawn_where_the_difference_is_seen():
    def dashed(name: str) -> int:
        patches = [patch for patch in drawn(solved(name)).patches if isinstance(patch, PathPatch)]
        return sum(patch.get_linestyle() in ("--", "dashed") for patch in patches)

    assert dashed("cylinder_on_plane") == 1
    assert dashed("gallery/hertz_small") == 0


def test_body_that_touches_nothing_is_drawn_without_a_fan():
    problem = spec.load(MODELS / "cantilever_flat_surface.yaml", variant="printed modulus")
    axes = drawn(analysis.solve(problem))
    assert lines(axes, VERMILION) == []
    assert not axes.texts


@pytest.mark.parametrize("pressure", [0.0, 1e-18])
@pytest.mark.filterwarnings("error")
def test_zone_that_touches_without_pressure_has_no_fan(pressure: float):
    """Nor a close-up, which would be scaled to a pressure that is round-off."""
    result = analysis.solve(seal_in_a_groove())
    contact, moved, pressed = result.contact, result.solution.displacement.copy(), result.solution.pressure.copy()
    at = int(np.flatnonzero(contact.zone == contact.zone_names.index("wall"))[8])
    pressed[at], moved[at] = pressure, -contact.initial_gap[at] - 1e-12
    result = replace(result, solution=replace(result.solution, pressure=pressed, displacement=moved))
    assert result.touching[at]
    assert "wall" not in figures.close_ups(result)
    assert len(lines(drawn(result), VERMILION)) == 2 * 2  # rim and feet of floor and lid


def factor_of(axes: Axes) -> float:
    """Read the stated magnification."""
    title = axes.get_title(loc="left")
    return 1.0 if "displacements to scale" in title else float(re.split("× |\n|,", title)[2])


def test_deformed_outline_is_displaced_by_the_stated_factor(result: analysis.Result):
    assert result.boundary is not None
    axes = Figure().add_subplot()
    figures.draw_deformed(axes, result)
    moved = result.boundary.points + factor_of(axes) * result.boundary.displacement
    assert off(moved, outlines(axes, BLACK)) < 1e-12 * 50
    assert off(result.boundary.points, outlines(axes, GREY)) < 1e-12 * 50


def test_contact_is_marked_on_the_deformed_outline():
    """The whole floor is in contact: one thick line goes through its elements."""
    result = analysis.solve(block_in_a_corner())
    assert result.boundary is not None
    axes = Figure().add_subplot()
    figures.draw_deformed(axes, result)
    (on_floor,) = (stroke for stroke in strokes(axes) if np.abs(stroke[:, 1]).max() < 1e-9)
    assert len(on_floor) == 4 * 8 + 1  # 4 elements
    moved = (result.boundary.points + factor_of(axes) * result.boundary.displacement)[..., 0]
    floor = np.abs(result.boundary.points[..., 1]).max(axis=1) < 1e-9
    assert np.ptp(on_floor[:, 0]) == pytest.approx(np.ptp(moved[floor]), rel=1e-9)


def test_magnified_surfaces_meet_the_magnified_body_where_it_touches(result: analysis.Result):
    """A surface moves as a whole by the mean gap of what touches, f - 1 times: distances to it cancel in the mean.

    Where u_n = -g, magnified displacements reach f times the gap; along the surface the body slides.
    """
    contact, axes = result.contact, Figure().add_subplot()
    figures.draw_deformed(axes, result)
    factor = factor_of(axes)
    assert factor > 1
    (floor, *_) = grey_lines(axes)
    own = result.touching & (contact.zone == 0)
    onto = contact.points - factor * contact.initial_gap[:, None] * contact.normals
    normals = contact.normals[own]
    assert np.arccos((normals @ normals.mean(axis=0)).min()) < TURN
    away = [
        (place - floor[np.argmin(np.hypot(*(floor - place).T))]) @ normal
        for place, normal in zip(onto[own], normals, strict=True)
    ]
    size = float(np.hypot(*np.ptp(result.boundary.points.reshape(-1, 2), axis=0)))
    assert np.mean(away) == pytest.approx(0, abs=1e-3 * size)


@pytest.mark.parametrize("name", ["gallery/hertz_small", "gallery/receding_contact", "gallery/beam_on_two_supports"])
def test_no_magnified_body_reaches_far_through_a_surface(name: str):
    """Planes at the height of the contact: no node of the magnified body is visibly behind them."""
    result = solved(name)
    axes = Figure().add_subplot()
    figures.draw_deformed(axes, result)
    factor, state = factor_of(axes), result.boundary
    assert state is not None
    size = float(np.hypot(*np.ptp(state.points.reshape(-1, 2), axis=0)))
    contact = result.contact
    for number in range(len(contact.zone_names)):
        own = contact.zone == number
        touching = own & result.touching
        level = (contact.points - factor * contact.initial_gap[:, None] * contact.normals)[touching].mean(axis=0)
        moved = contact.points + factor * (_displaced(result) - contact.points)
        if np.ptp(contact.normals[own], axis=0).max() < 1e-9:
            assert ((moved[own] - level) @ contact.normals[touching][0]).min() > -THROUGH * size * (1 + 1e-6)


def test_the_largest_displacement_is_magnified_to_be_seen(result: analysis.Result):
    """To 2 to 5 % of the size by a factor of 1, 2 or 5 times a power of ten; large displacements stay as they are.

    It is less where the body would reach through a surface.
    """
    assert result.boundary is not None
    size = np.hypot(*np.ptp(result.boundary.points.reshape(-1, 2), axis=0))
    axes = Figure().add_subplot()
    figures.draw_deformed(axes, result)
    factor = factor_of(axes)
    seen = factor * np.hypot(*result.boundary.displacement.reshape(-1, 2).T).max() / size
    assert f"{factor:.0e}"[0] in "125"
    assert factor == 1 or seen <= 0.05
    larger = next(more for more in (2, 2.5) if f"{more * factor:.0e}"[0] in "125")
    assert seen >= 0.02 or reach_through(result, larger * factor) > THROUGH * size


def bodies_of(axes: Axes) -> list[np.ndarray]:
    """Outlines of the bodies that are drawn."""
    patches = [patch for patch in axes.patches if isinstance(patch, PathPatch)]
    return [np.asarray(patch.get_path().vertices) for patch in patches if patch.get_edgecolor() == to_rgba(BLACK)]


@cache
def pressed() -> tuple[analysis.Result, Axes]:
    result, axes = analysis.solve(hub_on_a_shaft()), Figure(figsize=(5, 5)).add_subplot()
    figures.draw_deformed(axes, result)
    return result, axes


def test_magnified_bodies_with_an_interference_meet_where_they_touch():
    """The interference is not drawn, but magnified as displacements are: shaft and hub have one radius."""
    _, axes = pressed()
    shaft, hub = (np.hypot(*outline.T) for outline in bodies_of(axes))
    assert factor_of(axes) * 0.002 > 10 * THROUGH * 4
    assert "also the initial ones" in axes.get_title(loc="left")
    assert shaft.max() == pytest.approx(hub.min(), abs=2e-5 * 4)  # quadratic elements


def test_magnified_bodies_move_by_the_stated_factor_from_their_dashed_outlines():
    """Also where a body is bent: the hole of the hub is narrower by the magnified interference, the outside stays."""
    result, axes = pressed()
    factor, state = factor_of(axes), result.boundary
    assert state is not None
    dashed = outlines(axes, GREY)
    own = np.array([name == "hub/bore" for name in state.edge_names])[state.edge]
    inward = 1 - factor * 0.002 / 2
    assert off(inward * state.points[own], dashed) < 1e-9
    assert off(inward * state.points[own] + factor * state.displacement[own], np.concatenate(bodies_of(axes))) < 1e-9


def test_stress_fills_the_bodies_as_they_are_drawn():
    result = pressed()[0]
    axes = Figure(figsize=(5, 5)).add_subplot()
    figures.draw_deformed(axes, result, StressMeasure.VON_MISES)
    filled = np.concatenate([
        path.vertices for item in axes.collections if isinstance(item, TriContourSet) for path in item.get_paths()
    ])  # fmt: skip
    radius = np.hypot(*np.concatenate(bodies_of(axes)).T)
    assert np.hypot(*filled.T).max() == pytest.approx(radius.max(), rel=1e-3)


def test_whole_contact_of_two_bodies_is_marked_once():
    _, axes = pressed()
    (line,) = strokes(axes)
    assert line[[0, -1]].min(axis=1) == pytest.approx([0, 0], abs=1e-6)


def test_magnified_bodies_do_not_reach_through_each_other():
    """A roller between plates: the gap as drawn closes beside the contact before it would be seen to."""
    problem = spec.load(MODELS / "bodies" / "two_cylinders.yaml").with_value("accuracy", 0.1)
    result, axes = analysis.solve(problem), Figure(figsize=(5, 5)).add_subplot()
    figures.draw_deformed(axes, result)
    assert factor_of(axes) > 1
    one, other = bodies_of(axes)
    for outline, around in ((one, other), (other, one)):
        inside = outline[Outline(around, closed=True).contains_points(outline)]
        assert not len(inside) or off(inside, around) < 1.1 * THROUGH * problem.size


@cache
def in_a_groove() -> analysis.Result:
    result = analysis.solve(roller_in_a_groove())
    return replace(result, accuracy=of_peaks(result, 0.01 * float(result.solution.pressure.max())))


def test_close_up_shows_one_of_two_contacts_far_apart():
    result, axes = in_a_groove(), Figure(figsize=(4, 4)).add_subplot()
    figures.draw_contact(axes, result, "seat")
    (text,) = (text for text in axes.texts if text.get_text() != "$g$")
    assert np.ptp(axes.get_xlim()) < 6
    assert axes.get_xlim()[0] < text.get_position()[0] < axes.get_xlim()[1]


def test_each_of_two_equal_peaks_has_its_error_bar():
    texts = [text.get_text() for text in drawn(in_a_groove()).texts]
    assert sum("±" in text for text in texts) == 2


@pytest.mark.parametrize("draw", [figures.draw_contact, figures.draw_deformed])
def test_rigid_body_is_drawn_whole(draw: Callable[[Axes, analysis.Result], None]):
    axes = Figure(figsize=(4, 4)).add_subplot()
    draw(axes, in_a_groove())
    (ground,) = grey_lines(axes)
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    assert np.ptp(ground, axis=0) == pytest.approx([40, 22], rel=1e-6)
    assert (ground > (left, low)).all()
    assert (ground < (right, high)).all()


def test_bodies_have_their_names_and_colors():
    axes = Figure(figsize=(12, 4)).add_subplot()
    figures.draw_contact(axes, analysis.solve(leaves()))
    names = {text.get_text(): text.get_position()[1] for text in axes.texts}
    assert 0 < names["long"] < 4
    assert -4 < names["short"] < 0
    fills = [patch.get_facecolor() for patch in axes.patches if isinstance(patch, PathPatch) and patch.get_fill()]
    assert {to_rgba(color) for color in BODIES[:2]} <= {tuple(color) for color in fills}


def test_weight_of_a_body_is_drawn():
    axes = drawn(in_a_groove())
    assert "$g$" in [text.get_text() for text in axes.texts]


def test_what_is_rigid_has_its_name_where_there_are_several_things():
    """A floor, a wall and a lid are told apart by their zones; a roller on one plane has nothing to be told from."""
    axes = new_page(6, 6).add_subplot()
    figures.draw_contact(axes, analysis.solve(seal_in_a_groove()))
    places = {text.get_text(): text.get_position() for text in axes.texts}
    assert {"floor", "wall", "lid"} <= set(places)
    assert places["floor"][1] < -2 < 2 < places["lid"][1]
    assert places["wall"][0] < -2
    axes = new_page(6, 6).add_subplot()
    figures.draw_contact(axes, solved("gallery/hertz_small"))
    assert not any(name in text.get_text() for name in ("rim", "plane") for text in axes.texts)


@pytest.mark.slow
def test_a_rigid_body_has_its_name_in_it():
    axes = new_page(6, 6).add_subplot()
    result = analysis.solve(shaft_in_a_ring_in_a_housing())
    figures.draw_contact(axes, result)
    away = {text.get_text(): np.hypot(*text.get_position()) for text in axes.texts}
    assert away["shaft"] < 14 < away["ring"] < 20 < away["housing"]
