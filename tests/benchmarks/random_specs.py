"""Random contact problems as specs, by kind, for the benchmark `random_problems`.

Numbers have three digits, so that a spec that fails is short. Rollers are at least as stiff as what they roll on.
"""

from collections.abc import Callable, Iterable
from math import cos, pi, radians, sin
from random import Random
from typing import Any

Spec = dict[str, Any]
KINDS: dict[str, Callable[["Draw"], Spec]] = {}
FLOOR = "floor"


class Draw(Random):
    """Random numbers of three digits."""

    def number(self, low: float, high: float) -> float:
        """Between two values; logarithmic if both are positive and far apart."""
        far = low > 0 and high > 10 * low
        return rounded(low * (high / low) ** self.random() if far else self.uniform(low, high))

    def chance(self, part: float) -> bool:
        """Whether something happens, that does so in this part of all cases."""
        return self.random() < part

    def material(self, low: float = 1e3, high: float = 300e3) -> Spec:
        """A material in N/mm²."""
        state = {"state": "plane_stress"} if self.chance(0.3) else {}
        return {"young_modulus": self.number(low, high), "poisson_ratio": self.number(0, 0.45), **state}


def rounded(value: float, digits: int = 3) -> float:
    """A number with few digits."""
    return float(f"{value:.{digits}g}") + 0.0


def kind(build: Callable[[Draw], Spec]) -> Callable[[Draw], Spec]:
    """Register a kind of problem under the name of its function."""
    KINDS[build.__name__] = build
    return build


def stated(name: str, **more: Any) -> Spec:
    """A spec; what is empty is left out."""
    head = {"name": name, "units": {"length": "mm", "force": "N"}}
    return {**head, **{key: value for key, value in more.items() if value or value == 0}}


def polygon(points: Iterable[Iterable[float]], names: str) -> list[Spec]:
    """Straight edges from each point to the next."""
    corners = [[rounded(x, 6) for x in point] for point in points]
    ends = [*corners[1:], corners[0]]
    return [{"name": n, "start": a, "end": b} for n, a, b in zip(names.split(), corners, ends, strict=True)]


def rectangle(width: float, height: float, x: float = 0.0, y: float = 0.0) -> list[Spec]:
    """Bottom, right, top, left; the middle of the bottom is at (x, y)."""
    left, right = x - width / 2, x + width / 2
    return polygon([(left, y), (right, y), (right, y + height), (left, y + height)], "bottom right top left")


def split(edge: Spec, at: float, name: str) -> list[Spec]:
    """Cut a straight edge at a fraction; the second part has the name."""
    (x, y), (u, v) = edge["start"], edge["end"]
    middle = [rounded(x + at * (u - x), 6), rounded(y + at * (v - y), 6)]
    return [{**edge, "end": middle}, {"name": name, "start": middle, "end": edge["end"]}]


def filleted(draw: Draw, edges: list[Spec], size: float) -> list[Spec]:
    """Round both ends of the first edge, or none."""
    if draw.chance(0.6):
        return edges
    first, last = ({"name": f"{side} fillet", "fillet": draw.number(size / 50, size / 5)} for side in ("right", "left"))
    return [edges[0], first, *edges[1:], last]


def disk(radius: float, x: float = 0.0, y: float = 0.0, name: str = "rim") -> list[Spec]:
    """A whole circle that begins below."""
    return [{"name": name, "kind": "arc", "center": [x, y], "radius": radius, "angles": [-90, 270]}]


def bore(radius: float, x: float = 0.0, y: float = 0.0, name: str = "bore") -> list[Spec]:
    """A whole circle around a hole."""
    return [{"name": name, "kind": "arc", "center": [x, y], "radius": radius, "angles": [270, -90]}]


def plane(x: float, y: float, angle: float = 90.0) -> Spec:
    """A plane with the normal in a direction [degrees]."""
    normal = [round(cos(radians(angle)), 12), round(sin(radians(angle)), 12)]
    return {"kind": "plane", "point": [x, y], "normal": normal}


