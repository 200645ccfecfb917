"""Exponents of infinite pressures at a corner, from the angle of the elastic wedge and what holds its faces.

Near a corner the displacement is of the form r^λ f(θ), and stresses are infinite like r^(λ-1) if 0 < λ < 1. With
φ = A z^λ, ψ = B z^λ (Muskhelishvili) two conditions on each face are four real equations for A and B; λ is where they
are singular (Williams 1952). Frictionless contact with a straight rigid face, u_n = 0 = τ, mirrors the wedge: with a
free face, sin 2λω + λ sin 2ω = 0, which is λ = 1/2 on a half-plane, ω = π.

Constant tractions on the faces make λ = 1. Where that is singular too, as in contact beside a free face at a right
angle, the pressure changes like ln r; near to it, hardly less slowly.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array

GRID = np.arange(0.01, 0.995, 0.005)
"""Values of λ between which roots are looked for."""
ROOT = 1e-9
"""Smallest singular value, over the largest, of equations that are singular."""
EXACT = 1e-13
"""Accuracy of a root λ."""
NEAR_ONE = np.arange(0.7, 1.305, 0.005)
"""Values of λ between which roots change the pressure so slowly that meshes do not tell where it ends."""
RESONANT = 1e-6
"""Largest |λ - 1| at which the pressure is computed as that of a logarithm."""
STEP = 1e-6
"""Step of λ for a derivative of the equations."""
MARGINAL = 1e-6
"""Angle [rad], and sin² of it, by which round-off may exceed those at which λ = 1."""
UNPRESSED = 1e-6
"""Pressure on a face in contact, over the largest stress of a state, that is none."""


class Face(NamedTuple):
    """What a face of a wedge is held by: in each of two directions at right angles, displacement or nothing.

    Parameters
    ----------
    direction : complex number of the first direction; the second is it times i
    held : whether the displacement in each direction is prescribed, else the traction
    contact : whether pressure acts on it
    """

    direction: complex
    held: tuple[bool, bool]
    contact: bool = False


def contact_face(normal: complex) -> Face:
    """A face in frictionless contact, with its normal."""
    return Face(normal, (True, False), contact=True)


FREE = Face(1.0, (False, False))


@lru_cache(maxsize=256)
def wedge_exponents(start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float) -> tuple[float, ...]:
    """Exponents α = 1 - λ of pressures that are infinite like r^-α, the largest first.

    Parameters
    ----------
    start, angle : direction of the first face from the tip, and the angle inside the body from there [rad]
    faces : the first and the second one
    poisson_ratio : of plane strain
    """
    if not any(face.contact for face in faces):
        return ()
    wedge = (start, angle, faces, poisson_ratio)
    return tuple(1 - power for power in _roots(wedge, GRID) if _presses(wedge, power))


@lru_cache(maxsize=256)
def stress_is_infinite(start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float) -> bool:
    """Whether stress grows without bound at the tip of a wedge, unless loads happen not to excite it.

    Parameters are those of `wedge_exponents`. Between a clamped face and a free one λ may be complex; its real part is
    below one if sin²ω > (κ+1)/4, or ω > π/2 (Williams 1952).
    """
    clamped, free = ((held, held) in [face.held for face in faces] for held in (True, False))
    if clamped and free:
        return bool(angle > np.pi / 2 + MARGINAL or np.sin(angle) ** 2 > 1 - poisson_ratio + MARGINAL)
    return bool(_roots((start, angle, faces, poisson_ratio), GRID))


def _roots(wedge: "Wedge", grid: Array) -> list[float]:
    """Values of λ, between those of a grid, where the equations are singular."""
    sizes = _singular(wedge, grid)
    low = 1 + np.flatnonzero((sizes[1:-1] <= sizes[:-2]) & (sizes[1:-1] < sizes[2:]))
    powers = [_least(wedge, float(grid[i - 1]), float(grid[i + 1])) for i in low]
    return [power for power in powers if _singular(wedge, np.array(power)) <= ROOT]


class SlowChange(NamedTuple):
    """Pressures on both faces that hardly change with the distance r from the tip: c + (p - c) (r/R)^rate if p at R.

    With rate = 0 they are p + slope ln(r/R).

    Parameters
    ----------
    constants : c [p], by tractions alone; not known if rate = 0
    slopes : [p] of the logarithm
    rate : power λ - 1, as of `NEAR_ONE`
    """

    constants: tuple[float, float]
    slopes: tuple[float, float]
    rate: float

    def at(self, face: int, pressure: float, ratio: float) -> float:
        """Pressure on a face at r = ratio R from that at R."""
        if abs(self.rate) <= RESONANT:
            return pressure + self.slopes[face] * float(np.log(ratio))
        return self.constants[face] + (pressure - self.constants[face]) * ratio**self.rate


@lru_cache(maxsize=256)
def slow_change(
    start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float, loads: tuple[complex, complex]
) -> SlowChange | None:
    """How slowly the pressure changes at the tip of a wedge; None if no λ is near to one.

    Parameters
    ----------
    start, angle, faces, poisson_ratio : see `wedge_exponents`
    loads : traction [p] on each face, of which counts what the face does not hold: on one in contact the shear
    """
    wedge = (start, angle, faces, poisson_ratio)
    roots = [power for power in _roots(wedge, NEAR_ONE) if _presses(wedge, power)]
    if not roots:
        return None
    power = min(roots, key=lambda root: abs(root - 1))
    left, sizes, right = np.linalg.svd(_conditions(wedge, power))
    null = sizes <= 10 * ROOT * sizes[0]
    outward = -1.0, 1.0  # the field has tractions on rays, towards larger angles
    given = np.array([
        0.0 if held else sign * (load * np.conj(direction)).real
        for face, load, sign in zip(faces, loads, outward, strict=True)
        for direction, held in zip((face.direction, 1j * face.direction), face.held, strict=True)
    ])  # fmt: skip

    def pressures(state: Array) -> tuple[float, float]:
        one, other = (
            -sign * float((_field(at, 1.0, poisson_ratio)[1] * np.conj(face.direction)).real @ state)
            if face.contact
            else 0.0
            for face, at, sign in zip(faces, (start, start + angle), outward, strict=True)
        )
        return one, other

    derivative = (_conditions(wedge, power + STEP) - _conditions(wedge, power - STEP)) / (2 * STEP)
    left, right = left[:, null], right[null]
    amount = np.asarray(np.linalg.lstsq(left.T @ derivative @ right.T, left.T @ given, rcond=None)[0], float)
    constant = np.asarray(np.linalg.lstsq(_conditions(wedge, 1.0), given, rcond=None)[0], float)
    return SlowChange(pressures(constant), pressures(amount @ right), float(power - 1))


Wedge = tuple[float, float, tuple[Face, Face], float]


def _least(wedge: Wedge, low: float, high: float) -> float:
    """Where the equations are most nearly singular between two λ; the smallest singular value is like |λ - λ0|."""
    ratio = (np.sqrt(5) - 1) / 2
    while high - low > EXACT:
        one, other = high - ratio * (high - low), low + ratio * (high - low)
        nearer, farther = _singular(wedge, np.array([one, other]))
        if nearer <= farther:
            high = other
        else:
            low = one
    return (low + high) / 2


def _singular(wedge: Wedge, powers: Array) -> Array:
    """Smallest singular value of the conditions on both faces, over the largest, for each power."""
    sizes = np.linalg.svd(_conditions(wedge, powers), compute_uv=False)
    return sizes[..., -1] / sizes[..., 0]


def _presses(wedge: Wedge, power: float) -> bool:
    """Whether a state r^λ has pressure on a face in contact."""
    start, angle, faces, poisson_ratio = wedge
    _, sizes, states = np.linalg.svd(_conditions(wedge, power))
    states = states[sizes <= 10 * ROOT * sizes[0]]
    for face, at in zip(faces, (start, start + angle), strict=True):
        if face.contact:
            _, traction = _field(at, power, poisson_ratio)
            if np.abs(states @ (traction * np.conj(face.direction)).real).max() > UNPRESSED:
                return True
    return False


def _conditions(wedge: Wedge, power: float | Array) -> Array:
    """Matrix (..., 4, 4) of the conditions on both faces, on (Re A, Im A, Re B, Im B), for each power (...)."""
    start, angle, faces, poisson_ratio = wedge
    rows = list[Array]()
    for face, at in zip(faces, (start, start + angle), strict=True):
        displacement, traction = _field(at, power, poisson_ratio)
        for direction, held in zip((face.direction, 1j * face.direction), face.held, strict=True):
            rows.append(((displacement if held else traction) * np.conj(direction)).real)
    return np.stack(rows, axis=-2)


def _field(theta: float, power: float | Array, poisson_ratio: float) -> tuple[Array, Array]:
    """2 G u and the traction on a ray (..., 4), as complex numbers, at r = 1 for each of (Re A, Im A, Re B, Im B)."""
    A, B = np.array([1, 1j, 0, 0]), np.array([0, 0, 1, 1j])
    z = np.exp(1j * theta)
    power = np.asarray(power, float)[..., None]
    phi, slope, bent = A * _power(theta, power), power * A * _power(theta, power - 1), power * (power - 1) * A
    displacement = (3 - 4 * poisson_ratio) * phi - z * np.conj(slope) - np.conj(B * _power(theta, power))
    stress = slope + np.conj(slope) + bent * _power(theta, power - 1) + power * B * _power(theta, power + 1)
    return displacement, 1j * z * np.conj(stress)


def _power(theta: float, power: Array) -> Array:
    """Power of z = e^(iθ), continuous in θ."""
    return np.exp(1j * theta * power)
