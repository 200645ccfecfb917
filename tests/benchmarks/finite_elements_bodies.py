"""The five problems of [SS92] for quadratic triangles, stated anew from the text and not read from `models/`.

Lengths in cm, forces in kN. Each function takes the number of equal parts into which the elements of a graded grid are
cut, and gives the contact on that mesh. Elements are small where contact may end, and at corners: a triangle in a
corner, with two sides on the boundary, hardly deforms freely, and its displacement converges slowly.
"""

import numpy as np
from finite_elements_contact import Array, ElasticBody, IntArray, Touch, graded, mapped, press


def along_x(x: Array, y: Array) -> Array:
    return x


def upwards(x: Array, y: Array) -> tuple[Array, Array]:
    return np.zeros_like(x), np.ones_like(x)


def rectangle_ray(angle: Array, half_width: float, height: float) -> tuple[Array, Array]:
    """Where rays from the origin at these angles in radians leave |x| <= half_width, y <= height."""
    reach = np.minimum(
        half_width / np.maximum(abs(np.cos(angle)), 1e-12), height / np.maximum(abs(np.sin(angle)), 1e-12)
    )
    x, y = reach * np.cos(angle), reach * np.sin(angle)
    return np.where(abs(abs(x) - half_width) < 1e-9, np.copysign(half_width, x), x), y


def cantilever_curved_surface(parts: int) -> Touch:
    """Fig. 2: the gap of a material point is how far it sinks under 50 alone."""
    x = graded((0, 20, 40, 8), (20, 100, 40, 2), parts=parts)
    y = graded((0, 5, 6, 4), (5, 10, 6, 0.25), parts=parts)
    mesh = mapped(x, y, lambda s, t: (s, t))
    clamp = ((along_x, 0), (along_x, 1))
    body = ElasticBody(mesh=mesh, young_modulus=2e6, poisson_ratio=0.0, held=clamp)
    bending = body.deflection(body.traction(lambda x, y: y - 10, (0, -50)))
    load = body.traction(lambda x, y: y - 10, (0, -100))
    return press(body, load, lambda x, y: y, along_x, upwards, lambda nodes: -bending[nodes, 1])


def cylinder_on_plane(parts: int) -> Touch:
    """Fig. 3: rays from the arc, at angles from the lowest point, to the inner half of the horizontal radius."""
    angle = graded(
        (0, 18, 18, 0.5), (18, 22.4, 24, 1), (22.4, 28.4, 10, 4), (28.4, 60, 8, 5), (60, 90, 8, 0.1), parts=parts
    )
    depth = graded((0, 1, 24, 40), parts=parts)

    def place(s: Array, t: Array) -> tuple[Array, Array]:
        x, y = 8 * np.sin(np.radians(s)), 8 - 8 * np.cos(np.radians(s))
        return x + t * (4 * s / 90 - x), y + t * (8 - y)

    mesh = mapped(angle, depth, place)
    body = ElasticBody(mesh=mesh, young_modulus=1e3, poisson_ratio=0.3, held=((along_x, 0),))
    load = body.traction(lambda x, y: y - 8, (0, -50.625))

    def foot(x: Array, y: Array) -> Array:
        lowest = 8 - 8 * np.cos(np.radians(28.4))
        return np.where(y < lowest + 1e-6, np.hypot(x, y - 8) - 8, 1.0)

    return press(body, load, foot, along_x, upwards, lambda nodes: body.nodes[nodes, 1])


