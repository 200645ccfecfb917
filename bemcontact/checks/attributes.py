"""Attributes and names that do not exist: an error that says where the quantity is, or which names there are."""

import difflib
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, TypeVar

from bemcontact.checks.arguments import shown
from bemcontact.errors import ProblemError

Value = TypeVar("Value")

PLACES = {
    "footprint.peak.pressure": ("peak", "max_pressure", "maximum_pressure", "peak_pressure", "p_max", "pmax", "max"),
    "pressure": ("pressure", "pressures", "traction", "tractions", "p"),
    "stress": ("stress", "stresses", "sigma", "stress_at", "stress_tensor"),
    "largest_stresses": (
        "largest_stresses", "von_mises", "mises", "max_stress", "maximum_stress", "peak_stress", "max_von_mises",
        "max_shear", "tresca",
    ),
    "solution.displacement": ("displacement", "displacements", "deformation", "deflection", "u"),
    "solution.rigid_amplitudes": ("rigid_amplitudes", "amplitudes", "motions"),
    "rotations": ("rotations", "rotation", "angles", "turn"),
    "solution.status": ("status",),
    "solution.solver": ("solver",),
    "solution.iterations": ("iterations", "nit", "steps"),
    "footprint.resultant.force": ("resultant", "force", "total_force", "contact_force"),
    "forces": ("forces", "zone_forces", "resultants", "reaction", "reactions"),
    "footprint.resultant.moment": ("moment", "torque"),
    "intervals": ("intervals", "contact_length", "contact_width", "contact_area", "half_width", "ends"),
    "boundary": ("mesh", "nodes", "elements"),
    "touching": ("contact_set", "active_set", "in_contact"),
    "points": ("points", "coordinates", "positions"),
    "contact.initial_gap": ("initial_gap",),
    "gap": ("gap", "gaps", "opening"),
    "contact.compliance": ("compliance", "flexibility", "compliance_matrix"),
    "contact.stiffness_rows.K": ("stiffness_rows", "stiffness", "stiffness_matrix"),
    "certified": ("converged", "success", "solved", "is_solved", "optimal", "ok"),
    "words": ("words", "verdict", "message"),
    "accuracy.bars": ("error", "errors", "error_bars", "bars", "tolerance"),
    "problem.material.young_modulus": ("young_modulus",),
    "problem.material.poisson_ratio": ("poisson_ratio",),
}  # fmt: skip
"""Place of a quantity in a result -> its own name and what others call it."""
PLACE = ("point", "points", "place", "position", "positions", "location", "where", "node", "x", "y", "coordinates")
ERROR = ("error", "errors", "relative", "relative_error", "tolerance", "uncertainty", "sigma", "error_bar",
         "error_bars", "bars")  # fmt: skip
PEAK = ("value", "peak", "max", "p", "p_max", "pmax", "max_pressure", "maximum_pressure", "peak_pressure", "stress")
"""What others call a place, an error and a largest pressure."""
Words = Mapping[str, tuple[str, ...]]
"""What a part of a result has -> what others call it there."""
CLOSE = 0.8
"""Likeness of two words, from 0 to 1, from which one may be meant by the other: a slip of one or two letters."""
OF_A_RESULT = "the result of bemcontact.solve has it as"


class ByName(dict[str, Value]):
    """Values by name, all of one kind of thing; `ProblemError` for a name that is not among them."""

    def __init__(self, what: str, values: Mapping[str, Value]) -> None:
        super().__init__(values)
        self._what = what

    def __missing__(self, name: object) -> Value:
        """Refuse a name, and say which there are."""
        raise ProblemError(f"there is no {self._what} {shown(name)}; there are: {', '.join(self) or 'none'}")

    def __reduce__(self) -> tuple[type["ByName[Value]"], tuple[str, dict[str, Value]]]:
        """Copies and pickles make it of its items."""
        return type(self), (self._what, dict(self))


class WithHints:
    """Base of objects whose users look for a quantity by another name or in another place."""

    _called: ClassVar[Words] = {}
    """Words of others for what it has."""
    _home: ClassVar[str] = ""
    """Where a part of a result is itself, to which nobody is sent who has it."""


def _missing(owner: WithHints, name: str) -> Any:
    """Raise the error of an attribute that does not exist."""
    if name.startswith("_") or hasattr(type(owner), name):  # an error within a property is another one
        return object.__getattribute__(owner, name)
    raise AttributeError(f"{type(owner).__name__} has no '{name}'; {_hint(owner, name)}")


setattr(WithHints, "__getattr__", _missing)  # noqa: B010 (in the class it would tell checkers of types that all exist)


def _hint(owner: WithHints, name: str) -> str:
    """Say where a quantity is: by another name, in another place, under a similar name; else list the names."""
    for place, words in owner._called.items():
        if name.lower() in words:
            return f"use {place}"
    known = {word: place for place, words in PLACES.items() for word in words if place != owner._home}
    own = [part for part in dir(owner) if not part.startswith("_")]
    if name.lower() not in known:
        similar = difflib.get_close_matches(name.lower(), own, 1, CLOSE)
        similar = similar or difflib.get_close_matches(name.lower(), known, 1, CLOSE)
        if not similar or similar[0] in own:
            return f"did you mean '{similar[0]}'?" if similar else f"there are: {', '.join(sorted(own))}"
        name = similar[0]
    place = known[name.lower()]
    found = (*_there(owner, place), *(word for word in PLACES[place] if word in own), *_in_parts(owner, place))
    return f"use {found[0]}" if found else f"{OF_A_RESULT} {place}"


def _there(owner: object, place: str) -> Iterator[str]:
    """The place of a quantity in an object that has it, or in one of several results."""
    if _leads(owner, place.split(".")):
        yield place
    results = vars(owner).get("results")
    for case, result in results.items() if isinstance(results, Mapping) else ():
        yield from (f"results[{case!r}].{there}" for there in _there(result, place))


def _in_parts(owner: object, place: str) -> Iterator[str]:
    """The place in an object that is itself a part of a result."""
    while place := place.partition(".")[2]:
        yield from _there(owner, place)


def _leads(owner: object, parts: list[str]) -> bool:
    """Whether attributes within each other exist, as far as that can be said without computing any."""
    first, *rest = parts
    inside = getattr(owner, "__dict__", {})
    if not rest:
        return first in inside or hasattr(type(owner), first)
    return first in inside and (inside[first] is None or _leads(inside[first], rest))