def circle(x: float, y: float, radius: float, body: str = "outside") -> Spec:
    """A rigid circle."""
    return {"kind": "circle", "center": [x, y], "radius": radius, "body": body}


def weight(load: float, area: float, angle: float = -90.0) -> Spec:
    """A load on the volume with a resultant."""
    size = load / area
    return {"density": 1, "acceleration": [rounded(size * f(radians(angle)), 4) for f in (cos, sin)]}


def volume_loads(draw: Draw) -> Spec:
    """Heat, or nothing."""
    if draw.chance(0.75):
        return {}
    change = draw.choice([draw.number(-100, 200), {"constant": draw.number(-50, 50), "x": draw.number(-3, 3)}])
    return {"temperature": {"expansion": 1e-5, "change": change}}


@kind
def block(draw: Draw) -> Spec:
    """A block that is pressed on a plane, a line with corners, or rods."""
    w, h = draw.number(5, 100), draw.number(5, 60)
    E, p = draw.material(), draw.number(1e-4, 3e-3)
    pressure = rounded(p * E["young_modulus"])
    edges = filleted(draw, rectangle(w, h), min(w, h))
    bottom = {"edges": [edge["name"] for edge in edges if edge["name"] == "bottom" or "fillet" in edge]}
    top = next(i for i, edge in enumerate(edges) if edge["name"] == "top")
    conditions: Spec = {"top": {"pressure": pressure}}
    match draw.randrange(4):
        case 0:
            edges[top : top + 1] = split(edges[top], draw.number(0.2, 0.8), "top left")
        case 1:
            conditions["top"] = {"pressure": {"constant": pressure, "x": rounded(pressure / w)}}
        case 2:
            conditions["top"] = {"force": {"x": 0, "y": rounded(-pressure * w), "width": rounded(w / 3)}}
    match draw.randrange(4):
        case 0 if "fillet" not in edges[-1]:
            conditions["left"] = {"displacement": {"x": 0}}
        case 1 if "fillet" not in edges[-1]:
            conditions["left"] = conditions["right"] = {"pressure": rounded(pressure * draw.number(-1, 2))}
        case 2 if "fillet" not in edges[-1]:
            conditions["right"] = {"fixed": True}
    match draw.randrange(4):
        case 0:
            held = "fixed" in conditions.get("right", {}) or "displacement" in conditions.get("left", {})
            low = draw.choice([0, rounded(w * draw.number(1e-6, 1e-4))])
            tilt = draw.choice([0, draw.number(-0.01, 0.01)]) if held else 0
            zones = {FLOOR: {**bottom, "surface": plane(0, -low, 90 + tilt)}}
        case 1:
            corner, drop = draw.number(-w / 3, w / 3), w * draw.number(1e-4, 0.1)
            points = [[-w, 0], [corner, 0], [w, rounded(-drop)]]
            zones = {FLOOR: {**bottom, "surface": {"kind": "polyline", "points": points}}}
        case 2:
            first, last = draw.number(-0.45, -0.15) * w, draw.number(0.15, 0.45) * w
            ends = rounded(first), rounded(last)
            points = [[ends[0], -w], [ends[0], 0], [ends[1], 0], [ends[1], -w]]
            zones = {FLOOR: {**bottom, "surface": {"kind": "polyline", "points": points}}}
        case _:
            places = sorted(draw.sample([-0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4], draw.choice([2, 2, 3])))
            zones = {}
            for number, place in enumerate(places, 1):
                r, low = draw.number(w / 100, w), draw.choice([0, 0, w * draw.number(1e-5, 1e-3)])
                zones[f"rod {number}"] = {"edges": ["bottom"], "surface": circle(place * w, -r - low, r)}
    return stated("block", material=E, boundary={"outer": edges}, conditions=conditions, contact_zones=zones,
                  loads=volume_loads(draw))  # fmt: skip


