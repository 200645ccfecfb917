"""Influence coefficients: rigid motions need no traction, and blocks of rows are those of single rows."""

import numpy as np
import pytest
from bodies import MESHES, mesh_of, values_of

from bemcontact.bem import reference_element
from bemcontact.bem.influence import Influence
from bemcontact.bem.rigid_motions import RigidMotions
from bemcontact.bem.system import number_unknowns, place_equations


def no_traction(points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    return np.zeros_like(points)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.49])
def test_rigid_motions_need_no_traction(name, poisson_ratio):
    """F u = 0 for both translations and the rotation, at the nodes and at points inside elements beside corners."""
    mesh = mesh_of(*MESHES[name])
    influence = Influence(mesh=mesh, poisson_ratio=poisson_ratio, traction_elements=np.zeros(0, int))
    clamped = values_of(mesh, dict.fromkeys(mesh.edge_names, "xy"), np.zeros_like, no_traction)
    free = values_of(mesh, {}, np.zeros_like, no_traction)
    motions = RigidMotions(coefficients=np.eye(3), center=mesh.center, radius=mesh.size)
    u = motions.displacement(mesh.nodes)
    for values in (free, clamped):
        collocation = place_equations(mesh, number_unknowns(mesh, values), influence.nodes).collocation
        block = influence.block(collocation, slice(0, len(collocation)))
        xx, yy, xy, yx = block.F
        for k in range(3):
            assert abs(xx.T @ u[:, 0, k] + xy.T @ u[:, 1, k]).max() < 1e-13
            assert abs(yx.T @ u[:, 0, k] + yy.T @ u[:, 1, k]).max() < 1e-13


@pytest.mark.parametrize("held", [{}, {"bottom": "xy", "left": "x"}, {"bottom": "xy", "left": "xy"}])
def test_points_are_on_the_elements_that_are_listed_for_them(held: dict[str, str]):
    """x(ξ0) of each listed element is the point, points ascend, and each is on both elements beside it or on one."""
    mesh = mesh_of(*MESHES["plate with a hole"])
    influence = Influence(mesh=mesh, poisson_ratio=0.3, traction_elements=np.zeros(0, int))
    unknowns = number_unknowns(mesh, values_of(mesh, held, np.zeros_like, no_traction))
    equations = place_equations(mesh, unknowns, influence.nodes)
    points = equations.collocation
    assert (np.diff(points.on_point) >= 0).all()
    nodes = influence.element_nodes[points.on_element]
    there = (reference_element.values(points.on_local) * nodes).sum(axis=1)
    assert abs(there - points.points[points.on_point]).max() < 1e-15
    assert (np.bincount(points.on_point) == 1 + (points.corner >= 0)).all()
    assert sorted(equations.row[equations.row >= 0]) == [*range(unknowns.size)]


def test_blocks_do_not_depend_on_their_size():
    """Rows computed one by one and all at once are the same to round-off, F and G."""
    mesh = mesh_of(*MESHES["plate with a hole"])
    influence = Influence(mesh=mesh, poisson_ratio=0.3, traction_elements=np.arange(0, len(mesh.elements), 2))
    values = values_of(mesh, {"bottom": "xy", "left": "xy"}, np.zeros_like, no_traction)
    collocation = place_equations(mesh, number_unknowns(mesh, values), influence.nodes).collocation
    whole = influence.block(collocation, slice(0, len(collocation)))
    for i in range(len(collocation)):
        alone = influence.block(collocation, slice(i, i + 1))
        assert abs(alone.F[..., 0] - whole.F[..., i]).max() < 1e-13
        assert abs(alone.G[..., 0] - whole.G[..., i]).max() < 1e-13
