"""Exponents of infinite pressures at a corner, from the angle of the elastic wedge and what holds its faces.

Near a corner the displacement is of the form r^λ f(θ), and stresses are infinite like r^(λ-1) if 0 < λ < 1. With
φ = A z^λ, ψ = B z^λ (Muskhelishvili) two conditions on each face are four real equations for A and B; λ is where they
are singular (Williams 1952). Frictionless contact with a straight rigid face, u_n = 0 = τ, mirrors the wedge: with a
free face, sin 2λω + λ sin 2ω = 0, which is λ = 1/2 on a half-plane, ω = π.

Contact of two elastic wedges joins their equations: on both faces shear is zero, and normal tractions and displacements
are the same (Dundurs and Lee 1972). On bonded faces both components of both are the same. At the tip of a closed
debond on a straight interface λ = 1/2: shear is infinite on the bond, and if Dundurs' β is not zero, so is pressure on
the contact, as |β| times that shear (Comninou 1977).

Constant tractions on the faces make λ = 1. Where that is singular too, as in contact beside a free face at a right
angle, the pressure changes like ln r; near to it, hardly less slowly.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array

GRID = tuple(np.arange(0.01, 0.995, 0.005).tolist())
"""Values of λ between which roots are looked for."""
ROOT = 1e-9
"""Smallest singular value, over the largest, of equations that are singular."""
EXACT = 1e-13
"""Accuracy of a root λ."""
FINER = 33
"""Values of λ at which the equations are looked at together on the way to a root."""
BESIDE_ONE = 0.005 / 1.5 ** np.arange(22)
"""Distances from λ = 1, which is a root where the wedges may turn together, at which others may be close to it."""
NEAR_ONE = tuple(np.concatenate([
    np.arange(0.7, 0.9925, 0.005), 1 - BESIDE_ONE, [1.0], 1 + BESIDE_ONE[::-1], np.arange(1.01, 1.305, 0.005)
]).tolist())  # fmt: skip
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
    bonded : whether it moves with the face of the opposite wedge, as `BONDED` does; without one, it is held
    """

    direction: complex
    held: tuple[bool, bool]
    contact: bool = False
    bonded: bool = False


def contact_face(normal: complex) -> Face:
    """A face in frictionless contact, with its normal."""
    return Face(normal, (True, False), contact=True)


FREE = Face(1.0, (False, False))
BONDED = Face(1.0, (True, True), bonded=True)
"""Its direction is that of the face on the other side."""


class OppositeWedge(NamedTuple):
    """The elastic wedge on the other side of contact.

    Parameters
    ----------
    start, angle, faces, poisson_ratio : as of `wedge_exponents`; its first face touches the second one of the other
        wedge, or its second the first
    stiffness : shear modulus over that of the other wedge
    """

    start: float
    angle: float
    faces: tuple[Face, Face]
    poisson_ratio: float
    stiffness: float


@lru_cache(maxsize=256)
def wedge_exponents(
    start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float, opposite: OppositeWedge | None = None
) -> tuple[float, ...]:
    """Exponents α = 1 - λ of pressures that are infinite like r^-α, the largest first.

    Parameters
    ----------
    start, angle : direction of the first face from the tip, and the angle inside the body from there [rad]
    faces : the first and the second one
    poisson_ratio : of plane strain
    opposite : the elastic wedge that faces in contact touch; a rigid surface if None
    """
    if not any(face.contact for face in faces):
        return ()
    wedge = (start, angle, faces, poisson_ratio, opposite)
    return tuple(1 - power for power in _roots(wedge, GRID) if _presses(wedge, power))


class BesideBond(NamedTuple):
    """The state with the largest exponent where a bond begins beside contact, up to a factor.

    Parameters
    ----------
    exponent : α
    pressure : on the contact at r = 1
    traction : on the wedge by the bond at r = 1, x + iy
    """

    exponent: float
    pressure: float
    traction: complex

    def intensity(self, traction: complex, distance: float) -> float:
        """Factor K of the pressure K r^-α that goes with a traction of the bond at a distance [L] from its tip."""
        size = (traction * self.traction.conjugate()).real / abs(self.traction) ** 2
        return size * self.pressure * distance**self.exponent


