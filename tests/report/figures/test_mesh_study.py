"""Pictures of a mesh study: iterations, convergence, and which pictures there are."""

import dataclasses
from collections.abc import Callable
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest
from drawings import curves, drawn
from matplotlib.figure import Figure
from mesh_studies import (
    not_unique,
    of_many_settings,
    on_one_mesh,
    on_three_meshes,
    without_a_body,
    without_contact,
)

from bemcontact.analysis.mesh_study import MeshStudy
from bemcontact.assessment.comparison import Contender
from bemcontact.contact.solution import Trace
from bemcontact.report import figures


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


@cache
def pictures_of(study: Callable[[], MeshStudy]) -> dict[str, Figure]:
    return figures.figures_of(study())


@pytest.mark.slow
def test_each_study_has_its_pictures():
    assert {"problem", "pressure", "gap", "deformed"} <= pictures_of(on_one_mesh).keys()
    assert "convergence" in pictures_of(on_three_meshes)
    assert "difference" in pictures_of(of_many_settings)
    for study in (without_a_body, without_contact, not_unique):
        assert not {"problem", "deformed", "convergence"} & pictures_of(study).keys()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("study", "again"),
    [(on_three_meshes, None), (of_many_settings, {"difference"}), (without_contact, {"pressure"})],
    ids=["on_three_meshes", "of_many_settings", "without_contact"],
)
def test_pictures_are_the_same_each_time_and_light_enough(study: Callable[[], MeshStudy], again: set[str] | None):
    """A second time are drawn all of the first study, and of the others what it has not."""
    first = {name: figures.vector_graphic(figure) for name, figure in pictures_of(study).items()}
    second = figures.figures_of(study())
    for name in second if again is None else again:
        assert figures.vector_graphic(second[name]) == first[name], name
    for name, picture in first.items():
        assert len(picture) < 150_000, name
        root = ElementTree.fromstring(picture)
        assert root.tag.endswith("svg")
        assert not [node for node in root.iter() if node.tag.endswith(("}script", "}image"))]
