"""Closed forms of frictionless line contact, as the textbooks have them; forces are per thickness."""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np

from bemcontact.contact import Array
from bemcontact.problem.material import Material


def contact_modulus(material: Material) -> float:
    """E* [p] of an elastic body on a rigid one: E / (1 - ν²) in plane strain, E in plane stress, [Joh85] 4.2."""
    return 2 * material.shear_modulus / (1 - material.effective_poisson_ratio)


@dataclass(frozen=True, kw_only=True)
class HertzContact:
    """Two cylinders pressed together: p = p0 sqrt(1 - x²/b²) with b² = 4 P R / (π E*), [Joh85] (4.43) to (4.45).

    Valid for b/R << 1, R the smaller radius: the gap of a circle is x²/2R only up to terms of relative size b²/4R², and
    so is the body a half-plane. Finite elements of a cylinder on a plane find a peak that is lower by 0.23 (b/R)²:
    0.03 % at b/R = 0.034 and 2.6 % at 0.34. On a block of 20 b by 10 b the peak is lower by 0.5 %.

    Parameters
    ----------
    load : P [p L]
    curvature : 1/R = 1/R1 + 1/R2 [1/L], radii of hollows negative
    modulus : E* [p]
    """

    load: float
    curvature: float
    modulus: float

    @property
    def half_width(self) -> float:
        """Half-width b [L]."""
        return sqrt(4 * self.load / (pi * self.modulus * self.curvature))

    @property
    def peak(self) -> float:
        """p0 = 2 P / (π b) [p]."""
        return 2 * self.load / (pi * self.half_width)

    def pressure(self, x: Array) -> Array:
        """Pressure (k,) [p] at distances x (k,) [L] from the middle; zero beyond b."""
        return self.peak * np.sqrt(np.maximum(1 - (x / self.half_width) ** 2, 0.0))

    @staticmethod
    def error(ratio: float) -> float:
        """How far the peak is off, relatively, at b/R."""
        return 0.23 * ratio**2


@dataclass(frozen=True, kw_only=True)
class PunchOnHalfPlane:
    """A rigid flat punch on a half-plane: p = P (1 + 2 e x/a²) / (π sqrt(a² - x²)), [Joh85] (2.64) for e = 0.

    The term with e leaves a displacement that is linear in x and has the moment P e; it presses everywhere for
    |e| <= a/2. Valid for a body that is large against a; on a square block of 20 a by 10 a it is off by 0.5 %.

    Parameters
    ----------
    load : P [p L]
    half_width : a [L]
    eccentricity : e [L]
    """

    load: float
    half_width: float
    eccentricity: float = 0.0

    def pressure(self, x: Array) -> Array:
        """Pressure (k,) [p] at distances x (k,) [L] from the middle; not a number at the edges, zero beyond."""
        a = self.half_width
        tilt = 1 + 2 * self.eccentricity * x / a**2
        root = np.sqrt(np.maximum(a**2 - x**2, 0.0))
        inside = np.abs(x) < a * (1 - 1e-12)
        pressure = self.load * tilt / (pi * np.where(inside, root, np.nan))
        return np.where(np.abs(x) > a * (1 + 1e-12), 0.0, pressure)


@dataclass(frozen=True, kw_only=True)
class ShrunkRing:
    """Lamé's ring a <= r <= b, one face of which is moved by δ against the pressure, [TG70] art. 28.

    With u = (1 - 2ν) A r + B/r over 2G and σ_r = A - B/r², the other face free of traction:
    on a pin    p = 2 G δ (b² - a²) / (a ((1 - 2ν) a² + b²)),
    in a bore   p = 2 G δ (b² - a²) / (b ((1 - 2ν) b² + a²)),
    with ν / (1 + ν) for ν in plane stress. Exact in the linear theory, in which the package works too.

    Parameters
    ----------
    inner_radius, outer_radius : a, b [L]
    interference : δ [L]
    """

    inner_radius: float
    outer_radius: float
    interference: float

    def pressure_on_pin(self, material: Material) -> float:
        """Pressure [p] between the ring and a rigid pin in it."""
        return self._pressure(self.inner_radius, self.outer_radius, material)

    def pressure_in_bore(self, material: Material) -> float:
        """Pressure [p] between the ring and a rigid bore around it."""
        return self._pressure(self.outer_radius, self.inner_radius, material)

    def _pressure(self, touched: float, free: float, material: Material) -> float:
        """Both formulas, which are one with the two faces exchanged."""
        G, nu = material.shear_modulus, material.effective_poisson_ratio
        wall = abs(free**2 - touched**2)
        return 2 * G * self.interference * wall / (touched * ((1 - 2 * nu) * touched**2 + free**2))


@dataclass(frozen=True, kw_only=True)
class ClosedCrack:
    """An elliptical opening in an infinite panel, closed by compression q across it.

    The free opening of half-length a and half-height c closes by q (2a + c) / E' in its middle and stays an ellipse.
    The uniform stress σ_yy = -t loads its faces by t per length of the plane and closes it by t c / E' only. Of q,
    the part q - t acts on a free opening, so that it closes to the tip with t = (q (2a + c) - c E') / (2a). A straight
    slit that starts with the gap c sqrt(1 - x²/a²) closes with t = q - c E' / (2a), the same without the small q c.
    Valid for t > 0 and a panel that is large against a: one of 2w by 2w has a pressure larger by 3.4 (a/w)².

    Parameters
    ----------
    half_length, half_height : a, c [L]
    compression : q [p]
    modulus : E' [p]
    slit : whether the edge is straight
    """

    half_length: float
    half_height: float
    compression: float
    modulus: float
    slit: bool = False

    @property
    def pressure_along_plane(self) -> float:
        """Force t [p] per length of the rigid plane; negative if the opening does not close."""
        a, c, q = self.half_length, self.half_height, self.compression
        return (q * (2 * a + (0.0 if self.slit else c)) - c * self.modulus) / (2 * a)

    def pressure(self, x: Array) -> Array:
        """Pressure (k,) [p] per undeformed length, t dx/ds, at distances x (k,) [L]; not a number beyond the tip."""
        a, c = self.half_length, 0.0 if self.slit else self.half_height
        room = np.maximum(a**2 - x**2, 0.0)
        with np.errstate(invalid="ignore"):
            cosine = np.sqrt(room / (room + (c * x / a) ** 2))
        return np.where(np.abs(x) < a * (1 - 1e-12), self.pressure_along_plane * cosine, np.nan)
