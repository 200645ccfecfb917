"""The same problem, stated otherwise: turned, mirrored, in other units, in a load case, sides exchanged, the whole.

A change acts on the specs of `random_specs`: each edge states both of its ends, or `angles`.
"""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from math import cos, radians, sin
from typing import Any

import numpy as np
from random_specs import Spec

POINTS, LENGTHS = ("start", "end", "center", "point"), ("radius", "fillet", "width", "gap")
UNITS = {
    "in, psi": (1 / 25.4, 145.03773773, {"length": "in", "force": "lbf"}),
    "m, Pa": (1e-3, 1e6, {"length": "m", "force": "N"}),
}
"""Factors of lengths and stresses from mm and N, and the labels."""


@dataclass(frozen=True, kw_only=True)
class Change:
    """Mirrored on x = 0, turned by an angle [degrees], then shifted, with numbers larger by the factors of units."""

    angle: float = 0.0
    mirror: bool = False
    length: float = 1.0
    stress: float = 1.0
    shift: tuple[float, float] = (0.0, 0.0)
    units: Spec | None = None

    @property
    def matrix(self) -> np.ndarray:
        """Orthogonal matrix (2, 2) of directions."""
        c, s = (f(radians(self.angle)) for f in (cos, sin))
        turn = np.array([[c, -s], [s, c]])
        turn = np.round(turn) if self.angle % 90 == 0 else turn
        return turn @ np.diag([-1.0 if self.mirror else 1.0, 1.0])

    def vector(self, value: Any, factor: float = 1.0) -> list[float]:
        """A direction."""
        return [float(v) + 0.0 for v in factor * self.matrix @ np.array(value, float)]

    def place(self, value: Any) -> list[float]:
        """A point."""
        return [v + moved for v, moved in zip(self.vector(value, self.length), self.shift, strict=True)]

    def components(self, value: Spec, factor: float, *, moment: str = "", both: bool = False) -> Spec:
        """A mapping of components; those that are left out stay so, which needs quarter turns."""
        rest = {key: item for key, item in value.items() if key not in ("x", "y")}
        if moment in rest:
            rest[moment] *= (-1 if self.mirror else 1) * (factor * self.length if moment == "moment" else 1.0)
        if "width" in rest:
            rest["width"] *= self.length
        if "x" not in value and "y" not in value:
            return rest
        turned = self.vector([value.get("x", 0), value.get("y", 0)], factor)
        given = {"x", "y"} if both or {"x", "y"} <= {*value} else {*value} & {"x", "y"}
        kept = {axis for axis, row in zip("xy", self.matrix, strict=True) for old in given if row["xy".index(old)]}
        return {**rest, **{axis: turned["xy".index(axis)] for axis in sorted(kept)}}

    def field(self, value: Any, factor: float) -> Any:
        """A number, or a field that is linear in the coordinates."""
        if not isinstance(value, dict):
            return value * factor
        slope = self.vector([value.get("x", 0), value.get("y", 0)], factor / self.length)
        constant = value.get("constant", 0) * factor - slope[0] * self.shift[0] - slope[1] * self.shift[1]
        return {"constant": constant, "x": slope[0], "y": slope[1]}

    def loop(self, edges: list[Spec]) -> list[Spec]:
        """A loop of edges; a mirrored one runs the other way."""
        made = [{key: self(item, key) for key, item in edge.items()} for edge in edges]
        for edge in made if self.mirror else ():
            if "start" in edge:
                edge["start"], edge["end"] = edge["end"], edge["start"]
        return made[::-1] if self.mirror else made

    def angles(self, value: list[float]) -> list[float]:
        """First and last angle of an arc [degrees]."""
        first, last = (180 - value[1], 180 - value[0]) if self.mirror else value
        return [first + self.angle, last + self.angle]

    def __call__(self, value: Any, key: str = "") -> Any:
        """A part of a spec by its key."""
        s, p = self.length, self.stress
        by_key: dict[str, Callable[[Any], Any]] = {
            **dict.fromkeys(POINTS, self.place),
            **dict.fromkeys(LENGTHS, lambda v: v * s),
            "points": lambda v: [self.place(point) for point in (v[::-1] if self.mirror else v)],
            "shift": lambda v: self.vector(v, s),
            "acceleration": lambda v: self.vector(v, p / s),
            "normal": self.vector,
            "angles": self.angles,
            "young_modulus": lambda v: v * p,
            "pressure": lambda v: self.field(v, p),
            "change": lambda v: self.field(v, 1.0),
            "traction": lambda v: self.components(v, p, both=True),
            "force": lambda v: self.components(v, p * s, moment="moment"),
            "displacement": lambda v: self.components(v, s, moment="rotation"),
            "spring": lambda v: {way: k * p / s for way, k in v.items()},
            "symmetry": lambda v: "xy"[int(abs(self.matrix[1, "xy".index(v)]) > 0.5)],
            "outer": self.loop,
            "holes": lambda v: [self.loop(hole) for hole in v],
            "units": lambda v: self.units or v,
        }
        if key in by_key:
            return by_key[key](value)
        if isinstance(value, dict):
            return {name: self(item, name) for name, item in value.items()}
        return [self(item) for item in value] if isinstance(value, list) else value


