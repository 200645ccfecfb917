"""Specs of bodies whose contact is known in closed form; numbers may be given in any units."""

from math import asin, degrees, pi


def hertz(*, length: float = 1.0, stress: float = 1.0) -> str:
    """A quarter of the cylinder of [SS92] under a hundredth of its load, b/R = 0.034, with its mesh around b."""
    radius, load = 8 * length, 8.1 * length * stress
    angles = "[-90, -88.3322, -87.8412, -87.0545]"  # x = 0.85 b, 1.1 b, 1.5 b
    first, second, third, fourth = angles.strip("[]").split(", ")
    arc = f"kind: arc, center: [0, {radius!r}], radius: {radius!r}"
    return f"""
name: cylinder under a hundredth of the load
material: {{young_modulus: {1000 * stress!r}, poisson_ratio: 0.3}}
boundary:
  outer:
    - {{name: under, {arc}, angles: [{first}, {second}], elements: 6, grading: {{ratio: 2, towards: end}}}}
    - {{name: end of contact, {arc}, angles: [{second}, {third}], elements: 10}}
    - {{name: beyond, {arc}, angles: [{third}, {fourth}], elements: 4}}
    - {{name: flank, {arc}, angles: [{fourth}, 0], elements: 14, grading: {{ratio: 60, towards: start}}}}
    - {{name: top, elements: 4}}
    - {{name: axis, start: [0, {radius!r}], end: [0, 0], elements: 14, grading: {{ratio: 60, towards: end}}}}
conditions:
  top: {{pressure: {load / (2 * radius)!r}}}
  axis: {{displacement: {{x: 0}}}}
contact_zones:
  foot: {{edges: [under, end of contact, beyond], surface: {{kind: plane, point: [0, 0], normal: [0, 1]}}}}
reference:
  Hertz: {{kind: hertz, load: {load!r}, radius: {radius!r}, half: true}}
"""


def pillow(size: float) -> str:
    """Half of a block of 2 size by size, bulging by the radius 400 below, under the load for the half-width b = 1."""
    radius, load = 400.0, pi * 1000 / 0.91 / (4 * 400.0)
    first, second, third, last = (degrees(asin(x / radius)) - 90 for x in (0.85, 1.1, 1.6, size))
    arc = f"kind: arc, center: [0, {radius}], radius: {radius}"
    return f"""
name: pillow
material: {{young_modulus: 1000, poisson_ratio: 0.3}}
boundary:
  outer:
    - {{name: under, {arc}, angles: [-90, {first!r}], elements: 8, grading: {{ratio: 2, towards: end}}}}
    - {{name: end of contact, {arc}, angles: [{first!r}, {second!r}], elements: 16}}
    - {{name: beyond, {arc}, angles: [{second!r}, {third!r}], elements: 6}}
    - {{name: free, {arc}, angles: [{third!r}, {last!r}], elements: 12, grading: {{ratio: 10, towards: start}}}}
    - {{name: side, end: [{size}, {size}], elements: 8}}
    - {{name: top, elements: 8}}
    - {{name: axis, start: [0, {size}], end: [0, 0], elements: 14, grading: {{ratio: 30, towards: end}}}}
conditions:
  top: {{pressure: {load / (2 * size)!r}}}
  axis: {{displacement: {{x: 0}}}}
contact_zones:
  foot: {{edges: [under, end of contact, beyond], surface: {{kind: plane, point: [0, 0], normal: [0, 1]}}}}
reference:
  Hertz: {{kind: hertz, load: {load!r}, radius: {radius}, half: true}}
"""


def punch(size: float) -> str:
    """Half of a square block of 2 size by size, with a punch of half-width 1 on it and total load 2."""
    return f"""
name: flat punch
material: {{young_modulus: 1000, poisson_ratio: 0.3}}
boundary:
  outer:
    - {{name: base, start: [0, 0], end: [{size}, 0], elements: 8}}
    - {{name: side, end: [{size}, {size}], elements: 8}}
    - {{name: free, end: [1, {size}], elements: 14, grading: {{ratio: 200, towards: end}}}}
    - {{name: face, end: [0, {size}], elements: 14, grading: {{ratio: 40, towards: start}}}}
    - {{name: axis, elements: 12, grading: {{ratio: 20, towards: start}}}}
conditions: {{axis: {{displacement: {{x: 0}}}}, base: {{pressure: {1 / size!r}}}}}
contact_zones:
  punch: {{edges: face, surface: {{kind: plane, point: [0, {size}], normal: [0, -1]}}}}
reference:
  punch: {{kind: flat_punch, load: 2, half_width: 1, center: [0, {size}], half: true}}
"""


