"""Fitting makes no shipped problem worse: references are still met, and errors are not larger than without a fit."""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import bemcontact
from bemcontact.analysis.result import Result
from bemcontact.problem import Problem
from bemcontact.reference import expected, score

MODELS = {path.stem: path for path in sorted((Path(__file__).parents[2] / "models").rglob("*.yaml"))}


@cache
def problem(name: str) -> Problem:
    return bemcontact.load(MODELS[name])


CASES = [(name, case) for name in MODELS for case in problem(name).case_names or (None,)]
"""Each file with each of its load cases and combinations, or with none."""


@cache
def solved(
    name: str, *, fit: bool, refine: int = 1, case: str | None = None, zone: tuple[str, int] | None = None
) -> Result:
    """A shipped problem under a load case, with another number of elements in its zone if that is given."""
    stated = problem(name).with_value("mesh.fit_contact_edges", fit).refined(refine)
    if case is not None:
        stated = stated.with_case(case)
    if zone is not None:
        stated = stated.with_value(f"boundary.outer.{zone[0]}.elements", zone[1])
    return bemcontact.solve(stated, "complementarity")


def differences(result: Result) -> dict[tuple[str, str], tuple[float, float]]:
    """Differences and tolerances of all that is judged."""
    assert result.problem is not None
    known = expected(result.problem, result.contact)
    scores = score(known, result.contact, result.footprint, result.solution.pressure)
    judged = [item for item in scores if item.judged]
    return {(item.reference, item.quantity): (abs(item.difference or 0.0), item.tolerance) for item in judged}


@pytest.mark.parametrize("refine", [1, 2])
@pytest.mark.parametrize(("name", "case"), CASES)
def test_references_are_still_met(name: str, case: str | None, refine: int):
    result = solved(name, fit=True, refine=refine, case=case)
    assert result.certified
    assert result.mesh_fit is not None
    assert differences(result)
    assert {key: pair for key, pair in differences(result).items() if pair[0] > pair[1]} == {}


@pytest.mark.parametrize(("name", "case"), CASES)
def test_pressures_are_not_farther_from_the_references(name: str, case: str | None):
    """In the mean square, up to a tenth of the tolerance of the reference."""
    fitted, unfitted = (differences(solved(name, fit=fit, case=case)) for fit in (True, False))
    for (reference, quantity), (difference, tolerance) in fitted.items():
        if quantity == "pressure (mean square)":
            assert difference <= unfitted[reference, quantity][0] + tolerance / 10


def peak(result: Result) -> float:
    assert result.footprint.peak is not None
    return result.footprint.peak.pressure


def start(result: Result) -> float:
    """Start of the contact of the cantilever [cm]."""
    return result.footprint.intervals[0].start[0]


def angle(result: Result) -> float:
    """Start of the contact of the bolt, in degrees from the top of the hole."""
    x, y = result.footprint.intervals[0].end
    return float(np.degrees(np.arctan2(-x, y)))


@pytest.mark.parametrize(
    ("name", "edge", "quantity", "truth", "within"),
    [
        ("bolt_in_plate", "bearing", peak, 48.59, 0.0015 * 48.59),  # finite elements; a tenth of the file's tolerance
        ("bolt_in_plate", "bearing", angle, 10.5, 0.5),  # finite elements, to half a degree
        ("cantilever_flat_surface", "landing", peak, 11.57, 0.003 * 11.57),  # finite elements, for the mesh
        ("cantilever_flat_surface", "landing", start, 42.395, 0.02),  # the same
    ],
)
def test_errors_are_no_larger(name: str, edge: str, quantity: Callable[[Result], float], truth: float, within: float):
    """On the mesh as stated, and the largest with up to two elements fewer or more in the zone.

    One mesh tells little of what is read off equal elements, which may happen to end where the contact ends.
    """
    stated = problem(name).edge(edge).elements
    counts = range(stated - 2, stated + 3)
    error = {
        fit: [abs(quantity(solved(name, fit=fit, zone=(edge, n))) - truth) for n in counts] for fit in (True, False)
    }
    assert error[True][counts.index(stated)] <= within
    assert max(error[True]) <= max(error[False]) * (1 + 1e-9)


def test_the_start_of_contact_does_not_depend_on_the_elements_in_the_zone():
    """Of the cantilever: with a fit, it moves by less than a tenth of what it moves without."""
    starts = {
        fit: [start(solved("cantilever_flat_surface", fit=fit, zone=("landing", n))) for n in (8, 9, 10, 11, 12)]
        for fit in (True, False)
    }
    assert np.ptp(starts[True]) <= np.ptp(starts[False]) / 10
