"""Intervals, peak and resultant of given pressures and gaps."""

from dataclasses import replace

import numpy as np
import pytest

from bemcontact.assessment.footprint import Footprint, end_rates, footprint
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status


def state(
    points: np.ndarray,
    arc: np.ndarray,
    pressure: np.ndarray,
    gap: np.ndarray,
    *,
    perimeter: float = np.inf,
    normals: np.ndarray | None = None,
    zone: np.ndarray | None = None,
    run: np.ndarray | None = None,
) -> tuple[CondensedContact, ContactSolution]:
    """A contact state by its pressure and gap, with unit weights; the compliance does not matter here."""
    n = len(arc)
    problem = CondensedContact.from_compliance(np.eye(n), np.ones(n))
    run = np.zeros(n, int) if run is None else run
    problem = replace(
        problem,
        points=points,
        normals=problem.normals if normals is None else normals,
        arc_position=arc,
        run=run,
        run_length=np.full(run.max() + 1, perimeter),
        zone=np.zeros(n, int) if zone is None else zone,
        zone_names=("foot", "side"),
    )
    solution = ContactSolution(
        formulation="test",
        solver="none",
        status=Status.SOLVED,
        pressure=pressure,
        displacement=gap - 1.0,
        rigid_amplitudes=np.zeros(0),
        iterations=0,
    )
    return problem, solution


def along_x(arc: np.ndarray, start: float, end: float) -> tuple[CondensedContact, ContactSolution]:
    """Contact from `start` to `end` on the x axis; outside the gap is s^(3/2) of the distance: exact for the line."""
    outside = np.maximum(np.maximum(start - arc, arc - end), 0.0)
    return state(np.column_stack([arc, 0 * arc]), arc, (outside == 0) * 1.0, outside**1.5)


def test_contact_ends_half_way_where_the_gap_jumps_and_grows_by_rounding_alone():
    """By a last digit that is gone in δ^(2/3), so that its line is level; a gap that does not grow ends there too."""
    arc = np.arange(4.0)
    gaps = 1.5 + np.arange(20) * np.finfo(float).eps
    lost = np.flatnonzero((gaps[1:] > gaps[:-1]) & (gaps[1:] ** (2 / 3) == gaps[:-1] ** (2 / 3)))[0]
    for beyond in (gaps[lost : lost + 2], gaps[[lost, lost]]):
        gap = np.concatenate([[0.0, 0.0], beyond])
        contact, solution = state(np.column_stack([arc, 0 * arc]), arc, (arc < 2) * 1.0, gap)
        (interval,) = footprint(contact, solution).intervals
        assert (interval.start_arc, interval.end_arc) == (0.0, 1.5)
        assert end_rates(contact, solution, np.zeros(4)) == ((0.0, 0.0),)


def test_end_is_the_zero_of_the_line_through_the_gap():
    """δ^(2/3) is a line by construction, so that the ends come out exactly though no node lies there."""
    (interval,) = footprint(*along_x(np.linspace(-2, 2, 21), -0.73, 1.11)).intervals
    assert interval.zone == "foot"
    assert (interval.start_arc, interval.end_arc) == pytest.approx((-0.73, 1.11), abs=1e-12)
    assert (*interval.start, *interval.end) == pytest.approx((-0.73, 0.0, 1.11, 0.0), abs=1e-12)


def test_flat_gap_of_hertz():
    """Hertz: δ ∝ x sqrt(x² - 1) - arcosh x beyond |x| = 1; with spacing 0.04 the ends are within 0.3 %."""
    x = np.linspace(-1.5, 1.5, 76)
    beyond = np.maximum(np.abs(x), 1.0)
    gap = beyond * np.sqrt(beyond**2 - 1) - np.arccosh(beyond)
    pressure = np.sqrt(np.maximum(1 - x**2, 0))
    (interval,) = footprint(*state(np.column_stack([x, 0 * x]), x, pressure, gap)).intervals
    assert interval.end_arc == pytest.approx(1.0, abs=0.003)
    assert interval.start_arc == pytest.approx(-1.0, abs=0.003)


@pytest.mark.parametrize(("open_nodes", "expected"), [(2, 1.3), (1, 1.5), (0, 1.0)])
def test_few_open_nodes(open_nodes, expected):
    """Two: the line through both, exact here; one: half-way; none: the last point of the run."""
    arc = np.arange(2.0 + open_nodes)
    (interval,) = footprint(*along_x(arc, -1.0, 1.3)).intervals
    assert interval.end_arc == pytest.approx(expected, abs=1e-12)
    assert interval.start_arc == 0.0


def test_end_stays_between_the_contact_and_the_first_open_node():
    """A gap that jumps, or is slow to open, cannot push the end past its neighbors."""
    arc = np.arange(6.0)
    p = np.array([1.0, 1, 0, 0, 0, 0])
    points = np.column_stack([arc, 0 * arc])
    for gap, expected in (([0, 0, 5.0, 5.1, 5.2, 5.3], 1.0), ([0, 0, 0.0, 1.0, 8.0, 20.0], 2.0)):
        (interval,) = footprint(*state(points, arc, p, np.array(gap))).intervals
        assert interval.end_arc == expected


def test_pocket_between_two_intervals():
    """The gap rises and falls again: only its rising part on each side is used, and the ends are mirrored."""
    arc = np.arange(9.0)
    gap = np.array([0, 0, 0, 1.0, 2.0, 1.0, 0, 0, 0])
    one, two = footprint(*state(np.column_stack([arc, 0 * arc]), arc, (gap == 0) * 1.0, gap)).intervals
    assert one.start_arc == 0.0
    assert two.end_arc == 8.0
    assert one.end_arc - 2 == pytest.approx(6 - two.start_arc, abs=1e-12)