@kind
def corner(draw: Draw) -> Spec:
    """A block between a floor and walls, held by contact alone."""
    w, h, E = draw.number(10, 60), draw.number(10, 60), draw.material()
    p, q = (rounded(draw.number(1e-4, 2e-3) * E["young_modulus"]) for _ in range(2))
    edges = rectangle(w, h)
    rounds = ["round"] if draw.chance(0.5) else []
    edges += [{"name": name, "fillet": rounded(draw.number(0.05, 0.3) * min(w, h))} for name in rounds]
    zones: Spec = {FLOOR: {"edges": ["bottom", *rounds], "surface": plane(0, 0)}}
    lean = draw.choice([0.0, 0.0, draw.number(-0.02, 0.02)])
    zones["wall"] = {"edges": ["left", *rounds], "surface": plane(rounded(-w / 2, 6), h / 2, lean)}
    conditions = {"top": {"pressure": p}, "right": {"pressure": q}}
    return stated("corner", material=E, boundary={"outer": edges}, conditions=conditions, contact_zones=zones,
                  loads=volume_loads(draw))  # fmt: skip


@kind
def roller(draw: Draw) -> Spec:
    """A disk or a ring on a plane, in a groove, in a trough or on a rod; under its weight or a plate."""
    r, E = draw.number(2, 50), draw.material()
    strength = draw.number(1e-5, 2e-3) * E["young_modulus"] * r
    holes, area, thick = [], pi * r * r, 1.0
    if draw.chance(0.4):
        inner = rounded(r * draw.number(0.2, 0.8))
        thick = 1 - inner / r
        holes, area = [bore(inner)], pi * (r * r - inner * inner)
    strength *= thick**2
    low = rounded(-r, 6)
    force = rounded(strength)
    loads, tools, zones = {}, {}, {}
    match draw.randrange(4):
        case 0:
            zones[FLOOR] = {"edges": ["rim"], "surface": plane(0, low)}
        case 1:
            steep = draw.number(15, 50)
            for name, angle in ("left flank", 90 - steep), ("right flank", 90 + steep):
                x, y = (rounded(-r * f(radians(angle)), 8) for f in (cos, sin))
                zones[name] = {"edges": ["rim"], "surface": plane(x, y, angle)}
        case 2:
            R = rounded(r * draw.number(1.01, 10), 6)
            zones["trough"] = {"edges": ["rim"], "surface": circle(0, R - r, R, "inside")}
        case _:
            half = radians(draw.number(15, 40))
            points = [[-3 * r, r], [-r * sin(half), -r], [r * sin(half), -r], [3 * r, r]]
            points = [[rounded(x, 5) for x in point] for point in points]
            zones["groove"] = {"edges": ["rim"], "surface": {"kind": "polyline", "points": points}}
    if draw.chance(0.5):
        aside = draw.number(-10, 10) if len(zones) > 1 and draw.chance(0.5) else 0
        loads["gravity"] = weight(force, area, -90 + aside)
    else:
        zones["plate"] = {"edges": ["rim"], "surface": plane(0, -low, -90)}
        tools["plate"] = {"zones": "plate", "force": {"y": -force}}
    return stated("roller", material=E, boundary={"outer": disk(r), "holes": holes}, loads=loads, contact_zones=zones,
                  tools=tools)  # fmt: skip


@kind
def ring(draw: Draw) -> Spec:
    """A ring or an eye on a rigid pin, with clearance or interference."""
    a = draw.number(3, 30)
    b = rounded(a * draw.number(1.3, 3))
    E = draw.material()
    gap = a * draw.choice([draw.number(1e-5, 1e-2), -draw.number(1e-5, 2e-3)])
    pin = circle(0, rounded(max(gap, 0), 6), rounded(a - gap, 8))
    outer = [
        {"name": "above", "kind": "arc", "center": [0, 0], "start": [b, 0], "end": [-b, 0]},
        {"name": "below", "kind": "arc", "center": [0, 0], "start": [-b, 0], "end": [b, 0]},
    ]
    load = rounded(-draw.number(1e-5, 1e-3) * E["young_modulus"])
    aside = 0 if gap > 0 else draw.choice([0, load / 2])
    conditions: Spec = {edge: {"traction": {"x": aside, "y": load}} for edge in ("above", "below")}
    return stated("ring", material=E, boundary={"outer": outer, "holes": [bore(a)]}, conditions=conditions,
                  contact_zones={"pin": {"edges": ["bore"], "surface": pin}}, loads=volume_loads(draw))  # fmt: skip


