"""What is listed of a problem before it is solved."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bemcontact.analysis.check import check
from bemcontact.problem import Problem


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
