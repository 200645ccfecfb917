"""Paths and sensitivities by the key paths of a spec."""

import re
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from debonds import halves
from tool_problems import BETWEEN, made

import bemcontact
from bemcontact.adaptivity.adapt import meshed
from bemcontact.analysis.compare import mesh_study
from bemcontact.analysis.follow import between, follow, sensitivities, stated_value
from bemcontact.analysis.solve import condense
from bemcontact.analysis.variation import Variation
from bemcontact.bem.body import Body
from bemcontact.bem.condense import Condensation
from bemcontact.bem.condense import condense as condense_body
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.options import ComparisonOptions, FormulationName
from bemcontact.problems import Problem

MODELS = Path(__file__).parents[2] / "models"
PRESSURE = "conditions.top.pressure"


@pytest.fixture(scope="module")
def cylinder() -> Problem:
    return bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh")


@pytest.fixture(scope="module")
def cantilever() -> Problem:
    return bemcontact.load(MODELS / "cantilever_flat_surface.yaml", variant="stated mesh")


def apart(one: CondensedContact, other: CondensedContact, pressure: np.ndarray) -> float:
    expected = complementarity.solve(other).pressure
    return float(np.abs(pressure - expected).max() / expected.max())


@pytest.mark.parametrize(
    ("key", "to", "start"),
    [
        ("conditions.top.traction.y", -3.0, -2.0),
        ("contact_zones.ground.surface.point[1]", -1.0, -1.5),
        ("conditions.clamp.displacement.y", 0.4, -0.4),
    ],
)
def test_states_of_a_path_are_those_of_the_problem_itself(cantilever: Problem, key: str, to: float, start: float):
    """Loads, rigid surfaces and prescribed displacements; problems condensed and solved anew agree to 1e-9."""
    found = follow(cantilever, key, to, start=start)
    assert found.certified
    for t in (0.0, 0.3, 0.7, 1.0):
        problem = bemcontact.condense(cantilever.with_value(key, found.value(t)))
        assert apart(found.path.contact(t), problem, found.path.at(t).pressure) <= 1e-9


@pytest.mark.parametrize("factor", [1.0, 0.5])
def test_a_value_in_a_load_case_is_followed(cylinder: Problem, factor: float):
    """The load of the case changes, not its factor; the state in the middle is that of a solve, and so is its peak."""
    acting = cylinder.with_value("load_cases", {"press": {"conditions": {"top": {"pressure": 5.0}}}})
    acting = acting.with_value("accuracy", None).with_factors({"press": factor})
    key = "load_cases.press.conditions.top.pressure"
    found = follow(acting, key, 15.0)
    assert found.path.complete
    for t in (0.0, 0.5, 1.0):
        other = condense(acting.with_value(key, found.value(t)))
        assert apart(found.path.contact(t), other, found.path.at(t).pressure) < 1e-9
        assert found.path.contact(t).cases.factors == pytest.approx([factor])
        np.testing.assert_allclose(found.path.contact(t).cases.motion_load, other.cases.motion_load, rtol=1e-12)


def test_a_path_between_two_factors_of_two_load_cases_has_permanent_loads(cylinder: Problem):
    """Load and factor both differ, so that neither alone describes the states between."""
    acting = cylinder.with_value("load_cases", {"press": {"conditions": {"top": {"pressure": 5.0}}}})
    acting = acting.with_value("accuracy", None)
    other = acting.with_value("load_cases.press.conditions.top.pressure", 10.0)
    ends = [condense(acting.with_factors({"press": 1.0})), condense(other.with_factors({"press": 2.0}))]
    found = bemcontact.load_path(*ends)
    middle = condense(acting.with_factors({"press": 2.5}))  # the load is 5 at the start and 20 at the end
    assert apart(found.contact(0.5), middle, found.at(0.5).pressure) < 1e-9
    assert not len(found.contact(0.5).cases)


def test_gravity_is_a_parameter(cylinder: Problem):
    heavy = cylinder.with_value("loads.gravity", {"density": 0.01, "acceleration": [0, -1.0]})
    found = follow(heavy, "loads.gravity.acceleration[1]", -10.0)
    assert (found.start, found.certified) == (-1.0, True)
    problem = bemcontact.condense(heavy.with_value("loads.gravity.acceleration[1]", -4.0))
    assert apart(problem, problem, found.path.at(1 / 3).pressure) <= 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("backwards", [False, True])