@kind
def lip(draw: Draw) -> Spec:
    """A clamped strip with a round nose that is pressed on a plane, a rod or a floor with a corner."""
    length, h, E = draw.number(10, 60), draw.number(1, 6), draw.material(5, 1e5)
    r = rounded(h * draw.number(0.3, 1.5))
    x = round(length - 2 * r, 3)
    corners = [(0, 0), (x - r, 0), (x + r, 0), (length, 0), (length, h), (0, h)]
    edges = polygon(corners, "under nose beyond tip top clamp")
    edges[1] |= {"kind": "arc", "center": [x, 0]}
    deep = -rounded(r - length * draw.number(1e-4, 3e-3), 6)
    surface = draw.choice([
        plane(0, deep), circle(x, rounded(deep - 3 * r, 6), rounded(3 * r, 6)),
        {"kind": "polyline", "points": [[0, deep], [x, deep], [2 * length, deep - draw.number(0, 1)]]},
    ])  # fmt: skip
    conditions: Spec = {"clamp": {"fixed": True}}
    if draw.chance(0.3):
        conditions["top"] = {"pressure": rounded(1e-6 * E["young_modulus"])}
    zones = {"seal": {"edges": ["under", "nose", "beyond"] if draw.chance(0.5) else ["nose"], "surface": surface}}
    return stated("lip", material=E, boundary={"outer": edges}, conditions=conditions, contact_zones=zones)


@kind
def tool(draw: Draw) -> Spec:
    """A rigid flat, round or pointed tool on a block that is held, moved or loaded in all its motions."""
    w, h, E = draw.number(20, 80), draw.number(10, 60), draw.material()
    edges = rectangle(w, h, 0, rounded(-h, 6))
    a, b = sorted(draw.sample([-0.4, -0.25, -0.1, 0.1, 0.25, 0.4], 2))
    pieces = split(edges[2], 0.5 - b, "face")
    pieces = [pieces[0], *split(pieces[1], (b - a) / (b + 0.5), "beside")]
    pieces[0]["name"] = "free"
    edges[2:3] = pieces
    middle, half = w * (a + b) / 2, w * (b - a) / 2
    R = w * draw.number(0.3, 10)
    drop = half * draw.number(1e-4, 3e-2)
    corners = [[middle + w, drop * w / half], [middle, 0], [middle - w, drop * w / half]]
    surface = draw.choice([
        plane(0, 0, -90), circle(rounded(middle, 6), rounded(R, 6), rounded(R, 6)),
        {"kind": "polyline", "points": [[rounded(v, 5) for v in point] for point in corners]},
    ])  # fmt: skip
    force = draw.number(1e-5, 1e-3) * E["young_modulus"] * w
    sunk = rounded(-h * draw.number(1e-5, 1e-3))
    action = draw.choice([
        {"force": {"y": rounded(-force)}},
        {"force": {"y": rounded(-force), "moment": rounded(force * half * draw.number(-0.6, 0.6))}},
        {"displacement": {"y": sunk, "rotation": draw.choice([0, 1e-5, -1e-4])}},
        {"displacement": {"y": sunk}, "force": {"moment": 0}},
    ])  # fmt: skip
    tools = {"punch": {"zones": "punch", "point": [rounded(middle, 6), 0], **action}}
    spring = {"normal": rounded(E["young_modulus"] / h / 10), "tangent": 1}
    held = draw.choice([{"fixed": True}, {"spring": spring}])
    zones = {"punch": {"edges": ["face"], "surface": surface}}
    return stated("tool", material=E, boundary={"outer": edges}, conditions={"bottom": held}, tools=tools,
                  contact_zones=zones, loads=volume_loads(draw))  # fmt: skip


