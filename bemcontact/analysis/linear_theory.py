"""Whether displacements are as small as linear theory supposes: strains under contact, and the whole boundary.

Error bars compare meshes, and the certificate is of the linear equations. Neither sees an error of the theory.
"""

from typing import NamedTuple, Self

import numpy as np

from bemcontact.analysis.diagnostics import points_in
from bemcontact.arrays import Array, IntArray, indices, magnitudes, scalar_products
from bemcontact.assessment.footprint import Footprint
from bemcontact.assessment.penetration import Misfit, Penetration
from bemcontact.bem.body import Body
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.mesh import CORNER
from bemcontact.bem.symmetry import symmetry_lines
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.problems.curves import cross
from bemcontact.problems.material import Material
from bemcontact.problems.problem import Problem

LARGE = 0.25
"""Change of the displacement over the length along which it changes, and pressure over Young's modulus, not small.

Linear theory leaves out half the square of this change, here 3 % of the length and an eighth of a strain; a cantilever
whose end has this slope deflects 3 % less than linear theory says (Bisshopp and Drucker 1945)."""
LARGE_ROTATION = 0.5
"""Rotation in radians from which linear theory means little: it leaves out an eighth of lengths, and the cantilever
deflects 10 % less. The surface beside a line contact turns by more than the strain in it, so that it needs more."""
LARGE_STRAIN = 1 / 3
"""Strain at the peak pressure that is not small: in a line contact, where the peak is a quarter of Young's modulus."""
NOTICED = 0.2
"""Part of these strains from which linear theory is noticeably off: by about as much as the strain."""
LARGE_TURN = 0.1
"""Rotation of the whole body in radians from which it is named as the cause."""
LARGE_PART = 0.05
"""Share of a contact, or of the boundary, on which strains may be large: singular corners and tips of slits."""
AT_CORNER = 1e-4
"""Distance from a corner over the size of the body up to which pressure is that of the corner."""


class Noticed(NamedTuple):
    """A note on displacements that are noticeable, with their size, a number, and what it is of."""

    of: str
    size: float
    words: str


class Judgment(NamedTuple):
    """Where linear theory does not hold, or notes on where it is noticeably off."""

    beyond: Penetration | None = None
    noticed: tuple[Noticed, ...] = ()


def linear_theory(
    body: Body, contact: CondensedContact, solution: ContactSolution, where: Footprint, boundary: BoundaryState
) -> Judgment:
    """Judge strains under contact, and displacements of the whole boundary."""
    turns, change = any("rotation" in name for name in contact.motion_names), RateOfChange.of(boundary)
    moved = large_displacements(boundary, change, turns, body.problem)
    if most_strained(body.problem, abs(solution.pressure).max(initial=0.0), change.gradient.max()) <= NOTICED:
        return moved
    strain, part = contact_strains(body, boundary, change, solution.pressure)
    beyond = _strained(body, contact, solution, where, strain, part) or moved.beyond
    if beyond is not None:
        return Judgment(beyond)
    i = int(np.argmax(solution.pressure))
    if where.peak is None or part[i] <= NOTICED:
        return moved
    times = where.peak.pressure / _softest(body, i)
    words = (
        f"the peak pressure is {times:.2g} times Young's modulus, and strains there are about {strain[i]:.2g}: linear "
        f"theory is off by about {100 * strain[i]:.2g} % there; error bars do not include this"
    )
    return Judgment(noticed=(Noticed("strain", float(strain[i]), words), *moved.noticed))


class RateOfChange(NamedTuple):
    """How displacements change along elements: their chords (m, 2) [L], what changes over these (m, 2), per length."""

    along: Array
    change: Array
    length: Array
    gradient: Array

    @classmethod
    def of(cls, boundary: BoundaryState) -> Self:
        """That of the state of a boundary."""
        along, change = (values[:, 2] - values[:, 0] for values in (boundary.points, boundary.displacement))
        length = magnitudes(along)
        return cls(along, change, length, magnitudes(change) / length)


def most_strained(problem: Problem, pressure: float, gradient: float) -> float:
    """Bound of what part contact strains are of large ones, from the largest pressure and change per length.

    As of `contact_strains`: shear is below p/E, strain along the boundary below the gradient, and (1 + ν)(1 - 2ν) is at
    most 9/8.
    """
    bounds = list[float]()
    for material in (part.material for part in problem.parts):
        sheared, nu = pressure / material.young_modulus, material.poisson_ratio
        normal = (9 / 8 * sheared + abs(nu) * gradient) / (1 - max(nu, 0.0))
        bounds += sheared / LARGE, normal / LARGE_STRAIN
    return max(bounds)


