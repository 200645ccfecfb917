"""The elastic wedges around a place of a mesh: that of a body, and those that it touches or is bonded to there."""

from collections.abc import Callable

import numpy as np

from bemcontact.adaptivity.wedge_exponents import Face, Wedge, Wedges
from bemcontact.arrays import IntArray
from bemcontact.bem.mesh import Mesh
from bemcontact.problems.problem import Problem

CRACK = 1e-6
"""Angle between two faces [rad] that are those of a crack."""

FaceAt = Callable[[int, float], Face]
"""What holds the face with an element, from the direction of the boundary there [rad]."""


def wedge_at(problem: Problem, mesh: Mesh, after: int, face: FaceAt) -> Wedge:
    """The wedge of the body where an element starts."""
    before = int(mesh.before[after])
    leaves = arrives = mesh.tangents[after, 0]  # edges are smooth
    if mesh.edge[after] != mesh.edge[before]:
        leaves = problem.edge(mesh.edge_names[mesh.edge[after]]).directions(np.array([0.0]))[0]
        arrives = problem.edge(mesh.edge_names[mesh.edge[before]]).directions(np.array([1.0]))[0]
    start, end = (float(np.arctan2(y, x)) for x, y in (leaves, arrives))
    angle = float(np.mod(end + np.pi - start, 2 * np.pi))
    faces, material = (face(after, start), face(before, end)), problem.parts[mesh.part_of(after)].material
    angle = 2 * np.pi if angle < CRACK else angle
    return Wedge(start, angle, faces, material.effective_poisson_ratio, material.shear_modulus)


def around(mesh: Mesh, across: IntArray, after: int) -> tuple[list[int], bool]:
    """The elements that start where one does, of bodies on each other, counterclockwise; whether they close a ring.

    `across` (m,) is the element on the other side of a contact or a bond, else -1.
    """
    starts = [after]
    while (other := int(across[mesh.before[starts[-1]]])) >= 0 and other not in starts:
        starts.append(other)
    if other == after:
        return starts, True
    while (other := int(across[starts[0]])) >= 0 and (other := int(mesh.elements[other, 2])) not in starts:
        starts.insert(0, other)
    return starts, False


def wedges_at(
    problem: Problem, mesh: Mesh, across: IntArray, after: int, face: FaceAt
) -> tuple[Wedges, list[tuple[int, int]]]:
    """The wedges around the start of an element, and the elements with both faces of each.

    Bonded ones of one material are one. Stiffness is over that of the wedge at this element.
    """
    starts, closed = around(mesh, across, after)
    wedges, ends, numbers = list[Wedge](), list[tuple[int, int]](), list[int]()
    for start in starts:
        new, both = wedge_at(problem, mesh, start, face), (start, int(mesh.before[start]))
        if wedges and _one_material(wedges[-1], new):
            wedges[-1], ends[-1] = _merged(wedges[-1], new), (ends[-1][0], both[1])
        else:
            wedges, ends = [*wedges, new], [*ends, both]
        numbers.append(len(wedges) - 1)
    if closed and len(wedges) > 1 and _one_material(wedges[-1], wedges[0]):
        wedges[0], ends[0] = _merged(wedges.pop(), wedges[0]), (ends.pop()[0], ends[0][1])
    own = numbers[starts.index(after)] % len(wedges)
    scaled = tuple(item._replace(stiffness=item.stiffness / wedges[own].stiffness) for item in wedges)
    return Wedges(scaled, own, closed), ends


def _one_material(wedge: Wedge, other: Wedge) -> bool:
    """Whether the second face of a wedge is bonded to the first one of another one of its material."""
    return wedge.faces[1].bonded and wedge[3:] == other[3:]


def _merged(wedge: Wedge, other: Wedge) -> Wedge:
    """Both as one."""
    return wedge._replace(angle=wedge.angle + other.angle, faces=(wedge.faces[0], other.faces[1]))
