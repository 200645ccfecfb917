"""From a contact pressure back to displacement and traction on the whole boundary."""

import numpy as np
from numpy.typing import NDArray

from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.condense import Condensation
from bemcontact.bem.rigid_motions import all_rigid_motions

Array = NDArray[np.float64]


def boundary_state(condensation: Condensation, pressure: Array, rigid_amplitudes: Array) -> BoundaryState:
    """Recover the boundary from pressure and rigid amplitudes of a contact solution.

    Parameters
    ----------
    condensation : Condensation
    pressure : (n,) p [p]
    rigid_amplitudes : (k,) a [L], in the fixed gauge of the condensed problem

    Returns
    -------
    BoundaryState
    """
    body, system = condensation.body, condensation.system
    mesh, gauge = body.mesh, condensation.gauge
    scaled = np.append(condensation.factors, pressure / system.stress)
    z = condensation.response @ scaled
    amplitudes = rigid_amplitudes.copy()
    amplitudes[: len(gauge.shift_load)] -= gauge.shift_load @ condensation.factors + gauge.shift_pressure @ pressure

    displacement, traction = system.fields(z, body.acting)
    displacement += body.seen.body.displacement(mesh.nodes) @ amplitudes
    points = body.points
    traction[points.element, points.local] += pressure[points.point, None] * points.normals[points.point]
    return BoundaryState(
        points=mesh.nodes[mesh.elements],
        displacement=displacement[mesh.elements],
        traction=traction,
        edge=mesh.edge,
        edge_names=mesh.edge_names,
        force_balance=_force_balance(condensation, traction),
        equilibrium_slack=_slack(condensation, scaled),
    )


def _force_balance(condensation: Condensation, traction: Array) -> float:
    """Resultant force and moment of everything that acts on the body, over the sum of the magnitudes."""
    body = condensation.body
    mesh, every = body.mesh, all_rigid_motions(body.mesh)
    forces = mesh.tributary[..., None] * traction
    volume = body.acting.particular
    resultant = every.work(mesh.nodes[mesh.elements], forces) + every.work_of(volume.force, volume.moment)
    magnitude = np.hypot(forces[..., 0], forces[..., 1]).sum() + volume.magnitude
    return float(abs(resultant).max() / magnitude) if magnitude > 0 else 0.0


def _slack(condensation: Condensation, scaled: Array) -> float:
    """Border unknowns of the solution over the sum of what loads and pressures put there each by themselves."""
    slack = condensation.response[condensation.system.unknowns.size :]
    if len(slack) == 0:
        return 0.0
    total = abs(slack) @ abs(scaled)
    return float(abs(slack @ scaled).max() / total.max()) if total.max() > 0 else 0.0
