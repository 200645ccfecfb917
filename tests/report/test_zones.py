"""Tables of zones, points and stresses: their numbers are those of the results, and add up."""

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from drawings import roller_in_a_groove
from results import EACH, cases, condensed, punched, rolled

import bemcontact
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.report.contact_words import units_of
from bemcontact.report.zones import (
    by_case,
    interval_rows,
    result_table,
    tables_of,
    zone_rows,
)


def read(results: Result | CaseResults, name: str) -> list[dict[str, str]]:
    return [*csv.DictReader(io.StringIO(result_table(results, name)))]


@pytest.mark.parametrize("name", EACH)
def test_zones_have_the_forces_and_moments_that_add_up_to_the_resultant(name: str):
    """One line for each zone, also for one without contact, and for each of its intervals, which carry its force."""
    results = EACH[name]()
    lines, parts = read(results, "zones.csv"), read(results, "intervals.csv")
    for case, result in by_case(results).items():
        own = {line["zone"]: line for line in lines if line["case"] == case}
        assert len(own) == sum(line["case"] == case for line in lines)
        assert [*own] == [*result.contact.zone_names]
        force = np.sum([[float(line["force_x"]), float(line["force_y"])] for line in own.values()], axis=0)
        where = result.footprint.resultant
        assert force == pytest.approx(where.force, abs=1e-12 * np.hypot(*force))
        moment = sum(float(line["moment"]) for line in own.values())
        assert moment == pytest.approx(where.moment, abs=1e-9 * max(1.0, abs(where.moment)))
        of_case = [line for line in parts if line["case"] == case]
        assert len(of_case) == len(result.footprint.intervals) == sum(int(line["intervals"]) for line in own.values())
        for zone, line in own.items():
            for column in ("length", "force_x", "force_y", "moment"):
                total = sum(float(part[column]) for part in of_case if part["zone"] == zone)
                assert total == pytest.approx(float(line[column]), rel=1e-9, abs=1e-12)


def test_forces_name_the_body_on_which_they_act():
    """A stack under 5 N/mm² on 30 mm: the lower body of each joint is pressed down by 150 N/mm, the upper one up."""
    stack = bemcontact.load(Path(__file__).parents[2] / "models" / "bodies" / "stack_of_three.yaml").to_dict()
    stack["contacts"]["lower joint"]["between"] = ["base/top", "middle/bottom"]
    result = bemcontact.solve(bemcontact.problem(stack))
    for name in ("zones.csv", "intervals.csv"):
        found = {line["zone"]: (line["body"], float(line["force_y"])) for line in read(result, name)}
        assert found["upper joint"] == ("top", pytest.approx(150))
        assert found["lower joint"] == ("base", pytest.approx(-150))
    assert {line["body"] for line in read(rolled(), "zones.csv")} == {""}


def test_each_stretch_of_contact_has_the_force_and_the_peak_of_its_own():
    """A heavy roller in a groove of two faces at a right angle: by symmetry each carries weight / sqrt(2) across it."""
    result = bemcontact.solve(roller_in_a_groove())
    (zone,), (left, right) = read(result, "zones.csv"), read(result, "intervals.csv")
    weight = 0.02 * np.pi * 10**2
    assert float(zone["force_y"]) == pytest.approx(weight, rel=1e-3)
    assert {np.sign(float(left["start_x"])), np.sign(float(right["start_x"]))} == {-1, 1}
    for line in (left, right):
        side = -np.sign(float(line["start_x"]))
        assert (float(line["force_x"]), float(line["force_y"])) == pytest.approx(
            (side * weight / 2, weight / 2), rel=1e-2
        )
        assert float(line["peak"]) == pytest.approx(float(zone["peak"]), rel=1e-2)
        assert np.sign(float(line["peak_x"])) == -side
        assert min(float(line["start_x"]), float(line["end_x"])) <= float(line["peak_x"])
        assert max(float(line["start_x"]), float(line["end_x"])) >= float(line["peak_x"])
    rows = [*interval_rows(result.to_dict(), units_of(result.contact))]
    assert [row["zone"] for row in rows] == ["seat", "seat"]
    assert all(" at (" in row["peak"] for row in rows)
    assert [*interval_rows(rolled().to_dict(), units_of(rolled().contact))] == []


