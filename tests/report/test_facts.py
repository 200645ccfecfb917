"""Facts and error bars in words: what is written never states more than what is known."""

import re
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from accuracies import accuracy, bar
from hypothesis import example, given
from hypothesis import strategies as st

import bemcontact
from bemcontact.problems import Units
from bemcontact.report.bars import (
    LEAST_SHOWN,
    accuracy_rows,
    error_alone,
    error_percent,
    with_bar,
    without_digits_beyond,
)
from bemcontact.report.facts import contact_intervals, facts, peak_of, peak_place

UNITS = Units(length="cm", force="kN")


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (183.335, 0.002, "183.3 ± 0.4"),
        (183335.0, 0.01, "183300 ± 1900"),
        (1.83335e7, 0.01, "(1.833 ± 0.019)e+07"),
        (0.0183335, 0.0075, "0.01833 ± 0.00014"),
        (3.0, 0.0, "3.00000 ± 0.00003"),
        (1713.47, 0.00134, "1713.5 ± 2.3"),
        (10.0, 0.034, "10.00 ± 0.34"),
        (10.0, 0.036, "10.0 ± 0.4"),
        (10.0, 0.02, "10.0 ± 0.2"),
        (0.0, 0.1, "0"),
        (12.5, None, "12.5"),
    ],
)
def test_numbers_with_error_bars(value: float, error: float | None, text: str):
    assert with_bar(value, error) == text


@given(st.floats(1e-9, 1e12), st.floats(0, 0.9), st.booleans())
@example(9.9999, 0.00999, False)
def test_a_number_has_no_digit_beyond_its_error(value: float, error: float, negative: bool):
    """The error is rounded up, by less than its double; the last digits of both are the same; the value is rounded."""
    value = -value if negative else value
    written = with_bar(value, error)
    number, shown, power = re.fullmatch(r"\(?(-?[\d.]+) ± ([\d.]+)\)?(?:e([+-]\d+))?", written).groups()  # pyright: ignore
    scale = 10.0 ** int(power or 0)
    least = max(error, LEAST_SHOWN) * abs(value)
    assert least * (1 - 1e-6) <= float(shown) * scale < 2 * least * (1 + 1e-6)
    assert Decimal(number).as_tuple().exponent == Decimal(shown).as_tuple().exponent
    assert len(shown.replace(".", "").strip("0")) <= 2
    assert abs(float(number) * scale - value) <= 0.5 * float(shown) * scale * (1 + 1e-6)


@given(st.floats(1e-9, 1e12), st.none() | st.floats(0, 0.9))
@example(1.83335e7, 0.01)
@example(1e-5, 0.3)
def test_a_number_alone_has_the_digits_that_it_has_beside_its_error(value: float, error: float | None):
    beside = re.match(r"\(?([\d.e+-]+)( ± [\d.]+\))?(.*)", with_bar(value, error)).groups()  # pyright: ignore
    power = beside[2] if beside[1] else ""
    assert without_digits_beyond(value, error) == beside[0] + power


@given(st.floats(1e-5, 1e3))
def test_an_error_in_per_cent_is_rounded_up(error: float):
    written = float(error_percent(error).removesuffix(" %"))
    assert 100 * error * (1 - 1e-6) <= written <= 110 * error * (1 + 1e-6)


def test_rows_have_units_and_errors_of_ends_relative_to_their_interval():
    """The ends of an interval of length 4, known to 0.5 %: 0.02. The intensity has the unit of p times √s."""
    bars = (
        bar("peak", 183.335, 0.002), bar("force", 405.0, 0.001), bar("start", 1.0, 0.005, interval=0),
        bar("end", 5.0, 0.02, interval=0), bar("length", 4.0, 0.025, interval=0),
        bar("intensity", 9.68, 0.018, note="p = K s^-0.5"), bar("displacement", 1.05, 0.003, zone=None),
    )  # fmt: skip
    rows = [*accuracy_rows(accuracy(*bars), UNITS)]
    assert [row["value"] for row in rows] == [
        "183.3 ± 0.4 kN/cm²", "405.0 ± 0.5 kN/cm", "1.00 ± 0.02 cm", "5.00 ± 0.08 cm", "4.0 ± 0.1 cm",
        "9.68 ± 0.18 kN/cm²·cm^0.5", "1.0500 ± 0.0032 cm",
    ]  # fmt: skip
    assert [row["share"] for row in rows] == ["20 %", "10 %", "50 %", "200 %", "–", "–", "30 %"]
    assert [row["color"] for row in rows] == ["", "", "", "bad", "", "", ""]


