"""Machine code and NumPy give the same sums; without numba, NumPy is used."""

import dataclasses
import sys

import numba
import numpy as np
import pytest
from bodies import arc, even, mesh_of, rectangle, segment, solved, values_of, without_rigid_motion

from bemcontact.bem import compiled, influence
from bemcontact.bem.influence import WORTH_COMPILING, Influence
from bemcontact.bem.system import number_unknowns, place_equations
from bemcontact.problem.material import Material

MATERIAL = Material(young_modulus=1000, poisson_ratio=0.3)
STRESS = np.array([[3.0, 1.2], [1.2, -2.0]])
STRAIN = (STRESS - 0.3 * np.trace(STRESS) * np.eye(2)) / (2 * MATERIAL.shear_modulus)
"""Plane strain: 2Gε = σ - ν tr(σ) 1."""

GRADED = np.append(0, np.cumsum(1.05 ** np.arange(100.0))) / np.sum(1.05 ** np.arange(100.0))
"""Element ends with lengths from 1 to 125."""

MESHES = {
    "straight": [rectangle(2, 1, even(60), even(30))],
    "curved": [[("c", arc((0, 0), 1, 0, 360), even(150))]],
    "graded": [[("flat", segment((-1, 0), (1, 0)), GRADED), ("arc", arc((0, 0), 1, 0, 180), GRADED)]],
    "two loops": [rectangle(2, 1, even(40), even(20)), [("hole", arc((1, 0.5), 0.3, 360, 0), even(40))]],
}


def displacement(points):
    return points @ STRAIN.T


def traction(points, normals):
    return normals @ STRESS


@pytest.fixture
def without_numba(monkeypatch):
    """Let every import of numba fail."""
    monkeypatch.setitem(sys.modules, "numba", None)
    compiled.far_sums.cache_clear()
    yield
    compiled.far_sums.cache_clear()


def influence_of(mesh, *, by_numba=None, traction_elements=()):
    return Influence(
        mesh=mesh, poisson_ratio=0.3, traction_elements=np.array(traction_elements, int), by_numba=by_numba
    )


def rows_of(source, fixed):
    """All of F (4, N, c) and G (3, 3, e, c), by way of `each_block`."""
    mesh = source.mesh
    values = values_of(mesh, fixed, displacement, traction)
    collocation = place_equations(mesh, number_unknowns(mesh, values), source.nodes).collocation
    F = np.full((4, len(mesh.nodes), len(collocation)), np.nan)
    G = np.full((3, 3, len(source.traction_elements), len(collocation)), np.nan)

    def keep(block):
        F[..., block.rows], G[..., block.rows] = block.F, block.G

    source.each_block(collocation, keep)
    return F, G


@pytest.mark.parametrize("name", MESHES)
def test_machine_code_and_numpy_agree(name):
    """Both ways agree to round-off of the largest entry. All elements, or those of one stretch, have columns of G."""
    mesh = mesh_of(*MESHES[name])
    m = len(mesh.elements)
    for wanted in (np.arange(m), np.arange(m // 3, 2 * m // 3), np.zeros(0, int)):
        one = influence_of(mesh, by_numba=True, traction_elements=wanted)
        other = dataclasses.replace(one, by_numba=False)
        fixed = {mesh.edge_names[0]: "xy"}
        for compiled_rows, numpy_rows in zip(rows_of(one, fixed), rows_of(other, fixed), strict=True):
            assert np.isfinite(numpy_rows).all()
            largest = abs(numpy_rows).max(initial=0)
            assert abs(compiled_rows - numpy_rows).max(initial=0) <= 1e-14 * largest


def test_loops_without_numba_agree_with_numpy(monkeypatch):
    """The function that numba compiles gives the same result as Python."""
    mesh = mesh_of(rectangle(2, 1, even(16), even(8)))
    by_products = influence_of(mesh, by_numba=False, traction_elements=range(20))
    by_loops = dataclasses.replace(by_products, by_numba=True)
    monkeypatch.setattr(compiled, "far_sums", lambda: compiled.add_far)
    for one, other in zip(rows_of(by_loops, {}), rows_of(by_products, {}), strict=True):
        assert abs(one - other).max() <= 1e-14 * abs(other).max()


def test_only_large_meshes_use_numba():
    small, large = (mesh_of([("c", arc((0, 0), 1, 0, 360), even(count))]) for count in (8, WORTH_COMPILING // 4))
    assert influence_of(small)._far_sums is None
    assert influence_of(large)._far_sums is not None
    assert influence_of(large, by_numba=False)._far_sums is None


@pytest.mark.usefixtures("without_numba")
def test_numpy_is_used_without_numba():
    mesh = mesh_of(*MESHES["curved"])
    wanting = influence_of(mesh, by_numba=True)
    assert wanting._far_sums is None
    F, _ = rows_of(wanting, {})
    assert (rows_of(influence_of(mesh, by_numba=False), {})[0] == F).all()


def test_machine_code_that_cannot_be_cached_is_compiled_again(monkeypatch):
    """Numba refuses to cache where it finds no directory to write to."""

    def njit(function, *, cache=False, **_):
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return function

    monkeypatch.setattr(numba, "njit", njit)
    compiled.far_sums.cache_clear()
    assert compiled.far_sums() is compiled.add_far
    compiled.far_sums.cache_clear()


@pytest.mark.parametrize("fixed", [{}, {"left": "xy"}, {"bottom": "y", "left": "x"}])
def test_constant_stress_is_exact_by_machine_code(fixed, monkeypatch):
    """The patch test, with numba chosen by default."""
    mesh = mesh_of(rectangle(2, 1, GRADED, even(40)))
    monkeypatch.setattr(influence, "WORTH_COMPILING", mesh.degrees_of_freedom)
    u, t, system = solved(mesh, MATERIAL, values_of(mesh, fixed, displacement, traction))
    assert system.influence._far_sums is not None
    du = u - displacement(mesh.nodes)
    du = without_rigid_motion(mesh, du) if len(system.motions) else du
    dt = t - traction(mesh.nodes[mesh.elements], mesh.normals)
    of_stress = np.sqrt(np.sum(mesh.tributary[..., None] * dt**2) / np.sum(mesh.tributary)) / abs(STRESS).max()
    assert abs(du).max() / abs(displacement(mesh.nodes)).max() < 1e-12
    assert of_stress < 1e-12
