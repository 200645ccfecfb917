"""What bisecting every element changes: nothing where the answer is in the space of the elements."""

import numpy as np
import pytest
from adaptive_problems import block_on_flat_floor, half_disk

from bemcontact.adaptivity.fields import MeshDifference, halves, norm_squared, penetrations, solved
from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.problems import Problem


def difference(problem: Problem) -> MeshDifference:
    """The first mesh and its halves."""
    coarse = first_mesh(problem)
    fine = coarse.model_copy(update={"mesh": coarse.mesh.model_copy(update={"refine": 2})})
    return MeshDifference(coarse=solved(coarse), fine=solved(fine), number=0)


def test_halves_prolong_quadratics_exactly():
    """Values of a quadratic at -1, 0, 1 become those at -1, -1/2, 0 and 0, 1/2, 1, whatever axes follow."""
    rng = np.random.default_rng(1)
    coefficients = rng.normal(size=(4, 3, 2))

    def at(xi: list[float]) -> np.ndarray:
        return np.einsum("mjx,jk->mkx", coefficients, np.array([np.ones(3), xi, np.square(xi)]))

    found = halves(at([-1, 0, 1]))
    assert found[0::2] == pytest.approx(at([-1, -0.5, 0]))
    assert found[1::2] == pytest.approx(at([0, 0.5, 1]))


def test_halves_of_scalars_have_the_shape_of_scalars():
    assert halves(np.arange(6.0).reshape(2, 3)).tolist() == [[0, 0.5, 1], [1, 1.5, 2], [3, 3.5, 4], [4, 4.5, 5]]


@pytest.fixture(scope="module")
def patch() -> MeshDifference:
    return difference(block_on_flat_floor()[0])


def test_a_patch_test_changes_by_nothing(patch: MeshDifference):
    """Uniform pressure and linear displacements are in the space of the elements: what changes is round-off."""
    coarse = patch.coarse
    one, two = patch.pair
    norm = norm_squared(coarse, one.pressure[0]).sum()
    assert norm == pytest.approx(7.0**2 * 40, rel=1e-9)
    assert patch.pressure_squared.sum() < 1e-16 * norm
    assert two.displacement == pytest.approx(halves(one.displacement), abs=1e-8 * np.abs(one.displacement).max())
    shear = patch.fine.body.problem.material.shear_modulus
    assert patch.energy.sum() < 1e-16 * 7.0**2 / shear * 120**2


def test_the_weights_integrate_along_the_boundary(patch: MeshDifference):
    """Its length is 120."""
    assert patch.coarse.weights.sum() == pytest.approx(120, rel=1e-12)
    assert patch.fine.weights.sum() == pytest.approx(120, rel=1e-12)


def test_contact_on_an_arc_changes_and_its_stretch_is_found():
    """Half of a disk: one stretch from the axis to a free end; the pressure changes most in its elements."""
    changed = difference(half_disk(2000.0))
    one, _ = changed.pair
    (stretch,) = one.stretches[0]
    assert (stretch.start, stretch.start_free, stretch.end_free) == (0.0, False, True)
    touching = (one.pressure[0] > 0).any(axis=1)
    squares = changed.pressure_squared[0]
    assert squares.sum() > 0
    assert squares[touching].sum() > squares[~touching].sum()


def test_fields_of_a_stretch_are_zero_outside_the_zone():
    changed = difference(half_disk(2000.0))
    one, _ = changed.pair
    assert (one.pressure[0][~changed.coarse.in_zone[0]] == 0).all()


def shaft(clearance: float, held: bool = False) -> Problem:
    """A shaft on eight elements that hangs in a hole, by its weight or held on top."""
    halves = [("top", (0, 180)), ("bottom", (180, 360))]
    rim = [
        {"name": name, "kind": "arc", "center": (0, 0), "radius": 1.0, "angles": angles, "elements": 4}
        for name, angles in halves
    ]
    return Problem.model_validate(
        {
            "name": "shaft",
            "material": {"young_modulus": 1000.0, "poisson_ratio": 0.3},
            "boundary": {"outer": rim},
            "conditions": {"top": {"displacement": {"x": 0, "y": 0}}} if held else {},
            "loads": {"gravity": {"density": 1e-3, "acceleration": (0, -1)}},
            "contact_zones": {
                "hole": {
                    "edges": "bottom",
                    "surface": {"kind": "circle", "center": (0, clearance), "radius": 1 + clearance, "body": "inside"},
                }
            },
            "mesh": {"adapt": False},
        }
    )


@pytest.mark.parametrize("held", [False, True])
def test_the_gap_between_nodes_is_that_of_the_curve(held: bool):
    """A quarter of a right angle bulges by 6e-4 beyond its quadratic element; the arcs themselves do not cross.

    The nodes at the ends of the zone that are held have no contact point, and their gap is known all the same.
    """
    answer = solved(shaft(1e-3, held))
    body = answer.mesh
    bulge = np.hypot(*(np.array([3 / 8, 3 / 4, -1 / 8]) @ body.nodes[body.elements[0]])) - 1
    assert abs(bulge) > 1e-4
    assert not [*penetrations(answer, answer.answers[0])]


def test_a_tool_that_comes_between_two_nodes_is_seen_where_it_has_moved():
    """A small disk below a wide element does not reach the nodes, and the element sinks into it by what it moves."""
    bottom = {"name": "bottom", "start": (0, 0), "elements": 2}
    corners = {"right": (8, 0), "top": (8, 4), "left": (0, 4)}
    problem = Problem.model_validate(
        {
            "name": "block",
            "material": {"young_modulus": 1000.0, "poisson_ratio": 0.3},
            "boundary": {"outer": [bottom, *({"name": k, "start": at, "elements": 2} for k, at in corners.items())]},
            "conditions": {"top": {"displacement": {"x": 0, "y": 0}}},
            "contact_zones": {
                "pin": {
                    "edges": "bottom",
                    "surface": {"kind": "circle", "center": (1, -0.6), "radius": 0.5, "body": "outside"},
                }
            },
            "tools": {"pin": {"zones": "pin", "displacement": {"y": 0.15}}},
            "mesh": {"adapt": False},
        }
    )
    answer = solved(problem)
    [(element, depth)] = penetrations(answer, answer.answers[0])
    assert answer.mesh.edge_names[answer.mesh.edge[element]] == "bottom"
    assert depth == pytest.approx(0.05, rel=1e-9)
