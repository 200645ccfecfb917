"""Is it the solution, is it the only one, and how far off can it be? `certify` answers from p and u_n alone.

Uniqueness. Let D = J be the tributary weights and λ the smallest eigenvalue of sym(DM) on the equilibrium space
{v : ℓᵀv = 0}. For two solutions (p, δ) and (p', δ') the difference v = p - p' lies there, so that
vᵀD(δ - δ') = vᵀDM v + ℓᵀv·(a - a') >= λ|v|², and complementarity makes the left side -pᵀDδ' - p'ᵀDδ <= 0.
With λ > 0 the pressure is unique. A diagonal S > 0 changes no sign: v = S f with f in {f : (Sℓ)ᵀf = 0}. So λ is that
of S sym(DM) S, with S so that the diagonal is one (van der Sluis, Numer. Math. 14 (1969) 14-23); it is less where a
compliance is below 1e-10 of ‖M‖, which may be round-off. Then short elements beside long ones, whose weights differ by
many orders, do not make λ small. What round-off in D M and in the space may have added to λ is taken off.

Error bound. Let y >= 0 be a pressure in equilibrium, ℓᵀy = -load, a any amplitudes and δ = ε + Δ1 + M y + R a. Let s
be the part of Dδ that should not be: s = Dδ where y > 0, s = min(Dδ, 0) where y = 0; so Dδ - s >= 0 and
yᵀ(Dδ - s) = 0. For the solution (p*, δ*) and e = y - p*

    λ|S⁻¹e|² <= eᵀDM e = eᵀD(δ - δ*) = eᵀs - yᵀDδ* - p*ᵀ(Dδ - s) <= |S⁻¹e||Ss|,

so that |y - p*|ᵢ <= Sᵢ|Ss|/λ, and for any p at all |p - p*|ᵢ <= |p - y| + Sᵢ|Ss|/λ. With Z an orthonormal basis of the
space and its rows Zᵢ it is even Sᵢ|Zᵢ||ZᵀSs|/λ: nothing where equilibrium fixes a pressure. Here y is p cut off outside
its contact set and brought into equilibrium by the smallest change. What round-off leaves of equilibrium changes y by
that over the least lever of the points that carry, and is added. Where these lack one direction, the amplitudes a may
be changed in it until the first gap beside closes: this point carries the round-off, and no work is done. Where they
lack more, others must carry by pressures z >= 0 that linear programs bound: then yᵀ(Dδ - s) = zᵀDδ, and
|S⁻¹e| <= |Ss|/λ + √(zᵀDδ/λ). Where the round-off of ordinary sums leaves the answer open, δ and ℓᵀy are added again
without rounding, and the energy bounds the change: with x² = eᵀKe, K = sym(DM) and s known but for round-off r,
x <= √(sᵀK⁻¹s) + |r|ᵀg and |eᵢ| <= gᵢx, gᵢ² = (K⁻¹)ᵢᵢ on the space. In soft directions K⁻¹ is small.

This sharpens Pang's bound for strongly monotone problems, (1 + ‖DM‖)/λ·|min(p, Dδ)| (Math. Oper. Res. 12(3), 1987,
474-484), which does not carry over to bodies with free motions: a small pressure on a body lifted off its support has a
small min(p, Dδ), however far it is from the solution.

Where λ is not positive, `uniqueness` may still exclude all states outside of an error bound, or `reweighting` by other
weights. Inside it there may be more than one.
"""

from enum import StrEnum

import numpy as np

from bemcontact.arrays import Array, norm, row_norms
from bemcontact.assessment.definiteness import EPS, Definiteness
from bemcontact.assessment.equations import TIE, ContactEquations, balanced, round_off_of_equilibrium
from bemcontact.assessment.reach import points_that_may_touch
from bemcontact.assessment.residual import Residuals
from bemcontact.assessment.reweighting import reweighted_bound
from bemcontact.assessment.uniqueness import NearState, effective_eigenvalue, near_bound
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.frozen import frozen_value
from bemcontact.options import FormulationName
from bemcontact.serialization import Leaf

