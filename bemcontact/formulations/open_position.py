"""The position of a body or tool that contact leaves open, chosen by a rule instead of by round-off.

Where no pressed point sees a motion, any amplitude solves the contact problem that opens no pressed point and closes
no gap beyond touching. Chosen is the one with the least normal displacement R a of the contact points, in the least
squares of the weights: that depends on no unit, no basis of the motions, and no path of a solver.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls

from bemcontact.arrays import Array
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.formulations.scaling import ScaledContact, scaled, scaled_point, unscaled

VANISHED = 1e-12
"""Fraction of the largest pressure below which a pressure is round-off, and holds no motion."""
UNSEEN = 1e-9
"""Normal displacement of pressed points, relative to the motion's own, that counts as zero."""
OPEN = 1e-6
"""Amplitude in U that a motion needs to count as open: round-off leaves less where it is locked."""
ACCEPTED = 1e-11
"""Value of `ScaledContact.residual` up to which a position is one of contact."""


def settled(contact: CondensedContact, solution: ContactSolution) -> ContactSolution:
    """Choose the position by the rule, and say so, if contact leaves one open; otherwise nothing changes.

    Points that do not solve the contact problem to round-off, and bodies that nothing touches, are left as they are.
    """
    body = scaled(contact)
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    if not a.size or not (p > 0).any() or not body.residual(p, a) <= ACCEPTED:
        return solution
    p = np.where(p > VANISHED * p.max(), p, 0.0)
    motions = _unseen(body, p)
    if not motions.size or not (ways := _open_ways(body, p, a, motions)).any():
        return solution
    a = _nearest(body, p, a, motions)
    if body.residual(p, a) > ACCEPTED:
        return solution
    p, u_n, a = unscaled(contact, p, a)
    named = [name for name, way in zip(contact.motion_names, ways, strict=True) if way]
    note = (
        f"contact leaves the {' and the '.join(named)} open: the position is the one with the least "
        "normal displacement of the contact points; state a load or a displacement that holds it, if it matters"
    )
    return replace(
        solution, pressure=p, displacement=u_n, rigid_amplitudes=a, notes=tuple(dict.fromkeys((*solution.notes, note)))
    )


def _unseen(body: ScaledContact, pressure: Array) -> Array:
    """Basis (k, j) of the motions that no pressed point sees."""
    pressed = body.rigid_motions[pressure > 0]
    scale = np.sqrt(len(body.weights))
    return np.asarray(null_space(np.vstack([pressed, np.zeros_like(pressed[:1])]) / scale, rcond=UNSEEN), float)


def _limits(body: ScaledContact, pressure: Array, amplitudes: Array, motions: Array) -> tuple[Array, Array]:
    """The rows G y >= h, h <= 0, of size one, for the points that must not penetrate where the body moves by y (j,)."""
    free = pressure == 0
    G, h = body.rigid_motions[free] @ motions, -np.maximum(body.gap(pressure, amplitudes)[free], 0.0)
    size = np.maximum(np.abs(G).max(axis=1, initial=UNSEEN), np.abs(h))
    return np.where(np.abs(G) > UNSEEN, G, 0.0) / size[:, None], h / size


def _open_ways(body: ScaledContact, pressure: Array, amplitudes: Array, motions: Array) -> Array:
    """Which of the k motions (k,) have more than one amplitude, by linear programs."""
    G, h = _limits(body, pressure, amplitudes, motions)
    open_ways = np.zeros(len(motions), bool)
    for row, way in enumerate(motions):
        for cost in (way, -way) if np.abs(way).max() > UNSEEN else ():
            optimum = linprog(cost, A_ub=-G, b_ub=-h, bounds=(-1.0, 1.0))
            open_ways[row] |= optimum.success and -optimum.fun > OPEN
    return open_ways


def _nearest(body: ScaledContact, pressure: Array, amplitudes: Array, motions: Array) -> Array:
    """The amplitudes (k,) with least weighted squares of R a: a least-distance program."""
    # Lawson and Hanson, "Solving Least Squares Problems" (1974), chapter 23: min |z| with G z >= h, by NNLS
    root = np.sqrt(body.weights)[:, None] * body.rigid_motions
    Q, S = np.linalg.qr(root @ motions)
    center = -np.linalg.solve(S, Q.T @ (root @ amplitudes))
    G, h = _limits(body, pressure, amplitudes, motions)
    h = h - G @ center
    if (h <= 0).all():
        return amplitudes + motions @ center
    E = np.vstack([np.linalg.solve(S.T, G.T), h])
    right = np.append(np.zeros(len(center)), 1.0)
    r = E @ nnls(E, right)[0] - right
    return amplitudes + motions @ (center - np.linalg.solve(S, r[:-1] / r[-1]))
