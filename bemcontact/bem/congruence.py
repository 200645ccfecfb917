"""Congruent bodies: equal but for a rotation and a translation, with equal meshes, as equally loaded copies have.

The equations of such bodies have one matrix in a common frame, so they share its factors. Vectors are turned into the
frame of the first of them and back. The points of a translated body need not be moved: only differences of them count.
"""

from collections.abc import Sequence

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.system import System

ROUNDING = 64 * float(np.finfo(float).eps)
"""Difference of two nodes over the largest coordinate that is round-off of the coordinates themselves."""


def congruent(systems: Sequence[System]) -> dict[int, dict[int, Array]]:
    """Rotations as of `turn_onto` by number of the body, by number of the first one that each is congruent to."""
    turns: dict[int, dict[int, Array]] = {}
    for number, system in enumerate(systems):
        for first, its in turns.items():
            if (turn := turn_onto(system, systems[first])) is not None:
                its[number] = turn
                break
        else:
            turns[number] = {number: np.eye(2)}
    return turns


def turn_onto(own: System, other: System) -> Array | None:
    """Rotation (2, 2) that turns vectors x (…, 2) of a body into x @ rotation of a congruent one; None if it is none.

    Material, elements, prescribed axes and unit pressures are equal, up to the rounding of the coordinates of nodes.
    There are no springs.
    """
    one, two = own.mesh, other.mesh
    springs = any(system.values.stiffness.any() for system in (own, other))
    if own.material != other.material or springs or not _arranged_alike(own, other):
        return None
    from_middle = [mesh.nodes - mesh.nodes.mean(axis=0) for mesh in (one, two)]
    x, y = (nodes[:, 0] + 1j * nodes[:, 1] for nodes in from_middle)
    factor = np.vdot(x, y)
    cosine, sine = factor.real / abs(factor), factor.imag / abs(factor)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    rounding = ROUNDING * max(abs(one.nodes).max(), abs(two.nodes).max())
    forces = [_unit_forces(system) for system in (own, other)]
    for mine, its in (from_middle, forces):
        if abs(mine @ turn - its).max(initial=0.0) > rounding:
            return None
    if sine == 0 and cosine == 1:
        return np.eye(2)
    # Axes along which displacement is prescribed turn with the body unless both are.
    values = own.values
    both = values.displacement_given, values.traction_unknown
    return turn if all((given[:, 0] == given[:, 1]).all() for given in both) else None


def _arranged_alike(own: System, other: System) -> bool:
    """Whether elements, edges, prescribed axes and unit pressures of two bodies have the same numbers."""
    lists = [
        (
            system.mesh.elements, system.mesh.edge, system.values.displacement_given, system.values.traction_unknown,
            system.points.element, system.points.local, system.points.pressure, system.points.node,
        )
        for system in (own, other)
    ]  # fmt: skip
    return all(np.array_equal(one, two) for one, two in zip(*lists, strict=True))


def _unit_forces(system: System) -> Array:
    """Nodal forces (q, 2) [L] by unit pressures."""
    points = system.points
    return system.mesh.tributary[points.element, points.local, None] * points.traction
