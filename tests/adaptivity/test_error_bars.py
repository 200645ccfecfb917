"""Error bars are no smaller than the change by bisection, and have no unit."""

from collections.abc import Callable
from functools import cache
from math import ceil, pi, radians

import numpy as np
import pytest
from adaptive_problems import (
    Case,
    cam_nose,
    flat_punch_at_corner,
    half_disk,
    hertz_full,
    hertz_hundredth,
    partial_load_lifts_off,
    problem,
    rectangle,
    rod,
    wave_light,
)

import bemcontact
from bemcontact.adaptivity.adapt import meshed
from bemcontact.adaptivity.error_bars import END, FORCE, PEAK, SAFETY, error_bars, pressure_change
from bemcontact.adaptivity.fields import MeshDifference, solved
from bemcontact.adaptivity.hidden_changes import REMAINS, hidden_change, told_apart
from bemcontact.assessment.accuracy import ErrorBar
from bemcontact.problems import Problem

pytestmark = pytest.mark.usefixtures("meshes_found_once")


def difference(problem: Problem) -> MeshDifference:
    """A mesh fitted to contact, and its halves."""
    coarse = meshed(problem.with_value("accuracy", 3e-2)).problem
    coarse = coarse.model_copy(update={"mesh": coarse.mesh.model_copy(update={"refine": 1})})
    fine = coarse.model_copy(update={"mesh": coarse.mesh.model_copy(update={"refine": 2})})
    return MeshDifference(coarse=solved(coarse), fine=solved(fine), number=0)


def by_quantity(bars: tuple[ErrorBar, ...]) -> dict[str, ErrorBar]:
    return {item.quantity: item for item in bars}


@pytest.fixture(scope="module", params=[lambda: half_disk(2000.0), lambda: partial_load_lifts_off()[0]])
def changed(request: pytest.FixtureRequest) -> MeshDifference:
    return difference(request.param())


def test_bars_are_no_smaller_than_the_change(changed: MeshDifference):
    """Times 1.5 on the finer mesh; on the coarser one the change itself comes on top."""
    one, two = changed.pair
    fine, coarse = (by_quantity(error_bars(changed, (), of_fine=of_fine)) for of_fine in (True, False))
    peaks = float(one.pressure.max()), float(two.pressure.max())
    change = abs(peaks[1] - peaks[0]) / peaks[1]
    assert fine["peak"].value == peaks[1]
    assert coarse["peak"].value == peaks[0]
    assert (fine["peak"].bar or 0) >= SAFETY * change
    assert (coarse["peak"].bar or 0) >= (SAFETY + 1) * change * (1 - 1e-12)


def test_the_change_of_the_pressure_as_a_whole_is_a_floor_of_all(changed: MeshDifference):
    bars = by_quantity(error_bars(changed, ()))
    m = pressure_change(changed, 0, ())
    assert m is not None
    assert bars["pressure"].bar == pytest.approx(SAFETY * m)
    for quantity, share in (("peak", PEAK), ("force", FORCE), ("end", END), ("displacement", 1.0)):
        assert (bars[quantity].bar or 0) >= SAFETY * share * m * (1 - 1e-12)


def test_the_error_of_a_length_is_that_of_both_ends(changed: MeshDifference):
    bars = by_quantity(error_bars(changed, ()))
    start, end, length = (bars[name] for name in ("start", "end", "length"))
    assert None not in (start.value, end.value, start.bar, end.bar)
    assert length.value == pytest.approx((end.value or 0) - (start.value or 0))
    assert length.bar == pytest.approx((start.bar or 0) + (end.bar or 0))
    assert not length.promised


def test_a_free_end_is_no_better_known_than_its_nodes(changed: MeshDifference):
    """Two meshes graded to the same place give the same end, whatever its error is: a spacing of nodes is the least."""
    bars = by_quantity(error_bars(changed, ()))
    run = changed.fine.runs[0]
    end, length = bars["end"].value or 0.0, (bars["end"].value or 0.0) - (bars["start"].value or 0.0)
    beside = [high - low for low, high in zip(run.ends, run.ends[1:], strict=False) if low <= end <= high]
    assert (bars["end"].bar or 0) >= SAFETY * min(beside) / 2 / length * (1 - 1e-9)
    assert bars["start"].bar == 0.0  # contact reaches the axis
    assert bars["start"].note


@pytest.mark.parametrize("factor", [1e-3, 1e4])
def test_the_unit_of_stress_does_not_matter(factor: float):
    """On the same mesh: modulus and pressure times a factor."""
    problem = half_disk(2000.0)
    other = problem.with_value("material.young_modulus", 210e3 * factor).with_value(
        "conditions.cut.pressure", 2000.0 / 50 * factor
    )
    one, two = (error_bars(difference(p), ()) for p in (problem, other))
    stresses = {"peak", "force", "pressure"}
    for a, b in zip(one, two, strict=True):
        assert a.quantity == b.quantity
        assert b.bar == pytest.approx(a.bar, rel=1e-6, abs=1e-12)
        assert b.value == pytest.approx((a.value or 0) * (factor if a.quantity in stresses else 1), rel=1e-6)


