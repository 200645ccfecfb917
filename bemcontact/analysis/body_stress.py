"""Stress and displacement of one state of a body: at its points and along its edges, and where stress is infinite."""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from bemcontact.adaptivity.corner_wedges import around, wedges_at
from bemcontact.adaptivity.wedge_exponents import BONDED, FREE, Face, Wedges, contact_face, stress_is_infinite
from bemcontact.analysis.edge_peak import largest_along
from bemcontact.arrays import Array, BoolArray, IntArray, magnitudes, real_array
from bemcontact.bem import reference_element
from bemcontact.bem.mesh import CORNER, Mesh
from bemcontact.bem.outline import Outline
from bemcontact.bem.stress_field import NEARLY, Located, StressField
from bemcontact.contact.stress import EdgeStress, PointKind, Stress
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.serialization import Pair

FLAT = 1e-6
"""Angle of a corner that is none, and jump of shear over the largest traction that is none."""


@frozen
class BodyStress:
    """The stress of one state of a body, with the places where it is infinite.

    Parameters
    ----------
    name : of the body; empty for an only one
    field : of one state
    traction : (m, 3, 2) [p]
    singular : (m,) whether stress is infinite where an element starts
    """

    name: str
    field: StressField
    traction: Array
    singular: BoolArray

    @classmethod
    def of(
        cls, problem: Problem, number: int, mesh: Mesh, displacement: Array, traction: Array, smooth: BoolArray,
        singular: BoolArray, infinite: Sequence[Pair] | Array,
    ) -> Self:  # fmt: skip
        """Read the boundary of the elastic body of a number, with its mesh.

        From displacement (m, 3, 2) [L] and traction (m, 3, 2) [p], and whether elements start smoothly (m,), and at
        infinite stress by the wedges there (m,). At the places `infinite`, pressure is known to be so.
        """
        part, factors = problem.parts[number], problem.factors()
        of_nodes = np.zeros((len(mesh.nodes), 2))
        of_nodes[mesh.elements] = displacement
        field = StressField.of(
            Outline(problem=problem, mesh=mesh),
            part.material,
            of_nodes[..., None],
            traction[..., None],
            [loads[number] for loads in problem.volume_loads],
            np.array([[1.0, *(factors.get(case, 0.0) for case in problem.load_cases)]]),
            smooth,
        )
        singular = singular | _sheared(field, traction)
        for place in infinite:
            singular |= np.hypot(*(mesh.nodes[: len(singular)] - place).T) <= NEARLY * mesh.size
        return cls(name=part.name, field=field, traction=traction, singular=singular)

    def stress(self, points: object) -> Stress:
        """Stress at points (k, 2)."""
        return self.at(self._located(points))

    def at(self, at: Located) -> Stress:
        """Stress where points are; not a number outside the body."""
        kind = kinds(self.field, at, self.singular)
        inside = self.field.stress(at)
        zz = self.field.out_of_plane(inside, at.points)[:, 0]
        infinite = kind == PointKind.SINGULAR
        components = np.where(infinite[:, None], np.nan, inside[..., 0].T)
        return Stress(points=at.points, components=components, zz=np.where(infinite, np.nan, zz), kind=kind)

    def displacement(self, points: object) -> Array:
        """Displacement (k, 2) [L] at points (k, 2)."""
        return self.field.displacement(self._located(points))[..., 0]

    def _located(self, points: object) -> Located:
        """Where points are; `ProblemError` if one is outside."""
        at = self.field.locate(real_array(points, "points", (None, 2)))
        ensure_in_body(self.field, at)
        return at

    def along(self, edge: str) -> EdgeStress:
        """Stress along an edge."""
        mesh, own = self.field.mesh, self._elements(edge)
        normals, traction = mesh.normals[own], self.traction[own]
        hoop, stress = self._on(np.repeat(own, 3), np.tile(reference_element.NODES, len(own)))
        infinite, points = self._infinite(own), mesh.nodes[mesh.elements[own]]
        peak = self.edge_peak(edge)
        return EdgeStress(
            edge=edge,
            points=points,
            arc=self._arc(own),
            hoop=np.where(infinite, np.nan, hoop.reshape(-1, 3)),
            pressure=-np.sum(traction * normals, axis=2),
            shear=traction[..., 1] * normals[..., 0] - traction[..., 0] * normals[..., 1],
            von_mises=np.where(infinite, np.nan, stress.von_mises.reshape(-1, 3)),
            peak=None if peak is None else peak.value,
            peak_at=None if peak is None else peak.point,
            peak_arc=None if peak is None else peak.arc,
            singular=points[infinite],
        )

    def edge_peak(self, edge: str, *, von_mises: bool = False) -> "EdgePeak | None":
        """The hoop stress of the largest magnitude along an edge, or the equivalent stress; None as in `EdgeStress`."""
        own = self._elements(edge)
        ends = self._infinite(own)

        def values(at: Array) -> Array:
            number = np.minimum(at.astype(int), len(own) - 1)
            hoop, stress = self._on(own[number], 2 * (at - number) - 1)
            return stress.von_mises if von_mises else hoop

        found = largest_along(values, np.append(ends[:, 0], ends[-1, 2]))
        if found is None:
            return None
        number = min(int(found[0]), len(own) - 1)
        shapes = reference_element.values(np.array(2 * (found[0] - number) - 1))
        mesh = self.field.mesh
        x, y = (shapes @ mesh.nodes[mesh.elements[own[number]]]).tolist()
        return EdgePeak(found[1], (x, y), float(shapes @ self._arc(own)[number]))

    def _elements(self, edge: str) -> IntArray:
        """Elements of an edge in order."""
        return np.flatnonzero(self.field.mesh.edge == self.field.mesh.edge_names.index(edge))

    def _infinite(self, own: IntArray) -> BoolArray:
        """Whether stress is infinite at the nodes (m, 3) of elements."""
        infinite = np.zeros((len(own), 3), bool)
        infinite[:, 0], infinite[:, 2] = self.singular[own], self.singular[self.field.mesh.elements[own, 2]]
        return infinite

    def _arc(self, own: IntArray) -> Array:
        """Arc length (m, 3) [L] of the nodes of all elements of an edge from its start."""
        halves = self.field.mesh.halves[own]
        starts = np.append(0.0, np.cumsum(halves.sum(axis=1))[:-1])
        return starts[:, None] + np.column_stack([np.zeros(len(own)), halves[:, 0], halves.sum(axis=1)])

    def _on(self, element: IntArray, xi: Array) -> tuple[Array, Stress]:
        """Hoop stress (k,) [p] and stress at ξ (k,) of elements (k,)."""
        mesh = self.field.mesh
        shapes, slopes = reference_element.values(xi), reference_element.derivatives(xi)
        nodes = mesh.nodes[mesh.elements[element]]
        points, tangent = (np.einsum("kl,klx->kx", part, nodes) for part in (shapes, slopes))
        stress = self.field.stress_on(element, xi, points)
        (x, y), (xx, yy, xy) = tangent.T / np.hypot(*tangent.T), stress[..., 0]
        zz = self.field.out_of_plane(stress, points)[:, 0]
        kind = np.full(len(xi), PointKind.BOUNDARY.value)
        return xx * x * x + yy * y * y + 2 * xy * x * y, Stress(
            points=points, components=stress[..., 0].T, zz=zz, kind=kind
        )


