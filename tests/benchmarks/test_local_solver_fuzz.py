"""The judge of whole-number programs refuses wrong answers; the local solver gives right ones in any units."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from exact_judge import Verdict, judge, solved_exactly
from hypothesis import example, given, settings
from hypothesis import strategies as st
from integer_program import (
    IntegerProgram,
    Units,
    endless_program,
    narrow_program,
    plain_units,
    random_units,
    resting_program,
)
from local_solver_fuzz import case, outcomes, solved

from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.result import QPResult, QPStatus

INF = np.inf
BAD = ("judge", "numerical", "restart")


@pytest.fixture(autouse=True, scope="module", params=["phases", pytest.param("numba", marks=pytest.mark.slow)])
def iterations(request):
    """What takes the regular iterations."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("bemcontact.compilation.numba_is_imported", lambda: request.param == "numba")
        yield


def saddle_in_a_box() -> IntegerProgram:
    """-x1 x2 over [-1, 1]²: a saddle at 0, minimizers -1 at (1, 1) and (-1, -1)."""
    H = np.array([[0.0, -1.0], [-1.0, 0.0]])
    return IntegerProgram(H=H, c=np.zeros(2), A=np.zeros((0, 2)), lower=-np.ones(2), upper=np.ones(2))


def quadrant(sign: float) -> IntegerProgram:
    """Sign x1 x2 over the quadrant x >= 0: the form is copositive for sign 1, and falls along (1, 1) for sign -1."""
    program = saddle_in_a_box()
    return replace(program, H=-sign * program.H, lower=np.zeros(2), upper=np.full(2, INF))


def claimed(program: IntegerProgram, x: list[float], status: QPStatus, **evidence: np.ndarray) -> QPResult:
    """A result that claims this of x."""
    result = solved(program, plain_units(program), None, None)
    return replace(result, x=np.array(x), status=status, **evidence)


@pytest.mark.parametrize(
    ("program", "x", "verdict"),
    [
        (saddle_in_a_box(), [0.0, 0.0], Verdict.FALSE_MINIMIZER),
        (saddle_in_a_box(), [1.0, 1.0], Verdict.RIGHT),
        (saddle_in_a_box(), [1.0, -1.0], Verdict.FALSE_MINIMIZER),
        (saddle_in_a_box(), [2.0, 2.0], Verdict.FALSE_MINIMIZER),
        (quadrant(1.0), [0.0, 0.0], Verdict.RIGHT),
        (quadrant(-1.0), [0.0, 0.0], Verdict.FALSE_MINIMIZER),
        (quadrant(-1.0), [1e-12, 1e-12], Verdict.FALSE_MINIMIZER),
    ],
)
def test_the_judge_distinguishes_minimizers_from_other_points(program, x, verdict):
    assert judge(program, plain_units(program), claimed(program, x, QPStatus.LOCAL_MINIMIZER)) is verdict


@pytest.mark.parametrize("seed", [1234, 9424, 18878])
def test_the_judge_tells_a_strict_minimizer_from_the_corner_next_to_it(seed):
    """A minimizer that is 4e-10 to 5e-7 away from a bound that does not hold it."""
    rng = np.random.default_rng(seed)
    program = narrow_program(rng)
    units = random_units(program, rng)
    start = rng.integers(-4, 5, program.c.size).astype(float) if rng.random() < 0.5 else None
    assert judge(program, units, solved(program, units, start, None)) is Verdict.RIGHT


def test_the_judge_refuses_rays_that_leave_or_rise():
    units = Units(columns=np.ones(2), rows=np.ones(0), objective=1.0)
    for program, ray, verdict in (
        (quadrant(-1.0), [1.0, 1.0], Verdict.RIGHT),
        (quadrant(-1.0), [1.0, -1.0], Verdict.FALSE_UNBOUNDED),
        (quadrant(1.0), [1.0, 1.0], Verdict.FALSE_UNBOUNDED),
        (saddle_in_a_box(), [1.0, 1.0], Verdict.FALSE_UNBOUNDED),
    ):
        result = claimed(program, [0.0, 0.0], QPStatus.UNBOUNDED, ray=np.array(ray))
        assert judge(program, units, result) is verdict


def test_the_judge_refuses_a_certificate_that_proves_nothing():
    """x1 + x2 >= 3 contradicts the box [-1, 1]², x1 + x2 >= 2 does not."""
    for bound, verdict in ((3.0, Verdict.RIGHT), (2.0, Verdict.FALSE_INFEASIBLE)):
        rows = {"lower": np.array([-1.0, -1.0, bound]), "upper": np.array([1.0, 1.0, INF])}
        program = replace(saddle_in_a_box(), A=np.ones((1, 2)), **rows)
        result = claimed(program, [1.0, 1.0], QPStatus.INFEASIBLE, certificate=np.array([-1.0, -1.0, 1.0]))
        assert judge(program, plain_units(program), result) is verdict


def test_equations_are_solved_in_fractions():
    rows = [[Fraction(2), Fraction(4), Fraction(6)], [Fraction(1), Fraction(2), Fraction(3)]]
    assert solved_exactly(rows, 2, [Fraction(0), Fraction(1, 2)]) == [Fraction(2), Fraction(1, 2)]
    assert solved_exactly([*rows, [Fraction(1), Fraction(2), Fraction(4)]], 2, [Fraction(0)] * 2) is None


