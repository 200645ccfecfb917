"""The natural factors solve their least-squares problem, and take out units of rows, variables and objective."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bemcontact.errors import ProblemError
from bemcontact.formulations.local_solver.equilibration import OF_BOUNDS, OF_OBJECTIVE, _entries, equilibrate
from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.result import QPOptions
from bemcontact.formulations.local_solver.statement import Statement


def statement(seed, *, density=1.0):
    """A program with entries of many sizes; all of them are present for a density of one."""
    rng = np.random.default_rng(seed)
    n, m = rng.integers(1, 7), rng.integers(0, 9)

    def entries(*shape):
        return rng.uniform(1.0, 9.0, shape) * 10.0 ** rng.integers(-3, 4, shape) * (rng.random(shape) < density)

    H, upper = entries(n, n), entries(n + m)
    upper[upper == 0.0] = np.inf
    return Statement(H=np.triu(H) + np.triu(H, 1).T, c=entries(n), A=entries(m, n), lower=np.zeros(n + m), upper=upper)


def least_squares(stated):
    """Logarithms of the factors of variables and rows, from one equation for each entry of A, H, c and the bounds."""
    m, n = stated.A.shape
    unit, rows, right = np.eye(n + m + 1), [], []

    def add(row, entry, weight):
        rows.append(np.sqrt(weight) * row)
        right.append(-np.sqrt(weight) * np.log2(entry))

    for (i, j), entry in np.ndenumerate(stated.A):
        if entry:
            add(unit[n + i] + unit[j], entry, 1.0)
    for (i, j), entry in np.ndenumerate(stated.H):
        if entry:
            add(unit[i] + unit[j] + unit[-1], entry, 0.5 * OF_OBJECTIVE)
    for j, entry in enumerate(stated.c):
        add(unit[j] + unit[-1], entry, OF_OBJECTIVE)
    for i, entry in enumerate(stated.upper):
        add(unit[i] if i >= n else -unit[i], entry, OF_BOUNDS)
    return np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0][:-1]


SAME_FUNCTIONS = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


def natural_factors(scaling, stated):
    return scaling.natural_factors(stated.H, stated.c, stated.A, np.array([stated.lower, stated.upper]))


@settings(SAME_FUNCTIONS, max_examples=60)
@given(st.integers(0, 10**9))
def test_natural_factors_are_the_least_squares_solution(scaling, seed):
    stated = statement(seed)
    factors = natural_factors(scaling, stated)
    assert np.abs(np.log2(factors) - least_squares(stated)).max() <= 0.01  # the factors have a small weight


@settings(SAME_FUNCTIONS, max_examples=100)
@given(st.integers(0, 10**9))
def test_natural_factors_change_with_the_units(scaling, seed):
    """So scaled data do not depend on units. No entry is as small as noise.

    Both are within 0.01 of least squares, which change so exactly; see the test above.
    """
    stated, rng = statement(seed), np.random.default_rng(seed)
    m, n = stated.A.shape
    columns, rows, unit = (10.0 ** rng.integers(-2, 3, size) for size in (n, m, 1))
    changed = Statement(
        H=unit * columns[:, None] * stated.H * columns,
        c=unit * columns * stated.c,
        A=rows[:, None] * stated.A * columns,
        lower=np.zeros(n + m),
        upper=np.concatenate([1.0 / columns, rows]) * stated.upper,
    )
    plain = natural_factors(scaling, stated)
    other = natural_factors(scaling, changed)
    expected = plain / np.concatenate([columns, rows])
    assert np.abs(np.log2(other / expected)).max() <= 2 * 0.01


@settings(SAME_FUNCTIONS, max_examples=100)
@given(st.integers(0, 10**9))
def test_entries_that_are_rounding_do_not_count(scaling, seed):
    """Those of H in pairs, and whatever the unit of the objective; the factors are those without these entries."""
    stated, rng = statement(seed), np.random.default_rng(seed)
    m, n = stated.A.shape
    columns, rows = (10.0 ** rng.integers(-8, 9, size) for size in (n, m))
    wide = replace(stated, H=columns[:, None] * stated.H * columns, A=rows[:, None] * stated.A * columns)
    unit = 10.0 ** rng.integers(-12, 13)
    counted = _entries(wide.H, wide.c, wide.A)[0]
    np.testing.assert_array_equal(counted, _entries(unit * wide.H, unit * wide.c, wide.A)[0])
    np.testing.assert_array_equal(counted[:n], counted[:n].T)
    without = replace(wide, H=counted[:n] * wide.H, A=counted[n + 1 :] * wide.A)
    factors = natural_factors(scaling, wide)
    far = np.abs(np.log2(factors) - least_squares(without)).max()
    assert far <= 0.01 * np.abs(np.log2([*columns, *rows, 2.0])).max()  # the factors have a small weight


@settings(SAME_FUNCTIONS, max_examples=100)
@given(st.integers(0, 10**9), st.sampled_from([0.3, 0.7]))
def test_columns_and_rows_of_the_scaled_matrix_have_size_one(scaling, seed, density):
    """Rows to the nearest power of two; no entry is larger than its row; zeros stay zeros."""
    stated = statement(seed, density=density)
    A = equilibrate(stated, scaling.scaled_data)[0].A
    lengths = np.linalg.norm(A, axis=1)
    assert ((A != 0.0) == (stated.A != 0.0)).all()
    filled = lengths > 0.0
    assert np.all(np.abs(np.log2(lengths[filled])) <= 0.5 + 1e-9)


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("density", [0.2, 1.0])
def test_machine_code_scales_as_numpy_does(machine_code, seed, density):
    """To the last digit: all factors are powers of two, and none is so near to between two that rounding decides."""
    stated, rng = statement(seed, density=density), np.random.default_rng(seed)
    m, n = stated.A.shape
    columns, rows = (10.0 ** rng.integers(-12, 13, size) for size in (n, m))  # some entries are rounding beside others
    wide = replace(
        stated, H=columns[:, None] * stated.H * columns, A=rows[:, None] * stated.A * columns, upper=1e-3 * stated.upper
    )
    ours, theirs = equilibrate(wide), equilibrate(wide, machine_code["compiled_scaling"].scaled_data_by_loops)
    for one, other in zip(ours, theirs, strict=True):
        for name in vars(one).keys() & one.__dataclass_fields__.keys():
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("entry", [1e308, 1e-308])
def test_what_no_number_represents_is_refused(scaling, entry):
    """A product of two units of variables is beyond double precision, however these are chosen."""
    H, A = np.diag([entry, 1 / entry, 1.0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1e300, 1.0, 1e-300]])
    wide = Statement(H=H, c=np.array([1e300, 1e-300, 1e300]), A=A, lower=np.full(6, -1e19), upper=np.full(6, 5e-324))
    with pytest.raises(ProblemError, match="too far apart"):
        equilibrate(wide, scaling.scaled_data)


@pytest.mark.parametrize("name", ["H", "c", "A"])
def test_entries_whose_squares_are_infinite_are_refused_without_scaling(name):
    """1e290 ended in an OverflowError of Python. With scaling the same program is solved: x = 1 by its bounds."""
    data = {"H": np.eye(1), "c": -np.ones(1), "A": np.ones((1, 1))}
    data[name] = data[name] * 1e290
    with pytest.raises(ProblemError, match=rf"^{name} has an entry of size 1e\+290, .* leave out scale=False"):
        minimize_qp(*data.values(), None, [1e290 if name == "A" else 1.0], options=QPOptions(scale=False))
    assert minimize_qp(*data.values(), bl=[1.0], bu=[1.0]).x == 1.0
