"""The schema of report.json is what a report holds: neither more nor less."""

import json
from typing import Any

import numpy as np
import pytest
from contact_problems import random_contact
from jsonschema import Draft202012Validator, ValidationError, validate

from bemcontact.analysis import compare as comparing
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.options import ComparisonOptions
from bemcontact.report.reproduction_schema import reproduction_schema
from bemcontact.report.schema import Report, report_schema
from bemcontact.spec import load

SPURIOUS = CondensedContact.from_compliance([[1.0, 2.0], [1.0, 1.0]], [-1.0, -2.0])


def reports() -> dict[str, dict]:
    cylinder = load("models/cylinder_on_plane.yaml")
    cases = {
        "cylinder": (ComparisonOptions.of(weights=["tributary", "consistent"], penalties=[1, 1e3]), cylinder, (1, 2)),
        "fitted": (ComparisonOptions.of(["qp3"]), cylinder.with_value("mesh.fit_contact_edges", True), (1,)),
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
    return {name: json.loads(comparing.study(*case).to_json()) for name, case in cases.items()}


@pytest.fixture(scope="module")
def written(request: pytest.FixtureRequest) -> dict[str, dict]:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(request.config.rootpath)
        return reports()


def test_it_is_a_schema():
    Draft202012Validator.check_schema(report_schema())


@pytest.mark.parametrize("stated", [report_schema(), reproduction_schema()])
def test_it_tells_of_each_field_what_it_means(stated: dict[str, Any]):
    """Every object and every key has a description, which is a sentence."""
    objects = {"the whole": stated, **{name: item for name, item in stated["$defs"].items() if "properties" in item}}
    assert len(objects) > 10
    for name, part in objects.items():
        for key, item in ({"itself": part} | part["properties"]).items():
            assert item.get("description", "").endswith("."), f"{name}: {key}"


def test_lengths_pressures_and_forces_have_their_units():
    """Of what report.json has in units: each of them named [L], [p], [p L] or [p L²]."""
    units = {
        ("Answer", "pressure"): "[p]", ("Answer", "gap"): "[L]", ("Answer", "normal_displacement"): "[L]",
        ("Answer", "resultant"): "[p L]", ("Answer", "resultant_moment"): "[p L²]", ("Peak", "pressure"): "[p]",
        ("Interval", "arc"): "[L]", ("Contact", "initial_gap"): "[L]", ("Contact", "tributary_lengths"): "[L]",
        ("Contact", "motion_load"): "[p L]", ("Scales", "pressure"): "[p]", ("Certificate", "error_bound"): "[p]",
        ("Expected", "peak"): "[p]", ("Expected", "resultant"): "[p L]", ("Expected", "contact_length"): "[L]",
    }  # fmt: skip
    stated = report_schema()["$defs"]
    for (name, key), unit in units.items():
        assert unit in stated[name]["properties"][key]["description"], f"{name}: {key}"


def test_reports_of_all_kinds_are_valid_and_nothing_is_left_out(written: dict[str, dict]):
    for report in written.values():
        validate(report, report_schema(), Draft202012Validator)
        assert json.loads(Report.model_validate(report).model_dump_json()) == report


def test_a_report_with_a_key_too_many_or_too_few_is_not(written: dict[str, dict]):
    report = written["free"]
    for wrong in ({**report, "extra": 1}, {key: value for key, value in report.items() if key != "levels"}):
        with pytest.raises(ValidationError):
            validate(wrong, report_schema(), Draft202012Validator)