@lru_cache(maxsize=256)
def beside_bond(
    start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float, opposite: OppositeWedge | None = None
) -> BesideBond | None:
    """State of infinite pressure where a bond begins beside contact; None if there is none. Parameters as above."""
    known = wedge_exponents(start, angle, faces, poisson_ratio, opposite)
    if not known:
        return None
    power = 1 - known[0]
    state = np.linalg.svd(_conditions((start, angle, faces, poisson_ratio, opposite), power))[2][-1, :4]
    pressure, traction = 0.0, 0j
    for face, at, sign in zip(faces, (start, start + angle), OUTWARD, strict=True):
        outward = sign * complex(_field(at, power, poisson_ratio)[1] @ state)
        if face.contact:
            pressure = -(outward * np.conj(face.direction)).real
        if face.bonded:
            traction = outward
    return BesideBond(known[0], float(pressure), traction) if abs(traction) > UNPRESSED else None


@lru_cache(maxsize=256)
def stress_is_infinite(start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float) -> bool:
    """Whether stress grows without bound at the tip of a wedge, unless loads happen not to excite it.

    Parameters are those of `wedge_exponents`. Between a clamped face and a free one λ may be complex; its real part is
    below one if sin²ω > (κ+1)/4, or ω > π/2 (Williams 1952).
    """
    clamped, free = ((held, held) in [face.held for face in faces] for held in (True, False))
    if clamped and free:
        return bool(angle > np.pi / 2 + MARGINAL or np.sin(angle) ** 2 > 1 - poisson_ratio + MARGINAL)
    return bool(_roots((start, angle, faces, poisson_ratio, None), GRID))


@lru_cache(maxsize=256)
def _roots(wedge: "Wedge", grid: tuple[float, ...]) -> tuple[float, ...]:
    """Values of λ, between those of a grid, where the equations are singular."""
    sizes = _singular(wedge, np.array(grid))
    low = 1 + np.flatnonzero((sizes[1:-1] <= sizes[:-2]) & (sizes[1:-1] < sizes[2:]))
    powers = [_least(wedge, grid[i - 1], grid[i + 1]) for i in low.tolist()]
    return tuple(power for power in powers if _singular(wedge, np.array(power)) <= ROOT)


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
    start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float, loads: tuple[complex, ...],
    opposite: OppositeWedge | None = None,
) -> SlowChange | None:  # fmt: skip
    """How slowly the pressure changes at the tip of a wedge; None if no λ is near to one.

    Parameters
    ----------
    start, angle, faces, poisson_ratio, opposite : see `wedge_exponents`
    loads : traction [p] on each face, of which counts what the face does not hold: on one in contact the shear; then
        those on the faces of the opposite wedge
    """
    wedge = (start, angle, faces, poisson_ratio, opposite)
    roots = [power for power in _roots(wedge, NEAR_ONE) if _presses(wedge, power)]
    if not roots:
        return None
    power = min(roots, key=lambda root: abs(root - 1))
    left, sizes, right = np.linalg.svd(_conditions(wedge, power))
    null = sizes <= 10 * ROOT * sizes[0]
    given = _given(wedge, loads)

    def pressures(state: Array) -> tuple[float, float]:
        one, other = (
            -sign * float((_field(at, 1.0, poisson_ratio)[1] * np.conj(face.direction)).real @ state[:4])
            if face.contact
            else 0.0
            for face, at, sign in zip(faces, (start, start + angle), OUTWARD, strict=True)
        )
        return one, other

    derivative = (_conditions(wedge, power + STEP) - _conditions(wedge, power - STEP)) / (2 * STEP)
    left, right = left[:, null], right[null]
    amount = np.asarray(np.linalg.lstsq(left.T @ derivative @ right.T, left.T @ given, rcond=None)[0], float)
    constant = np.asarray(np.linalg.lstsq(_conditions(wedge, 1.0), given, rcond=None)[0], float)
    return SlowChange(pressures(constant), pressures(amount @ right), float(power - 1))


OUTWARD = -1.0, 1.0
"""Signs of the tractions out of a wedge on its faces: the field has those on rays, towards larger angles."""
Wedge = tuple[float, float, tuple[Face, Face], float, OppositeWedge | None]


def _least(wedge: Wedge, low: float, high: float) -> float:
    """Where the equations are most nearly singular between two λ; the smallest singular value is like |λ - λ0|."""
    while high - low > EXACT:
        powers = np.linspace(low, high, FINER)
        least = int(np.clip(_singular(wedge, powers).argmin(), 1, FINER - 2))
        low, high = float(powers[least - 1]), float(powers[least + 1])
    return (low + high) / 2


def _singular(wedge: Wedge, powers: Array) -> Array:
    """Smallest singular value of the conditions on both faces, over the largest, for each power."""
    sizes = np.linalg.svd(_conditions(wedge, powers), compute_uv=False)
    return sizes[..., -1] / sizes[..., 0]


