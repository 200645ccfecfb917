"""A round pin in a round hole of an infinite plate, pressed without friction on any part of its circumference."""

from math import atan, pi, radians, sqrt, tan
from typing import NamedTuple

import numpy as np
import scipy

from bemcontact.arrays import Array
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen_value
from bemcontact.problems.material import Material

TERMS = 40
"""Number of Chebyshev polynomials: half angle and peak have 8 digits, and all digits if the materials are equal."""
PLACES = 200
"""Number of places at which the integrals over the pressure are summed."""
WIDEST = radians(150)
"""Largest half angle that is looked for."""


class _Shape(NamedTuple):
    """Pressure under Q/R = 1 and the clearance that belongs to it.

    Parameters
    ----------
    factors : C (TERMS,), without a unit
    clearance : c/Q [1/p]
    """

    factors: Array
    clearance: float


@frozen_value
class LoosePin:
    """A pin of radius R in a hole of radius R + c, under a load Q at its center, [Per64], [CD01].

    Under the pressure p(θ) = Σ p_n cos nθ, the sum of both radial displacements has for n >= 2 the components
    R p_n (n A - D) / (n² - 1). Here A = A₁ + A₂ and D = B₁ - B₂, with A = (1 - ν)/G and B = (1 - 2ν)/2G of the pin (1)
    and of the plate (2), 0 of a rigid one, and ν / (1 + ν) for ν in plane stress. For n = 0 it has -R p_0 (A₂ + D), and
    for n = 1 it is a rigid motion. In contact it is c and a rigid motion, so that

        A d/dθ (1/2π) ⨍ p(φ) cot((θ - φ)/2) dφ - D p(θ) - (A - D) p_1 cos θ - A₂ p_0 = c/R,    p_1 = Q / πR.

    With tan(θ/2) = b s and b = tan(ε/2), ε the half angle of contact, the integral is that of a half-plane. So
    p = sqrt(1 - s²) Σ C_k U_2k(s) gives A (1 + b²s²)/2b Σ (2k + 1) C_k U_2k(s). The equation is solved at as many
    places as there are C_k. For D = 0, as for equal materials, its solution is the closed form of Persson,

        p R/Q = 2 w / (π r (1 + y²)) + log((r + w)/(r - w)) / (2π b² r²),    r² = 1 + b², w² = b² - y², y = b s,
        c / AQ = (1 - (A₂/A) (log r² + 2b⁴)) / (2π b² r²).

    Here R is the geometric mean of both radii, with which narrow contact is that of Hertz. Also exact if the load is
    spread over the volume of the pin, like a weight. The plate carries its load to infinity. One that ends W from the
    center and is held on one side has a peak that is off by 0.01 R/W, 0.09 R/W and 0.25 R/W at half angles of 10, 30
    and 70 degrees, less if it is held on the far side of the contact, and more on the near one. Held on both, it is off
    by 0.7 (R/W)² at 70 degrees with equal materials, and by up to 1.4 (R/W)² with others.

    Parameters
    ----------
    load : Q [p L]
    radius, clearance : R, c [L]
    pin, plate : materials, None of a rigid one
    """

    load: float
    radius: float
    clearance: float
    pin: Material | None
    plate: Material | None

    @property
    def mean_radius(self) -> float:
        """Geometric mean [L] of the radii of pin and hole."""
        return sqrt(self.radius * (self.radius + self.clearance))

    @cached_property
    def half_angle(self) -> float | None:
        """Angle ε [rad] between the middle and the end of contact; None if it is larger than `WIDEST`."""
        wanted = self.clearance / self.load
        if self._shape(tan(WIDEST / 2)).clearance > wanted:
            return None
        first, _, second, _ = self._constants
        least = min(sqrt((first + second) / (2 * pi * wanted)), 1.0) / 10  # a tenth of the b of Hertz
        b = scipy.optimize.brentq(
            lambda b: self._shape(b).clearance - wanted, least, tan(WIDEST / 2), xtol=1e-14 * least, rtol=1e-14
        )
        return 2 * atan(b)

    @property
    def peak(self) -> float:
        """Pressure [p] in the middle."""
        return float(self.pressure(np.zeros(1))[0])

    @property
    def spread(self) -> float:
        """Force [p L] across the load on one half of the contact, R ∫ p sin θ dθ from 0 to ε."""
        end = self.half_angle or 0.0
        places, weights = np.polynomial.legendre.leggauss(PLACES)
        angle = end / 2 * (1 + places)
        return float(self.mean_radius * end / 2 * weights @ (self.pressure(angle) * np.sin(angle)))

    def pressure(self, angle: Array) -> Array:
        """Pressure (k,) [p] at angles (k,) [rad] between -π and π from the middle; zero beyond ε."""
        end = self.half_angle
        if end is None:
            return np.full(len(angle), np.nan)
        inside = np.abs(angle) < end
        turn = np.arccos(np.tan(np.where(inside, angle, 0.0) / 2) / tan(end / 2))
        pressure = np.sin(np.outer(turn, _DEGREES)) @ self._shape(tan(end / 2)).factors
        return np.where(inside, self.load / self.mean_radius * pressure, 0.0)

    @property
    def _constants(self) -> tuple[float, float, float, float]:
        """A₁, B₁, A₂, B₂ [1/p]."""
        return *_compliances(self.pin), *_compliances(self.plate)

    def _shape(self, b: float) -> _Shape:
        """Solve the equation for half the tangent b, without a unit: C and c/Q."""
        first, own, second, other = self._constants
        A, D = first + second, own - other
        turn = np.arange(1, TERMS + 1) * pi / (2 * TERMS + 1)
        sines, y = np.sin(np.outer(turn, _DEGREES)), b * np.cos(turn)
        mean, first_harmonic = _harmonics(b)
        rows = A * (1 + y**2)[:, None] / (2 * b) * _DEGREES * sines / np.sin(turn)[:, None] - D * sines
        rows -= ((A - D) * (1 - y**2) / (1 + y**2))[:, None] * first_harmonic + second * mean
        matrix = np.block([[rows, -np.ones((TERMS, 1))], [first_harmonic[None], np.zeros((1, 1))]])
        solution = np.linalg.solve(matrix, np.append(np.zeros(TERMS), 1 / pi))
        return _Shape(solution[:-1], float(solution[-1]))


_DEGREES = 2 * np.arange(TERMS) + 1
"""Degrees 2k + 1: with s = cos t, sqrt(1 - s²) U_2k(s) = sin (2k + 1) t."""


def _compliances(material: Material | None) -> tuple[float, float]:
    """A = (1 - ν)/G and B = (1 - 2ν)/2G [1/p]; 0 if rigid."""
    if material is None:
        return 0.0, 0.0
    G, nu = material.shear_modulus, material.effective_poisson_ratio
    return (1 - nu) / G, (1 - 2 * nu) / (2 * G)


def _harmonics(b: float) -> tuple[Array, Array]:
    """p_0 and p_1 (TERMS,) of each polynomial: (1/2π) ∫ p dθ and (1/π) ∫ p cos θ dθ, by Gauss-Chebyshev quadrature."""
    turn = np.arange(1, PLACES) * pi / PLACES
    y2 = (b * np.cos(turn)) ** 2
    weights = b / PLACES * np.sin(turn) / (1 + y2)
    sines = np.sin(np.outer(turn, _DEGREES))
    return weights @ sines, 2 * (weights * (1 - y2) / (1 + y2)) @ sines