def test_free_body_without_load_is_found_from_the_other_end(cylinder: Problem, backwards: bool):
    """Nothing presses the cylinder at 0, and it cannot be condensed; by linearity the load there is zero exactly."""
    to, start = (0.0, None) if backwards else (50.625, 0.0)
    found = follow(cylinder, PRESSURE, to, start=start)
    assert found.certified
    empty = found.breakpoints[-1 if backwards else 0]
    assert (empty.value, empty.peak, empty.resultant) == (0.0, 0.0, ((0.0, 0.0),))
    problem = bemcontact.condense(cylinder.with_value(PRESSURE, 20.25))
    t = 1 - 0.4 if backwards else 0.4
    assert apart(problem, problem, found.path.at(t).pressure) <= 1e-9


@pytest.mark.parametrize("end", [20.25, 50.625, 5062.5])
def test_path_ends_where_the_load_no_longer_presses_the_body_on(cylinder: Problem, end: float):
    """A pull of any size: the cylinder is free at pressure 0, whether the middle of the path is beyond or not."""
    found = follow(cylinder, PRESSURE, -end)
    assert found.reaches == pytest.approx((50.625, 0.0), abs=1e-9)
    assert "pulls the body off" in " ".join(found.notes)
    assert repr(found).startswith(f"<ParameterPath of {PRESSURE} from 50.625 to -{end:g}: ")


def test_a_path_of_a_factor_ends_where_the_tool_lifts_off():
    """A force of -10 + 4 f on a press that nothing else holds: none at f = 2.5, and the path is asked for up to 40."""
    cases = {"lift": {"tools": {"press": {"force": {"y": 4}}}}}
    tools = {"press": {"zones": "press", "force": {"y": -10}}}
    found = follow(made(BETWEEN, tools=tools, load_cases=cases), "load_cases.lift", 40)
    assert found.reaches == pytest.approx((0.0, 2.5))
    assert found.contact.name == BETWEEN["name"]
    assert found.path.end.cases.factors == pytest.approx([40])


@pytest.mark.parametrize(
    ("key", "to", "words"),
    [
        ("material.young_modulus", 2e3, "young_modulus: the compliance depends on it; only loads, gaps"),
        ("boundary.outer.top.elements", 8, "elements: the compliance depends on it"),
        ("name", 1.0, "name: there is no number to vary"),
        ("material.color", 1.0, "there is no number to vary: unknown entry 'color'; there are: "),
        ("conditions.tpo.pressure", 1.0, "there is no number to vary: unknown entry 'tpo'; did you mean 'top'?"),
        (
            "conditions.top.traction.x",
            1.0,
            "there is no number to vary: it is left out; state it, or give the start value",
        ),
        ("contact_zones.foot.surface.point", 1.0, "there is no number to vary: it is a list of 2; give a path to a"),
        ("contact_zones.foot.surface.point.1", 1.0, "a list has positions, not keys; write [1] instead of '1'"),
        (PRESSURE, 50.625, "a path needs two different finite values; found 50.625 and 50.625"),
        (PRESSURE, np.nan, "the value at the end of the path (to) must be a finite number; found nan"),
        ("no path[", 1.0, "is not a key path"),
    ],
)
def test_invalid_parameters_are_refused(cylinder: Problem, key: str, to: float, words: str):
    with pytest.raises(ProblemError, match=re.escape(words)):
        follow(cylinder, key, to)


def on_a_circle() -> tuple[Problem, str]:
    """The small Hertz problem on a circle below, and the path to it."""
    problem = bemcontact.load(MODELS / "gallery" / "hertz_small.yaml", variant="stated mesh")
    (zone,) = problem.contact_zones
    key = f"contact_zones.{zone}.surface"
    return problem.with_value(key, {"kind": "circle", "center": [0, -100], "radius": 100, "body": "outside"}), key


def test_radius_of_a_rigid_circle_is_linear():
    """The gap along the normal of a circle is the distance from its center less its radius."""
    circle, key = on_a_circle()
    assert follow(circle, f"{key}.radius", 99.99).path.contact(1.0).offset == pytest.approx(
        bemcontact.condense(circle.with_value(f"{key}.radius", 99.99)).offset, abs=1e-13
    )


def test_value_that_turns_the_rigid_surface_is_refused():
    """As the center of a circle moves sideways its normals turn, and all that is seen along them with it."""
    circle, key = on_a_circle()
    with pytest.raises(ProblemError, match=r"center\[0\]: the compliance depends on it"):
        follow(circle, f"{key}.center[0]", 1.0)


