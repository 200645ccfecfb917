"""Pictures of a comparison: what is drawn is what was found, and equal curves can be told apart."""

import dataclasses
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import matplotlib.colors
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from studies import (
    not_unique,
    of_many_settings,
    on_one_mesh,
    on_three_meshes,
    without_a_body,
    without_contact,
)
from test_figures import block_in_a_corner

from bemcontact import spec
from bemcontact.analysis import compare as comparing
from bemcontact.analysis.study import Study
from bemcontact.assessment.comparison import Contender
from bemcontact.contact.solution import Trace
from bemcontact.options import ComparisonOptions
from bemcontact.report import figures

GREY = "#7d838c"


def curves(axes: Axes) -> dict[str, Line2D]:
    """What the legend names."""
    return {str(line.get_label()): line for line in axes.lines if not str(line.get_label()).startswith("_")}


def drawn(line: Line2D) -> np.ndarray:
    return np.asarray(line.get_ydata(), float)


def test_each_pressure_is_drawn_and_none_hides_another():
    level, axes = on_one_mesh().finest, Figure().add_subplot()
    figures.draw_pressures(axes, level)
    found = curves(axes)
    for contender in level.comparison.everyone:
        assert contender.assessment is not None
        assert drawn(found[contender.label]) == pytest.approx(contender.assessment.solution.pressure)
    widths = [found[label].get_linewidth() for label in ("direct", "QP1", "QP2", "QP3")]
    assert np.diff(widths).max() < -1
    assert len({found[label].get_color() for label in ("direct", "QP1", "QP2", "QP3")}) == 4
    assert "per undeformed length" in axes.get_ylabel()


def test_references_are_dashed_and_grey_where_they_are_out_of_range():
    level, axes = on_one_mesh().finest, Figure().add_subplot()
    figures.draw_pressures(axes, level)
    found = curves(axes)
    assert drawn(found["theory"]) == pytest.approx(3)
    assert found["theory"].get_color() != GREY
    assert found["Hertz, out of its range"].get_color() == GREY
    assert found["Hertz, out of its range"].is_dashed()


def test_contenders_that_cannot_be_distinguished_are_one_curve_and_what_is_far_off_is_cut_off_and_named():
    """QP1 finds the same with both weights; QP2 with consistent weights and a large penalty has huge pressures."""
    level, axes = of_many_settings().finest, Figure().add_subplot()
    figures.draw_pressures(axes, level)
    labels = [*curves(axes)]
    assert "QP1 and 1 more" in labels
    largest = {
        item.label: item.assessment.solution.pressure.max()
        for item in level.comparison.contenders
        if item.assessment is not None
    }
    wild = max(largest, key=lambda label: largest[label])
    assert largest[wild] > 2 * level.answer.solution.pressure.max()
    assert wild in axes.get_title(loc="left")
    assert axes.get_ylim()[1] < largest[wild]


def test_gaps_are_drawn_beside_the_initial_gap():
    level, axes = on_three_meshes().finest, Figure().add_subplot()
    figures.draw_gaps(axes, level)
    found, contact = curves(axes), level.answer.contact
    assert drawn(found["initial gap"]) == pytest.approx(contact.initial_gap)
    assert drawn(found["QP2"]) == pytest.approx(
        contact.initial_gap + level.answer.solution.displacement, abs=1e-9 * contact.scales.displacement
    )


def test_gaps_that_are_closed_everywhere_are_reported_and_their_round_off_is_not_blown_up():
    """A block in a corner under uniform pressure touches both planes with all of its edges."""
    problem = spec.load(Path(__file__).parents[2] / "models" / "gallery" / "block_in_corner.yaml")
    level, axes = comparing.study(ComparisonOptions.of(["qp3"]), problem).finest, Figure().add_subplot()
    figures.draw_gaps(axes, level)
    assert "closed everywhere" in [text.get_text() for text in axes.texts]
    assert axes.get_ylim()[1] == level.answer.contact.scales.displacement


def test_differences_are_relative_to_the_peak():
    level, axes = of_many_settings().finest, Figure().add_subplot()
    figures.draw_differences(axes, level)
    assert axes.get_yscale() == "log"
    found = curves(axes)
    assert "direct" not in found
    for label, line in found.items():
        difference = level.comparison.difference(label)
        assert difference is not None
        assert np.nanmax(drawn(line)) == pytest.approx(difference.largest)


def test_two_zones_stand_side_by_side_each_with_its_own_distances():
    study = comparing.study(ComparisonOptions.of(["qp3"]), block_in_a_corner())
    axes = Figure().add_subplot()
    figures.draw_pressures(axes, study.finest)
    assert [text.get_text() for text in axes.texts] == ["floor", "wall"]
    floor, wall = (line for line in axes.lines if line.get_color() == "#222222")
    assert np.max(floor.get_xdata()) < np.min(wall.get_xdata())
    assert [label.get_text() for label in axes.get_xticklabels()].count("0") == 2
    pressure = study.finest.answer.solution.pressure
    assert np.concatenate([drawn(floor), drawn(wall)]) == pytest.approx(pressure)


