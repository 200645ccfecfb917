"""QP3, (40)-(42): the quadratic program in pressures and rigid amplitudes, written in cvxpy and solved by Clarabel.

    minimise   pᵀJ(ε + Δ1 + R a) + pᵀJ M p    over p, a
    subject to ε + Δ1 + M p + R a >= 0,  p >= 0,  ℓᵀp = -load

In equilibrium the objective is pᵀJδ, (19). M stays unsymmetric in the constraints; the objective sees its symmetric
part only, which changes no value of it.
"""

import warnings
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from clarabel import DefaultSettings, DefaultSolver, NonnegativeConeT, ZeroConeT  # pyright: ignore (has no stubs)
from scipy.linalg import eigvalsh
from scipy.sparse import triu

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status, Trace
from bemcontact.errors import NotConvexError, SolverError
from bemcontact.formulations.complementarity import escape_note, polish
from bemcontact.formulations.scaling import ScaledContact, scaled, scaled_weights, unscaled
from bemcontact.options import FormulationName, SolveOptions, Weights, options_of

ITERATIONS = 200
NEGLIGIBLE = 1e-10
"""Entry of ZᵀJR, or negative eigenvalue, that is round-off; by the scaling the numbers are of size one."""
SLIGHT = 1e-2
"""Negative part of a Hessian, relative to its largest eigenvalue, that is blamed on the mesh."""
TOLERANCES = 1e-11, 1e-8
"""Asked of Clarabel one after the other, the second where the first cannot be reached; the polish does the rest."""
STATUSES = {
    "optimal": Status.SOLVED,
    "optimal_inaccurate": Status.SOLVED,
    "user_limit": Status.ITERATION_LIMIT,
    "infeasible": Status.INFEASIBLE,
    "infeasible_inaccurate": Status.INFEASIBLE,
    "unbounded": Status.UNBOUNDED,
    "unbounded_inaccurate": Status.UNBOUNDED,
}


def load() -> None:
    """Import cvxpy, which takes half a second, so that what follows can be timed."""
    import cvxpy  # noqa: F401


@dataclass(frozen=True, kw_only=True, eq=False)
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


def objective(problem: ScaledContact, J: Array) -> Objective:
    """Write pᵀJδ as a convex function of (p, a), with the help of equilibrium.

    With P = I - R(ℓᵀR)⁻¹ℓᵀ and p0 = -R(ℓᵀR)⁻¹load every p in equilibrium is P p + p0, so that
    pᵀJM p = (P p)ᵀJM(P p) + p0ᵀ(JM + MᵀJᵀ)P p + p0ᵀJM p0. And if JR = ℓC, then pᵀJR a = -loadᵀC a; C = I for the
    tributary J.

    Parameters
    ----------
    problem : ScaledContact
    J : (n, n) weights of the objective, scaled

    Returns
    -------
    Objective
    """
    M, R, ell, load = problem.compliance, problem.rigid_motions, problem.equilibrium, problem.motion_load
    weighted = J @ M
    hessian = weighted + weighted.T
    project = np.eye(len(M)) - R @ np.linalg.solve(ell.T @ R, ell.T)
    p0 = -R @ np.linalg.solve(ell.T @ R, load)
    share = np.linalg.lstsq(ell, J @ R, rcond=None)[0]
    return Objective(
        hessian=project.T @ hessian @ project,
        pressure=J @ problem.offset + project.T @ (hessian @ p0),
        amplitudes=-share.T @ load,
        constant=float(p0 @ weighted @ p0),
    )


