"""Starts: given, random, many at once."""

import itertools
import json
import re
from dataclasses import replace

import numpy as np
import pytest
from contact_problems import resting

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.errors import OptionError
from bemcontact.formulations import complementarity, qp1
from bemcontact.formulations.multistart import multistart
from bemcontact.formulations.search import Start, draw_starts
from bemcontact.options import Equilibrium, SolveOptions

P_MATRIX = np.array([[1.0, -3.0, 0.0], [0.0, 1.0, -3.0], [0.0, 0.0, 1.0]])
"""Triangular with positive diagonal, so a P-matrix, but far from positive definite."""


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


@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_a_strictly_monotone_problem_has_one_end(formulation):
    problem = resting()
    computed = multistart(problem, SolveOptions.of(formulation, starts=25))
    (end,) = computed.ends
    assert (computed.solved, end.count, end.first_start) == (25, 25, 0)
    assert end.residual < 1e-10
    assert end.objective == pytest.approx(0, abs=1e-10)
    direct = complementarity.solve(problem)
    np.testing.assert_allclose(end.solution.pressure, direct.pressure, atol=1e-10 * direct.pressure.max())


def test_penalised_equilibrium_has_a_second_end():
    """The lifted body: one end wherever it is lifted to, F2 > 0, counted apart and put last."""
    computed = multistart(resting(), SolveOptions.of("qp2", equilibrium=Equilibrium.PENALTY, starts=60))
    best, lifted = computed.ends
    assert best.solution.status is Status.SOLVED
    assert lifted.solution.status is Status.LOCAL_MINIMUM
    assert not lifted.solution.pressure.any()
    assert lifted.objective > 0.1
    assert best.count + lifted.count == 60
    assert lifted.count > 0
    assert str(computed).startswith(f"{best.count} of 60 random starts (seed 0) end at the contact state\n")


@pytest.mark.parametrize("formulation", ["qp1", "qp2"])
def test_a_p_matrix_has_one_end(formulation):
    """Every first-order point of QP1 and QP2 is the solution for a P-matrix of any definiteness (row sufficient)."""
    rng = np.random.default_rng(0)
    for _ in range(3):
        problem = CondensedContact.from_compliance(P_MATRIX, rng.standard_normal(3))
        computed = multistart(problem, SolveOptions.of(formulation, starts=15))
        assert [end.solution.status for end in computed.ends] == [Status.SOLVED]
        truth = complementarity.solve(problem).pressure
        np.testing.assert_allclose(computed.ends[0].solution.pressure, truth, atol=1e-9)


def test_a_matrix_that_is_not_p_has_all_its_ends_named():
    """M = [[1, 2], [2, 1]], q = (-1, -1): contact at either point alone or at both; by enumeration, three solutions."""
    M, q = np.array([[1.0, 2.0], [2.0, 1.0]]), np.array([-1.0, -1.0])
    truths = []
    for bits in itertools.product([False, True], repeat=2):
        A = np.flatnonzero(bits)
        p = np.zeros(2)
        p[A] = np.linalg.solve(M[np.ix_(A, A)], -q[A])
        if min(p.min(), (q + M @ p).min()) >= 0:
            truths.append(p)
    assert len(truths) == 3
    computed = multistart(CondensedContact.from_compliance(M, q), SolveOptions.of("qp1", starts=40))
    assert len(computed.ends) > 1
    for end in computed.ends:
        assert end.solution.status is Status.SOLVED
        assert any(np.abs(end.solution.pressure - truth).max() < 1e-10 for truth in truths)


def test_the_library_function_and_the_option_agree():
    problem = resting()
    computed = bemcontact.random_starts(problem, "qp2", count=10, seed=2, equilibrium="penalty")
    result = bemcontact.solve(problem, "qp2", equilibrium="penalty", start="random", seed=2, starts=10)
    assert result.certified
    assert result.starts is not None
    assert [end.count for end in result.starts.ends] == [end.count for end in computed.ends]
    data = json.loads(result.to_json())
    assert data["starts"]["solved"] == computed.solved
    assert sum(end["count"] for end in data["starts"]["ends"]) == 10
    assert data["search"]["start"] == f"random point {computed.ends[0].first_start}, seed 2"


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
def test_what_cannot_be_asked_is_refused(asked, pattern):
    with pytest.raises(OptionError, match=pattern):
        bemcontact.solve(resting(), **asked)


