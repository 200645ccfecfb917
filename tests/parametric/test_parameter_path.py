"""A load path in the values of its parameter: states, tables, numbers."""

import csv
import io
import json
from dataclasses import replace

import numpy as np
import pytest
from contact_states import half_plane, rocker

from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.parametric.parameter_path import BETWEEN, ParameterPath
from bemcontact.parametric.path import LoadPath, load_path

NO_MESH = Accuracy(asked=None, reason="no mesh is known")


def path_of(key: str, start: float, end: float, path: LoadPath) -> ParameterPath:
    return ParameterPath(key=key, start=start, end=end, path=path, start_accuracy=NO_MESH, end_accuracy=NO_MESH)


def pressed_parabola() -> ParameterPath:
    return path_of("load", 0.0, -8.0, load_path(half_plane(21, 0.0), half_plane(21, 0.2)))


def crossing(start: float, end: float) -> ParameterPath:
    return path_of("place", start, end, load_path(rocker(start), rocker(end)))


def test_states_are_breakpoints_and_three_between_each_two():
    result = pressed_parabola()
    breakpoints = [state.breakpoint for state in result.states]
    assert breakpoints == [True, *([False] * len(BETWEEN) + [True]) * (len(result.breakpoints) - 1)]
    np.testing.assert_allclose([state.value for state in result.breakpoints], -8 * result.path.parameter, atol=1e-14)
    assert result.certified


def test_peaks_between_breakpoints_are_those_of_the_line():
    """Pressures are linear between breakpoints, and here the middle bears the peak: so is the peak."""
    result = pressed_parabola()
    values, peaks = ([getattr(state, name) for state in result.breakpoints] for name in ("value", "peak"))
    for state in result.states:
        assert state.peak == pytest.approx(np.interp(-state.value, -np.array(values), peaks), abs=1e-13)


def test_resultant_is_the_load():
    """Equilibrium: the rigid plane carries 0.2 at t = 1, and in proportion before."""
    for state in pressed_parabola().states:
        assert state.resultant[0] == pytest.approx((0.0, -state.value / 40), abs=1e-14)


def test_moment_is_that_of_the_load_about_the_origin():
    """By symmetry the force acts at point 10, which is at (10, 0)."""
    for state in pressed_parabola().states:
        assert state.moments == pytest.approx([10 * state.resultant[0][1]], abs=1e-12)


def test_table_has_a_row_for_each_state():
    result = pressed_parabola()
    head, *rows = csv.reader(io.StringIO(result.to_csv()))
    assert head == [
        "load", "breakpoint", "enter", "leave", "peak", "peak error", "peak x", "peak y",
        "contact resultant x", "contact resultant y", "contact moment", "contact starts", "contact ends",
        "nodes in contact",
    ]  # fmt: skip
    assert [float(row[0]) for row in rows] == [state.value for state in result.states]
    last = rows[-1]
    assert last[6:8] == ["10.0", "0.0"]
    assert [int(i) for i in last[-1].split()] == list(result.states[-1].touching)
    assert float(last[12]) + float(last[11]) == pytest.approx(20, abs=1e-9)  # symmetry about point 10
    entering = next(row for row in rows if row[2])
    assert entering[2] == "9 11"


def test_numbers_are_json():
    record = json.loads(crossing(-0.5, 1.5).to_json())
    assert not record["certified"]
    assert record["reaches"] == pytest.approx([-0.5, 1.0])
    assert record["notes"][0].startswith(
        "the path exists up to 1; beyond that, the load pulls the body off its support"
    )
    assert [state["left"] for state in record["states"] if state["breakpoint"]] == [[], [0], [], []]


def test_round_off_of_a_parameter_is_zero():
    """From 0.3 to -0.1 the value 0 is at t = 3/4, where round-off leaves 3e-17."""
    assert path_of("x", 0.3, -0.1, pressed_parabola().path).value(0.75) == 0.0


def test_accuracies_of_both_ends_are_json():
    record = json.loads(crossing(-0.5, 1.5).to_json())
    assert record["start_accuracy"]["reason"] == record["end_accuracy"]["reason"] == "no mesh is known"


def test_an_infinite_peak_at_one_end_is_stated_nowhere_on_the_path():
    bar = ErrorBar(quantity="peak", zone="contact", value=None, bar=None, note="infinite at a corner")
    result = replace(pressed_parabola(), end_accuracy=Accuracy(asked=0.01, met=True, passes=3, bars=(bar,)))
    assert {(state.peak, state.at, state.footprint.peak) for state in result.states} == {(None, None, None)}
    head, *rows = csv.reader(io.StringIO(result.to_csv()))
    assert {row[i] for row in rows for i, name in enumerate(head) if name.startswith("peak")} == {""}
