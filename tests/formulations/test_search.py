"""Starts: given, random, many at once."""

import numpy as np
import pytest
from contact_problems import resting

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import OptionError, SpecError
from bemcontact.formulations import qp1
from bemcontact.formulations.starts import Start, draw_starts, read_start
from bemcontact.options import SolveOptions


def test_random_points_are_repeatable_and_free_of_units():
    """Fewer starts are the first of more, and a change of units scales them."""
    problem = resting()
    few, many = draw_starts(problem, 2, seed=4), draw_starts(problem, 5, seed=4)
    np.testing.assert_array_equal(few[1].displacement, many[1].displacement)
    assert (many[0].pressure >= 0).all()
    assert not np.array_equal(many[0].pressure, many[1].pressure)
    stiff = CondensedContact.from_compliance(
        problem.compliance / 1e3, problem.offset, rigid_motions=problem.rigid_motions, motion_load=-7e3
    )
    np.testing.assert_allclose(draw_starts(stiff, 1, seed=4)[0].pressure, many[0].pressure * 1e3, rtol=1e-12)


def test_one_random_start_is_the_first_of_many():
    problem = resting()
    one = bemcontact.solve(problem, "qp1", start="random", seed=5)
    assert one.certified
    assert one.starts is None
    assert one.solution.search.start == "random point 0, seed 5"
    again = qp1.solve(problem, SolveOptions.of("qp1", start=draw_starts(problem, 1, 5)[0]))
    assert again.iterations == one.solution.iterations


@pytest.mark.parametrize(
    ("asked", "pattern"),
    [
        ({"formulation": "qp3", "start": "random"}, "no use for the option 'start'"),
        ({"formulation": "complementarity", "start": "random"}, "no use for the option 'start'"),
        ({"formulation": "qp3", "starts": 3}, "no use for the option 'starts'"),
        ({"formulation": "complementarity", "seed": 3}, "no use for the option 'seed'"),
        ({"formulation": "qp1", "start": "null", "seed": 1}, "leave out the other start"),
        ({"formulation": "qp1", "start": "null", "starts": 3}, "leave out the other start"),
        (
            {"formulation": "qp1", "start": Start(pressure=np.ones(7), displacement=np.ones(7)), "starts": 3},
            "leave out",
        ),
        ({"formulation": "qp1", "starts": 2.5}, "number of starts must be a whole number of at least 1; found 2.5"),
        ({"formulation": "qp1", "seed": 1.5}, "seed must be a whole number of at least 0; found 1.5"),
        ({"formulation": "qp1", "start": np.zeros(45)}, "no start of type ndarray; take null, random, or a Start"),
        ({"formulation": "qp2", "penalty": "x"}, "penalty must be a number"),
        ({"formulation": "qp2", "penalty": None}, "penalty must be a number"),
        ({"formulation": "qp1", "max_iterations": 0}, "limit of iterations"),
        ({"formulation": None}, "take one of qp1"),
        ({"formulation": ["qp1"]}, "take one of qp1"),
        ({"formulation": "qp1", "start": "zero"}, "no start 'zero'"),
        ({"formulation": "qp1", "start": "random", "starts": 0}, "number of starts .* at least 1"),
        ({"formulation": "qp1", "start": "random", "seed": -1}, "seed .* at least 0"),
        ({"formulation": "qp1", "start": Start(pressure=np.zeros(2), displacement=np.zeros(2))}, "2 contact points"),
        ({"formulation": "qp1", "start": 3}, "take null, random"),
        ({"formulation": "qp2", "rows": "diagonal"}, "take one of stiffness, compliance"),
        ({"formulation": "qp2", "equilibrium": "none"}, "take one of constraint, penalty"),
        ({"formulation": "qp3", "equilibrium": "penalty"}, "no use for the option 'equilibrium'"),
    ],
)
def test_invalid_options_of_solve_are_refused(asked, pattern):
    with pytest.raises(OptionError, match=pattern):
        bemcontact.solve(resting(), **asked)


@pytest.mark.parametrize(("asked", "starts"), [({"seed": 5}, None), ({"starts": 2}, 2), ({"seed": 5, "starts": 2}, 2)])
def test_a_seed_or_a_number_means_random_starts(asked, starts):
    implied = bemcontact.solve(resting(), "qp1", **asked)
    said = bemcontact.solve(resting(), "qp1", start="random", **asked)
    assert implied.solution.search == said.solution.search
    assert (None if implied.starts is None else implied.starts.count) == starts


@pytest.mark.parametrize(
    ("pressure", "displacement"),
    [([1.0], [1.0, 2.0]), ([np.nan], [0.0]), (np.zeros((2, 2)), np.zeros((2, 2))), ("x", [1.0]), (None, [1.0])],
)
def test_a_start_of_no_meaning_is_refused(pressure, displacement):
    with pytest.raises(OptionError, match=r"start needs|of a start (must|has)"):
        Start(pressure=pressure, displacement=displacement)


def test_a_start_is_not_read_from_standard_input():
    with pytest.raises(SpecError, match="not read from standard input"):
        read_start("-")
