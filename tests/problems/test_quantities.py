"""Values with units: the numbers that they are, and what is refused; problems restated in other units."""

import io
import math
import re
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

import bemcontact
from bemcontact.problems import quantities
from bemcontact.problems.quantities import (
    DEGREES,
    FRACTION,
    RADIANS,
    Dimension,
    dimension_of,
    with_numbers,
)
from bemcontact.problems.units import METERS, NEWTONS
from bemcontact.report.text import result_summary

MODELS = sorted((Path(__file__).parents[2] / "models").rglob("*.yaml"))
UNITS = {"length": "mm", "force": "N"}


@pytest.mark.parametrize(
    ("path", "text", "number"),
    [
        (("material", "young_modulus"), "210 GPa", 210e3),
        (("material", "young_modulus"), "30e6 psi", 30e6 * 6894.757293168361e-6),
        (("materials", "steel", "young_modulus"), "210e3 N/mm²", 210e3),
        (("material", "young_modulus"), "210e3N/mm2", 210e3),
        (("boundary", "outer", 0, "center", 1), "1 cm", 10.0),
        (("boundary", "outer", 0, "radius"), "0.5 in", 12.7),
        (("boundary", "outer", 1, "fillet"), "200 µm", 0.2),
        (("boundary", "outer", 0, "angles", 0), "-0.5 rad", math.degrees(-0.5)),
        (("boundary", "outer", 0, "rotation"), "30 deg", 30.0),
        (("boundary", "mirror", "x"), "1 m", 1000.0),
        (("boundary", "outer", 0, "ends_at", 0), "25 %", 0.25),
        (("boundary", "outer", 0, "ends_at", 0, 1), "1 cm", 10.0),
        (("conditions", "top", "pressure"), "20 MPa", 20.0),
        (("conditions", "top", "pressure", "constant"), "2 bar", 0.2),
        (("conditions", "top", "pressure", "x"), "1 MPa/m", 1e-3),
        (("conditions", "top", "pressure", "along", 1, 0), "2 cm", 20.0),
        (("conditions", "top", "pressure", "along", 1, 1), "1 kPa", 1e-3),
        (("conditions", "top", "traction", "y"), "-1 kN/cm²", -10.0),
        (("conditions", "top", "traction", "y", "along", 0, 1), "-1 kN/cm²", -10.0),
        (("conditions", "top", "displacement", "x"), "1 um", 1e-3),
        (("conditions", "top", "displacement", "x", "y"), "1 mm/m", 1e-3),
        (("conditions", "top", "force", 0, "y"), "-4 kN/cm", -400.0),
        (("conditions", "top", "force", "width"), "1 cm", 10.0),
        (("tools", "press", "force", "y"), "2 kN/m", 2.0),
        (("tools", "press", "force", "moment"), "2 kN*m/m", 2000.0),
        (("tools", "press", "displacement", "rotation"), "1 deg", math.pi / 180),
        (("loads", "gravity", "density"), "7850 kg/m^3", 7.85e-9),
        (("loads", "gravity", "acceleration", 1), "-9.81 m/s^2", -9810.0),
        (("loads", "centrifugal", "angular_velocity"), "3000 rpm", 100 * math.pi),
        (("loads", "gravity", "density"), "7.85 g/cm3", 7.85e-9),
        (("loads", "gravity", "acceleration", 1), "-9.81 m/s2", -9810.0),
        (("loads", "temperature", "expansion"), "12e-6 1/K", 12e-6),
        (("loads", "temperature", "expansion"), "12e-6 /K", 12e-6),
        (("loads", "temperature", "expansion"), "1.2e-5/K", 12e-6),
        (("loads", "temperature", "change"), "50 °C", 50.0),
        (("contacts", "a", "gap"), "-10 um", -0.01),
        (("bodies", "a", "shift", 0), "1 cm", 10.0),
        (("bodies", "a", "rotate"), "1 turn", 360.0),
        (("contact_zones", "a", "surface", "points", 2, 0), "1 cm", 10.0),
        (("reference", "Hertz", "load"), "1 kN/mm", 1000.0),
        (("reference", "Hertz", "half_width"), "1 um", 1e-3),
        (("reference", "Hertz", "peak"), "1 GPa", 1000.0),
        (("accuracy",), "0.3 %", 0.003),
        (("variants", "soft", "set", "material.young_modulus"), "1 GPa", 1000.0),
        (("variants", "big", "set", "boundary.outer[0].radius"), "1 cm", 10.0),
    ],
)
def test_a_value_with_a_unit_is_its_number_in_the_units_of_the_problem(path, text, number):
    stated = text
    for step in reversed(path):
        stated = {step: stated} if isinstance(step, str) else [*[0] * step, stated]
    read, issues = with_numbers({"units": UNITS, **stated})
    assert issues == []
    for step in path:
        read = read[step]
    assert read == pytest.approx(number, rel=1e-12)


