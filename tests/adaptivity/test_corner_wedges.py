"""Wedges that meet at a place of a mesh."""

import numpy as np
import pytest
from several_bodies import block, elastic, rigid, stated

from bemcontact.adaptivity.corner_wedges import around, wedges_at
from bemcontact.adaptivity.wedge_exponents import BONDED, FREE
from bemcontact.bem.mesh import build

FOUR = (2, 2, 2, 2)


def quarters(moduli):
    """Four blocks that are bonded around the origin, under a rigid block, and their mesh."""
    places = {"a": ((0, 1), (0, 1)), "b": ((-1, 0), (0, 1)), "c": ((-1, 0), (-1, 0)), "d": ((0, 1), (-1, 0))}
    bodies = {
        name: elastic(block(*place, FOUR), None, modulus)
        for (name, place), modulus in zip(places.items(), moduli, strict=True)
    }
    bonds = {
        "ab": ["a/left", "b/right"],
        "bc": ["b/bottom", "c/top"],
        "cd": ["c/right", "d/left"],
        "da": ["d/top", "a/bottom"],
    }
    for name in "cd":
        bodies[name]["conditions"] = {"bottom": {"fixed": True}}
    bodies["ram"] = rigid(block((-2, 2), (1, 2)))
    contacts = {name: {"between": [f"{name}/top", "ram/bottom"]} for name in "ab"}
    problem = stated(name="quarters", bodies=bodies, bonded=bonds, contacts=contacts)
    return problem, build(problem)


def start_at(mesh, problem, body, place):
    """The element of a body that starts at a place."""
    number = [part.name for part in problem.parts].index(body)
    (found,) = np.flatnonzero((mesh.part == number) & np.all(mesh.nodes[: len(mesh.elements)] == place, axis=1))
    return int(found)


def face(across):
    """Bonded where another body is, else free."""
    return lambda element, _: BONDED if across[element] >= 0 else FREE


@pytest.mark.parametrize("body", "abcd")
def test_bonded_bodies_around_a_place_close_a_ring(body):
    """Counterclockwise from any of them."""
    problem, mesh = quarters((1, 2, 3, 4))
    across = mesh.across(problem.bonded)
    starts, closed = around(mesh, across, start_at(mesh, problem, body, (0, 0)))
    assert closed
    names = "".join(problem.parts[mesh.part_of(start)].name for start in starts)
    assert names in "abcdabc"
    assert names[0] == body
    wedges, ends = wedges_at(problem, mesh, across, starts[0], face(across))
    assert wedges.own == 0
    assert [wedge.stiffness for wedge in wedges.wedges] == pytest.approx(
        [("abcd".index(name) + 1) / ("abcd".index(body) + 1) for name in names]
    )
    assert [wedge.angle for wedge in wedges.wedges] == pytest.approx([np.pi / 2] * 4)
    assert [after for after, _ in ends] == starts


def test_bonded_wedges_of_one_material_are_one():
    """Also over the first face of the first one, and three quarters beside one that is unlike."""
    for moduli, own, angles in (
        ((1, 1, 1, 1), 0, [2 * np.pi]),
        ((2, 1, 2, 2), 0, [3 * np.pi / 2, np.pi / 2]),
        ((1, 2, 2, 2), 0, [np.pi / 2, 3 * np.pi / 2]),
    ):
        problem, mesh = quarters(moduli)
        across = mesh.across(problem.bonded)
        wedges, ends = wedges_at(problem, mesh, across, start_at(mesh, problem, "a", (0, 0)), face(across))
        assert wedges.closed
        assert wedges.own == own
        assert sorted(wedge.angle for wedge in wedges.wedges) == pytest.approx(sorted(angles))
        assert wedges.at.stiffness == 1
        assert len(ends) == len(angles)


@pytest.mark.parametrize("body", "bc")
def test_wedges_at_a_free_surface_are_an_open_row(body):
    """From the free face of the lower body to that of the upper one, whichever is asked for."""
    problem, mesh = quarters((1, 2, 3, 4))
    across = mesh.across(problem.bonded)
    wedges, _ = wedges_at(problem, mesh, across, start_at(mesh, problem, body, (-1, 0)), face(across))
    assert not wedges.closed
    assert [wedge.faces for wedge in wedges.wedges] == [(FREE, BONDED), (BONDED, FREE)]
    assert wedges.wedges[wedges.own].stiffness == 1
    assert wedges.wedges[0].stiffness / wedges.wedges[1].stiffness == pytest.approx(3 / 2)
