"""The two bodies of `finite_elements_pressed`, stated for the package, on meshes that a user would state."""

import numpy as np
from finite_elements_pressed import FILLET, FLAT, HEIGHT, WIDTH
from pressure_error import Pressure, by_elements

import bemcontact

MATERIAL = {"young_modulus": 1000, "poisson_ratio": 0.3, "state": "plane_strain"}
CANDIDATE = {"cylinder": -90 + 28.4, "block": -90 + 40.0}
"""Angle on the arc up to which contact may be."""


def some(elements: int, share: float) -> int:
    """A share of a number of elements, at least one."""
    return max(1, round(share * elements))


def towards(end: str, elements: int) -> dict:
    """Elements that get smaller towards an end, the more the more of them there are."""
    return {"elements": elements, "grading": {"ratio": max(2.0, elements**2 / 4), "towards": end}}


def cylinder(elements: int, end: float | None = None) -> bemcontact.Problem:
    """The cylinder of [SS92] with so many elements in the zone, uniform, or up to the end of contact (x) and graded."""
    arc, last = {"kind": "arc", "center": [0, 8], "radius": 8}, CANDIDATE["cylinder"]
    if end is None:
        zone = [{**arc, "name": "zone", "angles": [-90, last], "elements": elements}]
    else:
        angle = float(np.degrees(np.arcsin(end / 8))) - 90
        zone = [
            {**arc, "name": "under", "angles": [-90, angle], **towards("end", elements)},
            {**arc, "name": "beyond", "angles": [angle, last], **towards("start", some(elements, 0.5))},
        ]
    rest = [
        {**arc, "name": "flank", "angles": [last, 0], "elements": 1 + some(elements, 0.4), "grading": growing("start")},
        {"name": "top", "elements": 1 + some(elements, 0.3)},
        {
            "name": "axis",
            "start": [0, 8],
            "end": [0, 0],
            "elements": 1 + some(elements, 0.4),
            "grading": growing("end"),
        },
    ]
    return pressed("cylinder", zone, rest, 50.625)


def block(elements: int, end: float | None = None) -> bemcontact.Problem:
    """The block with so many elements on its flat face and on its fillet, uniform, or graded as above."""
    arc, last, root = {"kind": "arc", "center": [FLAT, FILLET], "radius": FILLET}, CANDIDATE["block"], 0.5**0.5
    flat = {"name": "flat", "start": [0, 0]}
    if end is None:
        zone = [{**flat, "elements": elements}, {**arc, "name": "zone", "angles": [-90, last], "elements": elements}]
    else:
        angle = float(np.degrees(np.arcsin((end - FLAT) / FILLET))) - 90
        zone = [
            {**flat, **towards("end", elements)},
            {**arc, "name": "under", "angles": [-90, angle], **towards("both", elements)},
            {**arc, "name": "beyond", "angles": [angle, last], **towards("start", some(elements, 0.5))},
        ]
    x, y = FLAT + FILLET * root, FILLET * (1 - root)
    rest = [
        {**arc, "name": "fillet", "angles": [last, -45], "elements": 1},
        {"name": "chamfer", "start": [x, y], "elements": some(elements, 0.2)},
        {"name": "side", "start": [WIDTH, y + WIDTH - x], "elements": 1 + some(elements, 0.4)},
        {"name": "top", "start": [WIDTH, HEIGHT], "elements": 1 + some(elements, 0.3)},
        {
            "name": "axis",
            "start": [0, HEIGHT],
            "end": [0, 0],
            "elements": 1 + some(elements, 0.4),
            "grading": growing("end"),
        },
    ]
    return pressed("block", zone, rest, 60.0)


def growing(end: str) -> dict:
    """Elements that grow away from the zone, which is at an end of their edge."""
    return {"ratio": 5, "towards": end}


def pressed(name: str, zone: list[dict], rest: list[dict], load: float) -> bemcontact.Problem:
    """A half of a body on a plane, under a pressure on its top."""
    surface = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
    return bemcontact.Problem(
        name=name,
        material=MATERIAL,
        boundary={"outer": zone + rest},
        conditions={"top": {"pressure": load}, "axis": {"displacement": {"x": 0}}},
        contact_zones={"foot": {"edges": [edge["name"] for edge in zone], "surface": surface}},
        accuracy=None,
    )


def reported(result: bemcontact.Result) -> Pressure:
    """Pressure along x as the result has it: quadratic on each element, the traction along y."""
    assert result.boundary is not None
    assert result.problem is not None
    edges = result.problem.contact_zones["foot"].edges
    names = np.array(result.boundary.edge_names)[result.boundary.edge]
    inside = np.isin(names, edges)
    x, p = result.boundary.points[inside, :, 0], result.boundary.traction[inside, :, 1]
    order = np.argsort(x[:, 0])
    return by_elements(x[order], p[order])
