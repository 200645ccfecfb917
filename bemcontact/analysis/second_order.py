"""Whether slender parts carry loads otherwise once they are displaced: they stretch as they bend, or they buckle.

Linear theory writes equilibrium for the undeformed body. In bodies that are not slender this is off by the order of
strains and rotations, which `linear_theory` judges. In slender ones it may be off by far more.
"""

from typing import NamedTuple

import numpy as np

from bemcontact.adaptivity.first_sizes import ACROSS, OPPOSED
from bemcontact.analysis.displaced_body import ProbedBody, elastic_displacement
from bemcontact.analysis.linear_theory import LARGE, LARGE_PART, NOTICED, Judgment, Noticed
from bemcontact.arrays import Array, IntArray, magnitudes
from bemcontact.assessment.penetration import Misfit, Penetration
from bemcontact.bem import reference_element
from bemcontact.bem.body import Body
from bemcontact.bem.bonds import bonded_elements
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.loading import particular_solutions
from bemcontact.bem.mesh import Mesh
from bemcontact.errors import BemContactError
from bemcontact.problems.conditions import Loads

CHANGED = 0.05
"""Error of displacements or forces from which it is noted, if strains are smaller."""
MOVED = 0.05
"""Displacement over the thickness of the body there, below which stretching does not matter: a strip that is clamped
at both ends gets stiffer by 3/4 of its square."""
EULER = np.pi**2 / 48
"""Critical strain of a strut that is clamped at one end, over the square of thickness over length."""
SLENDER = 5.0
"""Size of the body over its thickness from which a part is slender, and beam theory holds."""
PROBE = 0.01
"""Displacement that probes for buckling, over the least thickness of the body."""
BESIDE_IT = 0.1
"""Gap over the thickness up to which a surface is so near to a part that it may hold it where it buckles."""
BESIDE = 2.0
"""Local coordinate up to which a place opposite may be in the next element."""
ROWS = 256
"""Elements whose distances from all others are computed at a time."""
SEVERAL = 3.0
"""Displacement over that of linear theory from which its estimate, a series, is not given as a number."""


def second_order(body: Body, boundary: BoundaryState, initial_gap: Array) -> Judgment:
    """Judge stretching and buckling of slender parts, if a first look at thickness and strain allows for either.

    `initial_gap` (n,) [L] is that of the contact points.
    """
    mesh, every = body.mesh, np.arange(len(body.mesh.elements))
    thickness, facing, local = across(body)
    size = _sizes_of_wholes(body)
    slender = thickness < size / SLENDER
    if not slender.any():
        return Judgment()
    moved = magnitudes(elastic_displacement(body, boundary)[mesh.elements[:, 1]]) / thickness * slender
    stressed = boundary.displacement - thermal_displacement(body)
    strain = axial_strain(mesh, stressed, every, np.zeros(len(every)))
    middle = (strain + axial_strain(mesh, stressed, facing, local)) / 2
    strut = np.where(slender, -middle / (EULER * (thickness / size) ** 2), 0.0)
    if moved.max() <= MOVED and strut.max() <= CHANGED:
        return Judgment()
    motion, compressed, strained = (_beyond_details(mesh, values) for values in (moved, strut, abs(strain)))
    if motion <= MOVED and compressed <= CHANGED:
        return Judgment()
    at, element = body.points.point, body.points.element
    guided = bool(np.any(slender[element] & (initial_gap[at] <= BESIDE_IT * thickness[element])))
    return _probed(body, boundary, motion > MOVED, compressed, strained, guided=guided)


def _probed(body: Body, boundary: BoundaryState, moves: bool, strut: float, strain: float, *, guided: bool) -> Judgment:
    """Displace the body if it `moves`, and look for buckling if it is compressed as a part of a strut that buckles."""
    stiffer, of_force, zone, part = 1.0, 0.0, "", 0.0
    try:
        probed = ProbedBody(body)
        if moves:
            displacements, forces, i = probed.change()
            given = probed.loads > 0 or not probed.forces.any()
            stiffer = 1 / displacements.displacement if given else forces.force
            of_force, zone = abs(forces.force - 1) if given else 0.0, [*body.problem.zones][i]
        if strut > NOTICED:
            part = min(strut, probed.critical(PROBE * float(across(body)[0].min())))
    except BemContactError:
        return Judgment()  # contact does not hold the displaced body, which `placement` finds
    found = SecondOrder(
        stiffer=stiffer if _off(stiffer) > strain else 1.0, of_force=of_force if of_force > strain else 0.0, zone=zone,
        part=part if part * EULER > strain else 0.0, guided=guided,
        pressed=any(condition.pressure is not None for condition in body.problem.edge_conditions.values()),
    )  # fmt: skip
    return _judged(boundary, found)


