"""Stress inside the link on three supports beside quadratic triangles, with weight and temperature.

    OPENBLAS_NUM_THREADS=1 python tests/benchmarks/finite_elements_stress.py [--sizes 0.3 0.15] [--accuracy 0.01 0.001]

The link of `models/gallery/three_zones.yaml` gets a weight and a temperature. Finite elements find all contacts
themselves, on a mesh and on one with sides of half the length. The table compares stress at 50 points.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from finite_elements_contact import Array, ElasticBody, Field, IntArray, contact_state, curved, local_axes
from rich.console import Console
from rich.table import Table
from scipy.spatial import Delaunay, KDTree
from skfem import Basis, ElementTriP2, LinearForm, MeshTri, MeshTri2, asm
from skfem.element import DiscreteField
from skfem.models.elasticity import lame_parameters

import bemcontact

MODEL = Path(__file__).parents[2] / "models" / "gallery" / "three_zones.yaml"
YOUNG, POISSON, EXPANSION = 210e3, 0.3, 1.2e-5
WEIGHT = np.array([0.01, -0.1])
"""Body force [N/mm³]: the link weighs 190 N/mm, about half of its load."""
HEAT = (40.0, 0.5, 2.0)
"""Change of temperature: constant, and its slopes along x and y."""
LOADS = {
    "gravity": {"density": 1.0, "acceleration": WEIGHT.tolist()},
    "temperature": {"expansion": EXPANSION, "change": dict(zip(("constant", "x", "y"), HEAT, strict=True))},
}
RADIUS, LENGTH, HALF_HEIGHT, CUT = 10.0, 100.0, 8.0, 6.0
"""Radius of the round ends and distance of their centers; straight sides, which begin at this distance from centers."""
CORNER = float(np.degrees(np.arctan2(HALF_HEIGHT, CUT)))
GROWTH, CORNER_SIZE = 2.0, 0.5
"""Length of sides over the distance from a contact, and from a corner, times the relative length; smallest there."""
LARGEST = 8.0
"""Largest length of sides, times the relative length [mm]."""
HALF_WIDTH, REACH = 0.1, 0.35
"""About half the width of each contact, and how far from its middle without weight and heat the body may touch [mm]."""
SEED = 17
NEAREST, OUTSIDE, STEPS = 16, 0.05, 5
"""Triangles in which a point is looked for, how far in local coordinates it may be beyond a straight one, and steps of
Newton's to its coordinates."""
GROUPS = ("below contacts", "near the boundary", "inside")


class Support(NamedTuple):
    """A rigid surface: center of the round end, angle [°] of the lowest point, gap and normal at points (x, y)."""

    center: float
    angle: float
    gap: Field
    normal: Callable[[Array, Array], tuple[Array, Array]]

    @property
    def middle(self) -> Array:
        """Where the body is nearest to the surface at first (2,)."""
        return on_end(self.center, np.array(self.angle))

    def inward(self) -> Array:
        """Unit vector (2,) into the body."""
        return (np.array([self.center, 0]) - self.middle) / RADIUS


def on_end(center: float, angle: Array) -> Array:
    """Points (…, 2) of a round end at angles [°]."""
    return np.stack([center + RADIUS * np.cos(np.radians(angle)), RADIUS * np.sin(np.radians(angle))], axis=-1)


def _drum_normal(x: Array, y: Array) -> tuple[Array, Array]:
    away = np.hypot(x + 60, y + 80)
    return (x + 60) / away, (y + 80) / away


SUPPORTS = {
    "drum": Support(0.0, 180 + CORNER, lambda x, y: np.hypot(x + 60, y + 80) - 90, _drum_normal),
    "table": Support(LENGTH, -90.0, lambda x, y: y + 10, lambda x, y: (np.zeros_like(x), np.ones_like(x))),
    "wall": Support(LENGTH, 0.0, lambda x, y: 110 - x, lambda x, y: (-np.ones_like(x), np.zeros_like(x))),
}
RAYS = {
    0.0: np.append(np.linspace(CORNER, CORNER + 175, 18), np.linspace(CORNER + 185, 360 - CORNER, 8)),
    LENGTH: np.concatenate(
        [np.linspace(CORNER - 180, -95, 4), np.linspace(-85, -5, 9), np.linspace(5, 180 - CORNER, 13)]
    ),
}
"""Angles [°] of the corners of straight pieces in place of each round end, by its center; contacts are between two."""
RINGS = ((0.8, 1), (0.55, 2), (0.25, 4))
"""Points of the first mesh in round ends: part of the radius, and at which of the rays."""
CORNERS = np.array([(x, y) for x in (CUT, LENGTH - CUT) for y in (-HALF_HEIGHT, HALF_HEIGHT)])


