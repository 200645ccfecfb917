"""Points of contact: one for each face of the surface that holds a node; element lengths along the boundary."""

import numpy as np
import pytest
from bodies import arc, even, mesh_of
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bemcontact import solve
from bemcontact.bem.body import body_of
from bemcontact.bem.contact_points import element_lengths
from bemcontact.problem import Problem

PRESSURE = 3.0
FILLED = {"temperature": {"expansion": 1e-5, "change": (1 - 2 * 0.3) * PRESSURE / 1000.0 / 1e-5}}
"""The heat that gives a body back the size that the pressure takes: E α ΔT = (1 - 2 ν) p in plane strain."""


def outline(angles, radii, elements=2):
    """Corners of a star-shaped body, counterclockwise, and its edges by number."""
    angles = np.cumsum(angles) / np.sum(angles) * 2 * np.pi
    corners = np.column_stack([np.cos(angles), np.sin(angles)]) * np.array(radii)[:, None]
    return [{"name": f"e{i}", "start": tuple(at), "elements": elements} for i, at in enumerate(corners.tolist())]


def problem_of(edges, zones, loaded=PRESSURE, **more):
    """Press a body on all edges that are in no zone; `zones` has edge names and points of a polyline by name."""
    held = {name for names, _ in zones.values() for name in names}
    return Problem(
        name="corners",
        material={"young_modulus": 1000.0, "poisson_ratio": 0.3},  # pyright: ignore[reportArgumentType]
        boundary={"outer": edges},  # pyright: ignore[reportArgumentType]
        conditions={edge["name"]: {"pressure": loaded} for edge in edges if edge["name"] not in held},  # pyright: ignore
        contact_zones={
            name: {"edges": names, "surface": {"kind": "polyline", "points": points}}
            for name, (names, points) in zones.items()
        },  # pyright: ignore[reportArgumentType]
        **more,
    )


@settings(max_examples=40, deadline=None)
@given(
    angles=st.lists(st.floats(0.6, 1.4), min_size=6, max_size=6),
    radii=st.lists(st.floats(0.5, 1.5), min_size=6, max_size=6),
    faces=st.integers(1, 3),
    shift=st.tuples(st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3)),
    apart=st.booleans(),
)
@example(angles=[1.0] * 6, radii=[1.0, 0.6, 1.0, 1.0, 1.0, 1.0], faces=2, shift=(0.0, 0.0), apart=False)
@example(angles=[1.0] * 6, radii=[1.0, 0.4, 1.0, 1.0, 1.0, 1.0], faces=3, shift=(1e-3, 2e-3), apart=True)
def test_pressure_of_a_fluid_on_faces_that_fit_the_body(angles, radii, faces, shift, apart):
    """Equal pressure from all sides of a heated body moves nothing: an exact state, at any angle between the faces.

    Faces that the shift moves off the body, or into it, do not change it: the body follows.
    """
    edges = outline(angles, radii)
    names = [f"e{i}" for i in range(faces)]
    points = [tuple(np.add(edges[i]["start"], shift)) for i in range(faces + 1)]
    zones = {name: ((name,), points) for name in names} if apart else {"all": (names, points)}
    problem = problem_of(edges, zones, loads=FILLED)
    assert len(body_of(problem).points) == sum(2 * 2 + 1 for _ in names)
    result = solve(problem, "complementarity")
    assert result.solution.pressure == pytest.approx(PRESSURE, rel=1e-8)
    assert len(result.footprint.intervals) == faces
    for interval, name in zip(result.footprint.intervals, names, strict=True):
        edge = int(name[1:])
        assert interval.start == pytest.approx(edges[edge]["start"], abs=1e-12)
        assert interval.end == pytest.approx(edges[edge + 1]["start"], abs=1e-12)


def test_element_lengths_are_arc_lengths():
    """A circle of 64 elements: the parabola is shorter than the arc by less than (angle)^4/480, relative."""
    mesh = mesh_of([("c", arc((0, 0), 2, 0, 360), even(64))])
    exact = 2 * np.pi / 32
    assert abs(element_lengths(mesh) / exact - 1).max() < (2 * np.pi / 64) ** 4 / 480
