"""The comparison at an equal error: both bodies by both programs, and what has reached an error."""

import itertools
import time
from pathlib import Path

import boundary_elements_pressed
import finite_elements_pressed
import numpy as np
import pressure_error
import pytest
import timing
from finite_elements_pressed import BLOCK, CYLINDER, FILLET, FLAT, HEIGHT, WIDTH
from speed_of_finite_elements import LEAST_TURNS, LEVELS, Comparison, Point, both, neighboring, reached, targets

import bemcontact
from bemcontact.bem import condense as condensing
from bemcontact.contact.solution import Status


@pytest.mark.parametrize("module", [finite_elements_pressed, pressure_error])
def test_the_finite_elements_use_nothing_of_the_package(module):
    source = Path(module.__file__).read_text(encoding="utf-8")
    assert "import bemcontact" not in source
    assert "from bemcontact" not in source


@pytest.mark.parametrize(
    ("body", "state", "force"),
    [(CYLINDER, boundary_elements_pressed.cylinder, 405.0), (BLOCK, boundary_elements_pressed.block, 600.0)],
    ids=["cylinder", "block"],
)
def test_both_programs_solve_the_same_problem(body, state, force):
    """Forces are those of the loads; ends agree to what coarse meshes allow, pressures to 1 % in the L2 norm."""
    end = float(body.solve(body.uniform(0.25)).ends()[1])
    touch = body.solve(body.graded(0.35, end))
    result = bemcontact.solve(state(6, end))
    assert touch.force == pytest.approx([0, force], rel=1e-9)
    assert result.footprint.resultant.force == pytest.approx((0, force), rel=1e-3)
    assert result.footprint.intervals[0].end[0] == pytest.approx(touch.ends()[1], rel=3e-3)
    ours = boundary_elements_pressed.reported(result)
    for theirs in finite_elements_pressed.reported(touch).values():
        assert pressure_error.relative_error(ours, theirs, body.rate) < 0.01


@pytest.mark.parametrize("body", [CYLINDER, BLOCK], ids=["cylinder", "block"])
def test_the_lower_side_is_on_its_curve(body):
    """Height, rate and parameter of x belong together: place(along(x), 0) = (x, height), rate² = 1 + height'²."""
    x, step = np.linspace(0.1, body.candidate - 0.1, 30), 1e-6
    placed = np.array(body.place(body.along(x), np.zeros_like(x)))
    assert placed == pytest.approx(np.array([x, body.height(x)]), abs=1e-12)
    slope = (body.height(x + step) - body.height(x - step)) / (2 * step)
    assert body.rate(x) == pytest.approx(np.hypot(1, slope), rel=1e-7)


def test_the_block_has_its_corners():
    """The side starts where the chamfer of 45° from the end of the fillet meets it; the top is flat."""
    foot = FILLET * (1 - np.sqrt(0.5)) + WIDTH - FLAT - FILLET * np.sqrt(0.5)
    assert BLOCK.place(np.array([0.0, 1.0]), np.zeros(2)) == (pytest.approx([0, WIDTH]), pytest.approx([0, foot]))
    assert BLOCK.place(np.array([0.0, 1.0]), np.ones(2)) == (pytest.approx([0, WIDTH]), pytest.approx([HEIGHT] * 2))


@pytest.mark.parametrize("size", [0.5, 0.2])
def test_triangles_are_as_small_as_wanted(size):
    """Sides on the zone are at most as long as the size, times the length of the zone."""
    mesh = CYLINDER.uniform(size)
    ends = np.asarray(mesh.p)[:, np.asarray(mesh.facets)[:, mesh.boundary_facets()]]
    on_zone = (np.hypot(ends[0], ends[1] - 8) > 8 - 1e-9).all(axis=0) & (ends[0] <= CYLINDER.candidate).all(axis=0)
    lengths = np.hypot(*(ends[:, 0] - ends[:, 1]))[on_zone]
    assert on_zone.any()
    assert lengths.max() <= size * CYLINDER.candidate


def points(family, *errors):
    return [
        Point(family=family, setting=i, unknowns=10 * (i + 1), seconds=2.0**i, error=error, plain=2 * error)
        for i, error in enumerate(errors)
    ]


def test_equal_work_begins_at_the_stated_problem(monkeypatch: pytest.MonkeyPatch):
    """Finite elements set up loads and gaps within their time; so must this program, each time that it is timed."""
    compared = Comparison(body=CYLINDER, state=boundary_elements_pressed.cylinder, reference=None, end=2.8, unknowns=0,
                          checked=0.0)  # fmt: skip
    stated = boundary_elements_pressed.cylinder(5)
    attempt = compared._by_equal_work(compared._by_boundary_elements("elements, uniform", 5, stated), stated)
    made, original = [], condensing.body_of
    monkeypatch.setattr(condensing, "body_of", lambda problem: made.append(problem) or original(problem))
    for _ in range(2):
        assert attempt.run().status is Status.SOLVED
    assert made == [stated, stated]


def test_an_error_is_reached_where_all_finer_meshes_have_it():
    """The second mesh is below by luck, for the third one is not."""
    some = points("a", 0.1, 0.005, 0.02, 0.009, 0.001)
    assert reached(some, "a", 0.01).unknowns == 40
    assert reached(some, "a", 1e-4) is None
    assert reached(some, "b", 0.01) is None


def test_meshes_are_compared_at_an_equal_error():
    """The first family gets to 1 % with its third mesh, the second with its first; only the first gets to 0.1 %."""
    every = points("theirs", 0.1, 0.05, 0.01, 0.0005) + points("ours", 0.01, 0.009)
    assert both(every, ("theirs", "ours"), 0.01) == (every[2], every[4])
    assert both(every, ("theirs", "ours"), 0.001) is None
    assert both(every, ("theirs", "ours"), 0.02, plain=True) == (every[2], every[4])


def test_a_machine_that_becomes_slower_changes_no_ratio_of_neighboring_turns(monkeypatch: pytest.MonkeyPatch):
    """Both take 10 % longer from turn to turn."""
    clock, cost = [0.0], [1.0]

    def works(seconds: float) -> None:
        clock[0] += seconds * cost[0]

    def theirs() -> None:
        cost[0] *= 1.1
        works(6.0)

    monkeypatch.setattr(timing.time, "process_time", lambda: clock[0])
    monkeypatch.setattr(timing, "AT_ONCE", 0.0)
    ratios = timing.ratio(*neighboring(theirs, lambda: works(2.0), 25))
    assert (ratios.lower, ratios.median, ratios.upper) == pytest.approx((3.0, 3.0, 3.0))


def test_few_turns_are_enough_where_they_take_long(monkeypatch: pytest.MonkeyPatch):
    ticks = itertools.count()
    monkeypatch.setattr(time, "perf_counter", lambda: 100.0 * next(ticks))
    both_times = neighboring(lambda: np.ones(10**5).sum(), lambda: np.ones(10**5).sum(), 25)
    assert [len(times) for times in both_times] == [LEAST_TURNS, LEAST_TURNS]


def test_each_target_is_at_a_level_of_the_table():
    compared = Comparison(body=CYLINDER, state=boundary_elements_pressed.cylinder, reference=None, end=2.8, unknowns=0,
                          checked=0.0, points=points("elements, graded", 0.009))  # fmt: skip
    names = [target.name for target in targets(compared)]
    assert names[0] == "cylinder to 1 %: unknowns (graded)"
    assert {name.split(" %")[0].split()[-1] for name in names} <= {f"{100 * level:g}" for level in LEVELS}
