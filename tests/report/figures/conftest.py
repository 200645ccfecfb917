"""Two problems with all that a picture shows, and their results."""

import pytest
from drawings import beam_over_a_circle, block_in_a_corner

from bemcontact.analysis import solve as analysis
from bemcontact.problems import Problem

PROBLEMS = {"corner": block_in_a_corner, "beam": beam_over_a_circle}


@pytest.fixture(scope="module", params=PROBLEMS.values(), ids=PROBLEMS)
def problem(request: pytest.FixtureRequest) -> Problem:
    return request.param()


@pytest.fixture(scope="module")
def result(problem: Problem) -> analysis.Result:
    return analysis.solve(problem)
