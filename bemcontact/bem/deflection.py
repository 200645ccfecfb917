"""The body under other loads and touching nothing: the contour that it is deflected to may be a rigid surface."""

from dataclasses import replace

from bemcontact.arrays import Array
from bemcontact.bem.boundary_values import BoundaryValues, boundary_values
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.factorisation import solve
from bemcontact.bem.loading import Loading
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.rigid_motions import free_rigid_motions
from bemcontact.bem.system import System
from bemcontact.bem.volume_loads import particular_solution
from bemcontact.errors import Issue, KeyPath, ProblemError
from bemcontact.problem.problem import Problem
from bemcontact.problem.rigid_surface import DeflectedContour


def deflections(problem: Problem, mesh: Mesh) -> dict[str, Array]:
    """Deflect the body to each contour that serves as a rigid surface.

    Parameters
    ----------
    problem : Problem
    mesh : of it

    Returns
    -------
    dict
        By contact zone, for those on a deflected contour: displacement (N, 2) [L] of the nodes.

    Raises
    ------
    ProblemError
        If the conditions of a contour contradict each other, or leave the body free to move.
    SingularSystemError
        If the equations of the body have no unique solution.
    """
    surfaces = {name: zone.surface for name, zone in problem.contact_zones.items()}
    return {
        name: _deflection(problem, mesh, surface, ("contact_zones", name, "surface"))
        for name, surface in surfaces.items()
        if isinstance(surface, DeflectedContour)
    }


def _deflection(problem: Problem, mesh: Mesh, surface: DeflectedContour, path: KeyPath) -> Array:
    """Displacement (N, 2) [L] of the body under the loads that shape a contour, whose path of keys is given."""
    values = _boundary_values(problem, mesh, surface, path)
    motions = free_rigid_motions(mesh, values.displacement_given)
    if len(motions):
        message = (
            f"with these conditions nothing holds the body against the {' and the '.join(motions.describe())}, for "
            "there is no contact where the contour is found; prescribe displacements that hold it"
        )
        raise ProblemError(Issue(path=(*path, "conditions"), message=message))
    loading = Loading(values=values, particular=particular_solution(surface.loads, problem.material, mesh))
    system = System(
        mesh=mesh, material=problem.material, points=ContactPoints.none(mesh), motions=motions, loadings=(loading,),
    )  # fmt: skip
    displacement, _ = system.fields(solve(system)[:, 0], loading)
    return displacement


def _boundary_values(problem: Problem, mesh: Mesh, surface: DeflectedContour, path: KeyPath) -> BoundaryValues:
    """Spread the conditions of a contour; issues about its own get the path to them."""
    other = problem.model_copy(update={"conditions": problem.conditions | surface.conditions})
    try:
        return boundary_values(other, mesh)
    except ProblemError as error:
        issues = [
            replace(item, path=(*path, *item.path)) if item.path[1] in surface.conditions else item
            for item in error.issues
        ]
        raise ProblemError(issues) from None