def test_a_zone_without_contact_promises_nothing():
    problem = half_disk(2000.0)
    away = {"kind": "plane", "point": [0, -1], "normal": [0, 1]}
    data = problem.model_dump()
    data["contact_zones"]["foot"]["surface"] = away
    data["conditions"]["axis"]["displacement"]["y"] = 0.0
    force, displacement = error_bars(difference(Problem.model_validate(data)), ())
    assert (force.quantity, force.value, force.bar, force.promised) == ("force", 0.0, None, False)
    assert force.note
    assert displacement.promised


@pytest.mark.parametrize(("accuracy", "variant"), [(0.01, None), (1e-3, None), (0.01, "stated mesh")])
def test_contact_all_around_has_the_length_of_its_edges_without_error(accuracy: float, variant: str | None):
    """The perimeter of the bore is 2 π 10, whatever the mesh; there are no ends."""
    result = bemcontact.solve(bemcontact.load("models/gallery/shrink_fit.yaml", variant=variant), accuracy=accuracy)
    bar = result.accuracy.bar_of("length", "pin")
    assert bar.value == pytest.approx(2 * pi * 10, rel=1e-12)
    assert bar.bar == 0.0
    assert "no ends" in bar.note
    assert not [item for item in result.accuracy.bars if item.quantity in ("start", "end")]


def stated(problem: Problem, elements: int) -> Problem:
    """The problem on a mesh of equal elements, with the most on the longest edge, at least two on each."""
    data = problem.model_dump(exclude={"variants"})
    longest = max(edge.length for edge in problem.boundary.edges)
    for spec, edge in zip(data["boundary"]["outer"], problem.boundary.loops[0], strict=True):
        least = ceil(abs(getattr(edge.curve, "sweep", 0.0)) / radians(45))
        spec.update(elements=max(2, round(elements * edge.length / longest), least), grading=None, ends_at=())
    return Problem(**{**data, "accuracy": 0.01, "mesh": {"adapt": False}})


@pytest.mark.slow
@pytest.mark.parametrize("elements", [4, 8, 16, 32])
@pytest.mark.parametrize("case", [hertz_full, hertz_hundredth, cam_nose, partial_load_lifts_off, wave_light])
def test_no_bar_of_a_coarse_mesh_is_smaller_than_the_error(case: Callable[[], Case], elements: int):
    """Closed forms, and for forces statics: bars hold, or are not known."""
    problem, known = case()
    (judged,) = meshed(stated(problem, elements)).accuracies
    for bar in judged.bars:
        if bar.bar is None or bar.value is None:
            assert bar.note
        elif (bar.quantity, bar.zone) in known:
            truth, validity = known[bar.quantity, bar.zone]
            assert abs(bar.value / truth - 1) <= bar.bar + validity, bar


def test_the_largest_displacement_has_its_place_if_it_is_the_only_one():
    """A ring that grows moves by the same amount all around."""
    bent, ring = (bemcontact.load(f"models/{name}.yaml") for name in ("cantilever_flat_surface", "gallery/shrink_fit"))
    result = bemcontact.solve(bent, accuracy=0.05)
    bar, moved = result.accuracy.bar_of("displacement"), np.hypot(*np.moveaxis(result.boundary.displacement, 2, 0))
    assert bar.value == pytest.approx(moved.max(), rel=1e-12)
    assert np.unique(result.boundary.points[moved == moved.max()], axis=0) == pytest.approx(
        np.array([bar.at]), rel=1e-12
    )
    assert bemcontact.solve(ring, accuracy=0.05).accuracy.bar_of("displacement").at is None


def beam_between_walls() -> Problem:
    """A strip 200 by 4, clamped at both ends, on a rod that it reaches under its load."""
    held = {"displacement": {"x": 0, "y": 0}}
    return problem(
        "beam", rectangle(200, 4), {"rod": {"edges": "bottom", "surface": rod(100, -10.05, 10)}},
        conditions={"top": {"pressure": 0.03}, "left": held, "right": held},
    )  # fmt: skip


def with_graded_corners(found: Problem) -> Problem:
    """A mesh whose elements at the corners are cut at 4^-1 to 4^-6 of their length, and then all in two."""
    ends = {}
    for edge in found.boundary.edges:
        places = edge.breakpoints(1)
        near = 0.25 ** np.arange(1, 7)
        first, last = places[1] * near, 1 - (1 - places[-2]) * near
        ends[edge.name] = np.sort(np.concatenate([places[1:-1], first, last])).tolist()
    graded = found.with_element_ends(ends)
    return graded.model_copy(update={"mesh": graded.mesh.model_copy(update={"refine": 2})})