TOLERANCE = 1e-10
"""Residuals allowed: a thousand times above the round-off of the gap, a thousand below what shows in a result."""
LARGEST_BOUND = 1e-3
"""Error bound, relative to the peak pressure, above which round-off alone leaves the answer open."""
POSITION_OPEN = (
    " This is proved of the pressures, which are zero. The position of what is free is not determined: the one given "
    "is one of many."
)
LOCAL = (FormulationName.QP1, FormulationName.QP2)
"""Formulations whose solver starts somewhere and may end in a local minimum."""
DIRECT = "--formulation complementarity"


class CertificateKind(StrEnum):
    """What is proved of a solution."""

    UNIQUE = "unique"
    LOCAL = "local only"
    OPEN = "left open by round-off"
    NOT_A_SOLUTION = "not a solution"


NOT_SOLVED = "not solved"
HEADINGS = {
    CertificateKind.UNIQUE: "unique solution proved",
    CertificateKind.LOCAL: "local only",
    CertificateKind.OPEN: "left open by round-off",
    CertificateKind.NOT_A_SOLUTION: NOT_SOLVED,
}
"""What is proved -> the verdict on the equations, in a few words."""
POSITION_OPEN_HEADING = "unique pressures proved, position not determined"
WITHIN_BOUND_HEADING = "unique within the error bound"


@frozen_value
class Certificate(Leaf):
    """What is proved of a solution from its pressures and displacements alone, without trust in the solver."""

    kind: CertificateKind
    """What is proved."""
    heading: str
    """The verdict on the equations in a few words."""
    smallest_eigenvalue: float | None
    """Smallest eigenvalue λ of sym(JM) on the equilibrium space, with rows and columns scaled to a diagonal of ones.

    The pressure is unique if λ > 0. Null if equilibrium alone fixes the pressure.
    """
    why_unique: str
    """Why no other contact state exists, or none outside the error bound, as a clause; empty if this is not proved."""
    error_bound: float | None
    """Bound on the difference of each pressure from that of the solution [p]; null if there is none."""
    relative_error_bound: float | None
    """Error bound over the peak pressure; null if there is none, or where nothing touches."""
    violation: str
    """Residual that is too large, if this is not a solution; otherwise empty."""
    words: str
    """Two or three sentences for an engineer."""

    @property
    def certified(self) -> bool:
        """Whether this is the solution to the tolerance, and each solution is within the error bound."""
        return self.kind is CertificateKind.UNIQUE


def certify(
    contact: CondensedContact, solution: ContactSolution, residuals: Residuals, tolerance: float = TOLERANCE
) -> Certificate:
    """Certify a solution from its residuals.

    The tolerance is on penetration, tension, complementarity, equilibrium (12) and balance. Where the peak pressure is
    above T, gaps are judged relative to the displacement that goes with it, and never below their round-off.
    """
    equations = ContactEquations.of(contact)
    stiff = Definiteness.of(equations.weights, equations.compliance, contact.equilibrium)
    eigenvalue, definite = stiff.eigenvalue, stiff.definite
    peak = contact.peak(solution.pressure)
    violation = _violation(residuals, tolerance, max(1.0, peak / contact.scales.pressure))
    bound = _bound_by(equations, contact, solution, stiff)
    enough = LARGEST_BOUND * (peak or contact.scales.pressure)
    if not violation and (definite if bound is None else bound > enough):
        bound = _sharper(bound, contact, solution)
    unique = definite or bound is not None
    kind = CertificateKind.UNIQUE if unique else CertificateKind.LOCAL
    if unique and (bound is None or bound > enough):
        kind = CertificateKind.OPEN
    kind = CertificateKind.NOT_A_SOLUTION if violation else kind
    relative = bound / peak if bound is not None and peak > 0 else None
    open_position = kind is CertificateKind.UNIQUE and contact.free_motions > 0 and peak == 0
    within_bound = kind is CertificateKind.UNIQUE and not definite
    return Certificate(
        kind=kind,
        heading=WITHIN_BOUND_HEADING if within_bound else POSITION_OPEN_HEADING if open_position else HEADINGS[kind],
        smallest_eigenvalue=eigenvalue,
        why_unique=_why_unique(eigenvalue, definite) if kind is CertificateKind.UNIQUE else "",
        error_bound=bound,
        relative_error_bound=relative,
        violation=violation,
        words=_certificate_sentence(kind, violation, eigenvalue, definite, relative, solution)
        + POSITION_OPEN * open_position,
    )