def contact_strains(body: Body, boundary: BoundaryState, rate: RateOfChange, pressure: Array) -> tuple[Array, Array]:
    """Strains (n,) at contact points, and what part (n,) they are of large ones; `rate` is that of the boundary.

    The strain along the normal follows from the pressure and from the strain along the boundary. Shear below the
    surface is measured by the difference of the pressure from the least on the boundary, if that is none of tension: a
    pressure that acts all round shears nothing, however large it is.
    """
    points, other = body.points, body.points.opposite.node
    strain, part = _strains_at(body, boundary, rate, pressure, points.node)
    facing = indices(other >= 0)
    if len(facing):
        both = zip((strain, part), _strains_at(body, boundary, rate, pressure[facing], other[facing]), strict=True)
        for own, its in both:
            own[facing] = np.maximum(own[facing], its)
    return strain, part


def _softest(body: Body, point: int) -> float:
    """The smaller Young's modulus of the bodies at a contact point."""
    nodes = [body.points.node[point], body.points.opposite.node[point]]
    return min(body.material_at(int(node)).young_modulus for node in nodes if node >= 0)


def _strains_at(
    body: Body, boundary: BoundaryState, rate: RateOfChange, pressure: Array, nodes: IntArray
) -> tuple[Array, Array]:
    """Strains (k,) at nodes (k,) under pressure (k,), and what part (k,) they are of large ones."""
    along, change, length, _ = rate
    ends, strain = body.mesh.elements.ravel(), (scalar_products(along, change) / length**2).repeat(3)
    tangential = (np.bincount(ends, strain) / np.bincount(ends))[nodes]
    pressing = -cross(boundary.traction.sum(axis=1), along) / (3 * length)
    strain, part = np.zeros(len(nodes)), np.zeros(len(nodes))
    for on_mesh, stated in zip(body.mesh.parts, body.problem.parts, strict=True):
        own = slice(None) if isinstance(on_mesh.nodes, slice) else np.isin(nodes, on_mesh.nodes)
        least = max(float(pressing[on_mesh.elements].min()), 0.0)
        strain[own], part[own] = _strains_of(stated.material, pressure[own], tangential[own], least)
    return strain, part


def _strains_of(material: Material, pressure: Array, tangential: Array, least: float) -> tuple[Array, Array]:
    """The same of one body, from strains (k,) along its boundary and the least pressure on it that is no tension."""
    E, nu = material.young_modulus, material.poisson_ratio
    if material.state == "plane_strain":
        normal = -(pressure * (1 + nu) * (1 - 2 * nu) / E + nu * tangential) / (1 - nu)
    else:
        normal = -(pressure * (1 - nu**2) / E + nu * tangential)
    normal, sheared = abs(normal), (pressure - least) / E
    return np.maximum(normal, sheared), np.maximum(sheared / LARGE, normal / LARGE_STRAIN)


def _strained(
    body: Body, contact: CondensedContact, solution: ContactSolution, where: Footprint, strain: Array, part: Array
) -> Penetration | None:
    """Find the contact with the largest strains of those that are large on more than a small part of it."""
    if part.max(initial=0.0) <= 1:
        return None
    pressed = contact.pressed(solution.pressure, solution.displacement)
    found = list[tuple[float, int, float]]()
    for interval in where.intervals:
        own = pressed & points_in(contact, interval)
        share = contact.weights[own & (part > 1)].sum() / max(contact.weights[own].sum(), np.finfo(float).tiny)
        if share > LARGE_PART:
            i = int(np.argmax(np.where(own, part, 0.0)))
            found.append((part[i], i, share))
    if not found:
        return None
    _, i, share = max(found)
    E = _softest(body, i)
    (x, y), zone = body.mesh.place(contact.points[i]), contact.zone_names[contact.zone[i]]
    element = body.points.element[indices(body.points.point == i)[0]]
    return Penetration(
        kind=Misfit.NOT_SMALL, depth=float(strain[i]), allowed=LARGE, at=(x, y),
        edge=body.mesh.edge_names[body.mesh.edge[element]], zone=zone, paired=True,
        words=(
            f"Strains are not small on {100 * share:.0f} % of contact in '{zone}', up to about {strain[i]:.2g} at "
            f"({x:.5g}, {y:.5g}), where the pressure is {solution.pressure[i] / E:.2g} times Young's modulus: linear "
            f"theory does not hold. {_sharp(body, contact.points[i])}{_numbers(_modulus(body.problem))}"
        ),
    )  # fmt: skip


