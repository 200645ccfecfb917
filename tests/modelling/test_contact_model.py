"""The model in cvxpy: its optimum is the contact state, its parameters are the data, what is added is judged."""

import copy
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import cvxpy as cp
import numpy as np
import pytest
from contact_problems import random_contact, resting
from hypothesis import example, given, settings
from hypothesis import strategies as st
from modelling.tool_contact import tool_contact
from scipy.sparse import csr_array

import bemcontact
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.errors import NotConvexError, ProblemError, SolverError
from bemcontact.formulations import clarabel, complementarity
from bemcontact.formulations.clarabel import minimize_convex

GALLERY = Path(__file__).parents[2] / "models" / "gallery"
CONTACTS = {f"{n} points, {k} motions": random_contact(n + k, n, k) for n, k in ((9, 0), (14, 1), (14, 3))}
CONTACTS |= {"tools": tool_contact(), "resting": resting()}


def same_pressure(computed, contact: CondensedContact, within: float = 1e-10) -> None:
    """Against the direct solver; the compliance is positive definite on the equilibrium space, so there is one."""
    direct = complementarity.solve(contact)
    assert direct.status is Status.SOLVED
    np.testing.assert_allclose(computed, direct.pressure, atol=within * direct.pressure.max())


@pytest.mark.parametrize("contact", CONTACTS.values(), ids=CONTACTS)
def test_optimum_is_the_contact_state(contact):
    """F3 is zero there, and nowhere below among what the constraints admit."""
    model = bemcontact.model(contact)
    assert isinstance(model, bemcontact.ContactModel)
    result = model.solve()
    assert result.contact_state
    assert result.certificate.certified
    same_pressure(result.pressure, contact)
    U, T = contact.scales
    assert abs(result.objective) <= 1e-12 * U * T * contact.weights.max()
    assert model._pure.value == pytest.approx(0, abs=1e-9 * U * T * contact.weights.max())
    np.testing.assert_allclose(result.gap, contact.gap(result.pressure, result.motions), atol=1e-12 * U)


@pytest.mark.parametrize("contact", CONTACTS.values(), ids=CONTACTS)
def test_expressions_are_those_of_the_condensed_problem(contact):
    """gap, displacement and F3 = pᵀJ gap at any p in equilibrium, whatever the gauge of M."""
    rng = np.random.default_rng(0)
    model = bemcontact.model(contact)
    ell, U, T = contact.equilibrium, *contact.scales
    p = rng.standard_normal(contact.size) * T
    p -= contact.rigid_motions @ np.linalg.solve(ell.T @ contact.rigid_motions, ell.T @ p + contact.motion_load)
    a = rng.standard_normal(contact.free_motions) * U
    model.pressure.variables()[0].value = p / model.scales.pressure
    if model.motions is not None:
        scale = np.ones(len(a))
        model.motions.variables()[0].value = scale
        model.motions.variables()[0].value = a / model.motions.value
        np.testing.assert_allclose(model.motions.value, a, rtol=1e-13)
        assert model.constraints["equilibrium"].violation().max() <= 1e-13 * np.abs(p).max() / T * contact.size
    gap = contact.gap(p, a)
    np.testing.assert_allclose(model.pressure.value, p, rtol=1e-14)
    np.testing.assert_allclose(model.gap.value, gap, atol=1e-12 * np.abs(gap).max())
    np.testing.assert_allclose(model.displacement.value, gap - contact.initial_gap, atol=1e-12 * np.abs(gap).max())
    work = contact.weights * p * gap
    assert model.objective.value == pytest.approx(work.sum(), abs=1e-12 * np.abs(work).sum())
    forces = (contact.weights * p)[:, None] * contact.normals
    np.testing.assert_allclose(model.resultant().value, forces.sum(axis=0), atol=1e-12 * np.abs(forces).sum())
    if model.tool_displacement is not None:
        np.testing.assert_allclose(model.tool_displacement.value, contact.tools.displacement(a), atol=1e-13 * U)


@pytest.mark.parametrize("path", sorted(GALLERY.glob("*.yaml")), ids=lambda path: path.stem)
def test_bodies_of_the_gallery(path):
    """Certified, and the pressure of the direct solver, on bodies with up to three free motions and three zones."""
    contact = bemcontact.condense(bemcontact.load(path, variant="stated mesh"))
    result = bemcontact.model(contact).solve()
    assert result.certificate.certified
    same_pressure(result.pressure, contact)