def held_block(draw: Draw, w: float, h: float, E: Spec, y: float = 0.0) -> Spec:
    """A block below a height, clamped at its bottom."""
    held = draw.choice([{"fixed": True}, {"fixed": True}, {"displacement": {"y": 0}}])
    conditions: Spec = {"bottom": held}
    if "fixed" not in held:
        conditions["left"] = {"displacement": {"x": 0}}
    return {"material": E, "boundary": {"outer": rectangle(w, h, 0, rounded(y - h, 6))}, "conditions": conditions}


def pressed_block(w: float, h: float, E: Spec, y: float, load: float, x: float = 0.0) -> Spec:
    """A block above a height under a pressure, whose left side slides."""
    conditions = {"top": {"pressure": rounded(load / w)}, "left": {"displacement": {"x": 0}}}
    return {"material": E, "boundary": {"outer": rectangle(w, h, x, y)}, "conditions": conditions}


def bodies(name: str, parts: Spec, contacts: Spec, **more: Any) -> Spec:
    """A spec of several bodies."""
    return stated(name, bodies=parts, contacts=contacts, **more)


@kind
def blocks(draw: Draw) -> Spec:
    """Two or three blocks on each other; the upper ones may be longer, rounded or heated."""
    w, E = draw.number(10, 60), draw.material()
    parts = {"base": held_block(draw, w, draw.number(5, 40), E)}
    y, below, contacts = 0.0, "base", {}
    for number in range(draw.choice([1, 1, 2])):
        width, h = rounded(w * draw.choice([1, draw.number(0.3, 1), draw.number(1, 1.4)])), draw.number(2, 30)
        name = f"upper {number + 1}"
        edges = filleted(draw, rectangle(width, h, 0, y), min(width, h))
        parts[name] = {"material": draw.material(), "boundary": {"outer": edges}, "conditions": {}}
        if loads := volume_loads(draw):
            parts[name]["loads"] = loads
        contacts[f"joint {number + 1}"] = {"between": [name, below]}
        y, below = rounded(y + h, 6), name
    parts[below]["conditions"]["top"] = {"pressure": draw.number(0.1, 3)}
    return bodies("blocks", parts, contacts)


@kind
def rolled(draw: Draw) -> Spec:
    """A roller on a block, under its weight, a pressed block or a plate; or two of them between blocks."""
    r, E = draw.number(2, 20), draw.material()
    stiff = {**E, "young_modulus": rounded(E["young_modulus"] * draw.choice([1, draw.number(1, 20)]))}
    w = rounded(r * draw.number(4, 12))
    load = draw.number(1e-5, 1e-3) * E["young_modulus"] * r
    h = rounded(r * draw.number(1, 6))
    parts = {"base": held_block(draw, w, h, E)}
    parts["roller"] = {"material": stiff, "boundary": {"outer": disk(r, 0, r)}}
    contacts, more = {"under": {"between": ["roller", "base"]}}, {}
    match draw.randrange(4):
        case 0:
            parts["roller"]["loads"] = {"gravity": weight(load, pi * r * r)}
        case 1:
            more["contact_zones"] = {"plate": {"edges": ["roller/rim"], "surface": plane(0, 2 * r, -90)}}
            more["tools"] = {"plate": {"zones": "plate", "force": {"y": rounded(-load)}}}
        case 2:
            axis: Spec = {"conditions": {"axis": {"symmetry": "x"}}}
            base, over = (polygon([(0, y), (w, y), (w, y + h), (0, y + h)], "bottom right top axis")
                          for y, h in ((rounded(-h, 6), h), (2 * r, rounded(draw.number(1, 4) * r))))  # fmt: skip
            rim = {"name": "rim", "kind": "arc", "center": [0, r], "start": [0, 0], "end": [0, 2 * r]}
            shaft = {"name": "axis", "start": [0, 2 * r], "end": [0, 0]}
            pressed = {"axis": {"symmetry": "x"}, "top": {"pressure": rounded(load / w)}}
            parts = {
                "base": {**axis, "material": E, "boundary": {"outer": base}},
                "roller": {**axis, "material": stiff, "boundary": {"outer": [rim, shaft]}},
                "upper": {"material": draw.material(), "boundary": {"outer": over}, "conditions": pressed},
            }
            parts["base"]["conditions"] = {**axis["conditions"], "bottom": {"displacement": {"y": 0}}}
            contacts["over"] = {"between": ["roller", "upper"]}
        case _:
            step, bar, play = rounded(r * draw.number(1.5, 1.8)), rounded(r / 5), rounded(r / 500)
            parts["roller"]["boundary"]["outer"] = disk(r, -step, r)
            parts["roller 2"] = {"copy_of": "roller", "shift": [2 * step, 0]}
            parts["upper"] = pressed_block(w, r * draw.number(1, 4), E, 2 * r, load)
            del contacts["under"]
            for n, x in ("roller", -step), ("roller 2", step):
                contacts[f"under {n}"] = {"between": [n, "base"]}
                contacts[f"over {n}"] = {"between": [n, "upper"]}
                for side, middle in ("left", x - r - play - bar / 2), ("right", x + r + play + bar / 2):
                    outline = rectangle(bar, bar, rounded(middle, 6), rounded(r - bar / 2, 6))
                    parts[f"{side} of {n}"] = {"rigid": True, "boundary": {"outer": outline}}
                    contacts[f"{n} to the {side}"] = {"between": [n, f"{side} of {n}"]}
    return bodies("rolled", parts, contacts, **more)


