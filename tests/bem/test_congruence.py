"""Congruent bodies: their shared factors give what factors of their own give."""

import numpy as np
import pytest
from roller_bearings import ROLLERS, bearing
from several_bodies import GUIDED, HELD, Spec, block, elastic, problem

from bemcontact import Problem
from bemcontact.bem import condense as condensing
from bemcontact.bem.condense import Condensation, boundary_columns, condense_together, condensed
from bemcontact.bem.discretization import body_of


def both(spec, monkeypatch: pytest.MonkeyPatch) -> tuple[Condensation, Condensation]:
    """A problem condensed with shared factors and body by body."""
    shared = condensed(spec)
    with monkeypatch.context() as patch:
        patch.setattr(condensing, "congruent", lambda systems: {i: {i: np.eye(2)} for i in range(len(systems))})
        return shared, condensed(spec)


def ensure_equal(shared: Condensation, alone: Condensation) -> None:
    """The same compliance and displacement at contact points, and the same fields on the whole boundary."""
    for name in ("compliance", "free_displacement"):
        one, two = getattr(shared.contact, name), getattr(alone.contact, name)
        assert np.abs(one - two).max() <= 1e-11 * np.abs(two).max()
    for one, two in zip(boundary_columns(shared), boundary_columns(alone), strict=True):
        assert np.abs(one - two).max() < 1e-10 * np.abs(two).max()


def test_turned_copies_share_factors(monkeypatch):
    shared, alone = both(bearing(1e-3, -1e-5, 8), monkeypatch)
    assert [part.like for part in shared.parts] == [0] * ROLLERS
    assert [part.like for part in alone.parts] == [*range(ROLLERS)]
    ensure_equal(shared, alone)


WEIGHT = {"gravity": {"density": 0.01, "acceleration": [0.3, -9.81]}}
OTHER_WEIGHT = {"gravity": {"density": 0.02, "acceleration": [0, -9.81]}}


def legs(conditions: Spec, turn: float) -> Problem:
    """A leg that is clamped below, and a copy of it beside or a quarter turn away, each with a block on its top."""
    elements = (4, 6, 4, 6)
    bodies = {
        "leg": elastic(block((0, 1), (0, 2), elements), {**HELD, "right": {"pressure": 0.2}}, loads=WEIGHT),
        "copy": {
            "copy_of": "leg", "rotate": turn, "shift": [4, 0] if turn == 0 else [0, 0],
            "conditions": {"left": {"pressure": 0.1}, **conditions}, "loads": OTHER_WEIGHT,
        },
        "on leg": elastic(block((0, 1), (2, 3), elements), {"top": {"displacement": {"x": 0, "y": 0}}}, 500.0),
    }  # fmt: skip
    if turn == 0:
        above = elastic(block((4, 5), (2, 3), elements), {"top": {"displacement": {"x": 0, "y": 0}}}, 700.0)
        touching = "on copy/bottom"
    else:
        above = elastic(block((-3, -2), (0, 1), elements), {"left": {"displacement": {"x": 0, "y": 0}}}, 700.0)
        touching = "on copy/right"
    contacts: Spec = {"one": ["leg/top", "on leg/bottom"], "two": ["copy/top", touching]}
    return problem({**bodies, "on copy": above}, **contacts)


@pytest.mark.parametrize(
    ("conditions", "turn", "like"),
    [
        (HELD, 0, 0),
        ({"bottom": {"displacement": {"x": 0.001, "y": -0.002}}}, 0, 0),
        ({"bottom": {"displacement": {"x": 0.001, "y": -0.002}}}, 90, 0),
        (GUIDED | {"bottom": {"displacement": {"y": 0}}}, 0, 1),
        ({**HELD, "left": {"displacement": {"x": 0}}}, 90, 1),
    ],
)
def test_copies_share_factors_if_the_same_displacements_are_prescribed(conditions, turn, like, monkeypatch):
    """Values and loads may differ."""
    shared, alone = both(legs(conditions, turn), monkeypatch)
    assert [part.like for part in shared.parts] == [0, like, 2, 3]
    ensure_equal(shared, alone)


def test_the_axis_of_a_guide_turns_with_a_body(monkeypatch):
    """A quarter turn away, a copy that is guided on the same two sides is held along other axes there."""
    spec = legs(GUIDED | {"bottom": {"displacement": {"y": 0}}}, 90)
    bodies = {
        **spec.bodies,
        "leg": spec.bodies["leg"].model_copy(update={"conditions": spec.bodies["copy"].conditions}),
    }
    shared, alone = both(spec.model_copy(update={"bodies": bodies}), monkeypatch)
    assert [part.like for part in shared.parts] == [0, 1, 2, 3]
    ensure_equal(shared, alone)


def test_a_study_of_loads_shares_factors_of_copies_too(monkeypatch):
    """Problems that differ in loads only are condensed together: the loads of each copy are those of its problem."""
    held = {"bottom": {"displacement": {"x": 0.001, "y": -0.002}}}
    specs = [legs({**held, "left": {"pressure": pressure}}, 90) for pressure in (0.1, 0.3)]
    together = condense_together([body_of(spec) for spec in specs])
    for number, spec in enumerate(specs):
        ensure_equal(together[number], both(spec, monkeypatch)[1])