@cache
def force_of_the_rod() -> float:
    fine = solved(with_graded_corners(meshed(beam_between_walls().with_value("accuracy", 1e-2)).problem))
    return fine.force(fine.answers[0], 0)


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", [1e-2, 3e-3, 1e-3])
def test_errors_of_corners_and_of_other_elements_do_not_hide_each_other(accuracy: float):
    """The force of the rod is a quarter of the load, and the clamped corners make it too large, the others too small.

    On elements whose corners are graded, cut in 2, 3 and 4, the force is 1.52726, 1.52745 and 1.52748: their errors
    are below 2e-4. On a pair of meshes of the search it changed by 7e-5 while 9e-4 were missing.
    """
    found, truth = meshed(beam_between_walls().with_value("accuracy", accuracy)), force_of_the_rod()
    bar = found.accuracies[0].bar_of("force")
    assert bar.value is not None
    assert bar.bar is not None
    assert abs(bar.value - truth) <= (bar.bar + 2e-4) * truth


def test_what_a_force_may_hide_is_told_apart_by_a_third_mesh():
    """Beside a corner of the punch the bound is ten times too large; parts of both signs make no more than they do."""
    changed = difference(flat_punch_at_corner()[0])
    apart, *_ = told_apart([changed], 1e-5)
    assert apart.partly is not None
    before, between, after = (item.force(item.answers[0], 0) for item in apart.meshes)
    parts = abs(between - before) + abs(after - between)
    assert hidden_change(apart, 0) == pytest.approx(REMAINS * parts / after)
    assert hidden_change(apart, 0) < hidden_change(changed, 0) / 3
    assert told_apart([changed], 1.0) == [changed]


def test_the_force_that_statics_determines_hides_nothing():
    assert hidden_change(difference(half_disk(2000.0)), 0) < 1e-12


@pytest.mark.slow
def test_a_displacement_without_contact_hides_nothing_either():
    """A beam that is clamped at both ends bows under a temperature gradient, and does not reach the rod.

    A run at 1e-4 is the truth, with its own bar. By bisection alone an error of 1.9e-3 seemed to be one of 3e-4.
    """
    held = {"displacement": {"x": 0, "y": 0}}
    bowed = problem(
        "bow", rectangle(160, 10), {"rod": {"edges": "bottom", "surface": rod(80, -21.0, 20)}},
        conditions={"left": held, "right": held},
        loads={"temperature": {"expansion": 1.2e-5, "change": {"constant": 30.0, "y": -10.0}}},
    )  # fmt: skip
    reference = meshed(bowed.with_value("accuracy", 1e-4)).accuracies[0].bar_of("displacement")
    for accuracy in (1e-2, 3e-3, 1e-3):
        bar = meshed(bowed.with_value("accuracy", accuracy)).accuracies[0].bar_of("displacement")
        assert None not in (bar.value, bar.bar, reference.value, reference.bar)
        assert abs(bar.value - reference.value) <= bar.bar * bar.value + reference.bar * reference.value


def test_starts_and_ends_have_their_places():
    """Positions count from where the run begins; the places are those of the intervals of contact."""
    result = bemcontact.solve(partial_load_lifts_off()[0], accuracy=0.02)
    (interval,) = result.footprint.intervals
    for name, place in (("start", interval.start), ("end", interval.end)):
        assert result.accuracy.bar_of(name).at == pytest.approx(place, abs=1e-9)


@pytest.mark.parametrize("slant", [0.0, 8.0])
@pytest.mark.parametrize("gap", [1e-5, 2e-4, 2e-3])
def test_contact_ends_before_a_corner_that_is_held_off_the_surface(gap: float, slant: float):
    """The corner cannot touch. The bars hold an answer of four times the accuracy, and no pressure is infinite."""
    corners = {"bottom": (0, 0), "right": (40, 0), "top": (40 + slant, 20), "left": (0, 20)}
    block = {
        "name": "clamped",
        "material": {"young_modulus": 30200.0, "poisson_ratio": 0.3},
        "boundary": {"outer": [{"name": name, "start": at} for name, at in corners.items()]},
        "conditions": {"top": {"pressure": 30.0}, "right": {"fixed": True}},
        "contact_zones": {
            "floor": {"edges": "bottom", "surface": {"kind": "plane", "point": (0, -gap), "normal": (0, 1)}}
        },
    }
    coarse, fine = (
        {
            bar.quantity: bar
            for bar in meshed(Problem.model_validate({**block, "accuracy": accuracy})).accuracies[0].bars
        }
        for accuracy in (0.01, 0.0025)
    )
    assert coarse["end"].value < 40 - 1e-3
    for quantity, unit in (("end", 40.0), ("peak", coarse["peak"].value)):
        one, other = coarse[quantity], fine[quantity]
        assert abs(one.value - other.value) <= (one.bar + other.bar) * unit