def coarse() -> MeshTri:
    """The link with straight pieces instead of arcs."""
    x = np.concatenate([np.linspace(CUT, 40, 10), np.linspace(40, 60, 6)[1:-1], np.linspace(60, LENGTH - CUT, 10)])
    parts = [np.stack(np.meshgrid(x, np.linspace(-HALF_HEIGHT, HALF_HEIGHT, 5)), axis=-1).reshape(-1, 2)]
    for center, rays in RAYS.items():
        parts.append(on_end(center, rays[1:-1]))
        for part, step in RINGS:
            parts.append([center, 0] + part * (on_end(center, rays[1:-1:step]) - [center, 0]))
        parts.append(np.array([[center, 0.0]]))
    points = np.vstack(parts)
    triangles = Delaunay(points).simplices
    x, y = points[triangles].mean(axis=1).T
    inside = abs(y) < HALF_HEIGHT * np.minimum(1, np.minimum(x, LENGTH - x) / CUT)
    for center in RAYS:
        _, part = in_end(center, x, y)
        inside = inside | (part < 1)
    return MeshTri(points.T.copy(), triangles[inside].T.copy())


def in_end(center: float, x: Array, y: Array) -> tuple[Array, Array]:
    """Reach of the straight pieces around a round end at points, and the points' distance over it; inf beside it."""
    rays = RAYS[center]
    angle = np.degrees(np.arctan2(y, x - center))
    angle = np.where(angle < rays[0] - 1e-9, angle + 360, angle)
    piece = np.clip(np.searchsorted(rays, angle) - 1, 0, len(rays) - 2)
    middle, half = (rays[piece] + rays[piece + 1]) / 2, (rays[piece + 1] - rays[piece]) / 2
    reach = RADIUS * np.cos(np.radians(half)) / np.cos(np.radians(angle - middle))
    return reach, np.where(angle <= rays[-1] + 1e-9, np.hypot(x - center, y) / reach, np.inf)


def place(x: Array, y: Array) -> tuple[Array, Array]:
    """Push points of the link with straight pieces outwards, those on pieces onto the arcs."""
    result = np.array([x, y], float)
    for center in RAYS:
        reach, part = in_end(center, x, y)
        push = np.where(np.isfinite(part), (RADIUS / reach - 1) * part**2, 0.0)
        result += push * np.array([x - center, y])
    return result[0], result[1]


def link(size: float) -> MeshTri2:
    """Triangles whose sides are `size` half-widths long at contacts and grow with the distance from them."""
    flat = coarse()

    def wanted(x: Array, y: Array) -> Array:
        result = np.full_like(x, LARGEST * size)
        for support in SUPPORTS.values():
            away = np.hypot(x - support.middle[0], y - support.middle[1])
            result = np.minimum(result, size * (HALF_WIDTH + GROWTH * np.maximum(away - REACH, 0)))
        for corner in CORNERS:
            away = np.hypot(x - corner[0], y - corner[1])
            result = np.minimum(result, size * np.maximum(CORNER_SIZE * HALF_WIDTH, GROWTH * away))
        return result

    marked = np.zeros(1)
    while len(marked):
        ends = np.array(place(*flat.p))[:, flat.facets]
        too_long = np.hypot(*(ends[:, 0] - ends[:, 1])) > wanted(*ends.mean(axis=1))
        marked = np.flatnonzero(too_long[flat.t2f].any(axis=0))
        flat = flat.refined(marked) if len(marked) else flat
    return curved(flat, place)


