"""Loads on a body and its mesh: prescribed values, volume loads and the resultant of all. Loadings can be combined.

Volume loads enter by particular solutions of the loaded equations, the f = F u_p - G t_p of (7), without a domain
integral. Each is a polynomial that satisfies the equations of elasticity with its load; in plane stress ν is the
effective one.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field, replace
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem import reference_element
from bemcontact.bem.boundary_values import BoundaryValues, applied_traction, boundary_values
from bemcontact.bem.free_motions import FreeMotions
from bemcontact.bem.mesh import Mesh, MeshPart, along_curve
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.problems.bodies import Part
from bemcontact.problems.conditions import AxisFields, Centrifugal, Condition, Field, Gravity, Loads, Temperature
from bemcontact.problems.curves import Edge
from bemcontact.problems.load_case import LoadCase
from bemcontact.problems.material import Material
from bemcontact.problems.problem import Problem

EXACT_ORDER = 2
"""Gauss points that integrate x dy exactly along a quadratic element."""


@frozen
class ParticularSolution:
    """A field in equilibrium with the volume loads, on a mesh.

    Parameters
    ----------
    displacement : (N, 2) u_p [L]
    traction : (m, 3, 2) t_p [p]
    magnitude : sum of the magnitudes of the body forces, or a bound of it [p L]
    """

    displacement: Array
    traction: Array
    magnitude: float = 0.0


class VolumeField(NamedTuple):
    """A particular solution at points: displacement (…, 2) [L] and stress (…, 2, 2) [p]."""

    displacement: Array
    stress: Array


def particular_solution(loads: Loads, material: Material, mesh: Mesh) -> ParticularSolution:
    """Sum the particular solutions of all volume loads on the boundary."""
    field = particular_field(loads, material, mesh, mesh.nodes)
    magnitude = 0.0
    if loads.gravity:
        magnitude += _area(mesh) * float(np.hypot(*_weight(loads.gravity)))
    if loads.centrifugal:
        farthest = np.sum((mesh.nodes - np.array(loads.centrifugal.center)) ** 2, axis=1).max()
        magnitude += _spin(loads.centrifugal) * _area(mesh) * float(np.sqrt(farthest))
    return ParticularSolution(
        displacement=field.displacement,
        traction=np.einsum("mkij,mkj->mki", field.stress[mesh.elements], mesh.normals),
        magnitude=magnitude,
    )


def particular_field(loads: Loads, material: Material, mesh: Mesh, points: Array) -> VolumeField:
    """Sum the particular solutions of all volume loads at points (…, 2) [L] of a body with this mesh."""
    parts = []
    if loads.gravity:
        parts.append(_gravity(loads.gravity, material, points - mesh.centroid))
    if loads.centrifugal:
        parts.append(_centrifugal(loads.centrifugal, material, points - np.array(loads.centrifugal.center)))
    if loads.temperature:
        parts.append(_thermal(loads.temperature, material, mesh.centroid, points - mesh.centroid))
    return VolumeField(
        displacement=sum((part.displacement for part in parts), np.zeros_like(points)),
        stress=sum((part.stress for part in parts), np.zeros((*points.shape, 2))),
    )


def true_resultant(edges: Iterable[Edge], loads: Loads, center: Array) -> tuple[Array, float]:
    """Resultant (2,) [p L] of the body forces and its moment about the center [p L²], on the curves themselves.

    The center is near the body, so that coordinates far from the origin do no harm.
    """
    if not (loads.gravity or loads.centrifugal):
        return np.zeros(2), 0.0
    area, moments = 0.0, np.zeros(2)
    for edge in edges:
        points, normals, lengths, _ = along_curve(edge)
        arms = points - center
        flux = lengths * np.sum(arms * normals, axis=1)
        area += float(flux.sum()) / 2
        moments += flux @ arms / 3
    force, moment = np.zeros(2), 0.0
    if gravity := loads.gravity:
        b = gravity.density * np.array(gravity.acceleration)
        force, moment = force + area * b, moment + float(moments[0] * b[1] - moments[1] * b[0])
    if centrifugal := loads.centrifugal:
        density, arm = _spin(centrifugal), center - centrifugal.center
        force = force + density * (moments + area * arm)
        moment += density * float(moments[0] * arm[1] - moments[1] * arm[0])
    return force, moment


def _spin(centrifugal: Centrifugal) -> float:
    """ρω², the body force per distance from the axis."""
    return centrifugal.density * centrifugal.angular_velocity**2


def _weight(gravity: Gravity) -> Array:
    """ρg (2,), the body force."""
    return gravity.density * np.array(gravity.acceleration)


def _gravity(gravity: Gravity, material: Material, x: Array) -> VolumeField:
    """u_p = α r² b with G α (4 + 2/(1-2ν)) = -1, for the constant body force b; x (…, 2) from the middle."""
    b = _weight(gravity)
    nu = material.effective_poisson_ratio
    alpha = -(1 - 2 * nu) / (2 * material.shear_modulus * (3 - 4 * nu))
    gradient = 2 * alpha * np.einsum("i,...j->...ij", b, x)
    return VolumeField(alpha * np.sum(x * x, axis=-1)[..., None] * b, _stress(gradient, material))


def _centrifugal(centrifugal: Centrifugal, material: Material, x: Array) -> VolumeField:
    """u_p = γ r² x with 16 G γ (1-ν)/(1-2ν) = -ρω², x (…, 2) and r from the axis of rotation."""
    nu = material.effective_poisson_ratio
    gamma = -_spin(centrifugal) * (1 - 2 * nu) / (16 * material.shear_modulus * (1 - nu))
    r2 = np.sum(x * x, axis=-1)
    gradient = gamma * (r2[..., None, None] * np.eye(2) + 2 * np.einsum("...i,...j->...ij", x, x))
    return VolumeField(gamma * r2[..., None] * x, _stress(gradient, material))


def _thermal(temperature: Temperature, material: Material, middle: Array, x: Array) -> VolumeField:
    """u_p + i v_p = α' (T0 z + (a - ib) z²/2), free of stress, for T = T0 + a x + b y; α' = (1+ν) α in plane strain.

    x (…, 2) is from the middle of the body.
    """
    change, nu = temperature.change, material.poisson_ratio
    expansion = temperature.expansion * (1 + nu if material.state == "plane_strain" else 1)
    z = x[..., 0] + 1j * x[..., 1]
    at_center = change.at(middle[None, :])[0]
    w = expansion * (at_center * z + (change.x - 1j * change.y) * z * z / 2)
    return VolumeField(np.stack([w.real, w.imag], axis=-1), np.zeros((*x.shape, 2)))


def _stress(gradient: Array, material: Material) -> Array:
    """Hooke's law, σ = G (∇u + ∇uᵀ) + λ div u, from ∇u (…, 2, 2)."""
    G, nu = material.shear_modulus, material.effective_poisson_ratio
    strain = gradient + np.swapaxes(gradient, -1, -2)
    spherical = 2 * G * nu / (1 - 2 * nu) * np.trace(gradient, axis1=-2, axis2=-1)[..., None, None] * np.eye(2)
    return G * strain + spherical