def test_resultant_of_a_zone():
    contact = replace(random_contact(0, 6, 0), zone=np.array([0, 0, 1, 1, 1, 1]), zone_names=("left", "right"))
    model = bemcontact.model(contact)
    p = model.solve().pressure
    parts = model.resultant("left").value, model.resultant("right").value
    np.testing.assert_allclose(parts[0][1], contact.weights[:2] @ p[:2], rtol=1e-6)  # the values are Clarabel's own
    np.testing.assert_allclose(sum(parts), model.resultant().value, rtol=1e-13)
    with pytest.raises(ProblemError, match="no contact zone 'top'; there are: left, right"):
        model.resultant("top")


def test_parameters_are_the_data_of_the_problem():
    """Each against `with_factors` and `with_tools` of the waist; the values that are in effect come first."""
    contact = tool_contact()
    model = bemcontact.model(contact)
    assert model.case_factors.value == pytest.approx([1, 0])
    np.testing.assert_allclose(model.contact.offset, contact.offset, atol=1e-15)
    np.testing.assert_allclose(model.contact.motion_load, contact.motion_load, atol=1e-15)
    model.solve()
    model.case_factors.value = np.array([0.5, 2.0])
    loaded = contact.with_factors({"dead": 0.5, "live": 2.0})
    same_pressure(model.solve().pressure, loaded)
    moves, forces = np.array([[0, 0.1, -0.02], [0, 0, 0]]), np.array([[0, 0, 0], [0, 0.3, 0.01]])
    position, force = loaded.tools.position.reshape(2, 3) + moves, loaded.tools.force.reshape(2, 3) + forces
    unused = 7.0 * np.array([[0, 0, 0], [0, 1, 1]])
    model.tool_position.value = model.tool_position.value + moves + unused
    model.tool_force.value = model.tool_force.value + forces + unused[::-1]
    moved = loaded.with_tools(position, force)
    computed = model.solve()
    same_pressure(computed.pressure, moved)
    np.testing.assert_allclose(computed.tool_displacement[0], position[0], atol=1e-14)
    step = 0.1 * np.random.default_rng(1).standard_normal(contact.size)
    model.initial_gap.value = model.initial_gap.value + step
    relieved = replace(moved, initial_gap=moved.initial_gap + step)
    same_pressure(model.solve().pressure, relieved)
    same_pressure(model.solve(problem=model.problem()).pressure, relieved)


@pytest.mark.parametrize("added", [False, True])
def test_new_values_of_parameters_are_not_compiled(added):
    """The compiler of cvxpy hands out the very same parametrised program again: DPP by its own word."""
    model = bemcontact.model(tool_contact())
    problem = model.problem(extra_constraints=[model.pressure <= 9] if added else ())
    assert problem.is_dpp()
    first = model.solve(problem=problem)
    before = problem.get_problem_data(cp.CLARABEL, solver_opts={})[0]["param_prob"]
    model.case_factors.value = np.array([0.7, 1.0])
    model.tool_force.value = 1.5 * model.tool_force.value
    second = model.solve(problem=problem)
    assert problem.get_problem_data(cp.CLARABEL, solver_opts={})[0]["param_prob"] is before
    assert np.abs(second.pressure - first.pressure).max() > 0.01
    same_pressure(second.pressure, model.contact, 1e-6 if added else 1e-10)  # added: not polished


@pytest.mark.parametrize(("length", "stress"), [(1e6, 1.0), (1e-9, 1.0), (1.0, 1e6), (1.0, 1e-9), (1e-9, 1e6)])
def test_units_do_not_matter(length, stress):
    """Nothing added: to round-off. With additions in the user's units: to the tolerance of the solver."""
    one, other = tool_contact(), tool_contact(units=(length, stress))
    first, second = bemcontact.model(one).solve(), bemcontact.model(other).solve()
    np.testing.assert_allclose(second.pressure / stress, first.pressure, atol=1e-12 * first.pressure.max())
    limit = 0.8 * first.pressure.max()
    computed = []
    for contact, L, S in ((one, 1.0, 1.0), (other, length, stress)):
        model = bemcontact.model(contact)
        lift = cp.Variable(nonneg=True)
        cut = model.solve(0.1 * S * L * cp.sum(model.gap) + lift * S * L, [model.pressure <= limit * S + lift * S / L])
        assert cut.status is Status.SOLVED
        computed.append((cut.pressure / S, cut.objective / (S * L**2), lift.value / L))
    for one, other in zip(*computed, strict=True):
        np.testing.assert_allclose(other, one, atol=1e-6 * limit)


