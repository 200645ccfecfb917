"""What references say at the contact points of a body, and whether they are in their range."""

import json

import numpy as np
import pytest
from known_answers import BLOCK, crack, hertz, propped_beam, punch, ring
from messages import assert_states

import bemcontact
from bemcontact.reference import Expected, expected


def only(spec: str, *overrides: str) -> tuple[Expected, bemcontact.CondensedContact]:
    """The only reference of a spec, evaluated."""
    problem = bemcontact.loads(spec, set=overrides)
    contact = bemcontact.condense(problem)
    [one] = expected(problem, contact)
    return one, contact


def test_no_reference_expects_nothing():
    problem = bemcontact.loads(BLOCK[: BLOCK.index("reference:")])
    assert expected(problem, bemcontact.condense(problem)) == ()


def test_hertz_of_half_a_cylinder():
    one, contact = only(hertz())
    x = contact.points[:, 0]
    assert one.in_range
    assert one.remark == ""
    assert one.closed_form
    assert one.center == (0.0, 0.0)
    assert one.resultant == pytest.approx(4.05)
    assert one.pressure == pytest.approx(one.peak * np.sqrt(np.maximum(1 - (x / one.half_width) ** 2, 0)))
    assert one.compared.tolist() == (np.abs(x / one.half_width - 1) > 0.1).tolist()  # elements are shorter there


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (
            ("reference.Hertz.load=810",),
            "b/R = 0.34, … 2.7 %",
        ),
        (("reference.Hertz.load=81000",), "b/R = 3.4:"),
        (
            ("reference.Hertz.radius=800", "reference.Hertz.load=10"),
            "thick body; … 2.6",
        ),
    ],
)
def test_hertz_out_of_range_is_shown_and_not_judged(overrides, words: str):
    one, _ = only(hertz(), *overrides)
    assert not one.in_range
    assert_states(one.remark, words)
    assert one.remark.endswith("shown, not judged")
    assert np.isfinite(one.pressure).all()


@pytest.mark.parametrize(
    ("surface", "radius", "in_range"),
    [("2", 1.6, True), ("0.5", 8 / 17, False), ("-10", 40.0, True)],
)
def test_hertz_on_a_round_surface(surface: str, radius: float, in_range: bool):
    """Half-width with 1/R = 1/8 + 1/surface; on the pin of radius 0.5 it is 0.0665, more than a tenth of that."""
    one, _ = only(hertz(), f"reference.Hertz.surface_radius={surface}")
    plane, _ = only(hertz())
    assert one.half_width == pytest.approx(plane.half_width * np.sqrt(radius / 8))
    assert one.in_range is in_range


def test_hertz_speaks_of_the_near_side_of_a_body():
    """A whole cylinder that may touch all around: zero on its far side, where x is small again."""
    spec = hertz()
    whole = (
        spec[: spec.index("boundary:")]
        + """boundary:
  outer: [{name: rim, kind: arc, center: [0, 8], radius: 8, angles: [-90, 270], elements: 40}]
loads: {gravity: {density: 0.04, acceleration: [0, -1]}}
contact_zones:
  foot: {edges: rim, surface: {kind: plane, point: [0, 0], normal: [0, 1]}}
reference:
  Hertz: {kind: hertz, load: 8.04, radius: 8, center: [0, 0]}
"""
    )
    one, contact = only(whole)
    assert one.pressure[contact.points[:, 1] > 8].max() == 0.0
    assert one.pressure.max() > 0
    assert one.resultant == pytest.approx(8.04)


def test_tolerance_and_its_reason_are_those_of_the_kind_or_of_the_spec():
    one, _ = only(hertz())
    assert one.tolerance == 0.01
    assert "for the mesh" in one.reason
    one, _ = only(hertz(), "reference.Hertz.tolerance=0.003")
    assert (one.tolerance, one.reason) == (0.003, "stated in the spec")
    one, _ = only(hertz(), "reference.Hertz.tolerance=0.003", "reference.Hertz.reason=a fine mesh")
    assert (one.tolerance, one.reason) == (0.003, "a fine mesh")


