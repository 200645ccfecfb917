"""All problems of the benchmark of error bars can be built, and what is known of them names their zones."""

import pytest
from adaptive_problems import CASES

from bemcontact.adaptivity.mesh_sizes import first_mesh


@pytest.mark.parametrize("name", CASES)
def test_a_problem_has_a_first_mesh(name: str):
    """Two elements an edge at least, and no elements of its own; values are known of its zones."""
    problem, known = CASES[name]()
    assert problem.adapts
    assert not any(edge.elements for loop in problem.boundary.loops for edge in loop)
    assert {zone for _, zone in known if zone is not None} <= problem.contact_zones.keys()
    mesh = first_mesh(problem)
    assert all((edge.elements or 0) >= 2 for loop in mesh.boundary.loops for edge in loop)
