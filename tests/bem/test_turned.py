"""The same problem turned, mirrored, moved and in other units has the same answer, to round-off."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact import solve
from bemcontact.problem import Problem

CORNERS = {"foot": (0, 0), "right": (4, 0), "top": (4, 2), "left": (1, 2.5)}
"""Corners of the body, and the edges that begin there; the right one is an arc about (1, 1)."""


def body(held, load, turn=0.0, mirrored=False, length=1.0, stress=1.0, shift=(0.0, 0.0)):
    """A body with a hole on a floor, held on some edges or on none, under traction and a load on its volume."""
    c, s, m = np.cos(turn), np.sin(turn), -1.0 if mirrored else 1.0

    def vector(x, y):
        return np.array([c * m * x - s * y, s * m * x + c * y])

    def at(x, y):
        return length * (vector(x, y) + shift)

    names, corners = [*CORNERS], [*CORNERS.values()]
    if mirrored:  # run through the other way
        names, corners = names[::-1], [corners[0], *corners[:0:-1]]
    edges = [
        {"name": name, "start": tuple(at(*corner)), "elements": 3} for name, corner in zip(names, corners, strict=True)
    ]
    next(edge for edge in edges if edge["name"] == "right").update(kind="arc", center=tuple(at(1, 1)))
    first = np.degrees(np.arctan2(*vector(1, 0)[::-1]))
    bore = {"name": "bore", "kind": "arc", "center": tuple(at(2.3, 1.2)), "radius": 0.4 * length, "elements": 8}
    gradient = vector(3, 5) / length
    loads = {
        "gravity": {"density": stress / length, "acceleration": tuple(vector(0.1, -1.0))},
        "centrifugal": {"density": stress / length**2, "angular_velocity": 0.4, "center": tuple(at(2, 3))},
        "temperature": {
            "expansion": 1e-4,
            "change": {"constant": 7 - gradient @ at(0, 0), "x": gradient[0], "y": gradient[1]},
        },
    }
    push = stress * vector(0.1 if held else 0.0, -2.0)
    return Problem.model_validate(
        {
            "name": "turned",
            "material": {"young_modulus": 1000.0 * stress, "poisson_ratio": 0.3},
            "boundary": {"outer": edges, "holes": [[{**bore, "angles": (first + 360, first)}]]},
            "conditions": {
                "top": {"traction": {"x": push[0], "y": push[1]}},
                **{name: {"displacement": {"x": 0.0, "y": 0.0}} for name in held},
            },
            "loads": {load: loads[load]},
            "contact_zones": {
                "floor": {
                    "edges": "foot",
                    "surface": {"kind": "plane", "point": tuple(at(0, -1e-4)), "normal": tuple(vector(0, 1))},
                }
            },
            "mesh": {"adapt": False},
        }
    )


def sizes(problem, length, stress):
    """Pressures, and sizes of displacements and tractions, in units without name, sorted."""
    result = solve(problem)
    state = result.boundary
    assert state is not None
    displacement, traction = (
        np.sort(np.hypot(*np.moveaxis(field, 2, 0)).ravel()) for field in (state.displacement, state.traction)
    )
    return np.sort(result.solution.pressure) / stress, displacement / length, traction / stress


@pytest.mark.parametrize("held", [("left",), ("right",), ("left", "right")])
@pytest.mark.parametrize("load", ["gravity", "centrifugal", "temperature"])
@settings(max_examples=4, deadline=None)
@given(
    turn=st.floats(-3, 3), mirrored=st.booleans(), length=st.sampled_from([1e-3, 1.0, 25.4]),
    stress=st.sampled_from([1.0, 6894.76]), shift=st.tuples(st.floats(-10, 10), st.floats(-10, 10)),
)  # fmt: skip
def test_a_held_body_has_the_same_answer(held, load, turn, mirrored, length, stress, shift):
    """On a coarse mesh too: its errors turn with it. Corners between held and free edges are among the nodes."""
    expected = sizes(body(held, load), 1.0, 1.0)
    found = sizes(body(held, load, turn, mirrored, length, stress, shift), length, stress)
    assert expected[0].max() > 0
    for one, other in zip(expected, found, strict=True):
        assert other == pytest.approx(one, rel=0, abs=1e-9 * one.max())
