"""A Young's modulus that no solid has is noted where both labels are known units, and only there."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

import bemcontact
from bemcontact.analysis.check import check
from bemcontact.problems.units import METERS, NEWTONS, SOFTEST, STIFFEST, Units

SOLIDS = {"diamond": 1.2e12, "steel": 2.1e11, "concrete": 3e10, "polyethylene": 2e8, "rubber": 1e6, "gel": 5e3}
"""Young's moduli [Pa] from handbooks."""


@given(length=st.sampled_from(sorted(METERS)), force=st.sampled_from(sorted(NEWTONS)))
def test_no_solid_is_doubted_in_any_units(length: str, force: str):
    """Nor where a label is not known; twice the limits are doubted, with the number in Pa and that of steel."""
    units = Units(length=length, force=force)
    assert units.pascals is not None
    for modulus in SOLIDS.values():
        assert [*units.doubts(modulus / units.pascals, 0.4)] == []
    for modulus in (2 * STIFFEST, SOFTEST / 2):
        (note,) = units.doubts(modulus / units.pascals, 0.4)
        assert f"is {modulus:.3g} Pa" in note
        assert f"steel has {2.1e11 / units.pascals:.3g}" in note
        for unknown in (Units(length=length), Units(force=force), Units(length="cubit", force=force)):
            assert [*unknown.doubts(modulus / units.pascals, 0.4)] == []


def test_a_metal_in_other_units_is_noted():
    """E = 210e3 is steel in N/mm², and in N/m² a soft foam, whose Poisson's ratio is not that of a metal."""
    meters = Units(length="m", force="N")
    (note,) = meters.doubts(210e3, 0.3)
    assert note.startswith("Young's modulus is 2.1e+05 Pa, softer than rubber")  # once, as it is stated in Pa
    assert "steel has 2.1e+11" in note
    assert [*meters.doubts(210e3, 0.1)] == []
    for modulus in (210e3, 0.21):  # steel, and the same foam
        assert [*Units(length="mm", force="N").doubts(modulus, 0.3)] == []


def test_units_of_stress_agree_with_each_other():
    """N/mm² is a million times N/m²; a pound per square inch has 6894.757 Pa."""
    pairs = {("mm", "N"): 1e6, ("m", "N"): 1.0, ("cm", "kN"): 1e7, ("in", "lbf"): 6894.757}
    for (length, force), pascals in pairs.items():
        assert Units(length=length, force=force).pascals == pytest.approx(pascals, rel=1e-6)


@pytest.mark.parametrize("label", [
    *((key, word) for key, known in (("length", METERS), ("force", NEWTONS)) for word in known),
    ("length", ""), ("force", ""), ("length", "furlong"), ("length", "cubit"), ("length", "yd"), ("length", "mi"),
    ("length", "pm"), ("force", "dyn"), ("force", "pdl"), ("force", "tf"), ("force", "cN"), ("length", "any"),
])  # fmt: skip
def test_other_labels_are_free(label: tuple[str, str]):
    """Known units, and those that exist and are not known, however short, are not taken for misspelled ones."""
    assert [*Units.model_validate(dict([label])).misspelled()] == []


@pytest.mark.parametrize(
    ("key", "label", "meant"),
    [
        ("length", "inchs", "'inch'"),
        ("length", "inches", "'inch'"),
        ("length", "MM", "'mm'"),
        ("length", "Cm", "'cm'"),
        ("force", "KN", "'kN'"),
        ("force", "lbs", "'lb'"),
        ("force", "kips", "'kip'"),
        ("force", "kg", "'kgf'"),
        ("force", "mn", "'MN' or 'mN'"),  # either in small letters
    ],
)
def test_a_misspelled_label_is_noted_with_the_known_one(key: str, label: str, meant: str):
    (note,) = Units(**{key: label}).misspelled()
    assert note.startswith(f"units.{key}: '{label}' is not a known unit; did you mean {meant}?")


def test_check_solve_and_json_note_a_misspelled_label():
    problem = bemcontact.load("models/gallery/block_in_corner.yaml").with_value("units.length", "inchs")
    (note,) = problem.units.misspelled()
    result = bemcontact.solve(problem, accuracy=0.05)
    for notes in (check(problem).notes, result.notes, result.to_dict()["notes"]):
        assert [*notes].count(note) == 1


@pytest.mark.parametrize(
    ("modulus", "found"), [(206e9, "2.06e+17 Pa (2.06e+11 MPa), stiffer than diamond"), (210e3, None)]
)
def test_check_and_solve_note_a_modulus_of_other_units(modulus: float, found: str | None):
    problem = bemcontact.load("models/gallery/block_in_corner.yaml").with_value("material.young_modulus", modulus)
    told = [note for note in check(problem).notes if note.startswith("Young's modulus is")]
    assert told == [note for note in bemcontact.condense(problem, accuracy=0.05).notes if note in told]
    assert len(told) == (found is not None)
    assert all(found in note for note in told if found)
