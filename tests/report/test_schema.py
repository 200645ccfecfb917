"""The schemas of results are what their JSON holds: neither more nor less."""

import json
from typing import Any

import numpy as np
import pytest
import schemas
from contact_problems import random_contact
from jsonschema import ValidationError
from mesh_studies import punch, roller
from results import designed

import bemcontact
from bemcontact.analysis import compare as comparing
from bemcontact.analysis.case_comparisons import compare_cases
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.options import ComparisonOptions
from bemcontact.report.schema import RESULTS, schema
from bemcontact.spec import load

SPURIOUS = CondensedContact.from_compliance([[1.0, 2.0], [1.0, 1.0]], [-1.0, -2.0])


def reports() -> dict[str, dict]:
    cases = {
        "roller": (ComparisonOptions.of(weights=["tributary", "consistent"], penalties=[1, 1e3]), roller(), (1, 2)),
        "fitted": (ComparisonOptions.of(["qp3"]), roller(mesh={"adapt": True}, accuracy=0.05), (1,)),
        "infinite": (ComparisonOptions.of(["qp3"]), punch(), (1, 2)),
        "refused": (ComparisonOptions.of(["qp3"]), SPURIOUS, (1,)),
        "spurious": (ComparisonOptions.of(["qp1", "qp2"], starts=3), SPURIOUS, (1,)),
        "no contact": (ComparisonOptions.of(), CondensedContact.from_compliance(np.eye(2), [1.0, 1.0]), (1,)),
        "fixed by equilibrium": (
            ComparisonOptions.of(),
            CondensedContact.from_compliance([[1.0]], [0.0], rigid_motions=[1.0], motion_load=-1.0),
            (1,),
        ),
        "free": (ComparisonOptions.of(), random_contact(3, 7, 2), (1,)),
    }
    return {name: json.loads(comparing.mesh_study(*case).to_json()) for name, case in cases.items()}


@pytest.fixture(scope="module")
def written(request: pytest.FixtureRequest) -> dict[str, dict]:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(request.config.rootpath)
        return reports()


@pytest.mark.parametrize("kind", RESULTS)
def test_schema_is_valid_and_describes_each_field(kind: str):
    """Every object and every key has a description, which is a sentence."""
    assert schemas.of_result(kind)  # which checks that it is a schema
    stated = schema(kind)
    objects = {"the whole": stated, **{name: it for name, it in stated.get("$defs", {}).items() if "properties" in it}}
    for name, part in objects.items():
        for key, item in ({"itself": part} | part["properties"]).items():
            assert item.get("description", "").endswith("."), f"{name}: {key}"
            assert "default" not in item, f"{name}: {key}"


def test_lengths_pressures_and_forces_have_their_units():
    """What report.json has in units names them: [L], [p], [p L] or [p L²]."""
    units = {
        ("AnswerRecord", "pressure"): "[p]", ("AnswerRecord", "gap"): "[L]",
        ("AnswerRecord", "normal_displacement"): "[L]", ("AnswerRecord", "resultant"): "[p L]",
        ("AnswerRecord", "resultant_moment"): "[p L²]", ("Peak", "pressure"): "[p]",
        ("ContactInterval", "arc"): "[L]", ("ContactRecord", "initial_gap"): "[L]",
        ("ContactRecord", "tributary_lengths"): "[L]", ("ContactRecord", "motion_load"): "[p L]",
        ("ScalesRecord", "pressure"): "[p]", ("Certificate", "error_bound"): "[p]", ("Expected", "peak"): "[p]",
        ("Expected", "resultant"): "[p L]", ("Expected", "contact_length"): "[L]",
    }  # fmt: skip
    stated = schema("report")["$defs"]
    for (name, key), unit in units.items():
        assert unit in stated[name]["properties"][key]["description"], f"{name}: {key}"


def of_each_kind() -> dict[str, list[Any]]:
    """Results of each kind but mesh studies, and reproductions of the paper, which are tested with their page."""
    tools = load("models/gallery/body_between_two_tools.yaml", variant="stated mesh").with_case("raised")
    contact = random_contact(3, 7, 2)
    loose = CondensedContact.from_compliance(np.eye(2), [1.0, 1.0])
    cases = load("models/gallery/roller_in_v_block.yaml", variant="stated mesh")
    relief = bemcontact.Relief(lower=-0.2, upper=0.4, slope=0.2)
    return {
        "result": [
            bemcontact.solve(roller(), "qp2"),
            bemcontact.solve(roller(mesh={"adapt": True}, accuracy=0.05)),
            bemcontact.solve(tools),
            bemcontact.solve(punch()),
            bemcontact.solve(loose),
            bemcontact.solve(contact, "qp1", starts=2),
        ],
        "cases": [bemcontact.solve_cases(cases)],
        "case_report": [compare_cases(ComparisonOptions.of(), cases)],
        "comparison": [bemcontact.compare(contact, starts=2)],
        "study": [
            bemcontact.study(roller(), {"conditions.top.pressure": [20.0, -1.0]}),
            bemcontact.study(cases, {"accuracy": [None]}, ["peak", "force"]),
        ],
        "path": [
            bemcontact.follow(roller(), "conditions.top.pressure", 20.0, start=0.0),
            bemcontact.follow(punch(), "conditions.top.pressure", 1.0),
        ],
        "load_path": [bemcontact.load_path(loose, CondensedContact.from_compliance(np.eye(2), [-1.0, 1.0]))],
        "sensitivities": [bemcontact.sensitivities(roller(), ["conditions.top.pressure"])],
        "starts": [bemcontact.random_starts(contact, "qp1", count=2)],
        "design": [bemcontact.design_gap(contact, relief), designed()],
    }


@pytest.mark.slow
def test_results_of_each_kind_are_what_their_schema_states():
    results = of_each_kind()
    assert {*results, "report", "reproduction"} == {*RESULTS}
    for kind, several in results.items():
        for result in several:
            schemas.of_result(kind).validate(json.loads(json.dumps(result.to_dict(), allow_nan=False)))


@pytest.mark.slow
def test_reports_of_all_kinds_are_valid_and_nothing_is_left_out(written: dict[str, dict]):
    for report in written.values():
        schemas.of_result("report").validate(report)


def test_a_report_with_a_key_too_many_or_too_few_is_not(written: dict[str, dict]):
    report = written["free"]
    for wrong in ({**report, "extra": 1}, {key: value for key, value in report.items() if key != "levels"}):
        with pytest.raises(ValidationError):
            schemas.of_result("report").validate(wrong)