class EdgePeak(NamedTuple):
    """The largest stress along an edge [p], its place [L], and the arc length to it from the start of the edge [L]."""

    value: float
    point: Pair
    arc: float


def ensure_in_body(field: StressField, at: Located, bodies: int = 1) -> None:
    """Refuse points outside of the body with a `ProblemError`; of several `bodies` it is that nearest to the first."""
    if not at.outside.any():
        return
    first, count = int(np.argmax(at.outside)), int(at.outside.sum())
    (x, y), unit = at.points[first], field.problem.units.length
    edge = field.mesh.edge_names[field.mesh.edge[at.element[first]]]
    near = f", {at.distance[first]:.3g} {unit}".rstrip() + f" from '{edge}'" if np.isfinite(at.distance[first]) else ""
    others = f"; {count} of the {len(at.points)} points are" if count > 1 else ""
    named = f" '{body}'" if (body := field.problem.part_of(edge)) else ""
    where, inside = f"outside the undeformed body{named}", f"inside the body{named} or on its boundary"
    if bodies > 1:
        where, inside = "in none of the undeformed bodies", "inside a body or on its boundary"
    raise ProblemError(
        f"points[{first}] = ({x:.6g}, {y:.6g}) is {where}{near}{others}; give points {inside}, in coordinates before "
        "the deformation"
    )


