"""Elements and their joints."""

import numpy as np
import pytest
from bodies import mesh_of, rectangle

from bemcontact.bem import mesh
from bemcontact.problems import Problem

PLANE = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}


def test_inner_angles_are_those_of_the_body():
    """Along edges π; a corner of 3-4-5 triangles atan(4/3), a right angle, and 3π/2 around a square hole."""
    triangle = [("bottom", [0, 0]), ("slope", [30, 0]), ("left", [0, 40])]
    hole = [("west", [5, 5]), ("north", [5, 10]), ("east", [10, 10]), ("south", [10, 5])]
    loops = [[{"name": name, "start": start, "elements": 2} for name, start in loop] for loop in (triangle, hole)]
    problem = Problem.model_validate(
        {
            "name": "triangle with a hole",
            "material": {"young_modulus": 1, "poisson_ratio": 0.3},
            "boundary": {"outer": loops[0], "holes": [loops[1]]},
            "contact_zones": {"foot": {"edges": "bottom", "surface": PLANE}},
        }
    )
    slope = np.arctan2(4, 3)
    corners = [np.pi / 2, slope, np.pi / 2 - slope, *[3 * np.pi / 2] * 4]
    assert mesh.build(problem).inner_angles == pytest.approx(np.ravel([(corner, np.pi) for corner in corners]))


def test_a_place_in_a_sentence_has_no_round_off():
    """Below the middle of an arc from 180 to 360 degrees x is zero; a thousandth of the size is not."""
    arc = {"name": "dome", "kind": "arc", "center": [0, 0], "radius": 4, "angles": [180, 360], "elements": 8}
    edges = [arc, {"name": "foot", "elements": 2}]
    zones = {"lid": {"edges": "dome", "surface": {"kind": "plane", "point": [0, -4], "normal": [0, 1]}}}
    made = {"name": "dome", "material": {"young_modulus": 1, "poisson_ratio": 0.3}, "boundary": {"outer": edges}}
    built = mesh.build(Problem.model_validate({**made, "contact_zones": zones}))
    assert built.place(built.nodes[np.argmin(built.nodes[:, 1])]) == (0.0, -4.0)
    assert built.place([1e-14, 0.004]) == (0.0, 0.004)


def test_nodes_of_elements_are_those_of_their_rows():
    """Each node once, in order, also those that two elements share."""
    shape = mesh_of(rectangle(3.0, 1.0, [0, 0.3, 0.6, 1], [0, 1]))
    for elements in ([], [0], [1, 0], [7, 0, 3]):
        assert shape.nodes_of(np.array(elements, int)).tolist() == np.unique(shape.elements[elements]).tolist()
