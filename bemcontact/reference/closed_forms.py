"""Closed forms of frictionless line contact from textbooks; forces are per thickness."""

from math import copysign, pi, sqrt

import numpy as np

from bemcontact.arrays import Array
from bemcontact.frozen import frozen_value
from bemcontact.problems.material import Material


@frozen_value
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
        """Relative error of the peak at b/R."""
        return 0.23 * ratio**2


@frozen_value
class PunchOnHalfPlane:
    """A rigid flat punch on a half-plane: p = P (1 + 2 e x/a²) / (π sqrt(a² - x²)), [Joh85] (2.64) for e = 0.

    The term with e leaves a displacement that is linear in x and has the moment P e; it presses everywhere for
    |e| <= a/2. A load farther out touches on c < x < a only, for e > 0, with c = 4 e - 3 a: that is the same form for
    a punch of half-width (a - c)/2 with the load at half of that, p = P / (π h) sqrt((x - c)/(a - x)), h = (a - c)/2.
    Valid for a body that is large against a; on a square block of 20 a by 10 a it is off by 0.5 %.

    Parameters
    ----------
    load : P [p L]
    half_width : a [L]
    eccentricity : e [L], |e| < a
    """

    load: float
    half_width: float
    eccentricity: float = 0.0

    @property
    def lifts_off(self) -> bool:
        """Whether one edge of the punch lifts off."""
        return abs(self.eccentricity) > self.half_width / 2

    @property
    def touching_half_width(self) -> float:
        """Half the width h [L] of what touches, a or 2 (a - |e|)."""
        return min(self.half_width, 2 * (self.half_width - abs(self.eccentricity)))

    @property
    def middle(self) -> float:
        """The middle [L] of what touches."""
        return copysign(self.half_width - self.touching_half_width, self.eccentricity)

    def tilt(self, modulus: float) -> float:
        """Angle [rad] by which the punch turns, sinking on the side of the load: 4 P e / (π E* a²) for |e| <= a/2.

        For the part h that touches with its load at h/2 beside its middle that is 2 P / (π E* h).
        """
        return 4 * self.load * (self.eccentricity - self.middle) / (pi * modulus * self.touching_half_width**2)

    def pressure(self, x: Array) -> Array:
        """Pressure (k,) [p] at distances x (k,) [L] from the middle; not a number where infinite, zero beyond."""
        h, y = self.touching_half_width, x - self.middle
        tilted = 1 + 2 * (self.eccentricity - self.middle) * y / h**2
        edge = 1e-12 * self.half_width
        inside = np.abs(y) < h - edge
        pressure = self.load * tilted / (pi * np.where(inside, np.sqrt(np.maximum(h**2 - y**2, 0.0)), np.nan))
        away = (np.abs(y) > h + edge) | (self.lifts_off & (y * copysign(1.0, self.eccentricity) < edge - h))
        return np.where(away, 0.0, pressure)


@frozen_value
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


@frozen_value
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


@frozen_value
class BeamOverProp:
    """A beam of span l and height h on two end supports, under q, that sinks by g onto a prop in its middle.

    Without the prop its middle sinks by w = 5ql⁴/384EI + ql²/8κGh, and a unit force there lifts it by
    l³/48EI + l/4κGh; so the prop has R = (w - g) / (l³/48EI + l/4κGh), or nothing, and each end (ql - R)/2.
    [TG70] art. 22 has what shear adds to bending; here it has Timoshenko's κ = 5/6. Per thickness, I = h³/12 and E is
    E' = E / (1 - ν²) in plane strain. Valid for slender beams on small rollers: without a gap R is off by 0.8 % at
    l = 10 h and the ends by 1.3 %, all by 0.2 % at 20 h, above all because the rollers dent the beam. What is uncertain
    of w, 0.4 % at 10 h, counts w / (w - g) times for R.

    Parameters
    ----------
    load : q [p]
    span, height : l, h [L]
    gap : g [L]
    modulus : E' [p]
    shear_modulus : G [p]
    """

    load: float
    span: float
    height: float
    gap: float
    modulus: float
    shear_modulus: float

    @property
    def sag(self) -> float:
        """Displacement w [L] of the middle without the prop."""
        return self.load * self.span * (5 / 8 * self._bending + self._shear / 2)

    @property
    def prop(self) -> float:
        """Force R of the prop [p L]; 0 if the beam does not reach it."""
        return max((self.sag - self.gap) / (self._bending + self._shear), 0.0)

    @property
    def end(self) -> float:
        """Force of each end support [p L]."""
        return (self.load * self.span - self.prop) / 2

    @property
    def _bending(self) -> float:
        """l³/48EI [1/p], how far bending lets a unit force lift the middle."""
        return self.span**3 / (4 * self.modulus * self.height**3)

    @property
    def _shear(self) -> float:
        """l/4κGh [1/p], what shear adds."""
        return self.span / (4 * 5 / 6 * self.shear_modulus * self.height)
