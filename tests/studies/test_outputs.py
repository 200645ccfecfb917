"""Outputs of a study: names, values and errors are those of the result."""

import re
from pathlib import Path

import pytest
from several_bodies import block, elastic
from several_bodies import problem as several

import bemcontact
from bemcontact.errors import ProblemError
from bemcontact.studies.outputs import ALL_OF, OF_MOVERS, OF_ZONES, WHOLE, chosen, columns_of, of_stress, readings

MODELS = Path(__file__).parents[2] / "models"
ZONES = bemcontact.load(MODELS / "gallery" / "three_zones.yaml")
TOOLS = bemcontact.load(MODELS / "gallery" / "body_between_two_tools.yaml").with_case("raised")
PUNCH = bemcontact.load(MODELS / "gallery" / "flat_punch.yaml")


@pytest.mark.slow
def test_values_and_errors_are_those_of_the_error_bars():
    """Errors are absolute; of a start or an end relative to the length of its interval before."""
    result = bemcontact.solve(ZONES)
    found = readings(result)
    for bar in result.accuracy.bars:
        if bar.quantity in ("pressure", "peak"):
            continue
        mover = (bar.mover or "").partition(" about ")[0]
        name = f"{bar.quantity}.{bar.zone or mover}" if bar.zone or mover else bar.quantity
        name += f"[{bar.interval}]" if bar.interval else ""
        reading = found[name]
        assert reading.value == pytest.approx(bar.value, rel=1e-6, abs=1e-12)
        length = found[name.replace(bar.quantity, "length", 1)].value if bar.quantity in ("start", "end") else bar.value
        assert bar.bar is None or reading.error == pytest.approx(bar.bar * abs(length or 0.0), rel=1e-6)
    peak = result.footprint.peak
    assert peak is not None
    assert found["peak"].value == peak.pressure
    assert found["peak"].error == pytest.approx((result.accuracy.peak_bar() or 0.0) * peak.pressure)
    assert (found["resultant_x"].value, found["resultant_y"].value) == result.footprint.resultant.force
    for zone, force in result.footprint.forces.items():
        assert (found[f"force_x.{zone}"].value, found[f"force_y.{zone}"].value) == pytest.approx(force)
    assert sum(found[f"force_y.{zone}"].value or 0.0 for zone in ZONES.contact_zones) == pytest.approx(
        result.footprint.resultant.force[1]
    )


def test_an_infinite_peak_is_no_number():
    result = bemcontact.solve(PUNCH)
    assert result.accuracy.infinite
    found = readings(result)
    assert found["peak"].value is None
    zone = result.accuracy.infinite[0]
    assert found[f"intensity.{zone}"].value == result.accuracy.bar_of("intensity", zone).value


def test_outputs_may_be_one_text_as_on_the_command_line():
    assert chosen("peak, force.wall", ZONES) == chosen(["peak", "force.wall"], ZONES)


def test_the_usual_outputs_have_no_sum_of_forces_on_different_bodies():
    """The sum would be twice the load of a stack of three, or nothing with the sides of one contact exchanged."""
    assert chosen(None, ZONES) == ("peak", "resultant_x", "resultant_y", "length", "displacement")
    assert chosen(None, bemcontact.load(MODELS / "bodies" / "stack_of_three.yaml")) == (
        "peak", "force", "length", "displacement",
    )  # fmt: skip


@pytest.mark.slow
def test_largest_stresses_are_outputs_if_they_are_asked_for():
    """Below the roller the maximum inside is larger than that on the boundary; each with its error, absolute."""
    problem = bemcontact.load(MODELS / "gallery" / "hertz_small.yaml")
    result = bemcontact.solve(problem)
    largest, found = result.largest_stresses(), readings(result, stresses=True)
    for name, peak in (("von_mises", largest.inside), ("max_shear.foot", largest.shear["foot"])):
        assert peak is not None
        assert peak.bar is not None
        assert found[name].value == peak.value
        assert found[name].error == pytest.approx(peak.bar * peak.value)
        assert chosen([name], problem) == (name,)
        assert of_stress([name])
    assert found.keys() - readings(result).keys() == {"von_mises", "max_shear.foot"}
    assert not of_stress(["peak", "length.foot"])


def test_motions_of_tools_and_of_the_body_are_outputs():
    """A free rotation is named without its center: this is the middle of the nodes, and each member has its mesh."""
    found = readings(bemcontact.solve(TOOLS))
    assert [name for name, item in found.items() if name.split(".")[0] in OF_MOVERS and item.error is not None] == [
        "motion.translation along (0, 1)", "rotation.rotation counterclockwise", "motion.press", "rotation.press",
    ]  # fmt: skip