def smallest_eigenvalue(problem: ScaledContact, J: Array) -> float | None:
    """Smallest eigenvalue of Zᵀ(JM + MᵀJᵀ)Z, Z spanning {p : ℓᵀp = 0}: the curvature on the equilibrium space.

    Where ZᵀJR is not zero, pᵀJR a makes the objective a saddle in (p, a), and the eigenvalue is that of the Hessian in
    both. Never so with the tributary weights.

    Parameters
    ----------
    problem : ScaledContact
    J : (n, n) weights of the objective, scaled

    Returns
    -------
    float or None
        Dimensionless; None if equilibrium leaves no pressure free (n = k).
    """
    R, Z = problem.rigid_motions, problem.equilibrium_space
    n, k = R.shape
    if n == k:
        return None
    weighted = J @ problem.compliance
    hessian = Z.T @ (weighted + weighted.T) @ Z
    coupling = Z.T @ J @ R
    if np.abs(coupling).max(initial=0.0) > NEGLIGIBLE:
        hessian = np.block([[hessian, coupling], [coupling.T, np.zeros((k, k))]])
    return float(eigvalsh(hessian, subset_by_index=(0, 0))[0])


def solve(contact: CondensedContact, options: SolveOptions | None = None) -> ContactSolution:
    """Minimise QP3, (40)-(42), on the scaled problem, then polish.

    With the consistent weights the minimum need not be the contact state, as J has negative entries; so the result then
    is left as it is.

    Parameters
    ----------
    contact : CondensedContact
    options : weights of the objective, whether to polish, limit of Clarabel's iterations

    Returns
    -------
    ContactSolution
        With `smallest_eigenvalue` of the scaled Hessian. The history begins at Clarabel's start: `Objective.value`, and
        as "infeasibility" the residual of the constraints that Clarabel holds against its tolerance, relative to their
        terms where those are larger than one.

    Raises
    ------
    NotConvexError
        The Hessian has a negative eigenvalue on the equilibrium space; with the tributary weights, one of more than a
        hundredth of the largest.
    ProblemError
        The problem does not carry the weights asked for, or an option has no meaning for QP3.
    SolverError
        Clarabel broke down.
    """
    options = options_of(FormulationName.QP3, options)
    problem, J = scaled(contact), scaled_weights(contact, options.weights)
    eigenvalue = smallest_eigenvalue(problem, J)
    work = objective(problem, J)
    notes = []
    if eigenvalue is not None and eigenvalue < -NEGLIGIBLE:
        work = nearly_convex(work, eigenvalue, options.weights)
        notes.append(
            f"QP3 is not convex on this mesh (smallest eigenvalue {eigenvalue:.1e}): it was solved without the "
            "negative part of its Hessian, as a start for the active-set step"
        )
    found = _minimise(problem, work, options.max_iterations)
    widest = float(np.abs(problem.offset).max(initial=0.0))
    if found.status in (Status.UNBOUNDED, Status.INFEASIBLE) and widest > 1 and not escape_note(contact, problem):
        found = _in_units_of(widest, problem, work, options.max_iterations)
    p, u_n, a = unscaled(contact, found.pressure, found.amplitudes)
    if found.status is Status.INFEASIBLE and (note := escape_note(contact, problem)):
        notes.append(note)
    solution = ContactSolution(
        formulation=FormulationName.QP3,
        solver="Clarabel",
        status=found.status,
        pressure=p,
        displacement=u_n,
        rigid_amplitudes=a,
        iterations=found.iterations,
        smallest_eigenvalue=eigenvalue,
        history=tuple(
            Trace(quantity=quantity, first=0, values=tuple(values.tolist()))
            for quantity, values in zip(("objective", "infeasibility"), found.progress.T, strict=True)
        ),
        notes=tuple(notes),
    )
    exact = options.weights is not Weights.CONSISTENT
    return polish(contact, solution) if options.polish and exact and found.has_point else solution


@dataclass(frozen=True, kw_only=True, eq=False)
class _Found:
    """What came out of cvxpy: the status, the point if there is one (else zeros), the iterations.

    `progress` is the objective and the relative residual of the constraints at the start and after each iteration.
    """

    status: Status
    pressure: Array
    amplitudes: Array
    iterations: int
    has_point: bool
    progress: Array


