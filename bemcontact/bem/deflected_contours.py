"""The surfaces of deflected contours: the body under loads of their own, without contact."""

from dataclasses import replace

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.boundary_values import BoundaryValues, boundary_values
from bemcontact.bem.loading import Loading, particular_solution
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.rigid_motions import free_rigid_motions
from bemcontact.bem.solution import solve_system
from bemcontact.bem.system import System
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.errors import Issue, KeyPath, ProblemError
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour


def deflection(problem: Problem, mesh: Mesh, zone: str, surface: DeflectedContour) -> Array:
    """Displacement (N, 2) [L] of the nodes of the body of a zone under the loads that shape its contour.

    That of other bodies is zero. `ProblemError` if the conditions of the contour contradict each other, or leave the
    body free to move.
    """
    path: KeyPath = ("contact_zones", zone, "surface")
    body = problem.part_of(problem.edges_of(zone)[0])
    part, of_part = next(pair for pair in zip(problem.parts, mesh.parts, strict=True) if pair[0].name == body)
    own = of_part.mesh
    values = _boundary_values(problem, own, surface, path)
    motions = free_rigid_motions(own, values)
    if len(motions):
        message = (
            f"with these conditions nothing holds the body against the {' and the '.join(motions.describe())}, for "
            "the contour is computed without contact; prescribe displacements that hold it"
        )
        raise ProblemError(Issue(path=(*path, "conditions"), message=message))
    loading = Loading(values=values, particular=particular_solution(surface.loads, part.material, own))
    system = System(
        mesh=own, material=part.material, points=UnitPressures.none(), motions=motions, loadings=(loading,),
    )  # fmt: skip
    displacement = np.zeros_like(mesh.nodes)
    displacement[of_part.nodes], _ = system.fields(solve_system(system).combined(np.ones(1)), loading)
    return displacement


def _boundary_values(problem: Problem, mesh: Mesh, surface: DeflectedContour, path: KeyPath) -> BoundaryValues:
    """Spread the conditions of a contour over the mesh; issues of its own conditions get its key path."""
    conditions = problem.edge_conditions | surface.conditions
    try:
        return boundary_values(
            problem, {edge: conditions[edge] for edge in mesh.edge_names if edge in conditions}, mesh
        )
    except ProblemError as error:
        issues = [
            replace(item, path=(*path, *item.path) if own else problem.condition_path(item.path))
            for item in error.issues
            for own in [item.path[1] in surface.conditions]
        ]
        raise ProblemError(issues) from None
