"""The conditions of a problem, spread over the nodes and elements of its mesh."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.mesh import Mesh
from bemcontact.errors import Issue, ProblemError
from bemcontact.problem.conditions import AxisFields, Condition, Field
from bemcontact.problem.problem import Problem

CONTRADICTION = 1e-9
"""Difference of two prescribed displacements at one corner, relative to the largest one, from which they contradict."""


@dataclass(frozen=True, kw_only=True, eq=False)
class BoundaryValues:
    """Prescribed displacements and tractions on the boundary; zero where nothing is prescribed.

    Parameters
    ----------
    displacement_given : (N, 2) whether a displacement component is prescribed at a node
    displacement : (N, 2) its value [L]
    traction_unknown : (m, 2) whether the edge of an element prescribes displacement along an axis: traction is sought
    traction : (m, 3, 2) prescribed traction [p]
    """

    displacement_given: BoolArray
    displacement: Array
    traction_unknown: BoolArray
    traction: Array


def boundary_values(problem: Problem, mesh: Mesh) -> BoundaryValues:
    """Evaluate all conditions on the mesh.

    Raises
    ------
    ProblemError
        If two edges prescribe different displacements at the corner they share.
    """
    N, m = len(mesh.nodes), len(mesh.elements)
    values = BoundaryValues(
        displacement_given=np.zeros((N, 2), bool),
        displacement=np.zeros((N, 2)),
        traction_unknown=np.zeros((m, 2), bool),
        traction=np.zeros((m, 3, 2)),
    )
    owner = np.full((N, 2), -1)
    largest = _largest_displacement(problem, mesh)
    issues = []
    for index, name in enumerate(mesh.edge_names):
        if name not in problem.conditions:
            continue
        condition, elements = problem.conditions[name], np.flatnonzero(mesh.edge == index)
        nodes = np.unique(mesh.elements[elements])
        for axis, field in _given(condition.displacement):
            value = field.at(mesh.nodes[nodes])
            taken = values.displacement_given[nodes, axis]
            wrong = taken & (abs(value - values.displacement[nodes, axis]) > CONTRADICTION * largest)
            issues += [
                _contradiction(mesh, mesh.edge_names[owner[node, axis]], name, axis, int(node)) for node in nodes[wrong]
            ]
            values.displacement[nodes, axis] = value
            values.displacement_given[nodes, axis] = True
            values.traction_unknown[elements, axis] = True
            owner[nodes, axis] = index
        values.traction[elements] = applied_traction(
            condition, mesh.nodes[mesh.elements[elements]], mesh.normals[elements]
        )
    if issues:
        raise ProblemError(issues)
    return values


def applied_traction(condition: Condition, points: Array, normals: Array) -> Array:
    """Traction (…, 2) [p] that a condition prescribes at points (…, 2) [L] with outward normals, else zero."""
    traction = np.zeros_like(points)
    for axis, field in _given(condition.traction):
        traction[..., axis] = _at(field, points)
    if condition.pressure is not None:
        traction = -_at(condition.pressure, points)[..., None] * normals
    return traction


def _given(fields: AxisFields) -> Iterator[tuple[int, Field]]:
    """Number and field of each axis that is prescribed."""
    for axis, field in enumerate((fields.x, fields.y)):
        if field is not None:
            yield axis, field


def _at(field: Field, points: Array) -> Array:
    return field.at(points.reshape(-1, 2)).reshape(points.shape[:-1])


def _largest_displacement(problem: Problem, mesh: Mesh) -> float:
    """Largest prescribed displacement on the mesh [L]."""
    largest = 0.0
    for name, condition in problem.conditions.items():
        nodes = np.unique(mesh.elements[mesh.edge == mesh.edge_names.index(name)])
        for _, field in _given(condition.displacement):
            largest = max(largest, float(abs(field.at(mesh.nodes[nodes])).max()))
    return largest


def _contradiction(mesh: Mesh, first: str, second: str, axis: int, node: int) -> Issue:
    x, y = mesh.nodes[node]
    message = (
        f"at ({x:.6g}, {y:.6g}), where '{second}' meets '{first}', the two prescribe different displacements "
        f"along {'xy'[axis]}; make them agree at that corner"
    )
    return Issue(path=("conditions", second, "displacement", "xy"[axis]), message=message)
