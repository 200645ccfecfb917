"""Stress and displacement at any point of a body, inside and on its boundary, of several states at a time."""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from bemcontact.arrays import Array, BoolArray, ComplexArray, IntArray, magnitudes
from bemcontact.bem import reference_element
from bemcontact.bem.boundary_gradient import BoundaryFields
from bemcontact.bem.interior import Interior
from bemcontact.bem.loading import VolumeField, particular_field
from bemcontact.bem.mesh import CORNER, Mesh
from bemcontact.bem.outline import ROUGH, Outline
from bemcontact.bem.symmetry import SymmetryLine, symmetry_lines
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.conditions import Loads
from bemcontact.problems.material import Material
from bemcontact.problems.nearest_places import surface_corners
from bemcontact.problems.problem import Problem

ON_BOUNDARY, NEARLY = 1e-12, 1e-9
"""Distance from the boundary over the size of the body that is none: to either side, and out of the body."""
DEVIATION = np.array([-0.7, -0.45, 0.45, 0.7])
"""Local coordinates where a quadratic element is farthest from a curve through its nodes."""
ALONG_CURVE = 2
"""Steps to the foot of a point on a curve, from that on the element: each has twice as many digits."""
SLACK = 1.5
"""Factor of the distance there up to which a point between element and curve is on the boundary."""


class Located(NamedTuple):
    """Where points are.

    Parameters
    ----------
    points : (k, 2) [L]
    inside, outside : (k,) whether a point is inside the body, or outside; else it is on the boundary
    element, xi : (k,) nearest place on the boundary
    node : (k,) element that starts at the element end where the point is, or -1
    distance : (k,) to the boundary [L]; infinite where no element is near
    """

    points: Array
    inside: BoolArray
    outside: BoolArray
    element: IntArray
    xi: Array
    node: IntArray
    distance: Array


def smooth_starts(outline: Outline) -> BoolArray:
    """Whether boundary and conditions go on smoothly where each element (m,) of all bodies starts.

    They do so along an edge, but for corners of the surfaces that it may touch and ends of its bonds, and from one edge
    to the next one if these meet smoothly under the same conditions.
    """
    problem, mesh = outline.problem, outline.mesh
    before, element = mesh.before, np.arange(len(mesh.elements))
    same = mesh.edge == mesh.edge[before]
    normals = outline.sides[0][element]
    level = np.hypot(*(normals[:, 1] - normals[:, 0]).T) < ROUGH
    what = [_conditions(problem, name) for name in mesh.edge_names]
    alike = np.array([[one == other for other in what] for one in what])[mesh.edge, mesh.edge[before]]
    smooth = (same | (level & alike)) & (abs(mesh.turns) < CORNER) & ~mesh.ends_of_joints(mesh.across(problem.bonded))
    for name, zone in problem.zones.items():
        for edge in map(problem.edge, {*problem.edges_of(name)}.intersection(mesh.edge_names)):
            for corner in surface_corners(edge, zone.surface, at_ends=True):
                place = edge.points(np.array([corner.fraction]))
                smooth &= np.hypot(*(mesh.nodes[element] - place).T) > NEARLY * mesh.size
    return smooth


def _conditions(problem: Problem, edge: str) -> tuple[object, ...]:
    """What acts on an edge: conditions of the problem and of its load cases, and contact zones."""
    zones = [zone for zone in problem.zones if edge in problem.edges_of(zone)]
    return problem.edge_conditions.get(edge), [case.conditions.get(edge) for case in problem.load_cases.values()], zones