@kind
def pin(draw: Draw) -> Spec:
    """An elastic pin in the hole of a plate, with clearance or interference, pulled by its volume or its bore."""
    r, E = draw.number(3, 20), draw.material()
    gap = rounded(r * draw.choice([draw.number(1e-5, 1e-2), 0, -draw.number(1e-5, 1e-3)]))
    size, hole = rounded(r * draw.number(4, 10)), rounded(r + gap, 8)
    outline = {"outer": rectangle(size, size, 0, -size / 2), "holes": [bore(hole, name="hole")]}
    plate: Spec = {"material": E, "boundary": outline}
    plate["conditions"] = {draw.choice(["top", "bottom", "left"]): {"fixed": True}}
    stiff = {**E, "young_modulus": rounded(E["young_modulus"] * draw.number(1, 10))}
    y = rounded(-max(gap, 0), 6)
    made = {"material": stiff, "boundary": {"outer": disk(r, 0, y)}}
    load = draw.number(1e-5, 1e-3) * E["young_modulus"] * r
    made["loads"] = {"gravity": weight(load, pi * r * r, -90 if gap > 0 else draw.number(-180, 0))}
    return bodies("pin", {"pin": made, "plate": plate}, {"fit": {"between": ["pin/rim", "plate/hole"]}})


@kind
def layer(draw: Draw) -> Spec:
    """A layer that lies on a block, or a coat that is bonded to it, under a rigid roller or a pressure."""
    w, h = draw.number(20, 80), draw.number(10, 40)
    t, glued = rounded(draw.number(0.03, 0.5) * h), draw.chance(0.6)
    t = t if glued else max(t, rounded(w / 30))
    E, soft = draw.material(), draw.material(5, 300e3)
    base = {"material": E, "boundary": {"outer": rectangle(w, h, 0, -h)}, "conditions": {"bottom": {"fixed": True}}}
    coat = {"material": soft, "boundary": {"outer": rectangle(w, t)}, "conditions": {}}
    bonded = {"glue": ["coat/bottom", "base/top"]} if glued else {}
    contacts = {} if bonded else {"seat": {"between": ["coat/bottom", "base/top"]}}
    if not bonded:
        coat["conditions"]["left"] = {"displacement": {"x": 0}}
    R = rounded(w * draw.number(0.2, 3))
    place = rounded(draw.choice([0, draw.number(-0.3, 0.3)]) * w)
    load = rounded(draw.number(1e-6, 3e-4) * soft["young_modulus"] * R)
    zones = {"track": {"edges": ["coat/top"], "surface": circle(place, t + R, R)}}
    tools = {"roller": {"zones": "track", "force": {"y": -load}}}
    return bodies("layer", {"base": base, "coat": coat}, contacts, bonded=bonded, contact_zones=zones, tools=tools)