def test_gap_that_is_all_round_off_is_no_bend():
    """A block flush in a corner: gaps are zero, and what a pressure adds to them is round-off of 1e-19.

    As the pressure on the floor vanishes, that on the wall is 5 still, as statics wants; the path arrives there.
    """
    found = follow(bemcontact.load(MODELS / "gallery" / "block_in_corner.yaml"), PRESSURE, 0.0, start=8.0)
    assert found.certified
    assert found.reaches == (8.0, 0.0)
    assert [state.peak for state in found.breakpoints] == pytest.approx([8.0, 5.0], rel=1e-9)


def test_two_ends_that_nothing_presses_are_refused(cylinder: Problem):
    with pytest.raises(ProblemError, match="contact holds the body"):
        between(Variation(cylinder.with_value(PRESSURE, 0.0), "contact_zones.foot.surface.point[1]"), 0.0, 1.0)


@cache
def on_eccentric_punch() -> Problem:
    """On a mesh that a problem and a path share."""
    stated = bemcontact.load(MODELS / "gallery" / "eccentric_punch.yaml", variant="stated mesh")
    return stated.with_case("off the middle")


@pytest.mark.slow
def test_a_mesh_is_found_at_the_end_that_presses():
    """At the other end the force pulls at the punch, and there is no state for which a mesh could be found."""
    problem = bemcontact.load(MODELS / "gallery" / "eccentric_punch.yaml").with_case("off the middle")
    found = follow(problem.with_value("accuracy", 0.2), "tools.punch.force.y", 2000.0, start=-2000.0)
    assert found.reaches == pytest.approx((-2000.0, -800.0), rel=1e-9)  # where the moment of 4000 tips it off its edge
    assert found.start_accuracy.met
    assert found.end_accuracy.met is None
    assert found.end_accuracy.reason


@pytest.mark.slow
def test_a_short_path_needs_no_finer_mesh_than_its_beginning():
    """Both ends need the same mesh. The second search divides ends of contact anew; what is cut is not cut again."""
    problem = bemcontact.load(MODELS / "gallery" / "hertz_small.yaml").with_value("accuracy", 0.05)
    problem = problem.with_value("mesh.refine", 2)
    alone = meshed(problem).condensation.contact
    found = follow(problem, "conditions.top.pressure", 81.5 * (1 + 1e-6), start=81.5)
    assert alone.size <= found.contact.size <= 2 * alone.size
    assert found.start_accuracy.met
    assert found.end_accuracy.met


@pytest.mark.parametrize("to", [2000.0, 6000.0, 9000.0])
@pytest.mark.parametrize("backwards", [False, True])
def test_load_that_turns_around_is_followed_to_where_the_tool_lifts_off(to: float, backwards: bool):
    """At no load, wherever that is between the ends: also half-way, or nearer to the end that presses."""
    problem = on_eccentric_punch()
    problem = problem.with_value("load_cases.off the middle.tools.punch.force.moment", 0.0)
    key, ends = "tools.punch.force.y", (-2000.0, to)
    last, first = ends if backwards else ends[::-1]
    path = follow(problem, key, last, start=first).path
    none = 2000.0 / (2000.0 + to)
    reached, half = (path.begins_at, 1 - none / 2) if backwards else (path.ends_at, none / 2)
    assert reached == pytest.approx(1 - none if backwards else none, rel=1e-13)
    assert apart(path.contact(half), condense(problem.with_value(key, -1000.0)), path.at(half).pressure) <= 1e-10


@pytest.mark.slow
def test_factor_of_a_load_case_is_known_all_along_a_path_from_where_nothing_presses():
    """(1 - t) 0 + t 1, which `with_factors` builds on, though the state at factor 0 cannot be condensed by itself."""
    problem = bemcontact.load(MODELS / "gallery" / "roller_in_v_block.yaml", variant="stated mesh").with_case("still")
    data: dict[str, Any] = problem.model_dump(exclude={"reference", "variants"}) | {"combinations": {}, "case": None}
    data["tools"]["plate"]["force"]["y"] = 0.0
    data["load_cases"] = {"press": {"tools": {"plate": {"force": {"y": -400.0}}}}}
    problem = Problem(**data).with_case("press")
    path = follow(problem, "load_cases.press", 1.0, start=0.0).path
    for t in (0.0, 0.3, 1.0):
        assert path.contact(t).cases.factors == pytest.approx([t], abs=1e-15)
    full = path.contact(0.3).with_factors({"press": 1.0})
    np.testing.assert_allclose(full.motion_load, condense(problem).motion_load, rtol=1e-13)


