"""What is listed of a problem before it is solved."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from messages import assert_states
from several_bodies import HELD, block, elastic, problem

from bemcontact.analysis.check import check
from bemcontact.problems import Problem


@settings(max_examples=25, deadline=None)
@given(
    st.floats(1.0, 9.0),
    st.floats(-0.1, 2.0),
    st.sampled_from(["circle", "polyline"]),
    st.floats(0, 2 * np.pi),
    st.sampled_from([None, 1, 7]),
    st.sampled_from([["bottom"], None]),
)
def test_the_smallest_gap_is_that_of_the_curve_and_not_of_its_nodes(at, gap, kind, turn, elements, edges):
    """A disk or the tip of a wedge below a side of a block, between nodes or not, however it is turned."""

    def place(x, y):
        return float(np.cos(turn) * x - np.sin(turn) * y), float(np.sin(turn) * x + np.cos(turn) * y)

    corners = {"bottom": (0, 0), "right": (10, 0), "top": (10, 20), "left": (0, 20)}
    surface = (
        {"kind": "circle", "center": place(at, -gap - 0.5), "radius": 0.5, "body": "outside"}
        if kind == "circle"
        else {"kind": "polyline", "points": [place(at - 8, -gap - 4), place(at, -gap), place(at + 8, -gap - 4)]}
    )
    outer = [{"name": name, "start": place(*start), "elements": elements} for name, start in corners.items()]
    problem = Problem.model_validate(
        {
            "name": "block",
            "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
            "boundary": {"outer": outer},
            "conditions": {"top": {"displacement": {"x": 0, "y": 0}}},
            "contact_zones": {"foot": {"surface": surface, **({"edges": edges} if edges else {})}},
        }
    )
    assert check(problem).smallest_gaps["foot"] == pytest.approx(gap, abs=1e-6)


def stacked(overlap: float, gap: float = 0.0, **material: str) -> tuple[str, ...]:
    """Notes on a block of the size 5 on a larger one, which is drawn this far into it."""
    low, up = elastic(block((-5, 5), (-5, 0), (9,) * 4), HELD), elastic(block((-2, 2), (-overlap, 3), (4,) * 4))
    up["conditions"] = {"top": {"pressure": 1.0}}
    up["material"] |= material
    return check(problem({"low": low, "up": up}, face={"between": ["up/bottom", "low/top"], "gap": gap})).notes


@pytest.mark.parametrize(
    ("overlap", "gap", "facts"),
    [
        (0.5, 0.0, "'up' and 'low' overlap by 0.5 in 'face' as they are drawn, 9.4 % of the size of 'up'…interference"),
        (0.0, -0.5, "overlap by 0.5 in 'face' with gap: -0.5, 10 % of the size of 'up'…or correct gap"),
        (0.5, 0.48, ""),  # as large as usual interferences
        (0.049, 0.0, ""),
        (-1.0, 0.0, ""),
    ],
)
def test_a_large_overlap_of_bodies_in_contact_is_noted(overlap, gap, facts):
    notes = [note for note in stacked(overlap, gap) if "interference" in note]
    assert len(notes) == bool(facts)
    for note in notes:
        assert_states(note, facts)


def test_two_plane_states_in_one_problem_are_noted():
    (note,) = [note for note in stacked(0.0, state="plane_stress") if "plane states" in note]
    assert_states(note, "'low' in plane strain, and 'up' in plane stress…per thickness…the same state")
    assert not [note for note in stacked(0.0) if "plane" in note]