def crack(size: float) -> str:
    """A quarter of the panel with the opening of [SS92], but of any size; on fine meshes at the tip and the middle."""
    return f"""
name: closed crack
material: {{young_modulus: 1000, poisson_ratio: 0.3}}
boundary:
  outer:
    - {{name: line, start: [3, 0], end: [{size}, 0], elements: 20, grading: {{ratio: {100 * size}, towards: start}}}}
    - {{name: side, end: [{size}, {size}], elements: 6}}
    - {{name: top, end: [0, {size}], elements: 6}}
    - {{name: axis, end: [0, 0.3], elements: 20, grading: {{ratio: {5 * size}, towards: end}}}}
    - {{name: crack, kind: ellipse, center: [0, 0], semi_axes: [3, 0.3], angles: [90, 0], elements: 40,
       grading: {{ratio: 60, towards: end}}}}
conditions: {{axis: {{displacement: {{x: 0}}}}, line: {{displacement: {{y: 0}}}}, top: {{pressure: 75}}}}
contact_zones:
  faces: {{edges: crack, surface: {{kind: plane, point: [0, 0], normal: [0, 1]}}}}
reference:
  crack: {{kind: crack, half_length: 3, half_height: 0.3, compression: 75, center: [0, 0]}}
"""


def ring(state: str, rigid: str) -> str:
    """A quarter of a ring 1 <= r <= 2, forced with interference 0.001 on a pin or into a bore."""
    edge, radius, body = ("bore", 1.001, "outside") if rigid == "pin" else ("rim", 1.999, "inside")
    return f"""
name: shrink fit
material: {{young_modulus: 1000, poisson_ratio: 0.3, state: {state}}}
boundary:
  outer:
    - {{name: level, start: [1, 0], end: [2, 0], elements: 4}}
    - {{name: rim, kind: arc, center: [0, 0], radius: 2, angles: [0, 90], elements: 12}}
    - {{name: upright, start: [0, 2], end: [0, 1], elements: 4}}
    - {{name: bore, kind: arc, center: [0, 0], radius: 1, angles: [90, 0], elements: 12}}
conditions: {{level: {{displacement: {{y: 0}}}}, upright: {{displacement: {{x: 0}}}}}}
contact_zones:
  fit: {{edges: {edge}, surface: {{kind: circle, center: [0, 0], radius: {radius}, body: {body}}}}}
reference:
  fit: {{kind: shrink_fit, rigid: {rigid}, inner_radius: 1, outer_radius: 2, interference: 0.001}}
"""


def pin_in_hole(load: float, size: float = 20.0, plate: float = 1000.0, others: str = "") -> str:
    """Half of a heavy pin of radius 1 in a hole that is wider by 0.001, in half of a plate that is held on two sides.

    The pin has the modulus 1000. In a plate of the same modulus, the load 0.13834 on the whole pin has a half angle of
    30 degrees. The plate ends at x = size and y = ± size.
    """
    return f"""
name: pin in a hole
bodies:
  pin:
    material: {{young_modulus: 1000, poisson_ratio: 0.3}}
    boundary:
      outer:
        - {{name: rim, kind: arc, center: [0, -0.001], radius: 1, angles: [-90, 90]}}
        - {{name: axis}}
    conditions: {{axis: {{displacement: {{x: 0}}}}}}
    loads: {{gravity: {{density: {load / pi!r}, acceleration: [0, -1]}}}}
  plate:
    material: {{young_modulus: {plate}, poisson_ratio: 0.3}}
    boundary:
      outer:
        - {{name: bottom, start: [0, {-size}], end: [{size}, {-size}]}}
        - {{name: right, end: [{size}, {size}]}}
        - {{name: top, end: [0, {size}]}}
        - {{name: upper axis, end: [0, 1.001]}}
        - {{name: hole, kind: arc, center: [0, 0], end: [0, -1.001], clockwise: true}}
        - {{name: lower axis}}
    conditions:
      upper axis: {{displacement: {{x: 0}}}}
      lower axis: {{displacement: {{x: 0}}}}
      top: {{displacement: {{y: 0}}}}
      bottom: {{displacement: {{y: 0}}}}
contacts: {{bearing: {{between: [pin/rim, plate/hole]}}}}
accuracy: 3e-3
reference:
  pin: {{kind: pin_in_hole, load: {load!r}, radius: 1, clearance: 0.001, half: true{others}}}
"""