def with_history(contender: Contender, *history: Trace) -> Contender:
    assert contender.assessment is not None
    solution = dataclasses.replace(contender.assessment.solution, history=history)
    return dataclasses.replace(contender, assessment=dataclasses.replace(contender.assessment, solution=solution))


def test_history_shows_sizes_and_marks_what_is_below_zero():
    first = with_history(
        on_one_mesh().finest.comparison.contenders[0],
        Trace(quantity="infeasibility", first=1, values=(4.0, 0.5)),
        Trace(quantity="objective", first=3, values=(2.0, -0.25, 0.0)),
    )
    axes = Figure().add_subplot()
    figures.draw_history(axes, [first])
    found = curves(axes)
    assert [*found] == ["infeasibility", "objective"]
    assert found["infeasibility"].get_xdata() == pytest.approx([1, 2])
    assert found["objective"].get_xdata() == pytest.approx([3, 4, 5])
    assert drawn(found["objective"])[:2] == pytest.approx([2.0, 0.25])
    assert np.isnan(drawn(found["objective"])[2])  # a logarithm has no zero
    marks = np.concatenate([np.asarray(item.get_offsets()) for item in axes.collections if item.get_label() != "_"])
    assert [4.0, 0.25] in marks.tolist()
    legend = axes.get_legend()
    assert legend is not None
    assert "objective below zero" in [text.get_text() for text in legend.get_texts()]


def test_histories_of_several_settings_are_distinguished():
    trace = Trace(quantity="residual", first=0, values=(1.0, 1e-3))
    told = [with_history(item, trace) for item in of_many_settings().finest.comparison.contenders[:2]]
    axes = Figure().add_subplot()
    figures.draw_history(axes, told)
    found = curves(axes)
    assert [*found] == [f"{item.label}: residual" for item in told]
    assert len({line.get_color() for line in found.values()}) == 2


def test_convergence_is_drawn_to_the_limit_with_its_order():
    convergence, axes = on_three_meshes().convergence, Figure().add_subplot()
    assert convergence is not None
    figures.draw_convergence(axes, convergence)
    found = curves(axes)
    asymmetry = next(item for item in convergence.quantities if item.name == "asymmetry of J M")
    (label,) = (label for label in found if label.startswith("asymmetry"))
    assert drawn(found[label]) == pytest.approx(asymmetry.values)
    assert found[label].get_xdata() == pytest.approx([1, 2, 3])
    assert label.endswith(f"order {asymmetry.orders[-1]:.2g}")


def test_pictures_are_made_of_what_there_is():
    assert {"problem", "pressure", "gap", "deformed"} <= figures.figures_of(on_one_mesh()).keys()
    assert "convergence" in figures.figures_of(on_three_meshes())
    assert "difference" in figures.figures_of(of_many_settings())
    for study in (without_a_body, without_contact, not_unique):
        assert not {"problem", "deformed", "convergence"} & figures.figures_of(study()).keys()


@pytest.mark.parametrize(
    "study", [on_three_meshes, of_many_settings, without_contact], ids=lambda study: study.__name__
)
def test_pictures_are_the_same_each_time_and_light_enough(study: Callable[[], Study]):
    first, second = (
        {name: figures.vector_graphic(figure) for name, figure in figures.figures_of(study()).items()} for _ in range(2)
    )
    assert first == second
    for name, picture in first.items():
        assert len(picture) < 150_000, name
        root = ElementTree.fromstring(picture)
        assert root.tag.endswith("svg")
        assert not [node for node in root.iter() if node.tag.endswith(("}script", "}image"))]


def test_every_colour_has_contrast_on_paper_and_in_the_dark():
    """Lines and text against white and the dark page, 3 to 1 as WCAG asks of graphics; fills are only fills."""
    text = figures.vector_graphic(figures.figures_of(on_one_mesh())["pressure"]).decode()
    dark = dict(re.findall(r'\[style\*="stroke: (#\w{6})"\] \{ stroke: (#\w{6})', text))
    page = dark.pop("#ffffff")
    dark.pop("#e8ecf2")
    assert len(dark) == 7
    for there in dark.values():
        assert contrast(there, page) > 4.5
    strokes = {colour for colour in re.findall(r"stroke: (#\w{6})", text.split("</style>")[1]) if colour != "#ffffff"}
    for here in strokes - {"#cc79a7"}:  # of a reference, which is dashed
        assert contrast(here, "#ffffff") > 3


def contrast(one: str, other: str) -> float:
    """Ratio of relative luminances, WCAG 2.2."""

    def luminance(colour: str) -> float:
        rgb = np.array(matplotlib.colors.to_rgb(colour))
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        return float(linear @ (0.2126, 0.7152, 0.0722))

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_a_picture_has_no_background_and_paths_are_rounded():
    text = figures.vector_graphic(figures.figures_of(on_one_mesh())["gap"]).decode()
    (patch,) = re.findall(r'<g id="patch_1">\s*<path[^>]*style="([^"]*)"', text)
    assert "fill: none" in patch
    assert not re.search(r' d="[^"]*\d\.\d{3}', text)
    assert "screen and (prefers-color-scheme: dark)" in text