@dataclass(frozen=True, kw_only=True, eq=False)
class Pressed:
    """The link on its supports by finite elements.

    Parameters
    ----------
    body : ElasticBody
    displacement : of all unknowns [L]
    contacts : by support, the place of the middle of contact (2,) and its half-width [L]
    forces : by support [p L]
    """

    body: ElasticBody
    displacement: Array
    contacts: dict[str, tuple[Array, float]]
    forces: dict[str, float]

    @cached_property
    def _stress(self) -> tuple[Basis, list[Array]]:
        """σxx, σyy, σxy, projected on continuous quadratic functions: smoother than the gradient itself."""
        basis = self.body.basis
        lam, mu = lame_parameters(YOUNG, POISSON)
        field = basis.interpolate(self.displacement)
        assert isinstance(field, DiscreteField)
        du = np.asarray(field.grad)
        swelling = (3 * lam + 2 * mu) * EXPANSION * heat(*np.asarray(basis.global_coordinates()))
        mean = lam * (du[0, 0] + du[1, 1]) - swelling
        scalar = basis.with_element(ElementTriP2())
        parts = mean + 2 * mu * du[0, 0], mean + 2 * mu * du[1, 1], mu * (du[0, 1] + du[1, 0])
        return scalar, [np.asarray(scalar.project(part)) for part in parts]

    def stress(self, points: Array) -> Array:
        """σxx, σyy, σxy, σzz (k, 4) [p]."""
        scalar, parts = self._stress
        element, local = self._elements(points)
        shapes = [
            np.asarray(scalar.elem.gbasis(scalar.mapping, local[:, :, None], i, element)[0])[:, 0] for i in range(6)
        ]
        numbers = np.asarray(scalar.element_dofs)[:, element]
        xx, yy, xy = (np.sum(shapes * part[numbers], axis=0) for part in parts)
        return np.column_stack([xx, yy, xy, POISSON * (xx + yy) - YOUNG * EXPANSION * heat(*points.T)])

    def _elements(self, points: Array) -> tuple[IntArray, Array]:
        """The triangle (k,) in which each point is, and its local coordinates (2, k)."""
        corners = self.body.mesh.p[:, self.body.mesh.t]
        near = np.asarray(KDTree(corners.mean(axis=1).T).query(points, k=NEAREST)[1])
        origin, first, second = (corners[:, i, near] for i in range(3))
        sides = np.stack([first - origin, second - origin], axis=1).transpose(2, 3, 0, 1)
        x, y = np.linalg.solve(sides, (points.T[..., None] - origin).transpose(1, 2, 0)[..., None])[..., 0].T
        beyond = np.maximum(-np.minimum(x, y), x + y - 1).T
        element = near[np.arange(len(points)), beyond.argmin(axis=1)]
        if (beyond.min(axis=1) > OUTSIDE).any():
            raise ValueError("a point is in none of the triangles")
        mapping, local = self.body.basis.mapping, np.full((2, len(points), 1), 1 / 3)
        for _ in range(STEPS):
            away = points.T[..., None] - mapping.F(local, element)
            local = local + np.einsum("ijkl,jkl->ikl", mapping.invDF(local, element), away)
        return element, local[..., 0]


def heat(x: Array, y: Array) -> Array:
    """Change of temperature."""
    return HEAT[0] + HEAT[1] * x + HEAT[2] * y


def pressed(size: float) -> Pressed:
    """Solve the contact of the link on a mesh with sides of this length over the half-width of contact."""
    body = ElasticBody(mesh=link(size), young_modulus=YOUNG, poisson_ratio=POISSON)
    lam, mu = lame_parameters(YOUNG, POISSON)

    @LinearForm
    def volume(v, w):  # type: ignore[no-untyped-def]
        swelling = (3 * lam + 2 * mu) * EXPANSION * heat(*w.x)
        return WEIGHT[0] * v[0] + WEIGHT[1] * v[1] + swelling * (v.grad[0, 0] + v.grad[1, 1])

    def top(x: Array, y: Array) -> Array:
        return np.where((x > 40 - 1e-9) & (x < 60 + 1e-9), y - HALF_HEIGHT, 1.0)

    load = body.traction(top, (0, -20)) + asm(volume, body.basis)
    nodes, normals, gaps = [], [], []
    for support in SUPPORTS.values():

        def side(x: Array, y: Array, support: Support = support) -> Array:
            near = np.hypot(x - support.middle[0], y - support.middle[1]) < REACH
            return np.where(near, np.hypot(x - support.center, y) - RADIUS, 1.0)

        own: IntArray = np.unique(body.sides(side))
        x, y = body.nodes[own].T
        nodes.append(own)
        normals.append(np.column_stack(support.normal(x, y)))
        gaps.append(support.gap(x, y))
    turned, freedom = local_axes(body, np.concatenate(nodes), np.vstack(normals))
    u, force = contact_state(body.stiffness, body.held_freedoms, load, turned, freedom, np.concatenate(gaps))
    contacts, forces = {}, {}
    for (name, support), own, part in zip(
        SUPPORTS.items(), nodes, np.split(force, np.cumsum([len(own) for own in nodes])[:-1]), strict=True
    ):
        across = np.array([support.inward()[1], -support.inward()[0]])
        touching = (body.nodes[own[part > 0]] - support.middle) @ across
        forces[name] = float(part.sum())
        middle, half = float(touching.min() + touching.max()) / 2, float(np.ptp(touching)) / 2
        contacts[name] = support.middle + middle * across, half
    return Pressed(body=body, displacement=turned @ u, contacts=contacts, forces=forces)