def test_an_addition_that_breaks_contact_is_reported():
    """A bound on the pressure below the peak: all constraints hold, complementarity fails, the sentence says so."""
    model = bemcontact.model(random_contact(4, 12, 1))
    free = model.solve()
    p_max = 0.7 * free.pressure.max()
    computed = model.solve(extra_constraints=[model.pressure <= p_max])
    assert computed.status is Status.SOLVED
    assert computed.pressure.max() <= p_max * (1 + 1e-9)
    assert not computed.contact_state
    assert "optimum of your model, not a contact state" in computed.words
    assert computed.residuals.complementarity > 1e-2
    assert f"{computed.residuals.complementarity:.1e}" in computed.words
    idle = model.solve(extra_constraints=[model.pressure <= 2 * free.pressure.max()])
    assert idle.contact_state
    assert "This is a contact state in spite of" in idle.words
    np.testing.assert_allclose(idle.pressure, free.pressure, atol=1e-5 * p_max)


@pytest.mark.slow
@settings(max_examples=20)
@given(seed=st.integers(0, 10**6), motions=st.sampled_from([1, 3]), power=st.integers(6, 12))
@example(seed=5, motions=3, power=6)
@example(seed=9, motions=3, power=6)
@example(seed=51, motions=3, power=8)
@example(seed=9, motions=3, power=9)
def test_a_load_that_is_small_beside_the_gaps_is_carried(seed, motions, power):
    """A millionth of the pressure that would close the gaps, and less: not infeasible, as a solver may call it."""
    contact = random_contact(seed, 6, motions)
    light = replace(contact, motion_load=10.0**-power * contact.motion_load)
    direct, answer = bemcontact.solve(light), bemcontact.model(light).solve()
    if direct.certified:
        assert answer.status is Status.SOLVED
        assert answer.contact_state
        largest = direct.solution.pressure.max()
        assert answer.pressure == pytest.approx(direct.solution.pressure, abs=1e-6 * largest)


