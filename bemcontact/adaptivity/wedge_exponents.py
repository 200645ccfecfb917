"""Exponents of infinite pressures and stresses at a corner, from the elastic wedges there and what holds their faces.

Near a corner the displacement is of the form r^λ f(θ), and stresses are infinite like r^(λ-1) if 0 < λ < 1. With
φ = A z^λ, ψ = B z^λ (Muskhelishvili) two conditions on each face are four real equations for A and B; λ is where they
are singular (Williams 1952). Frictionless contact with a straight rigid face, u_n = 0 = τ, mirrors the wedge: with a
free face, sin 2λω + λ sin 2ω = 0, which is λ = 1/2 on a half-plane, ω = π.

Contact of two elastic wedges joins their equations: on both faces shear is zero, and normal tractions and displacements
are the same (Dundurs and Lee 1972). On bonded faces both components of both are the same. Any number of wedges may meet
so. At the tip of a closed debond on a straight interface λ = 1/2: shear is infinite on the bond, and if Dundurs' β is
not zero, so is pressure on the contact, as |β| times that shear (Comninou 1977).

Pressure does not change its sign, so that its λ is real. Stress beside clamped and bonded faces may have complex ones:
with A, its conjugate, B and its conjugate as unknowns, the equations are analytic in λ, and how often their determinant
turns along a closed path is the number of λ inside (the principle of the argument).

Constant tractions on the faces make λ = 1. Where that is singular too, as in contact beside a free face at a right
angle, the pressure changes like ln r; near to it, hardly less slowly.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from bemcontact.arrays import Array, ComplexArray

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
WEAKEST = 3e-4, 0.01
"""Exponents of stress that are none: round-off of an angle must not make a smaller λ of that of a constant stress.
Around a closed ring of wedges the states with λ = 1 are so many that others are not told from them so near by."""
STRONGEST = 0.9
"""Exponent of stress beyond which there is none."""
HIGHEST = 2.0
"""Imaginary part of λ beyond which there is none."""
UNPRESSED = 1e-6
"""Pressure on a face in contact, over the largest stress of a state, that is none."""


OUTWARD = -1.0, 1.0
"""Signs of the tractions out of a wedge on its faces: the field has those on rays, towards larger angles."""


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


class Wedge(NamedTuple):
    """An elastic wedge.

    Parameters
    ----------
    start, angle : direction of the first face from the tip, and the angle inside the body from there [rad]
    faces : the first and the second one
    poisson_ratio : of plane strain
    stiffness : shear modulus, in any unit that is that of all wedges that meet
    """

    start: float
    angle: float
    faces: tuple[Face, Face]
    poisson_ratio: float
    stiffness: float = 1.0

    @property
    def directions(self) -> tuple[float, float]:
        """Directions of both faces [rad]."""
        return self.start, self.start + self.angle


class Wedges(NamedTuple):
    """Elastic wedges around one tip, counterclockwise. The second face of each is on the first one of the next.

    Parameters
    ----------
    wedges : both of two faces that are on each other are in contact, or both are bonded
    own : number of the wedge whose pressures are asked for
    closed : whether the last one is on the first
    """

    wedges: tuple[Wedge, ...]
    own: int = 0
    closed: bool = False

    def joined(self, number: int, side: int) -> bool:
        """Whether a face of a wedge is on that of another one."""
        return self.closed or (number + 1 < len(self.wedges) if side else number > 0)

    @property
    def at(self) -> Wedge:
        """The wedge whose pressures are asked for."""
        return self.wedges[self.own]

    def own_state(self, states: Array) -> Array:
        """Its part (…, 4) of states (…, 4 k)."""
        return states[..., 4 * self.own : 4 * self.own + 4]


@lru_cache(maxsize=256)
def wedge_exponents(wedges: Wedges) -> tuple[float, ...]:
    """Exponents α = 1 - λ of pressures that are infinite like r^-α, the largest first."""
    if not any(face.contact for face in wedges.at.faces):
        return ()
    return tuple(1 - power for power in _roots(wedges, GRID) if _presses(wedges, power))


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
def beside_bond(wedges: Wedges) -> BesideBond | None:
    """State of infinite pressure where a bond begins beside contact; None if there is none."""
    known = wedge_exponents(wedges)
    if not known:
        return None
    power, own = 1 - known[0], wedges.at
    state = wedges.own_state(np.linalg.svd(_conditions(wedges, power))[2][-1])
    pressure, traction = 0.0, 0j
    for side, (face, sign) in enumerate(zip(own.faces, OUTWARD, strict=True)):
        outward = sign * complex(_field(own, side, power)[1] @ state)
        if face.contact:
            pressure = -(outward * np.conj(face.direction)).real
        if face.bonded:
            traction = outward
    return BesideBond(known[0], float(pressure), traction) if abs(traction) > UNPRESSED else None


@lru_cache(maxsize=256)
def stress_is_infinite(wedges: Wedges) -> bool:
    """Whether stress grows without bound at the tip, unless loads happen not to excite it.

    It is so if there is a λ with 0 < Re λ < 1.
    """
    determinants = np.linalg.det(_conditions(wedges, _strip(WEAKEST[wedges.closed])))
    turns = np.angle(np.roll(determinants, -1) / determinants).sum() / (2 * np.pi)
    return round(float(turns)) > 0


@lru_cache(maxsize=256)
def _roots(wedges: Wedges, grid: tuple[float, ...]) -> tuple[float, ...]:
    """Values of λ, between those of a grid, where the equations are singular."""
    sizes = _singular(wedges, np.array(grid))
    low = 1 + np.flatnonzero((sizes[1:-1] <= sizes[:-2]) & (sizes[1:-1] < sizes[2:]))
    powers = [_least(wedges, grid[i - 1], grid[i + 1]) for i in low.tolist()]
    return tuple(power for power in powers if _singular(wedges, np.array(power)) <= ROOT)


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
def slow_change(wedges: Wedges, loads: tuple[complex, ...]) -> SlowChange | None:
    """How slowly the pressure changes at the tip of wedges; None if no λ is near to one.

    `loads` are tractions [p] on both faces of each wedge, of which counts what the face does not hold: on one in
    contact the shear.
    """
    roots = [power for power in _roots(wedges, NEAR_ONE) if _presses(wedges, power)]
    if not roots:
        return None
    power, own = min(roots, key=lambda root: abs(root - 1)), wedges.at
    left, sizes, right = np.linalg.svd(_conditions(wedges, power))
    null = sizes <= 10 * ROOT * sizes[0]
    given = _given(wedges, loads)

    def pressures(state: Array) -> tuple[float, float]:
        one, other = (
            -sign * float((_field(own, side, 1.0)[1] * np.conj(face.direction)).real @ state) if face.contact else 0.0
            for side, (face, sign) in enumerate(zip(own.faces, OUTWARD, strict=True))
        )
        return one, other

    derivative = (_conditions(wedges, power + STEP) - _conditions(wedges, power - STEP)) / (2 * STEP)
    left, right = left[:, null], right[null]
    amount = np.asarray(np.linalg.lstsq(left.T @ derivative @ right.T, left.T @ given, rcond=None)[0], float)
    constant = np.asarray(np.linalg.lstsq(_conditions(wedges, 1.0), given, rcond=None)[0], float)
    constants, slopes = (pressures(wedges.own_state(state)) for state in (constant, amount @ right))
    return SlowChange(constants, slopes, float(power - 1))


@lru_cache
def _strip(weakest: float) -> ComplexArray:
    """Closed path (k,), counterclockwise around the λ of infinite stress; closest where it passes λ = 1 or 0."""
    side, other = (
        1j * near * np.sinh(np.linspace(-1, 1, 161) * np.arcsinh(HIGHEST / near)) for near in (weakest, 1 - STRONGEST)
    )
    across = np.linspace(1 - STRONGEST, 1 - weakest, 41)[1:-1]
    parts = [1 - weakest + side, across[::-1] + 1j * HIGHEST, 1 - STRONGEST - other, across - 1j * HIGHEST]
    return np.concatenate(parts).astype(complex)


def _least(wedges: Wedges, low: float, high: float) -> float:
    """Where the equations are most nearly singular between two λ; the smallest singular value is like |λ - λ0|."""
    while high - low > EXACT:
        powers = np.linspace(low, high, FINER)
        least = int(np.clip(_singular(wedges, powers).argmin(), 1, FINER - 2))
        low, high = float(powers[least - 1]), float(powers[least + 1])
    return (low + high) / 2


def _singular(wedges: Wedges, powers: Array) -> Array:
    """Smallest singular value of the conditions on both faces, over the largest, for each power."""
    sizes = np.linalg.svd(_conditions(wedges, powers), compute_uv=False)
    return sizes[..., -1] / sizes[..., 0]


def _presses(wedges: Wedges, power: float) -> bool:
    """Whether a state r^λ has pressure on a face in contact."""
    own = wedges.at
    _, sizes, states = np.linalg.svd(_conditions(wedges, power))
    states = wedges.own_state(states[sizes <= 10 * ROOT * sizes[0]])
    for side, face in enumerate(own.faces):
        if face.contact:
            _, traction = _field(own, side, power)
            if np.abs(states @ (traction * np.conj(face.direction)).real).max() > UNPRESSED:
                return True
    return False


def _conditions(wedges: Wedges, power: complex | Array | ComplexArray) -> Array:
    """Matrix (…, 4 k, 4 k) of the conditions on all faces, for each power (…).

    Its columns are Re A, Im A, Re B, Im B of each of the k wedges.
    """
    rows, count = list[Array](), len(wedges.wedges)

    def add(*parts: tuple[int, Array]) -> None:
        """Add a row with parts of wedges of these numbers."""
        row = np.zeros((*parts[0][1].shape[:-1], 4 * count), parts[0][1].dtype)
        for number, part in parts:
            row[..., 4 * number : 4 * number + 4] += part
        rows.append(row)

    for number, wedge in enumerate(wedges.wedges):
        for side, face in enumerate(wedge.faces):
            if wedges.joined(number, side) and not side:
                continue  # with the face that it is on
            here = _on_face(wedge, side, face.direction, power)
            if not wedges.joined(number, side):
                for at in range(2):
                    add((number, here.displacement[at] if face.held[at] else here.traction[at]))
            else:
                other = (number + 1) % count
                there = _on_face(wedges.wedges[other], 0, face.direction, power)
                if face.contact:
                    add((number, here.traction[1]))
                    add((other, there.traction[1]))
                softer = min(wedge.stiffness, wedges.wedges[other].stiffness)
                for at in range(1 if face.contact else 2):
                    add((number, here.traction[at]), (other, -there.traction[at]))
                    moved = softer / wedge.stiffness, softer / wedges.wedges[other].stiffness
                    add((number, moved[0] * here.displacement[at]), (other, -moved[1] * there.displacement[at]))
    return np.stack(rows, axis=-2)


def _given(wedges: Wedges, loads: tuple[complex, ...]) -> Array:
    """Right sides of the conditions for tractions on the faces, in their order."""
    given, both = list[float](), np.reshape(loads, (-1, 2))
    for number, wedge in enumerate(wedges.wedges):
        for side, (face, load) in enumerate(zip(wedge.faces, both[number].tolist(), strict=True)):
            if not wedges.joined(number, side):
                directions = zip((face.direction, 1j * face.direction), face.held, strict=True)
                given += [0.0 if held else OUTWARD[side] * (load * np.conj(at)).real for at, held in directions]
            elif side and face.contact:
                sheared = np.array([load, -both[(number + 1) % len(both), 0]]) * np.conj(1j * face.direction)
                given += [*sheared.real.tolist(), 0.0, 0.0]
            elif side:
                given += [0.0] * 4
    return np.array(given)


class _FaceRows(NamedTuple):
    """Rows (…, 4) of displacement and traction along a direction on a face, and across it."""

    displacement: tuple[Array, Array]
    traction: tuple[Array, Array]


def _on_face(wedge: Wedge, side: int, direction: complex, power: complex | Array | ComplexArray) -> _FaceRows:
    """The rows of a face of a wedge in a direction, for complex λ continued analytically from those of real ones."""
    real = not np.iscomplexobj(power)
    values = _field(wedge, side, power)
    mirrored = values if real else _field(wedge, side, np.conj(power))

    def part(number: int, at: complex) -> Array:
        one, other = values[number] * np.conj(at), np.conj(mirrored[number] * np.conj(at))
        return one.real if real else (one + other) / 2

    (normal, pressure), (along, shear) = ((part(0, at), part(1, at)) for at in (direction, 1j * direction))
    return _FaceRows((normal, along), (pressure, shear))


def _field(wedge: Wedge, side: int, power: complex | Array | ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """2 G u and the traction on a face (…, 4), as complex numbers, at r = 1 for each of (Re A, Im A, Re B, Im B).

    z^λ is one in the middle of the wedge, so that complex λ make no large numbers.
    """
    A, B, kappa = np.array([1, 1j, 0, 0]), np.array([0, 0, 1, 1j]), 3 - 4 * wedge.poisson_ratio
    z, from_middle = np.exp(1j * wedge.directions[side]), (side - 0.5) * wedge.angle
    own = np.asarray(power, complex)[..., None]
    its = own.conj()  # conjugates of functions of λ are those of its conjugate

    def raised(at: ComplexArray) -> ComplexArray:
        return np.exp(1j * from_middle * at)

    def slope(at: ComplexArray) -> ComplexArray:
        return at * A * raised(at) / z

    displacement = kappa * A * raised(own) - np.conj(np.conj(z) * slope(its) + B * raised(its))
    stress = its * slope(its) + np.conj(slope(own)) + its * B * raised(its) * z
    return displacement, 1j * z * np.conj(stress)
