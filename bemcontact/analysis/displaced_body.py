"""The linear problem on a displaced body: what it changes of the answer, and the load at which the body buckles."""

from dataclasses import replace
from typing import NamedTuple, Self

import numpy as np

from bemcontact.adaptivity.mesh_sizes import cut
from bemcontact.arrays import Array, magnitudes
from bemcontact.bem.body import Body
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.condense import boundary_state, condense
from bemcontact.bem.discretization import body_of
from bemcontact.bem.loading import Loading, ParticularSolution, particular_solutions
from bemcontact.bem.mesh import Mesh
from bemcontact.contact.solution import Status
from bemcontact.errors import BemContactError
from bemcontact.formulations import complementarity

STEPS = 6
"""Largest dimension of the space of shapes in which the critical load is looked for."""
SETTLED = 0.05
"""Change of the loads over the critical ones by one more dimension, over them or one, below which they are settled."""
PROBE = 0.01
"""Largest slope of a displacement that probes for buckling."""
WAVES = 2.0
"""Waves of the first probe over the size of the body."""
FAINT = 0.02
"""Part of the largest force, or of the loads, that a force of contact counts with at least."""
HALF = 0.5
"""Part of its own displacement by which the body is displaced, forth and back."""


class StiffnessChange(NamedTuple):
    """How the stiffness against the displacement changes by it: 1 + tension f + 2 stretch f² after a part f of it.

    Parameters
    ----------
    tension : by loads that gain or lose levers, over the stiffness; negative where compression bends the body
    stretch : by the shape. A strip that is held at both ends and bends by w is a shallow arch, in which a further δw
        strains by w'δw'; as the load grows from zero the strain is w'²/2, and the stiffness that of half the change
    """

    tension: float = 0.0
    stretch: float = 0.0

    @classmethod
    def of_displacements(cls, forth: float, back: float) -> Self:
        """The change from the displacement over itself, under the same load, on the body displaced forth and back."""
        tension = (back - forth) / ((forth + back) * HALF)
        return cls(tension, (2 / (forth + back) - 1) / (2 * HALF**2))

    @classmethod
    def of_forces(cls, forth: float, back: float) -> Self:
        """The change from the force over itself, at the same displacement, on the body displaced forth and back."""
        return cls((forth - back) / (2 * HALF), ((forth + back) / 2 - 1) / (2 * HALF**2))

    @property
    def displacement(self) -> float:
        """Displacement x over that of linear theory, x (1 + tension) + stretch x³ = 1; infinite if there is none."""
        roots = np.roots([self.stretch, 0.0, 1 + self.tension, -1.0])
        real = roots.real[(abs(roots.imag) <= np.sqrt(np.finfo(float).eps) * abs(roots)) & (roots.real > 0)]
        return float(real.min(initial=np.inf))

    @property
    def force(self) -> float:
        """Force at the same displacement, over that of linear theory."""
        return max(1 + self.tension + self.stretch, 0.0)