def _sharper(bound: float | None, contact: CondensedContact, solution: ContactSolution) -> float | None:
    """The bound that follows from sums without rounding, if it is less."""
    equations = ContactEquations.of(contact, exact=True)
    stiff = Definiteness.of(equations.weights, equations.compliance, contact.equilibrium)
    better = _bound_by(equations, contact, solution, stiff)
    return min((found for found in (bound, better) if found is not None), default=None)


def _bound_by(
    equations: ContactEquations, contact: CondensedContact, solution: ContactSolution, stiff: Definiteness
) -> float | None:
    """|p - y| + max Sᵢ |Ss|/λ, as in the module's docstring, in units of pressure; s includes the round-off of δ.

    If the compliance is not definite, λ is that of `uniqueness`; None if there is none.
    """
    U, T = equations.units
    D, M = equations.weights, equations.compliance
    p = solution.pressure / T
    gap = (contact.initial_gap + solution.displacement) / U
    # pressures that are all round-off beside T hold no point
    y = balanced(equations, p if contact.peak(solution.pressure) > 0 else 0.0 * p, p > gap)
    if y is None:
        return None
    a = contact.amplitudes_of(gap - equations.offset - M @ y)
    delta, round_off = equations.gaps(y, a)
    s, round_off = D * np.where(y > 0, delta, np.minimum(delta, 0.0)), D * round_off
    imbalance, beside, tilted = round_off_of_equilibrium(equations, y, np.maximum(D * delta, 0.0), round_off)
    if imbalance == np.inf:
        return None
    off = norm(p - y) + imbalance
    if stiff.eigenvalue is None:
        return off * T * (1 + 4 * EPS)
    of_gaps, round_off = round_off, round_off + D * row_norms(M) * imbalance
    work = np.where(y > 0, 0.0, np.maximum(D * delta - round_off, 0.0))
    lacking = beside.any() or tilted is not None
    least = D * delta if tilted is None else np.minimum(D * delta, (1 - TIE) * tilted - TIE * np.abs(D * delta))
    round_off = np.where((y > 0) | (least < round_off), round_off, 0.0)
    residual = np.abs(s) + round_off
    beside_work = float(beside @ (np.maximum(D * delta, 0.0) + round_off))
    bound = stiff.largest_change(residual, beside_work) if stiff.definite else np.inf
    if equations.exact and stiff.definite and not lacking:
        bound = min(bound, _by_energy(equations, stiff, y, delta, of_gaps, imbalance))
    if bound <= LARGEST_BOUND * y.max() or lacking:
        return (off + bound) * T * (1 + 4 * EPS) if bound < np.inf else None
    state = NearState(
        weights=D, compliance=M, rigid_motions=equations.rigid_motions, offset=equations.offset,
        equilibrium=contact.equilibrium, pressure=y, work=work, residual=residual, definiteness=stiff,
    )  # fmt: skip
    bound = min(bound, _bound_near(state, LARGEST_BOUND * y.max()))
    return (off + bound) * T * (1 + 4 * EPS) if bound < np.inf else None


def _bound_near(state: NearState, enough: float) -> float:
    """Bound of |y - p*| in the largest component by the proofs of other modules, until it is enough."""
    definite, bound = state.definiteness.definite, np.inf
    if not definite:
        state = state.on(points_that_may_touch(state))
        if state.definiteness.definite:
            bound = state.definiteness.largest_change(state.residual)
        elif (eigenvalue := effective_eigenvalue(state)) is not None:
            bound = norm(state.residual) / eigenvalue
    if bound > enough and (state.equilibrium.size or not definite):
        bound = min(bound, near_bound(state))
    if bound > enough and not state.definiteness.definite:
        bound = min(bound, reweighted_bound(state))
    return bound


def _by_energy(
    equations: ContactEquations, stiff: Definiteness, y: Array, delta: Array, round_off: Array, imbalance: float
) -> float:
    """Bound of the change of a pressure in exact equilibrium, which is a known step from y, as the energy limits it.

    What round-off does in a soft direction, as by turning a body about a short edge, changes pressures little.
    """
    D, M = equations.weights, equations.compliance
    step, left = equations.step_to_balance(y, imbalance)
    moved = D * (delta + M @ step)
    round_off = round_off + D * row_norms(M) * left
    lost = np.where((y > 0) | (moved < round_off), round_off, 0.0)
    return stiff.change_by_energy(np.where(y > 0, moved, np.minimum(moved, 0.0)), lost)


