"""QP3, (40)-(42): the quadratic program in pressures and rigid amplitudes, written in cvxpy and solved by Clarabel.

    minimize   pᵀJ(ε + Δ1 + R a) + pᵀJ M p    over p, a
    subject to ε + Δ1 + M p + R a >= 0,  p >= 0,  ℓᵀp = -load

In equilibrium the objective is pᵀJδ, (19). M stays unsymmetric in the constraints; the objective sees its symmetric
part only, which changes no value of it.

The solver is given the forces f = J p of the contact points, J tributary. The multipliers of f >= 0 and δ >= 0 are then
gaps and forces, so that primal and dual numbers have the same sizes. Over p, columns of short elements are as small as
their weights, and the regularization of the solver hides them.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigvalsh

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status, Trace
from bemcontact.errors import NotConvexError, SolverError
from bemcontact.formulations.clarabel import STATUSES, minimize_convex
from bemcontact.formulations.complementarity import escape_note, polish
from bemcontact.formulations.piqp import minimize_by_piqp
from bemcontact.formulations.scaling import ACCEPTED, ScaledContact, scale, scaled_point, scaled_weights, unscaled
from bemcontact.frozen import frozen
from bemcontact.options import ConvexSolver, FormulationName, SolveOptions, Weights, options_of

NEGLIGIBLE = 1e-10
"""Entry of ZᵀJR, or negative eigenvalue, that is round-off; by the scaling the numbers are of size one."""
NAMES = {ConvexSolver.CLARABEL: "Clarabel", ConvexSolver.PIQP: "PIQP"}
MANY_POINTS = 500
"""Number of contact points from which Clarabel takes some hundred times longer than the direct solver."""
SLOW = (
    "Clarabel is slow for so many contact points: the direct solver is some hundred times faster, and the solver "
    "piqp a few times"
)
SLIGHT = 1e-2
"""Negative part of a Hessian, relative to its largest eigenvalue, that is attributed to the mesh."""


def import_cvxpy() -> None:
    """Import cvxpy, which takes half a second, so that later steps can be timed."""
    import cvxpy  # noqa: F401


@frozen
class Objective:
    """½ pᵀH p + cᵀp + bᵀa + d, which is pᵀJ(q + M p + R a) for every p in equilibrium.

    Parameters
    ----------
    hessian : (n, n) H, positive semidefinite on all of space if it is on the equilibrium space
    pressure : (n,) c
    amplitudes : (k,) b
    constant : d
    """

    hessian: Array
    pressure: Array
    amplitudes: Array
    constant: float

    def value(self, pressure: Array, amplitudes: Array) -> float:
        """The objective at p (n,) and a (k,)."""
        quadratic = 0.5 * pressure @ self.hessian @ pressure
        return float(quadratic + self.pressure @ pressure + self.amplitudes @ amplitudes + self.constant)


def objective(scaled: ScaledContact, J: Array) -> Objective:
    """Write pᵀJδ as a convex function of (p, a) by means of equilibrium; J (n, n) is scaled.

    With P = I - R(ℓᵀR)⁻¹ℓᵀ and p0 = -R(ℓᵀR)⁻¹load every p in equilibrium is P p + p0, so that
    pᵀJM p = (P p)ᵀJM(P p) + p0ᵀ(JM + MᵀJᵀ)P p + p0ᵀJM p0. And if JR = ℓC, then pᵀJR a = -loadᵀC a; C = I for the
    tributary J.
    """
    weighted, project, p0 = J @ scaled.compliance, scaled.projector, scaled.balancing_pressure
    hessian = weighted + weighted.T
    share = np.linalg.lstsq(scaled.equilibrium, J @ scaled.rigid_motions, rcond=None)[0]
    return Objective(
        hessian=project.T @ hessian @ project,
        pressure=J @ scaled.offset + project.T @ (hessian @ p0),
        amplitudes=-share.T @ scaled.motion_load,
        constant=float(p0 @ weighted @ p0),
    )


def smallest_eigenvalue(scaled: ScaledContact, J: Array) -> float | None:
    """Smallest eigenvalue of Zᵀ(JM + MᵀJᵀ)Z, Z spanning {p : ℓᵀp = 0}: the curvature on the equilibrium space.

    J (n, n) is scaled. Where ZᵀJR is not zero, pᵀJR a makes the objective a saddle in (p, a), and the eigenvalue is
    that of the Hessian in both; the tributary weights exclude this. None if equilibrium leaves no pressure free (n =
    k).
    """
    R, Z = scaled.rigid_motions, scaled.equilibrium_space
    n, k = R.shape
    if n == k:
        return None
    weighted = J @ scaled.compliance
    hessian = Z.T @ (weighted + weighted.T) @ Z
    coupling = Z.T @ J @ R
    if np.abs(coupling).max(initial=0.0) > NEGLIGIBLE:
        hessian = np.block([[hessian, coupling], [coupling.T, np.zeros((k, k))]])
    return float(eigvalsh(hessian, subset_by_index=(0, 0))[0])


def solve(contact: CondensedContact, options: SolveOptions | None = None) -> ContactSolution:
    """Minimize QP3, (40)-(42), on the scaled problem, then polish.

    With the consistent weights the minimum need not be the contact state, because J has negative entries. The result is
    then not polished. `smallest_eigenvalue` is that of the scaled Hessian. The history begins at Clarabel's start:
    `Objective.value`, and as "infeasibility" the residual of the constraints that Clarabel holds against its tolerance,
    relative to their terms where those are larger than one. PIQP has no history.

    Raises
    ------
    NotConvexError
        The Hessian has a negative eigenvalue on the equilibrium space; with the tributary weights, one of more than a
        hundredth of the largest.
    ProblemError
        The problem does not carry the weights asked for, or an option has no meaning for QP3.
    OptionError
        PIQP is not installed.
    SolverError
        The solver broke down, and left no point. A point that is left is polished, and a note says what happened.
    """
    options = options_of(FormulationName.QP3, options)
    scaled, J = scale(contact), scaled_weights(contact, options.weights)
    eigenvalue = smallest_eigenvalue(scaled, J)
    work = objective(scaled, J)
    notes = []
    if eigenvalue is not None and eigenvalue < -NEGLIGIBLE:
        work = nearly_convex(work, eigenvalue, options.weights)
        notes.append(
            f"QP3 is not convex on this mesh (smallest eigenvalue {eigenvalue:.1e}): it was solved without the "
            "negative part of its Hessian, as a start for the active-set step"
        )
    optimum = _minimized(scaled, work, options)
    if optimum.status is Status.INFEASIBLE and (escape := escape_note(contact)):
        notes.append(escape)
    notes += [optimum.note] if optimum.note else []
    if contact.size >= MANY_POINTS and options.solver is ConvexSolver.CLARABEL:
        notes.append(SLOW)
    p, u_n, a = unscaled(contact, optimum.pressure, optimum.amplitudes)
    solution = ContactSolution(
        formulation=FormulationName.QP3,
        solver=NAMES[options.solver],
        status=optimum.status,
        pressure=p,
        displacement=u_n,
        rigid_amplitudes=a,
        iterations=optimum.iterations,
        smallest_eigenvalue=eigenvalue,
        history=tuple(
            Trace(quantity=quantity, first=0, values=tuple(values.tolist()))
            for quantity, values in zip(("objective", "infeasibility"), optimum.progress.T, strict=True)
            if len(values)
        ),
        notes=tuple(notes),
    )
    if not (options.polish and options.weights is not Weights.CONSISTENT and optimum.has_point):
        return solution
    polished = polish(contact, solution)
    return _rescued(contact, polished) if optimum.status is Status.NUMERICAL_FAILURE else polished


def _rescued(contact: CondensedContact, solution: ContactSolution) -> ContactSolution:
    """A solution of which Clarabel gave the start only: solved if the active-set steps led to a contact state."""
    if scale(contact).residual(*scaled_point(contact, solution.pressure, solution.rigid_amplitudes)) > ACCEPTED:
        return solution
    note = "the active-set steps from the point that Clarabel left led to the contact state"
    return replace(solution, status=Status.SOLVED, notes=(*solution.notes, note))


@frozen
class _Optimum:
    """Outcome of the quadratic program; pressure and amplitudes are zeros if there is no point."""

    status: Status
    pressure: Array
    amplitudes: Array
    iterations: int
    has_point: bool
    progress: Array
    """Objective and relative residual of the constraints, at the start and after each iteration."""
    note: str


def _minimized(scaled: ScaledContact, work: Objective, options: SolveOptions) -> _Optimum:
    """State the quadratic program over forces in cvxpy, and solve it."""
    import cvxpy as cp

    w, R = scaled.weights, scaled.rigid_motions
    n, k = R.shape
    f = cp.Variable(n, nonneg=True, name="force")
    a = cp.Variable(k, name="rigid_amplitudes") if k else None
    goal = 0.5 * cp.quad_form(f, cp.psd_wrap(work.hessian / np.outer(w, w))) + (work.pressure / w) @ f
    gap, balance = scaled.offset + (scaled.compliance / w) @ f, []
    if a is not None:
        goal, gap, balance = goal + work.amplitudes @ a, gap + R @ a, [R.T @ f == -scaled.motion_load]
    program = cp.Problem(cp.Minimize(goal), [gap >= 0, *balance])
    try:
        if options.solver is ConvexSolver.PIQP:
            answer = minimize_by_piqp(program, options.max_iterations)
        else:
            answer = minimize_convex(program, options.max_iterations, equilibrate=False, leave_point=True)
    except SolverError as error:
        raise SolverError(
            f"{NAMES[options.solver]} found no solution of QP3; check the mesh for very short elements, or solve the "
            "complementarity problem directly"
        ) from error
    has_point, status = f.value is not None, STATUSES[str(program.status)]
    if options.solver is ConvexSolver.PIQP and not has_point:
        status = Status.NO_SOLUTION_FOUND  # it proves nothing
    return _Optimum(
        status=Status.NUMERICAL_FAILURE if answer.failed else status,
        pressure=np.asarray(f.value, float) / w if has_point else np.zeros(n),
        amplitudes=np.asarray(a.value, float) if has_point and a is not None else np.zeros(k),
        iterations=program.solver_stats.num_iters or 0,
        has_point=has_point,
        progress=answer.progress + np.array([work.constant, 0.0]),
        note=answer.note,
    )


def nearly_convex(work: Objective, eigenvalue: float, weights: Weights) -> Objective:
    """Drop the negative part of a Hessian that is slightly indefinite because of the mesh.

    Collocation leaves sym(JM) slightly indefinite on coarse meshes of slender bodies and at acute corners.
    `NotConvexError` if the weights are not tributary, or the eigenvalue is more than a hundredth of the largest.
    """
    values, vectors = np.linalg.eigh(work.hessian)
    if weights is Weights.TRIBUTARY and eigenvalue >= -SLIGHT * values[-1]:
        return replace(work, hessian=(vectors * np.maximum(values, 0.0)) @ vectors.T)
    remedy = "refine the mesh" if weights is Weights.TRIBUTARY else "use the tributary weights"
    raise NotConvexError(
        f"QP3 is not convex with {weights.value} weights: the smallest eigenvalue of its scaled Hessian on the "
        f"equilibrium space is {eigenvalue:.3e}; {remedy}, or solve the complementarity problem directly",
        smallest_eigenvalue=eigenvalue,
    )
