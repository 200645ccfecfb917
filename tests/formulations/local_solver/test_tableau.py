"""Iterations by machine code: they end where the phases end, on a tableau that is what it is said to be.

What `machine_code` is, `conftest` says.
"""

import subprocess
import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bemcontact import compilation
from bemcontact.formulations.local_solver import minimize
from bemcontact.formulations.local_solver.equilibration import scaled_data
from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.phase_two import WORTH_EDGES
from bemcontact.formulations.local_solver.result import QPOptions, QPStatus

INF = np.inf
NAME = "bemcontact.formulations.local_solver.tableau"
BY_CODE, BY_PHASES = QPOptions(by_numba=True), QPOptions(by_numba=False)


@pytest.fixture
def tableau(machine_code):
    return machine_code["tableau"]


def program(seed, *, convex, feasible, vertex=False):
    """Numbers at random, so that there are no ties. Zero is within the bounds, at a vertex, or violates constraints."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 13)), int(rng.integers(0, 9))
    B, A = rng.standard_normal((n, n)), rng.standard_normal((m, n))
    H = B @ B.T + 0.1 * np.eye(n) if convex else B + B.T
    inside = np.zeros(n) if feasible else 2 * rng.standard_normal(n)
    width = rng.uniform(0.1, 2.0, (2, n + m))
    middle = np.concatenate([inside, A @ inside])
    low, high = middle - width[0], middle + width[1]
    if vertex:
        low[:n] = 0.0
    else:
        equal = slice(n, n + min(m, n - 1) // 2)
        low[equal] = high[equal] = middle[equal]
    if convex:
        low[rng.random(n + m) < 0.2] = -INF
    return H, 3 * rng.standard_normal(n), A, low[n:], high[n:], low[:n], high[:n]


@pytest.mark.usefixtures("tableau")
@pytest.mark.parametrize("seed", range(12))
def test_from_a_vertex_the_iterations_are_those_of_phase_two(seed):
    """Indefinite: the same constraints enter and leave in the same order."""
    data = program(seed, convex=False, feasible=True, vertex=True)
    by_code, by_phases = (minimize_qp(*data, options=options) for options in (BY_CODE, BY_PHASES))
    assert by_code.status is by_phases.status
    assert [line[4:] for line in by_code.log] == [line[4:] for line in by_phases.log]
    assert_allclose([line[2:4] for line in by_code.log], [line[2:4] for line in by_phases.log], rtol=1e-9)
    assert abs(by_code.x - by_phases.x).max() < 1e-9
    assert by_code.by_numba == (by_phases.iterations > 0)
    assert not by_phases.by_numba


@pytest.mark.usefixtures("tableau")
@pytest.mark.parametrize("seed", range(12))
def test_from_an_infeasible_point_the_one_minimizer_is_found(seed):
    """Definite H: there is one, whatever the way there."""
    data = program(seed, convex=True, feasible=False)
    by_code, by_phases = (minimize_qp(*data, options=options) for options in (BY_CODE, BY_PHASES))
    assert by_code.status is by_phases.status is QPStatus.LOCAL_MINIMIZER
    assert abs(by_code.x - by_phases.x).max() < 1e-9
    assert by_code.by_numba


@pytest.mark.parametrize("convex", [True, False])
@pytest.mark.parametrize("seed", range(8))
def test_rows_of_the_tableau_are_conjugate_and_move_one_constraint_each(tableau, seed, convex, monkeypatch):
    """By their definition, after all iterations: G T is one on what is held, Z H Z is one, Z H and the rest is zero."""
    computed = []

    def watched(p, t, limits, descend=tableau.descend):
        descend(p, t, limits)
        computed.append((p, t))

    monkeypatch.setattr(tableau, "descend", watched)
    data = program(seed, convex=convex, feasible=seed % 2 == 0)
    minimize_qp(*data, options=BY_CODE)
    p, t = computed[0]
    k, n = int(t.counts[0]), p.c.size
    Z, rest, owners = t.T[:k], t.T[k:], t.owner[k:]
    G = np.vstack([np.eye(n), p.A])
    held = owners[owners >= 0]
    assert sorted(held) == list(np.flatnonzero(t.sides))
    assert abs(G[held] @ rest.T - (held[:, None] == owners)).max(initial=0) < 1e-9
    assert abs(G[held] @ Z.T).max(initial=0) < 1e-9
    assert abs(Z @ p.H @ Z.T - np.eye(k)).max(initial=0) < 1e-9
    assert abs(Z @ p.H @ rest.T).max(initial=0) < 1e-9
    assert abs(t.values - G @ t.values[:n]).max() < 1e-12


@pytest.mark.usefixtures("tableau")
def test_a_vertex_that_makes_simplex_methods_cycle_is_left():
    """Beale (1955): the least value is -5/4, at (1, 0, 1, 0)."""
    c = np.array([-0.75, 20.0, -0.5, 6.0])
    A = np.array([[0.25, -8.0, -1.0, 9.0], [0.5, -12.0, -0.5, 3.0], [0.0, 0.0, 1.0, 0.0]])
    result = minimize_qp(np.zeros((4, 4)), c, A, None, [0.0, 0.0, 1.0], np.zeros(4), options=BY_CODE)
    assert result.by_numba
    assert abs(result.objective + 1.25) < 1e-12
    assert abs(result.x - [1.0, 0.0, 1.0, 0.0]).max() < 1e-12


@pytest.mark.usefixtures("tableau")
def test_from_a_random_start_phase_one_goes_to_a_point_nearby():
    """The bilinear x y with x + y = 1, x and y >= 0: starts on both sides end at both minima, (1, 0) and (0, 1)."""
    H, A = np.array([[0.0, 1.0], [1.0, 0.0]]), np.ones((1, 2))
    for start, end in (((3.0, 1.0), (1.0, 0.0)), ((1.0, 3.0), (0.0, 1.0))):
        result = minimize_qp(H, np.zeros(2), A, [1.0], [1.0], np.zeros(2), x0=np.array(start), options=BY_CODE)
        assert abs(result.x - end).max() < 1e-12


@pytest.mark.usefixtures("tableau")
def test_an_answer_is_left_as_it_is():
    data = program(3, convex=False, feasible=True)
    first = minimize_qp(*data, options=BY_CODE)
    for working_set in (None, first.working_set):
        again = minimize_qp(*data, x0=first.x, working_set=working_set, options=BY_CODE)
        assert again.iterations == 0
        assert not again.by_numba
        assert abs(again.x - first.x).max() < 1e-14


@pytest.mark.usefixtures("tableau")
def test_the_limit_and_the_log_are_those_of_the_options():
    data, lines = program(1, convex=False, feasible=False), []
    whole = minimize_qp(*data, options=QPOptions(by_numba=True, log=lines.append))
    assert tuple(lines) == whole.log
    assert [line.iteration for line in lines] == list(range(1, whole.iterations + 1))
    assert lines[-1].value == pytest.approx(whole.objective, rel=1e-9)
    assert whole.iterations > 3
    cut = minimize_qp(*data, options=QPOptions(by_numba=True, max_iterations=3))
    assert cut.status is QPStatus.ITERATION_LIMIT
    assert cut.log == whole.log[:3]


@pytest.mark.usefixtures("tableau")
@pytest.mark.parametrize(
    ("H", "c", "data", "status"),
    [
        (np.diag([1.0, -1.0]), [0.0, 0.0], (), QPStatus.UNBOUNDED),
        (np.diag([1.0, 0.0]), [0.0, -1.0], (None, None, None, [0.0, 0.0]), QPStatus.UNBOUNDED),
        (np.array([[0.0, -1.0], [-1.0, 0.0]]), [0.0, 0.0], (None, None, None, [0.0, 0.0]), QPStatus.UNBOUNDED),
        (np.eye(2), [0.0, 0.0], (np.ones((2, 2)), [2.0, -INF], [INF, 1.0]), QPStatus.INFEASIBLE),
    ],
)
def test_programs_without_a_minimizer_are_named(H, c, data, status):
    assert minimize_qp(H, c, *data, options=BY_CODE).status is status


@pytest.mark.usefixtures("tableau")
@pytest.mark.parametrize("seed", range(8))
def test_phase_one_goes_on_while_the_sum_of_violations_falls(seed):
    """One variable: it ends where the sum over all rows is least, at a bound of one. Whole numbers have ties."""
    rng = np.random.default_rng(seed)
    A, low = rng.integers(1, 4, (40, 1)) * rng.choice([-1.0, 1.0], (40, 1)), rng.integers(-30, 31, 40).astype(float)
    high = low + rng.integers(1, 9, 40)

    def violation(x):
        return np.maximum(np.maximum(low - A[:, 0] * x, A[:, 0] * x - high), 0.0).sum()

    result = minimize_qp([[0.0]], [0.0], A, low, high, x0=[50.0], options=QPOptions(by_numba=True, scale=False))
    assert result.by_numba
    assert result.status is QPStatus.INFEASIBLE
    bounds = np.concatenate([low, high]) / np.tile(A[:, 0], 2)
    assert violation(result.x[0]) == pytest.approx(min(map(violation, bounds)), rel=1e-12)


@pytest.mark.usefixtures("tableau")
def test_a_small_curvature_without_rounding_is_not_zero():
    """1e-10 x falls against 2e-14 x²: the least value is -1.25e-7 at x = 2500, and no iteration goes below it."""
    H, c, options = np.diag([1.0, 4e-14]), [0.0, -1e-10], QPOptions(by_numba=True, scale=False)
    result = minimize_qp(H, c, bl=[-1.0, 0.0], bu=[1.0, 1e5], options=options)
    assert result.x[1] == pytest.approx(2500.0, rel=1e-9)
    assert min(line.value for line in result.log) == pytest.approx(-1.25e-7, rel=1e-9)


def test_a_curvature_that_rounding_of_the_direction_has_is_zero(tableau, monkeypatch):
    """A fall along a line whose direction has an entry of the size of rounding where H is not zero."""
    counts = []

    def watched(p, t, limits, descend=tableau.descend):
        t.T[1, 0] = 1e-17
        descend(p, t, limits)
        counts.append(int(t.counts[1]))

    monkeypatch.setattr(tableau, "descend", watched)
    result = minimize_qp(np.diag([1.0, 0.0]), [0.0, -1.0], bl=[-1.0, 0.0], bu=[1.0, 5.0], options=BY_CODE)
    assert counts == [1]
    assert result.x.tolist() == [0.0, 5.0]


@pytest.mark.usefixtures("tableau")
def test_fixed_variables_are_held_whatever_the_working_set():
    ones = np.ones(5)
    result = minimize_qp(np.zeros((5, 5)), ones, bl=ones, bu=ones, working_set=np.zeros(5, dtype=int), options=BY_CODE)
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert result.iterations == 0


@pytest.mark.usefixtures("tableau")
@pytest.mark.parametrize("given", [{"max_iterations": 10**30}, {"feasibility_tolerance": np.longdouble("1e-9")}])
def test_numbers_of_options_may_be_of_any_kind_and_size(given):
    data = program(1, convex=True, feasible=False)
    usual, result = (minimize_qp(*data, options=QPOptions(by_numba=True, **more)) for more in ({}, given))
    assert result.by_numba
    assert abs(result.x - usual.x).max() < 1e-9


def test_machine_code_is_used_where_numba_is_imported_and_the_program_is_small(monkeypatch):
    n = WORTH_EDGES + 1
    small, large = ((-np.eye(k), np.ones(k), None, None, None, -np.ones(k), np.ones(k)) for k in (3, n))
    calls = []
    code = scaled_data, lambda _, sides: calls.append(sides.size) or sides
    monkeypatch.setattr(minimize, "_by_numba", lambda: code)
    minimize_qp(*small)
    assert calls == []
    monkeypatch.setattr(compilation, "numba_is_imported", lambda: True)
    minimize_qp(*large)
    minimize_qp(*small, options=BY_PHASES)
    assert calls == []
    minimize_qp(*small)
    assert set(calls) == {3}


def test_without_numba_the_phases_take_all_iterations(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    monkeypatch.delitem(sys.modules, NAME, raising=False)
    minimize._by_numba.cache_clear()
    result = minimize_qp(*program(2, convex=True, feasible=True), options=BY_CODE)
    minimize._by_numba.cache_clear()
    assert result.status is QPStatus.LOCAL_MINIMIZER
    assert not result.by_numba


@pytest.mark.slow
def test_numba_is_used_by_default_if_it_is_imported_first():
    code = """
import numpy as np
from bemcontact import minimize_qp
print(minimize_qp(-np.eye(2), [1.0, 2.0], bl=[-1.0, -1.0], bu=[1.0, 1.0]).by_numba)
"""
    for first in ("", "import numba"):
        run = [sys.executable, "-c", first + code]
        out = subprocess.run(run, capture_output=True, text=True, check=True, timeout=200)
        assert out.stdout.strip() == str(bool(first))
