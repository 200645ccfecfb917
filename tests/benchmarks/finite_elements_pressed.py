"""Two bodies pressed on a plane, by quadratic triangles on meshes that a user of scikit-fem would make.

Nothing of the package is used. Both bodies are symmetric to x = 0, and their right half is modelled. Their lowest point
is (0, 0), and a pressure acts on their top. Triangles are small where contact may be, or around its end.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from finite_elements_bodies import along_x, upwards
from finite_elements_contact import Array, ElasticBody, Touch, locally_refined, press
from pressure_error import Pressure, by_elements
from skfem import MeshTri2

ORDER = 4
"""Of the quadrature; 6 takes 15 % longer and changes no error."""
COARSE, LAYERS = 0.3, 2
"""Largest side of the triangles that are bisected, of the lower side, and layers of these. Theirs is the wanted length
times a power of two, so that any length can be had. They have corners at kinks and at the end of contact."""
GROWTH = 2.0
"""Length of sides over the distance from the zone, times the relative length in it."""
GRADING, SMALLEST = 0.7, 0.003
"""Lengths go with this power of the distance from the end of contact; least distance, over the length of contact."""


@dataclass(frozen=True, kw_only=True)
class Pressed:
    """A body, stated for finite elements.

    Parameters
    ----------
    place : point (x, y) of two parameters from 0 to 1: along the lower side, and from there upwards
    along : the first parameter at x on the lower side, as far as it may touch
    height : y of the lower side at x, as far as it may touch
    rate : ds/dx of the lower side
    candidate : x up to which it may touch
    top, load : y of the top, and the pressure on it
    young_modulus, poisson_ratio : of the material
    kinks : x where the curvature of the lower side jumps
    corners : first parameter of corners of the lower side
    """

    place: Callable[[Array, Array], tuple[Array, Array]]
    along: Callable[[Array], Array]
    height: Callable[[Array], Array]
    rate: Callable[[Array], Array]
    candidate: float
    top: float
    load: float
    young_modulus: float
    poisson_ratio: float
    kinks: tuple[float, ...] = ()
    corners: tuple[float, ...] = ()

    def uniform(self, size: float) -> MeshTri2:
        """Triangles of one size, relative to the length of the zone, wherever contact may be."""
        return self._mesh(self.candidate, lambda x, y: np.full_like(x, size * self.candidate), size)

    def graded(self, size: float, end: float) -> MeshTri2:
        """Triangles that get smaller towards the end of contact (and kinks); `size` is relative to the contact."""

        def length(x: Array, y: Array) -> Array:
            near = [np.hypot(x - at, y - self.height(np.array(at))) / end for at in (end, *self.kinks)]
            return size * end * np.clip(np.min(near, axis=0), SMALLEST, 1) ** GRADING

        return self._mesh(end, length, size)

    def _mesh(self, end: float, length: Callable[[Array, Array], Array], size: float) -> MeshTri2:
        """Triangles of a length around the zone from 0 to `end`; they grow with the distance from it."""
        zone = np.linspace(0, end, 65)
        lowest = self.height(zone)

        def wanted(x: Array, y: Array) -> Array:
            away = np.hypot(x[:, None] - zone, y[:, None] - lowest).min(axis=1)
            return length(x, y) + GROWTH * size * away

        fixed = np.unique([0, *self.along(np.array([*self.kinks, end])), *self.corners, 1])
        spacing = size * float(self.along(np.array(end)))
        spacing *= 2 ** np.floor(np.log2(COARSE / spacing))
        parts = np.ceil(np.diff(fixed) / spacing).astype(int)
        along = [np.linspace(*ends, n, endpoint=False) for *ends, n in zip(fixed, fixed[1:], parts, strict=False)]
        return locally_refined(
            np.append(np.concatenate(along), 1.0),
            np.linspace(0, 1, round(LAYERS * COARSE / spacing) + 1),
            self.place,
            wanted,
        )

    def solve(self, mesh: MeshTri2) -> Touch:
        """Set up the equations, factorize and condense them, and solve the contact."""
        body = ElasticBody(
            mesh=mesh, young_modulus=self.young_modulus, poisson_ratio=self.poisson_ratio, held=((along_x, 0),),
            order=ORDER,
        )  # fmt: skip
        load = body.traction(lambda x, y: y - self.top, (0, -self.load))
        return press(body, load, self._foot, along_x, upwards, lambda nodes: body.nodes[nodes, 1])

    def _foot(self, x: Array, y: Array) -> Array:
        """Zero on the side that may touch."""
        inside = x < self.candidate + 1e-9
        return np.where(inside, y - self.height(np.where(inside, x, 0.0)), 1.0)


def reported(touch: Touch) -> dict[str, Pressure]:
    """Pressure of finite elements, recovered in two ways; which one is closer depends on the mesh.

    `nodal`: quadratic on each side, in balance with the nodal forces. `smooth`: slope of a spline through the force up
    to each corner of a triangle, cut at the end of contact.
    """
    of_side = 2 * np.arange(len(touch.lengths))[:, None] + np.arange(3)
    nodal = by_elements(touch.coordinate[of_side], touch.pressure[of_side])
    smooth = Pressure(breaks=touch.coordinate[::2], value=touch.pressure_at).cut(touch.ends()[1])
    return {"nodal": nodal, "smooth": smooth}


def _cylinder() -> Pressed:
    """Fig. 3 of [SS92]: a quarter of a cylinder of radius 8; rays from the arc to the inner half of the diameter."""
    radius = 8.0

    def place(s: Array, t: Array) -> tuple[Array, Array]:
        x, y = radius * np.sin(s * np.pi / 2), radius - radius * np.cos(s * np.pi / 2)
        return x + t * (radius / 2 * s - x), y + t * (radius - y)

    return Pressed(
        place=place, along=lambda x: np.arcsin(x / radius) * 2 / np.pi,
        height=lambda x: x**2 / (radius + np.sqrt(radius**2 - x**2)),
        rate=lambda x: radius / np.sqrt(radius**2 - x**2), candidate=radius * float(np.sin(np.radians(28.4))),
        top=radius, load=50.625, young_modulus=1e3, poisson_ratio=0.3,
    )  # fmt: skip


FLAT, FILLET, WIDTH, HEIGHT = 4.0, 6.0, 10.0, 12.0
"""The block: flat half-width, radius of the fillet, half-width and height, in mm."""


def _block() -> Pressed:
    """A block with a flat face, a fillet up to 45°, and a straight chamfer from there to its side."""
    root = np.sqrt(0.5)
    arc, corner = FILLET * np.pi / 4, np.array([FLAT + FILLET * root, FILLET * (1 - root)])
    length = FLAT + arc + (WIDTH - corner[0]) / root

    def height(x: Array) -> Array:
        beyond = np.maximum(x - FLAT, 0)
        return beyond**2 / (FILLET + np.sqrt(np.maximum(FILLET**2 - beyond**2, 0)))

    def place(s: Array, t: Array) -> tuple[Array, Array]:
        along = s * length
        angle = np.clip((along - FLAT) / FILLET, 0, np.pi / 4)
        chamfer = np.maximum(along - FLAT - arc, 0) * root
        x = np.minimum(along, FLAT) + FILLET * np.sin(angle) + chamfer
        y = FILLET * (1 - np.cos(angle)) + chamfer
        return x + t * (WIDTH * s - x), y + t * (HEIGHT - y)

    def along(x: Array) -> Array:
        return (np.minimum(x, FLAT) + FILLET * np.arcsin(np.maximum(x - FLAT, 0) / FILLET)) / length

    return Pressed(
        place=place, along=along,
        height=height, rate=lambda x: FILLET / np.sqrt(FILLET**2 - np.maximum(x - FLAT, 0) ** 2),
        candidate=FLAT + FILLET * float(np.sin(np.radians(40))), top=HEIGHT, load=60.0, young_modulus=1e3,
        poisson_ratio=0.3, kinks=(FLAT,), corners=((FLAT + arc) / length,),
    )  # fmt: skip


CYLINDER, BLOCK = _cylinder(), _block()