def _in_units_of(size: float, problem: ScaledContact, objective: Objective, max_iterations: int | None) -> _Found:
    """Minimise with pressures and gaps over a larger size, where the widest gaps drown the pressures otherwise."""
    smaller = replace(problem, offset=problem.offset / size, motion_load=problem.motion_load / size)
    linear = replace(
        objective,
        pressure=objective.pressure / size,
        amplitudes=objective.amplitudes / size,
        constant=objective.constant / size**2,
    )
    found = _minimise(smaller, linear, max_iterations)
    return replace(
        found,
        pressure=found.pressure * size,
        amplitudes=found.amplitudes * size,
        progress=found.progress * np.array([size**2, 1.0]),
    )


def _minimise(problem: ScaledContact, objective: Objective, max_iterations: int | None) -> _Found:
    """State the quadratic program in cvxpy, solve it, and take the arrays out."""
    import cvxpy as cp

    M, R, ell, load = problem.compliance, problem.rigid_motions, problem.equilibrium, problem.motion_load
    n, k = R.shape
    p = cp.Variable(n, nonneg=True, name="pressure")
    a = cp.Variable(k, name="rigid_amplitudes") if k else None
    work = 0.5 * cp.quad_form(p, cp.psd_wrap(objective.hessian)) + objective.pressure @ p + objective.constant
    gap, balance = problem.offset + M @ p, []
    if a is not None:
        work, gap, balance = work + objective.amplitudes @ a, gap + R @ a, [ell.T @ p == -load]
    program = cp.Problem(cp.Minimize(work), [gap >= 0, *balance])

    failure = None
    for tolerance in TOLERANCES:
        try:
            progress = _solve(program, tolerance, max_iterations or ITERATIONS)
        except cp.SolverError as error:
            failure = error
        else:
            break
    else:
        raise SolverError(
            "Clarabel found no solution of QP3; check the mesh for very short elements, or solve the "
            "complementarity problem directly"
        ) from failure
    has_point = p.value is not None
    return _Found(
        status=STATUSES[program.status],
        pressure=np.asarray(p.value, float) if has_point else np.zeros(n),
        amplitudes=np.asarray(a.value, float) if has_point and a is not None else np.zeros(k),
        iterations=program.solver_stats.num_iters or 0,
        has_point=has_point,
        progress=progress + np.array([objective.constant, 0.0]),
    )


def _solve(program: Any, tolerance: float, limit: int) -> Array:
    """Solve a cvxpy problem by Clarabel called directly, because cvxpy does not pass on the progress of a solver.

    Returns the objective without its constant and the relative residual of the constraints, (iterations + 1, 2), or one
    row less where Clarabel gave up in the last iteration.
    """
    data, chain, inverse = program.get_problem_data("CLARABEL", solver_opts={})
    settings = DefaultSettings()
    settings.verbose, settings.max_iter = False, limit
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    cones = [ZeroConeT(data["dims"].zero), NonnegativeConeT(data["dims"].nonneg)]
    solver = DefaultSolver(triu(data["P"], format="csc"), data["c"], data["A"], data["b"], cones, settings)
    rows: list[tuple[float, float]] = []

    def look(info: Any) -> bool:
        rows.append((info.cost_primal, info.res_primal))
        return False  # go on

    solver.set_termination_callback(look)
    solution = solver.solve()
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # the status tells the same
        program.unpack_results(solution, chain, inverse)
    if np.isfinite(solution.obj_val):
        rows[-1] = solution.obj_val, solution.r_prim  # Clarabel may have taken back its last step
    progress = np.array(rows)
    return progress[np.logical_and.accumulate(np.isfinite(progress).all(axis=1))]


def nearly_convex(work: Objective, eigenvalue: float, weights: Weights) -> Objective:
    """Leave out the negative part of a Hessian that is indefinite by the mesh alone; refuse any other.

    Collocation leaves sym(JM) slightly indefinite on coarse meshes of slender bodies and at acute corners.

    Parameters
    ----------
    work : Objective
    eigenvalue : `smallest_eigenvalue` of the problem, negative
    weights : of the objective

    Returns
    -------
    Objective

    Raises
    ------
    NotConvexError
        If the weights are not tributary, or the eigenvalue is more than a hundredth of the largest.
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
