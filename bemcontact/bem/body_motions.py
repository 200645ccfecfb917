"""How far bodies move and turn. Contact of elastic bodies does not see it, but only how one moves beside the other."""

from collections.abc import Iterator

import numpy as np

from bemcontact.arrays import Array, indices
from bemcontact.bem.body import Body
from bemcontact.problems.body_surface import BodySurface
from bemcontact.problems.curves import cross

ALIKE = 1e-9
"""Relative difference of the motions of two bodies that is round-off."""


def known_arms(body: Body) -> Array | None:
    """Arms (k,) [L] of the free motions that contact sees; None if the amplitude of one is no angle of a body."""
    turning = np.isfinite(body.seen.arms)
    return None if any(turning[motion] for motion, _ in _of_elastic_contacts(body)) else body.seen.arms


def amounts(body: Body, amplitudes: Array, displacement: Array) -> Array:
    """Angle [rad] of each free rotation and length [L] of each translation (k,).

    From amplitudes (k,) and the displacement (m, 3, 2) of the boundary [L]. Those of a body that touches elastic ones
    are means over its boundary, Σ w r×u / Σ w r² about the centroid and Σ w u / Σ w, less what nothing determines:
    blocks that stay in contact everywhere move and turn together, and gaps do not change.
    """
    seen = body.seen
    turning = np.isfinite(seen.arms)
    found = amplitudes / np.where(turning, seen.arms, 1.0) + 0.0
    among_elastic = [*_of_elastic_contacts(body)]
    if among_elastic:
        displacement = body.without_motions(displacement, body.pinned_motions)
    for motion, part in among_elastic:
        mesh, elements, _ = body.mesh.parts[part]
        weights, moved = mesh.tributary.ravel(), displacement[elements].reshape(-1, 2)
        x, y, turn = seen.of_bodies[motion, 3 * part : 3 * part + 3].tolist()
        if turning[motion]:
            away = mesh.nodes[mesh.elements].reshape(-1, 2) - mesh.centroid
            turned = weights @ cross(away, moved) / (weights @ (away**2).sum(axis=1))
            found[motion] = np.copysign(1.0, turn) * turned
        else:
            found[motion] = weights @ moved @ (x, y) / (weights.sum() * (x * x + y * y))
    return found


def _of_elastic_contacts(body: Body) -> Iterator[tuple[int, int]]:
    """Free motions that contact sees, with the body that moves or turns most, if it touches elastic bodies.

    It is the first of those that move alike.
    """
    problem, seen, names = body.problem, body.seen, [part.name for part in body.problem.parts]
    surfaces = {name: zone.surface for name, zone in problem.zones.items()}
    pairs = [name for name, it in surfaces.items() if isinstance(it, BodySurface) and it.first]
    touching = {names.index(name) for pair in pairs for name in problem.touching_bodies(pair)}
    for motion, row in enumerate(seen.coefficients if touching else ()):
        coefficients = row.reshape(-1, 3)  # of each body, then of each tool
        moved = abs(coefficients[:, 2]) if np.isfinite(seen.arms[motion]) else np.hypot(*coefficients[:, :2].T)
        most = indices(moved >= (1 - ALIKE) * moved.max()).tolist()
        if parts := [part for part in most if part in touching]:
            yield motion, parts[0]
