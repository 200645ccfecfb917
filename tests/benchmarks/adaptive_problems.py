"""Problems without meshes for the benchmark of error bars, with the values that statics and closed forms give.

No constant of the search for a mesh was chosen by them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import cos, pi, radians, sin, sqrt, tan
from typing import Any

from bemcontact import Problem

STEEL = {"young_modulus": 210e3, "poisson_ratio": 0.3}
Known = Mapping[tuple[str, str | None], float]
"""Values by quantity and zone, and their relative error where it is not zero."""
Case = tuple[Problem, dict[tuple[str, str | None], tuple[float, float]]]
"""A problem, and (value, relative error of the value) by quantity and zone."""
CASES: dict[str, Callable[[], Case]] = {}


def case(build: Callable[[], Case]) -> Callable[[], Case]:
    """Register a problem under the name of its function."""
    CASES[build.__name__] = build
    return build


def polygon(points: Sequence[tuple[float, float]], names: Sequence[str]) -> list[dict[str, Any]]:
    """Straight edges from each point to the next."""
    return [{"name": name, "start": list(point)} for name, point in zip(names, points, strict=True)]


def rectangle(width: float, height: float, x: float = 0.0, y: float = 0.0) -> list[dict[str, Any]]:
    """Bottom, right, top, left."""
    corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
    return polygon(corners, ["bottom", "right", "top", "left"])


def problem(name: str, outer: list[dict[str, Any]], zones: dict[str, Any], **more: Any) -> Problem:
    """A steel problem."""
    return Problem(**{"name": name, "material": STEEL, "boundary": {"outer": outer}, "contact_zones": zones, **more})


def floor(y: float = 0.0) -> dict[str, Any]:
    return {"kind": "plane", "point": [0, y], "normal": [0, 1]}


def rod(x: float, y: float, radius: float) -> dict[str, Any]:
    """A rigid circle."""
    return {"kind": "circle", "center": [x, y], "radius": radius, "body": "outside"}


def hertz(force: float, radius: float, modulus: float = 210e3 / (1 - 0.09)) -> tuple[float, float]:
    """Peak and half-width of a cylinder on a rigid plane."""
    a = sqrt(4 * force * radius / (pi * modulus))
    return 2 * force / (pi * a), a


def half_disk(load: float, radius: float = 50.0) -> Problem:
    """Half of a disk on a floor: quarter arc below, pressed on its horizontal diameter's half by a pressure."""
    outer = [
        {"name": "rim", "kind": "arc", "center": [0, radius], "radius": radius, "angles": [-90, 0]},
        {"name": "cut", "start": [radius, radius], "end": [0, radius]},
        {"name": "axis", "start": [0, radius], "end": [0, 0]},
    ]
    return problem(
        "half disk", outer, {"foot": {"edges": "rim", "surface": floor()}},
        conditions={"cut": {"pressure": load / radius}, "axis": {"displacement": {"x": 0}}},
    )  # fmt: skip


def _hertz_case(load: float, radius: float) -> Case:
    peak, a = hertz(2 * load, radius)
    error = 2 * (a / radius) ** 2 + 1e-9
    return half_disk(load, radius), {("peak", "foot"): (peak, error), ("force", "foot"): (load, 0.0)}


@case
def hertz_full() -> Case:
    return _hertz_case(2000.0, 50.0)


@case
def hertz_hundredth() -> Case:
    return _hertz_case(20.0, 50.0)


@case
def hertz_ten_thousandth() -> Case:
    return _hertz_case(0.2, 50.0)


