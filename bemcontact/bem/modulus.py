"""Change of the gaps with Young's modulus of one or several of the bodies."""

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.bonds import eliminate
from bemcontact.bem.condense import Condensation, observed
from bemcontact.errors import ProblemError

SAME = 1e-10
"""Difference of two normals, and of two gaps over the size of the bodies, that is round-off."""


def modulus_rate(one: Condensation, doubled: Condensation, modulus: float, pressure: Array) -> Array:
    """Change (n,) [L] of the gaps at a pressure (n,) [p] in equilibrium, per unit of Young's modulus E [p].

    `doubled` is the problem with 2 E in place of E, on the same mesh and with the same pairs. Of the bodies whose
    modulus is E, the compliance C falls as 1/E, and so does the part of the free displacement D that loads bring about;
    that of other bodies, and the part of prescribed displacements and of temperature, stay. So

        d(D + C p)/dE = -2 (D(E) - D(2E) + (C(E) - C(2E)) p)/E.

    Bonds have tractions, which p contains then: this opens them, and their tractions change until they are closed.

    Raises
    ------
    ProblemError
        If the surface that a body touches depends on E, as a deflected contour may; or if a body of this modulus is on
        springs, with which its compliance does not fall as 1/E.
    """
    body, other = one.body, doubled.body
    for stated, part, changed in zip(body.problem.parts, one.parts, doubled.parts, strict=True):
        if part.system.material != changed.system.material and part.system.values.stiffness.any():
            who = f"the body '{stated.name}'" if body.problem.several else "the body"
            raise ProblemError(
                f"{who} is on springs, so that its compliance is no multiple of 1/E, and there is no derivative here; "
                "solve at two moduli and take the difference"
            )
    if _differ(body.points.normals, other.points.normals, 1.0) or _differ(
        body.points.gap, other.points.gap, body.mesh.size
    ):
        raise ProblemError("the surface that a body touches depends on this modulus, so that there is no derivative")
    compliance, displacement = observed(body, one.parts)
    softer, less = observed(other, doubled.parts)
    bond, n, acting = one.bond, len(body.points), pressure
    if bond is not None:
        acting = np.append(pressure, bond.traction[0] @ pressure + bond.traction[1] @ one.factors)
    rate = -2 / modulus * ((displacement - less) @ one.factors + (compliance - softer) @ acting)
    if bond is not None:
        changes, work = body.all_changes(body.apart), body.all_work(body.apart)
        balanced = np.zeros((changes.shape[1], 1))
        rate = eliminate(compliance, rate[:, None], changes, work, balanced, body.apart.of_bodies.T, n)[1][:, 0]
    motions = body.algebra
    return rate - motions.rigid_motions @ motions.amplitudes_of(rate)


def _differ(one: Array, other: Array, size: float) -> bool:
    """Whether two arrays differ by more than round-off of a size."""
    return one.shape != other.shape or bool(np.abs(one - other).max(initial=0.0) > SAME * size)
