"""Typical displacement and pressure of a contact problem, by which residuals are divided."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from bemcontact.arrays import Array

INTERFERENCE = 1e-6
"""Fraction of the widest gap from which there is interference: the accuracy of a linear program."""
ROUND_OFF = 64 * float(np.finfo(float).eps)
"""This fraction for a body that is held: less is a gap that has just closed."""


class ContactScales(NamedTuple):
    """Typical displacement U [L] and pressure T [p] of a contact problem, by which residuals are divided."""

    displacement: float
    pressure: float


def typical_scales(compliance: Array, offset: Array, rigid_motions: Array, balancing_pressure: Array) -> ContactScales:
    """Scales with U = ‖M‖∞ T: the larger of those of the load and of the interference.

    Parameters
    ----------
    compliance : (n, n) M [L/p]
    offset : (n,) q, the gap without contact [L]
    rigid_motions : (n, k) R
    balancing_pressure : (n,) the least pressure in equilibrium with the load [p]
    """
    norm = float(np.abs(compliance).sum(axis=1).max(initial=0.0))
    pressure = float(np.abs(balancing_pressure).max(initial=0.0))
    widest = float(np.abs(offset).max(initial=0.0))
    displacement = max(norm * pressure, _interference(offset, rigid_motions, widest)) or widest or 1.0
    return ContactScales(displacement, displacement / norm if norm > 0 else pressure or 1.0)


def _interference(offset: Array, rigid_motions: Array, widest: float) -> float:
    """Least s >= 0 [L] with q + R a >= -s for some a, by a linear program; zero below 1e-6 of the widest gap."""
    n, k = rigid_motions.shape
    if k == 0 or widest == 0:
        deepest = float(np.maximum(-offset, 0.0).max(initial=0.0))
        return deepest if deepest > ROUND_OFF * widest else 0.0
    columns = np.column_stack([rigid_motions, np.ones(n)])
    cost, bounds = np.append(np.zeros(k), 1.0), [(None, None)] * k + [(0, None)]
    optimum = linprog(cost, A_ub=-columns, b_ub=offset / widest, bounds=bounds)
    return widest * optimum.fun if optimum.success and optimum.fun > INTERFERENCE else 0.0