class ProbedBody:
    """A body that is solved, then displaced and solved again, under the same loads, which move along with it.

    The elements are twice as long where the mesh has each of them halved: the change needs few digits. Gaps and normals
    of surfaces are those of the undisplaced places, and free motions do not displace: `placement` judges both.
    """

    def __init__(self, body: Body) -> None:
        refine = body.problem.mesh.refine
        self.loads = body.pinned.total(body.factors, body.forces)
        self.body = body if refine % 2 else body_of(cut(body.problem, refine // 2))
        self.elastic, self.forces = self._answer(np.zeros_like(self.body.mesh.nodes))

    def _answer(self, by: Array) -> tuple[Array, Array]:
        """Elastic displacement (N, 2) [L], and forces on the zones [p L], of the body displaced by (N, 2) [L]."""
        there = condense(displaced_body(self.body, by))
        solution = complementarity.solve(there.contact)
        if solution.status is not Status.SOLVED:
            raise BemContactError("contact does not hold the displaced body")
        state = boundary_state(there, solution.pressure, solution.rigid_amplitudes)
        forces = np.abs(self.body.points.tributary_by_zone(len(self.body.problem.zones))) @ solution.pressure
        return elastic_displacement(self.body, state), forces

    def _product(self, one: Array, other: Array) -> float:
        """Scalar product over the boundary of two displacements (N, 2) of nodes."""
        return float(_nodal_lengths(self.body.mesh) @ np.sum(one * other, axis=1))

    def change(self) -> tuple[StiffnessChange, StiffnessChange, int]:
        """How displacements change on the body that they displace, and how the force of the zone that does so most."""
        both = [self._answer(part * self.elastic) for part in (HALF, -HALF)]
        square = self._product(self.elastic, self.elastic)
        forth, back = (self._product(displacement, self.elastic) / square for displacement, _ in both)
        forces = np.array([force for _, force in both]) - self.forces
        least = FAINT * max(self.forces.max(), self.loads)  # beside which contact may be a rest of no interest
        forces = forces / np.maximum(self.forces, least) if least > 0 else 0.0 * forces
        i = int(np.argmax(abs(forces).max(axis=0)))
        return StiffnessChange.of_displacements(forth, back), StiffnessChange.of_forces(*(1 + forces[:, i]).tolist()), i

    def critical(self, size: float) -> float:
        """Loads over the critical ones, from displacements of up to this size [L]; 0 where they straighten the body.

        A small displacement v changes the answer by K⁻¹ K_g v, with the stiffness K and what the loads take from it,
        K_g. The largest eigenvalue is sought in the space of v, K⁻¹ K_g v and so on (Arnoldi).
        """
        shapes, images, found = list[Array](), list[Array](), 0.0
        image = _waves(self.body.mesh)
        for _ in range(STEPS):
            for shape in (*shapes, *shapes):
                image = image - self._product(image, shape) * shape
            shapes.append(image / np.sqrt(self._product(image, image)))
            step = min(size / abs(shapes[-1]).max(), PROBE / self._steepest(shapes[-1]))
            image = (self._answer(step * shapes[-1])[0] - self.elastic) / step
            images.append(image)
            reduced = [[self._product(shape, image) for image in images] for shape in shapes]
            before, found = found, max(float(np.linalg.eigvals(np.array(reduced)).real.max()), 0.0)
            if len(shapes) > 2 and abs(found - before) <= SETTLED * max(found, 1.0):
                break
        return found

    def _steepest(self, shape: Array) -> float:
        """Largest change of a displacement (N, 2) between neighboring nodes, over their distance."""
        mesh = self.body.mesh
        change, along = (np.diff(values[mesh.elements], axis=1) for values in (shape, mesh.nodes))
        return float((magnitudes(change) / magnitudes(along)).max())


def elastic_displacement(body: Body, state: BoundaryState) -> Array:
    """Displacement (N, 2) [L] of the nodes less the nearest free motions, in which bonded bodies move together."""
    mesh, displacement = body.mesh, np.zeros_like(body.mesh.nodes)
    displacement[mesh.elements] = state.displacement
    root = np.repeat(np.sqrt(_nodal_lengths(mesh)), 2)
    free = body.free.displacement(mesh).reshape(len(root), -1)
    nearest = np.linalg.lstsq(root[:, None] * free, root * displacement.ravel())[0]
    return displacement - (free @ nearest).reshape(-1, 2)


def _nodal_lengths(mesh: Mesh) -> Array:
    """Length (N,) [L] that belongs to each node."""
    return np.bincount(mesh.elements.ravel(), mesh.tributary.ravel()).astype(float)


def _waves(mesh: Mesh) -> Array:
    """A smooth displacement (N, 2) without symmetry."""
    x, phases = WAVES * np.pi * (mesh.nodes - mesh.center) / mesh.size, np.array([0.5, 1.7])
    return np.sin(x @ np.array([[1.0, 0.8], [0.7, -1.1]]) + phases) + np.cos(x @ np.array([[0.4, -0.5], [0.6, 0.3]]))


def displaced_body(body: Body, by: Array) -> Body:
    """The body with nodes that are displaced by (N, 2) [L], which take the loads and the places of contact along."""
    mesh = replace(body.mesh, nodes=body.mesh.nodes + by)
    parts = [particular_solutions(body.problem, mesh, loads) for loads in body.problem.volume_loads]
    loadings = [
        _taken_along(loading, part, body.mesh, mesh) for loading, part in zip(body.loadings, parts, strict=True)
    ]
    return replace(body, mesh=mesh, points=replace(body.points, mesh=mesh), loadings=tuple(loadings))


def _taken_along(loading: Loading, particular: ParticularSolution, mesh: Mesh, moved: Mesh) -> Loading:
    """The loading with the same forces at displaced places."""
    shrunk = (mesh.tributary / moved.tributary)[..., None]
    traction, stiffness = loading.values.traction * shrunk, loading.values.stiffness * shrunk[..., None]
    before = _moments(mesh, loading.values.traction - loading.particular.traction, mesh.center)
    after = _moments(moved, traction - particular.traction, moved.center)
    return replace(
        loading,
        values=replace(loading.values, traction=traction, stiffness=stiffness),
        particular=particular,
        true_moments=loading.true_moments + after - before,
    )


def _moments(mesh: Mesh, traction: Array, center: Array) -> Array:
    """Moment (b,) [p L²] on each body of tractions (m, 3, 2) about a center (2,)."""
    x, y = np.moveaxis(mesh.nodes[mesh.elements] - center, 2, 0)
    fx, fy = np.moveaxis(mesh.tributary[..., None] * traction, 2, 0)
    moments = x * fy - y * fx
    return np.array([moments[part.elements].sum() for part in mesh.parts])