def pressed(seed: int, n: int, load: float) -> CondensedContact:
    """A body that can only be lifted, pressed down; gaps of size one, some of them zero, and n points of weight one."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n))
    gaps = np.append(0.0, rng.integers(0, 3, n - 1) * rng.uniform(0.5, 2.0, n - 1))
    return CondensedContact.from_compliance(
        A @ A.T / n + 0.1 * np.eye(n), gaps, rigid_motions=np.ones(n), motion_load=-load
    )


LIGHT = st.integers(0, 9).map(lambda power: 10.0**-power)
"""Loads down to a billionth of the one that closes gaps."""


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 12), load=LIGHT, share=st.sampled_from([0.3, 0.99, 1.01, 1.5]))
def test_a_limit_is_infeasible_exactly_if_the_load_cannot_be_carried_under_it(seed, n, load, share):
    """A lift opens all gaps, so that only Σp = load and p <= limit remain: feasible if n limits exceed the load."""
    contact = pressed(seed, n, load)
    model = bemcontact.model(contact)
    result = model.solve(extra_constraints=[model.pressure <= share * load / n])
    assert result.status is (Status.SOLVED if share > 1 else Status.INFEASIBLE)
    assert ("cannot be satisfied" in result.words) == (share < 1)


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(4, 14), motions=st.sampled_from([0, 1, 3]), load=LIGHT)
@example(seed=3075, n=8, motions=3, load=1.6e-7)
def test_additions_that_contradict_each_other_are_infeasible(seed, n, motions, load):
    """Two bounds, a sum of pressures below zero, and two cones: none of them needs the rest of the model."""
    contact = random_contact(seed, n, motions)
    model = bemcontact.model(replace(contact, motion_load=load * contact.motion_load))
    p, y = model.pressure / model.scales.pressure, cp.Variable(n)
    for added in (
        [p[0] >= 2, p[0] <= 1.9],
        [cp.sum(p) <= -0.01],
        [cp.norm(p - y) <= 1, y >= 3 + p],
    ):
        assert model.solve(extra_constraints=added).status is Status.INFEASIBLE


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), motions=st.sampled_from([0, 1, 3]), load=LIGHT, cost=st.floats(-3, 3))
@example(seed=29, motions=3, load=10.0**-4.6, cost=0.1)
@example(seed=89, motions=3, load=10.0**-6.9, cost=1.4)
def test_what_decreases_the_objective_without_end_is_unbounded(seed, motions, load, cost):
    """A variable with a cost: free, of one sign, beside another one, under a gap; with a bound there is an optimum."""
    contact = random_contact(seed, 6, motions)
    if not bemcontact.solve(contact := replace(contact, motion_load=load * contact.motion_load)).certified:
        return
    model = bemcontact.model(contact)
    U, T = model.scales
    unit, x, y = 10.0**cost * U * T * contact.weights.max(), cp.Variable(), cp.Variable()
    for goal, added in (
        (x, []),
        (-x, [x >= 0]),
        (x - 2 * y, [y <= x + 1, y >= x - 1, x >= 0]),
        (x, [x <= model.gap[0] / U]),
    ):
        assert model.solve(unit * goal, added).status is Status.UNBOUNDED
    assert model.solve(unit * x, [x >= -1]).status is Status.SOLVED
    assert x.value == pytest.approx(-1, rel=1e-6)


@pytest.mark.parametrize("load", 10.0 ** np.arange(-2, -10, -1))
@pytest.mark.parametrize("share", [0.7, 0.4, 0.3])
def test_a_limit_shifts_a_light_load_to_the_next_gaps(load, share):
    """F3 then is Σ q p but for a part as small as the load, so that points are filled in the order of their gaps q.

    A note on the load is not needed where the tolerance of the solver was reached.
    """
    contact = replace(pressed(0, 5, load), initial_gap=np.array([0.0, 1.0, 2.0, 3.0, 4.0]))
    model = bemcontact.model(contact)
    result = model.solve(extra_constraints=[model.pressure <= share * load])
    filled = np.minimum(share, np.maximum(1 - share * np.arange(5), 0.0))
    assert result.status is Status.SOLVED
    assert result.pressure / load == pytest.approx(filled, abs=1e-6)
    assert result.objective == pytest.approx(load * filled @ contact.initial_gap, rel=20 * load + 1e-6)
    assert "The load is light" not in result.words


def test_a_light_load_that_leaves_no_digits_says_what_to_do(monkeypatch):
    """Where the tolerance is not reached, the sentence says where the digits are."""
    contact = random_contact(9, 6, 3)
    model = bemcontact.model(replace(contact, motion_load=1e-8 * contact.motion_load))
    monkeypatch.setattr(clarabel, "ATTEMPTS", (clarabel.ClarabelSettings("", {"max_iter": 1}),))
    with pytest.raises(SolverError, match=r"The load is light: .* Draw the body where it touches"):
        model.solve(extra_constraints=[model.pressure <= 1e-3])


def test_a_model_without_an_optimum_is_a_status_in_words():
    model = bemcontact.model(random_contact(4, 12, 1))
    too_much = model.solve(extra_constraints=[model.pressure <= -1])
    assert too_much.status is Status.INFEASIBLE
    assert too_much.pressure is None
    assert "what was added to the model cannot be satisfied" in too_much.words
    without_end = model.solve(-1e3 * cp.Variable())
    assert without_end.status is Status.UNBOUNDED
    assert "no lower bound" in without_end.words
    upwards = CondensedContact.from_compliance(np.eye(3), np.zeros(3), rigid_motions=np.ones(3), motion_load=1.0)
    assert "nothing holds: the motion 1" in bemcontact.model(upwards).solve().words


def test_invalid_models_are_refused():
    model = bemcontact.model(random_contact(4, 12, 1))
    with pytest.raises(ProblemError, match=r"not convex by cvxpy's rules \(DCP\) in the objective"):
        model.problem(cp.sqrt(model.pressure[0]))
    with pytest.raises(ProblemError, match=r"not convex .* in constraint"):
        model.problem(extra_constraints=[cp.norm(model.pressure) >= 1])
    with pytest.raises(ProblemError, match=r"each change of them is a new problem \(not DPP\)"):
        model.problem(cp.exp(model.initial_gap[0]) * cp.Parameter(nonneg=True) * model.pressure[0])
    with pytest.raises(ProblemError, match="not both"):
        model.solve(cp.sum(model.pressure), problem=model.problem())
    with pytest.raises(ProblemError, match="extra_constraints is a list of constraints"):
        model.solve(extra_constraints=model.pressure <= 1)  # pyright: ignore[reportArgumentType]
    with pytest.raises(ProblemError, match=r"extra_objective is an expression.* found Minimize"):
        model.solve(cp.Minimize(cp.sum(model.pressure)))  # pyright: ignore[reportArgumentType]
    with pytest.raises(ProblemError, match="has not been solved"):
        model.result(model.problem())
    with pytest.raises(bemcontact.SolverError, match="Clarabel cannot solve this model"):
        model.solve(cp.Variable(boolean=True))
    stranger = cp.Problem(cp.Minimize(0))
    stranger.solve()
    with pytest.raises(ProblemError, match="does not contain the pressure"):
        model.result(stranger)
    with pytest.raises(NotConvexError):
        bemcontact.model(CondensedContact.from_compliance([[1.0, 3.0], [0.0, 1.0]], [-1.0, -1.0], [4.0, 1.0]))


def test_a_result_is_taken_out_before_the_next_solve():
    model = bemcontact.model(random_contact(4, 12, 1))
    one, other = model.problem(), model.problem(extra_constraints=[model.pressure <= 1.0])
    one.solve(solver=cp.CLARABEL)
    kept = model.result(one)
    other.solve(solver=cp.CLARABEL)
    with pytest.raises(ProblemError, match="another problem of this model was solved since"):
        model.result(one)
    assert kept.solution.polished
    assert not kept.pressure.flags.writeable


def reread(model):
    return pickle.loads(pickle.dumps(model))


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, reread])
@pytest.mark.parametrize("solved", [False, True])
@pytest.mark.parametrize("contact", CONTACTS.values(), ids=CONTACTS)
def test_a_copy_is_a_model_of_its_own_with_the_same_values(copied, solved, contact):
    """It has the values and multipliers of the original, is solved and extended as one, and changes nothing in it."""
    model = bemcontact.model(contact)
    gap = contact.at_rest().initial_gap + 0.01 * contact.scales.displacement
    model.initial_gap.value = gap
    if solved:
        model.solve()
    other = copied(model)
    np.testing.assert_array_equal(other.initial_gap.value, gap)
    assert (other.pressure.value is not None) == solved
    if solved:
        np.testing.assert_array_equal(other.pressure.value, model.pressure.value)
        assert all(np.array_equal(other.duals[name], dual) for name, dual in model.duals.items())
    other.initial_gap.value = contact.at_rest().initial_gap
    np.testing.assert_array_equal(model.initial_gap.value, gap)
    same_pressure(other.solve().pressure, contact)
    assert {v.id for v in other.objective.variables()}.isdisjoint(v.id for v in model.objective.variables())
    limited = other.solve(cp.sum(other.pressure) * 1e-9, [other.pressure <= 10 * other.pressure.value.max()])
    assert limited.status is Status.SOLVED


@pytest.mark.slow
def test_variables_of_another_process_are_not_those_of_a_model_that_was_read():
    """Each process counts the variables of cvxpy from one on."""
    written = pickle.dumps(bemcontact.model(random_contact(4, 6, 1)))
    code = (
        "import sys, pickle, cvxpy; model = pickle.loads(sys.stdin.buffer.read());"
        "own = {item.id for item in (*model.objective.variables(), *model.objective.parameters())};"
        "sys.exit(any(cvxpy.Variable().id in own for _ in range(500)))"
    )
    assert subprocess.run([sys.executable, "-c", code], input=written, check=False).returncode == 0


def test_a_problem_of_a_model_is_not_copied():
    """Of copied expressions cvxpy has compiled others, which ends the process where it is solved."""
    model = bemcontact.model(random_contact(4, 6, 1))
    problem = model.problem()
    for solved in (False, True):
        with pytest.raises(ProblemError, match=r"a problem of a model cannot be copied, .* copy the model"):
            copy.deepcopy({"model": model, "problem": problem})
        if not solved:
            problem.solve()


def test_a_design_variable_composes_with_the_gap():
    """A shift of a clamped body's support that makes the peak smallest for a given force: contact on all points.

    gap + h >= 0 with contact closed, gap + h = 0, where p may be positive: its optimum is a contact state at the
    shifted gap, which the model finds again through its parameter.
    """
    contact = random_contact(11, 8, 0)
    model = bemcontact.model(contact)
    h, peak = cp.Variable(contact.size), cp.Variable()
    force = 5.0
    problem = cp.Problem(
        cp.Minimize(peak),
        [model.pressure <= peak, model.gap + h == 0, model.resultant()[1] == force, model.constraints["no_tension"]],
    )
    designed = model.solve(problem=problem)
    assert "not a contact state" in designed.words  # at the gap that is not shifted
    np.testing.assert_allclose(designed.pressure, force / contact.weights.sum(), rtol=1e-7)
    model.initial_gap.value = model.initial_gap.value + h.value
    computed = model.solve()
    assert computed.contact_state
    np.testing.assert_allclose(computed.pressure, designed.pressure, rtol=1e-6)


def test_solving_again_starts_from_the_last_solution():
    """The same problem again, and a neighbor: the active-set step gets there without Clarabel, and says so."""
    contact = random_contact(3, 40, 1)
    model = bemcontact.model(contact)
    assert model.solve().solution.solver == "Clarabel"
    same = model.solve()
    assert same.solution.solver == "primal-dual active set"
    same_pressure(same.pressure, contact)
    model.initial_gap.value = contact.initial_gap + 0.01 * np.random.default_rng(0).standard_normal(40)
    computed = model.solve()
    assert computed.solution.solver == "primal-dual active set"
    same_pressure(computed.pressure, model.contact)
    np.testing.assert_allclose(model.pressure.value, computed.pressure, rtol=1e-13)
    np.testing.assert_allclose(model.motions.value, computed.motions, rtol=1e-13)


def test_a_slightly_indefinite_objective_is_reported_and_polished():
    """sym(M) = [[1, 1.01], [1.01, 1]] has eigenvalues 2.01 and -0.01: half a hundredth, left out of F3."""
    contact = CondensedContact.from_compliance([[1.0, 2.02], [0.0, 1.0]], [-1.0, -1.0])
    model = bemcontact.model(contact)
    assert "not convex on this mesh" in model.notes[0]
    computed = model.solve()
    assert computed.contact_state
    same_pressure(computed.pressure, contact)


@pytest.mark.parametrize("contact", CONTACTS.values(), ids=CONTACTS)
def test_a_problem_solved_the_way_of_cvxpy_is_the_contact_state(contact):
    """`problem.solve()` without a solver named; the polish does the rest, which the certificate proves."""
    model = bemcontact.model(contact)
    problem = model.problem()
    problem.solve()
    assert problem.solver_stats.solver_name == "CLARABEL"
    computed = model.result(problem)
    assert computed.contact_state
    assert computed.certificate.certified
    same_pressure(computed.pressure, contact)


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12])
def test_a_problem_solved_the_way_of_cvxpy_does_not_depend_on_the_unit_of_length(unit: float):
    """Displacements and gaps in another unit; a bound that is far away leaves the contact state."""
    one = random_contact(4, 12, 1)
    lengths = {name: getattr(one, name) * unit for name in ("compliance", "free_displacement", "initial_gap")}
    model = bemcontact.model(replace(one, **lengths))
    problem = model.problem(extra_constraints=[model.gap <= 100 * model.scales.displacement])
    assert problem.solve() == problem.value
    computed = model.result(problem)
    assert computed.contact_state
    np.testing.assert_allclose(computed.pressure, complementarity.solve(one).pressure, rtol=1e-6, atol=1e-8)


def test_loads_of_two_cases_that_balance_each_other_may_act_together():
    """Each alone would drive block and tools up or down; together they press with 10 on a width of 10, uniformly."""
    edges = {"bottom": [-5, 0], "right": [5, 0], "top": [5, 4], "left": [-5, 4]}
    problem = bemcontact.Problem(
        name="between",
        material={"young_modulus": 1000, "poisson_ratio": 0.3},
        boundary={"outer": [{"name": name, "start": start, "elements": 4} for name, start in edges.items()]},
        conditions={"left": {"displacement": {"x": 0}}},
        contact_zones={
            "up": {"edges": "top", "surface": {"kind": "plane", "point": [0, 4], "normal": [0, -1]}},
            "down": {"edges": "bottom", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        },
        tools={name: {"zones": zone, "force": {"y": 0}} for name, zone in (("a", "up"), ("b", "down"))},
        load_cases={
            "one": {"tools": {"a": {"force": {"y": -10}}}},
            "two": {"tools": {"b": {"force": {"y": 10}}}},
        },
        combinations={"both": {"one": 1, "two": 1}},
        case="both",
    )
    contact = bemcontact.condense(problem)
    model = bemcontact.model(contact)
    np.testing.assert_allclose(model.solve().pressure, 1.0, rtol=1e-10)
    model.case_factors.value = [2, 2]
    np.testing.assert_allclose(model.solve().pressure, 2.0, rtol=1e-10)
    model.case_factors.value = [2, 1]
    with pytest.raises(ProblemError, match="nothing holds the body"):
        model.solve()
    with pytest.raises(ProblemError, match="nothing holds the body"):
        contact.with_factors({"one": 1})


def stationarity(contact: CondensedContact, model, p: np.ndarray, cap: cp.Constraint) -> tuple[float, float]:
    """Largest residual of the gradient of F3 with its multipliers over p and over a, relative to the largest term."""
    w, M, duals = contact.weights, contact.compliance, model.duals
    wanted, lift = w * duals["no_penetration"], w * duals["no_tension"]
    terms = [w * contact.offset, w * (M @ p), M.T @ (w * p), -M.T @ wanted, -lift, cap.dual_value]
    terms += [contact.equilibrium @ duals["equilibrium"]] if contact.free_motions else []
    over_a = contact.motion_load + contact.rigid_motions.T @ wanted
    size = np.abs(contact.rigid_motions.T) @ np.abs(wanted)
    return np.abs(sum(terms)).max() / np.abs(terms).max(), (np.abs(over_a) / size).max(initial=0.0)


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 1000),
    which=st.sampled_from([0, 1, 3, "tools"]),
    length=st.sampled_from([1.0, 1e-6, 1e3]),
    stress=st.sampled_from([1.0, 1e9]),
)
def test_multipliers_are_pressure_gap_and_motions_in_any_unit(seed, which, length, stress):
    """Lagrange's conditions of F3 at a contact state, by hand: w gap >= 0 has the multiplier p, w p >= 0 the gap."""
    contact = tool_contact(seed, 10, (length, stress)) if which == "tools" else random_contact(seed, 8, which)
    model = bemcontact.model(contact)
    with pytest.raises(ProblemError, match="no multipliers yet"):
        _ = model.duals
    result = model.solve()
    for _ in range(2):  # the second solve starts from the first, without Clarabel
        duals, (U, T) = model.duals, model.scales
        size = 1.0 + np.abs(result.pressure).max() / T
        np.testing.assert_allclose(duals["no_penetration"], result.pressure, rtol=0, atol=1e-5 * T * size)
        np.testing.assert_allclose(duals["no_tension"], result.gap, rtol=0, atol=1e-5 * U * size)
        if contact.free_motions:
            R = contact.rigid_motions
            np.testing.assert_allclose(R @ duals["equilibrium"], R @ result.motions, rtol=0, atol=1e-5 * U * size)
        result = model.solve()


