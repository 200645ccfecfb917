"""Change of the gaps with Young's modulus of one or several of the bodies."""

from dataclasses import replace

import numpy as np

from bemcontact.arrays import Array
from bemcontact.bem.body import Body
from bemcontact.bem.bonds import eliminate
from bemcontact.bem.condense import Condensation, CondensedPart, observed
from bemcontact.bem.loading import Loading, ParticularSolution, combined
from bemcontact.bem.solution import solve_system
from bemcontact.errors import ProblemError

SAME = 1e-10
"""Difference of two normals, and of two gaps over the size of the bodies, that is round-off."""


def modulus_rate(one: Condensation, doubled: Condensation, modulus: float, pressure: Array) -> Array:
    """Change (n,) [L] of the gaps at a pressure (n,) [p] in equilibrium, per unit of Young's modulus E [p].

    `doubled` is the problem with 2 E in place of E, on the same mesh and with the same pairs. Of the bodies whose
    modulus is E, the compliance C falls as 1/E, and so does the part of the free displacement D that loads bring about;
    that of other bodies, and the part of prescribed displacements and of temperature, stay. So

        d(D + C p)/dE = -2 (D(E) - D(2E) + (C(E) - C(2E)) p)/E.

    Of a body on springs it does not, and `_on_springs` has the change. Bonds have tractions, which p contains then:
    this opens them, and their tractions change until they are closed.

    Raises
    ------
    ProblemError
        If the surface that a body touches depends on E, as a deflected contour may.
    """
    body, other = one.body, doubled.body
    if _differ(body.points.normals, other.points.normals, 1.0) or _differ(
        body.points.gap, other.points.gap, body.mesh.size
    ):
        raise ProblemError("the surface that a body touches depends on this modulus, so that there is no derivative")
    bond, n, acting = one.bond, len(body.points), pressure
    if bond is not None:
        acting = np.append(pressure, bond.traction[0] @ pressure + bond.traction[1] @ one.factors)
    pairs = [*zip(one.parts, doubled.parts, strict=True)]
    sprung = [pair for pair in pairs if pair[0].system.values.stiffness.any()]
    others = [pair for pair in pairs if pair not in sprung]
    (stiff, much), (soft, less) = (observed(body, [pair[i] for pair in others]) for i in (0, 1))
    rate = -2 / modulus * ((much - less) @ one.factors + (stiff - soft) @ acting)
    for part, changed in sprung:
        if part.system.material != changed.system.material:
            rate += _on_springs(body, part, changed, modulus, acting, one.factors)
    if bond is not None:
        changes, work = body.all_changes(body.apart), body.all_work(body.apart)
        balanced = np.zeros((changes.shape[1], 1))
        compliance = observed(body, one.parts)[0]
        rate = eliminate(compliance, rate[:, None], changes, work, balanced, body.apart.of_bodies.T, n)[1][:, 0]
    motions = body.algebra
    return rate - motions.rigid_motions @ motions.amplitudes_of(rate)


def _on_springs(
    body: Body, part: CondensedPart, doubled: CondensedPart, modulus: float, acting: Array, factors: Array
) -> Array:
    """Change (n + b,) [L] of gaps and bonds by a body on springs K, per unit of its modulus E [p].

    Of F (u - u_p) = G (t - t_p)/μ, (7), with t = t_0 - K u, the derivative is the equation of a load -t/E, springs
    included, and of -1/E of the volume loads, with nothing prescribed. Temperature has u_p and t_p/E that stay.
    """
    system, softer = part.system, doubled.system
    points, loading, less = system.points, *(combined(item.loadings, factors.tolist()) for item in (system, softer))
    _, traction = part.fields(part.states(acting[None], factors)[:, 0], loading)
    np.add.at(traction, (points.element, points.local), acting[points.number][points.pressure, None] * points.traction)
    values, particular, others = loading.values, loading.particular, less.particular
    change = Loading(
        values=replace(values, displacement=0 * values.displacement, traction=-traction / modulus),
        particular=ParticularSolution(
            displacement=2 * (others.displacement - particular.displacement) / modulus,
            traction=(others.traction - 2 * particular.traction) / modulus,
        ),
    )
    system = replace(system, loadings=(change,))
    alone = replace(part, system=system, response=solve_system(system))
    return observed(body, [alone], loadings=1)[1][:, 0]


def _differ(one: Array, other: Array, size: float) -> bool:
    """Whether two arrays differ by more than round-off of a size."""
    return one.shape != other.shape or bool(np.abs(one - other).max(initial=0.0) > SAME * size)