def test_an_infinite_peak_has_no_number():
    record = {"accuracy": accuracy(bar("peak", None, None, note="infinite at a corner")), "peak": None}
    assert peak_of(record, UNITS) == "infinite"
    assert next(accuracy_rows(record["accuracy"], UNITS))["value"] == "infinite"
    assert peak_of({"accuracy": accuracy(), "peak": None}, UNITS) == "no contact"


def test_a_peak_whose_error_is_not_known_says_so_wherever_it_is_written():
    """An error that was looked for and not found is told from one that nobody looked for."""
    peak = {"pressure": 12.5, "at": [0.0, 0.0]}
    sought = {"accuracy": accuracy(bar("peak", 12.5, None)), "peak": peak}
    assert peak_of(sought, UNITS) == "12.5 kN/cm²; error not known"
    assert peak_of({"accuracy": {**accuracy(), "met": None}, "peak": peak}, UNITS) == "12.5 kN/cm²"


def test_of_two_zones_one_of_which_is_infinite_the_other_has_its_peak():
    lists = dict.fromkeys(
        (
            "nodes",
            "intervals",
            "tributary_lengths",
            "pressure",
            "zone",
            "normals",
            "tools",
            "undetermined",
            "unknown_motions",
            "gap",
        ),
        (),
    )
    bars = (bar("peak", None, None, note="infinite at a corner"), bar("peak", 12.5, 0.01, zone="wall"))
    record = {
        **lists, "forces": {}, "sides": {}, "peak": None, "resultant": (0.0, 0.0), "resultant_moment": 0.0,
        "scales": {"displacement": 1.0}, "motion_names": (), "rigid_amplitudes": (), "rotations": (),
        "residuals": dict.fromkeys(("penetration", "tension", "complementarity", "equilibrium", "force_balance")),
        "accuracy": accuracy(*bars),
    }  # fmt: skip
    peaks = [words for name, words in facts(record, UNITS) if name == "Peak pressure"]
    assert peaks == ["of foot: infinite at a corner", "of wall: 12.50 ± 0.13 kN/cm²"]


def facts_of_forces(
    infinite: bool, forces: list[float], rotations: tuple[float | None, ...] | None = (1e-15, 0.05, 0.0), **other: Any
) -> list[tuple[str, str]]:
    """Facts of one zone with these forces along y; its peak is infinite or 1."""
    total = sum(forces)
    record = {
        "nodes": [[1.0 + place, 0.0] for place in range(len(forces))], "zone": ["foot"] * len(forces),
        "intervals": [{"zone": "foot", "start": [0.0, 0.0], "end": [9.0, 0.0], "arc": [0.0, 9.0]}] * any(forces),
        "run": [0] * len(forces), "arc_position": [float(place) for place in range(len(forces))],
        "tributary_lengths": forces, "pressure": [1.0] * len(forces), "normals": [[0.0, 1.0]] * len(forces),
        "forces": {"foot": (0.0, total)}, "sides": {}, "undetermined": (), "unknown_motions": (),
        "gap": [0.0] * len(forces),
        "peak": None if infinite or not any(forces) else {"pressure": 1.0, "at": [0.0, 0.0]},
        "resultant": (1e-14 * total, total), "resultant_moment": 3.0 * total,
        "motion_names": ("rotation about (1, 2)", "rotation about (3, 4)", "translation along (0, 1)"),
        "rigid_amplitudes": (1e-15, 0.2, 0.3), "rotations": rotations, "scales": {"displacement": 1.0},
        "tools": [{"name": "punch", "point": [0.0, 0.0], "displacement": [0.0, -0.5], "rotation": 0.0,
                   "force_of_body": [0.0, -total], "moment_of_body": 0.0, "free": [False, True, False],
                   "zones": ["foot"]}],
        "residuals": dict.fromkeys(("penetration", "tension", "complementarity", "equilibrium", "force_balance")),
        "accuracy": accuracy(bar("peak", None if infinite else 1.0, None, note="infinite at a corner" * infinite)),
    }  # fmt: skip
    return [*facts({**record, **other}, UNITS)]


