"""Load cases and tools, from the spec to the judged answer: each against the same thing stated in another way."""

import json
from functools import cache
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from messages import assert_states
from tool_problems import (
    BETWEEN,
    FLOOR,
    FREE,
    FREE_BY_HAND,
    FREE_CASES,
    HELD,
    HELD_BY_HAND,
    HELD_CASES,
    ROLLER,
    WEDGE,
    Spec,
    displaced,
    made,
)

import bemcontact
from bemcontact import spec
from bemcontact.adaptivity import resting_contacts
from bemcontact.analysis import compare as comparing
from bemcontact.analysis import load_cases
from bemcontact.analysis import solve as analysis
from bemcontact.analysis.result import Result
from bemcontact.bem.condense import condense, condensed
from bemcontact.bem.discretization import body_of
from bemcontact.errors import ProblemError
from bemcontact.options import ComparisonOptions
from bemcontact.problems import Problem
from bemcontact.reference.closed_forms import PunchOnHalfPlane

GALLERY = Path(__file__).parents[2] / "models" / "gallery"


def solved(problem: Problem) -> Result:
    """The direct solution, to round-off."""
    return bemcontact.solve(problem, "complementarity")


def where(result: Result) -> np.ndarray:
    """Where the tools are (t, 3)."""
    return result.contact.tools.displacement(result.solution.rigid_amplitudes)


def reaction(result: Result) -> np.ndarray:
    """What the body does to the tools (t, 3)."""
    return result.contact.tool_reactions(result.solution.pressure)


def gap(result: Result) -> np.ndarray:
    return result.contact.gap(result.solution.pressure, result.solution.rigid_amplitudes)


def gaps_alike(one: Result, other: Result, within: float) -> bool:
    """Relative to the displacements of the problem, as everything may touch."""
    return bool(np.abs(gap(one) - gap(other)).max() <= within * other.contact.scales.displacement)


def same(found: np.ndarray, known: np.ndarray, within: float) -> bool:
    return bool(np.abs(found - known).max() <= within * np.abs(known).max())


@pytest.mark.parametrize(
    ("stated", "cases", "by_hand"), [(HELD, HELD_CASES, HELD_BY_HAND), (FREE, FREE_CASES, FREE_BY_HAND)]
)
def test_combination_is_what_a_spec_without_load_cases_finds(stated: Spec, cases: Spec, by_hand: Spec):
    """Tractions, pressures, displacements, volume loads, tools, held and free bodies: alike to 1e-11.

    Nothing holds the free block against what its loads gain along the table as it turns, by 1 % of the force.
    """
    one, other = solved(made(stated, **cases, case="all")), solved(made(stated, **by_hand))
    assert one.certificate.certified
    assert other.certificate.certified
    assert one.boundary is not None
    assert other.boundary is not None
    touching = other.solution.pressure > 0
    assert 0 < touching.sum() < len(touching)
    assert same(one.solution.pressure, other.solution.pressure, 1e-11)
    assert gaps_alike(one, other, 1e-11)
    assert same(one.boundary.displacement, other.boundary.displacement, 1e-11)
    assert same(one.boundary.traction, other.boundary.traction, 1e-11)
    assert same(where(one), where(other), 1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["wind", "heat", "settle", "spin", "push", "all"])
def test_cases_condensed_together_are_those_condensed_alone(name: str):
    """`solve_cases` condenses once, `solve` with a case each time; the answers are the same numbers to round-off.

    The circle of the punch follows the motion, which differs from case to case.
    """
    together, problem = held_cases().results[name], made(HELD, **HELD_CASES, case=name)
    alone = bemcontact.solve(problem)
    assert together.certified
    assert same(together.solution.pressure, alone.solution.pressure, 1e-13)
    assert together.problem == alone.problem
    assert together.contact.name == alone.contact.name == f"held block, {name}"