@case
def cam_nose() -> Case:
    """A wedge of 60 degrees with a nose of radius 1, 20 high, on a floor."""
    r, half = 1.0, radians(30)
    x, y = r * cos(half), r - r * sin(half)
    height = 20.0
    width = x + (height - y) * tan(half)
    outer = [
        {"name": "nose", "kind": "arc", "center": [0, r], "start": [0, 0], "end": [x, y]},
        {"name": "flank", "start": [x, y], "end": [width, height]},
        {"name": "top", "start": [width, height], "end": [0, height]},
        {"name": "axis", "start": [0, height], "end": [0, 0]},
    ]
    peak, a = hertz(400.0, r)
    return (
        problem("cam nose", outer, {"tip": {"edges": ["nose", "flank"], "surface": floor()}},
                conditions={"top": {"pressure": 200.0 / width}, "axis": {"displacement": {"x": 0}}}),
        {("force", "tip"): (200.0, 0.0), ("peak", "tip"): (peak, 3 * (a / r) ** 2)},
    )  # fmt: skip


@case
def cam_nose_heavy() -> Case:
    base, _ = cam_nose()
    return base.with_value("conditions.top.pressure", base.conditions["top"].pressure.constant * 40), {
        ("force", "tip"): (8000.0, 0.0)
    }


@case
def disk_between_plates() -> Case:
    """The whole rim of a quarter disk, pressed by a plate that moves down."""
    outer = [
        {"name": "rim", "kind": "arc", "center": [0, 0], "radius": 10, "angles": [0, 90]},
        {"name": "x axis", "start": [0, 0], "end": [10, 0]},
    ]
    outer = [{"name": "y axis", "start": [0, 10], "end": [0, 0]}, outer[1], outer[0]]
    surface = {"kind": "plane", "point": [0, 10], "normal": [0, -1]}
    return problem(
        "disk between plates", outer, {"plate": {"edges": "rim", "surface": surface}},
        conditions={"x axis": {"displacement": {"y": 0}}, "y axis": {"displacement": {"x": 0}}},
        tools={"plate": {"zones": "plate", "displacement": {"y": -0.02}}},
    ), {}  # fmt: skip


@case
def block_on_two_rods() -> Case:
    """Rods of radius 0.5 under a block, which no coarse node is near."""
    zones = {
        "left rod": {"edges": "bottom", "surface": rod(-18.3, -0.5, 0.5)},
        "right rod": {"edges": "lower", "surface": rod(11.7, -0.5, 0.5)},
    }  # fmt: skip
    outer = polygon([(-30, 0), (-3, 0), (30, 0), (30, 20), (-30, 20)], ["bottom", "lower", "right", "top", "left"])
    conditions = {"top": {"pressure": 10.0}, "left": {}}
    conditions.pop("left")
    # moments about the left rod: 600 * 18.3 = F * 30
    right = 600 * 18.3 / 30
    # the face leans where it touches, so that both forces lean a little
    loose = {("force", "left rod"): (600 - right, 1e-3), ("force", "right rod"): (right, 1e-3)}
    held = problem("block on two rods", outer, zones, conditions=conditions)
    return held, loose


@case
def block_on_flat_floor() -> Case:
    """Uniform pressure, exactly."""
    made = problem("block", rectangle(40, 20), {"floor": {"edges": "bottom", "surface": floor()}},
                   conditions={"top": {"pressure": 7.0}, "left": {"displacement": {"x": 0}}})  # fmt: skip
    return made, {("peak", "floor"): (7.0, 0.0), ("force", "floor"): (280.0, 0.0)}


@case
def linear_pressure() -> Case:
    """A block under a linear pressure: the same pressure below, exactly, where it is confined."""
    field = {"constant": 4.0, "x": 0.1}
    made = problem("tilted load", rectangle(40, 20), {"floor": {"edges": "bottom", "surface": floor()}},
                   conditions={"top": {"pressure": field}, "left": {"displacement": {"x": 0}}})  # fmt: skip
    return made, {("force", "floor"): (4 * 40 + 0.1 * 800, 0.0)}


@case
def partial_load_lifts_off() -> Case:
    """A long block pressed in its middle lifts off at its ends: receding contact."""
    outer = polygon([(0, 0), (120, 0), (120, 10), (8, 10), (0, 10)], ["bottom", "right", "top", "loaded", "axis"])
    made = problem("receding", outer, {"floor": {"edges": "bottom", "surface": floor()}},
                   conditions={"loaded": {"pressure": 50.0}, "axis": {"displacement": {"x": 0}}})  # fmt: skip
    return made, {("force", "floor"): (400.0, 0.0)}


