"""What acts on a body, on its mesh: prescribed values, volume loads, and the resultant of all; it may be combined."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.boundary_values import BoundaryValues, applied_traction, boundary_values
from bemcontact.bem.mesh import Mesh, along_curve
from bemcontact.bem.rigid_motions import RigidMotions
from bemcontact.bem.volume_loads import ParticularSolution, particular_solution, true_resultant
from bemcontact.errors import ProblemError
from bemcontact.problem.conditions import AxisFields, Condition, Field, Loads
from bemcontact.problem.load_case import LoadCase
from bemcontact.problem.problem import Problem


@dataclass(frozen=True, kw_only=True, eq=False)
class Loading:
    """Values on the boundary and loads on the volume; loadings of one body share what is prescribed, not its values.

    Parameters
    ----------
    values : prescribed displacements and tractions
    particular : a field in equilibrium with the volume loads
    true_force, true_moment : resultant (2,) [p L] of all tractions and volume loads, and their moment about the middle
        of the body [p L²], on the curves themselves
    """

    values: BoundaryValues
    particular: ParticularSolution
    true_force: Array = field(default_factory=lambda: np.zeros(2))
    true_moment: float = 0.0

    def forces(self, mesh: Mesh) -> Array:
        """What the prescribed tractions do at each (element, local node), (m, 3, 2) [p L]."""
        return mesh.tributary[..., None] * self.values.traction

    def resultant(self, mesh: Mesh) -> Array:
        """Force (2,) of all tractions and volume loads on the mesh [p L]."""
        return self.forces(mesh).sum(axis=(0, 1)) + self.particular.force

    def work(self, mesh: Mesh, motions: RigidMotions) -> Array:
        """Work (k,) in rigid motions [p L], with tributary weights as in all of equilibrium."""
        work = motions.work(mesh.nodes[mesh.elements], self.forces(mesh))
        return work + motions.work_of(self.particular.force, self.particular.moment)

    def true_work(self, mesh: Mesh, motions: RigidMotions) -> Array:
        """The same (k,) on the curves themselves, to round-off: whether loads balance is no matter of the mesh."""
        return motions.work_of(self.true_force, self.true_moment, about=mesh.center)

    def magnitude(self, mesh: Mesh) -> float:
        """Sum of the magnitudes of all loads [p L]."""
        forces = self.forces(mesh)
        return float(np.hypot(forces[..., 0], forces[..., 1]).sum() + self.particular.magnitude)


def permanent_loading(problem: Problem, mesh: Mesh) -> Loading:
    """What the problem's own conditions and loads do; `ProblemError` if they contradict each other at a corner."""
    return _loading(problem, mesh, problem.conditions, problem.loads)


def case_loadings(problem: Problem, mesh: Mesh) -> list[Loading]:
    """What each load case does by itself; `ProblemError` likewise."""
    return [_case_loading(problem, mesh, name, case) for name, case in problem.load_cases.items()]


def combined(loadings: Sequence[Loading], factors: Sequence[float]) -> Loading:
    """The sum of loadings with factors."""
    first = loadings[0]
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
            force=_sum(factors, (part.force for part in parts)),
            moment=float(_sum(factors, (part.moment for part in parts))),
            magnitude=float(_sum(np.abs(factors), (part.magnitude for part in parts))),
        ),
        true_force=_sum(factors, (loading.true_force for loading in loadings)),
        true_moment=float(_sum(factors, (loading.true_moment for loading in loadings))),
    )


def _sum(factors: Iterable[float], arrays: Iterable[Array | float]) -> Array:
    return np.asarray(sum(factor * array for factor, array in zip(factors, arrays, strict=True)))


def _loading(problem: Problem, mesh: Mesh, conditions: Mapping[str, Condition], loads: Loads) -> Loading:
    """Spread conditions and volume loads over the mesh."""
    acting = problem.model_copy(update={"conditions": dict(conditions), "loads": loads})
    force, moment = true_resultant(acting)
    moment -= mesh.center[0] * force[1] - mesh.center[1] * force[0]
    for edge in problem.boundary.edges:
        if edge.name in conditions:
            points, normals, lengths = along_curve(edge)
            forces = lengths[:, None] * applied_traction(conditions[edge.name], points, normals)
            x, y = (points - mesh.center).T
            force = force + forces.sum(axis=0)
            moment += float(x @ forces[:, 1] - y @ forces[:, 0])
    return Loading(
        values=boundary_values(acting, mesh),
        particular=particular_solution(loads, problem.material, mesh),
        true_force=force,
        true_moment=moment,
    )


def _case_loading(problem: Problem, mesh: Mesh, name: str, case: LoadCase) -> Loading:
    """What a load case does: displacements that it does not give are zero where the problem prescribes some."""
    conditions: dict[str, Condition] = {}
    for edge in {**problem.conditions, **case.conditions}:
        held = problem.conditions[edge].displacement.given if edge in problem.conditions else ()
        added = case.conditions.get(edge)
        given = {axis: getattr(added.displacement, axis, None) if added else None for axis in held}
        displacement = AxisFields(**{axis: value or Field(constant=0.0) for axis, value in given.items()})
        if held or added:
            conditions[edge] = Condition.model_construct(
                displacement=displacement,
                traction=added.traction if added else AxisFields(),
                pressure=added.pressure if added else None,
            )
    try:
        return _loading(problem, mesh, conditions, case.loads)
    except ProblemError as error:
        raise ProblemError([replace(item, path=("load_cases", name, *item.path)) for item in error.issues]) from None