@pytest.mark.parametrize("contact", [*(random_contact(4, 12, k) for k in (0, 1, 3)), tool_contact()])
def test_multipliers_with_a_constraint_of_the_user(contact):
    """With the pressure capped, Lagrange's conditions of F3 hold with the four multipliers, computed anew."""
    model = bemcontact.model(contact)
    cap = model.pressure <= 0.9 * float(model.solve().pressure.max())
    result = model.solve(extra_constraints=[cap])
    over_p, over_a = stationarity(contact, model, result.pressure, cap)
    assert over_p < 1e-7
    assert over_a < 1e-7


def test_a_multiplier_is_the_price_of_its_constraint():
    """The least objective by central differences of the zero in w gap >= 0 and in w p >= 0."""
    contact = random_contact(4, 12, 1)
    model = bemcontact.model(contact)
    cap = model.pressure <= 0.9 * float(model.solve().pressure.max())
    model.solve(extra_constraints=[cap])
    (U, T), duals, w = model.scales, model.duals, contact.weights
    for name, value, unit in (("no_penetration", model.gap, U), ("no_tension", model.pressure, T)):
        i = int(np.argmax(duals[name]))
        least, step = [], 1e-4 * unit * w[i]
        for s in (step, -step):
            others = [constraint for key, constraint in model.constraints.items() if key != name]
            shifted = cp.multiply(w, value) >= s * np.eye(contact.size)[i]
            minimize_convex(problem := cp.Problem(cp.Minimize(model.objective), [shifted, *others, cap]))
            least.append(problem.value)
        assert (least[0] - least[1]) / (2 * step) == pytest.approx(duals[name][i], rel=1e-3)