def test_errors_in_the_table_are_those_of_the_error_bars():
    """Absolute ones, in the unit of the number before them; unknown ones and infinite peaks are empty."""
    (zone,), (interval,) = read(rolled(), "zones.csv"), read(rolled(), "intervals.csv")
    for line, quantity, column in ((zone, "peak", "peak"), (interval, "length", "length")):
        bar = rolled().accuracy.bar_of(quantity, "foot")
        assert float(line[column]) == pytest.approx(bar.value, rel=1e-6)  # the bar has it before the polish
        assert float(line[f"{column}_error"]) == pytest.approx(bar.bar * bar.value)
    (infinite, *_) = read(punched(), "zones.csv")
    assert infinite["peak"] == infinite["peak_error"] == infinite["peak_x"] == ""
    assert {line["peak"] for line in read(punched(), "intervals.csv")} == {""}
    assert (
        read(condensed(), "zones.csv")[0]["peak_error"] == read(condensed(), "intervals.csv")[0]["length_error"] == ""
    )


def test_points_are_listed_along_the_boundary():
    """The trapezoidal sum of the weights is the force: each point is there once, with its pressure and gap."""
    lines = read(rolled(), "points.csv")
    contact = rolled().contact
    assert len(lines) == contact.size
    assert np.diff([float(line["arc"]) for line in lines]).min() > 0
    pressure = {(float(line["x"]), float(line["y"])): float(line["pressure"]) for line in lines}
    assert [pressure[tuple(point)] for point in contact.points.tolist()] == rolled().solution.pressure.tolist()
    assert sum(int(line["touching"]) for line in lines) == rolled().touching.sum()


def test_stress_along_edges_has_the_pressure_of_the_contact():
    """That acts along the normal of the surface, so pressure and shear on the inclined rim are its components."""
    lines, edges = read(rolled(), "stress.csv"), rolled().problem.edges_of("foot")
    on_rim = [line for line in lines if line["edge"] in edges]
    here = {(line["x"], line["y"]): np.hypot(float(line["pressure"]), float(line["shear"])) for line in on_rim}
    known = {(line["x"], line["y"]): float(line["pressure"]) for line in read(rolled(), "points.csv")}
    shared = here.keys() & known.keys()
    assert len(shared) > 10
    assert all(here[place] == pytest.approx(known[place], abs=1e-9 * max(known.values())) for place in shared)
    assert "" in {line["hoop"] for line in read(punched(), "stress.csv")}  # where it is infinite


def test_a_condensed_problem_has_no_stress():
    assert {*tables_of(condensed())} == {"zones.csv", "intervals.csv", "points.csv"}
    assert {*tables_of(cases())} == {"zones.csv", "intervals.csv", "points.csv", "stress.csv", "largest_stresses.csv"}


def test_rows_say_in_words_what_a_zone_does():
    """Its place, its peak with the error, its force; an infinite pressure has its intensity."""
    units = units_of(rolled().contact)
    (row,) = zone_rows(rolled().to_dict(), units)
    assert row["zone"] == "foot"
    assert "±" in row["peak"]
    assert row["intensity"] == "–"
    (row,) = zone_rows(punched().to_dict(), units)
    assert row["peak"] == "infinite"
    assert row["intensity"].startswith("K = ")


def test_largest_stresses_as_csv():
    """Values, absolute errors and places are those of the result; where stress is infinite there is a place alone."""
    largest = rolled().largest_stresses()
    lines = {(line["stress"], line["of"]): line for line in read(rolled(), "largest_stresses.csv")}
    for key, peak in ((("max_shear", "foot"), largest.shear["foot"]), (("von_mises", "boundary"), largest.boundary)):
        assert peak is not None
        error = "" if peak.bar is None else f"{peak.bar * peak.value}"
        assert lines[key]["value"] == f"{peak.value}"
        assert lines[key]["error"] == error
        assert (float(lines[key]["x"]), float(lines[key]["y"])) == peak.point
    infinite = [line for line in read(punched(), "largest_stresses.csv") if line["of"] == "infinite"]
    assert len(infinite) == len(punched().largest_stresses().singular) > 0
    assert {line["value"] for line in infinite} == {""}
    reasons = [line["none"] for line in read(punched(), "largest_stresses.csv") if line["none"]]
    assert reasons == [str(why) for why in punched().largest_stresses().missing.values()] != []