@frozen
class StressField:
    """Stress and displacement in a body in q states, each with volume loads of its own.

    Parameters
    ----------
    outline : the curves under the elements of the body
    material : of the body
    smooth : (m,) `smooth_starts`
    fields : on the boundary, less the particular solutions
    loads : volume loads of the states, and factors of them (q, …)
    """

    outline: Outline
    material: Material
    smooth: BoolArray
    fields: BoundaryFields
    loads: Sequence[Loads]
    factors: Array

    @classmethod
    def of(
        cls, outline: Outline, material: Material, displacement: Array, traction: Array, loads: Sequence[Loads],
        factors: Array, smooth: BoolArray,
    ) -> Self:  # fmt: skip
        """Read the boundary: displacement (N, 2, q) [L], traction (m, 3, 2, q) [p]."""
        mesh, u, t = outline.mesh, displacement, traction
        for item, factor in zip(loads, factors.T, strict=True):
            if item != Loads():
                field = particular_field(item, material, mesh, mesh.nodes)
                u = u - field.displacement[..., None] * factor
                on_boundary = np.einsum("mkij,mkj->mki", field.stress[mesh.elements], mesh.normals)
                t = t - on_boundary[..., None] * factor
        fields = BoundaryFields.of(mesh, material, u, t, smooth)
        return cls(outline=outline, material=material, smooth=smooth, fields=fields, loads=loads, factors=factors)

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self.outline.problem

    @property
    def mesh(self) -> Mesh:
        """Its mesh."""
        return self.outline.mesh

    @cached_property
    def interior(self) -> Interior:
        """The integrals over the boundary."""
        nu = self.material.effective_poisson_ratio
        return Interior(mesh=self.mesh, poisson_ratio=nu, lines=self.lines)

    @cached_property
    def lines(self) -> list[SymmetryLine]:
        """The lines of symmetry."""
        return symmetry_lines(self.problem, self.mesh)

    def stress(self, at: Located) -> Array:
        """σxx, σyy, σxy (3, k, q) [p]; where an element ends, the mean of both sides; not a number outside."""
        result = np.full((3, len(at.points), len(self.factors)), np.nan)
        inside, on = np.flatnonzero(at.inside), np.flatnonzero(~at.inside & ~at.outside)
        gradient = self.interior.gradient(self.interior.z(at.points[inside]), self.fields)
        result[:, inside] = gradient.stress(self.material) + self._volume_stress(at.points[inside])
        if len(on):
            result[:, on] = self.stress_on(at.element[on], at.xi[on], at.points[on])
        end = on[at.node[on] >= 0]
        if len(end):
            sides = ((at.node[end], -1.0), (self.mesh.before[at.node[end]], 1.0))
            both = [self.stress_on(element, np.full(len(end), xi), at.points[end]) for element, xi in sides]
            result[:, end] = (both[0] + both[1]) / 2
        return result

    def stress_on(self, element: IntArray, xi: Array, points: Array) -> Array:
        """σxx, σyy, σxy (3, k, q) [p] on the boundary at ξ (k,) of elements (k,), where points (k, 2) [L] are.

        On a line of symmetry it is that of the inside, but for corners.
        """
        gradient = self.fields.gradient(element, xi)
        for line in self.interior.used_lines:
            corner = ((xi <= -1) & ~self.smooth[element]) | ((xi >= 1) & ~self.smooth[self.mesh.elements[element, 2]])
            own = np.flatnonzero(line.elements[element] & ~corner)
            if not len(own):
                continue
            beside = points[own].copy()
            beside[:, line.axis] = line.place - line.outward * ON_BOUNDARY * self.mesh.size
            inside = self.interior.gradient(self.interior.z(beside), self.fields)
            gradient.a[own], gradient.b[own] = inside.a, inside.b
        return gradient.stress(self.material) + self._volume_stress(points)

    def _volume_stress(self, points: Array) -> Array:
        """σxx, σyy, σxy (3, k, q) [p] of the particular solutions."""
        result = np.zeros((3, len(points), len(self.factors)))
        for field, factor in self._volume(points):
            xx, yy, xy = field.stress[:, 0, 0], field.stress[:, 1, 1], field.stress[:, 0, 1]
            result += np.stack([xx, yy, xy])[..., None] * factor
        return result

    def displacement(self, at: Located) -> Array:
        """Displacement (k, 2, q) [L]; not a number outside."""
        result: ComplexArray = np.full((len(at.points), len(self.factors)), np.nan, complex)
        inside, on = np.flatnonzero(at.inside), np.flatnonzero(~at.inside & ~at.outside)
        result[inside] = self.interior.displacement(self.interior.z(at.points[inside]), self.fields)
        shapes = reference_element.values(at.xi[on])
        result[on] = np.einsum("kl,klq->kq", shapes, self.fields.displacement[at.element[on]])
        values = np.stack([result.real, result.imag], axis=1) * self.mesh.reference_length
        for field, factor in self._volume(at.points):
            values += field.displacement[..., None] * factor
        return values

    def out_of_plane(self, in_plane: Array, points: Array) -> Array:
        """σzz (k, q) [p] of in-plane stresses (3, k, q) at points (k, 2): that of plane strain, or zero."""
        material = self.material
        if material.state == "plane_stress":
            return np.zeros_like(in_plane[0])
        zz = material.poisson_ratio * (in_plane[0] + in_plane[1])
        for item, factor in zip(self.loads, self.factors.T, strict=True):
            if heat := item.temperature:
                zz -= material.young_modulus * heat.expansion * heat.change.at(points)[:, None] * factor
        return zz

    def _volume(self, points: Array) -> list[tuple[VolumeField, Array]]:
        """Particular solutions at points, with their factors (q,)."""
        both = zip(self.loads, self.factors.T, strict=True)
        return [
            (particular_field(item, self.material, self.mesh, points), factor)
            for item, factor in both
            if item != Loads()
        ]

    def locate(self, points: Array) -> Located:
        """Find out where points (k, 2) [L] are."""
        mesh, size = self.mesh, self.mesh.size
        z = self.interior.z(points)
        element, xi, distance, inside = self.interior.nearest(z)
        distance = distance * mesh.reference_length
        near = distance <= self._reach[element]
        on = distance <= ON_BOUNDARY * size
        some = np.flatnonzero(near & ~on)
        out = self._beyond_curve(points[some], element[some], xi[some])
        on[some] = (abs(out) <= ON_BOUNDARY * size) | (~inside[some] & (out <= NEARLY * size))
        inside[some] &= out <= NEARLY * size
        inside &= ~on
        at_end = np.where(xi < 0, mesh.elements[element, 0], mesh.elements[element, 2])
        node = np.where(on & (np.hypot(*(points - mesh.nodes[at_end]).T) <= NEARLY * size), at_end, -1)
        return Located(points, inside, ~inside & ~on, element, xi, node, distance)

    @cached_property
    def _reach(self) -> Array:
        """Distance (m,) [L] from each element within which points may be on the curve under it."""
        elements = np.arange(len(self.mesh.elements))
        curve = self.outline.places(elements, np.tile(DEVIATION, (len(elements), 1))).points
        between = reference_element.values(DEVIATION) @ self.mesh.nodes[self.mesh.elements]
        return SLACK * magnitudes(curve - between).max(axis=1) + NEARLY * self.mesh.size

    def _beyond_curve(self, points: Array, element: IntArray, xi: Array) -> Array:
        """How far points (k, 2) are beyond the curve [L] near places of it, along its normal; negative inside."""
        half = self.mesh.lengths[element] / 2
        for _ in range(ALONG_CURVE):
            away, inward = self._from_curve(points, element, xi)
            xi = np.clip(xi + (away[:, 0] * inward[:, 1] - away[:, 1] * inward[:, 0]) / half, -1, 1)
        away, inward = self._from_curve(points, element, xi)
        return -np.sum(away * inward, axis=1)

    def _from_curve(self, points: Array, element: IntArray, xi: Array) -> tuple[Array, Array]:
        """From places on the curve to points (k, 2) [L], and the normals (k, 2) there."""
        places = self.outline.places(element, xi[:, None])
        return points - places.points[:, 0], places.inward[:, 0]