@pytest.mark.parametrize(
    ("asked", "pattern"),
    [
        ({"seed": None}, "seed must be a whole number of at least 0; found None"),
        ({"count": 2.5}, "number of starts must be a whole number of at least 1; found 2.5"),
        ({"count": True}, "number of starts"),
        ({"penalty": 1e13, "formulation": "qp2"}, "from 1e-08 to"),
    ],
)
def test_what_random_starts_cannot_be_asked_is_refused(asked, pattern):
    with pytest.raises(OptionError, match=pattern):
        bemcontact.random_starts(resting(), **asked)


@pytest.mark.parametrize(("asked", "starts"), [({"seed": 5}, None), ({"starts": 2}, 2), ({"seed": 5, "starts": 2}, 2)])
def test_a_seed_or_a_number_means_random_starts(asked, starts):
    implied = bemcontact.solve(resting(), "qp1", **asked)
    said = bemcontact.solve(resting(), "qp1", start="random", **asked)
    assert implied.solution.search == said.solution.search
    assert (None if implied.starts is None else implied.starts.count) == starts


def test_a_limit_of_iterations_reaches_every_search():
    computed = bemcontact.random_starts(resting(), "qp1", count=3, max_iterations=2)
    assert {end.solution.status for end in computed.ends} == {Status.ITERATION_LIMIT}
    assert max(end.iterations[1] for end in computed.ends) <= 2
    result = bemcontact.solve(resting(), "qp1", max_iterations=2)
    assert result.solution.status is Status.ITERATION_LIMIT
    assert "--max-iterations; 2 were done" in result.certificate.words


def test_progress_counts_what_is_done():
    done = []
    bemcontact.random_starts(resting(), "qp1", count=4, progress=done.append)
    bemcontact.solve(resting(), "qp1", starts=3, progress=done.append)
    assert done == [1, 2, 3, 4, 1, 2, 3]


def test_all_infeasible_ends_are_one():
    """M = -1, q = -1 has no contact state; where the search saw that means nothing, nor does the objective there."""
    computed = multistart(CondensedContact.from_compliance([[-1.0]], [-1.0]), SolveOptions.of("qp1", starts=12))
    (end,) = computed.ends
    assert (end.count, end.objective, computed.solved) == (12, None, 0)
    assert re.fullmatch(r"12 x infeasible, (\d+ to )?\d+ iterations?", str(end))
    assert json.loads(json.dumps(computed.to_dict(), allow_nan=False))["ends"][0]["objective"] is None


def test_all_unbounded_ends_are_one():
    """On δ = 1 + p both grow along p = (1, 1), where pᵀJδ falls as -2p² for J = [[1, -2], [-2, 1]]."""
    J = np.array([[1.0, -2.0], [-2.0, 1.0]])
    problem = replace(CondensedContact.from_compliance(np.eye(2), [1.0, 1.0]), consistent_weights=J)
    computed = multistart(problem, SolveOptions.of("qp1", "consistent", starts=12))
    assert [end.solution.status for end in computed.ends] == [Status.UNBOUNDED]
    assert computed.ends[0].count == 12


@pytest.mark.parametrize(
    ("pressure", "displacement"),
    [([1.0], [1.0, 2.0]), ([np.nan], [0.0]), (np.zeros((2, 2)), np.zeros((2, 2))), ("x", [1.0]), (None, [1.0])],
)
def test_a_start_of_no_meaning_is_refused(pressure, displacement):
    with pytest.raises(OptionError, match="start needs"):
        Start(pressure=pressure, displacement=displacement)


def test_random_starts_are_for_local_solvers():
    with pytest.raises(OptionError, match="no use for the option 'starts'"):
        bemcontact.random_starts(resting(), "qp3")


def test_nothing_is_polished():
    """A polish would turn the lifted body into the solution."""
    computed = multistart(resting(), SolveOptions.of("qp1", polish=True, starts=2))
    assert not any(end.solution.polished for end in computed.ends)