class SecondOrder(NamedTuple):
    """What the displaced body tells.

    Parameters
    ----------
    stiffer : stiffness over that of linear theory; where loads are given, from displacements alone
    of_force : change of the force of contact of a zone under given loads, over itself
    zone : its name
    part : loads over the critical ones
    guided : whether surfaces are beside a slender part, which may hold it where it buckles
    pressed : whether a pressure is given, which the probe does not turn with its face
    """

    stiffer: float
    of_force: float
    zone: str
    part: float
    guided: bool
    pressed: bool


def _off(stiffer: float) -> float:
    """Error of linear theory from the stiffness over that of linear theory."""
    return max(stiffer, 1 / stiffer) - 1 if stiffer else np.inf


def _judged(boundary: BoundaryState, found: SecondOrder) -> Judgment:
    """Judge a stiffness over that of linear theory, a force of contact, and the loads over the critical ones."""
    if (found.part >= 1 and not found.guided) or max(_off(found.stiffer), found.of_force) >= LARGE:
        return Judgment(_withheld(boundary, found))
    told = "; error bars do not include this"
    noticed = list[Noticed]()
    if found.part > NOTICED:
        noticed.append(Noticed("buckling", found.part, _buckles(found) + told))
    if _off(found.stiffer) > CHANGED:
        noticed.append(Noticed("stiffness", _off(found.stiffer), _wrong(found.stiffer) + told))
    if found.of_force > CHANGED:
        noticed.append(Noticed("force", found.of_force, _wrong_force(found) + told))
    return Judgment(noticed=tuple(noticed))


def _withheld(boundary: BoundaryState, found: SecondOrder) -> Penetration:
    """Describe a state that linear theory does not tell."""
    i = int(np.argmax(np.hypot(*boundary.displacement[:, 1].T)))
    x, y = boundary.points[i, 1].tolist()
    unstable, off = found.part >= 1 and not found.guided, _off(found.stiffer)
    size, words = max((off, _wrong(found.stiffer)), (found.of_force, _wrong_force(found)))
    size, allowed, words = (found.part, 1.0, _buckles(found)) if unstable else (size, LARGE, words)
    remedy = "hold it sideways, make it thicker or shorter" if unstable else "make the part thicker"
    return Penetration(
        kind=Misfit.NOT_SMALL, depth=size, allowed=allowed, at=(x, y), edge=boundary.edge_names[boundary.edge[i]],
        zone="", paired=False,
        words=(
            f"{words[0].upper()}{words[1:]}. Linear theory does not hold. Check loads, lengths and Young's modulus; if "
            f"they are right, {remedy}, or take a program for large displacements."
        ),
    )  # fmt: skip


def _wrong_force(found: SecondOrder) -> str:
    """Say how far a force of contact is off."""
    return (
        f"a slender part gets stiffer or softer as it bends: the force of contact in '{found.zone}' is off by about "
        f"{100 * found.of_force:.2g} %"
    )


def _buckles(found: SecondOrder) -> str:
    """Say how far the loads are from the critical ones."""
    less = "; a pressure that turns with its face, as that of a fluid, may buckle it at three quarters of this"
    part, less = found.part, less if found.pressed else ""
    if part >= 1:
        beside = "surfaces beside it may hold it" if found.guided else "this state is not stable"
        return (
            f"a slender part buckles: the critical loads are about {1 / part:.2g} times those of the problem, "
            f"prescribed displacements and heat included, and {beside}{less}"
        )
    return (
        f"a slender part is compressed, and buckles at about {1 / part:.2g} times the loads, prescribed displacements "
        f"and heat included: where it bends, it bends by up to {1 / (1 - part):.2g} times what linear theory says{less}"
    )


def _wrong(stiffer: float) -> str:
    """Say which way displacements are off."""
    how_far = "by several times" if _off(stiffer) > SEVERAL else f"by about {100 * _off(stiffer):.2g} %"
    if stiffer > 1:
        return (
            "a slender part is stretched as it bends, as one is that is held at both ends: linear theory takes "
            f"displacements too large {how_far}, or forces too small where displacements are prescribed"
        )
    return (
        "loads gain levers on a slender part as it bends: linear theory takes displacements too small "
        f"{how_far}, or forces too large where displacements are prescribed"
    )


