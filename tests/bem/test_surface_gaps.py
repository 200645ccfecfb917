"""Which elements are compared with a surface."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bemcontact import load, solve
from bemcontact.arrays import magnitudes
from bemcontact.bem.discretization import body_of
from bemcontact.bem.surface_gaps import surface_gaps

GALLERY = Path(__file__).parents[2] / "models" / "gallery"


@pytest.mark.parametrize("times", [1.0, 30.0, 1000.0])
@pytest.mark.parametrize("name", ["block_in_corner", "body_between_two_tools", "closed_crack", "hertz_small"])
def test_elements_that_may_touch_are_those_near_to_the_surface_before_or_after_the_motion(name, times):
    """As by its definition, with the distances of all elements, however far they move."""
    problem = load(GALLERY / f"{name}.yaml", variant="stated mesh")
    problem = problem.with_case(problem.case_names[0]) if problem.case_names else problem
    result = solve(problem)
    state = replace(result.boundary, displacement=times * result.boundary.displacement)
    gaps = surface_gaps(body_of(result.problem), state, result.contact, result.solution)
    every = np.arange(len(state.points))
    for zone in gaps.surfaces:
        near = np.zeros(len(every), bool)
        for places, gap in (
            (state.points, gaps.undeformed), (state.points + state.displacement, gaps.exact)
        ):  # fmt: skip
            length = magnitudes(np.diff(places, axis=1)).sum(axis=1)
            near |= gap(zone, places[:, 1]).gap <= length
        assert gaps.near(zone, every).tolist() == every[near].tolist()
        assert gaps.near(zone, every[:0]).tolist() == []
