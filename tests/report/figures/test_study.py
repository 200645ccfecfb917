"""Pictures of a study: what is drawn, and that what does not hold is drawn differently."""

import numpy as np
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from bemcontact.problems.units import Units
from bemcontact.report import figures
from bemcontact.studies.axes import axes_of
from bemcontact.studies.outputs import Reading
from bemcontact.studies.rows import MemberRow, MemberStatus, failed_row
from bemcontact.studies.table import StudyTable


def table(*sizes: int, bad: dict[int, MemberStatus] | None = None) -> StudyTable:
    """A study whose peak is the number of the member."""
    axes = axes_of({f"axis {i}": [float(value) for value in range(size)] for i, size in enumerate(sizes)}, Units())
    rows = []
    for number, position in enumerate(np.ndindex(*sizes)):
        values = {axis.name: axis.values[i] for axis, i in zip(axes, position, strict=True)}
        status = (bad or {}).get(number, MemberStatus.HOLDS)
        if status is MemberStatus.FAILED:
            rows.append(failed_row(number, values, "no"))
            continue
        outputs = {"peak": Reading(value=float(number), error=0.5)}
        rows.append(
            MemberRow(number=number, values=values, status=status, equations="", certified=True, met=True,
                      mesh_error=0.0, message="", outputs=outputs)
        )  # fmt: skip
    return StudyTable(name="x", units=Units(), axes=axes, outputs=("peak",), rows=tuple(rows))


def drawn(study: StudyTable, axis: int = 0):
    axes = Figure().add_subplot()
    figures.draw_output(axes, study, "peak", axis)
    return axes


def test_a_curve_has_the_values_and_their_errors():
    axes = drawn(table(4))
    assert axes.lines[0].get_xydata().tolist() == [[0, 0], [1, 1], [2, 2], [3, 3]]
    ends = [segment.tolist() for segment in axes.collections[0].get_segments()]
    assert ends == [[[i, i - 0.5], [i, i + 0.5]] for i in range(4)]


def test_members_that_do_not_hold_interrupt_the_curve_and_are_marked():
    axes = drawn(table(4, bad={1: MemberStatus.NOT_MET, 2: MemberStatus.FAILED}))
    assert np.isnan(axes.lines[0].get_ydata()).tolist() == [False, True, True, False]
    (dots,) = (item for item in axes.collections if isinstance(item, PathCollection))
    assert (dots.get_label(), dots.get_offsets().tolist()) == ("does not hold", [[1.0, 1.0]])
    (cross,) = (line for line in axes.lines if line.get_label() == "no value")
    assert cross.get_xdata() == [2.0]


def test_a_member_without_a_value_is_seen_at_the_end_of_the_axis():
    axes = drawn(table(4, bad={0: MemberStatus.FAILED}))
    assert axes.get_xlim()[0] <= 0.0


def test_a_second_axis_gives_curves_and_a_third_one_a_band():
    two = drawn(table(3, 2))
    assert [text.get_text() for text in two.get_legend().get_texts()] == ["axis 1 = 0", "axis 1 = 1"]
    three = drawn(table(3, 2, 2))
    labels = {text.get_text() for text in three.get_legend().get_texts()}
    assert labels == {"range over all others", "others at their middle values"}
    low, high = np.array([[4 * i, 4 * i + 3] for i in range(3)]).T
    band = three.collections[0].get_paths()[0].vertices
    assert (band[:, 1].min(), band[:, 1].max()) == (low[0], high[-1])


def test_there_is_a_picture_for_each_axis_that_varies():
    found = figures.figures_of_study(table(3, 1, 2))
    assert [*found] == ["peak over axis 0, by axis 2", "peak over axis 2, by axis 0"]
    for figure in found.values():
        assert figures.vector_graphic(figure).startswith(b"<?xml")
