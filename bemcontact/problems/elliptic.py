"""The arc length of an ellipse: the incomplete elliptic integral of the second kind."""

import numpy as np

from bemcontact.arrays import Array

SERIES = 3e-3
"""Difference of arguments over their mean up to which Carlson's series have all digits: errors are its sixth power."""


def second_kind(angle: Array, ratio: float) -> Array:
    """E(φ | 1 - r²) = ∫₀^φ sqrt(cos²θ + r² sin²θ) dθ for angles φ (n,) and the ratio r of two semi-axes, 0 < r <= 1.

    `scipy.special.ellipeinc` takes longer to import than a problem to check.

    References
    ----------
    B. C. Carlson, "Numerical computation of real or complex elliptic integrals", Numer. Algorithms 10 (1995) 13-26.
    NIST Digital Library of Mathematical Functions, https://dlmf.nist.gov/19.25.E10 and /19.36.
    """
    half_turns = np.rint(angle / np.pi)
    rest = angle - half_turns * np.pi
    s, c, r2 = np.append(np.sin(rest), 1.0), np.append(np.cos(rest), 0.0), ratio**2
    slope2 = c * c + r2 * (s * s)
    first, second = _symmetric(c * c, slope2)
    k2 = (1.0 - ratio) * (1.0 + ratio)
    value = r2 * s * (first + k2 / 3.0 * (s * s) * second) + k2 * s * c / np.sqrt(slope2)
    return value[:-1] + 2.0 * half_turns * value[-1]


def _symmetric(x: Array, y: Array) -> tuple[Array, Array]:
    """R_F(x, y, 1) and R_D(x, 1, y), by duplication until the arguments are near each other."""
    z, total, power = np.ones_like(x), np.zeros_like(x), 1.0
    mean = (x + y + z) / 3.0
    # the arguments are between 0 and 1, and each duplication divides their differences by four
    while power > SERIES * float(np.min(mean)):
        root, other, last = np.sqrt(x), np.sqrt(y), np.sqrt(z)
        shift = root * (other + last) + other * last
        total += power / (other * (y + shift))
        x, y, z, power = (x + shift) / 4.0, (y + shift) / 4.0, (z + shift) / 4.0, power / 4.0
        mean = (x + y + z) / 3.0
    weighted = (x + z + 3.0 * y) / 5.0
    X, Y = 1.0 - x / mean, 1.0 - y / mean
    e2, e3 = -(X * X + X * Y + Y * Y), -X * Y * (X + Y)
    first = (1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0) / np.sqrt(mean)
    X, Z = 1.0 - x / weighted, 1.0 - z / weighted
    Y = -(X + Z) / 3.0
    e2, e3 = X * Z - 6.0 * Y * Y, (3.0 * X * Z - 8.0 * Y * Y) * Y
    e4, e5 = 3.0 * (X * Z - Y * Y) * Y * Y, X * Z * Y**3
    series = 1.0 - 3.0 * e2 / 14.0 + e3 / 6.0 + 9.0 * e2 * e2 / 88.0 - 3.0 * e4 / 22.0 - 9.0 * e2 * e3 / 52.0
    return first, 3.0 * total + power * (series + 3.0 * e5 / 26.0) / (weighted * np.sqrt(weighted))
