"""Rigid surfaces are drawn where they touch the magnified body."""

import numpy as np
import pytest

import bemcontact
from bemcontact.report.figures.surfaces import surfaces_of


@pytest.mark.parametrize("factor", [1.0, 2.0, 10.0])
@pytest.mark.parametrize("lid", [0.0, 0.3])
def test_a_displaced_surface_is_magnified_once(factor, lid):
    """A lid that squeezes a block lies on its top, whose displacements are magnified, wherever the lid is drawn."""
    corners = {"bottom": (0, 0), "right": (4, 0), "top": (4, 5), "left": (0, 5)}
    planes = {"bottom": ((0, 0), (0, 1)), "top": ((0, 5 + lid), (0, -1))}
    result = bemcontact.solve(bemcontact.problem({
        "name": "squeezed",
        "material": {"young_modulus": 8.0, "poisson_ratio": 0.3},
        "boundary": {"outer": [{"name": name, "start": at, "elements": 2} for name, at in corners.items()]},
        "contact_zones": {
            name: {"edges": name, "surface": {"kind": "plane", "point": point, "normal": normal}}
            for name, (point, normal) in planes.items()
        },
        "tools": {"lid": {"zones": "top", "displacement": {"y": -0.12 - lid}}},
        "mesh": {"adapt": False},
    }))  # fmt: skip
    state, problem = result.boundary, result.problem
    assert state is not None
    assert problem is not None
    shape = state.points + factor * state.displacement
    heights = [surface.points[:, 1] for surface in surfaces_of(result, problem, 1.0, factor)]
    np.testing.assert_allclose(heights[0], 0.0, atol=1e-12)
    np.testing.assert_allclose(heights[1], shape[..., 1].max(), rtol=1e-9)