def _presses(wedge: Wedge, power: float) -> bool:
    """Whether a state r^λ has pressure on a face in contact."""
    start, angle, faces, poisson_ratio, _ = wedge
    _, sizes, states = np.linalg.svd(_conditions(wedge, power))
    states = states[sizes <= 10 * ROOT * sizes[0], :4]
    for face, at in zip(faces, (start, start + angle), strict=True):
        if face.contact:
            _, traction = _field(at, power, poisson_ratio)
            if np.abs(states @ (traction * np.conj(face.direction)).real).max() > UNPRESSED:
                return True
    return False


def _conditions(wedge: Wedge, power: float | Array) -> Array:
    """Matrix of the conditions on both faces, on (Re A, Im A, Re B, Im B), for each power (...): (..., 4, 4).

    It is (..., 8, 8) on those of two wedges that touch.
    """
    start, angle, faces, poisson_ratio, other = wedge
    own_faces = _face_rows(start, angle, faces, poisson_ratio, power)
    if other is None:
        return np.stack([row for face in own_faces for row in face.held], axis=-2)
    other_faces, rows = _face_rows(*other[:4], power), list[tuple[Array | None, Array | None]]()
    for face, its, across in zip(faces, own_faces, other.faces[::-1], strict=True):
        joined = face.contact and across.contact  # a face that a third body touches is held as by a rigid one
        if face.bonded and across.bonded:
            continue
        rows += [(its.traction[1], None)] if joined else [(row, None) for row in its.held]
    for face, its, touched, theirs in zip(other.faces, other_faces, faces[::-1], own_faces[::-1], strict=True):
        if face.bonded and touched.bonded:
            rows += [(one, -two) for one, two in zip(theirs.traction, its.traction, strict=True)]
            moved = zip(theirs.displacement, its.displacement, strict=True)
            rows += [(one, -two / other.stiffness) for one, two in moved]
            continue
        if not (face.contact and touched.contact):
            rows += [(None, row) for row in its.held]
            continue
        turn = touched.direction * np.conj(face.direction)  # the normals are the same or opposite up to round-off
        sign = 1.0 if turn.real > 0 else -1.0
        rows.append((None, its.traction[1]))
        rows.append((theirs.traction[0], -sign * its.traction[0]))
        rows.append((theirs.displacement[0], -sign / other.stiffness * its.displacement[0]))
    return np.stack([_joined(*row) for row in rows], axis=-2)


def _given(wedge: Wedge, loads: tuple[complex, ...]) -> Array:
    """Right sides of the conditions for tractions on the faces, in their order."""
    _, _, own, _, other = wedge
    faces = own if other is None else (*own, *other.faces)
    given = list[float]()
    for number, (face, load) in enumerate(zip(faces, loads, strict=True)):
        directions = zip((face.direction, 1j * face.direction), face.held, strict=True)
        values = [0.0 if held else OUTWARD[number % 2] * (load * np.conj(at)).real for at, held in directions]
        across = None if other is None else (*other.faces[::-1], *own[::-1])[number]
        if across and face.bonded and across.bonded:
            given += [0.0] * (0 if number < 2 else 4)
        elif across is None or not (face.contact and across.contact):
            given += values
        else:
            given += values[1:] if number < 2 else [values[1], 0.0, 0.0]
    return np.array(given)


class _FaceRows(NamedTuple):
    """Rows (..., 4) of displacement and traction along the direction of a face, and across it; those that are held."""

    displacement: tuple[Array, Array]
    traction: tuple[Array, Array]
    held: tuple[Array, Array]


def _face_rows(
    start: float, angle: float, faces: tuple[Face, Face], poisson_ratio: float, power: float | Array
) -> tuple[_FaceRows, _FaceRows]:
    """The rows of both faces of a wedge."""

    def of(face: Face, at: float) -> _FaceRows:
        displacement, traction = (
            tuple((values * np.conj(direction)).real for direction in (face.direction, 1j * face.direction))
            for values in _field(at, power, poisson_ratio)
        )
        first, second = (u if held else t for u, t, held in zip(displacement, traction, face.held, strict=True))
        return _FaceRows((displacement[0], displacement[1]), (traction[0], traction[1]), (first, second))

    return of(faces[0], start), of(faces[1], start + angle)


def _joined(own: Array | None, other: Array | None) -> Array:
    """A row (..., 8) of two wedges, of which one may have no part in it."""
    known = own if own is not None else other
    assert known is not None, "one of the wedges has a part"
    none = np.zeros_like(known)
    return np.concatenate([none if own is None else own, none if other is None else other], axis=-1)


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
