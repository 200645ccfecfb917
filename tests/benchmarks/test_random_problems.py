"""The judge of random problems: what it must find, and that the statements of a problem are the same problem."""

import json
from math import cos, radians, sin

import numpy as np
import pytest
from random_problems import Answer, disagreements, variants
from random_specs import KINDS, Draw
from spec_changes import Change, in_a_case, turns_freely

import bemcontact
from bemcontact import Problem

FORCE = {"floor": np.array([0.0, 5.0])}


def answer(peak, bar, force=FORCE, ending="answered", holds=(True, True)):
    bars = {("peak", "floor"): [(peak, bar)], ("force", "floor"): [(5.0, 0.0)]}
    return Answer(ending=ending, seconds=0, text="as told", holds=holds, bars=bars, forces=force)


@pytest.mark.parametrize(
    ("other", "exact", "words"),
    [
        (answer(1.02, 0.01), False, "WRONG turned: peak"),
        (answer(1.01, 0.01), True, "DIFFERS turned: round-off"),
        (answer(1.0, 0.01, force={"floor": np.array([0.1, 5.0])}), False, "WRONG turned: force"),
        (answer(1.0, 0.01, ending="refused"), True, "DIFFERS turned: refused, as it is: holds"),
        (answer(1.0, 0.01, holds=(True, False)), True, "DIFFERS turned: not met, as it is: holds"),
        (answer(1.0, 0.01, ending="TRACEBACK"), True, "TRACEBACK turned: as told"),
    ],
)
def test_a_disagreement_is_found(other, exact, words):
    (said,) = disagreements(answer(1.0, 0.005), other, "turned", exact)
    assert said.startswith(words)


def test_answers_within_their_bars_agree():
    assert not [*disagreements(answer(1.0, 0.005), answer(1.01, 0.006), "finer", exact=False)]
    assert not [*disagreements(answer(1.0, 0.005), answer(1.0, 0.0, holds=(True, False)), "finer", exact=False)]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_all_statements_can_be_read(kind):
    spec = json.loads(json.dumps(KINDS[kind](Draw(f"{kind} 1"))))
    for _, stated, _, _ in variants(spec, Draw("statements")):
        assert Problem(**stated).name == kind


def test_a_point_is_mirrored_then_turned_then_shifted():
    change = Change(angle=30, mirror=True, length=2.0, shift=(1.0, -1.0))
    c, s = cos(radians(30)), sin(radians(30))
    assert change.place([3, 4]) == pytest.approx([1 + 2 * (-3 * c - 4 * s), -1 + 2 * (-3 * s + 4 * c)])


def test_an_axis_is_turned_by_quarters_only():
    assert not turns_freely({"conditions": {"left": {"displacement": {"x": 0}}}})
    assert turns_freely({"conditions": {"left": {"displacement": {"x": 0, "y": 0}}}})
    turned = Change(angle=90, length=2.0)({"displacement": {"x": 3.0}})
    assert turned == {"displacement": {"y": 6.0}}


def test_a_linear_field_has_the_same_values_at_the_same_places():
    change = Change(angle=20, mirror=True, length=3.0, stress=2.0, shift=(5.0, 7.0))
    field = change({"pressure": {"constant": 1.0, "x": 0.5}})["pressure"]
    x, y = change.place([4.0, 1.0])
    assert field["constant"] + field["x"] * x + field["y"] * y == pytest.approx(2.0 * (1.0 + 0.5 * 4.0))


def test_loads_in_a_case_are_the_loads():
    spec = json.loads(json.dumps(KINDS["block"](Draw("block 2"))))
    of_case = in_a_case(spec)
    assert of_case is not None
    alone = bemcontact.problem(of_case).with_case("own")
    assert alone.load_cases["own"].conditions["top"].pressure == Problem(**spec).conditions["top"].pressure