@pytest.mark.parametrize(("size", "in_range"), [(10.0, True), (9.0, False)])
def test_punch_on_a_small_body_is_out_of_range(size: float, in_range: bool):
    one, contact = only(punch(size))
    assert one.in_range is in_range
    assert ("ends 9 half-widths away" in one.remark) is not in_range
    x = contact.points[:, 0]
    assert np.isnan(one.pressure).tolist() == (x > 1 - 1e-9).tolist()
    assert one.compared.tolist() == (x <= 0.9).tolist()
    assert one.peak is None


@pytest.mark.parametrize(("size", "in_range"), [(60.0, True), (30.0, False)])
def test_crack_in_a_small_panel_is_out_of_range(size: float, in_range: bool):
    one, contact = only(crack(size))
    assert one.in_range is in_range
    assert ("ends 10 half-lengths away" in one.remark) is not in_range
    assert one.compared.tolist() == (contact.points[:, 0] <= 2.7).tolist()


def test_crack_that_does_not_close_is_not_judged():
    """The crack closes to the tip from q = c E' / (2a + c) = 52.3 on."""
    one, _ = only(crack(60.0), "reference.crack.compression=52")
    assert not one.in_range
    assert "the compression is too small" in one.remark
    assert np.isnan(one.pressure).all()
    assert not one.compared.any()
    one, _ = only(crack(60.0), "reference.crack.compression=53")
    assert one.in_range


@pytest.mark.parametrize("rigid", ["pin", "bore"])
def test_pressure_of_a_ring_is_uniform(rigid: str):
    one, contact = only(ring("plane_strain", rigid))
    assert one.compared.all()
    assert one.pressure == pytest.approx(np.full(contact.size, one.peak))


def supports(span: float, gap: float, *overrides: str) -> tuple[Expected, Expected]:
    """The references to the end and to the prop of a beam."""
    problem = bemcontact.loads(propped_beam(span, gap), set=overrides)
    end, prop = expected(problem, bemcontact.condense(problem))
    return end, prop


def test_supports_of_a_beam_share_its_load():
    """Of half a beam the prop has half of its force, of a whole one all of it; no pressure is told of."""
    end, prop = supports(20.0, 0.5)
    assert end.resultant is not None
    assert prop.resultant is not None
    assert end.resultant + prop.resultant == pytest.approx(1e-4 * 10, rel=1e-12)
    assert prop.in_range
    assert not prop.compared.any()
    _, whole = supports(20.0, 0.5, "reference.prop.half=false")
    assert whole.resultant == pytest.approx(2 * prop.resultant, rel=1e-14)


@pytest.mark.parametrize(
    ("span", "gap", "remark"),
    [
        (9.0, 0.5, "slender beam; … 9 heights long: shown, not judged"),
        (10.0, 0.8, "20 % of its sag … shown, not judged"),
    ],
)
def test_beam_out_of_range_is_shown_and_not_judged(span: float, gap: float, remark: str):
    for one in supports(span, gap):
        assert not one.in_range
        assert_states(one.remark, remark)
        assert one.resultant is not None


def test_beam_that_misses_its_prop_rests_on_its_ends():
    end, prop = supports(20.0, 1.1)
    assert end.in_range
    assert end.resultant == pytest.approx(1e-4 * 10, rel=1e-12)
    assert (prop.in_range, prop.resultant, prop.remark) == (False, None, "the beam does not reach its prop")


def test_zones_of_a_block():
    problem = bemcontact.loads(BLOCK)
    contact = bemcontact.condense(problem)
    known = {item.name: item for item in expected(problem, contact)}
    wall = contact.zone == contact.zone_names.index("wall")
    assert known["wall"].compared.tolist() == wall.tolist()
    assert np.isnan(known["wall"].pressure).tolist() == (~wall).tolist()
    assert known["values"].ends == ((0.0, 0.0), (2.0, 0.0))
    assert not known["values"].compared.any()
    y = contact.points[:, 1]
    inside = wall & (y > 0.2 - 1e-9) & (y < 0.6 + 1e-9)
    assert known["table"].compared.tolist() == inside.tolist()
    assert known["table"].pressure[inside] == pytest.approx(4 - 5 * (y[inside] - 0.2))


