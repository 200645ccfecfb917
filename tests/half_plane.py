"""Stress in the half-plane y < 0 under tractions on its edge, in closed form.

Muskhelishvili, "Some Basic Problems of the Mathematical Theory of Elasticity", ch. 19: with the tractions σyy = N and
σxy = T on y = 0 and Φ(z) = -1/(2πi) ∫ (N - iT) dξ/(ξ - z), σxx + σyy = 4 Re Φ(z) and
σyy - iσxy = Φ(z) - Φ(z̄) + (z - z̄) conj Φ'(z).
"""

from collections.abc import Callable

import numpy as np

Cauchy = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""∫ p dξ/(ξ - z) of a pressure p, and its derivative."""


def stress(points: np.ndarray, pressure: Cauchy) -> np.ndarray:
    """σxx, σyy, σxy (k, 3) at points (k, 2), from the integral of the pressure, or of the pressure times 1 + i T/N."""
    z = points[:, 0] + 1j * points[:, 1]
    (own, slope), (mirrored, _) = pressure(z), pressure(z.conj())
    phi, phi_1, other = (part / (2j * np.pi) for part in (own, slope, mirrored))
    w = phi - other + (z - z.conj()) * phi_1.conj()
    return np.column_stack([4 * phi.real - w.real, w.real, -w.imag])


def hertz(half_width: float, peak: float, curvature: float = 0.0) -> Cauchy:
    """Pressure p = p0 sqrt(1 - x²/b²), with the shear p x/R of a rigid circle, on whose normals it acts."""

    def integral(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        root = np.sqrt(z - half_width) * np.sqrt(z + half_width)
        own, slope = (-np.pi * peak / half_width * part for part in (z - root, 1 - z / root))
        sheared = np.pi * peak * half_width / 2 + z * own
        return own + 1j * curvature * sheared, slope + 1j * curvature * (own + z * slope)

    return integral


def punch(half_width: float, load: float) -> Cauchy:
    """Pressure p = P / (π sqrt(a² - x²))."""

    def integral(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        root = np.sqrt(z - half_width) * np.sqrt(z + half_width)
        return -load / root, load * z / root**3

    return integral


def strip(half_width: float, pressure: float) -> Cauchy:
    """Constant pressure on |x| < c: Flamant's line loads side by side."""

    def integral(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        ratio = (z - half_width) / (z + half_width)
        return pressure * np.log(ratio), pressure * (1 / (z - half_width) - 1 / (z + half_width))

    return integral
