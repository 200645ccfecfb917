"""Problems with load cases and with tools, for the tests of several rooms."""

from copy import deepcopy
from dataclasses import replace
from typing import Any

import numpy as np

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.problems import Problem

Spec = dict[str, Any]

FLOOR = {"kind": "plane", "point": [0, 0], "normal": [0, 1]}
ROOF = {"kind": "plane", "point": [0, 1], "normal": [0, -1]}


def made(spec: Spec, **more: Any) -> Problem:
    """The problem of a spec, with some of its parts replaced or added; errors are not assessed unless it says so."""
    return Problem(**deepcopy({"accuracy": None, **spec, **more}))


HELD: Spec = {
    "name": "held block",
    "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
    "boundary": {
        "outer": [
            {"name": "foot", "start": [0, 0], "elements": 6},
            {"name": "right", "start": [2, 0], "elements": 3},
            {"name": "head", "start": [2, 1], "elements": 4},
            {"name": "top", "start": [1, 1], "elements": 3},
            {"name": "left", "start": [0, 1], "elements": 3},
        ]
    },
    "conditions": {
        "left": {"displacement": {"x": 0.001, "y": {"constant": 0, "y": 0.0005}}},
        "right": {"pressure": 2},
    },
    "loads": {"gravity": {"density": 1, "acceleration": [0, -3]}},
    "contact_zones": {
        "table": {"edges": "foot", "surface": {"kind": "circle", "center": [1.2, -6], "radius": 6, "body": "outside"}},
        "punch": {"edges": "head", "surface": {"kind": "circle", "center": [1.6, 7], "radius": 6, "body": "outside"}},
    },
    "tools": {
        "punch": {"zones": "punch", "point": [1.5, 1], "force": {"y": -40, "moment": 3}},
        "table": {"zones": "table", "point": [0, 0], "displacement": {"y": 0.002, "rotation": 0.001}},
    },
}
"""A block whose left side is held, between a round punch that is loaded and may tilt and a displaced round table."""

HELD_CASES: Spec = {
    "load_cases": {
        "wind": {"conditions": {"right": {"traction": {"x": 1, "y": -2}}, "top": {"pressure": 1.5}}},
        "heat": {"loads": {"temperature": {"expansion": 1e-5, "change": {"constant": 20, "y": 30}}}},
        "settle": {
            "conditions": {"left": {"displacement": {"y": -0.002}}},
            "tools": {"table": {"displacement": {"y": 0.001}}},
        },
        "spin": {"loads": {"centrifugal": {"density": 0.5, "angular_velocity": 2, "center": [0, 0]}}},
        "push": {
            "tools": {"punch": {"force": {"y": -30, "moment": -4}}, "table": {"displacement": {"rotation": -5e-4}}}
        },
    },
    "combinations": {"all": {"wind": 1.5, "heat": -0.5, "settle": 2, "spin": 4, "push": 0.7}},
}
HELD_BY_HAND: Spec = {
    "conditions": {
        "left": {"displacement": {"x": 0.001, "y": {"constant": -0.004, "y": 0.0005}}},
        "right": {"traction": {"x": -0.5, "y": -3}},
        "top": {"pressure": 2.25},
    },
    "loads": {
        "gravity": {"density": 1, "acceleration": [0, -3]},
        "temperature": {"expansion": 1e-5, "change": {"constant": -10, "y": -15}},
        "centrifugal": {"density": 0.5, "angular_velocity": 4, "center": [0, 0]},
    },
    "tools": {
        "punch": {"zones": "punch", "point": [1.5, 1], "force": {"y": -61, "moment": 0.2}},
        "table": {"zones": "table", "point": [0, 0], "displacement": {"y": 0.004, "rotation": 0.00065}},
    },
}
"""What `HELD` and its combination are together; centrifugal forces go with the square of the speed."""

FREE: Spec = {
    **HELD,
    "name": "free block",
    "conditions": {},
    "loads": {"gravity": {"density": 1, "acceleration": [0, -3]}},
    "contact_zones": {"table": {"edges": "foot", "surface": FLOOR}, "punch": {"edges": "head", "surface": ROOF}},
    "tools": {"punch": {"zones": "punch", "point": [1.5, 1], "force": {"y": -40, "moment": 3}}},
}
"""The same block held by nothing: on a flat table, under a flat punch."""

