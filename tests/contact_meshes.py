"""Problems whose contact ends inside a zone, for the tests of notes and ends of contact."""

import bemcontact
from bemcontact.problems import Problem

CYLINDER = """
name: cylinder, a zone of equal elements
material: {{young_modulus: {E}, poisson_ratio: 0.3}}
boundary:
  outer:
    - {{name: foot, kind: arc, center: [0, {R}], radius: {R}, angles: [-90, -61.6], elements: {n}}}
    - {{name: flank, kind: arc, center: [0, {R}], radius: {R}, angles: [-61.6, 0], elements: 12,
       grading: {{ratio: 8, towards: start}}}}
    - {{name: top, elements: 6}}
    - {{name: axis, start: [0, {R}], end: [0, 0], elements: 12, grading: {{ratio: 8, towards: end}}}}
conditions:
  top: {{pressure: {p}}}
  axis: {{displacement: {{x: 0}}}}
contact_zones:
  foot: {{edges: foot, surface: {{kind: plane, point: [0, 0], normal: [0, 1]}}}}
"""
TABLE = """
name: table on two round feet, loaded on one side
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: left foot, kind: arc, center: [-2, 1.5], radius: 1.5, angles: [225, 315], elements: 10}
    - {name: bridge, elements: 4}
    - {name: right foot, kind: arc, center: [2, 1.5], radius: 1.5, angles: [225, 315], elements: 10}
    - {name: right, elements: 5}
    - {name: top, start: [3.0606601717798214, 3], end: [-3.0606601717798214, 3], elements: 8}
    - {name: left, elements: 5}
conditions:
  top: {pressure: {constant: 8, x: 1}}
contact_zones:
  feet: {edges: [left foot, bridge, right foot], surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
"""
RING = """
name: ring on a pin
material: {young_modulus: 210e3, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: rim, kind: arc, center: [0, 0], radius: 20, angles: [0, 180], elements: 12}
    - {name: under, kind: arc, center: [0, 0], radius: 20, angles: [180, 360], elements: 12}
  holes:
    - [{name: bore, kind: arc, center: [0, 0], radius: 10, angles: [SEAM], elements: 36}]
conditions:
  under: {traction: {y: -25}}
contact_zones:
  pin: {edges: bore, surface: {kind: circle, center: [0, 0], radius: 9.98, body: outside}}
"""


def cylinder(elements: int, *, length: float = 1.0, stress: float = 1.0, load: float = 1.0) -> Problem:
    """The paper's cylinder with equal elements in its zone, in any units, under a part of its load."""
    text = CYLINDER.format(E=1000 * stress, R=8 * length, n=elements, p=50.625 * load * stress)
    return bemcontact.loads(text)


def table() -> Problem:
    """Two contacts in one zone of three edges, more load on the right."""
    return bemcontact.loads(TABLE)


def ring(seam: float = 0.0) -> Problem:
    """Contact on part of a closed zone, which begins at an angle in degrees."""
    return bemcontact.loads(RING.replace("SEAM", f"{seam}, {seam - 360}"))