@case
def cantilever_20() -> Case:
    """A clamped strip 20:1 pressed down on a floor 0.05 below it."""
    made = problem("cantilever", rectangle(100, 5), {"floor": {"edges": "bottom", "surface": floor(-0.05)}},
                   conditions={"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 0.02}})  # fmt: skip
    return made, {}


@case
def beam_on_roller_20() -> Case:
    """A clamped beam 20:1 whose free end rests on a roller."""
    outer = polygon([(0, 0), (80, 0), (100, 0), (100, 5), (0, 5)], ["span", "seat", "tip", "top", "clamp"])
    roller = {"kind": "circle", "center": [90, -8], "radius": 8, "body": "outside"}
    made = problem("beam on a roller", outer, {"roller": {"edges": "seat", "surface": roller}},
                   conditions={"clamp": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 1.0}})  # fmt: skip
    return made, {}


@case
def beam_50() -> Case:
    """A clamped strip 50:1 pressed on a floor."""
    made = problem("strip 50:1", rectangle(100, 2), {"floor": {"edges": "bottom", "surface": floor(-0.05)}},
                   conditions={"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 0.004}})  # fmt: skip
    return made, {}


@case
def hole_beside_the_zone() -> Case:
    """A hole of radius 3 whose rim is 0.7 above the contact face of a block with a round foot."""
    low = 200 - sqrt(200**2 - 225)
    outer = [
        {"name": "foot", "kind": "arc", "center": [0, 200], "start": [-15, low], "end": [15, low]},
        {"name": "right", "end": [15, 25]},
        {"name": "top", "end": [-15, 25]},
        {"name": "left"},
    ]  # fmt: skip
    hole = [{"name": "hole", "kind": "arc", "center": [1, 3.7], "radius": 3, "angles": [360, 0]}]
    made = Problem(
        name="hole beside the zone", material=STEEL, boundary={"outer": outer, "holes": [hole]},
        conditions={"top": {"pressure": 20.0, }, "left": {"traction": {"x": 0}}},
        contact_zones={"floor": {"edges": "foot", "surface": floor()}},
    )  # fmt: skip
    return made, {("force", "floor"): (600.0, 0.0)}


@case
def pin_in_hole() -> Case:
    """Conforming: half of an eye on a rigid pin of nearly its radius, pulled upwards."""
    outer = [
        {"name": "eye", "kind": "arc", "center": [0, 0], "radius": 10, "angles": [90, -90]},
        {"name": "lower ligament", "start": [0, -10], "end": [0, -25]},
        {"name": "below", "end": [20, -25]},
        {"name": "side", "end": [20, 30]},
        {"name": "pulled", "end": [0, 30]},
        {"name": "upper ligament", "end": [0, 10]},
    ]
    pin = {"kind": "circle", "center": [0, 0.0], "radius": 9.98, "body": "outside"}
    made = problem("eye on a pin", outer, {"pin": {"edges": "eye", "surface": pin}},
                   conditions={"pulled": {"traction": {"y": 100.0}}, "lower ligament": {"displacement": {"x": 0}},
                               "upper ligament": {"displacement": {"x": 0}}})  # fmt: skip
    return made, {}


@case
def press_fit() -> Case:
    """A ring shrunk on a rigid shaft: the pressure of Lame."""
    a, b, d = 20.0, 35.0, 0.02
    outer = [{"name": "outside", "kind": "arc", "center": [0, 0], "radius": b, "angles": [0, 360]}]
    hole = [{"name": "bore", "kind": "arc", "center": [0, 0], "radius": a, "angles": [360, 0]}]
    shaft = {"kind": "circle", "center": [0, 0], "radius": a + d, "body": "outside"}
    made = Problem(
        name="press fit", material={**STEEL, "state": "plane_stress"}, boundary={"outer": outer, "holes": [hole]},
        contact_zones={"shaft": {"edges": "bore", "surface": shaft}},
    )  # fmt: skip
    pressure = 210e3 * d / a / ((b * b + a * a) / (b * b - a * a) + 0.3)
    # the gap is linearized about the undeformed bore
    return made, {("peak", "shaft"): (pressure, 1e-4), ("pressure", "shaft"): (pressure, 1e-4)}


@case
def ring_squeezed() -> Case:
    """A quarter ring between a plate and symmetry lines; bends and touches at its crown."""
    outer = [
        {"name": "outside", "kind": "arc", "center": [0, 0], "radius": 30, "angles": [0, 90]},
        {"name": "upper cut", "start": [0, 30], "end": [0, 26]},
        {"name": "inside", "kind": "arc", "center": [0, 0], "radius": 26, "angles": [90, 0]},
        {"name": "side cut", "start": [26, 0], "end": [30, 0]},
    ]
    plate = {"kind": "plane", "point": [0, 30], "normal": [0, -1]}
    made = problem("ring", outer, {"plate": {"edges": "outside", "surface": plate}},
                   conditions={"upper cut": {"displacement": {"x": 0}}, "side cut": {"displacement": {"y": 0}}},
                   tools={"plate": {"zones": "plate", "force": {"y": -60.0}}})  # fmt: skip
    return made, {("force", "plate"): (60.0, 0.0)}


def _punch(zone: tuple[float, float], height: float = 40.0, width: float = 40.0) -> list[dict[str, Any]]:
    left, right = zone
    return polygon(
        [(0, 0), (width, 0), (width, height), (right, height), (left, height), (0, height)],
        ["bottom", "right", "right of it", "face", "left of it", "left"],
    )


BASE = {"bottom": {"displacement": {"y": 0}}, "left": {"displacement": {"x": 0}}}


def _above(y: float) -> dict[str, Any]:
    return {"kind": "plane", "point": [0, y], "normal": [0, -1]}


@case
def flat_punch_pressed() -> Case:
    made = problem("flat punch", _punch((14, 26)), {"punch": {"edges": "face", "surface": _above(40)}},
                   conditions=BASE, tools={"punch": {"zones": "punch", "force": {"y": -500.0}}})  # fmt: skip
    return made, {("force", "punch"): (500.0, 0.0)}


@case
def flat_punch_at_corner() -> Case:
    """The punch covers the face up to a corner of the body."""
    outer = polygon([(0, 0), (30, 0), (30, 30), (12, 30), (0, 30)], ["bottom", "right", "free", "face", "left"])
    made = problem("punch at a corner", outer, {"punch": {"edges": "face", "surface": _above(30)}},
                   conditions={"bottom": {"displacement": {"y": 0}}, "right": {"displacement": {"x": 0}}},
                   tools={"punch": {"zones": "punch", "displacement": {"y": -0.01}}})  # fmt: skip
    return made, {}


@case
def wedge_indents() -> Case:
    """A blunt rigid wedge: the pressure is infinite like a logarithm at its apex."""
    wedge = {"kind": "polyline", "points": [[40, 41.0], [20, 40], [0, 41.0]]}
    made = problem("wedge", _punch((8, 32)), {"wedge": {"edges": "face", "surface": wedge}},
                   conditions=BASE, tools={"wedge": {"zones": "wedge", "displacement": {"y": -0.1}}})  # fmt: skip
    return made, {}


@case
def floor_with_a_kink() -> Case:
    """A block whose foot rests on a floor that bends down by one in a thousand."""
    kinked = {"kind": "polyline", "points": [[-10, 0], [12, 0], [60, -0.048]]}
    made = problem("kinked floor", rectangle(40, 15), {"floor": {"edges": "bottom", "surface": kinked}},
                   conditions={"top": {"pressure": 30.0}, "left": {"displacement": {"x": 0}}})  # fmt: skip
    return made, {("force", "floor"): (1200.0, 0.0)}


@case
def stepped_body() -> Case:
    """A re-entrant corner of the body above its foot."""
    outer = polygon(
        [(0, 0), (14, 0), (14, 12), (40, 12), (40, 26), (0, 26)], ["foot", "side", "ledge", "end", "top", "axis"]
    )
    made = problem("stepped", outer, {"floor": {"edges": "foot", "surface": floor()}},
                   conditions={"top": {"pressure": 5.0}, "axis": {"displacement": {"x": 0}}})  # fmt: skip
    return made, {("force", "floor"): (200.0, 0.0)}


@case
def just_to_the_end() -> Case:
    """A round foot whose contact just reaches the end of its zone."""
    base, _ = _hertz_case(2000.0, 50.0)
    _, a = hertz(4000.0, 50.0)
    edge = 0.98 * a / 50.0
    outer = [
        {"name": "foot", "kind": "arc", "center": [0, 50], "radius": 50, "angles": [-90, -90 + edge * 180 / pi]},
        {"name": "rim", "kind": "arc", "center": [0, 50], "radius": 50, "angles": [-90 + edge * 180 / pi, 0]},
        {"name": "cut", "start": [50, 50], "end": [0, 50]},
        {"name": "axis", "start": [0, 50], "end": [0, 0]},
    ]
    zones = {"foot": {"edges": "foot", "surface": floor()}}
    return Problem(**{**base.model_dump(), "boundary": {"outer": outer}, "contact_zones": zones}), {
        ("force", "foot"): (2000.0, 0.0)
    }


@case
def no_contact() -> Case:
    made = problem("no contact", rectangle(40, 5), {"floor": {"edges": "bottom", "surface": floor(-1.0)}},
                   conditions={"left": {"displacement": {"x": 0, "y": 0}}, "top": {"pressure": 0.5}})  # fmt: skip
    return made, {}


@case
def cases_touch_elsewhere() -> Case:
    """Load cases that press different rods into the face of a block."""
    zones = {
        name: {"edges": "face" if x > 0 else "other", "surface": rod(x, 43, 3)}
        for name, x in (("left rod", -9.0), ("right rod", 8.0))
    }  # fmt: skip
    outer = polygon([(-20, 0), (20, 0), (20, 40), (0, 40), (-20, 40)], ["bottom", "right", "face", "other", "left"])
    made = problem("two rods, two cases", outer, zones, conditions={"bottom": {"displacement": {"x": 0, "y": 0}}},
                   tools={"left": {"zones": "left rod", "displacement": {"y": 0.5}},
                          "right": {"zones": "right rod", "displacement": {"y": 0.5}}},
                   load_cases={"left": {"tools": {"left": {"displacement": {"y": -0.52}}}},
                               "right": {"tools": {"right": {"displacement": {"y": -0.505}}}}},
                   combinations={"both": {"left": 1, "right": 1}})  # fmt: skip
    return made, {}


def _wavy(height: float, load: float, name: str) -> Case:
    """Westergaard: a block on a wave of length 10, three and a half waves long."""
    points = [[x / 4, height * (cos(2 * pi * x / 40) - 1)] for x in range(-20, 161)]
    surface = {"kind": "spline", "points": points}
    made = problem(name, rectangle(35, 30), {"wave": {"edges": "bottom", "surface": surface}},
                   conditions={"top": {"pressure": load}, "left": {"displacement": {"x": 0}},
                               "right": {"displacement": {"x": 0}}})  # fmt: skip
    return made, {("force", "wave"): (35 * load, 0.0)}


@case
def wave_light() -> Case:
    return _wavy(0.01, 2.0, "wave, light")


@case
def wave_half() -> Case:
    return _wavy(0.01, 250.0, "wave, half")


@case
def wave_full() -> Case:
    return _wavy(0.001, 150.0, "wave, full contact")


@case
def three_feet() -> Case:
    """A table of three round feet, one of which is shorter by 2 micrometers."""
    outer: list[dict[str, Any]] = []
    for i, x in enumerate((5.0, 25.0, 45.0)):
        lift = 0.002 if i == 1 else 0.0
        low = 20 + lift - sqrt(384)
        outer += [
            {"name": f"foot {i}", "kind": "arc", "center": [x, 20 + lift], "start": [x - 4, low], "end": [x + 4, low]},
            {"name": f"right of {i}", "end": [x + 4, 8]},
        ]
        if i < 2:
            outer += [{"name": f"gap {i}", "end": [x + 16, 8]}, {"name": f"left of {i + 1}"}]
    outer += [{"name": "right", "end": [49, 20]}, {"name": "top", "end": [1, 20]}, {"name": "left"}]
    zones = {f"foot {i}": {"edges": f"foot {i}", "surface": floor(20 - 20.0)} for i in range(3)}
    return problem("three feet", outer, zones, conditions={"top": {"pressure": 12.0}}), {}


@case
def roller_in_corner() -> Case:
    """A roller pressed into a corner by its weight, with friction nowhere: statics gives the forces."""
    outer = [{"name": "rim", "kind": "arc", "center": [0, 0], "radius": 8, "angles": [-100, 260]}]
    s = sqrt(0.5)
    zones = {
        "left": {"edges": "west", "surface": {"kind": "plane", "point": [-8 * s, -8 * s], "normal": [1, 1]}},
        "right": {"edges": "east", "surface": {"kind": "plane", "point": [8 * s, -8 * s], "normal": [-1, 1]}},
    }
    outer = [
        {"name": "east", "kind": "arc", "center": [0, 0], "radius": 8, "angles": [-90, 0]},
        {"name": "over", "kind": "arc", "center": [0, 0], "radius": 8, "angles": [0, 180]},
        {"name": "west", "kind": "arc", "center": [0, 0], "radius": 8, "angles": [180, 270]},
    ]
    weight = 100.0
    made = problem("roller in a corner", outer, zones,
                   loads={"gravity": {"density": 1.0, "acceleration": [0, -weight / (pi * 64)]}})  # fmt: skip
    each = weight * s
    return made, {("force", "left"): (each, 2e-4), ("force", "right"): (each, 2e-4)}


@case
def spinning_ring() -> Case:
    """A ring that spins in a rigid housing and grows into it: Lame and the disk of constant thickness."""
    outer = [{"name": "rim", "kind": "arc", "center": [0, 0], "radius": 60, "angles": [0, 360]}]
    hole = [{"name": "bore", "kind": "arc", "center": [0, 0], "radius": 30, "angles": [360, 0]}]
    housing = {"kind": "circle", "center": [0, 0], "radius": 60.01, "body": "inside"}
    made = Problem(
        name="spinning ring", material=STEEL, boundary={"outer": outer, "holes": [hole]},
        conditions={"bore": {"pressure": 90.0}}, contact_zones={"housing": {"edges": "rim", "surface": housing}},
    )  # fmt: skip
    # plane strain, inner pressure q, outer p: growth of the rim
    e, v = 210e3 / 0.91, 0.3 / 0.7
    a2, b2 = 900.0, 3600.0
    growth = 90.0 * 60 * 2 * a2 / (b2 - a2) / e
    soften = 60 * ((b2 + a2) / (b2 - a2) - v) / e
    pressure = (growth - 0.01) / soften
    return made, {("peak", "housing"): (pressure, 3e-4)}


@case
def seal_in_groove() -> Case:
    """A soft square with round corners squeezed in a groove by a plate: bottom, side and top touch."""
    r, w = 1.0, 5.0
    outer = [
        {"name": "bottom", "start": [0, 0], "end": [w - r, 0]},
        {"name": "low corner", "kind": "arc", "center": [w - r, r], "start": [w - r, 0], "end": [w, r]},
        {"name": "side", "start": [w, r], "end": [w, 2 * w - r]},
        {"name": "high corner", "kind": "arc", "center": [w - r, 2 * w - r], "radius": r, "angles": [0, 90]},
        {"name": "top", "start": [w - r, 2 * w], "end": [0, 2 * w]},
        {"name": "axis", "start": [0, 2 * w], "end": [0, 0]},
    ]  # fmt: skip
    zones = {
        "floor": {"edges": ["bottom", "low corner"], "surface": floor()},
        "wall": {"edges": ["side"], "surface": {"kind": "plane", "point": [w + 0.05, 0], "normal": [-1, 0]}},
        "plate": {"edges": ["high corner", "top"], "surface": _above(2 * w)},
    }
    made = Problem(
        name="seal", material={"young_modulus": 8.0, "poisson_ratio": 0.45}, boundary={"outer": outer},
        conditions={"axis": {"displacement": {"x": 0}}}, contact_zones=zones,
        tools={"plate": {"zones": "plate", "displacement": {"y": -0.6}}},
    )  # fmt: skip
    return made, {}


@case
def plate_on_convex_rail() -> Case:
    """A plate on an elliptic rail, loaded beside it, held by a second one."""
    zones = {
        "rail": {"edges": "left half", "surface": rod(-30, -40, 40)},
        "pin": {"edges": "right half", "surface": rod(38, -2, 2)},
    }  # fmt: skip
    outer = polygon(
        [(-50, 0), (0, 0), (50, 0), (50, 12), (20, 12), (-10, 12), (-50, 12)],
        ["left half", "right half", "right", "top right", "loaded", "top left", "left"],
    )
    made = problem("plate on rails", outer, zones, conditions={"loaded": {"pressure": 15.0}})
    right = 450 * (5 + 30) / 68
    # the contact on the rail moves with the bending of the plate
    return made, {("force", "rail"): (450 - right, 5e-3), ("force", "pin"): (right, 5e-3)}


@case
def parabolic_punch_turned() -> Case:
    """A turned block under a parabolic surface: no direction is along an axis."""
    t = radians(27.0)

    def turned(x: float, y: float) -> list[float]:
        return [x * cos(t) - y * sin(t), x * sin(t) + y * cos(t)]

    corners = [(-40.0, 0.0), (40.0, 0.0), (40.0, 50.0), (-40.0, 50.0)]
    outer = [{"name": n, "start": turned(*c)} for n, c in zip(["bottom", "right", "top", "left"], corners, strict=True)]
    center = turned(3.0, 50 + 60.0 - 0.02)
    zones = {
        "ball": {"edges": "top", "surface": {"kind": "circle", "center": center, "radius": 60.0, "body": "outside"}}
    }
    made = problem("turned block", outer, zones, conditions={"bottom": {"displacement": {"x": 0, "y": 0}}})
    return made, {}


@case
def ellipse_on_plane() -> Case:
    """The end of an ellipse with radius of curvature 2, pressed on a plane."""
    outer = [
        {"name": "rim", "kind": "ellipse", "center": [0, 8], "semi_axes": [4, 8], "angles": [-90, 0]},
        {"name": "cut", "start": [4, 8], "end": [0, 8]},
        {"name": "axis", "start": [0, 8], "end": [0, 0]},
    ]
    made = problem("ellipse", outer, {"foot": {"edges": "rim", "surface": floor()}},
                   conditions={"cut": {"pressure": 50.0}, "axis": {"displacement": {"x": 0}}})  # fmt: skip
    peak, a = hertz(400.0, 2.0)
    return made, {("force", "foot"): (200.0, 0.0), ("peak", "foot"): (peak, 2 * (a / 2.0) ** 2 + 1e-5)}


@case
def gravity_on_pads() -> Case:
    """A beam 20:1 that rests by its weight on two short pads."""
    outer = polygon(
        [(0, 0), (4, 0), (96, 0), (100, 0), (100, 5), (0, 5)], ["left pad", "span", "right pad", "end", "top", "start"]
    )
    zones = {name: {"edges": name, "surface": floor()} for name in ("left pad", "right pad")}
    made = problem("beam on pads", outer, zones,
                   loads={"gravity": {"density": 8e-9, "acceleration": [0, -9810.0]}})  # fmt: skip
    weight = 8e-9 * 9810 * 500
    return made, {("force", "left pad"): (weight / 2, 1e-9), ("force", "right pad"): (weight / 2, 1e-9)}


@case
def incompressible_block() -> Case:
    """A rubber block with round lower corners under a plate that is pressed."""
    outer = [
        {"name": "bottom", "start": [0, 0], "end": [8, 0]},
        {"name": "corner", "kind": "arc", "center": [8, 2], "start": [8, 0], "end": [10, 2]},
        {"name": "side", "start": [10, 2], "end": [10, 10]},
        {"name": "top", "start": [10, 10], "end": [0, 10]},
        {"name": "axis", "start": [0, 10], "end": [0, 0]},
    ]
    made = Problem(
        name="rubber", material={"young_modulus": 3.0, "poisson_ratio": 0.49}, boundary={"outer": outer},
        conditions={"axis": {"displacement": {"x": 0}}, "top": {"displacement": {"x": 0, "y": -0.5}}},
        contact_zones={"floor": {"edges": ["bottom", "corner"], "surface": floor()}},
    )  # fmt: skip
    return made, {}


@case
def slot_closes() -> Case:
    """A lens-shaped slot of 0.008 by 10 in a block closes from its tips.

    The slot is drawn, not the surface: a surface at an angle to the ligament, which slides along it, would be a wedge.
    """
    y, rise = 10.0, 0.004
    down = (25 - rise**2) / (2 * rise)
    slot = {"name": "slot", "kind": "arc", "center": [0, y - down], "start": [0, y + rise], "end": [5, y],
            "clockwise": True}  # fmt: skip
    rest = polygon([(5, y), (20, y), (20, 30), (0, 30)], ["ligament", "side", "top", "axis"])
    rest[-1]["end"] = [0, y + rise]
    made = problem("slot", [slot, *rest], {"slot": {"edges": "slot", "surface": floor(y)}},
                   conditions={"axis": {"displacement": {"x": 0}}, "ligament": {"displacement": {"y": 0}},
                               "top": {"pressure": 60.0}})  # fmt: skip
    return made, {}


@case
def shoe_on_drum() -> Case:
    """A brake shoe of nearly the radius of its drum, pressed by a short edge of its back."""
    outer = [
        {"name": "lining", "kind": "arc", "center": [0, 0], "radius": 100.2, "angles": [120, 60]},
        {"name": "right", "end": [60, 105]},
        {"name": "right back", "end": [10, 115]},
        {"name": "pressed", "end": [-10, 115]},
        {"name": "left back", "end": [-60, 105]},
        {"name": "left"},
    ]
    drum = {"kind": "circle", "center": [0, 0], "radius": 100.0, "body": "outside"}
    made = problem("brake shoe", outer, {"drum": {"edges": "lining", "surface": drum}},
                   conditions={"pressed": {"displacement": {"x": 0}, "traction": {"y": -40.0}}})  # fmt: skip
    return made, {}


@case
def plane_stress_hook() -> Case:
    """A hook-like bracket that leans on a wall by a round toe."""
    outer = [
        {"name": "clamp", "start": [0, 60], "end": [0, 40]},
        {"name": "inner", "end": [25, 40]},
        {"name": "inside", "end": [25, 10]},
        {"name": "toe", "kind": "arc", "center": [25, 5], "start": [25, 10], "end": [25, 0]},
        {"name": "under", "end": [45, 0]},
        {"name": "outside", "end": [45, 60]},
        {"name": "top", "end": [0, 60]},
    ]
    wall = {"kind": "plane", "point": [19.9, 0], "normal": [1, 0]}
    made = Problem(
        name="hook", material={**STEEL, "state": "plane_stress"}, boundary={"outer": outer},
        conditions={"clamp": {"displacement": {"x": 0, "y": 0}}, "outside": {"pressure": 6.0}},
        contact_zones={"wall": {"edges": "toe", "surface": wall}},
    )  # fmt: skip
    return made, {}


def problems() -> Iterator[tuple[str, Case]]:
    """All problems."""
    for name, build in CASES.items():
        yield name, build()
