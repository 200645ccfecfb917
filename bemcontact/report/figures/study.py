"""Pictures of a study of parameters: each output against each parameter, with error bars."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.checks.arguments import is_real
from bemcontact.report.figures.page import (
    BLACK,
    CYCLE,
    GREY,
    VERMILION,
    labeled,
    legend_below,
    name_axis,
    new_page,
    plain,
    short_label,
)
from bemcontact.report.study_page import unit_of_output, value_in_words
from bemcontact.studies.rows import MemberRow
from bemcontact.studies.table import StudyTable

CURVES = tuple(color for color in CYCLE if color != VERMILION)
"""Colors of curves; vermilion is that of members that do not hold."""
WIDTH, HEIGHT = 5.2, 3.9
"""Inches of a picture."""
MOST_PICTURES = 36
"""Largest number of pictures of a study."""
MOST_CURVES = 5
"""Largest number of curves in a picture."""
MOST_MARKS = 300
"""Largest number of marks of members that do not hold, in a picture."""
BEYOND = 0.12
"""Opacity of the range over all other parameters."""


def figures_of_study(study: StudyTable) -> dict[str, Figure]:
    """Make a picture of each output against each parameter, by caption; at most `MOST_PICTURES`."""
    figures = dict[str, Figure]()
    for column in study.columns:
        for number, axis in enumerate(study.axes):
            if len(axis.values) > 1 and len(figures) < MOST_PICTURES:
                figure = new_page(WIDTH, HEIGHT)
                figure.set_layout_engine("none")
                draw_output(figure.add_subplot(), study, column, number)
                figures[f"{column} over {axis.name}{_beside(study, number)}"] = figure
    return figures


def _beside(study: StudyTable, number: int) -> str:
    """What the picture does with the other parameters."""
    others = _others(study, number)
    if not others:
        return ""
    if len(others) == 1:
        return f", by {study.axes[others[0]].name}"
    return "; the line has all others at their middle values, the band has their whole range"


def _others(study: StudyTable, number: int) -> list[int]:
    """Numbers of the other axes that have several values."""
    return [i for i, axis in enumerate(study.axes) if i != number and len(axis.values) > 1]


def draw_output(axes: Axes, study: StudyTable, column: str, number: int) -> None:
    """Draw an output against the parameter of an axis: a curve for each value of another one, or one in the middle."""
    axis, others = study.axes[number], _others(study, number)
    places, ticks = _places(axis.values)
    place = dict(zip(map(repr, axis.values), places, strict=True))
    if len(others) > 1:
        _draw_band(axes, study.rows, column, axis.name, place)
    for label, rows, color in _curves(study, others):
        _draw_curve(axes, rows, column, axis.name, place, label, color)
    _draw_doubtful(axes, study.rows, column, axis.name, place)
    if ticks:
        axes.set_xticks(places, [short_label(text, 18) for text in ticks])
    else:
        axes.locator_params(axis="x", nbins=6)
    name_axis(axes.xaxis, short_label(axis.name, 60))
    name_axis(axes.yaxis, labeled(short_label(column, 40), unit_of_output(column, study.units)))
    legend_below(axes)


def _places(values: Sequence[Any]) -> tuple[list[float], list[str]]:
    """Places of values along an axis: numbers at themselves, others one beside the other with their names."""
    if all(is_real(value) for value in values):
        return [float(value) for value in values], []
    return [float(i) for i in range(len(values))], [value_in_words(value) for value in values]


def _curves(study: StudyTable, others: Sequence[int]) -> Iterator[tuple[str, list[MemberRow], str]]:
    """Label, members and color of each curve."""
    if len(others) == 1:
        axis = study.axes[others[0]]
        chosen = np.unique(np.linspace(0, len(axis.values) - 1, MOST_CURVES).round().astype(int)).tolist()
        for order, position in enumerate(chosen):
            value = axis.values[position]
            rows = [row for row in study.rows if row.values[axis.name] == value]
            name = axis.title or axis.keys[0].rpartition(".")[2]
            yield f"{name} = {value_in_words(value)}", rows, CURVES[order % len(CURVES)]
        return
    middle = {study.axes[i].name: study.axes[i].values[len(study.axes[i].values) // 2] for i in others}
    rows = [row for row in study.rows if all(row.values[name] == value for name, value in middle.items())]
    yield "others at their middle values" if others else "", rows, BLACK


def _draw_band(axes: Axes, rows: Sequence[MemberRow], column: str, name: str, place: dict[str, float]) -> None:
    """Fill between the smallest and the largest value of all members that hold, at each place."""
    found = dict[float, list[float]]()
    for row in rows:
        if row.holds is not False and (value := row.reading(column).value) is not None:
            found.setdefault(place[repr(row.values[name])], []).append(value)
    x = sorted(found)
    if x:
        low, high = ([pick(found[at]) for at in x] for pick in (min, max))
        axes.fill_between(x, low, high, color=GREY, alpha=BEYOND, linewidth=0, label="range over all others")


def _draw_curve(
    axes: Axes, rows: Sequence[MemberRow], column: str, name: str, place: dict[str, float], label: str, color: str
) -> None:
    """Draw the members that hold, with error bars; the line is interrupted where one does not."""
    values = [row.reading(column) if row.holds is not False else None for row in rows]
    x = [place[repr(row.values[name])] for row in rows]
    y = [np.nan if item is None or item.value is None else item.value for item in values]
    errors = [0.0 if item is None or item.error is None else item.error for item in values]
    order = np.argsort(x)
    axes.errorbar(
        np.array(x)[order], np.array(y)[order], yerr=np.array(errors)[order], color=color, marker="o", markersize=3,
        linewidth=1.4, capsize=2, label=plain(label) or None,
    )  # fmt: skip


def _draw_doubtful(axes: Axes, rows: Sequence[MemberRow], column: str, name: str, place: dict[str, float]) -> None:
    """Mark the members that do not hold: hollow where there is a value, else a cross at the lower edge."""
    doubtful = [row for row in rows if row.holds is False]
    with_value = [row for row in doubtful if row.reading(column).value is not None][:MOST_MARKS]
    if with_value:
        x = [place[repr(row.values[name])] for row in with_value]
        y = [row.reading(column).value or 0.0 for row in with_value]
        axes.scatter(
            x, y, s=22, facecolors="none", edgecolors=VERMILION, linewidths=1.2, zorder=3, label="does not hold"
        )
    failed = sorted({place[repr(row.values[name])] for row in doubtful if row.reading(column).value is None})
    if failed:
        axes.plot(
            failed, [0.03] * len(failed), color=VERMILION, linestyle="none", marker="x", markersize=6, zorder=3,
            label="no value", transform=axes.get_xaxis_transform(),
        )  # fmt: skip