PUNCH = """
name: punch on a block
material: {young_modulus: 210e3, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: bottom, start: [-40, -40], elements: 6}
    - {name: right, start: [40, -40], elements: 5}
    - {name: beside right, start: [40, 0], elements: 8, grading: {ratio: 50, towards: end}}
    - {name: face, start: [5, 0], elements: 80, grading: {ratio: 10, towards: both}}
    - {name: beside left, start: [-5, 0], elements: 8, grading: {ratio: 50, towards: start}}
    - {name: left, start: [-40, 0], elements: 5}
conditions: {bottom: {displacement: {x: 0, y: 0}}}
contact_zones: {face: {edges: face, surface: {kind: plane, point: [0, 0], normal: [0, -1]}}}
tools: {punch: {zones: face, point: [0, 0], force: {y: -2000, moment: 1000}}}
"""


def test_a_capped_pressure_on_a_fine_mesh():
    """Of 161 points that nearly all depend on each other: the optimum by its conditions, computed anew."""
    contact = bemcontact.condense(bemcontact.loads(PUNCH))
    model = bemcontact.model(contact)
    for cap in (300, 600, 1000):
        limit = model.pressure <= cap
        result = model.solve(extra_constraints=[limit])
        assert result.pressure.max() <= cap * (1 + 1e-8)
        over_p, over_a = stationarity(contact, model, result.pressure, limit)
        assert over_p < 1e-6
        assert over_a < 1e-6


