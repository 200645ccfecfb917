"""What conditions prescribe on the boundary, and the state of the boundary in a solution."""

from collections.abc import Iterator, Mapping
from typing import ClassVar

import numpy as np

from bemcontact.arrays import Array, BoolArray, IntArray, indices
from bemcontact.bem.mesh import Mesh, MeshPart
from bemcontact.checks.attributes import PLACE, WithHints, Words
from bemcontact.errors import Issue, ProblemError
from bemcontact.frozen import frozen
from bemcontact.problems.conditions import Along, AxisFields, Condition, Field
from bemcontact.problems.problem import Problem

CONTRADICTION = 1e-9
"""Difference of two prescribed displacements at one corner, relative to the largest one, from which they contradict."""
STOP = 1e-9
"""Distance over the length of an edge up to which an element ends at a jump of a load: round-off."""


@frozen
class BoundaryValues:
    """Prescribed displacements and tractions on the boundary; zero where nothing is prescribed.

    Parameters
    ----------
    displacement_given : (N, 2) whether a displacement component is prescribed at a node
    displacement : (N, 2) its value [L]
    traction_unknown : (m, 2) whether the edge of an element prescribes displacement along an axis: traction is sought
    traction : (m, 3, 2) prescribed traction [p]
    stiffness : (m, 3, 2, 2) of springs, which add the traction -K u [p/L]
    """

    displacement_given: BoolArray
    displacement: Array
    traction_unknown: BoolArray
    traction: Array
    stiffness: Array

    def of_part(self, part: "MeshPart") -> "BoundaryValues":
        """The values on one body."""
        return BoundaryValues(
            displacement_given=self.displacement_given[part.nodes],
            displacement=self.displacement[part.nodes],
            traction_unknown=self.traction_unknown[part.elements],
            traction=self.traction[part.elements],
            stiffness=self.stiffness[part.elements],
        )

    def spring_traction(self, displacement: Array) -> Array:
        """Traction (m, 3, 2) [p] by springs at displacements (m, 3, 2) [L] of the nodes of elements."""
        if not self.stiffness.any():
            return np.zeros_like(displacement)
        return -np.einsum("mkij,mkj->mki", self.stiffness, displacement)


@frozen
class BoundaryState(WithHints):
    """Displacement and traction on the boundary, element by element; traction may jump between elements."""

    _home = "boundary"
    _called: ClassVar[Words] = {
        "points": (*PLACE, "nodes", "mesh"),
        "displacement": ("u", "displacements", "deformation"),
        "traction": ("stress", "stresses", "tractions", "pressure", "t"),
    }

    points: Array
    """Nodes (m, 3, 2) of each element [L]."""
    displacement: Array
    """Displacement (m, 3, 2) at these nodes [L]."""
    traction: Array
    """Force (m, 3, 2) on the body per undeformed length [p]."""
    edge: IntArray
    """Index (m,) into `edge_names`."""
    edge_names: tuple[str, ...]
    """Names of the edges."""
    force_balance: float
    """Resultant of all forces on the body (and of their moments, over the radius), over the sum of their magnitudes."""
    equilibrium_slack: float
    """Imbalance of the discrete equations relative to the loads; it measures the mesh."""


def boundary_values(problem: Problem, conditions: Mapping[str, Condition], mesh: Mesh) -> BoundaryValues:
    """Spread conditions by edge over the mesh; `ProblemError` if two of them contradict each other at a corner.

    Springs have the normals of the curves, so that a circle on springs is free to spin on any mesh.
    """
    N, m = len(mesh.nodes), len(mesh.elements)
    values = BoundaryValues(
        displacement_given=np.zeros((N, 2), bool),
        displacement=np.zeros((N, 2)),
        traction_unknown=np.zeros((m, 2), bool),
        traction=np.zeros((m, 3, 2)),
        stiffness=np.zeros((m, 3, 2, 2)),
    )
    owner = np.full((N, 2), -1)
    issues = []
    for index, name in enumerate(mesh.edge_names):
        if name not in conditions:
            continue
        condition, elements = conditions[name], indices(mesh.edge == index)
        for axis, field in _given(condition.displacement):
            nodes = mesh.nodes_of(elements)
            value = field.at(mesh.nodes[nodes])
            taken = values.displacement_given[nodes, axis]
            if taken.any():
                allowed = CONTRADICTION * _largest_displacement(conditions, mesh)
                wrong = nodes[taken & (abs(value - values.displacement[nodes, axis]) > allowed)].tolist()
                issues += [_contradiction(mesh, mesh.edge_names[owner[node, axis]], name, axis, node) for node in wrong]
            values.displacement[nodes, axis] = value
            values.displacement_given[nodes, axis] = True
            values.traction_unknown[elements, axis] = True
            owner[nodes, axis] = index
        if condition.spring is not None:
            normals = problem.edge(name).normals(mesh.fractions[elements].ravel())
            values.stiffness[elements] = condition.spring.matrices(normals.reshape(-1, 3, 2))
        if condition.presses:
            along = None
            if condition.varies_along:
                along = _along(mesh, index, elements)
                issues += _unmet_stops(condition, name, mesh, along)
            values.traction[elements] = applied_traction(
                condition, mesh.nodes[mesh.elements[elements]], mesh.normals[elements], along
            )
    if issues:
        raise ProblemError(issues)
    return values


def _along(mesh: Mesh, edge: int, elements: IntArray) -> Along:
    """Places (e, 3) along an edge of the nodes of its elements, each within its element."""
    length = mesh.edge_lengths[edge]
    distance = mesh.fractions[elements] * length
    return Along(distance, np.repeat(distance[:, 1:2], 3, axis=1), length)


def _unmet_stops(condition: Condition, name: str, mesh: Mesh, along: Along) -> Iterator[Issue]:
    """Issues of loads that jump or kink inside an element."""
    length, ends = along.length, mesh.ends_on(name) * along.length
    for stop in condition.stops(length):
        if abs(ends - stop).min() > STOP * length:
            message = (
                f"the load jumps or kinks at the distance {stop:.6g} from the start of '{name}', inside an element; "
                f"add {stop / length:.9g} to ends_at of this edge, or leave elements out"
            )
            yield Issue(path=("conditions", name), message=message)


def applied_traction(condition: Condition, points: Array, normals: Array, along: Along | None = None) -> Array:
    """Traction (…, 2) [p] that a condition prescribes at points (…, 2) [L] with outward normals, else zero.

    `along` are their places on the edge, which a condition that varies along it needs.
    """
    if condition.pressure is not None:
        traction = -_at(condition.pressure, points, along)[..., None] * normals
    else:
        traction = np.zeros(points.shape)
        for axis, field in _given(condition.traction):
            traction[..., axis] = _at(field, points, along)
    for force in condition.force:
        assert along is not None, "a force has a place on its edge"
        traction = traction + force.traction(along)
    return traction


def _given(fields: AxisFields) -> Iterator[tuple[int, Field]]:
    """Number and field of each axis that is prescribed."""
    for axis, field in enumerate((fields.x, fields.y)):
        if field is not None:
            yield axis, field


def _at(field: Field, points: Array, along: Along | None) -> Array:
    if along is not None:
        along = Along(along.distance.ravel(), along.within.ravel(), along.length)
    return field.at(points.reshape(-1, 2), along).reshape(points.shape[:-1])


def _largest_displacement(conditions: Mapping[str, Condition], mesh: Mesh) -> float:
    """Largest prescribed displacement on the mesh [L]."""
    largest = 0.0
    for name, condition in conditions.items():
        nodes = mesh.nodes_of(indices(mesh.edge == mesh.edge_names.index(name)))
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