def test_notes_are_those_of_the_case():
    """Pushed down only, the block may go away from the wall, which nothing presses it on; pushed aside too, not."""
    corner = {"table": {"edges": "foot", "surface": FLOOR}, "wall": {
        "edges": "left", "surface": {"kind": "plane", "point": [0, 0], "normal": [1, 0]}}}  # fmt: skip
    cases = {
        "down": {"conditions": {"top": {"pressure": 1}, "head": {"pressure": 1}}},
        "aside": {"conditions": {"right": {"pressure": 1}}},
    }
    stated = made(
        FREE, contact_zones=corner, tools={}, load_cases=cases, combinations={"both": {"down": 1, "aside": 1}}
    )
    together = bemcontact.solve_cases(stated)
    for name in ("down", "aside", "both"):
        told = together.results[name].notes
        assert told == bemcontact.solve(stated.with_case(name)).notes
        assert any("not determined: the translation" in note for note in told) is (name == "down")


@cache
def held_cases() -> load_cases.CaseResults:
    return bemcontact.solve_cases(made(HELD, **HELD_CASES))


def test_results_of_all_cases():
    found = held_cases()
    assert [*found.results] == ["wind", "heat", "settle", "spin", "push", "all"]
    assert found.certified
    peaks = {name: result.solution.pressure.max() for name, result in found.results.items()}
    assert found.worst == max(peaks, key=lambda name: peaks[name])
    written = json.loads(found.to_json())
    assert written["worst"] == found.worst
    assert written["cases"]["all"]["peak"]["pressure"] == pytest.approx(peaks["all"])
    assert "unique solutions proved, error not estimated" in repr(found)
    assert f"largest peak pressure in '{found.worst}'" in repr(found)


def test_a_case_costs_one_right_side():
    """Columns of the solution: what is permanent, each case, and a unit pressure at each contact point."""
    with_cases, without = condense(body_of(made(HELD, **HELD_CASES))), condense(body_of(made(HELD)))
    assert with_cases.parts[0].response.columns == 1 + 5 + with_cases.contact.size
    assert with_cases.parts[0].response.columns == without.parts[0].response.columns + 5


def test_boundary_under_a_case_agrees_with_the_condensed_equation():
    """n·u = u_n at the contact points, where the motion of tools is part of the gap and not of u."""
    for stated, cases in ((HELD, HELD_CASES), (FREE, FREE_CASES)):
        whole = condense(body_of(made(stated, **cases)))
        for name in cases["load_cases"]:
            case = whole.acting(name)
            result = bemcontact.solve(case.contact, "complementarity")
            state = analysis.boundary_state(case, result.solution.pressure, result.solution.rigid_amplitudes)
            points = case.body.points
            u_n = np.sum(points.normals[points.point] * state.displacement[points.element, points.local], axis=1)
            contact = case.contact
            moved = contact.tools.motions @ where(result).ravel()
            expected = (gap(result) - points.gap - moved)[points.point]
            assert abs(u_n - expected).max() < 1e-12 * contact.scales.displacement
            if stated is FREE:  # else reactions of the clamp are of the mesh
                assert state.force_balance < 1e-12


