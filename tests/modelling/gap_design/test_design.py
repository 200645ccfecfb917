"""Design of gaps: the best there is by exhaustive search, closed forms, random profiles, and the whole chain."""

from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import cvxpy as cp
import numpy as np
import pytest
from contact_problems import random_contact, resting
from modelling.tool_contact import tool_contact
from scipy.optimize import linprog

import bemcontact
from bemcontact import GapDesign, Relief, StressOperator, design_gap, spec
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.formulations import clarabel, complementarity
from bemcontact.modelling.gap_design import contact_sets
from bemcontact.modelling.gap_design.contact_sets import SharedProfile
from bemcontact.modelling.gap_design.designed_gap import relieved
from bemcontact.modelling.gap_design.relief import Profiles

GALLERY = Path(__file__).parents[3] / "models" / "gallery"
POWERS = [lambda s, k=k: (1 - s / 5) ** k for k in (2, 4, 8)]
"""Shapes for half a punch, from its edge (s = 0) to its middle (s = 5)."""


@cache
def condensed(name: str) -> CondensedContact:
    return bemcontact.condense(spec.load(GALLERY / f"{name}.yaml", variant="stated mesh"))


def loaded(contact: CondensedContact, factor: float) -> CondensedContact:
    """The same body under all loads times a factor: Δ1 and the load are linear in them."""
    return replace(
        contact,
        free_displacement=factor * contact.free_displacement,
        motion_load=factor * contact.motion_load,
    )


def three_loads() -> tuple[CondensedContact, ...]:
    rng, contact = np.random.default_rng(1), random_contact(7, 12, 1)
    return (
        contact,
        loaded(contact, 1.5),
        replace(contact, initial_gap=contact.initial_gap + 0.3 * rng.standard_normal(12)),
    )


CASES = {
    "roller on a shaped plane": (
        lambda: condensed("hertz_small"),
        Relief(lower=-0.002, upper=0.0, slope=0.02, curvature=0.05),
        {},
    ),
    "punch, blunt edges": (
        lambda: condensed("flat_punch"),
        Relief(lower=0, upper=0.002, slope=1e-3, curvature=1e-3),
        {},
    ),
    "punch, three shapes": (lambda: condensed("flat_punch"), Relief(shapes=POWERS, coefficients=(0.0, 0.02)), {}),
    "beam on a shaped support": (
        lambda: condensed("beam_on_two_supports"),
        Relief(lower=-0.03, upper=0.03, slope=0.1),
        {"zone": "end roller"},
    ),
    "three loads": (three_loads, Relief(lower=-0.2, upper=0.4, slope=0.2), {"arc": (2, 9)}),
}


@cache
def designed(name: str) -> GapDesign:
    contact, relief, where = CASES[name]
    return design_gap(contact(), relief, **where)


def states_of(name: str) -> tuple[CondensedContact, ...]:
    contact = CASES[name][0]()
    return (contact,) if isinstance(contact, CondensedContact) else contact


def peak(states: tuple[CondensedContact, ...], profile: np.ndarray) -> float:
    return max(complementarity.solve(relieved(state, profile)).pressure.max() for state in states)