def _violation(residuals: Residuals, tolerance: float, size: float) -> str:
    """The worst violation in words, or empty; `size` is that of the pressure over T."""
    of_gaps = max(tolerance * size, residuals.round_off)
    checks = {
        "penetration": (residuals.penetration, of_gaps),
        "tension": (residuals.tension, tolerance),
        "complementarity": (residuals.complementarity, of_gaps),
        "balance of forces": (residuals.balance, tolerance),
        "equilibrium (12)": (residuals.equilibrium, max(of_gaps, residuals.equilibrium_round_off)),
    }
    name, (value, allowed) = max(checks.items(), key=lambda check: check[1][0] / check[1][1])
    return "" if value <= allowed else f"the residual of {name} is {value:.1e} where {allowed:.1e} is allowed"


def _why_unique(eigenvalue: float | None, definite: bool) -> str:
    """Which other states are excluded, and why, as a clause."""
    if eigenvalue is None:
        return "no other state exists, because equilibrium alone fixes the pressure"
    size = f"(its smallest eigenvalue is {eigenvalue:.2e})"
    if definite:
        return f"no other state exists, because the compliance is positive definite {size}"
    return (
        "the load, the gaps, or other weights exclude all states outside the error bound, although the compliance is "
        f"not positive definite {size}"
    )


def _certificate_sentence(
    kind: CertificateKind,
    violation: str,
    eigenvalue: float | None,
    definite: bool,
    relative: float | None,
    solution: ContactSolution,
) -> str:
    """Two or three sentences for an engineer."""
    sure = "equilibrium alone fixes the pressure"
    if eigenvalue is not None:
        sure = f"the smallest eigenvalue of the compliance is {eigenvalue:.2e}"
    exact = f"{'the' if definite else 'any'} exact solution of the equations on this mesh"
    error = "" if relative is None else f" No pressure is off by more than {relative:.1e} of the peak from {exact}."
    match kind:
        case CertificateKind.UNIQUE:
            why = _why_unique(eigenvalue, definite)
            return f"All contact conditions hold. {why[0].upper()}{why[1:]}.{error}"
        case CertificateKind.LOCAL:
            return (
                f"All contact conditions hold, but the compliance is not positive definite ({sure}), so another "
                "contact state may exist. Take away parts of the zones that cannot touch, or refine the mesh "
                "(--refine 2)."
            )
        case CertificateKind.OPEN:
            return (
                "All contact conditions hold to their tolerance, but round-off leaves open whether other pressures, "
                f"far from this one, satisfy them too ({sure}).{error} Take away parts of the zones that cannot touch, "
                "look in the mesh for very short elements, and check units: loads, lengths and Young's modulus."
            )
        case CertificateKind.NOT_A_SOLUTION if solution.status is Status.INFEASIBLE:
            return advice(solution)
        case CertificateKind.NOT_A_SOLUTION:
            return f"This is not the contact state: {violation}.{error} {advice(solution)}"


def advice(solution: ContactSolution) -> str:
    """Say in a sentence what to try where a solution is not the contact state, with options of the command line."""
    match solution.status:
        case Status.INFEASIBLE:
            return "Check that loads and conditions press the body onto its support, and not off an end of it."
        case Status.UNBOUNDED:
            return "Take the tributary weights."
        case Status.ITERATION_LIMIT:
            another = ", or take another start (--seed 1)" * (solution.formulation in LOCAL)
            return f"Raise the limit (--max-iterations; {solution.iterations} were done){another}."
        case _ if solution.formulation == FormulationName.COMPLEMENTARITY:
            return "Refine the mesh (--refine 2), and look in it for very short elements."
        case Status.LOCAL_MINIMUM:
            return f"Try {DIRECT}, or other starts (--starts 20) with the tributary weights."
        case Status.NUMERICAL_FAILURE:
            return f"Try {DIRECT}, and look in the mesh for very short elements."
        case _:
            return f"Try {DIRECT}, a finer mesh (--refine 2), or the tributary weights if these are others."
