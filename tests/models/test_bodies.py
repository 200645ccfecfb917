"""Every file in models/bodies/ is certified, as accurate as it asks, and meets its references."""

from pathlib import Path

import numpy as np
import pytest

import bemcontact
from bemcontact.reference import expected, score

FOLDER = Path(__file__).parents[2] / "models" / "bodies"
MANY = "roller_bearing"
"""Eleven bodies, which take half a minute: they are checked here, not solved."""
NAMES = sorted(path.stem for path in FOLDER.glob("*.yaml") if path.stem != MANY)


@pytest.mark.parametrize("name", NAMES)
def test_references_are_met(name: str):
    problem = bemcontact.load(FOLDER / f"{name}.yaml")
    result = bemcontact.solve(problem)
    assert result.certified
    assert result.holds
    known = expected(problem, result.contact)
    assert all(
        item.holds or not item.judged
        for item in score(known, result.contact, result.footprint, result.solution.pressure)
    )


def test_the_bearing_is_held_and_its_rollers_are_copies():
    problem = bemcontact.load(FOLDER / f"{MANY}.yaml")
    assert {body.copy_of for body in problem.bodies.values()} == {None, "roller 1"}
    middles = [
        np.vstack([edge.points(np.linspace(0, 1, 9)[:-1]) for edge in part.edges]).mean(axis=0)
        for part in problem.parts[2:]
    ]
    assert np.hypot(*np.transpose(middles)) == pytest.approx(np.full(9, 20.0), rel=1e-12)
    turns = np.diff(np.unwrap(np.arctan2(*np.transpose(middles)[::-1])))
    assert turns == pytest.approx(np.full(8, np.radians(40)), rel=1e-12)