@pytest.mark.parametrize("slope", [0.0, 0.05])
def test_a_rotation_is_an_output_without_error_bars_and_where_it_is_zero(slope: float):
    """A mesh whose errors are not estimated has no bars, and a rotation that is round-off has none on any mesh."""
    load = {"top": {"pressure": {"constant": 1.0, "x": slope}}}
    bodies = {
        "stiff": elastic(block((-2, 2), (0, 3), (2,) * 4), load, 1e7),
        "base": elastic(block((-2, 2), (-4, 0), (2,) * 4), {"bottom": {"displacement": {"y": 0}}}, 10.0),
    }
    result = bemcontact.solve(several(bodies, seat=["stiff/bottom", "base/top"]))
    assert not result.accuracy.bars
    name = "rotation.rotation counterclockwise of the body 'stiff'"
    assert readings(result)[name].value == pytest.approx(-slope * 4 / 10 * (1 - 0.3**2), rel=1e-5, abs=0.0)
    assert readings(result)[name].error is None


def test_a_free_motion_of_bodies_can_be_chosen_with_the_comma_of_its_direction():
    stack = bemcontact.load(MODELS / "bodies" / "stack_of_three.yaml")
    body = next(part.name for part in stack.parts)
    name = f"motion.translation along (0, 1) of the body '{body}'"
    assert chosen(f"peak,{name}", stack) == ("peak", name)
    with pytest.raises(ProblemError, match=f"unknown body '{body}x'; did you mean '{body}'"):
        chosen(f"rotation.rotation counterclockwise of the body '{body}x'", stack)


def test_the_motions_of_a_body_can_be_chosen_by_its_name_as_those_of_a_tool():
    stack = bemcontact.load(MODELS / "bodies" / "stack_of_three.yaml")
    assert chosen("motion.top,rotation.middle", stack) == ("motion.top", "rotation.middle")
    with pytest.raises(ProblemError, match=r"unknown tool or body 'topp'; did you mean 'top'\?"):
        chosen("rotation.topp", stack)
    present = [
        "motion.translation along (1, 0) of the body 'top'", "motion.translation along (0, 1) of the body 'top'",
        "motion.translation along (0, 1) of the body 'top layer'",
        "rotation.rotation counterclockwise of the body 'top'",
    ]  # fmt: skip
    assert columns_of(["motion.top"], present) == tuple(present[:2])
    assert columns_of(["rotation.top", "rotation.middle"], present) == (present[3], "rotation.middle")


@pytest.mark.slow
def test_each_output_of_a_result_can_be_chosen():
    for problem in (ZONES, TOOLS, PUNCH):
        for name in readings(bemcontact.solve(problem)):
            assert chosen([name], problem) == (name,)
    for name in (*WHOLE, *OF_ZONES, *OF_MOVERS, *ALL_OF):
        assert chosen([name], ZONES)


@pytest.mark.parametrize(
    ("outputs", "says"),
    [
        (["peek"], "unknown output 'peek'; did you mean 'peak'?"),
        (["peak.foot"], "unknown output 'peak.foot'"),
        (["force.leftt"], "unknown contact zone 'leftt'"),
        (["end.wall[0]"], "unknown contact zone 'wall[0]'; did you mean 'wall'?"),
        (["end.wall[x]"], "unknown contact zone 'wall[x]'"),
        (["force.wall[1]"], "unknown contact zone 'wall[1]'"),  # it is the sum over all intervals
        (["motion.press"], "unknown tool 'press'; there are none; motion has a column for each tool and each free mo"),
        (["force.y"], "output force.y: write force_y, or force_y.drum"),
        ([], "no output is named"),
        (7, "list of texts"),
    ],
)
def test_unknown_outputs_are_refused(outputs: list[str], says: str):
    with pytest.raises(ProblemError, match=re.escape(says)):
        chosen(outputs, ZONES)


def test_columns_are_those_of_all_zones_and_intervals_that_some_row_has():
    present = ["peak", "length.a", "length.b", "length.a[1]", "lengthy.a", "motion.tool"]
    assert columns_of(["length", "peak"], present) == ("length.a", "length.b", "length.a[1]", "peak")
    assert columns_of(["length.a", "rotation"], present) == ("length.a", "length.a[1]", "rotation")