def kinds(field: StressField, at: Located, singular: BoolArray) -> NDArray[np.str_]:
    """The kind of each point (k,); `singular` (m,) says where an element starts at infinite stress."""
    result = np.where(at.inside, PointKind.INSIDE.value, PointKind.BOUNDARY.value).astype("U8")
    end = at.node >= 0
    result[end & ~field.smooth[at.node]] = PointKind.CORNER.value
    result[end & singular[at.node]] = PointKind.SINGULAR.value
    return result


def infinite_starts(problem: Problem, mesh: Mesh, smooth: BoolArray, pressed: BoolArray) -> BoolArray:
    """Whether stress grows without bound where each element (m,) of all bodies starts, by the wedges that meet there.

    `smooth` (m,) is as of `smooth_starts`, and `pressed` (zones, m) are the elements that touch, on both sides. A
    surface that is the contour of a slit is curved without bound at its tip, and holds its faces there as none does.
    """
    slits = [name for name, zone in problem.zones.items() if isinstance(zone.surface, DeflectedContour)]
    of_slits = {edge for name in slits for edge in problem.edges_of(name)}
    touches = pressed.any(axis=0) & ~np.isin(
        mesh.edge, [i for i, name in enumerate(mesh.edge_names) if name in of_slits]
    )
    bonded = mesh.across(problem.bonded)
    across = np.where(bonded >= 0, bonded, mesh.across(problem.zones, pressed))

    def face(element: int, direction: float) -> Face:
        if touches[element]:
            return contact_face(np.exp(1j * (direction - np.pi / 2)))
        if bonded[element] >= 0:
            return BONDED
        condition = problem.edge_conditions.get(mesh.edge_names[mesh.edge[element]])
        given = () if condition is None else condition.displacement.given
        return Face(1.0, ("x" in given, "y" in given)) if given else FREE

    temperatures = [*zip(*([loads.temperature for loads in each] for each in problem.volume_loads), strict=True)]
    result, known = np.zeros((2, len(mesh.elements)), bool)
    for after in np.flatnonzero(~smooth).tolist():
        if not known[after]:
            together, _ = around(mesh, across, after)
            wedges, _ = wedges_at(problem, mesh, across, after, face)
            heats = [temperatures[mesh.part_of(start)] for start in together]
            logarithmic = heats.count(heats[0]) < len(heats) and _heat_is_logarithmic(wedges, len(together))
            result[together] = logarithmic or stress_is_infinite(wedges)
            known[together] = True
    return result


def _heat_is_logarithmic(wedges: Wedges, bodies: int) -> bool:
    """Whether a jump of thermal expansion at a bond of equal materials makes stress grow like ln r at its end.

    It does in a half-plane that ends free, and around a corner in the whole plane. At other corners, and where the
    materials differ, stress is finite or grows faster.
    """
    free = all(not any(face.held) for face in wedges.at.faces) and abs(wedges.at.angle - np.pi) < CORNER
    return len(wedges.wedges) == 1 < bodies and (wedges.closed or free)


def _sheared(field: StressField, traction: Array) -> BoolArray:
    """Whether the shear on a straight boundary jumps where each element (m,) starts: stress there is a logarithm."""
    mesh = field.mesh
    tangents = mesh.tangents / mesh.jacobians[..., None]
    shear = np.sum(traction * tangents, axis=2)
    jump = abs(shear[:, 0] - shear[mesh.before, 2]) > FLAT * magnitudes(traction).max(initial=0.0)
    return ~field.smooth & (abs(mesh.turns) < CORNER) & (abs(mesh.inner_angles - np.pi) < CORNER) & jump