@settings(max_examples=30, deadline=None)
@given(
    rows=st.lists(st.lists(st.floats(-1, 1), min_size=3, max_size=3), min_size=2, max_size=2),
    kind=st.sampled_from([list, np.array, tuple, np.asfortranarray, lambda rows: [np.array(row) for row in rows]]),
)
def test_values_of_parameters_are_read_by_rows(rows, kind):
    """As NumPy reads them, whatever they are; cvxpy reads nested lists by columns."""
    model = bemcontact.model(tool_contact(0, 6))
    model.tool_force.value = kind(rows)
    model.tool_position.value = kind(rows)
    np.testing.assert_array_equal(model.tool_force.value, rows)
    np.testing.assert_array_equal(model.tool_position.value, rows)


@pytest.mark.parametrize("name", ["initial_gap", "case_factors", "tool_position", "tool_force"])
@pytest.mark.parametrize(
    "spoiled",
    [
        lambda value: np.ma.masked_array(value, np.arange(value.size).reshape(value.shape) == 1),
        lambda value: [*value, value[0]],
        lambda value: csr_array(np.atleast_2d(value)),
        lambda value: value.astype(str),
        lambda value: value + 1j,
        lambda value: value > 0,
        lambda value: value * np.nan,
        lambda value: [[1.0], [1.0, 2.0]],
        lambda value: 3.0,
    ],
)
def test_values_that_are_no_numbers_of_the_shape_are_refused(name, spoiled):
    """And the value stays as it was."""
    parameter = getattr(bemcontact.model(tool_contact(0, 6)), name)
    before = parameter.value
    with pytest.raises(ProblemError, match=f"the value of {name} "):
        parameter.value = spoiled(before)
    np.testing.assert_array_equal(parameter.value, before)