def test_table_beside_the_contact_states_nothing():
    spec = hertz()
    table = "reference:\n  high: {kind: table, source: s, against: y, pressure: [[5, 1], [6, 2]]}\n"
    one, _ = only(spec[: spec.index("reference:")] + table)
    assert not one.in_range
    assert_states(one.remark, "no contact point … range of the table")


def test_contact_of_another_problem_is_refused():
    with pytest.raises(bemcontact.ProblemError, match="zones fit, those of the problem are foot, wall; condense this"):
        expected(bemcontact.loads(BLOCK), bemcontact.condense(bemcontact.loads(ring("plane_strain", "pin"))))


def test_expected_values_are_ready_for_json():
    problem = bemcontact.loads(BLOCK)
    for item in expected(problem, bemcontact.condense(problem)):
        data = json.loads(json.dumps(item.to_dict(), allow_nan=False))
        assert data["name"] == item.name
        assert [p is None for p in data["pressure"]] == np.isnan(item.pressure).tolist()


TILTING = """
name: punch with an eccentric force
material: {young_modulus: 1000, poisson_ratio: 0.3}
boundary:
  outer:
    - {name: base, start: [-12, -12], elements: 4}
    - {name: right, start: [12, -12], elements: 4}
    - {name: free right, start: [12, 0], elements: 6, grading: {ratio: 50, towards: end}}
    - {name: face, start: [1, 0], elements: 10}
    - {name: free left, start: [-1, 0], elements: 6, grading: {ratio: 50, towards: start}}
    - {name: left, start: [-12, 0], elements: 4}
conditions: {base: {displacement: {x: 0, y: 0}}}
contact_zones: {punch: {edges: face, surface: {kind: plane, point: [0, 0], normal: [0, -1]}}}
tools: {punch: {zones: punch, point: [0, 0], force: {y: -2, moment: 0}}}
load_cases:
  near: {tools: {punch: {force: {moment: -0.6}}}}
  far: {tools: {punch: {force: {moment: 1.4}}}}
combinations: {opposite: {near: 1, far: 1}}
reference:
  any: {kind: values, source: statics, resultant: 2}
  near: {kind: flat_punch, case: near, load: 2, half_width: 1, center: [0, 0], eccentricity: 0.3}
  far: {kind: flat_punch, case: far, load: 2, half_width: 1, center: [0, 0], eccentricity: -0.7}
"""


@pytest.mark.parametrize(
    ("case", "names"),
    [("near", ["any", "near"]), ("far", ["any", "far"]), ("opposite", ["any"]), (None, ["any"])],
)
def test_a_reference_of_a_load_case_speaks_where_that_acts(case: str | None, names: list[str]):
    problem = bemcontact.loads(TILTING) if case is None else bemcontact.loads(TILTING).with_case(case)
    assert [one.name for one in expected(problem, bemcontact.condense(problem))] == names


def test_punch_whose_edge_lifts_off_touches_a_part():
    """With e = 0.7 to the left it touches from -1 to 3 - 4 · 0.7; compared off both ends, where it is open too."""
    problem = bemcontact.loads(TILTING).with_case("far")
    _, one = expected(problem, contact := bemcontact.condense(problem))
    x = contact.points[:, 0]
    assert one.in_range
    assert one.contact_length == pytest.approx(1.2)
    assert one.half_width == 1.0
    near_an_end = (x < -1 + 0.1 * 0.6 - 1e-9) | (np.abs(x - 0.2) < 0.1 * 0.6 - 1e-9)
    assert one.compared.tolist() == (~near_an_end).tolist()
    assert (one.pressure[x > 0.3] == 0).all()


def test_punch_that_presses_everywhere_has_no_contact_length():
    problem = bemcontact.loads(TILTING).with_case("near")
    _, one = expected(problem, contact := bemcontact.condense(problem))
    assert one.contact_length is None
    assert one.compared.tolist() == (np.abs(contact.points[:, 0]) <= 0.9 + 1e-9).tolist()
