"""Every file in models/gallery/ meets its references by each formulation on its stated mesh and on finer ones."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jv

from bemcontact import spec
from bemcontact.analysis import compare as comparing
from bemcontact.analysis import solve as analysis
from bemcontact.analysis.result import Result
from bemcontact.problems import Problem
from bemcontact.reference import Score, expected, score

FOLDER = Path(__file__).parents[2] / "models" / "gallery"
GALLERY = sorted(path.stem for path in FOLDER.glob("*.yaml"))
FORMULATIONS = ("qp1", "qp2", "qp3")
STATED = "stated mesh"


@cache
def problem(name: str, refine: int = 1, case: str | None = None) -> Problem:
    stated = spec.load(FOLDER / f"{name}.yaml", variant=STATED).refined(refine)
    return stated if case is None else stated.with_case(case)


CASES = [(name, case) for name in GALLERY for case in problem(name).case_names or (None,)]
"""Each file with each of its load cases and combinations, or with none."""


@cache
def result(name: str, formulation: str, refine: int = 1, case: str | None = None) -> Result:
    return analysis.solve(condensed(name, refine, case), formulation)


@cache
def condensed(name: str, refine: int, case: str | None = None) -> analysis.CondensedContact:
    return analysis.condense(problem(name, refine, case))


@cache
def scores(name: str, formulation: str, refine: int, case: str | None = None) -> tuple[Score, ...]:
    answer = result(name, formulation, refine, case)
    known = expected(problem(name, refine, case), answer.contact)
    return score(known, answer.contact, answer.footprint, answer.solution.pressure)


@pytest.mark.parametrize(("name", "case"), CASES)
def test_condensed_problems_pass_the_checks_of_what_users_state(name, case):
    """Those that condensation leaves out: labels, shapes, ranges, and the order of points."""
    contact = condensed(name, 1, case)
    stated = replace(contact)
    parts = "tools", "cases", "pinned"
    for name, value in vars(stated).items():
        if name not in parts:
            np.testing.assert_equal(value, getattr(contact, name))
    assert all(getattr(stated, part) is getattr(contact, part) for part in parts)


def test_gallery_is_complete():
    assert GALLERY == [
        "beam_on_springs",
        "beam_on_two_supports",
        "block_in_corner",
        "body_between_two_tools",
        "cam_on_follower",
        "closed_crack",
        "eccentric_punch",
        "flat_punch",
        "hertz_small",
        "receding_contact",
        "roller_in_v_block",
        "rolling_polygon",
        "shrink_fit",
        "three_zones",
    ]


@pytest.mark.parametrize("name", GALLERY)
def test_problem_is_described_and_short(name: str):
    stated = problem(name)
    assert stated.description
    assert stated.units.stress
    assert all(reference.reason for reference in stated.reference.values())
    assert len((FOLDER / f"{name}.yaml").read_text(encoding="utf-8").splitlines()) <= 60


@pytest.mark.parametrize(("formulation", "refine"), [*((formulation, 1) for formulation in FORMULATIONS), ("qp3", 2)])
@pytest.mark.parametrize(("name", "case"), CASES)
def test_references_are_met(name: str, case: str | None, formulation: str, refine: int):
    assert result(name, formulation, refine, case).certified
    assert scores(name, formulation, refine, case)
    assert [item for item in scores(name, formulation, refine, case) if not (item.judged and item.holds)] == []


@pytest.mark.parametrize(("name", "case"), CASES)
def test_each_case_has_a_reference_of_its_own(name: str, case: str | None):
    assert case in {reference.case for reference in problem(name).reference.values()}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "case"), CASES)
def test_comparison_is_certified(name: str, case: str | None):
    comparison = comparing.compare(problem(name, case=case))
    assert all(contender.certified for contender in comparison.everyone)


@pytest.mark.parametrize(("name", "case"), CASES)
def test_finer_mesh_is_more_accurate(name: str, case: str | None):
    """The largest difference decreases, or is round-off if the method is exact on any mesh."""
    coarse, fine = (max(abs(item.difference or 0.0) for item in scores(name, "qp3", refine, case)) for refine in (1, 2))
    assert fine < coarse or fine < 1e-9


def test_ring_is_uniform_to_the_fourth_order():
    """Parabolas in place of circles: halving the elements divides the error by 16."""
    coarse, fine = (
        {item.quantity: item.difference for item in scores("shrink_fit", "qp3", refine)}["pressure (mean square)"]
        for refine in (1, 2)
    )
    assert coarse is not None
    assert coarse / fine == pytest.approx(16, rel=0.05)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_load_does_not_move_the_end_of_receding_contact(formulation: str):
    """Ten times and a tenth of the load: the same interval, and a pressure that is ten times and a tenth as large."""
    once = result("receding_contact", formulation)
    for factor in (10, 0.1):
        loaded = problem("receding_contact").with_value("conditions.loaded.pressure", 100 * factor)
        other = analysis.solve(loaded, formulation)
        assert other.certified
        assert other.footprint.intervals[0].end == pytest.approx(once.footprint.intervals[0].end, rel=1e-9, abs=1e-9)
        pressure = factor * once.solution.pressure
        assert other.solution.pressure == pytest.approx(pressure, abs=1e-9 * pressure.max())


def test_material_does_not_move_the_end_of_receding_contact():
    """Without friction, the stress between a strip and a rigid base does not depend on E and ν, but on the mesh."""
    steel = result("receding_contact", "qp3", 2).footprint.intervals[0].end[0]
    cork = problem("receding_contact", 2).with_value("material", {"young_modulus": 20, "poisson_ratio": 0.0})
    assert analysis.solve(cork).footprint.intervals[0].end[0] == pytest.approx(steel, rel=1e-4)


class EndlessStrip:
    """A strip of thickness 1 pressed on a rigid base by unit pressure on |x| < c of its top, by Fourier integrals.

    A pressure p̂ below and t̂ above, parts of it alike and opposite on both faces, raise the lower face by 1/ξ times
    S (p̂ + t̂) + A (p̂ - t̂), but for a factor. With p = Σ k_n U_2n(x/a) sqrt(1 - x²/a²), which vanishes at ±a, the
    slope of the face at points in contact is linear in k. k_0 has the load. One equation is left over; a solves it.
    """

    def __init__(self, half_load: float, terms: int = 10) -> None:
        knots, weights = np.polynomial.legendre.leggauss(24)
        ends = np.concatenate([[1e-3, 0.05], np.linspace(0.3, 60, 100)])
        half = np.diff(ends)[:, None] / 2
        self.xi, self.weights = (ends[:-1, None] + half * (1 + knots)).ravel(), (half * weights).ravel()
        self.alike = (np.cosh(self.xi) - 1) / (np.sinh(self.xi) + self.xi)
        self.opposite = (np.cosh(self.xi) + 1) / (np.sinh(self.xi) - self.xi)
        self.top, self.load, self.terms = 2 * np.sin(half_load * self.xi) / self.xi, 2 * half_load, terms

    def equations(self, a: float) -> tuple[np.ndarray, np.ndarray, float]:
        """Slope of the face at points in contact: M k + b for k_1 ... , and k_0."""
        theta = (np.arange(self.terms) + 0.5) * np.pi / (2 * self.terms + 1)
        sines = np.sin(a * np.cos(theta)[:, None] * self.xi) * self.weights
        first = 2 * self.load / (np.pi * a)

        def below(n: int) -> np.ndarray:
            return np.pi * (-1) ** n * (2 * n + 1) * jv(2 * n + 1, self.xi * a) / self.xi

        def slope(n: int, factor: float, top: np.ndarray) -> np.ndarray:
            p = factor * below(n)
            smooth = self.alike / 2 * (p + top) + self.opposite / 2 * (p - top) - p
            return factor * np.pi * np.cos((2 * n + 1) * theta) + sines @ smooth

        M = np.column_stack([slope(n, 1.0, 0 * self.xi) for n in range(1, self.terms)])
        return M, slope(0, first, self.top), first

    def left_over(self, a: float) -> float:
        """What no k can balance."""
        M, b, _ = self.equations(a)
        left = np.linalg.svd(M)[0][:, -1]
        return float(left @ b * np.sign(left[0]))

    def pressure(self, a: float, x: np.ndarray) -> np.ndarray:
        M, b, first = self.equations(a)
        k = np.concatenate([[first], np.linalg.lstsq(M, -b, rcond=None)[0]])
        theta = np.arccos(np.minimum(x / a, 1))
        return np.sin((2 * np.arange(self.terms) + 1) * theta[:, None]) @ k


def test_receding_contact_of_an_infinite_strip():
    """The numbers in the file are from another method. The pressure away from the end agrees to 0.1 %."""
    strip = EndlessStrip(half_load=0.5)
    a = brentq(strip.left_over, 0.95, 1.05, xtol=1e-12)
    stated = problem("receding_contact").reference["endless strip"]
    assert 10 * a == pytest.approx(stated.end, rel=1e-6)
    assert 100 * strip.pressure(a, np.zeros(1))[0] == pytest.approx(stated.peak, rel=1e-5)
    for refine, within in ((1, 1e-3), (2, 3e-4)):
        answer = result("receding_contact", "qp3", refine)
        x = answer.contact.points[:, 0]
        known = 100 * strip.pressure(a, x[x < 9] / 10)
        assert abs(answer.solution.pressure[x < 9] - known).max() < within * stated.peak


def test_polygon_rolls_into_its_groove():
    """The polygon starts without contact and turns by the 0.0064 of the groove; forces and moment are balanced."""
    answer = analysis.solve(problem("rolling_polygon"))
    assert answer.contact.initial_gap.min() > 0.1
    assert answer.contact.free_motions == 3
    assert {interval.zone for interval in answer.footprint.intervals} == {"right flank", "left flank"}
    resultant = answer.footprint.resultant
    assert resultant.force == pytest.approx((-120, 780), rel=1e-9)
    assert resultant.moment == pytest.approx(moment_of_the_loads(), rel=1e-9)
    assert answer.boundary is not None
    x, _ = (answer.boundary.points - [0, 25]).reshape(-1, 2).T
    _, v = answer.boundary.displacement.reshape(-1, 2).T
    turned, _ = np.linalg.lstsq(np.column_stack([x, x**0]), v, rcond=None)[0]
    # its faces are at atan 0.76 and atan 0.74 where those of the groove are at atan 0.75
    assert turned == pytest.approx(-(np.arctan(0.76) - np.arctan(0.74)) / 2, rel=2e-3)


def moment_of_the_loads() -> float:
    """Minus that of the pressures on the upper faces and of the weight, about the origin."""
    corners = np.array([(0, 0), (20, 15.2), (20, 35), (0, 50), (-20, 35), (-20, 14.8)])
    after = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
    assert cross.sum() / 2 == pytest.approx(1400)
    centroid = (corners + after).T @ cross / (3 * cross.sum())
    moment = -140 * centroid[0]
    for start, pressure in ((2, 12), (3, 20)):
        side, middle = after[start] - corners[start], (corners[start] + after[start]) / 2
        force = pressure * np.array([-side[1], side[0]])
        moment += middle[0] * force[1] - middle[1] * force[0]
    return -float(moment)


def test_link_touches_three_surfaces_of_different_kinds():
    stated = problem("three_zones").contact_zones
    assert {zone.surface.kind for zone in stated.values()} == {"circle", "polyline", "plane"}
    answer = result("three_zones", "qp3")
    assert [interval.zone for interval in answer.footprint.intervals] == list(stated)
    assert answer.footprint.resultant.force == pytest.approx((0, 400), rel=1e-9, abs=400e-9)
