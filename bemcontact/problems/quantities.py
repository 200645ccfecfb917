"""Values with units, such as 210 GPa or 5 mm, as numbers in the units of a problem."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from typing import Any, NamedTuple

from bemcontact.errors import Issue, KeyPath, ProblemError
from bemcontact.problems.units import METERS, NEWTONS

QUANTITY = re.compile(
    r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?+)\s*((?![eE]\s*$)(?:1?\s*/\s*)?[A-Za-zµμ°%][^#]*?)\s*"
)
"""A number with a unit behind it. The exponent is one of the number, never a unit e."""
POWER = re.compile(r"(?<=[A-Za-z])([2-4])(?![A-Za-z0-9])")
"""The power of a unit in N/mm2 or kg/m3."""


class Dimension(NamedTuple):
    """Powers of length, force, time and temperature, and the name of a quantity."""

    length: int
    force: int
    time: int = 0
    temperature: int = 0
    name: str = "a quantity"
    example: str = ""


LENGTH = Dimension(1, 0, name="a length", example="5 mm")
STRESS = Dimension(-2, 1, name="a stress", example="210 GPa")
LINE_FORCE = Dimension(-1, 1, name="a force per thickness", example="400 N/mm")
LINE_MOMENT = Dimension(0, 1, name="a moment per thickness", example="20 N*mm/mm")
FOUNDATION = Dimension(-3, 1, name="a stiffness per area", example="50 N/mm^3")
DENSITY = Dimension(-4, 1, 2, name="a density", example="7850 kg/m^3")
ACCELERATION = Dimension(1, 0, -2, name="an acceleration", example="9.81 m/s^2")
ANGULAR_VELOCITY = Dimension(0, 0, -1, name="an angular velocity", example="3000 rpm")
EXPANSION = Dimension(0, 0, 0, -1, name="a coefficient of expansion", example="12e-6 1/K")
TEMPERATURE = Dimension(0, 0, 0, 1, name="a change of temperature", example="50 K")
DEGREES = Dimension(0, 0, name="an angle", example="30 deg")
RADIANS = Dimension(0, 0, name="a rotation", example="0.1 deg")
FRACTION = Dimension(0, 0, name="a fraction", example="1 %")

KEYS: Mapping[str, Dimension] = {
    **dict.fromkeys(
        ("start", "end", "center", "radius", "semi_axes", "fillet", "point", "points", "gap", "shift", "about", "width",
         "at"), LENGTH,
    ),
    "young_modulus": STRESS, "pressure": STRESS, "density": DENSITY, "acceleration": ACCELERATION,
    "angular_velocity": ANGULAR_VELOCITY, "expansion": EXPANSION, "change": TEMPERATURE, "moment": LINE_MOMENT,
    **dict.fromkeys(("angles", "rotate"), DEGREES), **dict.fromkeys(("accuracy", "tolerance"), FRACTION),
}  # fmt: skip
"""Key -> dimension of its value, or of the numbers in it."""
OF_PARENT: Mapping[str, Dimension] = {
    "displacement": LENGTH, "traction": STRESS, "force": LINE_FORCE, "mirror": LENGTH, "spring": FOUNDATION
}  # fmt: skip
"""Key -> dimension of x and y below it."""
OF_REFERENCE: Mapping[str, Dimension] = {
    **dict.fromkeys(("load", "resultant"), LINE_FORCE), **dict.fromkeys(("peak", "compression", "pressure"), STRESS),
    **dict.fromkeys(
        ("surface_radius", "half_width", "eccentricity", "inner_radius", "outer_radius", "interference", "clearance",
         "half_length", "half_height", "span", "height", "contact_length", "radius", "center", "gap"), LENGTH,
    ),
}  # fmt: skip
"""Key of a reference -> dimension of its value. Positions may be angles, so that they have no units."""
POWERS = {"constant": 0, "x": 1, "y": 1, "xx": 2, "xy": 2, "yy": 2}
"""Key of a polynomial -> power of the coordinates."""


SPELLED = {unit.casefold(): unit for unit in (*METERS, *NEWTONS, "Pa", "kPa", "MPa", "GPa", "psi", "ksi", "K", "kg")}
"""Unit in small letters -> how it is written."""


def dimension_of(path: KeyPath) -> Dimension | None:
    """Dimension of the number at a key path; None for one without units, or of which the unit is not known."""
    words = [step for step in path if isinstance(step, str)]
    if not words:
        return None
    key, parent = words[-1], words[-2] if len(words) > 1 else ""
    inside = len(path) - max(i for i, step in enumerate(path) if isinstance(step, str)) - 1
    if words[0] == "reference":
        if key in ("start", "end", "zero", "position") or (key == "pressure" and path[-1] == 0):
            return None
        return OF_REFERENCE.get(key) or KEYS.get(key)
    if key == "along":
        return LENGTH if path[-1] == 0 else dimension_of(tuple(words[:-1]))
    if key in ("ends_at", "towards"):
        return LENGTH if inside > (key == "ends_at") else FRACTION
    if key == "rotation":
        return RADIANS if parent == "displacement" else DEGREES
    if key in POWERS and (base := _of_field(words[:-1])):
        return base._replace(length=base.length - POWERS[key], name=base.name if not POWERS[key] else "a slope")
    if key in ("x", "y") or parent == "spring":
        return OF_PARENT.get(parent)
    return KEYS.get(key)


def _of_field(words: list[str]) -> Dimension | None:
    """Dimension of what a polynomial prescribes; None where there is no polynomial."""
    if words and words[-1] in ("pressure", "change"):
        return KEYS[words[-1]]
    if len(words) > 1 and words[-1] in ("x", "y") and words[-2] in ("traction", "displacement"):
        return OF_PARENT[words[-2]]
    return None


def with_numbers(data: Any) -> tuple[Any, list[Issue]]:
    """A problem as a user states it, with numbers for values with units; and issues of those that are none.

    The units are those of the key ``units``. A text that is no number with a unit stays as it is.
    """
    first = next(_texts(data, ()), None) if isinstance(data, Mapping) else None
    if first is None:
        return data, []
    units, labels = data.get("units"), list[str]()
    for key, known in (("length", METERS), ("force", NEWTONS)):
        label = units.get(key) if isinstance(units, Mapping) else getattr(units, key, "")
        labels.append(label.strip() if isinstance(label, str) else "")
        if labels[-1] not in known:
            message = f"{first} is converted to the units of the problem: give {key} as one of {', '.join(known)}"
            return data, [Issue(path=("units", key) if label else ("units",), message=message)]
    issues = list[Issue]()
    return _converted(data, (), _Reader(*labels), issues), issues


def in_units(value: Any, path: KeyPath, length: str, force: str) -> Any:
    """A value at a key path with numbers for texts with units; `ProblemError` for one that is none."""
    if next(_texts(value, path), None) is None:
        return value
    for key, label, known in (("length", length, METERS), ("force", force, NEWTONS)):
        if label not in known:
            message = f"{value} is converted to the units of the problem: give units.{key} as one of {', '.join(known)}"
            raise ProblemError(Issue(path=path, message=message))
    issues = list[Issue]()
    read = _converted(value, path, _Reader(length, force), issues)
    if issues:
        raise ProblemError(issues)
    return read


def _texts(value: Any, path: KeyPath) -> Iterator[str]:
    """Texts with a number and a unit at places of numbers."""
    match value:
        case Mapping():
            for key, part in value.items():
                yield from _texts(part, _below(path, key))
        case list() | tuple():
            for i, part in enumerate(value):
                yield from _texts(part, (*path, i))
        case str() if QUANTITY.fullmatch(value) and dimension_of(path) is not None:
            yield value


def _below(path: KeyPath, key: Any) -> KeyPath:
    """The path of an entry; keys of `set` in variants are paths themselves."""
    if len(path) == 3 and path[0] == "variants" and path[2] == "set" and isinstance(key, str):
        return (*path, *re.findall(r"[^.\[\]]+", key))
    return (*path, str(key))


def _converted(value: Any, path: KeyPath, reader: "_Reader", issues: list[Issue]) -> Any:
    """A value with numbers for texts with units."""
    match value:
        case Mapping():
            return {key: _converted(part, _below(path, key), reader, issues) for key, part in value.items()}
        case list() | tuple():
            return [_converted(part, (*path, i), reader, issues) for i, part in enumerate(value)]
        case str():
            found, wanted = QUANTITY.fullmatch(value), dimension_of(path)
            if found is None or wanted is None:
                return value
            try:
                return reader.number(float(found[1]), found[2], wanted)
            except ValueError as error:
                issues.append(Issue(path=path, message=str(error)))
    return value


@dataclass(frozen=True)
class _Reader:
    """Converts quantities to the units of a problem."""

    length: str
    force: str

    def number(self, value: float, unit: str, wanted: Dimension) -> float:
        """The number of a quantity in the units of the problem; `ValueError` in words if there is none."""
        text = f"{value:g} {unit}"
        if find_spec("pint") is None:
            raise ValueError(f"values with units need the extra units: pip install 'bemcontact[units]'; found {text}")
        if "mPa" in unit:
            raise ValueError(f"mPa in {text} is a thousandth of Pa; write {text.replace('mPa', 'MPa')}")
        registry = _registry()
        name = {"°C": "delta_degC", "degC": "delta_degC", "C": "delta_degC", "°": "degree", "%": "percent"}.get(
            unit, "1" * unit.startswith("/") + unit
        )
        name = POWER.sub(r"**\1", name.replace("²", "2").replace("³", "3")).replace("·", "*")
        try:
            quantity = registry.Quantity(value, name)
            target = "radian" if wanted in (DEGREES, RADIANS) else _si(wanted)
            if wanted is DEGREES:
                return float(quantity.to("degree").magnitude)
            number = float(quantity.to(target).magnitude)
        except Exception as error:  # pint raises errors of many kinds
            if type(error).__name__ == "DimensionalityError":
                raise ValueError(f"expected {wanted.name} such as {wanted.example}; found {text}") from None
            spelled = re.sub(r"[A-Za-z]+", lambda word: SPELLED.get(word[0].casefold(), word[0]), unit)
            hint = f"did you mean {spelled}?" if spelled != unit else f"write {wanted.name} such as {wanted.example}"
            raise ValueError(f"unknown unit '{unit}' in {text}; {hint}") from None
        return number / (METERS[self.length] ** wanted.length * NEWTONS[self.force] ** wanted.force)


def _si(wanted: Dimension) -> str:
    """The unit of a dimension in SI."""
    names = zip(("meter", "newton", "second", "kelvin"), wanted[:4], strict=True)
    return "*".join(f"{name}**({power})" for name, power in names if power) or "dimensionless"


@cache
def _registry() -> Any:
    """The units of pint."""
    return import_module("pint").UnitRegistry()
