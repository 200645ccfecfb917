"""Fields that the elements represent exactly: constant stress, rigid motion."""

import numpy as np
import pytest
from bodies import arc, even, mesh_of, rectangle, segment, solved, values_of, without_rigid_motion

from bemcontact.bem.contact_points import element_lengths
from bemcontact.bem.influence import Influence
from bemcontact.bem.rigid_motions import RigidMotions
from bemcontact.bem.system import number_unknowns, place_equations
from bemcontact.problem.problem import Material

MATERIAL = Material(young_modulus=1000, poisson_ratio=0.3)
STRESS = np.array([[3.0, 1.2], [1.2, -2.0]])
STRAIN = (STRESS - 0.3 * np.trace(STRESS) * np.eye(2)) / (2 * MATERIAL.shear_modulus)
"""Plane strain: 2Gε = σ - ν tr(σ) 1."""
GRADIENT = STRAIN + np.array([[0, -0.001], [0.001, 0]])

ABRUPT = np.append(0, np.cumsum([1.0, 35, 1, 35, 35, 1, 1, 35])) / 144
"""Element ends whose lengths jump by 35, next to corners too."""

MESHES = {
    "rectangle": [rectangle(2, 1, even(6), even(3))],
    "rectangle, lengths 1:35": [rectangle(2, 1, ABRUPT, ABRUPT)],
    "circle of four elements": [[("c", arc((0, 0), 1, 0, 360), even(4))]],
    "circle of eight elements": [[("c", arc((0, 0), 1, 0, 360), even(8))]],
    "circle, lengths 1:35": [[("c", arc((0, 0), 1, 0, 360), ABRUPT)]],
    "half disc, lengths 1:35": [[("flat", segment((-1, 0), (1, 0)), even(4)), ("arc", arc((0, 0), 1, 0, 180), ABRUPT)]],
    "plate with a hole": [rectangle(2, 1, ABRUPT, even(4)), [("hole", arc((1, 0.5), 0.3, 360, 0), even(8))]],
    "ligament of 0.01": [rectangle(2, 1, even(20), even(10)), [("hole", arc((1, 0.5), 0.49, 360, 0), even(12))]],
}
FIXED = {
    "traction": lambda names: {},
    "displacement": lambda names: dict.fromkeys(names, "xy"),
    "one edge clamped": lambda names: {names[0]: "xy"},
    "clamp beside roller": lambda names: {names[0]: "xy", names[-1]: "x"},
    "rollers": lambda names: {names[0]: "y", names[-1]: "x"},
}


def displacement(points):
    return points @ GRADIENT.T + np.array([0.002, -0.001])


def traction(points, normals):
    return normals @ STRESS


def errors(loops, fixed, gradient_scale=1.0):
    """Relative errors: largest of displacement, and of traction in the mean square along the boundary."""
    mesh = mesh_of(*loops)
    u, t, system = solved(mesh, MATERIAL, values_of(mesh, fixed(mesh.edge_names), displacement, traction))
    du = u - displacement(mesh.nodes)
    du = without_rigid_motion(mesh, du) if len(system.motions) else du
    dt = t - traction(mesh.nodes[mesh.elements], mesh.normals)
    of_stress = np.sqrt(np.sum(mesh.tributary[..., None] * dt**2) / np.sum(mesh.tributary)) / abs(STRESS).max()
    return abs(du).max() / abs(displacement(mesh.nodes)).max(), of_stress


@pytest.mark.parametrize("conditions", FIXED)
@pytest.mark.parametrize("name", MESHES)
def test_constant_stress_is_exact(name, conditions):
    """Interpolating t·J, the method reproduces constant stress on straight and curved elements to round-off."""
    assert max(errors(MESHES[name], FIXED[conditions])) < 1e-12


@pytest.mark.parametrize("conditions", FIXED)
def test_thin_strip(conditions):
    """2 x 0.01, elements ten times longer than the strip is thick; bending costs (length/thickness)² of round-off."""
    assert max(errors([rectangle(2, 0.01, even(20), even(1))], FIXED[conditions])) < 1e-11


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.49])
def test_rigid_motions_need_no_traction(name, poisson_ratio):
    """F u = 0 for both translations and the rotation, at the nodes and at points inside elements beside corners."""
    mesh = mesh_of(*MESHES[name])
    influence = Influence(mesh=mesh, poisson_ratio=poisson_ratio, traction_elements=np.zeros(0, int))
    clamped = values_of(mesh, dict.fromkeys(mesh.edge_names, "xy"), displacement, traction)
    free = values_of(mesh, {}, displacement, traction)
    motions = RigidMotions(coefficients=np.eye(3), center=mesh.center, radius=mesh.size)
    u = motions.displacement(mesh.nodes)
    for values in (free, clamped):
        collocation = place_equations(mesh, number_unknowns(mesh, values), influence.nodes).collocation
        block = influence.block(collocation, slice(0, len(collocation)))
        xx, yy, xy, yx = block.F
        for k in range(3):
            assert abs(xx.T @ u[:, 0, k] + xy.T @ u[:, 1, k]).max() < 1e-13
            assert abs(yx.T @ u[:, 0, k] + yy.T @ u[:, 1, k]).max() < 1e-13


def test_blocks_do_not_depend_on_their_size():
    """Rows computed one by one and all at once are the same to round-off, F and G."""
    mesh = mesh_of(*MESHES["plate with a hole"])
    influence = Influence(mesh=mesh, poisson_ratio=0.3, traction_elements=np.arange(0, len(mesh.elements), 2))
    values = values_of(mesh, {"bottom": "xy", "left": "xy"}, displacement, traction)
    collocation = place_equations(mesh, number_unknowns(mesh, values), influence.nodes).collocation
    whole = influence.block(collocation, slice(0, len(collocation)))
    for i in range(len(collocation)):
        alone = influence.block(collocation, slice(i, i + 1))
        assert abs(alone.F[..., 0] - whole.F[..., i]).max() < 1e-13
        assert abs(alone.G[..., 0] - whole.G[..., i]).max() < 1e-13


def test_element_lengths_are_arc_lengths():
    """A circle of 64 elements: the parabola is shorter than the arc by less than (angle)^4/480, relative."""
    mesh = mesh_of([("c", arc((0, 0), 2, 0, 360), even(64))])
    exact = 2 * np.pi / 32
    assert abs(element_lengths(mesh) / exact - 1).max() < (2 * np.pi / 64) ** 4 / 480