def sample(contacts: dict[str, tuple[Array, float]]) -> dict[str, Array]:
    """The 50 points: 24 below contacts at depths of 0.3 to 1 half-width, 10 near the boundary, 16 inside."""
    random = np.random.default_rng(SEED)
    below = []
    for name, (middle, half) in contacts.items():
        inward = SUPPORTS[name].inward()
        depth, beside = random.uniform(0.3, 1, 8) * half, random.uniform(-1.2, 1.2, 8) * half
        center = np.array([SUPPORTS[name].center, 0])
        direction = middle + beside[:, None] * [inward[1], -inward[0]] - center
        below.append(center + direction * ((RADIUS - depth) / np.hypot(*direction.T))[:, None])
    depth = 10 ** random.uniform(-2, 0, 10)
    flat = np.column_stack([random.uniform(12, 88, 6), random.choice([-1, 1], 6) * (HALF_HEIGHT - depth[:6])])
    angles = random.uniform(95, 215, 2), random.uniform(15, 115, 2)
    ends = [
        [center, 0] + (on_end(center, angle) - [center, 0]) * (1 - part / RADIUS)[:, None]
        for center, angle, part in zip(RAYS, angles, (depth[6:8], depth[8:]), strict=True)
    ]
    inside = np.column_stack([random.uniform(-5, LENGTH + 5, 16), random.uniform(-6, 6, 16)])
    return dict(zip(GROUPS, (np.vstack(below), np.vstack([flat, *ends]), inside), strict=True))


def von_mises(stress: Array) -> Array:
    """Equivalent stress (k,) of σxx, σyy, σxy, σzz (k, 4)."""
    xx, yy, xy, zz = stress.T
    return np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)


def compared(sizes: tuple[float, float], accuracies: tuple[float, ...]) -> Table:
    """Solve by both methods."""
    begin = time.perf_counter()
    rough, fine = map(pressed, sizes)
    middle = time.perf_counter()
    model = bemcontact.load(MODEL, set={"loads": LOADS, "reference": {}})
    results = [bemcontact.solve(model, accuracy=accuracy) for accuracy in accuracies]
    unknowns = " and ".join(str(one.body.freedoms.size) for one in (rough, fine))
    table = Table(
        title=f"link on three supports: finite elements with {unknowns} unknowns",
        caption=f"{middle - begin:.0f} s and {time.perf_counter() - middle:.0f} s",
    )
    for column in ("", "finite elements", "±", *(f"accuracy {accuracy:g}" for accuracy in accuracies)):
        table.add_column(column)
    for name, force in fine.forces.items():
        off = [force_of(result, name) / force - 1 for result in results]
        table.add_row(
            f"force of the {name}", f"{force:.6g}", percent(rough.forces[name] / force - 1), *map(percent, off)
        )
    points = sample(fine.contacts)
    right = {group: fine.stress(at) for group, at in points.items()}
    scale = max(von_mises(stress).max() for stress in right.values())
    for group, at in points.items():
        own = von_mises(right[group]).max()
        found = [np.column_stack([part.components, part.zz]) for part in (result.stress(at) for result in results)]
        own_error = abs(rough.stress(at) - right[group]).max()
        errors = [abs(stress - right[group]).max() for stress in found]
        for words, unit in ((f"stress {group}, of {scale:.5g}", scale), (f"… of their own largest {own:.5g}", own)):
            table.add_row(words, f"{len(at)} points", percent(own_error / unit), *(percent(e / unit) for e in errors))
    return table


def force_of(result: bemcontact.Result, support: str) -> float:
    """Magnitude of the force of a support [p L]."""
    return float(np.hypot(*result.to_dict()["forces"][support]))


def percent(ratio: float) -> str:
    return f"{100 * ratio:.2g} %"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--sizes", nargs=2, type=float, default=[0.3, 0.15], help="sides at contacts, over half-width")
    parser.add_argument("--accuracy", nargs="+", type=float, default=[0.01, 0.001], help="of bemcontact")
    given = parser.parse_args()
    Console(width=150).print(compared(tuple(given.sizes), tuple(given.accuracy)))


if __name__ == "__main__":
    main()
