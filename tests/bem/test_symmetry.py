"""Lines of symmetry: which edges are one, and that stress beside them has no error of what is computed along them."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from bodies import MESHES, mesh_of
from stress_states import CONSTANT, exact_fields

import bemcontact
from bemcontact.bem.interior import Interior
from bemcontact.bem.mesh import build
from bemcontact.bem.symmetry import SymmetryLine, symmetry_lines
from bemcontact.problems.material import Material

MATERIAL = Material(young_modulus=3.0, poisson_ratio=0.3)
FAR = {"kind": "plane", "point": [0, 99], "normal": [0, -1]}
POINTS = np.array([[1, 0.5], [0.3, 0.9], [1e-6, 0.4], [1.3, 1e-9], [1e-4, 1e-4], [1.999, 0.001]])


def sides(names: list[str]) -> Interior:
    """A rectangle 2 x 1 with some of its sides as lines of symmetry, whatever acts on them."""
    mesh = mesh_of(*MESHES["rectangle, lengths 1:35"])
    place = {"bottom": (1, 0.0, -1.0), "left": (0, 0.0, -1.0), "right": (0, 2.0, 1.0)}
    lines = [SymmetryLine(*place[name], mesh.edge == mesh.edge_names.index(name)) for name in names]
    return Interior(mesh=mesh, poisson_ratio=MATERIAL.effective_poisson_ratio, lines=lines)


@pytest.mark.parametrize("names", [["left"], ["bottom"], ["bottom", "left"], ["right", "left", "bottom"]])
def test_constant_stress_with_shear_along_a_line_and_displacement_across(names: list[str]):
    """Green's identity of the body and its images: exact for any field, also for one that is not symmetric."""
    interior = sides(names)
    found = interior.gradient(interior.z(POINTS), exact_fields(interior.mesh, MATERIAL, CONSTANT))
    true = CONSTANT.stress(POINTS)
    assert abs(found.stress(MATERIAL)[..., 0].T - true).max() < 1e-10 * abs(true).max()


@pytest.mark.parametrize("names", [["left"], ["bottom", "left"]])
def test_what_is_computed_on_a_line_cancels(names: list[str]):
    """Errors of displacement along the line and of traction across it change no stress inside."""
    interior = sides(names)
    fields, rng = exact_fields(interior.mesh, MATERIAL, CONSTANT), np.random.default_rng(1)
    P, D = fields.P.copy(), fields.D.copy()
    for line in interior.lines:
        P[line.elements] += rng.normal(size=P[line.elements].shape) * (1j if line.axis else 1)
        D[line.elements] += rng.normal(size=D[line.elements].shape) * (1 if line.axis else 1j)
    both = fields, replace(fields, P=P, D=D)
    pair = [interior.gradient(interior.z(POINTS), item).stress(MATERIAL) for item in both]
    assert abs(pair[0] - pair[1]).max() < 1e-13 * abs(pair[0]).max()
    bare = Interior(mesh=interior.mesh, poisson_ratio=interior.poisson_ratio)
    spoiled = bare.gradient(bare.z(POINTS), both[1]).stress(MATERIAL)
    assert abs(spoiled - pair[0]).max() > 0.1 * abs(pair[0]).max()


def ring(along: int, across: int) -> bemcontact.Problem:
    """A quarter of a ring with radii 1 and 2 under pressure in its bore."""
    outer = [
        {"name": "rim", "kind": "arc", "center": [0, 0], "radius": 2, "angles": [0, 90], "elements": along},
        {"name": "y axis", "start": [0, 2], "elements": across},
        {"name": "bore", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [90, 0], "elements": along},
        {"name": "x axis", "start": [1, 0], "elements": across},
    ]
    return bemcontact.Problem(
        name="ring", accuracy=None, material={"young_modulus": 1000, "poisson_ratio": 0.3}, boundary={"outer": outer},
        conditions={
            "bore": {"pressure": 3}, "y axis": {"displacement": {"x": 0}}, "x axis": {"displacement": {"y": 0}},
        },
        contact_zones={"far": {"edges": "rim", "surface": FAR}},
    )  # fmt: skip


@pytest.mark.parametrize("away", [0.0, 1e-6, 0.03])
def test_order_two_on_and_beside_lines_of_symmetry(away: float):
    """Lamé's σr, σφ = p (1 ∓ 4/r²)/3, with elements half as long on all edges: order 2 in a body with corners.

    From the computed displacement along the line the order was 1.5, and the error of the first mesh 7 times as large.
    """
    radii, errors = np.linspace(1.1, 1.9, 33), []
    points = np.vstack([np.column_stack([radii, away + 0 * radii]), np.column_stack([away + 0 * radii, radii])])
    r2 = np.sum(points**2, axis=1)
    true = np.column_stack([1 - 4 * (points**2 * [[1, -1]]).sum(axis=1) / r2**2, -8 * points.prod(axis=1) / r2**2])
    for count in (4, 8, 16):
        found = bemcontact.solve(ring(count, count // 2)).stress(points).components
        errors.append(abs(found[:, [0, 2]] - true).max() / (1 + 4 / 1.1**2))
    assert errors[0] < 2e-3
    for coarse, fine in pairwise(errors):
        assert np.log2(coarse / fine) > 2


def test_stress_of_edges_is_that_of_points():
    """On a line of symmetry both are those of the inside."""
    result = bemcontact.solve(ring(4, 4))
    edge = result.boundary_stress()["x axis"]
    middles = result.stress(edge.points[:, 1])
    assert edge.von_mises[:, 1] == pytest.approx(middles.von_mises, rel=1e-12)
    assert (middles.kind == "boundary").all()
    assert abs(middles.components[:, 2]).max() < 1e-9


def lines_of(conditions: dict, **places: list[float]) -> dict[int, tuple]:
    """Axis, place and direction of the lines of an L of 2 x 2 with a notch from (1, 1), by the first edge on each."""
    ends = {"bottom": [0, 0], "right": [2, 0], "arm": [2, 1], "inner": [1, 1], "top": [1, 2], "left": [0, 2]} | places
    body = bemcontact.Problem(
        name="L", material={"young_modulus": 1, "poisson_ratio": 0.3}, conditions=conditions,
        boundary={"outer": [{"name": name, "start": start, "elements": 2} for name, start in ends.items()]},
        contact_zones={"far": {"edges": "top", "surface": FAR}},
    )  # fmt: skip
    mesh = build(body)
    lines = symmetry_lines(body, mesh)
    return {mesh.edge_names[mesh.edge[np.argmax(line.elements)]]: tuple(line[:3]) for line in lines}


def test_which_edges_are_lines_of_symmetry():
    """Straight ones that are held across alone, with the body on one side of them; shear may act along them."""
    held = {"left": {"displacement": {"x": 0}}, "bottom": {"displacement": {"y": {"x": 0.1}}, "traction": {"x": 1}}}
    assert lines_of(held) == {"left": (0, 0, -1), "bottom": (1, 0, -1)}
    assert lines_of({"inner": {"displacement": {"x": 0}}, "left": {"displacement": {"x": 0, "y": 0}}}) == {}
    assert lines_of({"bottom": {"displacement": {"x": 0}}, "right": {"displacement": {"x": 0}}}) == {"right": (0, 2, 1)}
    assert lines_of({"left": {"displacement": {"x": 0}}}, left=[0.1, 2]) == {}