@kind
def outline(draw: Draw) -> Spec:
    """A rigid body with corners or rounded edges that is pressed on a block."""
    w, h, E = draw.number(20, 80), draw.number(10, 60), draw.material()
    half, tall = rounded(w * draw.number(0.05, 0.3)), h
    edges = rectangle(2 * half, tall)
    if draw.chance(0.7):
        radius = rounded(half * draw.number(0.05, 0.9))
        first, last = ({"name": f"{side} round", "fillet": radius} for side in ("right", "left"))
        edges = [edges[0], first, *edges[1:], last]
    force = rounded(draw.number(1e-5, 1e-3) * E["young_modulus"] * half)
    action = {"y": -force, **draw.choice([{}, {"moment": rounded(force * half * draw.number(-0.5, 0.5))}])}
    base = held_block(draw, w, h, E)
    punch = {"rigid": True, "boundary": {"outer": edges}}
    tools = {"ram": {"zones": "press", "point": [0, 0], "force": action}}
    return bodies("outline", {"base": base, "punch": punch}, {"press": {"between": ["base/top", "punch"]}}, tools=tools)


@kind
def half(draw: Draw) -> Spec:
    """Half of a symmetric body on a plane or a rod: its whole is a variant of it."""
    w, h, E = draw.number(5, 50), draw.number(5, 60), draw.material()
    r = rounded(w * draw.number(1.2, 8))
    load = rounded(draw.number(1e-5, 1e-3) * E["young_modulus"])
    if draw.chance(0.5):
        edges = polygon([(0, 0), (w, 0), (w, h), (0, h)], "foot right top axis")
    else:
        x = rounded(min(w, 0.9 * r), 6)
        low = rounded(r - (r * r - x * x) ** 0.5, 12)
        edges = polygon([(0, 0), (x, low), (x, low + h), (0, low + h)], "foot right top axis")
        edges[0] = {"name": "foot", "kind": "arc", "center": [0, r], "start": [0, 0], "end": [x, low]}
        edges[1]["start"], edges[1]["end"][1] = [x, low], edges[2]["start"][1]
    R = rounded(w * draw.number(0.1, 20))
    surface = draw.choice([plane(0, 0), circle(0, -R, R)])
    conditions = {"top": {"pressure": load}, "axis": {"symmetry": "x"}}
    return stated("half", material=E, boundary={"outer": edges}, conditions=conditions,
                  contact_zones={FLOOR: {"edges": ["foot"], "surface": surface}})  # fmt: skip


@kind
def wavy(draw: Draw) -> Spec:
    """A block on a surface with bumps, lines or a spline; held or free."""
    w, h, E = draw.number(10, 60), draw.number(5, 40), draw.material()
    high, count = w * draw.number(1e-5, 1e-3), draw.choice([4, 5, 6, 8, 11])
    heights = [round(high * draw.random(), 9) for _ in range(count)]
    most = max(heights)
    points = [[rounded((i / (count - 1) - 0.5) * 1.2 * w), round(y - most, 9)] for i, y in enumerate(heights)]
    surface = {"kind": draw.choice(["spline", "spline", "polyline"]), "points": points}
    conditions: Spec = {"top": {"pressure": rounded(draw.number(1e-5, 3e-3) * E["young_modulus"])}}
    if draw.chance(0.7):
        conditions["left"] = {"displacement": {"x": 0}}
    zones = {FLOOR: {"edges": ["bottom"], "surface": surface}}
    return stated("wavy", material=E, boundary={"outer": rectangle(w, h)}, conditions=conditions, contact_zones=zones,
                  loads=volume_loads(draw))  # fmt: skip