def across(body: Body) -> tuple[Array, IntArray, Array]:
    """Thickness (m,) [L] at the middle of each element: the distance through the body to the boundary that faces it.

    It is infinite where none does. Each body is looked at by itself, and bonded ones as one, inside which bonded
    elements are. Then the element that faces it (m,), and the local coordinate (m,) of the place opposite, which may be
    in the next element.
    """
    mesh, outer, whole = body.mesh, np.ones(len(body.mesh.elements), bool), _wholes(body)
    outer[bonded_elements(body.problem, mesh)[0]] = False
    at, normals, tangents = mesh.nodes[mesh.elements[:, 1]], mesh.normals[:, 1], mesh.tangents[:, 1]
    thickness, facing, local = np.full(len(at), np.inf), np.arange(len(at)), np.zeros(len(at))
    every = np.flatnonzero(outer)
    for first in range(0, len(every), ROWS):
        own = every[first : first + ROWS]
        x, y = (place[own, None] - place[every] for place in at.T)
        inward, distance = x * normals[own, 0, None] + y * normals[own, 1, None], np.hypot(x, y)
        faces = (inward > 0) & (inward >= ACROSS * distance) & (normals[own] @ normals[every].T < OPPOSED)
        distance[~faces | (whole[own, None] != whole[every])] = np.inf
        nearest = distance.argmin(axis=1)
        thickness[own], facing[own] = distance[np.arange(len(own)), nearest], every[nearest]
    some = np.flatnonzero(np.isfinite(thickness))
    facing[~np.isfinite(thickness)] = np.flatnonzero(~np.isfinite(thickness))
    along = tangents[facing[some]]
    local[some] = np.clip(
        np.sum((at[some] - at[facing[some]]) * along, axis=1) / np.sum(along**2, axis=1), -BESIDE, BESIDE
    )
    return thickness, facing, local


def _wholes(body: Body) -> IntArray:
    """Number (m,) of the body of each element; bonded bodies have one."""
    names, groups = [part.name for part in body.problem.parts], body.problem.bonded_groups
    numbers = [names.index(groups.get(name, name)) for name in names]
    return np.repeat(numbers, [len(part.mesh.elements) for part in body.mesh.parts])


def _sizes_of_wholes(body: Body) -> Array:
    """Diameter (m,) [L] of the bounding box of the body of each element; bonded bodies are one."""
    whole, points = _wholes(body), body.mesh.nodes[body.mesh.elements]
    sizes = {number: np.hypot(*np.ptp(points[whole == number].reshape(-1, 2), axis=0)) for number in {*whole.tolist()}}
    return np.array([sizes[number] for number in whole.tolist()])


def thermal_displacement(body: Body) -> Array:
    """Displacement (m, 3, 2) [L] by which the heat that acts expands a free body."""
    if not any(item.temperature for loads in body.problem.volume_loads for item in loads):
        return np.zeros((*body.mesh.elements.shape, 2))
    parts = [
        factor
        * particular_solutions(
            body.problem, body.mesh, [Loads(temperature=item.temperature) for item in loads]
        ).displacement
        for factor, loads in zip(body.factors.tolist(), body.problem.volume_loads, strict=True)
    ]
    return np.sum(parts, axis=0)[body.mesh.elements]


def axial_strain(mesh: Mesh, displacement: Array, elements: IntArray, local: Array) -> Array:
    """Strain (q,) along the boundary at local coordinates (q,) of elements (q,), by displacements (m, 3, 2) [L]."""
    shapes = reference_element.derivatives(local)
    along, change = (
        np.einsum("qk,qkx->qx", shapes, values[elements]) for values in (mesh.nodes[mesh.elements], displacement)
    )
    return np.sum(along * change, axis=1) / np.sum(along**2, axis=1)


def _beyond_details(mesh: Mesh, values: Array) -> float:
    """Largest of values (m,) of elements, less those of a small part of the boundary."""
    order, length = np.argsort(-values), mesh.tributary.sum(axis=1)
    beyond = np.cumsum(length[order]) > LARGE_PART * length.sum()
    return float(values[order][beyond][0])
