"""The picture of several load cases: each has its curve, its bar and its name."""

from functools import cache
from pathlib import Path

import pytest
from tool_problems import FREE, FREE_CASES, made

import bemcontact
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.report import figures


@cache
def found() -> CaseResults:
    return bemcontact.solve_cases(made(FREE, **FREE_CASES))


def test_each_case_has_its_curves_and_its_bar():
    """Two pieces of boundary for each case, with the pressures of its own; bars as long as the peaks."""
    above, below = figures.figure_of(found()).axes
    curves = [line for line in above.lines if len(line.get_xdata()) > 2]
    assert len(curves) == 2 * len(found().results)
    pressures = [max(line.get_ydata()) for line in curves]
    for number, result in enumerate(found().results.values()):
        assert max(pressures[2 * number : 2 * number + 2]) == pytest.approx(result.solution.pressure.max())
    legend = above.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == [*found().results]
    assert [bar.get_width() for bar in below.patches] == pytest.approx(
        [result.solution.pressure.max() for result in found().results.values()]
    )
    assert [label.get_text() for label in below.get_yticklabels()] == [*found().results]


def test_it_states_whether_all_are_certified():
    title = figures.figure_of(found()).get_suptitle()
    assert title == "free block: all certified"


@pytest.mark.parametrize("ending", [".png", ".svg", ".pdf"])
def test_it_is_saved_in_each_format(ending: str, tmp_path: Path):
    figures.save(figures.figure_of(found()), tmp_path / f"cases{ending}")
    assert (tmp_path / f"cases{ending}").stat().st_size > 1000


def test_one_result_has_its_own_figure():
    one = found().results["wind"]
    assert "wind" in figures.figure_of(one).get_suptitle()