@pytest.mark.parametrize(
    ("path", "text", "words"),
    [
        (("material", "young_modulus"), "5 mm", "expected a stress such as 210 GPa; found 5 mm"),
        (("material", "young_modulus"), "210 GPA", "unknown unit 'GPA' in 210 GPA; did you mean GPa?"),
        (("material", "young_modulus"), "2e5 n/MM2", "unknown unit 'n/MM2' in 200000 n/MM2; did you mean N/mm2?"),
        (("material", "young_modulus"), "2 foo", "unknown unit 'foo' in 2 foo; write a stress such as 210 GPa"),
        (("conditions", "top", "pressure"), "20 mPa", "mPa in 20 mPa is a thousandth of Pa; write 20 MPa"),
        (("conditions", "top", "pressure", "x"), "5 MPa", "expected a slope"),
        (("boundary", "outer", 0, "radius"), "5 deg", "expected a length such as 5 mm; found 5 deg"),
        (("boundary", "outer", 0, "angles", 0), "5 mm", "expected an angle such as 30 deg; found 5 mm"),
        (("accuracy",), "1 mm", "expected a fraction such as 1 %; found 1 mm"),
    ],
)
def test_a_value_of_another_dimension_is_refused_at_its_place(path, text, words):
    stated = text
    for step in reversed(path):
        stated = {step: stated} if isinstance(step, str) else [*[0] * step, stated]
    _, (issue,) = with_numbers({"units": UNITS, **stated})
    assert issue.path == path
    assert issue.message.startswith(words)


def test_a_wrong_unit_of_a_single_force_is_one_error():
    """A single force is a list of one: its place in the list does not matter."""
    stated = {"units": UNITS, "conditions": {"top": {"force": {"y": "-200 N"}}}}
    with pytest.raises(bemcontact.ProblemError) as refused:
        bemcontact.problem(stated)
    (issue,) = (issue for issue in refused.value.issues if issue.path[0] == "conditions")
    assert issue.message == "expected a force per thickness such as 400 N/mm; found -200 N"


def test_names_and_other_texts_stay_as_they_are():
    stated = {"name": "5 mm", "description": "210 GPa", "contact_zones": {"5 mm": {"edges": "3 bar"}}, "case": "2 kN"}
    assert with_numbers(stated) == (stated, [])


@pytest.mark.parametrize(
    ("units", "place", "words"),
    [
        ({}, ("units",), "give length as one of m, dm, cm"),
        ({"length": "furlong", "force": "N"}, ("units", "length"), "give length as one of m"),
        ({"length": "mm", "force": "pony"}, ("units", "force"), "give force as one of N, kN"),
    ],
)
def test_numbers_of_unknown_units_are_refused_once(units, place, words):
    with pytest.raises(bemcontact.ProblemError) as refused:
        bemcontact.problem({"units": units, "material": {"young_modulus": "210 GPa"}, "accuracy": "1 %"})
    (issue,) = refused.value.issues
    assert issue.path == place
    assert words in issue.message


def test_without_pint_the_extra_is_named(monkeypatch):
    monkeypatch.setattr(quantities, "find_spec", lambda name: None)
    _, (issue,) = with_numbers({"units": UNITS, "accuracy": "1 %"})
    assert "bemcontact[units]" in issue.message


def unit_of(dimension: Dimension, length: str, force: str) -> str:
    """The unit of a dimension as a text, in units of length and force."""
    if dimension in (DEGREES, RADIANS):
        return "deg" if dimension == DEGREES else "rad"
    if dimension == FRACTION:
        return "dimensionless"
    powers = zip((length, force, "s", "K"), dimension[:4], strict=True)
    return "*".join(f"{unit}**({power})" for unit, power in powers if power) or "dimensionless"


