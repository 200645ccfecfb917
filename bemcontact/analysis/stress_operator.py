"""Stress at points as a linear function of contact pressures and rigid amplitudes, for models that bound it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bemcontact.adaptivity.adapt import meshed
from bemcontact.analysis.body_stress import ensure_in_body, infinite_starts, kinds
from bemcontact.analysis.displaced_body import acting_volume_loads
from bemcontact.analysis.result import Result
from bemcontact.analysis.solve import ensure_kind
from bemcontact.analysis.stress import PointKind, Stress
from bemcontact.arrays import Array, BoolArray, IntArray, real_array
from bemcontact.bem.condense import Condensation, boundary_columns, condensed
from bemcontact.bem.stress_field import StressField
from bemcontact.blas_threads import one_thread
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.problem.problem import Problem


@dataclass(frozen=True, kw_only=True, eq=False)
class StressOperator:
    """σ = S_p p + S_a a + s_0 at k points, with s_0 = Σ_j f_j s_j over the loadings.

    The second axis of all parts counts σxx, σyy, σxy and σzz.
    """

    contact: CondensedContact
    """The condensed body, whose pressures p (n,) [p] and rigid amplitudes a (r,) [L] these are."""
    points: Array
    """Points (k, 2) [L] of the undeformed body."""
    kind: NDArray[np.str_]
    """A `PointKind` for each point: "inside", "boundary" or "corner"."""
    pressure: Array
    """S_p (k, 4, n)."""
    amplitudes: Array
    """S_a (k, 4, r) [p/L]: zero, for free motions are rigid."""
    loads: Array
    """s_j (k, 4, 1 + c) [p] of the permanent loads, then of what each load case adds."""

    @property
    def constant(self) -> Array:
        """s_0 (k, 4) [p] of the loads that act on `contact`."""
        return self.loads @ np.append(1.0, self.contact.cases.factors)

    def at(self, pressure: ArrayLike, amplitudes: ArrayLike | None = None) -> Stress:
        """Stress of pressures (n,) [p] and rigid amplitudes (r,) [L], zero if None, under the loads that act.

        Raises
        ------
        ProblemError
            If an array has another length.
        """
        p = real_array(pressure, "pressure", (self.pressure.shape[2],))
        zero = np.zeros(self.amplitudes.shape[2])
        a = zero if amplitudes is None else real_array(amplitudes, "amplitudes", zero.shape)
        values = self.pressure @ p + self.amplitudes @ a + self.constant
        return Stress(points=self.points, components=values[:, :3], zz=values[:, 3], kind=self.kind)


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
        If a point is outside the body, or at a place where stress may be infinite; otherwise as of `condense`.
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
    displacement, traction = boundary_columns(condensation)
    loads = acting_volume_loads(body)
    factors = np.zeros((displacement.shape[2], len(loads)))
    np.fill_diagonal(factors, 1.0)
    field = StressField.of(body.outline, displacement, traction, loads, factors)
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
