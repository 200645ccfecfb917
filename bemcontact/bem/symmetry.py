"""Lines of symmetry: straight edges that are held across and may slide along, at which the body goes on as its image.

On such a line the displacement across and the traction along are prescribed. The stress inside follows from them and
from the rest of the boundary with its image. Displacement along the line and traction across it, which are computed and
have errors, cancel.
"""

from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.mesh import Mesh
from bemcontact.problems.problem import Problem

STRAIGHT = 1e-12
"""Deviation of a unit normal from an axis, and of a place over the size of the body, that is round-off."""


class SymmetryLine(NamedTuple):
    """A line x = const or y = const, with the body on one side of it.

    Parameters
    ----------
    axis : 0 for x, 1 for y
    place : coordinate of the line [L]
    outward : -1 or 1, direction along the axis out of the body
    elements : (m,) whether an element is on it
    """

    axis: int
    place: float
    outward: float
    elements: BoolArray

    def beyond(self, points: Array) -> Array:
        """How far points (k, 2) are beyond the line (k,) [L]; negative where the body is."""
        return self.outward * (points[:, self.axis] - self.place)


def symmetry_lines(problem: Problem, mesh: Mesh) -> list[SymmetryLine]:
    """List the lines of symmetry of a body, those with the longest edges first."""
    result = list[SymmetryLine]()
    for number, name in enumerate(mesh.edge_names):
        condition, own = problem.edge_conditions.get(name), mesh.edge == number
        if condition is None or condition.spring or len(condition.displacement.given) != 1:
            continue
        axis = "xy".index(condition.displacement.given[0])
        normals, at = mesh.normals[own][..., axis], mesh.nodes[mesh.elements[own]][..., axis]
        place, outward = float(at[0, 0]), float(np.sign(normals[0, 0]))
        line = SymmetryLine(axis, place, outward, own)
        size = STRAIGHT * mesh.size
        if (abs(outward * normals - 1) > STRAIGHT).any() or (line.beyond(mesh.nodes) > size).any():
            continue
        for i, other in enumerate(result):
            if (other.axis, other.outward) == (axis, outward) and abs(other.place - place) <= size:
                result[i] = other._replace(elements=other.elements | own)
                break
        else:
            result.append(line)
    return sorted(result, key=lambda line: -mesh.lengths[line.elements].sum())