def elliptical_crack_closure(parts: int) -> Touch:
    """Fig. 4: rays from the eccentric angles of the ellipse, where the nodes crowd to the tip, to the panel's edges."""
    corner = np.degrees(np.arctan2(10, 8))
    angle = graded((0, 40, 40, 4), (40, corner, 8, 0.3), (corner, 90, 14, 2), parts=parts)
    depth = graded((0, 0.25, 20, 80), (0.25, 0.8, 5, 1), (0.8, 1, 4, 0.2), parts=parts)

    def place(s: Array, t: Array) -> tuple[Array, Array]:
        x, y = 3 * np.cos(np.radians(s)), 0.3 * np.sin(np.radians(s))
        x, y = np.where(s == 90, 0.0, x), np.where(s == 0, 0.0, y)
        out_x, out_y = rectangle_ray(np.radians(s), 8, 10)
        out_x = np.where(s == 90, 0.0, out_x)
        return x + t * (out_x - x), y + t * (out_y - y)

    mesh = mapped(angle, depth, place)
    held = ((along_x, 0), (lambda x, y: y, 1))
    body = ElasticBody(mesh=mesh, young_modulus=1e3, poisson_ratio=0.3, held=held)
    load = body.traction(lambda x, y: y - 10, (0, -75))

    def face(x: Array, y: Array) -> Array:
        return (x / 3) ** 2 + (y / 0.3) ** 2 - 1

    return press(body, load, face, along_x, upwards, lambda nodes: body.nodes[nodes, 1])


def from_top(x: Array, y: Array) -> Array:
    """Angle in degrees from the top of the hole to its left side."""
    return np.degrees(np.arctan2(-x, y))


def bolt_in_plate(parts: int) -> Touch:
    """Fig. 5: rays from the half hole to the edges of the upper half; the bolt's center is 0.1 left of the hole's."""
    corner = np.degrees(np.arctan2(3, 6))
    angle = graded(
        (0, corner, 8, 0.125), (corner, 90, 18, 3), (90, 98, 6, 0.5), (98, 103, 14, 1), (103, 180 - corner, 24, 0.3),
        (180 - corner, 180, 12, 3), parts=parts,
    )  # fmt: skip
    depth = graded((0, 0.4, 10, 5), (0.4, 1, 12, 0.1), parts=parts)

    def place(s: Array, t: Array) -> tuple[Array, Array]:
        sine = np.where(s == 180, 0.0, np.sin(np.radians(s)))
        x, y = 2 * np.cos(np.radians(s)), 2 * sine
        x = np.where(s == 90, 0.0, x)
        out_x, out_y = rectangle_ray(np.radians(s), 6, 3)
        out_y = np.where(s == 180, 0.0, out_y)
        return x + t * (out_x - x), y + t * (out_y - y)

    mesh = mapped(angle, depth, place)
    body = ElasticBody(mesh=mesh, young_modulus=1e3, poisson_ratio=0.3, held=((lambda x, y: y, 1),))
    load = body.traction(lambda x, y: x - 6, (25, 0))

    def bearing(x: Array, y: Array) -> Array:
        return np.where(x < 1e-6, np.hypot(x, y) - 2, 1.0)

    def normal(x: Array, y: Array) -> tuple[Array, Array]:
        distance = np.hypot(x + 0.1, y)
        return (x + 0.1) / distance, y / distance

    def gap(nodes: IntArray) -> Array:
        x, y = body.nodes[nodes].T
        return np.hypot(x + 0.1, y) - 1.9

    return press(body, load, bearing, from_top, normal, gap)


def cantilever_flat_surface(parts: int) -> Touch:
    """Fig. 6, with E = 2e4: rigid plane 1 below the lower face."""
    x = graded(
        (0, 25, 24, 12),
        (25, 40, 9, 0.4),
        (40, 41.5, 5, 0.3),
        (41.5, 43.5, 20, 1),
        (43.5, 47, 16, 3),
        (47, 50, 14, 0.15),
        parts=parts,
    )
    y = graded((0, 2.5, 8, 10), (2.5, 5, 8, 0.1), parts=parts)
    mesh = mapped(x, y, lambda s, t: (s, t))
    clamp = ((along_x, 0), (along_x, 1))
    body = ElasticBody(mesh=mesh, young_modulus=2e4, poisson_ratio=0.29, held=clamp)
    load = body.traction(lambda x, y: y - 5, (0, -3.6))
    return press(body, load, lambda x, y: y, along_x, upwards, lambda nodes: np.ones(len(nodes)))
