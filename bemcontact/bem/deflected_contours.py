"""The surfaces of deflected contours: the body under loads of their own, without contact."""

from dataclasses import replace

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.contact_points import UnitPressures
from bemcontact.bem.loading import Loading, particular_solution
from bemcontact.bem.mesh import BoundaryValues, Mesh, boundary_values
from bemcontact.bem.rigid_motions import free_rigid_motions
from bemcontact.bem.solution import solve_system
from bemcontact.bem.system import System
from bemcontact.errors import Issue, KeyPath, ProblemError
from bemcontact.problem.problem import Problem
from bemcontact.problem.rigid_surface import DeflectedContour


def deflection(problem: Problem, mesh: Mesh, surface: DeflectedContour, path: KeyPath) -> Array:
    """Displacement (N, 2) [L] of the nodes under the loads that shape a contour, whose path of keys is given.

    `ProblemError` if the conditions of the contour contradict each other, or leave the body free to move.
    """
    values = _boundary_values(problem, mesh, surface, path)
    motions = free_rigid_motions(mesh, values.displacement_given)
    if len(motions):
        message = (
            f"with these conditions nothing holds the body against the {' and the '.join(motions.describe())}, for "
            "the contour is computed without contact; prescribe displacements that hold it"
        )
        raise ProblemError(Issue(path=(*path, "conditions"), message=message))
    (part,) = problem.parts
    loading = Loading(values=values, particular=particular_solution(surface.loads, part.material, mesh))
    system = System(
        mesh=mesh, material=part.material, points=UnitPressures.none(), motions=motions, loadings=(loading,),
    )  # fmt: skip
    displacement, _ = system.fields(solve_system(system).combined(np.ones(1)), loading)
    return displacement


def _boundary_values(problem: Problem, mesh: Mesh, surface: DeflectedContour, path: KeyPath) -> BoundaryValues:
    """Spread the conditions of a contour over the mesh; issues of its own conditions get its key path."""
    try:
        return boundary_values(problem.edge_conditions | surface.conditions, mesh)
    except ProblemError as error:
        issues = [
            replace(item, path=(*path, *item.path)) if item.path[1] in surface.conditions else item
            for item in error.issues
        ]
        raise ProblemError(issues) from None
