"""Samples of elements, some of which are moved to where a surface is near."""

from pathlib import Path

import numpy as np
import pytest

from bemcontact import load
from bemcontact.bem.discretization import body_of

GALLERY = Path(__file__).parents[2] / "models" / "gallery"


@pytest.mark.parametrize("name", ["hertz_small", "roller_in_v_block", "cam_on_follower"])
def test_quadratics_are_interpolated_exactly(name):
    """From their values at the nodes ξ = -1, 0, 1 of each element, wherever its samples are."""
    outline = body_of(load(GALLERY / f"{name}.yaml", variant="stated mesh")).outline
    factors = np.random.default_rng(5).standard_normal((len(outline.mesh.elements), 2, 3))

    def quadratics(xi):
        """Two of each element (m, q, 2)."""
        return np.einsum("mqj,mxj->mqx", xi[..., None] ** np.arange(3), factors)

    at_nodes = quadratics(np.tile([-1.0, 0.0, 1.0], (len(factors), 1)))
    np.testing.assert_allclose(outline.interpolated(at_nodes), quadratics(outline.local), rtol=0, atol=1e-14)
    np.testing.assert_allclose(outline.shapes @ at_nodes, quadratics(outline.local), rtol=0, atol=1e-14)
