"""Large blocks in contact with small things, of which the half-plane is the closed form."""

from functools import cache

import numpy as np

import bemcontact
from bemcontact import Problem, Result

E, NU = 1000.0, 0.3
MODULUS = E / (1 - NU**2)


def block(
    size: float, top: list[dict], zones: dict, conditions: dict, accuracy: float | None = 1e-3,
    counts: dict | None = None, grading: dict | None = None,
) -> Problem:  # fmt: skip
    """The right half of a block under y = 0, of half this size; its edges from the lower left corner on."""
    edges = [{"name": "bottom", "start": [0, -size]}, {"name": "side", "start": [size, -size]}, *top]
    edges.append({"name": "axis", "start": [0, 0]})
    for key, values in (("elements", counts or {}), ("grading", grading or {})):
        for edge in edges:
            if edge["name"] in values:
                edge[key] = values[edge["name"]]
    return Problem(
        name="block", material={"young_modulus": E, "poisson_ratio": NU}, accuracy=accuracy,
        boundary={"outer": edges}, contact_zones=zones,
        conditions={"axis": {"displacement": {"x": 0}}, **conditions},
    )  # fmt: skip


@cache
def indented(width: float, accuracy: float = 1e-3) -> tuple[Result, float, float]:
    """A circle of radius 1 on a block 1000 times as large as the contact: the result, half-width and peak of Hertz."""
    load, size = np.pi * width**2 * MODULUS / 4, 1000 * width
    circle = {"kind": "circle", "center": [0, 1], "radius": 1, "body": "outside"}
    result = bemcontact.solve(
        block(
            size, [{"name": "top", "start": [size, 0]}], {"foot": {"edges": "top", "surface": circle}},
            {"bottom": {"pressure": load / 2 / size}}, accuracy,
        )
    )  # fmt: skip
    (x, _), *_ = [interval.start for interval in result.footprint.intervals]
    return result, x, 2 * load / np.pi / x