def _area(mesh: Mesh) -> float:
    """Area [L²] by Green's theorem on the elements, exactly."""
    xi, weights = reference_element.gauss_legendre(EXACT_ORDER)
    points = np.einsum("gk,mkx->mgx", reference_element.values(xi), mesh.nodes[mesh.elements] - mesh.center)
    tangents = mesh.tangents_at(xi)
    flux = points[..., 0] * tangents[..., 1] - points[..., 1] * tangents[..., 0]
    return float(np.einsum("mg,g->", flux, weights)) / 2


@frozen
class Loading:
    """Values on the boundary and loads on the volume; loadings of one body prescribe values at the same places.

    Parameters
    ----------
    values : prescribed displacements and tractions
    particular : a field in equilibrium with the volume loads
    true_forces, true_moments : resultants (b, 2) [p L] of all tractions and volume loads on each body, and their
        moments (b,) about the middle of the mesh [p L²], on the curves themselves
    """

    values: BoundaryValues
    particular: ParticularSolution
    true_forces: Array = field(default_factory=lambda: np.zeros((1, 2)))
    true_moments: Array = field(default_factory=lambda: np.zeros(1))

    @property
    def true_force(self) -> Array:
        """Resultant (2,) [p L] on all bodies."""
        return self.true_forces.sum(axis=0)

    def of_part(self, part: MeshPart) -> "Loading":
        """The loading of one body on its own mesh; without resultants unless it is the only body."""
        if part.whole:
            return self
        particular = self.particular
        return Loading(
            values=self.values.of_part(part),
            particular=replace(
                particular,
                displacement=particular.displacement[part.nodes],
                traction=particular.traction[part.elements],
            ),
        )

    def turned(self, turn: Array) -> "Loading":
        """The loading, without resultants, on a body that is turned by a rotation (2, 2), x @ turn."""
        values, particular = self.values, self.particular
        return Loading(
            values=replace(values, displacement=values.displacement @ turn, traction=values.traction @ turn),
            particular=replace(
                particular, displacement=particular.displacement @ turn, traction=particular.traction @ turn
            ),
        )

    def forces(self, mesh: Mesh) -> Array:
        """Forces of the prescribed tractions at each (element, local node), (m, 3, 2) [p L]."""
        return mesh.tributary[..., None] * self.values.traction

    def true_work(self, mesh: Mesh, motions: FreeMotions) -> Array:
        """Work (k,) in rigid motions [p L] on the exact curves, to round-off: it does not depend on the mesh."""
        (x, y), (force_x, force_y) = (motions.centers[: len(self.true_forces)] - mesh.center).T, self.true_forces.T
        moments = (self.true_moments - (x * force_y - y * force_x)) / motions.radius  # about the centers
        return motions.of_bodies @ np.array([force_x, force_y, moments]).T.ravel()

    def magnitude(self, mesh: Mesh) -> float:
        """Sum of the magnitudes of all loads [p L]."""
        forces = self.forces(mesh)
        return float(np.hypot(forces[..., 0], forces[..., 1]).sum() + self.particular.magnitude)