BLOCK = """
name: block between two walls and a plane
material: {young_modulus: 1000, poisson_ratio: 0.0}
boundary:
  outer:
    - {name: bottom, start: [0, 0], elements: 4}
    - {name: right, start: [2, 0], elements: 2}
    - {name: top, start: [2, 1], elements: 4}
    - {name: left, start: [0, 1], elements: 2}
conditions: {top: {pressure: 5}, right: {pressure: 3}}
contact_zones:
  foot: {edges: bottom, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
  wall: {edges: left, surface: {kind: plane, point: [0, 0], normal: [1, 0]}}
reference:
  foot: {kind: uniform, pressure: 5, zone: foot}
  wall: {kind: uniform, pressure: 4, zone: wall}
  values: {kind: values, source: statics, zone: foot, peak: 5, contact_length: 2, resultant: 10, start: 0, end: 2}
  both: {kind: values, source: statics, contact_length: 3}
  table: {kind: table, source: statics, zone: wall, against: y, pressure: [[0.6, 2], [0.2, 4]]}
"""
"""Uniform compression 5 on the plane and 3 on the wall; one reference is wrong on purpose."""


def propped_beam(span: float, gap: float) -> str:
    """Half of a lightly loaded beam of height 1 on small rollers, that sinks by a part of its sag onto a middle one."""
    middle, load = span / 2, 1e-4 * (20 / span) ** 4
    sag = load * span * (5 / 8 * span**3 / 4000 + span * 2.6 / (2 * 4 * 5 / 6 * 1000))
    beam = f"load: {load!r}, span: {span}, height: 1, gap: {gap * sag!r}, half: true"
    roller = "kind: circle, radius: 0.5, body: outside"
    return f"""
name: propped beam
material: {{young_modulus: 1000, poisson_ratio: 0.3, state: plane_stress}}
boundary:
  outer:
    - {{name: overhang, start: [-1, 0], elements: 6, grading: {{ratio: 20, towards: end}}}}
    - {{name: seat left, start: [-0.05, 0], elements: 4, grading: {{ratio: 10, towards: end}}}}
    - {{name: seat right, start: [0, 0], elements: 4, grading: {{ratio: 10, towards: start}}}}
    - {{name: under, start: [0.05, 0], elements: 24, grading: {{ratio: 30, towards: both}}}}
    - {{name: middle, start: [{middle - 0.05}, 0], elements: 4, grading: {{ratio: 10, towards: end}}}}
    - {{name: axis, start: [{middle}, 0], elements: 6, grading: {{ratio: 20, towards: start}}}}
    - {{name: loaded, start: [{middle}, 1], elements: 20}}
    - {{name: top end, start: [0, 1], elements: 2}}
    - {{name: left, start: [-1, 1], elements: 2}}
conditions: {{loaded: {{pressure: {load!r}}}, axis: {{displacement: {{x: 0}}}}}}
contact_zones:
  end: {{edges: [seat left, seat right], surface: {{center: [0, -0.5], {roller}}}}}
  prop: {{edges: middle, surface: {{center: [{middle}, {-0.5 - gap * sag!r}], {roller}}}}}
reference:
  end: {{kind: propped_beam, support: end, zone: end, {beam}}}
  prop: {{kind: propped_beam, support: prop, zone: prop, {beam}}}
"""