@kind
def hook(draw: Draw) -> Spec:
    """A clamped body with re-entrant corners, sharp or round, perhaps with a hole, whose feet touch rods and planes."""
    w, h, t, E = draw.number(20, 60), draw.number(15, 50), draw.number(3, 8), draw.material()
    inner, drop = rounded(w * draw.number(0.3, 0.6)), rounded(h * draw.number(0.2, 0.5))
    corners = [(0, drop), (inner, drop), (inner, 0), (w, 0), (w, h), (0, h)]
    edges = polygon(corners, "ledge riser foot right top clamp")
    if draw.chance(0.6):
        edges.insert(1, {"name": "throat", "fillet": rounded(draw.number(0.05, 0.4) * min(inner, drop))})
    r = rounded(draw.number(0.1, 0.3) * min(w - inner, h - drop))
    holes = [bore(r, rounded((inner + w) / 2), rounded((drop + h) / 2), "hole")] if draw.chance(0.5) else []
    low, place = w * draw.number(1e-5, 1e-3), rounded(inner + (w - inner) * draw.number(0.2, 0.8))
    R = draw.number(1, 50)
    foot = draw.choice([plane(0, -rounded(low, 5)), circle(place, -rounded(R + low, 8), R)])
    zones = {"foot": {"edges": ["foot"], "surface": foot}}
    if draw.chance(0.4):
        R, near = draw.number(0.5, t), rounded(low * draw.random() / 3)
        zones["ledge"] = {"edges": ["ledge"], "surface": circle(rounded(inner / 2), rounded(drop - R - near, 9), R)}
    load = rounded(-draw.number(1e-6, 1e-4) * E["young_modulus"] * w)
    conditions = {"clamp": {"fixed": True}, "top": {"force": {"x": 0, "y": load}}}
    return stated("hook", material=E, boundary={"outer": edges, "holes": holes}, conditions=conditions,
                  contact_zones=zones, loads=volume_loads(draw))  # fmt: skip


@kind
def seats(draw: Draw) -> Spec:
    """An elastic beam on two or three elastic blocks or half-round feet, pressed at several places."""
    w, t, E = draw.number(30, 100), draw.number(2, 12), draw.material()
    places = sorted(draw.sample([-0.45, -0.3, -0.15, 0.0, 0.15, 0.3, 0.45], draw.choice([2, 3])))
    beam = rectangle(w * 1.3, t)
    parts: Spec = {"beam": {"material": E, "boundary": {"outer": beam}}}
    parts["beam"]["conditions"] = {"left": {"displacement": {"x": 0}}}
    parts["beam"]["conditions"]["top"] = {"pressure": rounded(draw.number(1e-7, 1e-5) * E["young_modulus"])}
    contacts: Spec = {}
    for number, place in enumerate(places, 1):
        x, b, tall = rounded(place * w), rounded(draw.number(0.01, 0.06) * w), rounded(draw.number(0.05, 0.3) * w)
        low = draw.choice([0, 0, rounded(w * draw.number(1e-6, 1e-4))])
        outer = rectangle(2 * b, tall, x, rounded(-tall - low, 8))
        if draw.chance(0.5):
            R = rounded(b * draw.number(1.1, 10), 8)
            outer = rectangle(2 * b, tall, x, rounded(-tall - low - R, 8))
            high = -low - R + (R * R - b * b) ** 0.5
            for edge, end in (outer[1], "end"), (outer[2], "start"), (outer[2], "end"), (outer[3], "start"):
                edge[end] = [edge[end][0], high]
            outer[0]["start"] = outer[3]["end"] = [outer[0]["start"][0], outer[0]["start"][1]]
            outer[2] |= {"kind": "arc", "center": [x, -low - R]}
        name = f"seat {number}"
        held = {"bottom": {"fixed": True}}
        parts[name] = {"material": draw.material(), "boundary": {"outer": outer}, "conditions": held}
        contacts[f"on {number}"] = {"between": [f"{name}/top", "beam/bottom"]}
    return bodies("seats", parts, contacts)