@given(st.lists(st.floats(1e-9, 1e9), min_size=1, max_size=5))
@example([500.0, 500.0])
def test_forces_are_the_same_words_whether_or_not_the_peak_is_infinite(forces: list[float]):
    """A force is finite under an infinite peak; only round-off beside it, here 1e-14 of it along x, is zero."""
    finite, infinite = (dict(facts_of_forces(infinite, forces)) for infinite in (False, True))
    assert infinite["Resultant"] == finite["Resultant"]
    assert infinite["Tool"] == finite["Tool"]
    _, along = re.match(r"\((\S+), (\S+)\)", infinite["Resultant"]).groups()  # pyright: ignore
    assert float(along) == pytest.approx(sum(forces), rel=1e-4)
    assert f"presses on it with (0, -{along})" in infinite["Tool"]


def test_a_rotation_has_an_angle():
    """A translation of the body, the mean of its zones, is no fact that one can use."""
    assert rotations_of((1e-15, 0.05, 0.0)) == ["about (1, 2): 0", "about (3, 4): 0.05 rad"]


def test_a_rotation_that_is_not_known_has_no_amount():
    """One that contact leaves open, and one that only slopes hold, have no number and no sense in which they turn."""
    assert rotations_of(None) == ["about (1, 2)", "about (3, 4)"]
    names = "rotation counterclockwise about (1, 2)", "rotation about (3, 4)"
    open_one = {"motion_names": names, "unknown_motions": names, "undetermined": names[1:]}
    assert rotations_of((None, None), **open_one) == [
        "about (1, 2): not known; only slopes and levers as drawn hold it, which move with the body",
        "about (3, 4): not determined",
    ]


def test_translations_that_are_not_known_are_named_and_several_are_counted():
    """A bearing has two of each roller. Those that contact leaves open have notes of their own, and tools a line."""
    names = tuple(f"translation along (1, 0) of the body 'roller {i}'" for i in range(5))
    tool = "translation along (1, 0) of the tool 'punch'"
    (one,) = facts_of_translations(names[:1])
    assert (
        one == "along (1, 0) of the body 'roller 0': not known; only slopes and levers as drawn hold it, which move "
        "with the body"
    )
    (several,) = facts_of_translations((*names, tool))
    assert several.endswith("'roller 2' and 2 more: not known; only slopes and levers as drawn hold them, which move "
                            "with the body")  # fmt: skip
    assert facts_of_translations((tool,)) == []
    assert facts_of_translations(names, undetermined=names) == []


def facts_of_translations(names: tuple[str, ...], **other: Any) -> list[str]:
    told = facts_of_forces(False, [1.0], unknown_motions=names, **other)
    return [words for name, words in told if name == "Translation"]


def test_a_tool_that_moves_by_an_unknown_amount_has_no_number():
    punch = {
        "name": "punch", "point": [0.0, 0.0], "displacement": None, "rotation": None, "force_of_body": [0.0, -1.0],
        "moment_of_body": 0.0, "free": [True, True, True], "zones": ["foot"],
    }  # fmt: skip
    told = dict(facts_of_forces(False, [1.0], tools=[punch]))["Tool"]
    assert told.startswith("punch: moves by an amount that is not known, turns by an amount that is not known; the")


def rotations_of(rotations: tuple[float | None, ...] | None, **other: Any) -> list[str]:
    return [words for name, words in facts_of_forces(False, [1.0], rotations, **other) if name == "Rotation"]


