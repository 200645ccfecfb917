"""Stress at points as a linear function of contact pressures and rigid amplitudes, for models that bound it."""

import numpy as np
from numpy.typing import ArrayLike

from bemcontact.adaptivity.adapt import meshed
from bemcontact.analysis.body_stress import ensure_in_body, infinite_starts, kinds
from bemcontact.analysis.result import Result
from bemcontact.analysis.solve import ensure_kind
from bemcontact.arrays import BoolArray, IntArray, real_array
from bemcontact.bem.condense import Condensation, boundary_columns, condensed
from bemcontact.bem.stress_field import StressField
from bemcontact.blas_threads import one_thread
from bemcontact.contact.stress import PointKind
from bemcontact.contact.stress_operator import StressOperator
from bemcontact.errors import ProblemError
from bemcontact.problem.problem import Problem


@one_thread
def stress_operator(problem: Problem | Result, points: ArrayLike) -> StressOperator:
    """Stress at points of a body as a linear function of its contact pressures and rigid amplitudes.

    Parameters
    ----------
    problem : a Problem, which is condensed as by `bemcontact.condense`, or a Result, whose mesh is taken
    points : (k, 2) places (x, y) in the undeformed body [L], none of them where stress may be infinite

    Returns
    -------
    StressOperator
        Its `contact` is the condensed body to which its columns belong; `bemcontact.model` takes it.

    Raises
    ------
    ProblemError
        If there are several bodies, or a point is outside the body or where stress may be infinite; otherwise as of
        `condense`.
    SingularSystemError
        If the equations of the body have no unique solution.
    """
    if isinstance(problem, Result):
        if problem.problem is None:
            raise ProblemError("the result of a condensed problem has no body; give the Problem itself")
        return operator_of(condensed(problem.problem), points)
    ensure_kind(problem, Problem, Result)
    return operator_of(meshed(problem.without_joints(), errors=False).condensation, points)


def operator_of(condensation: Condensation, points: ArrayLike) -> StressOperator:
    """The operator of a body that has been condensed."""
    body, contact = condensation.body, condensation.contact
    part, *others = body.problem.parts
    if others:
        raise ProblemError(
            "a stress operator is of one body, and this problem has several; ask the result for its stress"
        )
    displacement, traction = boundary_columns(condensation)
    loads = [of_parts[0] for of_parts in body.problem.volume_loads]
    factors = np.zeros((displacement.shape[2], len(loads)))
    np.fill_diagonal(factors, 1.0)
    field = StressField.of(body.outline, part.material, displacement, traction, loads, factors)
    at = field.locate(real_array(points, "points", (None, 2)))
    ensure_in_body(field, at)
    kind = kinds(field, at, _may_be_infinite(field, body.points.element))
    if (kind == PointKind.SINGULAR).any():
        first = int(np.argmax(kind == PointKind.SINGULAR))
        x, y = at.points[first]
        raise ProblemError(
            f"points[{first}] = ({x:.6g}, {y:.6g}) is at a corner, a change of conditions or an end of a contact zone "
            "where stress may be infinite; give points at some distance from it"
        )
    in_plane = field.stress(at)
    values = np.concatenate([in_plane, field.out_of_plane(in_plane, at.points)[None]]).transpose(1, 0, 2)
    count = len(loads)
    return StressOperator(
        contact=contact,
        points=at.points,
        kind=kind,
        pressure=values[..., count:],
        amplitudes=np.zeros((*values.shape[:2], contact.rigid_motions.shape[1])),
        loads=values[..., :count],
    )


def _may_be_infinite(field: StressField, touching: IntArray) -> BoolArray:
    """Whether stress is infinite where each element starts, if no element that may touch does, or all of them do."""
    pressed = np.zeros(len(field.mesh.elements), bool)
    without = infinite_starts(field, pressed)
    pressed[touching] = True
    return without | infinite_starts(field, pressed)