TOOLS = {
    "punch that tilts": (HELD, "punch"),
    "punch on a free body": (FREE, "punch"),
    "plate on a roller": (made(ROLLER, tools={"plate": {"zones": "plate", "force": {"y": -20}}}).model_dump(), "plate"),
    "groove with three motions": (WEDGE, "groove"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", TOOLS)
@pytest.mark.parametrize("formulation", ["qp1", "qp2", "qp3", "complementarity"])
def test_loaded_tools_suit_every_formulation(name: str, formulation: str):
    """All certified, and the pressures those of the direct solution to 1e-8 of the peak."""
    stated, _ = TOOLS[name]
    problem = made(stated)
    found = bemcontact.solve(problem, formulation)
    assert found.certified
    assert same(found.solution.pressure, solved(problem).solution.pressure, 1e-8)


@pytest.mark.parametrize("name", TOOLS)
def test_loaded_tool_is_the_tool_displaced_to_where_it_went(name: str):
    """And back: the force on the displaced tool is the one that the loaded tool had; both to 1e-10.

    Both have the surfaces of the first: one that is displaced turns, and squeezes out a block that nothing holds aside.
    """
    stated, tool = TOOLS[name]
    problem = made(stated)
    loaded = solved(problem)
    index = loaded.contact.tools.names.index(tool)
    with patch.object(resting_contacts, "RESTING", np.inf):
        fixed = solved(displaced(problem, tool, where(loaded)[index]).on_contacts_of(loaded.problem))
    assert loaded.certified
    assert fixed.certified
    assert not fixed.contact.tools.free[3 * index : 3 * index + 3].any()
    assert same(fixed.solution.pressure, loaded.solution.pressure, 1e-10)
    assert gaps_alike(fixed, loaded, 1e-10)
    assert 0 < (loaded.solution.pressure > 0).sum() < loaded.contact.size
    force = np.array(problem.tools[tool].load)
    free = np.array(problem.tools[tool].free)
    assert -reaction(fixed)[index][free] == pytest.approx(force[free], abs=1e-10 * abs(force).max())


@pytest.mark.parametrize("name", TOOLS)
def test_action_is_reaction(name: str):
    stated, tool = TOOLS[name]
    problem = made(stated)
    result = solved(problem)
    index, free = result.contact.tools.names.index(tool), np.array(problem.tools[tool].free)
    force = np.array(problem.tools[tool].load)
    assert (reaction(result)[index] + force)[free] == pytest.approx(np.zeros(free.sum()), abs=1e-12 * abs(force).max())


def test_roller_in_a_block_of_two_planes_by_statics():
    """The plate's 20 down are 0.8 (L + R), and nothing acts sideways: L = R = 12.5."""
    result = solved(made(TOOLS["plate on a roller"][0]))
    forces = result.contact.weights * result.solution.pressure
    assert [forces[result.contact.zone == zone].sum() for zone in range(3)] == pytest.approx([12.5, 12.5, 20], rel=1e-9)
    assert result.certified


def test_block_that_is_pressed_up_is_the_plate_pressed_down():
    """One tool with two zones, against a plate that stands still: the same contact, seen from the block."""
    block = {"zones": ["left flank", "right flank"], "force": {"x": 0, "y": 20}}
    up, down = solved(made(ROLLER, tools={"block": block})), solved(made(TOOLS["plate on a roller"][0]))
    assert up.certified
    assert same(up.solution.pressure, down.solution.pressure, 1e-11)
    assert where(up)[0, 1] == pytest.approx(-where(down)[0, 1], rel=1e-10)
    assert reaction(up)[0] == pytest.approx([0, -20, 0], abs=1e-11)
    pinned = "translation along (1, 0) of the body and the tool 'block' together"
    assert any(pinned in note and "it is held at zero" in note for note in up.notes)


def bent(x: np.ndarray, force: float, e: float) -> np.ndarray:
    """Pressure P/w (1 + 12 e x/w²) of bending and compression over a width w = 2, x from its middle."""
    return force / 2 * (1 + 12 * e * x / 4)


@pytest.mark.parametrize("e", [0.0, 0.2, -1 / 3])
def test_body_between_tools_is_compressed_and_bent(e: float):
    """Within the kern, w/6, faces stay plane: exact on any mesh, whichever of the two tools is loaded, or both."""
    press = {"zones": "press", "point": [1, 1], "force": {"y": -10, "moment": -10 * e}}
    table = {"zones": "table", "point": [1, 0], "force": {"y": 10, "moment": 10 * e}}
    sitting = {"zones": "table", "point": [0, 0], "displacement": {"y": 0.01, "rotation": 0.002}}
    for tools in (
        {"press": press},
        {"table": table},
        {"press": press, "table": table},
        {"press": press, "it": sitting},
    ):
        result = solved(made(BETWEEN, tools=tools))
        assert result.certified
        assert result.solution.pressure == pytest.approx(bent(result.contact.points[:, 0] - 1, 10, e), abs=1e-11 * 10)


def test_both_tools_loaded_leave_their_common_motion_pinned():
    press = {"zones": "press", "point": [1, 1], "force": {"y": -10, "moment": 0}}
    table = {"zones": "table", "point": [1, 0], "force": {"y": 10, "moment": 0}}
    result = solved(made(BETWEEN, tools={"press": press, "table": table}))
    together = "of the body, the tool 'press' and the tool 'table' together moves no contact point"
    turning = (
        "of the tool 'press', together with the rotation counterclockwise about (1, 0) of the tool 'table' moves no"
    )
    assert [sum(words in note for note in result.notes) for words in (together, turning)] == [1, 1]
    assert where(result)[0, 1] - where(result)[1, 1] == pytest.approx(-10 / 2 * (1 - 0.3**2) / 1000, rel=1e-11)


def test_displaced_far_point_is_the_motion_of_the_surface():
    """A rotation of 1e-6 about a point 1e4 away is a lift of 1e-2 and that rotation.

    The surface turns with the tool: it also moves along by half of the lever times the square, 5e-9, which is 5e-7 of
    the lift.
    """
    far = {"zones": "table", "point": [-1e4, 0], "displacement": {"rotation": 1e-6}}
    near = {"zones": "table", "point": [0, 0], "displacement": {"y": 1e-2, "rotation": 1e-6}}
    tools = {"punch": HELD["tools"]["punch"]}
    one, other = (solved(made(HELD, tools={**tools, "table": table})) for table in (far, near))
    assert one.certified
    assert other.solution.pressure.max() > 0
    assert same(one.solution.pressure, other.solution.pressure, 5e-7)


def test_loaded_tool_may_have_its_force_at_a_far_point():
    """-40 with a moment that moves it from x = 1e5 to 1.5 is what it was; a rotation about there is hardly one."""
    far = {"zones": "punch", "point": [1e5, 1], "force": {"y": -40, "moment": 40 * (1e5 - 1.5) + 3}}
    both = (made(HELD, tools={"punch": punch}) for punch in (far, HELD["tools"]["punch"]))
    one, other = (bemcontact.solve(condensed(problem).contact) for problem in both)  # with the circle as drawn
    assert one.certified
    assert same(one.solution.pressure, other.solution.pressure, 1e-9)
    assert where(one)[0, 2] == pytest.approx(where(other)[0, 2], rel=1e-9)
    assert where(one)[0, 1] - 1e5 * where(one)[0, 2] == pytest.approx(
        where(other)[0, 1] - 1.5 * where(other)[0, 2], rel=1e-8
    )


def test_mirrored_tools_have_the_mirrored_answer():
    """With -x for x the loops run backwards, moments and rotations change their sign."""
    plain = solved(made(FREE, tools={"punch": {"zones": "punch", "point": [1.5, 1], "force": {"y": -40, "moment": 3}}}))
    corners = {"foot": [-2, 0], "right": [0, 0], "top": [0, 1], "head": [-1, 1], "left": [-2, 1]}
    counts = {edge["name"]: edge["elements"] for edge in FREE["boundary"]["outer"]}
    outer = [{"name": name, "start": start, "elements": counts[name]} for name, start in corners.items()]
    tool = {"zones": "punch", "point": [-1.5, 1], "force": {"y": -40, "moment": -3}}
    turned = solved(made(FREE, boundary={"outer": outer}, tools={"punch": tool}))
    assert turned.certified
    order = [np.lexsort((sign * r.contact.points[:, 0], r.contact.zone)) for sign, r in ((1, plain), (-1, turned))]
    assert same(turned.solution.pressure[order[1]], plain.solution.pressure[order[0]], 1e-10)
    assert where(turned)[0] == pytest.approx(where(plain)[0] * [-1, 1, -1], rel=1e-9)


@pytest.mark.parametrize("length", [1e-9, 1e6])
@pytest.mark.parametrize("stress", [1e-9, 1e6])
def test_units_change_nothing(length: float, stress: float):
    """Lengths by L, stresses by p, so densities by p/L², forces on tools by p L, moments by p L²; to 1e-9."""
    stated = spec.load(GALLERY / "roller_in_v_block.yaml", variant="stated mesh").with_case("down and aside")
    text = {**stated.model_dump(), "reference": {}}
    for edge in text["boundary"]["outer"]:
        edge["center"] = [length * value for value in edge["center"]]
        edge["radius"] *= length
        edge["start"] = edge["end"] = None
    for zone in text["contact_zones"].values():
        zone["surface"]["point"] = [length * value for value in zone["surface"]["point"]]
    text["material"]["young_modulus"] *= stress
    text["tools"]["plate"]["force"]["y"] *= stress * length
    for case in ("down", "aside"):
        text["load_cases"][case]["loads"]["gravity"]["density"] *= stress / length
    plain = solved(stated)
    scaled = solved(Problem(**text))
    assert scaled.certified
    assert same(scaled.solution.pressure / stress, plain.solution.pressure, 1e-9)
    assert same(where(scaled) / [length, length, 1], where(plain), 1e-9)


REFUSED = {
    "tool without load": (
        BETWEEN,
        {"press": {"zones": "press", "force": {"y": 0}}},
        "contact holds the body … translation along (0, 1) … rotation counterclockwise about (1, 0.5) … "
        "the tool 'press' … translation along (0, 1) … no load … position is not determined; apply a load",
    ),
    "tool that is pulled off": (
        BETWEEN,
        {"press": {"zones": "press", "force": {"y": 10}}},
        "the load of (0, 10) pulls the tool 'press' off … translation along (0, 1), up, … add a load down … turn "
        "the load around",
    ),
    "force that nothing resists": (
        BETWEEN,
        {"press": {"zones": "press", "force": {"x": 2, "y": -10}}},
        "nothing holds the tool 'press' … translation along (1, 0) … resultant 2 … prescribe a displacement",
    ),
    "moment beyond the edge": (
        BETWEEN,
        {"press": {"zones": "press", "point": [1, 1], "force": {"y": -10, "moment": 11}}},
        "the load pulls the tool 'press' off … rotation counterclockwise about (0, 1) … move it",
    ),
    "forces that do not balance": (
        BETWEEN,
        {"press": {"zones": "press", "force": {"y": -10}}, "table": {"zones": "table", "force": {"y": 9}}},
        "nothing holds the body, the tool 'press' and the tool 'table' together … translation along (0, 1) … "
        "resultant -1 … balance the loads",
    ),
    "moments that do not balance": (
        BETWEEN,
        {
            "press": {"zones": "press", "point": [1, 1], "force": {"y": -10, "moment": 2}},
            "table": {"zones": "table", "point": [1, 0], "force": {"y": 10, "moment": 1}},
        },
        "moment 3",
    ),
    "round tool that is turned": (
        {**BETWEEN, "contact_zones": {**BETWEEN["contact_zones"], "press": {"edges": ["head", "top"], "surface": {
            "kind": "circle", "center": [1, 4], "radius": 3, "body": "outside"}}}},
        {"press": {"zones": "press", "point": [1, 4], "force": {"y": -10, "moment": 2}}},
        "nothing holds the tool 'press' … rotation counterclockwise about (1, 4) … moment 2",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_tools_that_contact_cannot_hold_are_refused(name: str):
    stated, tools, words = REFUSED[name]
    with pytest.raises(ProblemError) as caught:
        body_of(made(stated, tools=tools))
    assert_states(str(caught.value), words)


def test_case_that_contact_cannot_hold_is_refused_by_its_name():
    cases = {"lift": {"tools": {"press": {"force": {"y": 30}}}}, "press": {"tools": {"press": {"force": {"y": -1}}}}}
    problem = made(BETWEEN, tools={"press": {"zones": "press", "force": {"y": -10}}}, load_cases=cases)
    with pytest.raises(
        ProblemError, match=r"load_cases\.lift: the load of \(0, 20\) pulls the tool 'press' off what it touches"
    ):
        bemcontact.solve_cases(problem)
    with pytest.raises(ProblemError, match=r"combinations\.it: the load of \(0, 20\) pulls the tool"):
        bemcontact.solve(
            made(BETWEEN, tools=problem.tools, load_cases=cases, combinations={"it": {"lift": 1}}, case="it")
        )
    assert bemcontact.solve(problem.with_case("press")).certified


def test_a_case_must_be_chosen_where_one_is_solved():
    with pytest.raises(ProblemError, match=r"as case \(in Python by with_case\): wind, heat, push, all; or solve all"):
        bemcontact.solve(made(FREE, **FREE_CASES))
    with pytest.raises(ProblemError, match="states no load cases"):
        bemcontact.solve_cases(made(FREE))


def test_zones_of_two_tools_that_meet_share_no_point():
    """Two punches side by side on one face, one deeper: none goes into the body, not at the node where they meet."""
    zones = {name: {"edges": edge, "surface": FREE["contact_zones"]["punch"]["surface"]} for name, edge in
             (("one", "head"), ("other", "top"))}  # fmt: skip
    tools = {
        "one": {"zones": "one", "displacement": {"y": -0.01}},
        "other": {"zones": "other", "displacement": {"y": -0.02}},
    }
    conditions = {"foot": {"displacement": {"x": 0, "y": 0}}}
    result = solved(made(HELD, conditions=conditions, loads={}, contact_zones=zones, tools=tools))
    contact = result.contact
    meeting = np.flatnonzero((abs(contact.points - [1, 1]) < 1e-9).all(axis=1))
    assert len(meeting) == 2
    assert gap(result).min() > -1e-9
    assert gap(result)[meeting] == pytest.approx([0.01, 0.0], abs=1e-9)  # the deeper one decides
    together = made(HELD, conditions=conditions, loads={}, contact_zones=zones, tools={"both": {
        "zones": ["one", "other"], "displacement": {"y": -0.01}}})  # fmt: skip
    assert solved(together).contact.size == contact.size - 1


@pytest.mark.parametrize("case", ["wind", "all"])
def test_saved_and_read_again_cases_and_tools_are_the_same(case: str, tmp_path: Path):
    contact = analysis.condense(made(FREE, **FREE_CASES))
    contact.save(tmp_path / "contact.npz")
    read = type(contact).load(tmp_path / "contact.npz")
    factors = made(FREE, **FREE_CASES).factors(case)
    one, other = (bemcontact.solve(item.with_factors(factors), "complementarity") for item in (contact, read))
    assert (one.solution.pressure == other.solution.pressure).all()
    assert (where(one) == where(other)).all()
    assert read.tools.names == ("punch",)
    assert read.cases.names == ("wind", "heat", "push")
    assert read.pinned.motions == contact.pinned.motions


def test_cases_are_compared_one_by_one():
    """A study of one case: references without case are judged in each, others in theirs; --case outdates none."""
    problem = spec.load(GALLERY / "body_between_two_tools.yaml", variant="stated mesh")
    plan = ComparisonOptions.of(("qp1", "qp2", "qp3"))
    for case, names in {
        "raised": {"raised", "press", "table"},
        "edge of the kern": {"edge of the kern", "press", "table"},
    }.items():
        study = comparing.mesh_study(plan, problem.with_case(case), changes=(f"case={case}",))
        assert study.certified
        assert {item.reference for item in study.finest.scores} == names
        assert all(item.judged and item.holds for item in study.finest.scores)
    changed = comparing.mesh_study(plan, problem.with_case("raised"), changes=("tools.press.force.y=-1",))
    assert not any(item.judged for item in changed.finest.scores)


def test_a_mesh_is_found_for_all_cases():
    """The end of contact under a round punch: each case has Hertz's peak to 1 %."""
    problem = made(
        HELD, conditions={"foot": {"displacement": {"x": 0, "y": 0}}}, loads={}, accuracy=3e-3,
        contact_zones={"punch": {"edges": ["head", "top"], "surface": {
            "kind": "circle", "center": [1, 3], "radius": 2, "body": "outside"}}},
        tools={"punch": {"zones": "punch", "force": {"y": 0}}},
        load_cases={
            name: {"tools": {"punch": {"force": {"y": force}}}} for name, force in (("light", -1), ("heavy", -4))},
    )  # fmt: skip
    found = bemcontact.solve_cases(problem)
    assert found.certified
    widths = []
    for name, force in (("light", 1), ("heavy", 4)):
        result = found.results[name]
        assert result.accuracy.met
        (interval,) = result.footprint.intervals
        widths.append(interval.end_arc - interval.start_arc)
        assert result.footprint.peak is not None
        assert result.footprint.peak.pressure == pytest.approx(
            np.sqrt(force * problem.material.contact_modulus / (np.pi * 2)), rel=0.01
        )
    assert widths[1] / widths[0] == pytest.approx(2, rel=0.02)


ECCENTRIC = spec.load(GALLERY / "eccentric_punch.yaml", variant="stated mesh")


@cache
def punch(refine: int) -> analysis.CondensedContact:
    return analysis.condense(ECCENTRIC.refined(refine))


def pressed_at(contact: analysis.CondensedContact, e: float) -> Result:
    """The condensed block with its force at e."""
    return bemcontact.solve(contact.with_tools(force=[[0, -2000, -2000 * e]]), "complementarity")


@pytest.mark.parametrize("e", [0.5, 2.0, 2.5, 3.5, 4.5])
def test_tilt_of_the_punch_is_that_of_the_closed_form(e: float):
    """A block of 40 half-widths, 304 degrees of freedom: 0.2 %; where an edge lifts off near the other, 1 %."""
    form = PunchOnHalfPlane(load=2000, half_width=5, eccentricity=e)
    tilt = -form.tilt(ECCENTRIC.material.contact_modulus)  # clockwise where the force is to the right
    assert where(pressed_at(punch(1), e))[0, 2] == pytest.approx(tilt, rel=2e-3 if e <= 2.5 else 1e-2)
    assert where(pressed_at(punch(2), e))[0, 2] == pytest.approx(tilt, rel=2e-3 if e <= 2.5 else 3e-3)


def lift_off(contact: analysis.CondensedContact) -> tuple[float, float]:
    """Where the force is as the last node at the far edge opens, by bisection, and how far the next node is from it."""
    x = contact.points[:, 0]
    last, beside = np.argsort(x)[:2]
    low, high = 0.0, 4.0
    while high - low > 1e-6:
        middle = (low + high) / 2
        low, high = (middle, high) if pressed_at(contact, middle).solution.pressure[last] > 0 else (low, middle)
    return low, float(x[beside] - x[last])


@pytest.mark.slow
def test_far_edge_lifts_off_at_half_of_the_half_width():
    """At a/2 = 2.5 within the spacing of nodes at the edge; of first order in it, 0.1 % off for the block."""
    found = [lift_off(punch(refine)) for refine in (1, 2, 4)]
    assert all(abs(e - 2.5) < spacing for e, spacing in found)
    coarse, middle, fine = (e for e, _ in found)
    assert (coarse - middle) / (middle - fine) == pytest.approx(2, rel=0.05)
    assert fine + (fine - middle) == pytest.approx(2.5, rel=1e-3)
