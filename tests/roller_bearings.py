"""Slices of roller bearings, for tests and benchmarks, and the load shares that closed forms give them."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import root_scalar
from several_bodies import Spec, elastic, rigid, stated

from bemcontact import Problem

ROLLERS, RADIUS, INNER, OUTER = 9, 5.0, 15.0, 25.0
"""Number and radius of the rollers, and radii of the raceways [L]."""
ACROSS = 60.0
"""Angle of the arc of a roller that faces a raceway [degrees]."""
RATIO = 2000
"""Longest over shortest element of this arc: contact is a few thousandths of it."""


def roller(elements: int) -> Spec:
    """The lowest roller, with so many elements on each arc that faces a raceway."""
    arcs = {"out": (-ACROSS / 2, ACROSS / 2), "right": (ACROSS / 2, 180 - ACROSS / 2)}
    arcs |= {"in": (180 - ACROSS / 2, 180 + ACROSS / 2), "left": (180 + ACROSS / 2, 360 - ACROSS / 2)}
    edges = [
        {
            "name": name, "kind": "arc", "center": [0, -(INNER + OUTER) / 2], "radius": RADIUS,
            "angles": [low - 90, high - 90],
            **({"elements": elements, "grading": {"ratio": RATIO, "towards": "middle"}} if name in ("out", "in")
            else {"elements": elements // 2}),
        }
        for name, (low, high) in arcs.items()
    ]  # fmt: skip
    return {"outer": edges}


def ring(raceway: float, back: float) -> Spec:
    """A ring between two circles."""
    edges = [
        {"name": name, "kind": "arc", "center": [0, 0], "radius": radius, "angles": [-90, 270 if outside else -450]}
        for name, radius, outside in (("raceway", raceway, raceway > back), ("back", back, back > raceway))
    ]
    outer, hole = sorted(edges, key=lambda edge: -edge["radius"])
    return {"outer": [outer], "holes": [[hole]]}


def bearing(load: float, gap: float, elements: int = 32, **others: Any) -> Problem:
    """Equal rollers of modulus 1000 between rigid rings, of which the inner one is pressed down.

    Without a cage, loads must be low for a certified answer: no friction holds a roller that the motion of the ring
    presses along the raceways.
    """
    bodies: dict[str, Spec] = {
        "inner": rigid(ring(INNER, 10.0)),
        "outer": rigid(ring(OUTER, 31.0)),
        "roller 1": elastic(roller(elements)),
    }
    bodies |= {f"roller {i}": {"copy_of": "roller 1", "rotate": (i - 1) * 360 / ROLLERS} for i in range(2, ROLLERS + 1)}
    contacts = {}
    for i in range(1, ROLLERS + 1):
        contacts[f"inside {i}"] = {"between": [f"roller {i}/in", "inner/raceway"]}
        contacts[f"outside {i}"] = {"between": [f"roller {i}/out", "outer/raceway"], "gap": gap}
    inside = [f"inside {i}" for i in range(1, ROLLERS + 1)]
    return stated(
        name="roller bearing",
        bodies=bodies,
        contacts=contacts,
        tools={"ring": {"zones": inside, "force": {"y": -load}}},
        accuracy=None,
        **others,
    )


def compression(force: float, modulus: float) -> float:
    """Approach [L] of rigid rings that press on a roller of plane-strain modulus E / (1 - ν²), [Joh85] (5.57).

    It is force / (π E') (2 ln(4 R / a) - 1) for each half of the roller, with the half-width a of its own contact.
    """
    if force <= 0:
        return 0.0
    curvatures = (1 / RADIUS + 1 / INNER, 1 / RADIUS - 1 / OUTER)
    halves = [2 * math.sqrt(force / (math.pi * modulus * curvature)) for curvature in curvatures]
    return force / (math.pi * modulus) * sum(2 * math.log(4 * RADIUS / half) - 1 for half in halves)


def load_shares(load: float, gap: float, modulus: float) -> np.ndarray:
    """Force (9,) on each roller, from the lowest one counterclockwise, between rigid rings: Σ Q cos ψ = load.

    The inner ring moves down by u, which presses each roller by u cos ψ less the gap.
    """
    cosines = np.cos(2 * np.pi * np.arange(ROLLERS) / ROLLERS)

    def root(function: Callable[[float], float], most: float) -> float:
        return root_scalar(function, bracket=(0.0, most), xtol=1e-15).root

    def forces(down: float) -> np.ndarray:
        ways = np.maximum(down * cosines - gap, 0.0).tolist()
        return np.array([root(lambda q, way=way: compression(q, modulus) - way, modulus * RADIUS / 10) for way in ways])

    return forces(root(lambda down: float(forces(down) @ cosines) - load, RADIUS / 20))