def permanent_loading(problem: Problem, mesh: Mesh) -> Loading:
    """The loading by the problem's own conditions and loads; `ProblemError` if these contradict at a corner."""
    try:
        return _loading(problem, mesh, problem.edge_conditions, problem.volume_loads[0])
    except ProblemError as error:
        raise ProblemError([replace(item, path=problem.condition_path(item.path)) for item in error.issues]) from None


def case_loadings(problem: Problem, mesh: Mesh) -> list[Loading]:
    """The loading by each load case alone; `ProblemError` if it contradicts itself at a corner."""
    if not problem.load_cases:
        return []
    cases = zip(problem.load_cases.items(), problem.volume_loads[1:], strict=True)
    return [_case_loading(problem, mesh, name, case, loads) for (name, case), loads in cases]


def combined(loadings: Sequence[Loading], factors: Sequence[float]) -> Loading:
    """The sum of loadings with factors."""
    first = loadings[0]
    if [*factors] == [1.0]:
        return first
    values = [loading.values for loading in loadings]
    parts = [loading.particular for loading in loadings]
    return Loading(
        values=replace(
            first.values,
            displacement=_sum(factors, (item.displacement for item in values)),
            traction=_sum(factors, (item.traction for item in values)),
        ),
        particular=ParticularSolution(
            displacement=_sum(factors, (part.displacement for part in parts)),
            traction=_sum(factors, (part.traction for part in parts)),
            magnitude=float(_sum(np.abs(factors), (part.magnitude for part in parts))),
        ),
        true_forces=_sum(factors, (loading.true_forces for loading in loadings)),
        true_moments=_sum(factors, (loading.true_moments for loading in loadings)),
    )


def _sum(factors: Iterable[float], arrays: Iterable[Array | float]) -> Array:
    return np.asarray(sum(factor * array for factor, array in zip(factors, arrays, strict=True)))


def _loading(problem: Problem, mesh: Mesh, conditions: Mapping[str, Condition], loads: Sequence[Loads]) -> Loading:
    """Spread conditions by edge, and volume loads by body, over the mesh."""
    resultants = [
        _resultant(part, its, conditions, mesh.center) for part, its in zip(problem.parts, loads, strict=True)
    ]
    forces, moments = zip(*resultants, strict=True)
    return Loading(
        values=boundary_values(problem, conditions, mesh),
        particular=particular_solutions(problem, mesh, loads),
        true_forces=np.array(forces),
        true_moments=np.array(moments),
    )


def _resultant(part: Part, loads: Loads, conditions: Mapping[str, Condition], center: Array) -> tuple[Array, float]:
    """Resultant (2,) [p L] of all loads on a body and its moment about the center [p L²]."""
    edges = part.edges
    force, moment = true_resultant(edges, loads, center)
    for edge in edges:
        if edge.name in conditions and conditions[edge.name].presses:
            points, normals, lengths, along = along_curve(edge)
            forces = lengths[:, None] * applied_traction(conditions[edge.name], points, normals, along)
            x, y = (points - center).T
            force = force + forces.sum(axis=0)
            moment += float(x @ forces[:, 1] - y @ forces[:, 0])
    return force, moment


def particular_solutions(problem: Problem, mesh: Mesh, loads: Sequence[Loads]) -> ParticularSolution:
    """Particular solutions of the volume loads on each body."""
    result = ParticularSolution(
        displacement=np.zeros_like(mesh.nodes), traction=np.zeros((*mesh.elements.shape, 2)), magnitude=0.0
    )
    if not any(its.given for its in loads):
        return result
    magnitude = 0.0
    for part, on_mesh, its in zip(problem.parts, mesh.parts, loads, strict=True):
        own = particular_solution(its, part.material, on_mesh.mesh)
        result.displacement[on_mesh.nodes], result.traction[on_mesh.elements] = own.displacement, own.traction
        magnitude += own.magnitude
    return replace(result, magnitude=magnitude)


def _case_loading(problem: Problem, mesh: Mesh, name: str, case: LoadCase, loads: Sequence[Loads]) -> Loading:
    """The loading by a load case; displacements that the problem prescribes and the case does not give are zero."""
    conditions: dict[str, Condition] = {}
    for edge in {**problem.edge_conditions, **case.conditions}:
        held = problem.edge_conditions[edge].displacement.given if edge in problem.edge_conditions else ()
        added = case.conditions.get(edge)
        given = {axis: getattr(added.displacement, axis, None) if added else None for axis in held}
        displacement = AxisFields(**{axis: value or Field(constant=0.0) for axis, value in given.items()})
        if held or added:
            conditions[edge] = Condition.model_construct(
                displacement=displacement,
                traction=added.traction if added else AxisFields(),
                pressure=added.pressure if added else None,
                force=added.force if added else (),
            )
    try:
        return _loading(problem, mesh, conditions, loads)
    except ProblemError as error:
        raise ProblemError([replace(item, path=("load_cases", name, *item.path)) for item in error.issues]) from None