@pytest.mark.slow
@settings(max_examples=400)
@given(st.integers(0, 10**9))
@example(361)
@example(9097)
@example(1282)
@example(2000161)
@example(20004158)
@example(20001064)
@example(70004828)
@example(70013905)
@example(100054772)
@example(100045516)
@example(100008520)
@example(100054992)
@example(100384487)
@example(100533185)
@example(300356280)
@example(300739627)
@example(300745930)
@example(300306888)
@example(400575139)
@example(400348856)
@example(400871184)
def test_no_claim_is_false_in_any_units_and_a_restart_at_an_answer_moves_nothing(seed):
    """Powers of ten from 1e-8 to 1e8 on rows, columns and the objective; random starts and working sets."""
    assert not [name for name in outcomes(seed) if any(bad in name for bad in BAD)]


@pytest.mark.slow
@settings(max_examples=150)
@given(st.integers(0, 10**9))
@example(1014709)
@example(1019846)
@example(1005738)
@example(1067815)
@example(2136)
def test_no_claim_is_false_at_degenerate_points_at_the_edge_of_copositivity(seed):
    assert not [name for name in outcomes(seed, degenerate=True) if any(bad in name for bad in BAD)]


@pytest.mark.slow
@settings(max_examples=300)
@given(st.integers(0, 10**9))
@example(124)
@example(141)
@example(356)
def test_rounding_in_place_of_zeros_makes_no_minimizer(seed):
    """A start whose zeros are numbers from 1e-16 to 1e-60, at a point of zero gradient that is often a saddle."""
    rng = np.random.default_rng(seed)
    program, x, zeros = resting_program(rng)
    units = random_units(program, rng)
    start = x + zeros * rng.choice([-1, 1], x.size) * 10.0 ** -rng.uniform(16, 60, x.size)
    assert judge(program, units, solved(program, units, start, None)) is not Verdict.FALSE_MINIMIZER


@pytest.mark.slow
@settings(max_examples=200)
@given(st.integers(0, 10**9))
@example(215)
@example(226)
@example(1129)
@example(13713)
def test_a_flat_ray_that_falls_has_no_end_in_any_units(seed):
    rng = np.random.default_rng(seed)
    program = endless_program(rng)
    units = random_units(program, rng)
    working_set = rng.integers(-1, 2, program.lower.size) if rng.random() < 0.3 else None
    result = solved(program, units, None, working_set)
    assert result.status is QPStatus.UNBOUNDED
    assert judge(program, units, result) is not Verdict.FALSE_UNBOUNDED


@pytest.mark.slow
@settings(max_examples=150)
@given(st.integers(0, 10**9))
@example(1107)
@example(6173)
@example(1109)
@example(18827)
@example(11668)
def test_rows_that_are_parallel_up_to_a_thousandth_have_answers_that_stay(seed):
    """Their multipliers lose three digits; a restart, from x alone or with the working set, moves nothing."""
    rng = np.random.default_rng(seed)
    program = narrow_program(rng)
    units = random_units(program, rng)
    start = rng.integers(-4, 5, program.c.size).astype(float) if rng.random() < 0.5 else None
    result = solved(program, units, start, None)
    assert judge(program, units, result) in (Verdict.RIGHT, Verdict.NO_CLAIM, Verdict.UNSETTLED)
    assert result.status is not QPStatus.NUMERICAL_FAILURE
    if result.status is QPStatus.LOCAL_MINIMIZER:
        sides = result.working_set if seed % 2 else None
        again = minimize_qp(*program.stated(units), x0=result.x, working_set=sides)
        assert (again.status, again.iterations) == (result.status, 0)


@pytest.mark.slow
@settings(max_examples=300)
@given(st.integers(0, 10**9))
@example(939)
@example(1008)
@example(1585)
@example(3153)
@example(3844)
@example(3900)
@example(4416)
@example(4657)
def test_rows_that_are_parallel_up_to_1e_7_have_no_false_claim(seed):
    """Seven digits of multipliers and directions are rounding; what they could decide is undecided."""
    rng = np.random.default_rng(seed)
    program = narrow_program(rng, 10**7)
    units = random_units(program, rng)
    start = rng.integers(-4, 5, program.c.size).astype(float) if rng.random() < 0.5 else None
    assert "false" not in judge(program, units, solved(program, units, start, None))


@pytest.mark.slow
@settings(max_examples=200)
@given(st.integers(0, 10**9))
def test_units_change_no_verdict_of_convex_programs(seed):
    """A convex program is infeasible, unbounded or has one least value, whatever the units."""
    program, units, start, working_set = case(seed)
    program = replace(program, H=program.H @ program.H)
    plain = solved(program, plain_units(program), start, working_set)
    scaled = solved(program, units, start, working_set)
    assert scaled.status is plain.status
    if plain.status is QPStatus.LOCAL_MINIMIZER:
        np.testing.assert_allclose(scaled.objective / units.objective, plain.objective, rtol=1e-8, atol=1e-8)