def test_stated_values_are_read(cylinder: Problem):
    assert stated_value(cylinder, PRESSURE) == 50.625
    assert stated_value(cylinder, "contact_zones.foot.surface.point[1]") == 0.0
    varied = cylinder.with_value(PRESSURE, {"constant": 1, "x": 2})
    with pytest.raises(ProblemError, match="there is no number to vary"):
        stated_value(varied, PRESSURE)
    assert stated_value(varied, f"{PRESSURE}.x") == 2.0


def test_sensitivities_by_key_against_central_differences(cantilever: Problem):
    """Bodies are condensed and solved anew, a step of 1e-5 of each value to both sides.

    Curvature leaves 1e-10, round-off 1e-12 / 1e-5 by the condition of the compliance.
    """
    keys = ["material.young_modulus", "conditions.top.traction.y", "contact_zones.ground.surface.point[1]"]
    found = sensitivities(cantilever, keys)
    assert list(found) == keys
    assert not found.notes
    for key in keys:
        value = stated_value(cantilever, key)
        step = 1e-5 * abs(value)
        ends = [bemcontact.solve(cantilever.with_value(key, value + side), "complementarity") for side in (step, -step)]
        after, before = (end.solution.pressure for end in ends)
        expected = (after - before) / (2 * step)
        np.testing.assert_allclose(found[key].rising.pressure, expected, atol=1e-6 * np.abs(expected).max())
        ends_of = [end.footprint.intervals[0].start_arc for end in ends]
        start = found[key].rising.interval_ends[0][0]
        assert start == pytest.approx((ends_of[0] - ends_of[1]) / (2 * step), rel=1e-5)


def test_an_infinite_peak_has_no_derivative():
    """Under the edge of a punch; the force grows by one per unit of the load all the same."""
    problem = bemcontact.load(MODELS / "gallery" / "eccentric_punch.yaml").with_case("off the middle")
    found = sensitivities(problem.with_value("accuracy", 0.05), ["tools.punch.force.y"])
    assert found.accuracy.infinite == ("punch",)
    rates = found["tools.punch.force.y"]
    assert rates.rising.peak is rates.falling.peak is None
    assert rates.rising.resultant[0, 1] == pytest.approx(1.0, rel=1e-9)
    assert "infinite" in repr(rates)


def test_sensitivities_of_a_condensed_problem(cylinder: Problem):
    contact = bemcontact.condense(cylinder)
    assert len(sensitivities(contact)) == 0
    with pytest.raises(
        ProblemError, match=r"there is no 'material\.young_modulus' in this condensed problem; it has: init"
    ):
        sensitivities(contact, ["material.young_modulus"])
    with pytest.raises(ProblemError, match="a Problem or a CondensedContact is needed, found '"):
        sensitivities("cylinder.yaml")  # pyright: ignore[reportArgumentType]


def test_sensitivity_to_the_gap_at_a_point(cylinder: Problem):
    """A difference over 1e-6 of a state that is linear in the gap as long as no point enters or leaves."""
    contact, step = bemcontact.condense(cylinder.with_value(PRESSURE, 45)), 1e-6
    wider = contact.initial_gap + step * (np.arange(contact.size) == 5)
    then = complementarity.solve(replace(contact, initial_gap=wider)).pressure
    expected = (then - complementarity.solve(contact).pressure) / step
    found = sensitivities(contact, "initial_gap[5]")["initial_gap[5]"]
    np.testing.assert_allclose(found.rising.pressure, expected, atol=1e-6 * np.abs(expected).max())
    with pytest.raises(ProblemError, match=r"there is no 'initial_gap\[45\]'"):
        sensitivities(contact, ["initial_gap[45]"])


def test_public_names_are_there(cylinder: Problem):
    contact = bemcontact.condense(cylinder)
    half = replace(contact, motion_load=contact.motion_load / 2, free_displacement=contact.free_displacement / 2)
    path = bemcontact.load_path(half, contact)
    assert isinstance(path, bemcontact.LoadPath)
    assert isinstance(bemcontact.sensitivities(contact), bemcontact.Sensitivities)
    assert isinstance(bemcontact.follow(cylinder, PRESSURE, 25), bemcontact.ParameterPath)


