"""Penetration of rigid surfaces where there are no contact points: depth, place, and what is tolerated."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bemcontact import follow, solve, solve_cases
from bemcontact.analysis.compare import study
from bemcontact.options import ComparisonOptions
from bemcontact.problem import Problem

E, NU, SIDE = 1000.0, 0.3, 10.0


def seal(*, pressure=40.0, gap=0.02, edges=("bottom",), elements=3, turn=0.0, size=1.0, split=0.5, **more):
    """A square block between a line of symmetry and the wall of a groove, pressed from above; turned and scaled."""
    c, s = np.cos(turn), np.sin(turn)

    def at(x, y):
        return (size * (c * x - s * y), size * (s * x + c * y))

    corners = {
        "bottom": (0, 0),
        "right": (SIDE, 0),
        "upper": (SIDE, split * SIDE),
        "top": (SIDE, SIDE),
        "left": (0, SIDE),
    }
    outer = [{"name": name, "start": at(*corner), "elements": elements} for name, corner in corners.items()]
    held = {"surface": {"kind": "plane", "point": at(0, 0), "normal": (c, s)}, "edges": "left"}
    groove = {"kind": "polyline", "points": [at(-5, 0), at(SIDE + gap, 0), at(SIDE + gap, 2 * SIDE)]}
    data = {
        "name": "seal",
        "material": {"young_modulus": E, "poisson_ratio": NU},
        "boundary": {"outer": outer},
        "conditions": {"top": {"pressure": pressure}},
        "contact_zones": {"symmetry": held, "groove": {"edges": edges, "surface": groove}},
    }
    return Problem(**{**data, **more})  # pyright: ignore[reportArgumentType]


def bulge(pressure):
    """Displacement of the free side of a block under uniform pressure, plane strain."""
    return NU * (1 + NU) * pressure * SIDE / E


@settings(max_examples=25, deadline=None)
@given(st.floats(1, 60), st.floats(0.0005, 0.3), st.floats(0, 6.28), st.sampled_from([1e-3, 1.0, 1e3]))
@example(40.0, 0.02, 0.0, 1.0)
def test_depth_of_a_block_that_bulges_into_a_wall(pressure, gap, turn, size):
    """The free side bulges uniformly, in any direction and unit: the depth is the bulge less the gap."""
    problem = seal(pressure=pressure, gap=gap, turn=turn, size=size)
    c, s = np.cos(turn), np.sin(turn)
    press = {**problem.model_dump()["conditions"], "upper": {"pressure": 1e-3}, "right": {"pressure": 1e-3}}
    result = solve(problem.with_value("conditions", press), "complementarity")
    free = bulge(pressure) - (1 - NU**2) * 1e-3 * SIDE / E
    depth, allowed = free - gap, 0.01 * np.hypot(free, (1 - NU**2) * pressure * SIDE / E)
    second = (free**2 + (bulge(pressure) / NU) ** 2) / SIDE  # more than the squares over the diagonal
    if depth > allowed + second:
        assert not result.certified
        assert result.certificate.certified
        assert result.penetration is not None
        assert result.penetration.depth == pytest.approx(depth * size, rel=1e-6)
        assert result.penetration.edge in ("right", "upper")
        assert not result.penetration.paired
        x, y = result.penetration.at
        assert c * x + s * y == pytest.approx(SIDE * size, rel=1e-9)
    elif depth < 0:
        assert result.certified
        assert result.penetration is None


@pytest.mark.parametrize("edges", [("bottom", "right", "upper"), ("bottom", "right")])
def test_an_edge_that_belongs_to_the_zone_is_held(edges):
    """With the whole side in the zone the wall holds it; with half of it, the other half is in the wall still."""
    result = solve(seal(edges=edges))
    whole = len(edges) == 3
    assert result.certified is whole
    if not whole:
        assert result.penetration is not None
        assert result.penetration.edge == "upper"


@pytest.mark.parametrize("kind", ["polyline", "spline"])
def test_a_bump_between_two_nodes_is_found(kind):
    """The nodes stand on the floor, under uniform pressure, and do not see the bump; finer ones beside its top do.

    The top of the polyline is sharp, so that what is left there falls with the length of the elements alone.
    """
    points = [(-1.0, 0.0), (5.2, 0.0), (5.6, 0.1), (6.0, 0.0), (11.0, 0.0)]
    zones = {"floor": {"edges": "bottom", "surface": {"kind": kind, "points": points}}}
    zones["symmetry"] = seal().contact_zones["symmetry"]
    problem = seal(elements=4, pressure=5.0, contact_zones=zones)
    result = solve(problem)
    assert result.certificate.certified
    assert not result.certified
    assert result.penetration is not None
    assert result.penetration.paired
    assert result.penetration.edge == "bottom"
    assert result.penetration.at == pytest.approx((5.6, 0.0), abs=0.2)
    if kind == "polyline":
        assert result.solution.pressure[result.contact.zone == 0] == pytest.approx(5.0, rel=1e-9)
        assert 0.8 * 0.1 < result.penetration.depth <= 0.1
    seen = solve(problem.with_value("boundary.outer.bottom.ends_at", [0.52, 0.56, 0.6]).refined(8))
    assert seen.certified or (kind == "polyline" and seen.penetration.depth < 0.1 * result.penetration.depth)


def test_load_cases_compare_and_paths_say_it():
    problem = seal(pressure=0.5, load_cases={"small": {"conditions": {"top": {"pressure": 1}}},
                               "large": {"conditions": {"top": {"pressure": 40}}}})  # fmt: skip
    cases = solve_cases(problem)
    assert [item.certified for item in cases.results.values()] == [True, False]
    assert not cases.certified
    compared = study(ComparisonOptions.of("qp3", "tributary", None), problem.with_case("large"), (1, 2))
    assert compared.finest.comparison.certified
    assert not compared.certified
    assert compared.heading == "NOT certified"
    assert "penetrates" in compared.verdict
    record = compared.to_dict()
    assert record["certified"] is False
    assert record["levels"][0]["penetration"]["edge"] in ("right", "upper")


@pytest.mark.parametrize(
    ("key", "start", "end", "pressure"),
    [
        ("conditions.top.pressure", 0.5, 40.0, 40.0),
        ("load_cases.more", 0.0, 2.0, 40.0),
        ("load_cases.more", 0.1, 0.4, 8.0),
    ],
)
def test_the_end_of_a_path_penetrates_as_the_solution_there(key, start, end, pressure):
    problem = seal(pressure=0.5, gap=0.05, load_cases={"more": {"conditions": {"top": {"pressure": 19.75}}}},
                   combinations={"none": {"more": 0}}, case="none")  # fmt: skip
    path = follow(problem, key, end, start)
    there = solve(problem.with_value(key, end) if "top" in key else problem.with_factors({"more": end}))
    assert path.certified == there.certified
    if bulge(pressure) > 0.06:
        assert path.penetration is not None
        assert there.penetration is not None
        assert path.penetrates_at == end
        assert path.penetration.depth == pytest.approx(there.penetration.depth, rel=1e-9)


def test_what_lies_behind_a_surface_is_noted_and_what_is_flush_is_left_out():
    """The floor as a plane goes on below the body; a block with a foot reaches behind it."""
    outer = [(0, 0), (4, 0), (4, -2), (8, -2), (8, 6), (0, 6)]
    names = ["sole", "step", "under", "right", "top", "left"]
    data = {
        "name": "foot",
        "material": {"young_modulus": E, "poisson_ratio": NU},
        "boundary": {"outer": [{"name": n, "start": at, "elements": 4} for n, at in zip(names, outer, strict=True)]},
        "conditions": {"top": {"pressure": 1}, "left": {"displacement": {"x": 0, "y": 0}}},
        "contact_zones": {"floor": {"edges": "sole", "surface": {"kind": "plane", "point": (0, 0), "normal": (0, 1)}}},
    }
    result = solve(Problem(**data))  # pyright: ignore[reportArgumentType]
    assert result.certified
    (note,) = [note for note in result.notes if "behind the rigid surface of 'floor'" in note]
    assert "'right', 'step', 'under'" in note


@pytest.mark.parametrize("middle", ["mid", "low"])
def test_a_forgotten_edge_between_two_of_a_zone_is_a_penetration(middle):
    """A plate on a wall under pressure: the edge between sinks in, and the lowest one, beside the zone, is noted."""
    corners = {"up": (0, 100), "mid": (0, 80), "low": (0, 20), "bottom": (0, 0), "right": (5, 0), "top": (5, 100)}
    edges = [name for name in ("up", "mid", "low") if name != middle]
    data = {
        "name": "plate",
        "material": {"young_modulus": E, "poisson_ratio": NU},
        "boundary": {"outer": [{"name": name, "start": at, "elements": 8} for name, at in corners.items()]},
        "conditions": {"right": {"pressure": 1}},
        "contact_zones": {"wall": {"edges": edges, "surface": {"kind": "plane", "point": (0, 0), "normal": (1, 0)}}},
    }
    result = solve(Problem(**data))  # pyright: ignore[reportArgumentType]
    assert result.certificate.certified
    if middle == "mid":
        assert not result.certified
        assert result.penetration.edge == "mid"
        assert not result.penetration.paired
    else:
        assert result.certified
        assert any("'low' lies in the rigid surface of 'wall'" in note for note in result.notes)
    whole = solve(Problem(**data).with_value("contact_zones.wall.edges", ["up", "mid", "low"]))  # pyright: ignore[reportArgumentType]
    assert whole.certified
    assert not any("lies in" in note for note in whole.notes)