def _sharp(body: Body, place: Array) -> str:
    """Ask for a corner of the body to be rounded if one is at a place (2,) [L]; empty if none is.

    Where a boundary meets a line of symmetry at a right angle, the whole body has no corner.
    """
    mesh = body.mesh
    sharp = abs(mesh.turns) > CORNER
    for part in mesh.parts:
        right = abs(part.mesh.turns) > np.cos(CORNER)
        for line in symmetry_lines(body.problem, part.mesh):
            sharp[part.elements] &= ~(right & (line.elements | line.elements[part.mesh.before]))
    corners = mesh.nodes[mesh.elements[sharp, 0]]
    if not len(corners) or np.hypot(*(corners - place).T).min() > AT_CORNER * mesh.size:
        return ""
    return (
        "A sharp corner of the body presses there, and a point carries no force: give the corner its real radius. Or: "
    )


def large_displacements(boundary: BoundaryState, rate: RateOfChange, turns: bool, problem: Problem) -> Judgment:
    """Find strains, slopes or rotations that are not small on a part of the boundary; translations do not count.

    `rate` is that of its displacements, and `turns` whether contact alone holds the body against rotation.
    """
    along, change, length, gradient = rate
    part = length[gradient > LARGE].sum() / length.sum()
    if part <= LARGE_PART:
        return Judgment()
    stretch = abs(np.sum(along * change, axis=1)) / length**2
    turn = abs(cross(along, change)) / length**2
    withheld = length[np.maximum(stretch / LARGE, turn / LARGE_ROTATION) > 1].sum() / length.sum()
    i, largest = int(np.argmax(gradient)), float(gradient.max())
    fact = (
        f"isplacements are not small: on {100 * part:.0f} % of the boundary they change by more than {LARGE:g} of the "
        f"length along it, by strain or rotation, and up to {largest:.2g}"
    )
    cause = _cause(boundary, turns, _modulus(problem))
    if withheld <= LARGE_PART:
        off = f"linear theory is off by half the square of this, up to {50 * largest**2:.2g} % of lengths there"
        return Judgment(noticed=(Noticed("displacement", largest, f"d{fact}: {off}. {cause.removesuffix('.')}"),))
    x, y = boundary.points[i, 1].tolist()
    return Judgment(
        Penetration(
            kind=Misfit.NOT_SMALL, depth=largest, allowed=LARGE, at=(x, y), zone="", paired=False,
            edge=boundary.edge_names[boundary.edge[i]], words=f"D{fact}. Linear theory does not hold. {cause}",
        )
    )  # fmt: skip


def _cause(boundary: BoundaryState, turns: bool, modulus: str) -> str:
    """What to do about large displacements: hold a body that turns as a whole, else check the numbers."""
    x, u = (
        values.reshape(-1, 2) - values.reshape(-1, 2).mean(axis=0)
        for values in (boundary.points, boundary.displacement)
    )
    turn = float(np.sum(x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0]) / np.sum(x**2))
    if not turns or abs(turn) <= LARGE_TURN:
        return _numbers(modulus)
    return (
        f"The body turns by {turn:.2g} rad ({np.degrees(turn):.0f} degrees): hold it against rotation by a condition "
        "or by another contact zone, or draw it as it is after most of this rotation."
    )


def _modulus(problem: Problem) -> str:
    """Young's modulus of each body with its unit."""
    moduli = dict.fromkeys(f"{part.material.young_modulus:.4g}" for part in problem.parts)
    return f"{' and '.join(moduli)} {problem.units.stress}".strip()


def _numbers(modulus: str) -> str:
    """Ask for a check of the numbers of the problem."""
    return (
        f"Units may be mixed: check loads, lengths and Young's modulus, which is {modulus}; in mm and N it is in "
        "N/mm², 210e3 for steel, and in m and N it is in N/m², 210e9. If all are right, such a body needs a program "
        "for large strains."
    )