FREE_CASES: Spec = {
    "load_cases": {
        "wind": {
            "conditions": {"top": {"pressure": 4}, "left": {"traction": {"x": 1}}, "right": {"traction": {"x": -1}}}
        },
        "heat": {"loads": {"temperature": {"expansion": 1e-5, "change": {"constant": 20, "y": 30}}}},
        "push": {"tools": {"punch": {"force": {"y": -30, "moment": -4}}}},
    },
    "combinations": {"all": {"wind": 1.5, "heat": 3, "push": 0.5}},
}
FREE_BY_HAND: Spec = {
    "conditions": {"top": {"pressure": 6}, "left": {"traction": {"x": 1.5}}, "right": {"traction": {"x": -1.5}}},
    "loads": {
        "gravity": {"density": 1, "acceleration": [0, -3]},
        "temperature": {"expansion": 1e-5, "change": {"constant": 60, "y": 90}},
    },
    "tools": {"punch": {"zones": "punch", "point": [1.5, 1], "force": {"y": -55, "moment": 1}}},
}

ROLLER: Spec = {
    "name": "roller",
    "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
    "boundary": {
        "outer": [
            {"name": "right flank", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [-68, -38], "elements": 8},
            {"name": "right", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [-38, 75], "elements": 5},
            {"name": "head", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [75, 105], "elements": 8},
            {"name": "left", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [105, 218], "elements": 5},
            {"name": "left flank", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [218, 248], "elements": 8},
            {"name": "below", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [248, 292], "elements": 3},
        ]
    },
    "contact_zones": {
        "left flank": {"edges": "left flank", "surface": {"kind": "plane", "point": [-0.6, -0.8], "normal": [3, 4]}},
        "right flank": {"edges": "right flank", "surface": {"kind": "plane", "point": [0.6, -0.8], "normal": [-3, 4]}},
        "plate": {"edges": "head", "surface": ROOF},
    },
}
"""An elastic disc in a V-block with flanks of 4 in 3, under a plate; nothing else holds it."""

WEDGE: Spec = {
    "name": "polygon in a groove that moves",
    "material": {"young_modulus": 1000, "poisson_ratio": 0.3},
    "boundary": {
        "outer": [
            {"name": "lower right", "start": [0, 0], "elements": 5},
            {"name": "right", "start": [2, 1.52], "elements": 3},
            {"name": "top", "start": [2, 3], "elements": 4},
            {"name": "left", "start": [-2, 3], "elements": 3},
            {"name": "lower left", "start": [-2, 1.48], "elements": 5},
        ]
    },
    "conditions": {"top": {"displacement": {"x": 0, "y": 0}}},
    "contact_zones": {
        "right flank": {"edges": "lower right", "surface": {"kind": "plane", "point": [0, -0.05], "normal": [-3, 4]}},
        "left flank": {"edges": "lower left", "surface": {"kind": "plane", "point": [0, -0.05], "normal": [3, 4]}},
    },
    "tools": {
        "groove": {
            "zones": ["right flank", "left flank"], "point": [0, 0], "force": {"x": 6, "y": 40, "moment": -8},
        }
    },
}  # fmt: skip
"""A held polygon, pressed from below by a groove that is free to move along both axes and to turn."""


def displaced(problem: Problem, name: str, position: np.ndarray) -> Problem:
    """The problem with a tool that goes where a solution found it, and has no force."""
    tool = problem.model_dump()["tools"][name]
    moves = dict(zip(("x", "y", "rotation"), map(float, position), strict=True))
    return problem.with_value(
        f"tools.{name}", {"zones": tool["zones"], "point": tool["point"] or [0, 0], "displacement": moves}
    )


BETWEEN: Spec = {**FREE, "loads": {}, "contact_zones": {"table": FREE["contact_zones"]["table"], "press": {
    "edges": ["head", "top"], "surface": FREE["contact_zones"]["punch"]["surface"]}}}  # fmt: skip
"""The free block between a table and a press, both as wide as it is."""


def of_peaks(result: Result, error: float | None, asked: float | None = None) -> Accuracy:
    """The accuracy of a result whose peaks, by zone, all have this error; none is infinite."""
    contact, pressure = result.contact, result.solution.pressure
    peaks = {name: pressure[contact.zone == number].max() for number, name in enumerate(contact.zone_names)}
    bars = [ErrorBar(quantity="peak", zone=name, value=float(value), bar=error) for name, value in peaks.items()]
    return Accuracy(asked=None, bars=tuple(bars)) if asked is None else Accuracy.of(asked, 1, bars)


def not_met(cases: CaseResults) -> CaseResults:
    """Results of load cases whose peaks are all off by 5 % at most, where 1 % was asked."""
    return replace(
        cases, results={k: replace(it, accuracy=of_peaks(it, 0.05, 0.01)) for k, it in cases.results.items()}
    )
