"""Whether slender parts carry loads otherwise once they are displaced: they stretch as they bend, or they buckle.

Linear theory writes equilibrium for the undeformed body. In bodies that are not slender this is off by the order of
strains and rotations, which `linear_theory` judges. In slender ones it may be off by far more.
"""

import numpy as np

from bemcontact.adaptivity.first_sizes import ACROSS, OPPOSED
from bemcontact.analysis.displaced_body import ProbedBody, acting_volume_loads, elastic_displacement
from bemcontact.analysis.linear_theory import LARGE, LARGE_PART, NOTICED, Judgment, Noticed
from bemcontact.arrays import Array, IntArray
from bemcontact.assessment.penetration import Misfit, Penetration
from bemcontact.bem import reference_element
from bemcontact.bem.body import Body
from bemcontact.bem.loading import particular_solution
from bemcontact.bem.mesh import BoundaryState, Mesh
from bemcontact.errors import BemContactError
from bemcontact.problem.conditions import Loads

CHANGED = 0.05
"""Error of displacements or forces from which it is noted, if strains are smaller."""
MOVED = 0.1
"""Displacement over the thickness of the body there, below which stretching does not matter: a strip that is clamped
at both ends gets stiffer by 3/4 of its square."""
EULER = np.pi**2 / 48
"""Critical strain of a strut that is clamped at one end, over the square of thickness over length."""
SLENDER = 5.0
"""Size of the body over its thickness from which a part is slender, and beam theory holds."""
PROBE = 0.01
"""Displacement that probes for buckling, over the least thickness of the body."""
BESIDE = 2.0
"""Local coordinate up to which a place opposite may be in the next element."""
SEVERAL = 3.0
"""Displacement over that of linear theory from which its estimate, a series, is not given as a number."""


def second_order(body: Body, boundary: BoundaryState) -> Judgment:
    """Judge stretching and buckling of slender parts, if a first look at thickness and strain allows for either."""
    mesh, every = body.mesh, np.arange(len(body.mesh.elements))
    thickness, facing, local = across(mesh)
    slender = thickness < mesh.size / SLENDER
    if not slender.any():
        return Judgment()
    moved = np.hypot(*elastic_displacement(body, boundary)[mesh.elements[:, 1]].T) / thickness * slender
    stressed = boundary.displacement - thermal_displacement(body)
    strain = axial_strain(mesh, stressed, every, np.zeros(len(every)))
    middle = (strain + axial_strain(mesh, stressed, facing, local)) / 2
    strut = np.where(slender, -middle / (EULER * (thickness / mesh.size) ** 2), 0.0)
    most = [_beyond_details(mesh, values) for values in (moved, strut, abs(strain))]
    if most[0] <= MOVED and most[1] <= CHANGED and _beyond_details(mesh, -strut) <= CHANGED:
        return Judgment()
    return _probed(body, boundary, *most[1:])


def _probed(body: Body, boundary: BoundaryState, strut: float, strain: float) -> Judgment:
    """Displace the body, and look for buckling if it is compressed as this part of a strut that buckles may be."""
    try:
        probed = ProbedBody(body)
        displacements, forces = probed.change()
        thickness = float(across(body.mesh)[0].min())
        part = min(strut, probed.critical(PROBE * thickness)) if strut > NOTICED else 0.0
    except BemContactError:
        return Judgment()  # contact does not hold the displaced body, which `placement` finds
    stiffer = max(1 / displacements.displacement, forces.force, key=_off)
    return _judged(boundary, stiffer if _off(stiffer) > strain else 1.0, part if part * EULER > strain else 0.0)


def _off(stiffer: float) -> float:
    """Error of linear theory from the stiffness over that of linear theory."""
    return max(stiffer, 1 / stiffer) - 1 if stiffer else np.inf


def _judged(boundary: BoundaryState, stiffer: float, part: float) -> Judgment:
    """Judge a stiffness over that of linear theory, and the loads over the critical ones."""
    if part >= 1 or _off(stiffer) >= LARGE:
        return Judgment(_withheld(boundary, stiffer, part))
    told = "; error bars do not include this"
    noticed = list[Noticed]()
    if part > NOTICED:
        noticed.append(Noticed("buckling", part, _buckles(part) + told))
    if _off(stiffer) > CHANGED:
        noticed.append(Noticed("stiffness", _off(stiffer), _wrong(stiffer) + told))
    return Judgment(noticed=tuple(noticed))


def _withheld(boundary: BoundaryState, stiffer: float, part: float) -> Penetration:
    """Describe a state that linear theory does not tell."""
    i = int(np.argmax(np.hypot(*boundary.displacement[:, 1].T)))
    x, y = boundary.points[i, 1].tolist()
    unstable = part >= 1
    size, allowed, words = (part, 1.0, _buckles(part)) if unstable else (_off(stiffer), LARGE, _wrong(stiffer))
    remedy = "hold it sideways, make it thicker or shorter" if unstable or stiffer < 1 else "make the part thicker"
    return Penetration(
        kind=Misfit.NOT_SMALL, depth=size, allowed=allowed, at=(x, y), edge=boundary.edge_names[boundary.edge[i]],
        zone="", paired=False,
        words=(
            f"{words[0].upper()}{words[1:]}. Linear theory does not hold. Check loads, lengths and Young's modulus; if "
            f"they are right, {remedy}, or take a program for large displacements."
        ),
    )  # fmt: skip


def _buckles(part: float) -> str:
    """Say how far the loads are from the critical ones."""
    if part >= 1:
        return (
            f"a slender part buckles: the critical loads are about {1 / part:.2g} times those of the problem, "
            "prescribed displacements and heat included, and this state is not stable"
        )
    return (
        f"a slender part is compressed, and buckles at about {1 / part:.2g} times the loads, prescribed displacements "
        f"and heat included: where it bends, it bends by up to {1 / (1 - part):.2g} times what linear theory says"
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


def across(mesh: Mesh) -> tuple[Array, IntArray, Array]:
    """Thickness (m,) [L] at the middle of each element: the distance through the body to the boundary that faces it.

    It is infinite where none does. Then the element that faces it (m,), and the local coordinate (m,) of the place
    opposite, which may be in the next element.
    """
    at, normals, tangents = mesh.nodes[mesh.elements[:, 1]], mesh.normals[:, 1], mesh.tangents[:, 1]
    thickness, facing, local = np.full(len(at), np.inf), np.arange(len(at)), np.zeros(len(at))
    for i, (place, normal) in enumerate(zip(at, normals, strict=True)):
        away = place - at
        inward, distance = away @ normal, np.hypot(*away.T)
        faces = (inward > 0) & (inward >= ACROSS * distance) & (normals @ normal < OPPOSED)
        if faces.any():
            j = facing[i] = np.argmin(np.where(faces, distance, np.inf))
            thickness[i] = distance[j]
            local[i] = np.clip(away[j] @ tangents[j] / (tangents[j] @ tangents[j]), -BESIDE, BESIDE)
    return thickness, facing, local


def thermal_displacement(body: Body) -> Array:
    """Displacement (m, 3, 2) [L] by which the heat that acts expands a free body."""
    parts = [
        factor
        * particular_solution(Loads(temperature=loads.temperature), body.problem.material, body.mesh).displacement
        for factor, loads in zip(body.factors.tolist(), acting_volume_loads(body), strict=True)
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