def turns_freely(spec: Any, key: str = "") -> bool:
    """Whether no component along a single axis is stated, so that any angle can be stated."""
    if isinstance(spec, list):
        return all(turns_freely(item) for item in spec)
    if not isinstance(spec, dict):
        return key != "symmetry"
    alone = key in ("displacement", "force") and len({*spec} & {"x", "y"}) == 1
    return not alone and all(turns_freely(item, name) for name, item in spec.items())


def in_a_case(spec: Spec) -> Spec | None:
    """The problem with its loads in the load case `own`, beside another one with half of them; None without loads."""
    made, own = deepcopy(spec), {"conditions": {}, "bodies": {}, "tools": {}}
    for name, body in [("", made), *made.get("bodies", {}).items()]:
        for edge, condition in [*body.get("conditions", {}).items()]:
            loads = {key: condition.pop(key) for key in ("pressure", "traction", "force") if key in condition}
            if loads:
                own["conditions"][f"{name}/{edge}" if name else edge] = loads
            if not condition:
                del body["conditions"][edge]
        if loads := body.pop("loads", None):
            own["bodies"].update({name: loads} if name else {})
            own.update({} if name else {"loads": loads})
    for name, tool in made.get("tools", {}).items():
        own["tools"][name] = {way: deepcopy(tool[way]) for way in ("force", "displacement") if way in tool}
        for way in own["tools"][name]:
            tool[way] = dict.fromkeys(tool[way], 0)
    own = {key: value for key, value in own.items() if value}
    if not own:
        return None
    return {**made, "load_cases": {"own": own}, "combinations": {"half": {"own": 0.5}, "all": {"own": 1}}}


def exchanged(spec: Spec) -> Spec:
    """The sides of all contacts exchanged, and those of bonds."""
    made = deepcopy(spec)
    for contact in made.get("contacts", {}).values():
        contact["between"] = contact["between"][::-1]
    made.update({"bonded": {name: pair[::-1] for name, pair in made["bonded"].items()}} if "bonded" in made else {})
    return made


def whole(spec: Spec) -> Spec:
    """The whole of half of a body whose last edge is the axis x = 0."""
    made = deepcopy(spec)
    loop = made["boundary"]["outer"][:-1]
    image = [{**edge, "name": f"{edge['name']} mirrored"} for edge in Change(mirror=True).loop(loop)]
    made["boundary"]["outer"] = [*loop, *image]
    del made["conditions"]["axis"]
    made["conditions"] |= {f"{edge} mirrored": condition for edge, condition in made["conditions"].items()}
    for zone in made["contact_zones"].values():
        zone["edges"] = [*zone["edges"], *(f"{edge} mirrored" for edge in zone["edges"])]
    return made


def reordered(spec: Spec) -> Spec:
    """Bodies, zones, contacts and conditions in the opposite order, and each loop begun at its second edge."""

    def turned(value: Any, key: str = "") -> Any:
        if isinstance(value, dict):
            back = key in ("bodies", "contact_zones", "contacts", "conditions", "tools")
            return {name: turned(item, name) for name, item in ([*value.items()][::-1] if back else value.items())}
        return [*value[1:], value[0]] if key == "outer" else deepcopy(value)

    return turned(spec)


def cut(spec: Spec) -> Spec:
    """Each straight edge without a condition cut in two, at 0.37 of its length."""
    made, parts = deepcopy(spec), dict[str, list[str]]()
    for name, body in [("", made), *made.get("bodies", {}).items()]:
        held, loop = body.get("conditions", {}), list[Spec]()
        for edge in body.get("boundary", {}).get("outer", []):
            loop.append(edge)
            if edge.get("kind", "line") != "line" or "start" not in edge or edge["name"] in held:
                continue
            start, end = np.array([edge["start"], edge["end"]], float)
            middle, other = [float(v) for v in start + 0.37 * (end - start)], f"{edge['name']} 2"
            loop[-1:] = [{**edge, "end": middle}, {"name": other, "start": middle, "end": edge["end"]}]
            whole, second = (f"{name}/{own}" if name else own for own in (edge["name"], other))
            parts[whole] = [whole, second]
        if loop:
            body["boundary"]["outer"] = loop
    for zone in made.get("contact_zones", {}).values():
        zone["edges"] = [part for edge in zone["edges"] for part in parts.get(edge, [edge])]
    for contact in made.get("contacts", {}).values():
        contact["between"] = [parts.get(side, side) for side in contact["between"]]
    return made
