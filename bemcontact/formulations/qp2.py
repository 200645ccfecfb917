"""QP2, (30)-(34): QP1 with the equations penalized, over displacements and pressures, from a local solver.

    minimize   pᵀJ(ε + u_n) + (1/μ)|K u_n - B p - r|²    over u_n, p
    subject to ε + u_n >= 0,  p >= 0,  ℓᵀp = -load

on the scaled problem, where μ = 1 weighs an error of T in the equations like the work of T on U.

Stationary points. Let sym(JM) be positive definite on the equilibrium space, ℓ = JR, J > 0 diagonal, and
σ = (2/μ)(K u_n - B p - r) with K = S, B = I. With w = Kᵀσ and σ' = σ + ℓy, y the multiplier of equilibrium, the
conditions of first order read p >= 0, Jδ - σ' >= 0, δ >= 0, Jp + w >= 0, the first two and the last two complementary:
in each case w_i σ'_i <= 0. From S M = I - Vℓᵀ follows σ' = Mᵀw + ℓz, and Rᵀw = 0. So with v = w/J, which is in
equilibrium, vᵀJM v = wᵀσ'/J <= 0: v = 0, σ = 0, and the point is the contact state, whatever μ is. With the compliance
rows w = σ and σ' = Mᵀσ + ℓy lead to the same. Where equilibrium is penalized as all the rest, as [SS92] has it, p = 0
with the body lifted far enough is another stationary point: the residual then is balanced by no force, and small
changes of p and u_n improve nothing.

Convexity. On the equilibrium space p = Z z, s = K u_n - B p - r the quadratic is zᵀW z + zᵀD s + (1/μ)|s|² with
W = ZᵀJM Z and D = W (stiffness rows, s = Z t) or D = ZᵀJ (compliance rows). Its least value over s is
zᵀ(W - (μ/4) D Dᵀ)z, so that QP2 is convex up to the smallest eigenvalue of (2(W + Wᵀ), D Dᵀ). A product pᵀJR a that
equilibrium does not make vanish is a saddle for every μ.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import eigvalsh

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Penalty, Status
from bemcontact.errors import OptionError
from bemcontact.formulations.program import (
    Program,
    contact_equations,
    equilibrium,
    lower_bounds,
    no_equations,
)
from bemcontact.formulations.scaling import scale, scaled_weights
from bemcontact.formulations.search import polished, searched
from bemcontact.frozen import frozen
from bemcontact.options import Equilibrium, FormulationName, Rows, SolveOptions, Weights, options_of

NEGLIGIBLE = 1e-10
"""Entry of ZᵀJR that is round-off; by the scaling the numbers are of size one."""


@frozen
class Ray:
    """A direction of two contact points along which QP2 falls without end, once μ is above a limit.

    Parameters
    ----------
    pressed, opened : contact points whose pressure grows and whose gap opens
    direction : (2n,) over (u_n, p), scaled, for the μ asked for
    limit : the largest μ, free of units, up to which no two points make such a ray
    """

    pressed: int
    opened: int
    direction: Array
    limit: float


def program_of(contact: CondensedContact, options: SolveOptions) -> Program:
    """(30)-(34) on the scaled problem, over (u_n, p), or (u_n, p, a) with the compliance rows.

    `ProblemError` if the problem does not carry the weights, or the rows do not contain the equilibrium to be
    penalized.
    """
    penalized = contact_equations(contact, options.rows)
    size = penalized.matrix.shape[1]
    exact = no_equations(size)
    if options.equilibrium is Equilibrium.CONSTRAINT:
        exact = equilibrium(scale(contact), size).of_unit_size
    elif options.rows is Rows.COMPLIANCE and contact.free_motions:
        raise OptionError(
            "equilibrium can be penalized with the stiffness rows only, which contain it; the compliance rows need it "
            "as a constraint"
        )
    return Program(
        weights=scaled_weights(contact, options.weights),
        penalized=penalized,
        penalty=options.penalty,
        equations=exact,
        lower=lower_bounds(contact, size),
    )


def penalty_scale(contact: CondensedContact, options: SolveOptions) -> float:
    """The μ in the user's units that is 1 in scaled ones: T/(U max J) for stiffness rows, U/(T max J) for others.

    It is that of pᵀJδ + (1/μ)|K u_n - B p - r|² with K, B, r, J as they are. Where a change of units multiplies
    lengths, it changes; so do not compare μ between problems by it.
    """
    U, T = contact.scales
    weight = float(np.abs(contact.weight_matrix(options.weights)).max())
    return (T / U if options.rows is Rows.STIFFNESS else U / T) / weight


def convexity_limit(contact: CondensedContact, options: SolveOptions) -> float:
    """The largest μ, free of units, for which QP2 is convex.

    It is zero if QP2 is convex for none, and infinite if equilibrium leaves no pressure free.
    """
    scaled, J = scale(contact), scaled_weights(contact, options.weights)
    n, k = scaled.rigid_motions.shape
    Z = scaled.equilibrium_space
    lifted = options.equilibrium is Equilibrium.PENALTY and k > 0
    if lifted or np.abs(Z.T @ J @ scaled.rigid_motions).max(initial=0.0) > NEGLIGIBLE:
        return 0.0
    if n == k:
        return np.inf
    W = Z.T @ J @ scaled.compliance @ Z
    curvatures = eigvalsh(W + W.T)
    if curvatures[0] <= n * np.finfo(float).eps * curvatures[-1]:
        return 0.0
    if options.rows is Rows.STIFFNESS:  # with w = Wᵀz the pencil is that of W⁻¹ alone
        inverse = np.linalg.inv(W)
        return float(eigvalsh(2 * (inverse + inverse.T), subset_by_index=(0, 0))[0])
    D = Z.T @ J
    return float(eigvalsh(2 * (W + W.T), D @ D.T, subset_by_index=(0, 0))[0])


def two_point_ray(contact: CondensedContact, options: SolveOptions) -> Ray | None:
    """Find p growing by β at i and u_n by α at j, J_ij < 0, such that αβ J_ij + (1/μ)|α K e_j - β B e_i|² < 0.

    For given i, j the quadratic form in α, β > 0 is somewhere negative if μ > 2(|K e_j||B e_i| - K e_j·B e_i)/(-J_ij).
    The result is the ray of the lowest limit; None if μ is not above it, or equilibrium lets no single pressure grow.
    """
    n, J = contact.size, scaled_weights(contact, options.weights)
    if not (J < 0).any() or (contact.free_motions and options.equilibrium is Equilibrium.CONSTRAINT):
        return None
    E = contact_equations(contact, options.rows).matrix
    K, B = E[:, :n], -E[:, n : 2 * n]
    lengths = np.outer(np.linalg.norm(B, axis=0), np.linalg.norm(K, axis=0))
    limits = np.where(J < 0, 2 * (lengths - B.T @ K) / np.where(J < 0, -J, 1.0), np.inf)
    i, j = map(int, np.unravel_index(np.argmin(limits), limits.shape))
    if options.penalty <= limits[i, j]:
        return None
    direction = np.zeros(2 * n)
    direction[j], direction[n + i] = np.linalg.norm(B[:, i]), np.linalg.norm(K[:, j])
    return Ray(pressed=i, opened=j, direction=direction, limit=float(limits[i, j]))


def solve(contact: CondensedContact, options: SolveOptions | None = None) -> ContactSolution:
    """Find a local minimum of QP2, then polish it unless it is certain not to be the contact state.

    The status is `Status.LOCAL_MINIMUM` at a stationary point that is not the contact state, and
    `Status.NUMERICAL_FAILURE` where there is no such point. `search` has the penalty and the limit of convexity. The
    history is the sum of infeasibilities, as the solver scales them, and then `Program.value`. `ProblemError` if QP2
    has no minimum, as with the consistent weights and a large penalty, if the problem does not carry the weights, or if
    the rows do not contain the equilibrium to be penalized.
    """
    options = options_of(FormulationName.QP2, options)
    program = program_of(contact, options)
    unit = penalty_scale(contact, options)
    if ray := two_point_ray(contact, options):
        raise OptionError(_unbounded(contact, options, ray, unit))
    limit = convexity_limit(contact, options)
    penalty = Penalty(
        value=options.penalty,
        raw=options.penalty * unit,
        convexity_limit=limit if np.isfinite(limit) else None,
        convexity_limit_raw=limit * unit if np.isfinite(limit) else None,
        dimension="p/L²" if options.rows is Rows.STIFFNESS else "1/p",
    )
    solution = searched(contact, options, program, only=limit > 0, penalty=penalty)
    if solution.status is Status.UNBOUNDED and options.weights is Weights.CONSISTENT:
        raise OptionError(
            f"QP2 has no minimum with consistent weights: {solution.notes[-1]}; take the tributary weights"
        )
    if solution.status in (Status.NUMERICAL_FAILURE, Status.NO_SOLUTION_FOUND):
        notes = ("take a penalty nearer to 1, or stiffness rows, which lose least to round-off",)
    else:
        notes = _notes(contact, options, solution)
    return polished(contact, options, replace(solution, notes=(*solution.notes, *notes)))


def _unbounded(contact: CondensedContact, options: SolveOptions, ray: Ray, unit: float) -> str:
    """Describe a ray."""
    (x, y), (v, w) = contact.points[ray.pressed], contact.points[ray.opened]
    return (
        f"QP2 has no minimum with {options.weights.value} weights and penalty {options.penalty:.3g} "
        f"({options.penalty * unit:.3g} in the units of the problem): it falls without end as the pressure grows at "
        f"contact point {ray.pressed} ({x:.5g}, {y:.5g}) and the gap opens at point {ray.opened} ({v:.5g}, {w:.5g}), "
        f"whose common weight is negative; take a penalty of at most {ray.limit:.3g} ({ray.limit * unit:.3g}), or the "
        "tributary weights"
    )


def _notes(contact: CondensedContact, options: SolveOptions, solution: ContactSolution) -> tuple[str, ...]:
    """Notes on equilibrium that is only penalized."""
    if options.equilibrium is Equilibrium.CONSTRAINT:
        return ()
    if not contact.free_motions:
        return ("conditions hold all rigid motions: there is no equilibrium of a free body to be penalized",)
    if solution.status is not Status.LOCAL_MINIMUM:
        return ()
    state = "lifted off its support" if not solution.pressure.any() else "out of equilibrium"
    return (
        f"equilibrium was only penalized, and the body was left {state}, where no small change helps; keep "
        "equilibrium as a constraint, or take another start",
    )