@pytest.mark.parametrize(("key", "to"), [("load_cases.lift", 2.0), ("tools.press.force.y", -7.0)])
def test_factors_and_tools_are_followed_with_one_condensation(monkeypatch: pytest.MonkeyPatch, key: str, to: float):
    """Only gaps and loads change; the state at the end is that of the problem condensed anew."""
    cases = {"lift": {"tools": {"press": {"force": {"y": 4}}}}}
    tools = {"press": {"zones": "press", "force": {"y": -10}}}
    problem = made(BETWEEN, tools=tools, load_cases=cases).with_factors({"lift": 1.0})
    calls: list[Body] = []

    def counted(body: Body) -> Condensation:
        calls.append(body)
        return condense_body(body)

    monkeypatch.setattr("bemcontact.analysis.variation.condense_body", counted)
    path = follow(problem, key, to).path
    assert len(calls) == 1
    varied = problem.with_factors({"lift": to}) if key.startswith("load_cases") else problem.with_value(key, to)
    assert apart(path.end, condense(varied), path.at(1.0).pressure) <= 1e-10


@pytest.mark.slow
def test_each_breakpoint_has_error_bars_that_hold():
    """A roller comes down on a block: where contact begins the mesh of the end is coarse, and the bars say so.

    With fewer than five points in contact they are not known.

    The truth is a mesh of its own for each value, with bars an order smaller.
    """
    corners = [("bottom", 0, 0), ("right", 40, 0), ("top", 40, 20), ("left", 0, 20)]
    surface = {"kind": "circle", "center": [15, 30.01], "radius": 10, "body": "outside"}
    roller = made(
        {
            "name": "roller",
            "material": {"young_modulus": 210e3, "poisson_ratio": 0.3},
            "boundary": {"outer": [{"name": name, "start": [x, y]} for name, x, y in corners]},
            "conditions": {"bottom": {"displacement": {"x": 0, "y": 0}}},
            "contact_zones": {"roller": {"edges": "top", "surface": surface}},
            "tools": {"roller": {"zones": "roller", "displacement": {"y": 0}}},
        },
        accuracy=0.02,
    )
    found = follow(roller, "tools.roller.displacement.y", -0.05)
    pressed = [state for state in found.breakpoints if state.peak]
    known = {state.value: state.peak_bar for state in pressed if state.peak_bar is not None}
    assert [state.value in known for state in pressed] == [len(state.touching) >= 5 for state in pressed]
    assert known[-0.05] <= 0.02 < 0.1 < max(known.values())
    assert found.coarse == tuple(state for state in pressed if known.get(state.value, 1.0) > 0.02)
    measured = [state for state in pressed if state.value in known]
    for state in (measured[0], measured[2], measured[len(measured) // 2]):
        truth = bemcontact.solve(roller.with_value("tools.roller.displacement.y", state.value), accuracy=2e-3)
        bars = {item.quantity: item for item in truth.accuracy.bars}
        mine = {item.quantity: item for item in state.bars}
        for quantity in ("peak", "force"):
            error = abs(mine[quantity].value / bars[quantity].value - 1)
            assert error <= mine[quantity].bar + bars[quantity].bar


@pytest.mark.slow
@pytest.mark.parametrize("to", [8000.0, -8000.0])
def test_contact_leaves_the_place_of_an_infinite_pressure_on_a_path(to: float):
    """The punch tilts to either edge; at the end it stands on one, where the search has seen an infinite pressure."""
    punch = bemcontact.load(MODELS / "gallery" / "eccentric_punch.yaml").with_case("in the middle")
    found = follow(punch.with_value("accuracy", 0.1), "tools.punch.force.moment", to, start=0.0)
    assert found.certified
    assert found.end_accuracy.met
    assert all(found.breakpoint_bars)


@pytest.mark.slow
def test_a_path_needs_no_variant_that_fits_its_mesh():
    """The variants of a model state other meshes of the same edges, which a mesh that is found contradicts."""
    beam = bemcontact.load(MODELS / "gallery" / "beam_on_two_supports.yaml").with_value("accuracy", 0.1)
    found = follow(beam, "conditions.loaded.pressure", 0.15, start=0.14)
    assert found.start_accuracy.met
    assert found.end_accuracy.met
    assert found.breakpoints[-1].peak == pytest.approx(
        bemcontact.solve(beam.with_value("conditions.loaded.pressure", 0.15)).footprint.peak.pressure, rel=0.1
    )


@pytest.mark.slow
def test_of_a_stated_mesh_no_bar_is_that_of_an_infinite_peak():
    """At the breakpoints as at the ends: no value for the peak, and the force to the accuracy of the mesh."""
    found = follow(on_eccentric_punch().with_value("accuracy", 0.01), "tools.punch.force.y", -2000.0, start=-1900.0)
    first, last = found.breakpoint_bars[0], found.breakpoint_bars[-1]
    for bars in (first, last):
        (peak,) = (item for item in bars if item.quantity == "peak")
        assert peak.value is None
        (force,) = (item for item in bars if item.quantity == "force")
        assert force.bar is not None
        assert force.bar < 0.01


def test_the_accuracy_of_a_path_is_that_of_its_problem_also_when_the_mesh_is_cut():
    outer = [
        {"name": name, "start": list(at)} for name, at in zip("abcd", [(0, 0), (4, 0), (4, 2), (0, 2)], strict=True)
    ]
    problem = Problem(
        name="block",
        material={"young_modulus": 1000.0, "poisson_ratio": 0.3},
        boundary={"outer": outer},
        conditions={"c": {"pressure": 1.0}, "d": {"displacement": {"x": 0}}},
        contact_zones={"a": {"edges": "a", "surface": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}}},
    )
    asked = problem.asked_accuracy
    path = follow(problem, "conditions.c.pressure", 2.0)
    cut = mesh_study(ComparisonOptions(formulations=(FormulationName.QP1,)), problem, refine=(1, 2))
    told = [path.start_accuracy, path.end_accuracy, cut.finest.answer.accuracy]
    assert [(item.asked, item.met) for item in told] == [(asked, True)] * 3


@pytest.mark.slow
@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_a_squeezed_block_bulges_beside_a_wall_and_is_moved_off_it(turn):
    """Where the side has closed the gap to the wall, points under the round lid go on to close: as a solve finds it."""

    def turned(x, y):
        return [np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y]

    corners = {"bottom": (0, 0), "right": (2, 0), "top": (2, 1), "left": (0, 1)}
    lid = {"kind": "circle", "center": turned(1, 31), "radius": 30, "body": "outside"}
    planes = {"bottom": ((0, 0), (0, 1)), "right": ((2.0005, 0), (-1, 0))}
    (x, y), (mx, my) = turned(0.0, -1.0), turned(0.0, -39.0)
    problem = bemcontact.problem({
        "name": "beside a wall",
        "material": {"young_modulus": 1000.0, "poisson_ratio": 0.3},
        "boundary": {"outer": [{"name": k, "start": turned(*at), "elements": 8} for k, at in corners.items()]},
        "contact_zones": {"top": {"edges": "top", "surface": lid}} | {
            name: {"edges": name, "surface": {"kind": "plane", "point": turned(*at), "normal": turned(*normal)}}
            for name, (at, normal) in planes.items()
        },
        "tools": {"lid": {"zones": "top", "force": {"x": x, "y": y}}},
        "load_cases": {"more": {"tools": {"lid": {"force": {"x": mx, "y": my}}}}},
        "mesh": {"adapt": False},
    })  # fmt: skip
    path = bemcontact.follow(problem, "load_cases.more", 1.0, start=0.0).path
    assert path.complete
    assert path.pivots > 2
    whole = problem.with_value("tools.lid.force.x", x + mx).with_value("tools.lid.force.y", y + my)
    end = bemcontact.solve(whole.model_copy(update={"load_cases": {}}))
    pressure, wall = end.solution.pressure, end.contact.zone == 2
    np.testing.assert_allclose(path.at(1.0).pressure, pressure, rtol=0, atol=1e-9 * pressure.max())
    assert not pressure[wall].any()
    assert end.solution.undetermined


@pytest.mark.parametrize(("start", "end"), [(-2.0, 5.0), (5.0, -2.0), (5.0, 0.0), (0.0, 5.0)])
def test_a_crack_closes_as_a_whole_where_the_load_changes_its_sign(start: float, end: float):
    """Under uniform pressure all of it is closed, and under tension open: the load is zero at its only breakpoint.

    Pressure and motion there are round-off beside those on the path, which no finding is of.
    """
    held = {"bottom": {"displacement": {"y": 0}}, "left": {"displacement": {"x": 0}}}
    crack = halves("bcb", ({"top": {"pressure": 5.0}}, held))
    path = follow(crack, "bodies.up.conditions.top.pressure", end, start=start)
    assert path.certified
    assert path.penetration is None
    assert not path.notes
    inside = [state.value for state in path.breakpoints if state.value not in (start, end)]
    assert inside == pytest.approx([0.0] if start * end < 0 else [], abs=1e-9)
    assert path.path.pressure.max() == pytest.approx(5.0)