def with_units(value, path, length, force):
    """What a problem states, with a unit behind each number that has one."""
    match value:
        case dict():
            below = quantities._below
            return {key: with_units(part, below(path, key), length, force) for key, part in value.items()}
        case list():
            return [with_units(part, (*path, i), length, force) for i, part in enumerate(value)]
        case bool() | str() | None:
            return value
    dimension = dimension_of(path)
    return value if dimension is None else f"{value!r} {unit_of(dimension, length, force)}"


def restated(problem, units):
    """A problem with a unit behind each number, whose numbers are converted to other units."""
    stated = problem.to_dict()
    own = stated.pop("units")
    return bemcontact.problem({**with_units(stated, (), own["length"], own["force"]), "units": units})


@pytest.mark.parametrize(
    "model", [pytest.param(it, id=it.stem, marks=[pytest.mark.slow] * (it.stem == "roller_bearing")) for it in MODELS]
)
def test_a_model_with_units_behind_its_numbers_is_the_same(model):
    """In its own units up to the rounding of a conversion there and back; elsewhere it is a sound problem too."""
    problem = bemcontact.load(model)
    same = restated(problem, problem.units.to_dict())
    assert same.parts[0].material.young_modulus == pytest.approx(problem.parts[0].material.young_modulus, rel=1e-15)
    for edge, other in zip(problem.edges, same.edges, strict=True):
        assert other.length == pytest.approx(edge.length, rel=1e-14)
    elsewhere = restated(problem, {"length": "m", "force": "N"})
    assert elsewhere.size == pytest.approx(problem.size * METERS[problem.units.length], rel=1e-14)


ROUNDED = {"two_cantilevers": 1e-6}
"""Part of a pressure, over the 1e-7 of others, up to which the rounding of coordinates in another unit changes it."""
MANY_BODIES = "roller_bearing"
"""The model that takes minutes; its bodies are those of others."""


def words_of(*results):
    """What the program prints of each result: its words without numbers, and without the units of any of them."""
    units = {unit for it in results for unit in (it.units.stress, it.units.line_force, it.units.length)}
    units |= {f"{it.units.force}·{it.units.length}/{it.units.length}" for it in results}
    for result in results:
        console = Console(file=io.StringIO(), width=10_000)
        console.print(result_summary(result))
        words = re.split(r"[\s(),;:]+", console.file.getvalue())
        yield [word for word in words if word not in units and not re.match(r"[-.\d]", word)]


@pytest.mark.slow
@pytest.mark.parametrize("units", [("m", "N"), ("in", "lbf")], ids="/".join)
@pytest.mark.parametrize("model", [path for path in MODELS if path.stem != MANY_BODIES], ids=lambda model: model.stem)
def test_other_units_change_no_answer_beyond_round_off(model, units):
    """On the same mesh forces, which equilibrium determines up to its round-off, agree to 1e-12.

    Gaps are differences of coordinates that are 1e3 to 1e7 times as large, and are rounded in the other unit: pressures
    agree to that part of round-off, over the condition of the equations, which is worst for slender beams.
    """
    stated = bemcontact.load(model)
    stated = stated.with_case(stated.case_names[0]) if stated.case_names else stated
    found = bemcontact.solve(stated, accuracy=0.1)
    assert found.problem is not None
    problem = found.problem.with_value("accuracy", None)
    one = bemcontact.solve(problem)
    other = bemcontact.solve(restated(problem, dict(zip(("length", "force"), units, strict=True))))
    length = METERS[problem.units.length] / METERS[units[0]]
    force = NEWTONS[problem.units.force] / NEWTONS[units[1]] / length
    pressure, forces = one.pressure * force / length, np.array([*one.forces.values()]) * force
    total = float(other.contact.weights @ other.pressure)  # of a ring that is pressed all around the forces are zero
    np.testing.assert_allclose(forces, [*other.forces.values()], rtol=0, atol=1e-12 * total)
    rounded = ROUNDED.get(model.stem, 1e-7) * pressure.max()
    np.testing.assert_allclose(pressure, other.pressure, rtol=0, atol=rounded)
    np.testing.assert_allclose(one.gap * length, other.gap, rtol=0, atol=1e-12 * problem.size * length)
    assert (other.certificate.kind, other.certified) == (one.certificate.kind, one.certified)
    words, others = words_of(one, other)
    assert words == others
