"""The roller bearing is held, and its rollers are copies on a circle; the gallery page judges all other files."""

from pathlib import Path

import numpy as np
import pytest

import bemcontact

FOLDER = Path(__file__).parents[2] / "models" / "bodies"
MANY = "roller_bearing"
"""Eleven bodies, which take half a minute: they are checked here, not solved."""


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
