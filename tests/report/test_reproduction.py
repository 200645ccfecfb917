"""The page and the table of the paper's problems: their numbers are those of numbers.json, and nothing else."""

import copy
import json
import re
from html import unescape
from io import StringIO
from typing import Any

import pytest
import schemas
from jsonschema import ValidationError
from page_reader import ensure_self_contained, read
from reproductions import on_base_meshes, with_coarse_mesh_judged
from rich.console import Console

from bemcontact.report.reproduction import render, reproduction_summary

SVG = b'<svg xmlns="http://www.w3.org/2000/svg"/>'


def record() -> dict[str, Any]:
    """The record as another program reads it from the file."""
    return json.loads(on_base_meshes().to_json())


def table(record: dict[str, Any]) -> str:
    console = Console(width=100, file=StringIO())
    with console.capture() as captured:
        console.print(reproduction_summary(record))
    return captured.get()


def test_the_page_is_whole_and_needs_nothing_else():
    names = [
        f"{item['model'].replace('_', '-')}-{what}" for item in record()["problems"] for what in ("problem", "pressure")
    ]
    page = render(record(), dict.fromkeys(names, SVG))
    reader = read(page)
    ensure_self_contained(page, reader)
    pictures = [attrs for tag, attrs in reader.tags if tag == "img"]
    assert len(pictures) == 10
    assert all(picture["alt"] for picture in pictures)
    assert "The paper's five problems" in reader.text
    assert "Reproduced: in agreement with every reference." in reader.text
    assert "Equations: unique solution proved." in reader.text
    assert "Mesh: not assessed." in reader.text


def test_page_has_the_statements_of_the_paper():
    text = read(render(record(), {})).text
    for item in record()["problems"]:
        for told in (item["name"][1:], *(row["statement"] for row in item["statements"]), *item["differs"]):
            assert told in text
        for run in item["runs"]:
            assert run["description"] in text


def test_numbers_come_from_the_record_alone():
    """Another finding, expectation and count in the record are others on the page and in the table."""
    changed = copy.deepcopy(record())
    curved = changed["problems"][0]
    curved["statements"][0]["computed"][0] = [12.125]
    curved["runs"][2]["level"]["scores"][0]["computed"] = 0.4375
    curved["iterations"]["qp1"] = 6543
    curved["runs"][0]["level"]["comparison"]["contenders"][1]["answer"]["iterations"] = 7654
    for write, told in (
        (lambda item: read(render(item, {})).text, ("12.125", "0.4375", "6543", "7654")),
        (table, ("12.125", "6543", "7654")),
    ):
        before, after = write(record()), write(changed)
        for number in told:
            assert number not in before
            assert number in after


def test_iterations_of_qpsol_are_above_ours():
    marked_up = render(record(), {}).split('<section id="iterations">')[1]
    section = " ".join(unescape(re.sub(r"<[^>]+>", " ", marked_up)).split())
    assert "QPSOL, the paper – 63 47 70 –" in section
    for item in record()["problems"]:
        for run in item["runs"]:
            compared = run["level"]["comparison"]
            solvers = (*compared["contenders"], compared["reference"])
            own = {solver["formulation"]: solver["answer"]["iterations"] for solver in solvers}
            counts = (own[name] for name in ("qp1", "qp2", "qp3", "complementarity"))
            cells = (compared["contact"]["contact_nodes"], *counts)
            assert " ".join(map(str, (run["label"], *cells))) in section


def test_failed_references_are_named():
    failed = json.loads(with_coarse_mesh_judged().to_json())
    text = read(render(failed, {})).text
    assert "The paper's two problems" in text
    assert "Not reproduced." in text
    assert "See Fig. 5." in text
    assert "does not hold" in text
    assert "NOT reproduced" in table(failed)


def test_the_table_fits_a_terminal():
    told = table(record())
    assert max(map(len, told.splitlines())) <= 100
    for words in ("Fig. 6", "no contact", "printed E", "QPSOL, the paper", "reproduced."):
        assert words in told


@pytest.mark.slow
def test_the_schema_is_what_the_record_holds():
    validator = schemas.of_result("reproduction")
    for written in (record(), json.loads(with_coarse_mesh_judged().to_json())):
        validator.validate(written)
    with pytest.raises(ValidationError):
        validator.validate({**record(), "extra": 1})
