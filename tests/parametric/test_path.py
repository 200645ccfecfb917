"""Load paths: every state on them is the one that an independent solver or exhaustive search finds."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import exhaustive
import numpy as np
import pytest
from contact_problems import random_contact
from contact_states import between_tools, degenerate, half_plane, rocker, without_load
from hypothesis import given, settings
from hypothesis import strategies as st

import bemcontact
from bemcontact.assessment.certificate import certify
from bemcontact.assessment.residual import residuals
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.parametric.path import LoadPath, load_path

MODELS = Path(__file__).parents[2] / "models"


def random_path(seed: int, n: int, k: int) -> tuple[CondensedContact, CondensedContact]:
    """A random body between two random gaps and loads, both of which some pressure carries."""
    body, rng = random_contact(seed, n, k), np.random.default_rng(seed + 100)
    carried = np.maximum(rng.standard_normal(n), 0.0)
    load = -body.equilibrium.T @ carried
    return body, replace(body, initial_gap=rng.standard_normal(n), motion_load=load)


def natural_residual(path: LoadPath) -> float:
    """The largest of |min(p/T, δ/U)| and of the imbalance at the breakpoints, recomputed from p and a."""
    worst = 0.0
    U, T = path.end.scales
    for t, p, a in zip(path.parameter, path.pressure, path.rigid_amplitudes, strict=True):
        contact = path.contact(t)
        size = 1 + p.max(initial=0.0) / T
        worst = max(worst, np.abs(np.minimum(p / T, contact.gap(p, a) / U)).max() / size)
        balance = contact.equilibrium.T @ p + contact.motion_load
        worst = max(worst, np.abs(balance).max(initial=0.0) / (T * contact.weights.sum() * size))
    return worst


def apart(path: LoadPath, count: int) -> float:
    """The largest difference to independent solves at random t, of the pressure over its peak and of the gap over U."""
    worst = 0.0
    for t in np.random.default_rng(7).uniform(path.begins_at, path.ends_at, count):
        result, expected = path.at(t), complementarity.solve(path.contact(t))
        assert expected.status is bemcontact.Status.SOLVED
        worst = max(worst, np.abs(result.pressure - expected.pressure).max() / (expected.pressure.max() or 1.0))
        gaps = np.abs(result.displacement - expected.displacement).max()
        worst = max(worst, gaps / path.end.scales.displacement)
    return worst


@pytest.mark.parametrize("seed", range(12))
def test_states_are_those_of_exhaustive_search(seed: int):
    """All 2ⁿ sets of points are tried at the breakpoints and between them; sym(JM) is definite, so there is one state.

    Where a point is about to enter, two sets give the same state. The search allows 1e-9 of the size, which is 10.
    """
    path = load_path(*random_path(seed, 4 + seed % 5, seed % 3))
    assert path.complete
    for t in [*path.parameter, *(path.parameter[1:] + path.parameter[:-1]) / 2]:
        np.testing.assert_allclose(path.at(t).pressure, exhaustive.state(path.contact(t))[0], atol=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_random_states_between_agree_with_independent_solves(seed: int):
    """1e-9 is asked for; the residual is round-off, since each state is solved for anew."""
    path = load_path(*random_path(seed, 20 + seed, seed % 4))
    assert apart(path, 50) <= 1e-9
    assert natural_residual(path) <= 1e-13


@pytest.mark.parametrize("seed", range(12))
def test_path_from_a_state_with_weakly_active_points(seed: int):
    """Points without pressure and gap at the start: the derivative there decides which of them are loaded."""
    start, _, _ = degenerate(seed, n=9, k=seed % 3, weak=1 + seed % 4)
    _, end = random_path(seed, 9, seed % 3)
    assert apart(load_path(start, replace(end, initial_gap=end.initial_gap + 0.5)), 20) <= 1e-9


def coarse_path(rng: np.random.Generator) -> tuple[CondensedContact, CondensedContact]:
    """Data out of few whole numbers: points enter and leave together, and are weakly active at the ends."""
    n, k = int(rng.integers(3, 8)), int(rng.integers(0, 3))
    B, x = rng.integers(0, 2) * rng.integers(-1, 2, (n, n)), np.arange(n) - (n - 1) / 2
    R = np.column_stack([np.ones(n), x])[:, :k]
    loads = [-R.T @ np.maximum(rng.integers(-1, 3, n), 0) for _ in range(2)]
    start = CondensedContact.from_compliance(
        (B @ B.T + np.diag(rng.integers(1, 3, n))) / 2,
        rng.integers(-1, 3, n) / 2,
        rigid_motions=R if k else None,
        motion_load=loads[0] if k else None,
    )
    return start, replace(start, initial_gap=rng.integers(-1, 3, n) / 2, motion_load=loads[1])


def wandering_load(rng: np.random.Generator) -> tuple[CondensedContact, CondensedContact]:
    """A load that wanders over springs of uneven height while it changes; on stiff ones the block tips over."""
    n = int(rng.integers(3, 8))
    x, gap, compliance = np.arange(n) - (n - 1) / 2, rng.integers(0, 4, n) / 2, 10.0 ** rng.integers(-4, 1)
    R = np.column_stack([np.ones(n), x])
    places, loads = rng.uniform(x[0], x[-1], 2), rng.permutation([0.0, 1.0, 2.0])[:2]
    start, end = (
        CondensedContact.from_compliance(
            compliance * np.eye(n), gap, rigid_motions=R, motion_load=[-load, -load * place]
        )
        for load, place in zip(loads, places, strict=True)
    )
    return start, end


@pytest.mark.slow
@pytest.mark.parametrize("made", [coarse_path, wandering_load])
def test_degenerate_paths_are_those_of_exhaustive_search(made):
    """Pressures are of size 1; on springs of compliance 1e-4, the stiffest, the search allows 1e-5 of them."""
    tipped = together = 0
    for seed in range(50):
        rng = np.random.default_rng(seed)
        path = load_path(*made(rng))
        assert path.complete or path.note.startswith("the load pulls the body off its support")
        assert path.residual <= 1e-12
        tipped += bool((np.diff(path.parameter) == 0).any())
        together += any(len(points) > 1 for points in (*path.entered, *path.left))
        for t in rng.uniform(path.begins_at, path.ends_at, 2):
            expected = exhaustive.state(path.contact(t))[0]
            np.testing.assert_allclose(path.at(t).pressure, expected, atol=1e-5, err_msg=f"seed {seed}")
    assert (together if made is coarse_path else tipped) >= 5


@pytest.mark.parametrize("what", ["case", "position", "force"])
def test_load_factors_positions_and_forces_of_tools(what: str):
    """Problems made at each t by `with_factors` and `with_tools`, solved independently, and the place of the tool."""
    contact = between_tools()

    def at(t: float) -> CondensedContact:
        match what:
            case "case":
                return contact.with_factors({"wind": 4 * t - 1})
            case "position":
                return contact.with_tools(position=[[0.2 - t, 0.0, 0.1 + t]])
            case _:
                return contact.with_tools(force=[[0.0, -3 * t, 0.0]])

    path = load_path(at(0.0), at(1.0))
    assert path.complete
    assert path.pivots >= 2
    for t in np.random.default_rng(1).uniform(0, 1, 50):
        stated, result, made = at(t), path.at(t), path.contact(t)
        expected = complementarity.solve(stated)
        np.testing.assert_allclose(result.pressure, expected.pressure, atol=1e-9 * expected.pressure.max())
        np.testing.assert_allclose(made.cases.factors, stated.cases.factors, atol=1e-14)
        np.testing.assert_allclose(
            made.tools.displacement(result.rigid_amplitudes),
            stated.tools.displacement(expected.rigid_amplitudes),
            atol=1e-9,
        )
        np.testing.assert_allclose(made.tools.force, stated.tools.force, atol=1e-14)


def test_path_back_is_the_same_path():
    start, end = random_path(3, 15, 2)
    there, back = load_path(start, end), load_path(end, start)
    np.testing.assert_allclose(there.parameter, 1 - back.parameter[::-1], atol=1e-12)
    np.testing.assert_allclose(there.pressure, back.pressure[::-1], atol=1e-11)
    assert there.entered == back.left[::-1]
    assert there.left == back.entered[::-1]


def model(name: str) -> bemcontact.Problem:
    """A shipped problem, on a stated mesh if it has one."""
    problem = bemcontact.load(MODELS / f"{name}.yaml")
    return problem.variant("stated mesh") if "stated mesh" in problem.variants else problem


@pytest.fixture(scope="module", params=["cylinder_on_plane", "cantilever_flat_surface", "gallery/three_zones"])
def full_load(request) -> LoadPath:
    """From no load to the full one: problems 2 and 5 of [SS92] and a body on three zones, which statics fixes."""
    contact = bemcontact.condense(model(request.param))
    return load_path(without_load(contact), contact)


def test_bodies_from_no_load_to_the_full_one(full_load: LoadPath):
    """50 solves in between agree to 1e-9 (the condition of M is up to 1e6); residuals are those of one linear solve."""
    assert full_load.complete
    assert full_load.unique
    assert apart(full_load, 50) <= 1e-9
    assert natural_residual(full_load) <= 1e-12
    assert full_load.residual <= 1e-12


def test_every_breakpoint_is_certified(full_load: LoadPath):
    """The certificate recomputes optimality and uniqueness from pressure and displacement alone."""
    for t in full_load.parameter:
        contact, solution = full_load.contact(t), full_load.at(t)
        certificate = certify(contact, solution, residuals(contact, solution))
        assert certificate.certified, (t, certificate.words)


@pytest.mark.parametrize("name", ["cantilever_flat_surface", "gallery/three_zones"])
def test_unloading_ends_certified_where_nothing_touches_any_more(name):
    """Down to -1/4 of the load, t = 0.8 is no load: the free link ends there, by statics, without tipping in the air.

    The gap at a point that has just closed, and a load that has just gone, are round-off, by which nothing is judged.
    """
    contact = bemcontact.condense(model(name))
    reversed_load = replace(
        contact, free_displacement=-contact.free_displacement / 4, motion_load=-contact.motion_load / 4
    )
    path = load_path(contact, reversed_load)
    assert path.ends_at == pytest.approx(0.8 if contact.free_motions else 1.0, rel=1e-14)
    assert (np.diff(path.parameter) > 0).all()
    for i, t in enumerate(path.parameter):
        there, state = path.contact(t), path.breakpoint(i)
        certificate = certify(there, state, residuals(there, state))
        assert certificate.certified, (t, certificate.words)


def test_contact_sets_of_the_path_are_those_of_its_states(full_load: LoadPath):
    """Half-way between two breakpoints a point is in contact if it bears a pressure."""
    for t, touching in zip((full_load.parameter[1:] + full_load.parameter[:-1]) / 2, full_load.touching, strict=True):
        np.testing.assert_array_equal(full_load.at(t).pressure > 0, touching)


def test_cantilever_touches_first_at_its_tip():
    """Without contact it bends in proportion to the load: the tip closes 1 cm at t = 1 / its free deflection."""
    contact = bemcontact.condense(bemcontact.load(MODELS / "cantilever_flat_surface.yaml", variant="stated mesh"))
    path = load_path(without_load(contact), contact)
    sinks = -contact.free_displacement
    assert path.parameter[1] == pytest.approx(1.0 / sinks.max(), rel=1e-13)
    assert path.entered[1] == (int(sinks.argmax()),)
    assert not path.pressure[1].any()


def test_load_path_of_a_body_that_contact_alone_holds_begins_at_its_first_touch():
    """The limit of no load: the parabola rests on its lowest point, at the middle of 41, and on no other."""
    path = load_path(half_plane(41, 0.0), half_plane(41, 0.2))
    assert path.complete
    assert not path.pressure[0].any()
    np.testing.assert_array_equal(np.flatnonzero(path.gap[0] == 0), [20])
    np.testing.assert_allclose(path.gap[0], np.linspace(-1, 1, 41) ** 2 / 2, atol=1e-15)


@pytest.mark.parametrize("at", [0.0, 0.3, -0.7, 1.0])
def test_load_that_vanishes_leaves_a_body_where_it_stood(at: float):
    """Towards no load the pressures go to zero together: the end is the limit of what was before, and is reached."""
    path = load_path(rocker(at, gap=0.0), rocker(at, load=0.0, gap=0.0))
    assert path.complete
    assert bool(path.notes) is (at == 1.0)  # over one spring, the load leaves the rotation away from the others open
    np.testing.assert_allclose(path.pressure[-1], 0, atol=1e-15)
    np.testing.assert_allclose(path.rigid_amplitudes[-1], 0, atol=1e-14)  # on three level springs, unloaded


def loose_path(seed: int) -> tuple[CondensedContact, CondensedContact] | None:
    """A random body between two loads that some pressures carry; each point sees some of the motions only."""
    rng = np.random.default_rng(seed)
    n, k = int(rng.integers(3, 8)), int(rng.integers(1, 4))
    whole = rng.random() < 0.4  # degenerate in many ways
    A = rng.standard_normal((n, n))
    R = (rng.integers(-1, 2, (n, k)) if whole else rng.standard_normal((n, k))) * (rng.random((n, k)) < 0.6)
    if np.linalg.matrix_rank(R) < k:
        return None

    def numbers() -> np.ndarray:
        return rng.integers(-1, 3, n).astype(float) if whole else rng.standard_normal(n)

    loads = [-R.T @ (np.maximum(numbers(), 0) * (rng.random(n) < 0.5)) for _ in range(2)]
    first, last = (
        CondensedContact.from_compliance(A @ A.T / n + 0.3 * np.eye(n), numbers(), rigid_motions=R, motion_load=load)
        for load in (loads[0], loads[0] * 2 if rng.random() < 0.5 else loads[1])
    )
    return first, last


@pytest.mark.slow
def test_positions_that_contact_leaves_open_are_those_of_solutions():
    """Between breakpoints: the rule chooses the same position on a path and in a solution, and the path goes on."""
    opened = 0
    for seed in range(24):
        ends = loose_path(seed)
        if ends is None or not any(end.motion_load.any() for end in ends):
            continue
        path = load_path(*ends)
        opened += path.open.any()
        assert path.complete
        assert path.residual < 1e-12
        for t in np.random.default_rng(seed).uniform(0, 1, 3):
            contact = path.contact(t)
            state, solution = path.at(t), complementarity.solve(contact)
            if contact.peak(solution.pressure):  # else nothing touches, and no rule holds
                scale = contact.scales
                apart = state.displacement - solution.displacement
                np.testing.assert_allclose(state.pressure, solution.pressure, rtol=0, atol=1e-9 * scale.pressure)
                np.testing.assert_allclose(apart, 0, rtol=0, atol=1e-8 * scale.displacement)
    assert opened > 5


@pytest.mark.slow
def test_positions_that_contact_leaves_open_are_noted_once_with_where_they_are():
    """A motion is named in the ranges in which solutions leave it open; values of a parameter stand in place of t."""
    several = 0
    for seed in range(24):
        ends = loose_path(seed)
        if ends is None or not any(end.motion_load.any() for end in ends):
            continue
        path = load_path(*ends)
        notes = [note for note in path.notes_at(lambda t: 100 * t) if note.startswith("not determined")]
        assert len(notes) == path.open.any()
        for begin, end in pairwise(path.parameter):
            if begin < end:
                named = {name for name, own in path.left_open if any(a <= begin and end <= b for a, b in own)}
                assert named == {*path.at((begin + end) / 2).undetermined}
        for name, own in path.left_open:
            assert all(b < c for (_, b), (c, _) in pairwise(own))
            where = " and ".join(f"from {100 * a:.6g} to {100 * b:.6g}" for a, b in own)
            assert f"the {name} {where}" in notes[0]
        several += len(path.left_open) > 1 or any(len(own) > 1 for _, own in path.left_open)
    assert several > 2


def test_points_that_enter_together_are_one_breakpoint():
    """By symmetry the points of a pressed parabola enter in pairs; the pressure stays symmetric to round-off."""
    path = load_path(half_plane(40, 0.01), half_plane(40, 0.2))
    assert all(len(points) in (0, 2) and sum(points) == 39 * (len(points) == 2) for points in path.entered)
    assert path.pivots >= 10
    np.testing.assert_allclose(path.pressure, path.pressure[:, ::-1], atol=1e-12)


def test_points_that_enter_together_by_construction():
    """Three springs of compliance 1 under a rigid floor that rises by t: gaps 1/2 - t close at once, 3/4 - t later."""
    start = CondensedContact.from_compliance(np.eye(3), [0.5, 0.5, 0.75])
    path = load_path(start, replace(start, initial_gap=start.initial_gap - 1))
    assert path.parameter.tolist() == [0.0, 0.5, 0.75, 1.0]
    assert path.entered == ((), (0, 1), (2,), ())
    np.testing.assert_allclose(path.pressure[-1], [0.5, 0.5, 0.25], atol=1e-15)


def test_load_that_moves_across_a_support_lets_the_block_tip():
    """As the load passes the middle support, all of it stands there, and the block turns from one stop to the other.

    Springs of compliance 0.1 under outer supports lower by 0.3: with p = (0, 1, 0) the block is at -0.1 over the middle
    and turned by ±0.2, where the gap of one outer support is closed and that of the other 0.4.
    """
    path = load_path(rocker(-0.5), rocker(0.5))
    assert path.parameter.tolist() == pytest.approx([0, 0.5, 0.5, 1], abs=1e-15)
    np.testing.assert_allclose(path.pressure, [[0.5, 0.5, 0], [0, 1, 0], [0, 1, 0], [0, 0.5, 0.5]], atol=1e-15)
    np.testing.assert_allclose(path.gap[1:3], [[0, 0, 0.4], [0.4, 0, 0]], atol=1e-14)
    np.testing.assert_allclose(path.rigid_amplitudes[1:3, 1], [0.2, -0.2], atol=1e-14)


def test_load_that_crosses_a_support_with_the_next_one_level():
    """With the outer supports lower by 0.1 the block, which sinks by that, is level as the load passes: no tipping."""
    path = load_path(rocker(-0.5, gap=0.1), rocker(0.5, gap=0.1))
    assert path.parameter.tolist() == pytest.approx([0, 0.5, 1], abs=1e-15)
    assert (path.entered[1], path.left[1]) == ((2,), (0,))


@pytest.mark.parametrize(
    ("start", "end", "reach", "words"),
    [(-0.5, 1.5, (0, 0.75), "the path exists up to 0.75"), (1.5, -0.5, (0.25, 1), "the path exists from 0.25 on")],
)
def test_load_beyond_the_last_support_ends_the_path(start, end, reach, words):
    """The load reaches the outer support, x = 1, a quarter of the way from 1.5 to -0.5."""
    path = load_path(rocker(start), rocker(end))
    assert not path.complete
    assert (path.begins_at, path.ends_at) == pytest.approx(reach, abs=1e-14)
    assert path.note.startswith("the load pulls the body off its support, in a motion that nothing holds")
    assert path.notes == (f"{words}; beyond that, {path.note}",)
    with pytest.raises(ProblemError, match="there is nothing at"):
        path.at(1.0 if reach[0] == 0 else 0.0)
    np.testing.assert_allclose(path.pressure[-1 if reach[0] == 0 else 0], [0, 0, 1], atol=1e-14)


def test_no_path_without_a_support():
    with pytest.raises(ProblemError, match="there is no path of contact states: at the start, the load pulls"):
        load_path(rocker(2.0), rocker(3.0))


def test_path_that_turns_back_is_not_followed_silently():
    """M = [[1, 2], [2, 1]] is no P-matrix; q = (-1, -1.9 - t/5).

    Both points are loaded by p = (2.8 + 0.4 t, 0.1 - 0.2 t) / 3 up to t = 1/2. There p = (1, 0), which is a solution as
    t falls again, not as it rises.
    """
    start = CondensedContact.from_compliance([[1.0, 2.0], [2.0, 1.0]], [-1.0, -1.9])
    path = load_path(start, replace(start, initial_gap=np.array([-1.0, -2.1])))
    np.testing.assert_allclose(path.parameter, [0, 0.5], atol=1e-14)
    np.testing.assert_allclose(path.pressure, [[2.8 / 3, 0.1 / 3], [1, 0]], atol=1e-14)
    assert path.notes[0].startswith("the path exists up to 0.5; beyond that, no contact state was found to continue")
    assert "does not rule out other contact states" in path.notes[1]


def test_ends_that_are_not_of_one_body_are_refused():
    start, end = random_path(0, 6, 1)
    with pytest.raises(
        ProblemError, match=r"compliance of start and end differ, by 0\.5 of the largest; a path is exact"
    ):
        load_path(start, replace(end, compliance=end.compliance * 1.5))
    with pytest.raises(ProblemError, match="weights of start and end differ"):
        load_path(start, replace(end, weights=end.weights * 2))
    with pytest.raises(
        ProblemError, match="a path leads between two CondensedContact, which condense makes; found str"
    ):
        load_path("block.yaml", "block.yaml")  # pyright: ignore[reportArgumentType]
    with pytest.raises(ProblemError, match=r"compliance of start and end differ in shape, \(6, 6\) and \(7, 7\)"):
        load_path(start, random_contact(0, 7, 1))


@settings(max_examples=15)
@given(st.floats(-6, 6), st.floats(-6, 6))
def test_units_change_nothing(length: float, stress: float):
    """Lengths times L, pressures times P, and M times L/P: the same breakpoints, the same points."""
    L, P = 10.0**length, 10.0**stress

    def in_other_units(contact: CondensedContact) -> CondensedContact:
        return replace(
            contact,
            compliance=contact.compliance * (L / P),
            initial_gap=contact.initial_gap * L,
            free_displacement=contact.free_displacement * L,
            weights=contact.weights * L,
            motion_load=contact.motion_load * (L * P),
        )

    ends = random_path(5, 8, 1)
    here, there = load_path(*ends), load_path(*map(in_other_units, ends))
    np.testing.assert_allclose(there.parameter, here.parameter, atol=1e-12)
    np.testing.assert_allclose(there.pressure / P, here.pressure, atol=1e-11)
    assert (there.entered, there.left) == (here.entered, here.left)


def test_resultants_and_peaks_are_those_of_the_states(full_load: LoadPath):
    """The footprint of each breakpoint, computed on its own, has the same peak and total force."""
    for t, peak, forces in zip(full_load.parameter[1:], full_load.peak[1:], full_load.resultant[1:], strict=True):
        seen = full_load.footprint(t)
        assert (seen.peak.pressure if seen.peak else 0.0) == pytest.approx(peak, rel=1e-13)
        np.testing.assert_allclose(
            forces.sum(axis=0), seen.resultant.force, atol=1e-12 * abs(full_load.resultant).max()
        )


def test_path_in_words_and_numbers():
    path = load_path(rocker(-0.5), rocker(1.5))
    assert repr(path).startswith(
        "<LoadPath of 'unnamed': 4 breakpoints from 0 to 0.75, 2 pivots; the path exists up to 0.75; "
    )
    record = path.to_dict()
    assert (record["complete"], record["pivots"], record["left"]) == (False, 2, [[], [0], [], []])
    assert record["notes"] == list(path.notes)
