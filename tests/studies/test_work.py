"""What a worker does: a row is that of `solve`, alone or condensed together with others."""

from pathlib import Path
from typing import Any

import pytest

import bemcontact
from bemcontact.bem import condense as condensing
from bemcontact.studies import work
from bemcontact.studies.plan import StudyPlan, study_plan
from bemcontact.studies.rows import MemberRow, MemberStatus, row_of
from bemcontact.studies.work import Task, rows_of_task, rows_on_one_thread, tasks_of

MODELS = Path(__file__).parents[2] / "models"
CYLINDER = bemcontact.load(MODELS / "cylinder_on_plane.yaml", variant="stated mesh")
WEDGE = bemcontact.load(MODELS / "gallery" / "roller_in_v_block.yaml")
LINK = bemcontact.load(MODELS / "gallery" / "three_zones.yaml", variant="stated mesh")
LOAD, PLACE, ROUND_OFF = "conditions.top.pressure", "contact_zones.foot.surface.point[1]", 1e-9


def rows(plan: StudyPlan) -> list[MemberRow]:
    return [row for task in tasks_of(plan, [False] * len(plan)) for row in rows_of_task(plan, task)]


def assert_same(row: MemberRow, expected: MemberRow) -> None:
    assert (row.status, row.equations, row.certified, row.met) == (
        expected.status, expected.equations, expected.certified, expected.met,
    )  # fmt: skip
    assert row.outputs.keys() == expected.outputs.keys()
    size = max(abs(item.value or 0.0) for item in expected.outputs.values())
    for name, reading in row.outputs.items():
        for part, rel in (("value", ROUND_OFF), ("error", 1e-5)):
            found, wanted = getattr(reading, part), getattr(expected.outputs[name], part)
            assert found == (None if wanted is None else pytest.approx(wanted, rel=rel, abs=ROUND_OFF * size)), name


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", [None, 0.01])
def test_rows_of_members_that_share_are_those_of_solve(accuracy: float | None):
    """One factorization for all loads and gaps on each mesh, and for each modulus."""
    problem = CYLINDER.with_value("accuracy", accuracy)
    plan = study_plan(problem, {LOAD: [10, 50.0], PLACE: [0.0, -0.5], "material.young_modulus": [900, 1100]})
    for row in rows(plan):
        alone = bemcontact.solve(problem.with_values(row.values))
        assert_same(row, row_of(row.number, row.values, alone))


def test_one_factorization_serves_all_loads(monkeypatch: pytest.MonkeyPatch):
    solved = []
    original = condensing.solve_system
    monkeypatch.setattr(condensing, "solve_system", lambda system: solved.append(system) or original(system))
    rows(study_plan(CYLINDER, {LOAD: [10, 20, 30, 40]}))
    assert len(solved) == 1


def test_a_key_of_loads_that_changes_the_matrix_is_not_shared():
    """A traction in place of a condition of displacement: the unknowns of the edge are others."""
    held: dict[str, Any] = {"displacement": {"x": 0}}
    plan = study_plan(CYLINDER, {"conditions.axis": [held, {"displacement": {"x": 0, "y": 0}}]})
    found = rows(plan)
    for row in found:
        assert_same(row, row_of(row.number, row.values, bemcontact.solve(CYLINDER.with_values(row.values))))
    assert found[0].outputs["peak"].value != pytest.approx(found[1].outputs["peak"].value, rel=1e-3)


@pytest.mark.slow
def test_rows_of_load_cases_are_those_of_solve():
    for row in rows(study_plan(WEDGE, {"accuracy": [0.05]})):
        alone = bemcontact.solve(WEDGE.with_case(row.values["case"]).with_value("accuracy", row.values["accuracy"]))
        assert_same(row, row_of(row.number, row.values, alone))


def test_contacts_that_a_motion_moves_are_those_of_solve():
    """The link slides along the drum, whose face is then elsewhere beside it: the matrix changes with the normals."""
    plan = study_plan(LINK, {"contact_zones.drum.surface.radius": [90.0, 89.99]})
    assert len([*plan.groups()]) == 1
    for row in rows(plan):
        result = bemcontact.solve(LINK.with_values(row.values))
        as_drawn = condensing.condensed(LINK.with_values(row.values)).contact
        assert not (result.contact.normals == as_drawn.normals).all()
        assert_same(row, row_of(row.number, row.values, result))


def test_a_member_that_fails_is_a_row_and_the_others_are_solved():
    """A pull has no contact state; it shares its matrix with the others."""
    found = rows(study_plan(CYLINDER, {LOAD: [10, -10, 20]}))
    assert [row.status for row in found] == ["mesh not assessed", "failed", "mesh not assessed"]
    assert found[1].message.startswith("the load of (0, 80) kN/cm pulls the body off its support")
    assert found[1].holds is False
    assert found[1].outputs == {}


def test_values_that_do_not_go_together_are_a_row():
    """Elements may be left out where a mesh is found, and no mesh need be found where they are stated."""
    problem = CYLINDER.with_value("accuracy", 0.01)
    plan = study_plan(problem, {"boundary.outer.top.elements": [4, None], "mesh.adapt": [True, False]})
    assert [row.status for row in rows(plan)].count(MemberStatus.FAILED) == 1


def test_a_mesh_that_is_not_met_is_a_status():
    row = rows(study_plan(CYLINDER, {"accuracy": [1e-6], "mesh.adapt": [False]}))[0]
    assert (row.status, row.certified, row.met, row.holds) == (MemberStatus.NOT_MET, True, False, False)
    assert "0.0001 % is asked" in row.message


def test_a_broken_program_is_a_row(monkeypatch: pytest.MonkeyPatch):
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(work, "_solved", broken)
    assert "please report it: ZeroDivisionError" in rows(study_plan(CYLINDER, {LOAD: [10]}))[0].message


def test_a_part_of_a_group_has_the_same_numbers_to_the_last_digit():
    """After a kill the rest of a group is solved with the same factorization and right sides."""
    plan = study_plan(CYLINDER, {LOAD: [10, 20, 30, 40]})
    whole = rows_on_one_thread(plan, Task(group=(0, 1, 2, 3), wanted=(0, 1, 2, 3)))
    assert rows_on_one_thread(plan, Task(group=(0, 1, 2, 3), wanted=(1, 3))) == [whole[1], whole[3]]


def test_doubled_loads_and_modulus_give_doubled_forces():
    """A change of the unit of force: pressures double, and lengths and relative errors stay."""
    problem = CYLINDER.with_value("accuracy", 0.01)
    one, two = (
        rows(study_plan(problem, {LOAD: [factor * 20.0], "material.young_modulus": [factor * 1000.0]}))[0]
        for factor in (1, 2)
    )
    for name, power in (("peak", 1), ("resultant_y", 1), ("force.foot", 1), ("length.foot", 0), ("displacement", 0)):
        for part in ("value", "error"):
            expected = 2**power * getattr(one.outputs[name], part)
            assert getattr(two.outputs[name], part) == pytest.approx(expected, rel=1e-6)
