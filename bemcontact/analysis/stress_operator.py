"""Stress at points as a linear function of contact pressures and rigid amplitudes, for models that bound it."""

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.adaptivity.adapt import meshed
from bemcontact.analysis.body_stress import infinite_starts, kinds
from bemcontact.analysis.result import Result
from bemcontact.analysis.solve import ensure_kind
from bemcontact.analysis.stress_of_bodies import numbers_of, owners, placed_in
from bemcontact.arrays import Array, BoolArray
from bemcontact.bem.body import Body
from bemcontact.bem.condense import Condensation, boundary_columns, condensed
from bemcontact.bem.outline import Outline
from bemcontact.bem.stress_field import StressField, smooth_starts
from bemcontact.contact.stress import PointKind
from bemcontact.contact.stress_operator import StressOperator
from bemcontact.errors import ProblemError
from bemcontact.problems.problem import Problem
from bemcontact.threads import one_thread


@one_thread
def stress_operator(problem: Problem | Result, points: ArrayLike, body: str | None = None) -> StressOperator:
    """Stress at points of bodies as a linear function of contact pressures and rigid amplitudes.

    Parameters
    ----------
    problem : a Problem, which is condensed as by `bemcontact.condense`, or a Result, whose mesh is taken
    points : (k, 2) places (x, y) in the undeformed bodies [L], none of them where stress may be infinite
    body : name of the body that has the points, where several touch; as of `Result.stress` if left out

    Returns
    -------
    StressOperator
        Its `contact` is the condensed contact to which its columns belong; `bemcontact.model` takes it.

    Raises
    ------
    ProblemError
        If there is no such body, or a point is outside the bodies or where stress may be infinite; otherwise as of
        `condense`.
    SingularSystemError
        If the equations of a body have no unique solution.
    """
    if isinstance(problem, Result):
        if problem.problem is None:
            raise ProblemError("the result of a condensed problem has no body; give the Problem itself")
        return operator_of(condensed(problem.problem), points, body)
    ensure_kind(problem, Problem, Result)
    return operator_of(meshed(problem.without_joints(), errors=False).condensation, points, body)


def operator_of(condensation: Condensation, points: ArrayLike, name: str | None = None) -> StressOperator:
    """The operator of bodies that have been condensed."""
    body, contact = condensation.body, condensation.contact
    columns = boundary_columns(condensation)
    smooth = smooth_starts(body.outline)
    infinite = _may_be_infinite(body, smooth)
    numbers = numbers_of([part.name for part in body.problem.parts], name)
    fields = [_field_of(body, number, *columns, smooth) for number in numbers]
    placed = placed_in(fields, points)
    owner, rows = owners(placed), np.arange(len(placed[0].points))
    kind, values = [], []
    for number, field, at in zip(numbers, fields, placed, strict=True):
        kind.append(kinds(field, at, infinite[body.mesh.parts[number].elements]))
        in_plane = field.stress(at)
        values.append(np.concatenate([in_plane, field.out_of_plane(in_plane, at.points)[None]]))
    of_kind = np.stack(kind)[owner, rows]
    if (of_kind == PointKind.SINGULAR).any():
        first = int(np.argmax(of_kind == PointKind.SINGULAR))
        x, y = placed[0].points[first]
        raise ProblemError(
            f"points[{first}] = ({x:.6g}, {y:.6g}) is at a corner, a change of conditions or an end of a contact zone "
            "where stress may be infinite; give points at some distance from it"
        )
    components, loads = np.stack(values)[owner, :, rows], len(body.loadings)
    return StressOperator(
        contact=contact,
        points=placed[0].points,
        kind=of_kind,
        pressure=components[..., loads:],
        amplitudes=np.zeros((*components.shape[:2], contact.rigid_motions.shape[1])),
        loads=components[..., :loads],
    )


def _field_of(body: Body, number: int, displacement: Array, traction: Array, smooth: BoolArray) -> StressField:
    """Field of the elastic body of a number, by each loading and each unit pressure alone."""
    mesh, elements, nodes = body.mesh.parts[number]
    loads = [of_parts[number] for of_parts in body.problem.volume_loads]
    factors = np.zeros((displacement.shape[2], len(loads)))
    np.fill_diagonal(factors, 1.0)
    outline = Outline(problem=body.problem, mesh=mesh)
    material = body.problem.parts[number].material
    parts = displacement[nodes], traction[elements], loads, factors, smooth[elements]
    return StressField.of(outline, material, *parts)


def _may_be_infinite(body: Body, smooth: BoolArray) -> BoolArray:
    """Whether stress is infinite where each element starts, if no element that may touch does, or all of them do."""
    problem, mesh, points = body.problem, body.mesh, body.points
    touching = np.zeros((len(problem.zones), len(mesh.elements)), bool)
    touching[points.zone_of_share, points.element] = True
    for number, facing in points.facing.items():
        touching[number, facing[touching[number] & (facing >= 0)]] = True
    none = infinite_starts(problem, mesh, smooth, np.zeros_like(touching))
    return none | infinite_starts(problem, mesh, smooth, touching)
