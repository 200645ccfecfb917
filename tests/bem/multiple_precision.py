"""The rule of Gauss and Legendre by which integrals in multiple precision are computed."""

from functools import cache

import mpmath as mp
from mpmath.calculus.quadrature import GaussLegendre

DIGITS = 25


@cache
def rule_of_24() -> list[tuple[mp.mpf, mp.mpf]]:
    with mp.workdps(DIGITS):
        return GaussLegendre(mp.mp).calc_nodes(4, mp.mp.prec)