def test_single_node_in_contact():
    """A polygon's corner: the interval straddles the node, within its neighbors."""
    (interval,) = footprint(*along_x(np.arange(7.0), 2.6, 3.3)).intervals
    assert (interval.start_arc, interval.end_arc) == pytest.approx((2.6, 3.3), abs=1e-12)


def test_ends_lie_on_the_curve():
    """On a circle of radius 2 the parabola through three nodes, 0.1 apart, is off by less than s³/R²/16 = 1.6e-5."""
    angle = np.linspace(-1.0, 1.0, 41)
    arc = 2 * angle
    points = 2 * np.column_stack([np.sin(angle), -np.cos(angle)])
    outside = np.maximum(np.abs(arc) - 0.83, 0.0)
    (interval,) = footprint(*state(points, arc, (outside == 0) * 1.0, outside**1.5)).intervals
    assert interval.end == pytest.approx((2 * np.sin(0.415), -2 * np.cos(0.415)), abs=1.6e-5)


def test_an_interval_has_a_perimeter_in_print_where_the_boundary_closes_on_itself():
    (open_ended,) = footprint(*along_x(np.linspace(-2, 2, 21), -0.73, 1.11)).intervals
    (closed,) = ring(3.0, 0.5).intervals
    assert repr(open_ended).endswith("run=0)")
    assert repr(closed).endswith(f"run=0, perimeter={2 * np.pi!r})")


def ring(center: float, half: float, n: int = 40) -> Footprint:
    """Contact around one angle on a full circle of radius 1."""
    angle = 2 * np.pi * np.arange(n) / n
    distance = np.abs((angle - center + np.pi) % (2 * np.pi) - np.pi)
    outside = np.maximum(distance - half, 0.0)
    points = np.column_stack([np.cos(angle), np.sin(angle)])
    return footprint(*state(points, angle, (outside == 0) * 1.0, outside**1.5, perimeter=2 * np.pi))


@pytest.mark.parametrize("center", [0.0, 0.05, 1.0, 3.0, 6.2])
def test_closed_run_goes_on_across_its_seam(center):
    """One interval wherever the contact lies, of the right length, with its ends at the right angles."""
    (interval,) = ring(center, 0.5).intervals
    assert interval.end_arc - interval.start_arc == pytest.approx(1.0, abs=1e-11)
    assert np.exp(1j * interval.start_arc) == pytest.approx(np.exp(1j * (center - 0.5)), abs=1e-11)
    assert complex(*interval.end) == pytest.approx(np.exp(1j * (center + 0.5)), abs=1e-3)


def test_closed_run_in_contact_all_around():
    (interval,) = ring(0.0, 4.0).intervals
    assert interval.start == pytest.approx(interval.end, abs=1e-12)
    assert interval.end_arc - interval.start_arc == pytest.approx(2 * np.pi, rel=1e-12)


def test_zones_and_runs_are_kept_apart():
    """Contact at the end of one run and the start of the next is two intervals, each with the name of its zone."""
    arc = np.array([0.0, 1, 2, 0, 1, 2])
    p, gap = np.array([0.0, 0, 1, 1, 0, 0]), np.array([2.0, 1, 0, 0, 1, 2])
    group = np.repeat([0, 1], 3)
    points = np.column_stack([arc, group])
    one, two = footprint(*state(points, arc, p, gap, zone=group, run=group)).intervals
    assert (one.zone, two.zone) == ("foot", "side")
    assert one.end == (2.0, 0.0)
    assert two.start == (0.0, 1.0)


def test_no_contact():
    arc = np.arange(4.0)
    result = footprint(*state(np.column_stack([arc, 0 * arc]), arc, np.zeros(4), np.ones(4)))
    assert result.intervals == ()
    assert result.peak is None
    assert result.resultant.force == (0.0, 0.0)
    assert result.resultant.line_point is None


def test_resultant_and_line_of_action():
    """Forces (0, 2) at x = 1 and (0, 6) at x = 3: together (0, 8) at x = 2.5, moment 20 about the origin."""
    arc = np.array([0.0, 1.0, 2.0, 3.0])
    result = footprint(*state(np.column_stack([arc, 0 * arc - 1]), arc, np.array([0.0, 2, 0, 6]), np.zeros(4)))
    assert result.resultant.force == (0.0, 8.0)
    assert result.resultant.moment == pytest.approx(20.0)
    assert result.resultant.line_point == pytest.approx((2.5, 0.0))
    assert result.peak is not None
    assert result.peak.pressure == 6.0
    assert result.peak.at == (3.0, -1.0)


def test_oblique_resultant():
    """The moment of the force through the point of the line nearest to the origin is the moment."""
    rng = np.random.default_rng(0)
    normals = rng.standard_normal((5, 2))
    normals /= np.hypot(*normals.T)[:, None]
    result = footprint(
        *state(rng.standard_normal((5, 2)), np.arange(5.0), rng.uniform(0, 1, 5), np.zeros(5), normals=normals)
    ).resultant
    assert result.line_point is not None
    (x, y), (fx, fy) = result.line_point, result.force
    assert x * fy - y * fx == pytest.approx(result.moment, rel=1e-12)
    assert x * fx + y * fy == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("count", [2, 3, 7, 40, 1000])
@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_forces_that_balance_each_other_have_no_line_of_action(count: int, unit: float):
    """Equal pressures all round a circle: their sum is zero, and round-off in floating point."""
    angle = 2 * np.pi * np.arange(count) / count + 0.1
    normals = np.column_stack([np.cos(angle), np.sin(angle)])
    result = footprint(*state(normals, angle, np.full(count, unit), np.zeros(count), normals=normals)).resultant
    assert np.hypot(*result.force) <= 1e-12 * count * unit
    assert result.line_point is None
