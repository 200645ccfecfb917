"""The quadratic program over (u_n, p) that QP1 and QP2 share, and its way through the local solver.

x = (u_n, p), or (u_n, p, a) where the compliance rows bring in the amplitudes; all of it dimensionless as in
`bemcontact.formulations.scaling`, but with u_n itself and not the gap, so that the null vector is that of [SS92].
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from bemcontact.choices import Rows, Weights
from bemcontact.contact import Array, CondensedContact
from bemcontact.formulations.complementarity import escape_note, polish
from bemcontact.formulations.formulation import FormulationOptions, Start
from bemcontact.formulations.local_solver import QPOptions, QPResult, QPStatus, inertia, minimize_qp
from bemcontact.formulations.scaling import ScaledContact, scaled, scaled_point, unscaled
from bemcontact.solution import ContactSolution, LocalSearch, Penalty, Status

SOLUTION = 1e-8
"""Residual up to which the end of a search counts as the contact state: searches that go well leave 1e-10 and less."""
ZERO = 1e-6
"""Scaled objective that a solver's tolerance may leave where the best value is 0: large errors may hide behind it."""
STATIONARY = "stationary but not the solution, with an objective of {:.1e} (scaled) and not 0"
NEAR = "not the solution, but the solver's tolerance cannot tell its objective, {:.1e} (scaled), from 0"
LOST = "not the solution, although round-off makes it look stationary, with an objective of {:.1e} (scaled) and not 0"
BIASED = (
    "not the solution, with an objective of {:.1e} (scaled): consistent weights have negative entries, so that the "
    "least objective lies below 0 and off the solution, and an objective of 0 certifies nothing"
)
"""What the points are where a search ended, with their objectives."""
POLISHED = (Status.SOLVED, Status.NO_SOLUTION_FOUND, Status.NUMERICAL_FAILURE)
"""Ends from which the polish is tried."""
NO_CONTACT_STATE = (
    "equations and bounds contradict each other: no pressure p >= 0 leaves a gap >= 0 at all contact points, so that "
    "no contact state exists, whatever the formulation"
)
SOLVER = "inertia-controlling active set"
STATUSES = {
    QPStatus.LOCAL_MINIMISER: Status.SOLVED,
    QPStatus.UNDECIDED: Status.SOLVED,
    QPStatus.UNBOUNDED: Status.UNBOUNDED,
    QPStatus.INFEASIBLE: Status.INFEASIBLE,
    QPStatus.ITERATION_LIMIT: Status.ITERATION_LIMIT,
    QPStatus.NUMERICAL_FAILURE: Status.NUMERICAL_FAILURE,
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Equations:
    """A x = b over x of N entries.

    Parameters
    ----------
    matrix : (m, N) A
    right : (m,) b
    """

    matrix: Array
    right: Array

    def and_also(self, other: "Equations") -> "Equations":
        """Both, one below the other."""
        return Equations(matrix=np.vstack([self.matrix, other.matrix]), right=np.concatenate([self.right, other.right]))

    @property
    def of_unit_size(self) -> "Equations":
        """The same with the largest entry of each row 1."""
        size = np.abs(self.matrix).max(axis=1, initial=0.0)
        size = np.where(size > 0, size, 1.0)
        return Equations(matrix=self.matrix / size[:, None], right=self.right / size)


@dataclass(frozen=True, kw_only=True, eq=False)
class Program:
    """Minimise pᵀJ(ε + u_n) + (1/μ)|E x - e|² subject to equations and ε + u_n >= 0, p >= 0.

    Parameters
    ----------
    weights : (n, n) scaled J
    penalised : E x = e; none of them, (0, N), in QP1
    penalty : μ
    equations : that hold exactly
    lower : (N,) bounds of x, -ε, 0 and for amplitudes -inf
    """

    weights: Array
    penalised: Equations
    penalty: float
    equations: Equations
    lower: Array

    @cached_property
    def hessian(self) -> Array:
        """H (N, N) of ½ xᵀH x + cᵀx + d."""
        n, J, E = len(self.weights), self.weights, self.penalised.matrix
        hessian = (2 / self.penalty) * (E.T @ E)
        hessian[:n, n : 2 * n] += J.T
        hessian[n : 2 * n, :n] += J
        return hessian

    @cached_property
    def linear(self) -> Array:
        """The c (N,) likewise."""
        n = len(self.weights)
        linear = -(2 / self.penalty) * (self.penalised.matrix.T @ self.penalised.right)
        linear[n : 2 * n] -= self.weights @ self.lower[:n]
        return linear

    @property
    def inertia(self) -> tuple[int, int, int]:
        """Numbers of positive, zero and negative eigenvalues of the Hessian Q + (2/μ) EᵀE.

        From [[Q, Eᵀ], [E, -μ/2]], whose inertia is that and m negative ones (Haynsworth 1968): it is free of 1/μ.
        """
        n, (m, N) = len(self.weights), self.penalised.matrix.shape
        bordered = np.zeros((N + m, N + m))
        bordered[:n, n : 2 * n], bordered[n : 2 * n, :n] = self.weights.T, self.weights
        bordered[N:, :N], bordered[:N, N:] = self.penalised.matrix, self.penalised.matrix.T
        bordered[N:, N:] = -0.5 * self.penalty * np.eye(m)
        positive, zero, negative = inertia(bordered)
        return positive, zero, negative - m

    def value(self, x: Array) -> float:
        """The objective at x (N, more may follow), not as it is multiplied out, which would cancel to round-off."""
        n, x = len(self.weights), x[: len(self.lower)]
        residual = self.penalised.matrix @ x - self.penalised.right
        work = x[n : 2 * n] @ self.weights @ (x[:n] - self.lower[:n])
        return float(work + residual @ residual / self.penalty)


def contact_equations(condensed: CondensedContact, rows: Rows) -> Equations:
    """K u_n - B p = r, (12), in scaled numbers, so that a residual is a part of the scale T or U.

    Parameters
    ----------
    condensed : CondensedContact
    rows : the stiffness rows over (u_n, p), or the compliance rows over (u_n, p, a)

    Returns
    -------
    Equations
    """
    U, T = condensed.scales
    if rows is Rows.STIFFNESS:
        K, B, r = condensed.stiffness_rows
        return Equations(matrix=np.hstack([K * (U / T), -B]), right=r / T)
    problem = scaled(condensed)
    matrix = np.hstack([np.eye(condensed.size), -problem.compliance, -problem.rigid_motions])
    return Equations(matrix=matrix, right=condensed.free_displacement / U)


def equilibrium(problem: ScaledContact, size: int) -> Equations:
    """ℓᵀp = -load over x of `size` entries."""
    n, k = problem.rigid_motions.shape
    matrix = np.zeros((k, size))
    matrix[:, n : 2 * n] = problem.equilibrium.T
    return Equations(matrix=matrix, right=-problem.motion_load)


def no_equations(size: int) -> Equations:
    """None at all over x of `size` entries."""
    return Equations(matrix=np.zeros((0, size)), right=np.zeros(0))


def lower_bounds(condensed: CondensedContact, size: int) -> Array:
    """-ε, 0, and -inf for amplitudes, of x of `size` entries."""
    n = condensed.size
    gap = condensed.initial_gap / condensed.scales.displacement
    return np.concatenate([-gap, np.zeros(n), np.full(size - 2 * n, -np.inf)])


def minimise(program: Program, start: Array, max_iterations: int | None) -> QPResult:
    """Hand a program to the local solver.

    Penalised equations go there as √μ s = E x - e with |s|² in the objective: the same, without the condition of EᵀE.

    Parameters
    ----------
    program : Program
    start : (N,)
    max_iterations : or None for the solver's own limit

    Returns
    -------
    QPResult
        Of x with s after it.
    """
    E, e = program.penalised.matrix, program.penalised.right
    A, b = program.equations.matrix, program.equations.right
    n, (m, N), root = len(program.weights), E.shape, np.sqrt(program.penalty)
    J, zero = program.weights, np.zeros((n, n))
    H = block_diag(np.block([[zero, J.T], [J, zero]]), np.zeros((N - 2 * n, N - 2 * n)), 2 * np.eye(m))
    c = np.zeros(N + m)
    c[n : 2 * n] = -J @ program.lower[:n]
    right = np.concatenate([b, e])
    x = np.maximum(start, program.lower)
    return minimize_qp(
        H,
        c,
        A=np.block([[A, np.zeros((len(b), m))], [E, -root * np.eye(m)]]),
        cl=right,
        cu=right,
        bl=np.concatenate([program.lower, np.full(m, -np.inf)]),
        x0=np.concatenate([x, (E @ x - e) / root]),
        options=QPOptions(max_iterations=max_iterations),
    )


def start_vector(condensed: CondensedContact, start: Start | None, size: int) -> Array:
    """Write a start as x of `size` entries: u_n/U, p/T, and the amplitudes that go with them best."""
    x = np.zeros(size)
    if start is None:
        return x
    start.ensure_fits(condensed.size)
    n = condensed.size
    p, a = scaled_point(condensed, start.pressure, amplitudes(condensed, start.pressure, start.displacement))
    x[:n], x[n : 2 * n] = start.displacement / condensed.scales.displacement, p
    x[2 * n :] = a[: size - 2 * n]
    return x


def amplitudes(condensed: CondensedContact, pressure: Array, displacement: Array) -> Array:
    """The a (k,) with which u_n = Δ1 + M p + R a comes closest, in the least squares of the weights."""
    R, ell = condensed.rigid_motions, condensed.equilibrium
    rest = displacement - condensed.free_displacement - condensed.compliance @ pressure
    return np.asarray(np.linalg.solve(ell.T @ R, ell.T @ rest), float)


def searched(
    condensed: CondensedContact,
    options: FormulationOptions,
    formulation: str,
    program: Program,
    *,
    only: bool,
    penalty: Penalty | None = None,
) -> ContactSolution:
    """Solve a program and say what its end is, by its residual and not by what the solver says.

    With weights that are not negative the best value is zero, attained at the contact state alone. An end elsewhere is
    a local minimum, or the work of round-off if there is none.

    Parameters
    ----------
    condensed : CondensedContact
    options : start, limit of iterations, weights
    formulation : its name
    program : Program
    only : whether the contact state is proved to be the only stationary point with weights that are not negative
    penalty : to be told with the search

    Returns
    -------
    ContactSolution
        Its displacement is the solver's own u_n.
    """
    result = minimise(program, start_vector(condensed, options.start, len(program.linear)), options.max_iterations)
    found = _as_found(condensed, formulation, result, _search(options, program, result, penalty))
    residual, objective = contact_residual(condensed, found), program.value(result.x)
    if found.status is not Status.SOLVED or residual <= SOLUTION:
        return found
    if options.weights is Weights.CONSISTENT:
        status, what = Status.LOCAL_MINIMUM, BIASED
    elif objective * max(1.0, program.penalty) <= ZERO:  # times μ it is the residual of the equations, squared
        status, what = Status.NO_SOLUTION_FOUND, NEAR
    else:
        status, what = (Status.NUMERICAL_FAILURE, LOST) if only else (Status.LOCAL_MINIMUM, STATIONARY)
    note = (
        f"{formulation.upper()} ended at a point where contact conditions and equations are violated by {residual:.1e} "
        f"of their scales; it is {what.format(objective)}"
    )
    return replace(found, status=status, notes=(*found.notes, note))


def polished(condensed: CondensedContact, options: FormulationOptions, found: ContactSolution) -> ContactSolution:
    """The polish, where it is asked for and due, which may make the solution of an end that round-off has spoilt.

    Not due are a true minimum elsewhere, a search that was cut short or proved that there is nothing to find, and the
    consistent weights, which are left as they are.
    """
    if not options.polish or options.weights is Weights.CONSISTENT or found.status not in POLISHED:
        return found
    better = polish(condensed, found)
    if found.status is Status.SOLVED or contact_residual(condensed, better) > SOLUTION:
        return better
    return replace(better, status=Status.SOLVED, notes=(*better.notes, "the polish led from there to the solution"))


def contact_residual(condensed: CondensedContact, solution: ContactSolution) -> float:
    """Largest of |min(p/T, δ/U)|, of (12) over U and of |ℓᵀp + load| over T Σ|ℓ|, over the size of the numbers."""
    problem = scaled(condensed)
    p, a = scaled_point(condensed, solution.pressure, solution.rigid_amplitudes)
    strange = solution.displacement - unscaled(condensed, p, a)[1]
    size = 1.0 + float(np.abs(p).max(initial=0.0) + np.abs(a).sum())
    return max(problem.residual(p, a), float(np.abs(strange).max()) / condensed.scales.displacement / size)


def ray_in_words(condensed: CondensedContact, ray: Array) -> str:
    """Name the contact points whose pressure or displacement grows most along a ray (N,)."""
    n = condensed.size
    displacement, pressure = ray[:n], ray[n : 2 * n]
    terms = []
    for name, part in (("pressure", pressure), ("normal displacement", displacement)):
        if (i := int(np.argmax(np.abs(part)))) < n and part[i]:
            x, y = condensed.points[i]
            terms.append(f"{name} {'grows' if part[i] > 0 else 'falls'} at contact point {i} ({x:.5g}, {y:.5g})")
    return " while ".join(terms) or "the body moves rigidly"


def _search(options: FormulationOptions, program: Program, result: QPResult, penalty: Penalty | None) -> LocalSearch:
    """How the solver came to its end."""
    return LocalSearch(
        start="null vector" if options.start is None else options.start.label,
        phase_one_iterations=result.phase_one_iterations,
        phase_two_iterations=result.phase_two_iterations,
        working_set_changes=result.working_set_changes,
        inertia=program.inertia,
        reduced_inertia_start=result.reduced_inertia_start,
        reduced_inertia_end=result.reduced_inertia_end,
        weakly_active=len(result.weakly_active),
        objective=program.value(result.x),
        penalty=penalty,
    )


def _as_found(condensed: CondensedContact, formulation: str, result: QPResult, search: LocalSearch) -> ContactSolution:
    """The end of the solver in the user's units."""
    n = condensed.size
    U, T = condensed.scales
    notes = []
    if result.status is QPStatus.UNDECIDED:
        notes.append("the local solver left open whether its end is a minimum: zero multipliers hide directions")
    if result.status is QPStatus.UNBOUNDED and result.ray is not None:
        notes.append(f"the objective falls without end along a ray: {ray_in_words(condensed, result.ray)}")
    if result.status is QPStatus.INFEASIBLE:
        notes.append(escape_note(condensed, scaled(condensed)) or NO_CONTACT_STATE)
    u_n, p = result.x[:n] * U, result.x[n : 2 * n] * T
    return ContactSolution(
        formulation=formulation,
        solver=SOLVER,
        status=STATUSES[result.status],
        pressure=p,
        displacement=u_n,
        rigid_amplitudes=amplitudes(condensed, p, u_n),
        iterations=result.iterations,
        search=search,
        notes=tuple(notes),
    )
