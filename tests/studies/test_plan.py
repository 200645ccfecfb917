"""The members of a study, their keys, and which of them may be condensed together."""

from pathlib import Path
from typing import Any

import pytest

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.studies.plan import TOGETHER, study_plan

MODELS = Path(__file__).parents[2] / "models"
CYLINDER = bemcontact.load(MODELS / "cylinder_on_plane.yaml")
WEDGE = bemcontact.load(MODELS / "gallery" / "roller_in_v_block.yaml")
LOAD, MODULUS = "conditions.top.pressure", "material.young_modulus"
RADIUS = ("boundary.outer.rim.radius", "boundary.outer.rim.center[1]", "boundary.outer.axis.start[1]")


def test_members_are_the_grid_with_the_first_axis_slowest():
    plan = study_plan(CYLINDER, {LOAD: [10, 20], MODULUS: [1, 2, 3]})
    found = [tuple(plan.values(number).values()) for number in range(len(plan))]
    assert found == [(10, 1), (10, 2), (10, 3), (20, 1), (20, 2), (20, 3)]
    assert plan.member(5).material.young_modulus == 3


def test_a_member_is_the_problem_with_its_values():
    plan = study_plan(CYLINDER, {"variant": ["paper", "stated mesh"], LOAD: [10, 20]})
    expected = CYLINDER.variant("stated mesh").with_value(LOAD, 10)
    assert plan.member(2).model_dump() == expected.model_dump()


def test_several_keys_take_the_same_value():
    """The radius of the cylinder is stated in three places, which only go together."""
    plan = study_plan(CYLINDER, {RADIUS: [7, 9]})
    for number, radius in enumerate((7, 9)):
        assert plan.member(number).edge("rim").length == pytest.approx(radius * 3.141592653589793 / 2)
    with pytest.raises(ProblemError, match="the loop is open"):
        study_plan(CYLINDER, {RADIUS[0]: [7, 9]}).ensure_possible()


def test_the_name_of_an_axis_does_not_change_the_keys_of_the_journal():
    """Its rows are known by keys and values, so that a study may get names later."""
    grids = ({",".join(RADIUS): [7, 9], LOAD: [1]}, {f"radius: {','.join(RADIUS)}": [7, 9], f"z: {LOAD}": [1]})
    plain, named = (study_plan(CYLINDER, vary) for vary in grids)
    assert plain.keys() == named.keys()
    assert [*named.values(0)] == ["radius", "z"]


def test_load_cases_are_members_unless_they_are_chosen():
    assert WEDGE.case_names
    plan = study_plan(WEDGE, {"accuracy": [0.01]})
    assert [plan.member(number).case for number in range(len(plan))] == [*WEDGE.case_names]
    assert len(study_plan(WEDGE.with_case("aside"), {"accuracy": [0.01]})) == 1
    assert study_plan(WEDGE, {"case": ["aside"], "accuracy": [0.01]}).member(0).case == "aside"


def test_the_factor_of_a_load_case_can_be_varied():
    name = next(iter(WEDGE.load_cases))
    with pytest.raises(ProblemError, match=rf"'{name}' is a load case; vary its factor by load_cases\.{name}"):
        study_plan(WEDGE, {name: [0.5, 2.0]})
    with pytest.raises(ProblemError, match="vary its factor by"):
        bemcontact.follow(WEDGE, name, 2.0)
    plan = study_plan(WEDGE, {f"load_cases.{name}": [0.5, 2.0]})
    assert [plan.member(number).factors()[name] for number in range(2)] == [0.5, 2.0]


@pytest.mark.parametrize(
    ("vary", "says"),
    [
        ({"conditions.top.presure": [1]}, "did you mean 'pressure'"),
        ({"conditions.side.pressure": [1]}, "side"),
        ({MODULUS: [1000, -1]}, "young_modulus"),
        ({"variant": ["papr"]}, "did you mean 'paper'"),
        ({"case": ["wind"]}, "unknown load case"),
        ({LOAD: [1], "variant": ["paper", "x"]}, "unknown variant"),
    ],
)
def test_values_that_are_wrong_by_themselves_are_refused_before_any_work(vary: dict[str, Any], says: str):
    with pytest.raises(ProblemError, match=says):
        study_plan(CYLINDER, vary).ensure_possible()


def test_a_refusal_elsewhere_names_the_value():
    """The radius 9 in place of 8 opens the loop at the next edge; a radius of -1 is named where it is wrong."""
    with pytest.raises(ProblemError, match=r"the loop is open.*\(with .*rim\.radius = 9\)"):
        study_plan(CYLINDER, {RADIUS[0]: [8, 9]}).ensure_possible()
    with pytest.raises(ProblemError, match=r"greater than 0, found -1$"):
        study_plan(CYLINDER, {RADIUS[0]: [-1]}).ensure_possible()


def test_a_key_depends_on_problem_and_values_alone():
    """Other values on an axis, or another order of axes, leave the keys of common members as they are."""
    one = study_plan(CYLINDER, {LOAD: [10, 20], MODULUS: [1000, 2000]}).keys()
    more = study_plan(CYLINDER, {MODULUS: [1000, 1500, 2000], LOAD: [20, 10]}).keys()
    assert len({*one}) == 4
    assert {*one} < {*more}
    assert study_plan(CYLINDER, {LOAD: [10.0, 20.0], MODULUS: [1000.0, 2000.0]}).keys() == one  # as of 10:20:2
    other = study_plan(
        CYLINDER.with_value("material.poisson_ratio", 0.2), {LOAD: [10, 20], MODULUS: [1000, 2000]}
    ).keys()
    assert not {*one} & {*other}


def test_members_with_the_same_matrix_go_together():
    stated = CYLINDER.variant("stated mesh")
    plan = study_plan(stated, {LOAD: range(1, 41), MODULUS: [1000, 2000]})
    groups = [*plan.groups()]
    assert sorted(number for group in groups for number in group) == [*range(len(plan))]
    assert max(map(len, groups)) <= TOGETHER
    for group in groups:
        assert len({plan.values(number)[MODULUS] for number in group}) == 1
    assert all(len(group) == 1 for group in study_plan(CYLINDER, {LOAD: [1, 2]}).groups())  # each finds its own mesh
