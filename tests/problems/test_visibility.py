"""Which edges can see a surface: turned to it, and nothing of the body in the way."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from messages import assert_states

from bemcontact.errors import ProblemError
from bemcontact.problems import Plane, Problem
from bemcontact.problems.boundary import Boundary
from bemcontact.problems.rigid_surface import Circle
from bemcontact.problems.visibility import edges_that_see

CHANNEL = {"under": (0, 0), "right": (4, 0), "rim": (4, 3), "inner right": (3, 3), "bed": (3, 1), "inner left": (1, 1),
           "other rim": (1, 3), "left": (0, 3)}  # fmt: skip
"""Corners of a channel that is open above, and the edges that begin there."""
PIPE = {"name": "pipe", "kind": "arc", "center": [2, 0.5], "radius": 0.2, "angles": [360, 0]}


def channel(turn=0.0, scale=1.0, mirrored=False):
    """Boundary of the channel with a hole, and the map of its points."""
    c, s, m = np.cos(turn), np.sin(turn), -1.0 if mirrored else 1.0

    def at(x, y):
        return scale * (c * m * x - s * y) + 7.0, scale * (s * m * x + c * y) - 3.0

    names, corners = [*CHANNEL], [*CHANNEL.values()]
    if mirrored:  # the body is on the left again: an edge now starts where it ended
        names, corners = names[::-1], [*np.roll(corners, -1, axis=0)[::-1].tolist()]
    outer = [{"name": name, "start": at(*corner)} for name, corner in zip(names, corners, strict=True)]
    hole = PIPE | {"center": at(*PIPE["center"]), "radius": scale * PIPE["radius"]}
    return Boundary(outer=outer, holes=[[hole]]), at  # pyright: ignore[reportArgumentType]


def plane(at, point, normal):
    start, tip = np.array(at(*point)), np.array(at(*np.add(point, normal)))
    return Plane(point=tuple(start.tolist()), normal=tuple((tip - start).tolist()))


@settings(max_examples=30, deadline=None)
@given(st.floats(-3, 3), st.sampled_from([1e-6, 1.0, 1e6]), st.booleans())
def test_a_channel_sees_what_is_before_it(turn, scale, mirrored):
    """In any position, size and orientation: what is written down by hand for one drawing."""
    boundary, at = channel(turn, scale, mirrored)
    seen = {
        ((2, -0.1), (0, 1)): {"under"},  # the wall of the hole is behind "under"
        ((2, 3.5), (0, -1)): {"rim", "bed", "other rim"},
        ((4, 0), (-1, 0)): {"right"},  # the inner side is behind the right flange
        ((4.5, 0), (-1, 1)): {"under", "right"},  # the bed and the inner left side are hidden
    }
    for where, names in seen.items():
        assert {*edges_that_see(boundary.edges, plane(at, *where))} == names
    ball = Circle(center=at(2, 1.5), radius=0.3 * scale, body="outside")
    assert {*edges_that_see(boundary.edges, ball)} == {"bed", "inner left", "inner right"}
    pin = Circle(center=at(2, 0.5), radius=0.19 * scale, body="outside")
    assert "pipe" in edges_that_see(boundary.edges, pin)


def problem(zones, conditions=None):
    boundary, _ = channel()
    return Problem(
        name="channel",
        material={"young_modulus": 1000.0, "poisson_ratio": 0.3},  # pyright: ignore[reportArgumentType]
        boundary=boundary,
        conditions=conditions or {},
        contact_zones=zones,
        loads={"gravity": {"density": 1, "acceleration": [0, -1]}},  # pyright: ignore[reportArgumentType]
    )


FLOOR = {"kind": "plane", "point": [0, -3], "normal": [0, 1]}


@pytest.mark.parametrize("zone", [{}, {"edges": "all"}, {"edges": None}])
def test_a_zone_without_names_has_the_edges_that_see_its_surface(zone):
    its = problem({"floor": {**zone, "surface": FLOOR}})
    assert its.edges_of("floor") == ("under",)
    assert problem(its.model_dump()["contact_zones"]).edges_of("floor") == ("under",)
    assert its.with_value("contact_zones.floor.surface.point", [0, -3.5]).edges_of("floor") == ("under",)


@pytest.mark.parametrize(
    ("zones", "conditions", "facts"),
    [
        ({"floor": {"surface": FLOOR | {"normal": [0, -1]}}}, {}, "contact_zones.floor.surface: … no edge … direction"),
        (
            {"floor": {"surface": FLOOR}},
            {"under": {"pressure": 1}},
            "contact_zones.floor.surface: only 'under' can see … condition",
        ),
        (
            {"floor": {"edges": ["under", "rim"], "surface": FLOOR},
             "lid": {"edges": "rim", "surface": FLOOR | {"point": [0, 0], "normal": [0, -1]}}},
            {},
            "contact_zones.floor.edges[1]: … 'rim' … turned nowhere",
        ),
        (
            {"floor": {"surface": FLOOR}, "ground": {"surface": FLOOR}},
            {},
            "contact_zones.ground.surface: … 'floor' … same surface … 'under'",
        ),
        (
            {"floor": {"surface": {"kind": "deflected_contour", "direction": [0, 1], "loads": {"gravity": {
                "density": 1, "acceleration": [0, -1]}}}}},
            {},
            "contact_zones.floor: … deflected contour … names",
        ),
    ],
)  # fmt: skip
def test_zones_that_no_edge_can_touch_are_refused(zones, conditions, facts):
    with pytest.raises(ProblemError) as caught:
        problem(zones, conditions)
    assert_states(str(caught.value), facts)


@pytest.mark.parametrize("first", [-90, 0, 91, 180])
@pytest.mark.parametrize("drawn", [0.0, 3.0])
def test_a_wheel_sees_a_narrow_rail_wherever_its_circle_begins(first: float, drawn: float):
    """The rail is a tenth as wide as the places of the circle are apart; the bore is behind the rim."""
    steel = {"young_modulus": 1000.0, "poisson_ratio": 0.3}
    rim = {"name": "rim", "kind": "arc", "center": [0, 100 + drawn], "radius": 100, "angles": [first, first + 360]}
    bore = {"name": "bore", "kind": "arc", "center": [0, 100 + drawn], "radius": 40, "angles": [360, 0]}
    foot = {"name": "foot", "start": [-1, -5], "end": [1, -5]}
    rail = [foot, {"name": "right", "end": [1, 0]}, {"name": "head", "end": [-1, 0]}, {"name": "left"}]
    its = Problem(
        name="wheel on a rail",
        bodies={  # pyright: ignore[reportArgumentType]
            "wheel": {"material": steel, "boundary": {"outer": [rim], "holes": [[bore]]}},
            "rail": {"material": steel, "boundary": {"outer": rail}, "conditions": {"foot": {"fixed": True}}},
        },
        contacts={"track": {"between": ["wheel", "rail/head"]}},  # pyright: ignore[reportArgumentType]
    )
    assert its.edges_of("track") == ("wheel/rim",)
