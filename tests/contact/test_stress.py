"""What stresses print: the numbers of the first points, their units, and why a number is missing."""

import numpy as np

from bemcontact.contact.stress import (
    INSIDE,
    PRINTED,
    EdgeStress,
    Labels,
    LargestStresses,
    NoPeak,
    PointKind,
    Stress,
    StressPeak,
)

MM = Labels(length="mm", stress="MPa")
NOWHERE = np.zeros((0, 2))


def stress(count: int, kind: PointKind = PointKind.INSIDE, labels: Labels = MM) -> Stress:
    """Uniaxial tension of 3 along x, so that both equivalent stresses are known: 3, and 1.5 in shear."""
    values = np.tile([3.0, 0.0, 0.0], (count, 1))
    points = np.column_stack([np.arange(count), np.full(count, 0.25)])
    return Stress(points=points, components=values, zz=np.zeros(count), kind=np.array([kind] * count), labels=labels)


def test_stress_prints_a_row_for_each_of_the_first_points():
    head, names, *rows = repr(stress(PRINTED + 2)).splitlines()
    assert head == f"<Stress at {PRINTED + 2} points, von Mises stress up to 3 MPa>"
    assert names.split("  ")[:1] == ["x [mm]"]
    assert "xx [MPa]" in names
    assert rows[1].split() == ["1", "0.25", "3", "0", "0", "0", "3", "1.5", "inside"]
    assert len({*map(len, [names, *rows[:-1]])}) == 1
    assert (len(rows), rows[-1]) == (PRINTED + 1, "2 more points")


def test_what_is_round_off_beside_the_largest_stress_is_zero_in_print():
    nearly = np.array([[3.0, 2e-12, -2e-13], [1e-3, np.nan, 0.0]])
    some = Stress(points=np.zeros((2, 2)), components=nearly, zz=np.zeros(2), kind=np.array(["inside", "singular"]))
    _, _, first, second = repr(some).splitlines()
    assert first.split()[2:5] == ["3", "0", "0"]
    assert second.split()[2:5] == ["0.001", "nan", "0"]


def test_stress_without_points_or_units_is_printed_too():
    assert repr(stress(0)) == "<Stress at 0 points>"
    assert repr(stress(1, labels=Labels())).splitlines()[1].split()[:3] == ["x", "y", "xx"]
    assert "1 of them singular" in repr(stress(1, PointKind.SINGULAR))


def test_an_edge_prints_its_peak_and_its_place_in_units():
    nothing = np.zeros((1, 3))
    values = {"points": np.zeros((1, 3, 2)), "arc": nothing, "hoop": nothing, "pressure": nothing, "shear": nothing}
    edge = EdgeStress(
        edge="rim", **values, von_mises=nothing, peak=-12.5, peak_at=(1.0, 2.0), peak_arc=0.0, singular=NOWHERE,
        labels=MM,
    )  # fmt: skip
    assert repr(edge) == "<EdgeStress of 'rim': 1 element, hoop stress -12.5 MPa at (1, 2) mm>"


def test_largest_stresses_print_each_with_its_error_and_place_or_why_there_is_none():
    below = StressPeak(value=200.0, point=(-1e-14, 0.5), depth=0.5, bar=0.01)  # x is round-off
    corner = StressPeak(value=50.0, point=(1.0, 0.0), depth=0.0, edge="top", body="ring")
    largest = LargestStresses(
        shear={"foot": below}, inside=None, boundary=corner, missing={INSIDE: NoPeak.TO_BOUNDARY},
        singular=np.zeros((1, 2)), labels=MM,
    )  # fmt: skip
    assert repr(largest).splitlines() == [
        "<LargestStresses below 1 zone, infinite at 1 place>",
        "shear below foot: 200 ± 2 MPa at (0, 0.5) mm, 0.5 mm deep",
        f"von Mises, inside: {NoPeak.TO_BOUNDARY}",
        "von Mises, on the boundary: 50 MPa at (1, 0) mm, edge top, body ring",
    ]
