"""What a person should know of a result that the certificate does not say: remarks on the mesh and on the load."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bemcontact.assessment.footprint import Footprint
from bemcontact.bem.condense import Body

FEW_POINTS = 5
"""Points under pressure below which a contact is not resolved: three make a parabola, two more its ends."""
SMOOTH = 0.2
"""Sine of the angle at the end of a zone below which the boundary goes on smoothly."""
LARGE_PRESSURE = 0.5
"""Peak pressure over Young's modulus beyond which nothing is left of small displacements."""


def of_few_points(touching: NDArray[np.bool_]) -> Iterator[str]:
    """Say if too few points carry pressure to show its course."""
    carrying = int(np.count_nonzero(touching))
    if 0 < carrying < FEW_POINTS:
        yield (
            f"pressure acts on {carrying} contact point{'s' if carrying > 1 else ''} only: the mesh is too coarse "
            "there to tell how it is distributed; shorten the elements"
        )


def of_zone_ends(body: Body, touching: NDArray[np.bool_]) -> Iterator[str]:
    """Say where contact reaches the end of a zone although the boundary goes on smoothly."""
    mesh, points = body.mesh, body.points
    in_zone = np.isin(np.arange(len(mesh.elements)), points.element)
    smooth_end = (in_zone != in_zone[mesh.before]) & (abs(mesh.turns) < SMOOTH)
    for i in np.flatnonzero(touching):
        if points.node[i] < len(mesh.elements) and smooth_end[points.node[i]]:
            x, y = mesh.nodes[points.node[i]]
            yield (
                f"contact reaches the end of the zone '{list(body.problem.contact_zones)[points.zone[i]]}' at "
                f"({x:.5g}, {y:.5g}), where the boundary goes on smoothly; make the zone longer"
            )


def of_size(body: Body, where: Footprint) -> Iterator[str]:
    """Say if the pressure is too large for small displacements."""
    modulus = body.problem.material.young_modulus
    if where.peak is not None and where.peak.pressure > LARGE_PRESSURE * modulus:
        yield (
            f"the peak pressure is {where.peak.pressure / modulus:.2g} times Young's modulus: displacements are not "
            "small, and the linear answer means little"
        )
