"""Roller bearing: held, with copies on a circle. Cantilevers: beam theory. The gallery page judges all other files."""

from pathlib import Path

import numpy as np
import pytest

import bemcontact
from bemcontact.problems import Values

FOLDER = Path(__file__).parents[2] / "models" / "bodies"
MANY = "roller_bearing"
"""Eleven bodies, which take half a minute: they are checked here, not solved."""


@pytest.mark.slow
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


def compliance(length: float, height: float) -> float:
    """l³/3EI + l/κGA of Timoshenko's beam of steel, clamped at one end, in plane stress with κ = 5/6."""
    E, G = 210e3, 210e3 / 2.6
    return 4 * length**3 / (E * height**3) + length / (5 / 6 * G * height)


def test_the_reference_of_the_cantilevers_is_beam_theory():
    """The stiffer one takes more; Hertz has the peak sqrt(P E* / πR), E* = E/2 of two equal bodies in plane stress."""
    upper, lower = compliance(100, 10), compliance(100, 8)
    force = 1.4 * upper / (upper + lower)
    stated = bemcontact.load(FOLDER / "two_cantilevers.yaml").reference["beams"]
    assert isinstance(stated, Values)
    assert stated.resultant == pytest.approx(force, abs=5e-6)
    assert stated.peak == pytest.approx(np.sqrt(force * 105e3 / (np.pi * 25)), abs=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize("length", [100.0, 70.0, 50.0])
def test_cantilevers_share_their_load_as_beams_do(length: float):
    """With clamps nearer to the nose, the upper one is 10, 7 and 5 heights h long. Beam theory is off by 0.17 (h/l)².

    This is of the order of what it leaves out, and was measured at l = 5 h with an accuracy of 0.1 %, by two meshes.
    The rest is the error bar. Shear changes the force by 0.2 to 0.7 %, which is about as much as theory is off.
    """
    problem = bemcontact.load(FOLDER / "two_cantilevers.yaml")
    upper, lower = "bodies.upper.boundary.outer", "bodies.lower.boundary.outer"
    moved = {
        f"{upper}.bottom.start": [100 - length, 0],
        f"{upper}.top.end": [100 - length, 10],
        f"{lower}.bottom.end": [100 + length, -9],
        f"{lower}.clamp.end": [100 + length, -1],
    }
    result = bemcontact.solve(problem.with_values(moved), accuracy=3e-3)
    assert result.certified
    bar = next(bar.bar for bar in result.accuracy.bars if bar.quantity == "force")
    assert bar is not None
    force = 1.4 * compliance(length, 10) / (compliance(length, 10) + compliance(length, 8))
    assert result.footprint.forces["tips"][1] == pytest.approx(force, rel=0.17 * (10 / length) ** 2 + bar)
