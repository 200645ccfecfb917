"""The gradient on the boundary: constant fields, order of convergence, and that it does not jump at smooth ends."""

import numpy as np
import pytest
from bodies import MESHES, arc, even, mesh_of, rectangle
from stress_states import CONSTANT, SMOOTH, below, exact_fields

from bemcontact.bem.boundary_gradient import BoundaryFields
from bemcontact.bem.mesh import Mesh
from bemcontact.problems.material import Material

MATERIALS = [Material(young_modulus=3.0, poisson_ratio=nu, state=state) for nu, state in
             ((0.3, "plane_strain"), (0.499, "plane_strain"), (0.5, "plane_stress"))]  # fmt: skip
LOCAL = (-1.0, -0.6, 0.0, 1.0)


def errors(mesh: Mesh, material: Material, state=SMOOTH) -> np.ndarray:
    """Errors (4, m) of the stress of a state at `LOCAL` of each element, with its exact values at the nodes."""
    fields, own = exact_fields(mesh, material, state), np.arange(len(mesh.elements))
    found = [fields.gradient(own, np.full(len(own), local)).stress(material)[..., 0].T for local in LOCAL]
    true = [state.stress(below(mesh, local, 0)) for local in LOCAL]
    return abs(np.array(found) - np.array(true)).max(axis=2)


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("name", MESHES)
def test_constant_stress(name: str, material: Material):
    """Exact, on coarse curved elements and beside lengths of 1:35 too, up to round-off of u over the shortest one."""
    bulk = 1 / (1 - 2 * material.effective_poisson_ratio)
    assert errors(mesh_of(*MESHES[name]), material, CONSTANT).max() < 1e-11 * bulk


@pytest.mark.parametrize(
    "loops",
    [
        lambda count: [("c", arc((0, 0), 1, 0, 360), even(count))],
        lambda count: [("c", arc((0, 0), 1, 0, 360), np.cumsum(np.append(0, np.tile([1, 3], count // 2))) / 2 / count)],
        lambda count: rectangle(1, 1, even(count), even(count)),
    ],
    ids=["circle", "circle of lengths 1:3", "square"],
)
def test_order(loops):
    """Order four at nodes and three between, with exact nodal values, at corners of the square and beside them too."""
    coarse, fine = (errors(mesh_of(loops(count)), MATERIALS[0]).max(axis=1) for count in (32, 128))
    order = np.log2(coarse / fine) / 2
    assert order[1] > 2.8
    assert min(order[[0, 2, 3]]) > 3.8


def test_gradient_does_not_jump_at_smooth_ends():
    """It is the same from both sides of an end."""
    mesh = mesh_of([("c", arc((0, 0), 1, 0, 360), even(8))])
    fields, own = exact_fields(mesh, MATERIALS[0], SMOOTH), np.arange(len(mesh.elements))
    after = fields.gradient(own, np.full(len(own), -1.0)).stress(MATERIALS[0])
    before = fields.gradient(mesh.before, np.full(len(own), 1.0)).stress(MATERIALS[0])
    assert abs(after - before).max() < 1e-12 * abs(after).max()


def test_integrals_over_elements_stay():
    """The change of displacement over each element and the force on it are those of the nodal values."""
    mesh = mesh_of(*MESHES["half disc, lengths 1:35"])
    rng = np.random.default_rng(2)
    u, t = rng.normal(size=(len(mesh.nodes), 2, 1)), rng.normal(size=(len(mesh.elements), 3, 2, 1))
    smooth = mesh.edge == mesh.edge[mesh.before]
    fields, raw = (BoundaryFields.of(mesh, MATERIALS[0], u, t, some) for some in (smooth, np.zeros_like(smooth)))
    for one, other in ((fields.D, raw.D), (fields.P, raw.P)):
        share = np.array([1, 4, 1])[:, None] / 3
        assert abs(np.sum(share * (one - other), axis=1)).max() < 1e-12 * abs(other).max()