@pytest.mark.slow
def test_the_force_of_several_zones_is_as_uncertain_as_all_of_them():
    """On a body that conditions hold aside; and each zone has its largest pressure."""
    record = bemcontact.solve(bemcontact.load("models/gallery/beam_on_two_supports.yaml")).to_dict()
    told = [f"{name} {words}" for name, words in facts(record, UNITS)]
    errors = [bar["value"] * bar["bar"] for bar in record["accuracy"]["bars"] if bar["quantity"] == "force"]
    (whole,) = [words for words in told if "of the rigid surfaces on the body" in words]
    above = float(whole.split("± ")[1].split(" ")[0]) - sum(errors)
    assert 0 <= above < 10 ** np.floor(np.log10(sum(errors)))  # it is written with one figure
    assert len([words for words in told if words.startswith("Peak pressure of middle roller")]) == 1


@given(
    st.lists(st.floats(0.0, 0.4e-3), min_size=2, max_size=6),
    st.lists(st.floats(0.0, 0.99), max_size=4),
    st.integers(0, 5),
    st.sampled_from(("foot", "wall")),
)
def test_a_level_pressure_has_no_place(dips: list[float], others: list[float], open_points: int, other_zone: str):
    """Round-off or an error of the mesh do not choose one; open points and other zones do not matter."""
    level = [1.0 - dip for dip in dips]
    pressure = [*level, *others, *[0.0] * open_points]
    zone = ["foot"] * len(level) + [other_zone] * len(others) + ["foot"] * open_points
    at = [float(np.argmax(pressure)), 0.0]
    record = {
        "peak": {"pressure": max(pressure), "at": at}, "pressure": pressure, "zone": zone,
        "nodes": [[float(i), 0.0] for i in range(len(zone))], "intervals": [{"arc": [0.0, 9.0]}],
        "run": [0] * len(zone), "arc_position": [float(i) for i in range(len(zone))],
        "tributary_lengths": [0.4] * len(zone),
    }  # fmt: skip
    pressed_beside = other_zone == "foot" and any(value > 1e-9 for value in others)
    name = "the contact" if len({*zone}) == 1 else "foot"
    assert peak_place(record, UNITS) == (f"({at[0]:g}, 0) cm" if pressed_beside else f"all along {name}")


def test_ends_of_a_narrow_contact_far_away_are_told_apart():
    """A width of 0.094 at a coordinate of 1000 takes seven figures."""
    ends = {"start": (999.969, 0.0), "end": (1000.063, 0.0), "arc": [0.0, 0.094]}
    record = {"intervals": [{"zone": "foot", **ends}], "nodes": [[1000.0, 0.0]]}
    ((_, place),) = contact_intervals(record, Units(length="mm"))
    assert place == "(999.969, 0) to (1000.063, 0) mm, 0.094 mm long"


def test_many_contacts_at_one_place_are_counted():
    """At a sharp corner contact breaks into pieces whose coordinates look the same; one by itself keeps its length."""

    def contact(*starts: float) -> list[str]:
        intervals = [
            {"zone": "floor", "arc": (s, s + 1e-8), "start": (25.0 + s, 15.0), "end": (25.0 + s + 1e-8, 15.0)}
            for s in starts
        ]
        record = {"nodes": [[30.0, 15.0]], "intervals": intervals}
        return [place for _, place in contact_intervals(record, Units(length="mm"), merged=True)]

    assert contact(0.0, 1e-7, 2e-7, 3.0) == ["narrow, at (25, 15) mm"] * 3 + contact(3.0)
    assert contact(3.0) == ["(28, 15) to (28.00000001, 15) mm, 1e-08 mm long"]


@pytest.mark.parametrize(
    ("error", "written"),
    [(8e-4, "0.0008"), (9.96e-5, "0.0001"), (4.1e-5, "5e-05"), (9.96e-7, "1e-06"), (9.96e6, "1e+07"), (9.96, "10")],
)
def test_an_error_alone_is_rounded_up_to_one_figure(error: float, written: str):
    """An error that is rounded up to ten of a power is one of the next power."""
    assert error_alone(error) == written
