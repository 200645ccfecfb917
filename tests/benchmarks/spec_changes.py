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
    """Mirrored on x = 0, then turned by an angle [degrees], in units whose numbers are larger by these factors."""

    angle: float = 0.0
    mirror: bool = False
    length: float = 1.0
    stress: float = 1.0
    units: Spec | None = None

    @property
    def matrix(self) -> np.ndarray:
        """Orthogonal matrix (2, 2) of directions."""
        c, s = (f(radians(self.angle)) for f in (cos, sin))
        turn = np.array([[c, -s], [s, c]])
        turn = np.round(turn) if self.angle % 90 == 0 else turn
        return turn @ np.diag([-1.0 if self.mirror else 1.0, 1.0])

    def vector(self, value: Any, factor: float = 1.0) -> list[float]:
        """A direction or a point about the origin."""
        return [float(v) + 0.0 for v in factor * self.matrix @ np.array(value, float)]

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
        return {"constant": value.get("constant", 0) * factor, "x": slope[0], "y": slope[1]}

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
            **dict.fromkeys(POINTS, lambda v: self.vector(v, s)),
            **dict.fromkeys(LENGTHS, lambda v: v * s),
            "points": lambda v: [self.vector(point, s) for point in (v[::-1] if self.mirror else v)],
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