def peaks(state: CondensedContact, profiles: np.ndarray, touching: np.ndarray) -> np.ndarray:
    """The largest pressure (m,) above each profile (m, n), by Newton's steps p > gap for all profiles at once.

    A state counts if the next step is its own set: p > 0 where the gap is 0, and gap >= 0 where p is 0.
    """
    (U, T), n, k = state.scales, state.size, state.free_motions
    gap = np.hstack([state.compliance * T, state.rigid_motions * U]) / U
    eye = np.eye(n + k)[:n]
    balance = np.hstack([state.equilibrium.T, np.zeros((k, k))]) / state.weights.max()
    load = -state.motion_load / (T * state.weights.max())
    offset, active = (state.offset + profiles) / U, np.tile(touching, (len(profiles), 1))
    result, left = np.full(len(profiles), np.nan), np.arange(len(profiles))
    for _ in range(30):
        A, q = active[left], offset[left]
        rows = np.concatenate([np.where(A[..., None], gap, eye), np.tile(balance, (len(left), 1, 1))], axis=1)
        right = np.concatenate([np.where(A, -q, 0.0), np.tile(load, (len(left), 1))], axis=1)
        x = np.linalg.solve(rows, right[..., None])[..., 0]
        active[left] = np.where(A, x[:, :n] > 0, q + x @ gap.T < 0)
        rests = (active[left] == A).all(axis=1)
        result[left[rests]] = T * x[rests, :n].max(axis=1)
        left = left[~rests & (active[left].sum(axis=1) >= k)]
    assert not np.isnan(result).any()
    return result


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_no_random_profile_has_a_lower_peak(name):
    """A thousand of them: corners of the set of profiles, mixtures of corners, and mixtures with the design itself."""
    design, states, (_, relief, where) = designed(name), states_of(name), CASES[name]
    space, rng = Profiles.of(states[0], relief, **where), np.random.default_rng(99)
    corners = []
    for _ in range(200):
        direction = np.zeros(states[0].size)
        direction[space.points] = rng.standard_normal(len(space.points))
        corners.append(space.shapes @ space.extreme(direction))
    mixed = [rng.dirichlet(np.full(4, 0.7)) @ [corners[i] for i in rng.integers(0, 200, 4)] for _ in range(400)]
    near = [design.profile + 10 ** rng.uniform(-6, 0) * (corners[i % 200] - design.profile) for i in range(400)]
    profiles = np.array([*corners, *mixed, *near])
    sets = [after.pressure > 0 for after in design.after]
    highest = np.max([peaks(*pair) for pair in zip(states, [profiles] * len(states), sets, strict=True)], axis=0)
    for i in rng.integers(0, len(profiles), 10):
        assert peak(states, profiles[i]) == pytest.approx(highest[i], rel=1e-9)
    assert design.peak <= highest.min() * (1 + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_design_is_verified_and_keeps_its_bounds(name):
    """Solved again, certified, pressures as designed to 1e-6; bounds by differences over arc length written here."""
    design, states, relief = designed(name), states_of(name), CASES[name][1]
    assert design.verified
    assert design.difference <= 1e-6
    for state, after in zip(states, design.after, strict=True):
        direct = complementarity.solve(relieved(state, design.profile))
        np.testing.assert_allclose(after.pressure, direct.pressure, atol=1e-9 * design.peak)
    assert design.lower_bound <= design.peak * (1 + 1e-9)
    assert design.peak <= peak(states, np.zeros(states[0].size)) * (1 + 1e-9)
    contact, at = states[0], design.points
    g, s = design.profile[at], contact.arc_position[at]
    same_run = np.diff(contact.run[at]) == 0
    slope = np.diff(g)[same_run] / np.diff(s)[same_run]
    room = 1e-15 * max(abs(g).max(), 1e-12)  # nothing but round-off, in slope that of a difference as well
    if relief.lower is not None:
        assert relief.lower - room <= g.min()
        assert g.max() <= relief.upper + room
    if relief.slope is not None:
        assert abs(slope).max() <= relief.slope + 4 * room / np.diff(s)[same_run].min()
    if relief.curvature is not None:
        shortest = np.diff(s).min()
        assert abs(np.diff(slope) / ((s[2:] - s[:-2]) / 2)).max() <= relief.curvature + 8 * room / shortest**2
    if relief.shapes is not None:
        assert design.coefficients is not None
        np.testing.assert_allclose(
            sum(c * f(s) for c, f in zip(design.coefficients, POWERS, strict=True)), g, atol=4 * room
        )
        assert (design.coefficients >= -1e-9).all()


def exhaustive(contact: CondensedContact, low: float, high: float) -> float:
    """The least peak over all 2ⁿ contact sets, by scipy: gap = 0 and p >= 0 on each, p = 0 and gap >= 0 off it.

    Variables are the peak, g (n,), p (n,) and a (k,).
    """
    n, k = contact.rigid_motions.shape
    eye, none, R, ell = np.eye(n), np.zeros((n, n)), contact.rigid_motions, contact.equilibrium
    gap = np.hstack([np.zeros((n, 1)), eye, contact.compliance, R])
    below_peak = np.hstack([-np.ones((n, 1)), none, eye, np.zeros((n, k))])
    balance = np.hstack([np.zeros((k, 1 + n)), ell.T, np.zeros((k, k))])
    best = np.inf
    for touching in product((False, True), repeat=n):
        A = np.array(touching)
        bounds = [(None, None), *[(low, high)] * n, *((0, None if on else 0) for on in A), *[(None, None)] * k]
        result = linprog(
            np.append(1.0, np.zeros(2 * n + k)),
            A_ub=np.vstack([below_peak, -gap[~A]]),
            b_ub=np.append(np.zeros(n), contact.offset[~A]),
            A_eq=np.vstack([gap[A], balance]),
            b_eq=np.append(-contact.offset[A], -contact.motion_load),
            bounds=bounds,
        )
        best = min(best, result.fun if result.success else np.inf)
    return best


@pytest.mark.parametrize("seed", range(4))
def test_the_design_is_the_best_of_all_contact_sets(seed):
    contact = random_contact(seed, 6, seed % 3)
    design = design_gap(contact, Relief(lower=-0.3, upper=0.5))
    best = exhaustive(contact, -0.3, 0.5)
    assert design.value == pytest.approx(best, rel=1e-6, abs=1e-9)
    assert design.lower_bound <= best * (1 + 1e-6)
    assert not design.proved_optimal or design.lower_bound == pytest.approx(best, rel=1e-5)


def test_a_free_profile_makes_the_pressure_of_a_punch_uniform():
    """1000 N/mm on half a face of 5 mm: 200, which no pressure on that face can be below; the profile is the contour.

    Uniform pressure p on |x| < a of a half-plane lowers its surface against the middle by
    p/(π E*) [(a + x) ln(1 + x/a)² + (a - x) ln(1 - x/a)²] less (Johnson, Contact Mechanics, 2.30a). The block is 40
    half-widths large, 0.1 %; the rest is for the mesh beside the edge of the load.
    """
    design = design_gap(condensed("flat_punch"), Relief(lower=0, upper=0.01))
    assert design.proved_optimal
    assert "No profile within the bounds does better" in design.words
    np.testing.assert_allclose(design.after[0].pressure, 200, rtol=1e-6)
    x = design.before[0].contact.points[:, 0] / 5
    log = [np.log(np.maximum(1 + side * x, 1e-300)) * (1 + side * x) for side in (1, -1)]
    contour = 200 * 5 * (1 - 0.3**2) / (np.pi * 210e3) * 2 * (log[0] + log[1])
    relative = design.profile - design.profile[np.argmin(abs(x))]
    assert abs(relative - contour).max() <= 0.01 * contour.max()


@pytest.mark.slow
def test_uniform_is_another_goal():
    """Free: no deviation at all. Bounded: not above that of the peak's design, whose peak is not above this one's."""
    contact = condensed("flat_punch")
    free = design_gap(contact, Relief(lower=0, upper=0.01), goal="uniform")
    assert free.value <= 1e-5 * 200
    np.testing.assert_allclose(free.after[0].pressure, 200, rtol=1e-5)
    relief = Relief(shapes=POWERS, coefficients=(0.0, 0.02))
    even, low = design_gap(contact, relief, goal="uniform"), designed("punch, three shapes")
    weights = contact.weights / contact.weights.sum()

    def deviation(p):
        return np.sqrt(weights @ (p - weights @ p) ** 2)

    assert even.verified
    assert even.value == pytest.approx(deviation(even.after[0].pressure), rel=1e-12)
    assert even.value <= deviation(low.after[0].pressure) * (1 + 1e-9)
    assert low.peak <= even.peak * (1 + 1e-9)


@pytest.mark.slow
def test_load_cases_are_load_states():
    contact = tool_contact()
    factors = [{"dead": 1.0}, {"dead": 1.0, "live": 0.5}]
    design = design_gap(contact, Relief(lower=0, upper=0.2), cases=factors)
    again = design_gap([contact.with_factors(some) for some in factors], Relief(lower=0, upper=0.2))
    assert design.verified
    assert "the worst of 2 load states" in design.words
    assert design.value == pytest.approx(again.value, rel=1e-9)
    assert design.value < design.value_before


@pytest.mark.slow
def test_all_contact_sets_are_one_program_for_cvxpy(monkeypatch):
    """Few problems, each of which cvxpy compiles once: its data change with parameters. None is solved again."""
    solved, chosen = [], []

    def noted(problem):
        solved.append(problem)
        chosen.append(b"".join(np.asarray(p.value).tobytes() for p in problem.parameters()))
        return clarabel.minimize_convex(problem)

    monkeypatch.setattr(contact_sets, "minimize_convex", noted)
    design_gap(three_loads(), Relief(lower=-0.2, upper=0.4, slope=0.2), arc=(2, 9))
    most = max(solved, key=solved.count)
    sets = [some for problem, some in zip(solved, chosen, strict=True) if problem is most]
    assert len(sets) > 20
    assert len({*sets}) == len(sets)
    assert len({*map(id, solved)}) <= 5
    assert all(problem.is_dcp(dpp=True) for problem in solved)


def test_progress_has_stages_and_the_starts_that_are_done():
    told = []
    design = design_gap(
        symmetric_punch(), Relief(lower=0, upper=0.05), progress=lambda stage, now: told.append((stage, now))
    )
    starts = [now for stage, now in told if stage == "contact sets" and now]
    assert all(now.startswith(f"start {i} of {len(starts)}, ") for i, now in enumerate(starts, start=1))
    assert starts[-1].endswith(f"{design.value:.4g} is reached")
    assert {stage for stage, now in told if not now} >= {"profiles to start from", "lower bound"}


@pytest.mark.slow
def test_a_gentler_profile_that_costs_too_much_is_not_taken(monkeypatch):
    """Bounds near each other and the tolerance of a solver make it dearer; here it is moved by hand."""
    contact, relief = symmetric_punch(), Relief(lower=0, upper=0.05, curvature=0.1)
    plain, gentlest = design_gap(contact, relief), SharedProfile.gentlest

    def dear(shared, piece):
        gentle = gentlest(shared, piece)
        return replace(gentle, coefficients=0.9 * gentle.coefficients)

    monkeypatch.setattr(SharedProfile, "gentlest", dear)
    assert design_gap(contact, relief).value == pytest.approx(plain.value, rel=1e-6)


@pytest.mark.slow
def test_units_do_not_matter():
    result = []
    for L, S in ((1.0, 1.0), (1e-9, 1e6)):
        contact = tool_contact(units=(L, S))
        result.append(design_gap(contact, Relief(lower=0, upper=0.2 * L, slope=0.5)).value / S)
    assert result[1] == pytest.approx(result[0], rel=1e-6)


def test_invalid_design_is_refused():
    contact = random_contact(0, 6, 1)
    relief = Relief(lower=0, upper=1)
    with pytest.raises(ProblemError, match="needs a CondensedContact"):
        design_gap([], relief)
    with pytest.raises(ProblemError, match="no goal 'low'; there are: peak, uniform"):
        design_gap(contact, relief, goal="low")
    with pytest.raises(ProblemError, match="load state 2 differs from the first one in its compliance"):
        design_gap([contact, random_contact(1, 6, 1)], relief)
    with pytest.raises(ProblemError, match="factors of load cases go with one condensed contact"):
        design_gap([contact, contact], relief, cases=[{}])
    with pytest.raises(ProblemError, match=r"no contact state: .* off its support"):
        design_gap(replace(resting(), motion_load=np.ones(1)), relief)
    with pytest.raises(ProblemError, match="no profile keeps the bounds on values and slope"):
        design_gap(contact, Relief(lower=(0, 5, 0, 0, 0, 0), upper=(1, 6, 1, 1, 1, 1), slope=0.1))


@pytest.mark.parametrize(("arc", "outside"), [((1.0, 2.0), True), ((0.0, 2.0), False)])
def test_a_peak_outside_of_the_interval_is_reported(arc, outside):
    """Three springs by themselves, the first compressed by 3 and out of reach of the profile, or not."""
    contact = CondensedContact.from_compliance(np.eye(3), [-3.0, -1.0, -1.0])
    design = design_gap(contact, Relief(lower=0, upper=1.5), arc=arc)
    assert design.peak == pytest.approx(3.0 if outside else 1.5)
    assert ("outside of the interval" in design.words) is outside


def uniform_program(
    contact: CondensedContact, relief: Relief, touching: np.ndarray
) -> tuple[cp.Expression, cp.Expression, list[cp.Constraint]]:
    """Deviation of the pressure from its mean, gaps (n,) and constraints of all designs with one contact set.

    Pressures are in 1000 MPa and gaps in 1e-3 mm, so that all numbers are of order one.
    """
    p, g, a = cp.Variable(contact.size), cp.Variable(contact.size), cp.Variable(contact.rigid_motions.shape[1])
    gap = g + 1e3 * contact.offset + 1e6 * contact.compliance @ p + contact.rigid_motions @ a
    weights = contact.weights / contact.weights.sum()
    constraints = [
        gap[touching] == 0,
        gap[~touching] >= 0,
        p[touching] >= 0,
        p[~touching] == 0,
        contact.equilibrium.T @ p == -contact.motion_load / 1e3,
        g >= 1e3 * relief.lower,
        g <= 1e3 * relief.upper,
        cp.abs(cp.diff(g)) <= 1e3 * relief.slope * np.diff(contact.arc_position),
    ]
    return cp.norm(cp.multiply(np.sqrt(weights), p - weights @ p)), gap, constraints


def least_deviation(contact: CondensedContact, relief: Relief, touching: np.ndarray) -> float:
    """Least deviation in MPa for one contact set, by a convex program."""
    deviation, _, constraints = uniform_program(contact, relief, touching)
    return 1e3 * cp.Problem(cp.Minimize(deviation), constraints).solve(solver=cp.CLARABEL)


def smallest_gap(contact: CondensedContact, relief: Relief, touching: np.ndarray, point: int) -> float:
    """Smallest gap in 1e-3 mm at a point among all designs of least deviation for one contact set."""
    deviation, gap, constraints = uniform_program(contact, relief, touching)
    optimal = deviation <= least_deviation(contact, relief, touching) / 1e3 * (1 + 1e-6)
    return cp.Problem(cp.Minimize(gap[point]), [*constraints, optimal]).solve(solver=cp.CLARABEL)


@pytest.mark.slow
def test_uniform_design_goes_on_from_all_optimal_profiles_of_a_contact_set():
    """Several profiles are optimal for a contact set, and only some of them touch at the next point.

    The search ends if no optimal profile of its contact set touches at the next point. The contact set without the last
    point is such a place where it must go on: with the last point the deviation is smaller.
    """
    contact, relief = condensed("hertz_small"), Relief(lower=0, upper=0.00207155, slope=0.0588938)
    design = design_gap(contact, relief, goal="uniform")
    touching = design.after[0].pressure > 1e-6 * design.peak
    last = np.flatnonzero(touching)[-1]
    before = touching & (np.arange(contact.size) != last)
    assert design.verified
    assert design.value == pytest.approx(least_deviation(contact, relief, touching), rel=1e-4)
    assert smallest_gap(contact, relief, touching, last + 1) > 1e-3
    assert smallest_gap(contact, relief, before, last) < 1e-6
    assert design.value < least_deviation(contact, relief, before)


def symmetric_punch(n: int = 7) -> CondensedContact:
    """A row of points that is its own mirror image, pressed in: each turn of a point has an equal one."""
    x = np.linspace(-1, 1, n)
    compliance = np.exp(-np.abs(x[:, None] - x)) + 0.1 * np.eye(n)
    contact = CondensedContact.from_compliance(
        compliance, np.zeros(n), np.full(n, 1 / n), rigid_motions=np.ones(n), motion_load=[-1.0]
    )
    return replace(contact, points=np.column_stack([x, 0 * x]), arc_position=x + 1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("states", "relief"),
    [
        ((symmetric_punch(),), Relief(lower=0, upper=0.05, curvature=0.1)),
        ((random_contact(7, 6, 1), loaded(random_contact(7, 6, 1), 1.5)), Relief(lower=-0.2, upper=0.2, slope=2.0)),
    ],
    ids=["symmetric", "two loads"],
)
def test_round_off_changes_neither_the_design_nor_its_verdict(states, relief):
    """Compliances that differ in their last digits, as with other numbers of threads: one answer, one verdict."""
    plain = design_gap(states, relief)
    noise = 1 + 1e-15 * np.random.default_rng(0).standard_normal(states[0].compliance.shape)
    other = design_gap([replace(state, compliance=state.compliance * noise) for state in states], relief)
    assert other.value == pytest.approx(plain.value, rel=1e-7)
    assert (other.verified, other.proved_optimal) == (plain.verified, plain.proved_optimal)
    assert other.difference < 1e-8


@cache
def under_the_punch() -> StressOperator:
    problem = spec.load(GALLERY / "flat_punch.yaml", variant="stated mesh")
    return bemcontact.stress_operator(problem, [[4.6, -0.5], [4.0, -1.0], [2.0, -2.0]])


CROWN = Relief(lower=0, upper=0.01, slope=0.004, curvature=0.004)


@pytest.mark.slow
def test_a_limit_of_stress_is_kept_by_a_solve_on_the_designed_surface():
    """To a relative 0.004, the largest slope, by which normals of the surface lean; the plain design is above it."""
    operator, limit = under_the_punch(), 95.0
    plain = design_gap(operator.contact, CROWN)
    design = design_gap(operator.contact, CROWN, stress=operator, von_mises=limit)
    assert operator.at(plain.after[0].pressure).von_mises.max() > 1.1 * limit
    assert design.verified
    assert design.peak >= plain.lower_bound
    assert operator.at(design.after[0].pressure).von_mises.max() <= limit * (1 + 1e-6)
    assert design.von_mises is not None
    assert design.von_mises <= limit * (1 + 1e-6)
    assert not replace(design, von_mises_limit=0.9 * limit).verified
    problem = spec.load(GALLERY / "flat_punch.yaml", variant="stated mesh")
    zone = problem.contact_zones["punch"].model_copy(update={"surface": design.surface()})
    relieved_problem = problem.model_copy(update={"contact_zones": {"punch": zone}, "reference": {}})
    result = bemcontact.solve(relieved_problem)
    assert result.stress(operator.points).von_mises.max() <= limit * (1 + 0.004)


@pytest.mark.slow
def test_a_limit_of_stress_that_cannot_be_kept_is_refused():
    """The least stress that is reached and the lower bound are those of the goal "von_mises"."""
    operator = under_the_punch()
    lowest = design_gap(operator.contact, CROWN, goal="von_mises", stress=operator)
    assert lowest.verified
    assert lowest.value == operator.at(lowest.after[0].pressure).von_mises.max()
    for limit, words in (
        (0.9 * lowest.lower_bound, "no profile within"),
        (0.99 * lowest.value, "no profile was found"),
    ):
        numbers = f"{lowest.value:.5g} is the least.* {lowest.lower_bound:.5g};"
        with pytest.raises(ProblemError, match=f"{words}.* {numbers}"):
            design_gap(operator.contact, CROWN, stress=operator, von_mises=limit)
    kept = design_gap(operator.contact, CROWN, stress=operator, von_mises=1.01 * lowest.value)
    assert kept.verified


def test_limits_of_stress_that_do_not_fit_are_refused():
    """A limit needs points, points need a limit, and both need the same problem."""
    operator = under_the_punch()
    for given, words in (
        ({"von_mises": 95}, "needs points"),
        ({"goal": "von_mises"}, "needs points"),
        ({"stress": operator}, "nothing bounds it"),
        ({"stress": operator, "von_mises": 0}, "positive"),
        ({"stress": [[1, 1]], "von_mises": 95}, "stress_operator"),
    ):
        with pytest.raises(ProblemError, match=words):
            design_gap(operator.contact, CROWN, **given)
    with pytest.raises(ProblemError, match=r"operator\.contact"):
        design_gap(condensed("hertz_small"), Relief(lower=0, upper=0.1), stress=operator, von_mises=95)