@pytest.mark.parametrize(("length", "stress"), [(1.0, 1.0), (1e-6, 1e3), (1e6, 1e-6)])
def test_bound_in_the_units_of_pressure_holds_in_any_units(length: float, stress: float):
    """A bound on pressure differences, whose variable in cvxpy has the unit of pressure, under a large objective."""
    n = 21
    x = np.linspace(-1.0, 1.0, n)
    M = np.exp(-3 * abs(x[:, None] - x)) * length / stress
    contact = CondensedContact.from_compliance(M, (0.5 * x**2 - 0.4) * length, np.full(n, length / n))
    peak = complementarity.solve(contact).pressure.max()
    model_of_it = bemcontact.model(contact)
    p, (U, T) = model_of_it.pressure, model_of_it.scales
    pull = 1e5 * U * T * length * cp.sum_squares(p / T - 2 * peak / T)
    bound = cp.max(cp.abs(cp.diff(p))) / peak <= 0.25
    result = model_of_it.solve(extra_objective=pull, extra_constraints=[bound])
    assert result.status is Status.SOLVED
    assert bound.violation() <= 1e-7
    assert result.pressure is not None
    assert result.objective is not None
    work = model_of_it.contact.weights @ (result.pressure * result.gap)
    assert result.objective == pytest.approx(float(work) + float(pull.value), rel=1e-9)
