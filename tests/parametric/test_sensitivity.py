"""Sensitivities against differences of contact states, away from degeneracy and at it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from contact_problems import random_contact
from contact_states import between_tools, changed, degenerate, half_plane, random_change, rocker, without_load

import bemcontact
from bemcontact.assessment.footprint import footprint
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import Change
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.parametric.sensitivity import Rates, Sensitivities, sensitivities

ROUND_OFF = 4e-13
"""Of the states: numbers up to 200, with the errors of ten operations."""

MODELS = Path(__file__).parents[2] / "models"


def quantities(contact: CondensedContact) -> dict[str, np.ndarray]:
    """What a sensitivity is given of, from an independent solve."""
    solution = complementarity.solve(contact)
    seen = footprint(contact, solution)
    return {
        "pressure": solution.pressure,
        "gap": contact.initial_gap + solution.displacement,
        "rigid_amplitudes": solution.rigid_amplitudes,
        "resultant": contact.resultants(solution.pressure),
        "peak": np.array(seen.peak.pressure if seen.peak else 0.0),
        "interval_ends": np.array([(item.start_arc, item.end_arc) for item in seen.intervals]),
    }


def difference(after: CondensedContact, before: CondensedContact, width: float) -> dict[str, np.ndarray]:
    then, now = quantities(after), quantities(before)
    return {name: (then[name] - now[name]) / width for name in then}


def assert_same(rates: Rates, expected: dict[str, np.ndarray], width: float, *names: str) -> None:
    """Agree to 1e-6 relative, as is asked for, beside the round-off of the difference."""
    for name in names or expected:
        result = np.array(getattr(rates, name), float)
        size = np.abs(expected[name]).max(initial=0.0)
        np.testing.assert_allclose(result, expected[name], rtol=0, atol=1e-6 * size + ROUND_OFF / width, err_msg=name)


def test_tools_and_load_cases_against_central_differences():
    """States are piecewise linear: a central difference is exact but for 1e-15 / 1e-4, and for δ^(2/3) in the ends."""
    contact, step = between_tools(), 1e-4
    result = sensitivities(contact)
    assert set(result) == {
        "load_cases.wind", "tools.punch.displacement.x", "tools.punch.force.y", "tools.punch.displacement.rotation",
    }  # fmt: skip
    sides = {}
    for side in (step, -step):
        position, force = contact.tools.position, contact.tools.force
        sides[side] = {
            "load_cases.wind": contact.with_factors({"wind": side}),
            "tools.punch.displacement.x": contact.with_tools(position=position + np.array([side, 0, 0])),
            "tools.punch.force.y": contact.with_tools(force=force + np.array([0, side, 0])),
            "tools.punch.displacement.rotation": contact.with_tools(position=position + np.array([0, 0, side])),
        }
    for key, sensitivity in result.each.items():
        assert not sensitivity.one_sided
        assert_same(sensitivity.rising, difference(sides[step][key], sides[-step][key], 2 * step), step)


@pytest.mark.parametrize("seed", range(8))
def test_gap_and_load_of_random_bodies_against_central_differences(seed: int):
    contact, step = random_contact(seed, 12, seed % 4), 1e-5
    change = random_change(seed, contact)
    rates = sensitivities(contact, {"both": change})["both"].rising
    expected = difference(changed(contact, change, step), changed(contact, change, -step), 2 * step)
    assert_same(rates, expected, step, "pressure", "gap", "rigid_amplitudes", "resultant", "peak")


@pytest.fixture(scope="module")
def cylinder() -> bemcontact.Problem:
    return bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh")


def test_load_on_the_cylinder_against_central_differences(cylinder: bemcontact.Problem):
    """At 0.9 of the load, where the end is read between two points: curvature over a step of 1e-5 leaves 1e-9."""
    full, step = bemcontact.condense(cylinder), 1e-5
    free = without_load(full)
    change = Change(full.offset - free.offset, full.motion_load - free.motion_load)
    contact = changed(free, change, 0.9)
    rates = sensitivities(contact, {"load": change})["load"].rising
    assert_same(rates, difference(changed(contact, change, step), changed(contact, change, -step), 2 * step), step)
    (start, end), *others = rates.interval_ends
    assert start == 0.0  # on the axis
    assert end is not None
    assert end > 0
    assert not others
    assert rates.resultant[0, 1] == pytest.approx(405, rel=1e-12)  # statics: 50.625 on a radius of 8


@pytest.mark.parametrize("seed", range(8))
def test_weakly_active_points_give_two_sides(seed: int):
    """One-sided differences over 1e-5 are exact to 1e-10 on each side as long as no other point enters or leaves."""
    contact, _, _ = degenerate(seed, n=9, k=seed % 3, weak=2)
    change, step = random_change(seed, contact), 1e-5
    result = sensitivities(contact, {"both": change})
    assert len(result.weak) == 2
    assert "touch without pressure" in result.notes[0]
    sensitivity = result["both"]
    assert sensitivity.one_sided
    names = ("pressure", "gap", "rigid_amplitudes", "resultant", "peak")
    assert_same(sensitivity.rising, difference(changed(contact, change, step), contact, step), step, *names)
    assert_same(sensitivity.falling, difference(contact, changed(contact, change, -step), step), step, *names)
    assert np.abs(sensitivity.rising.pressure - sensitivity.falling.pressure).max() > 1e-3


def test_ends_beside_a_weakly_active_point_have_no_derivative():
    """The parabola in contact at points 18 to 22 of 41, and 23 about to join: beyond it the end is read anew."""
    path = bemcontact.parametric.path.load_path(half_plane(41, 0.0), half_plane(41, 0.2))
    entering = next(i for i, points in enumerate(path.entered) if 23 in points)
    result = sensitivities(path.contact(path.parameter[entering]), {"load": Change(np.zeros(41), np.array([-1.0]))})
    assert result.weak == (17, 23)
    assert result["load"].rising.interval_ends == ((None, None),)
    assert "points 17 at (17, 0), 23 at (23, 0) touch without pressure" in result.notes[0]


def test_peak_that_two_points_share_has_two_sides():
    """A load between two supports; as it moves to the right, the right one bears more, as to the left, the left one."""
    contact = rocker(-0.5)
    result = sensitivities(contact, {"moved": Change(np.zeros(3), np.array([0.0, -1.0]))})
    assert (result["moved"].rising.peak, result["moved"].falling.peak) == pytest.approx((1.0, -1.0), abs=1e-13)
    assert "points 0 at (0, 0), 1 at (1, 0) share the peak pressure" in result.notes[0]


def test_no_derivative_where_the_body_is_not_held():
    with pytest.raises(ProblemError, match=r"no derivative with respect to load as it rises: .* do not hold the body"):
        sensitivities(rocker(0.0), {"load": Change(np.zeros(3), np.array([-1.0, 0.0]))})
    with pytest.raises(ProblemError, match="there is no contact state to differentiate: the load pulls the body off"):
        sensitivities(rocker(2.0), {})


def test_input_that_does_not_fit_is_refused():
    contact = random_contact(0, 6, 1)
    with pytest.raises(ProblemError, match=r"gap: the offset of the change has shape \(5,\) where \(6,\)"):
        sensitivities(contact, {"gap": Change(np.zeros(5), np.zeros(1))})
    with pytest.raises(ProblemError, match="gap: the offset of the change has entries that are not finite"):
        sensitivities(contact, {"gap": Change(np.full(6, np.nan), np.zeros(1))})
    other = complementarity.solve(random_contact(1, 6, 1))
    with pytest.raises(ProblemError, match="no contact state to differentiate: its residual is"):
        sensitivities(contact, {}, other)


def test_units_change_nothing():
    """Lengths times 1e3 and pressures times 1e-6: the rate of pressure per length changes by 1e-9."""
    contact, L, P = random_contact(4, 10, 1), 1e3, 1e-6
    change = Change(np.eye(10)[3], np.zeros(1))
    other = replace(
        contact,
        compliance=contact.compliance * (L / P),
        initial_gap=contact.initial_gap * L,
        free_displacement=contact.free_displacement * L,
        weights=contact.weights * L,
        motion_load=contact.motion_load * (L * P),
    )
    here, there = (sensitivities(item, {"gap": change})["gap"].rising for item in (contact, other))
    np.testing.assert_allclose(there.pressure, here.pressure * P / L, rtol=1e-10, atol=1e-10 * P / L)


def test_words_and_numbers():
    result: Sensitivities = sensitivities(between_tools())
    head, *lines = repr(result).splitlines()
    assert head == f"<Sensitivities to {len(result)} parameters>"
    assert lines[: len(result)] == [repr(item)[len("<Sensitivity to ") : -1] for item in result.each.values()]
    assert lines[len(result) :] == [*result.notes]
    assert repr(result["load_cases.wind"]).startswith("<Sensitivity to load_cases.wind: peak ")
    record = json.loads(result.to_json())
    assert [item["key"] for item in record["sensitivities"]] == list(result)
    with pytest.raises(ProblemError, match=r"no sensitivity to 'wind'; there are: load_cases\.wind"):
        result["wind"]
