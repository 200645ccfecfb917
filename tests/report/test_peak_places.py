"""All places of the largest pressure are named, and no others: hills between which the pressure falls."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bemcontact
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import facts
from bemcontact.report.peak_places import LEVEL, equal_peaks

HEIGHTS = st.lists(st.tuples(st.sampled_from([1.0, 0.9996, 0.98, 0.5]), st.integers(1, 3)), min_size=1, max_size=6)


def record(pressure: list[float], closed: bool = False, zones: int = 1) -> dict[str, object]:
    """Points at distance one along a line, or around a polygon."""
    n = len(pressure)
    turn = 2 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(turn), np.sin(turn)]) / (2 * np.sin(np.pi / n)) if n > 1 else np.zeros((1, 2))
    nodes = ring if closed else np.column_stack([np.arange(n), np.zeros(n)])
    zone = [f"z{i * zones // n}" for i in range(n)]
    return {
        "pressure": pressure, "nodes": nodes.tolist(), "zone": zone, "run": [int(name[1:]) for name in zone],
        "arc_position": [float(i) for i in range(n)], "tributary_lengths": [1.0 if closed else 0.4] * n,
    }  # fmt: skip


@given(hills=HEIGHTS, turn=st.integers(0, 20), closed=st.booleans(), error=st.sampled_from([0.0, 0.01]))
def test_each_hill_as_high_as_the_largest_is_named_once(hills, turn: int, closed: bool, error: float):
    """Flat hills of some points with valleys of zero: around a closed run, wherever its seam is."""
    pressure = [height for height, width in hills for height in [height] * width + [0.0]]
    pressure = [*np.roll(pressure, turn)] if closed and len(pressure) > 4 else pressure
    closed = closed and len(pressure) > 4
    highest = max(height for height, _ in hills)
    expected = sum(height >= (1 - max(error, LEVEL)) * highest for height, _ in hills)
    found = equal_peaks(record(pressure, closed), error)
    assert len(found) == expected
    assert all(pressure[i] >= (1 - max(error, LEVEL)) * highest for i in found)


@pytest.mark.parametrize(("dip", "count"), [(0.999, 1), (0.985, 1), (0.97, 2)])
def test_a_dip_within_twice_the_error_does_not_divide_a_hill(dip: float, count: int):
    assert len(equal_peaks(record([0.5, 1.0, dip, 1.0, 0.5]), 0.01)) == count


def place(edges: dict[str, float], **zones: object) -> str:
    """What is said of the peak of a block on a floor, its lower side divided at x into edges."""
    below = [{"name": name, "start": [x, 0]} for name, x in edges.items()]
    rest = [
        {"name": "right", "start": [20, 0]},
        {"name": "top", "start": [20, 20]},
        {"name": "left", "start": [-20, 20]},
    ]
    problem = bemcontact.Problem.model_validate({
        "name": "block", "units": {"length": "mm", "force": "N"},
        "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
        "boundary": {"outer": [*below, *rest]}, "conditions": {"top": {"pressure": 3}}, "contact_zones": zones,
    })  # fmt: skip
    result = bemcontact.solve(problem)
    (words,) = (words for name, words in facts(result.to_dict(), units_of(result.contact)) if name == "Peak pressure")
    return words


def test_both_sides_of_a_symmetric_body_are_named():
    """A block on two rods, and on two halves of a floor, where the pressure is the same at all points."""
    rods = {name: {"edges": name, "surface": {"kind": "circle", "center": [x, -5], "radius": 5, "body": "outside"}}
            for name, x in (("first", -10), ("second", 10))}  # fmt: skip
    found = re.search(
        r"at \((\S+), 0\) mm and \((\S+), 0\) mm, equal within", place({"first": -20, "second": 0}, **rods)
    )
    assert found is not None
    assert [float(x) for x in found.groups()] == pytest.approx([-10, 10], abs=0.01)
    floor = {name: {"edges": name, "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}
             for name in ("first", "second")}  # fmt: skip
    assert " all along first and all along second, equal within " in place({"first": -20, "second": 0}, **floor)
