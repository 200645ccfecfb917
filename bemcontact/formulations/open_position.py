"""The position of a body or tool that contact does not determine, chosen by a rule instead of by round-off.

Where no pressed point sees a motion, any amplitude solves the contact problem that opens no pressed point and closes
no gap beyond touching. Chosen is the one with the least normal displacement R a of the contact points, in the least
squares of the weights: that depends on no unit, no basis of the motions, and no path of a solver.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import scipy

from bemcontact.arrays import Array, BoolArray
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import unseen_ways
from bemcontact.contact.solution import ContactSolution
from bemcontact.formulations.local_solver.factorizations import unit_rows
from bemcontact.formulations.scaling import ACCEPTED, ScaledContact, motion_sizes, scale, scaled_point, unscaled

VANISHED = 1e-12
"""Fraction of the largest pressure below which a pressure is round-off, and holds no motion."""
UNSEEN = 1e-9
"""Normal displacement of pressed points, relative to the motion's own, that counts as zero."""
OPEN = 1e-6
"""Amplitude in U that a motion needs to count as open: round-off leaves less where it is locked."""


def unheld_motions(contact: CondensedContact, pressure: Array, closed: BoolArray | None = None) -> Array:
    """Combinations (k, j) of free motions that move no point with pressure (n,), nor one that is `closed` (n,)."""
    pressed = pressure > VANISHED * pressure.max(initial=0.0)
    held = pressed if closed is None else pressed | closed
    return unseen_ways((contact.rigid_motions / motion_sizes(contact))[held], UNSEEN)


def with_chosen_position(
    contact: CondensedContact, solution: ContactSolution, closed: BoolArray | None = None
) -> ContactSolution:
    """Choose the position by the rule, and say so, if one is not determined; otherwise nothing changes.

    Points that do not solve the contact problem to round-off, and bodies that nothing touches, are left as they are.
    `closed` (n,) are points that must stay closed although nothing presses them.
    """
    if not contact.free_motions or not contact.peak(solution.pressure):
        return solution
    motions = unheld_motions(contact, solution.pressure, closed)
    if not motions.size:
        return solution
    pressed, scaled = solution.pressure > VANISHED * solution.pressure.max(), scale(contact)
    held = pressed if closed is None else pressed | closed
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    if not scaled.residual(p, a) <= ACCEPTED:
        return solution
    p = np.where(pressed, p, 0.0)
    limits = _limits(scaled, held, scaled.gap(p, a), motions)
    if not (ways := _open_ways(limits, motions)).any():
        return solution
    a = _nearest(scaled, a, limits, motions)
    if not scaled.residual(p, a) <= ACCEPTED:
        return solution
    p, u_n, a = unscaled(contact, p, a)
    named = tuple(name for name, way in zip(contact.motion_names, ways, strict=True) if way)
    return replace(
        solution, pressure=p, displacement=u_n, rigid_amplitudes=a, undetermined=named,
        notes=tuple(dict.fromkeys((*solution.notes, note_of_open(named)))),
    )  # fmt: skip


def note_of_open(motions: Iterable[str]) -> str:
    """Note that some motions are not determined, and what was chosen."""
    return (
        f"not determined: the {' and the '.join(motions)}; the position that is given has the least normal "
        "displacement of the contact points; state a load or a displacement that holds it, if it matters"
    )


def _limits(scaled: ScaledContact, held: BoolArray, gap: Array, motions: Array) -> tuple[Array, Array]:
    """The rows G y >= h, h <= 0, of size one, for the points that must not penetrate where the body moves by y (j,)."""
    G, h = scaled.rigid_motions[~held] @ motions, -np.maximum(gap[~held], 0.0)
    size = np.maximum(np.abs(G).max(axis=1, initial=UNSEEN), np.abs(h))
    return np.where(np.abs(G) > UNSEEN, G, 0.0) / size[:, None], h / size


def _open_ways(limits: tuple[Array, Array], motions: Array) -> BoolArray:
    """Which of the k motions (k,) have more than one amplitude, by linear programs."""
    G, h = limits
    open_ways = np.zeros(len(motions), bool)
    for row, way in enumerate(motions):
        for cost in (way, -way) if np.abs(way).max() > UNSEEN else ():
            optimum = scipy.optimize.linprog(cost, A_ub=-G, b_ub=-h, bounds=(-1.0, 1.0))
            open_ways[row] |= optimum.success and -optimum.fun > OPEN
    return open_ways


def _nearest(scaled: ScaledContact, amplitudes: Array, limits: tuple[Array, Array], motions: Array) -> Array:
    """The amplitudes (k,) with least weighted squares of R a: a least-distance program."""
    root, (G, h) = np.sqrt(scaled.weights)[:, None] * scaled.rigid_motions, limits
    Q, S = np.linalg.qr(root @ motions)
    center = -np.linalg.solve(S, Q.T @ (root @ amplitudes))
    rows = np.asarray(np.linalg.solve(S.T, G.T).T, float)
    return amplitudes + motions @ (center + np.linalg.solve(S, _least(rows, h - G @ center)))


def _least(G: Array, h: Array) -> Array:
    """The smallest z (j,) with G z >= h; zero if there is none."""
    # Lawson and Hanson, "Solving Least Squares Problems" (1974), chapter 23, by NNLS
    G, length = unit_rows(G)
    h, none = h / length, np.zeros(G.shape[1])
    size = h.max(initial=0.0)  # z is no smaller; in this unit it keeps its digits
    if size == 0.0:
        return none
    E, right = np.vstack([G.T, h / size]), np.append(none, 1.0)
    r = E @ scipy.optimize.nnls(E, right)[0] - right
    return -size * r[:-1] / r[-1] if r[-1] < 0.0 else none


def farthest(values: Array, rates: Array, seen: Array, most: float) -> tuple[float, Array]:
    """Find the largest step s <= most at which values + s rates + seen @ y >= 0 for some y (j,), and a y there.

    Values (n,) are not negative; the numbers are of size one. A linear program names the rows that lock y; these are
    then solved as equations, for the solver of the program leaves errors that would count as gaps.
    """
    rows = np.column_stack([rates, np.where(np.abs(seen) > UNSEEN, seen, 0.0)])
    size = np.maximum(np.abs(rows).max(axis=1), UNSEEN)
    rows, values = rows / size[:, None], values / size
    cost = -np.eye(rows.shape[1])[0]
    optimum = scipy.optimize.linprog(
        cost, A_ub=-rows, b_ub=values, bounds=[(0.0, most), *[(None, None)] * seen.shape[1]]
    )
    if not optimum.success:
        return 0.0, np.zeros(seen.shape[1])
    x, free = np.append(most, np.zeros(seen.shape[1])), np.eye(rows.shape[1])[:, 1:]
    locking = optimum.ineqlin.marginals < -UNSEEN
    if locking.any():
        x = np.asarray(optimum.x, float)
        x += np.linalg.lstsq(rows[locking], -values[locking] - rows[locking] @ x, rcond=None)[0]
        free = unseen_ways(rows[locking], UNSEEN)
    others = ~locking & (np.abs(rows @ free).max(axis=1, initial=0.0) > UNSEEN)
    x += free @ _least((rows @ free)[others], -(values + rows @ x)[others])
    return float(x[0]), x[1:]
