"""Pages of all pictures: their files, sizes, colors, and a page written twice is the same."""

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import matplotlib.colors
import matplotlib.image
import numpy as np
import pytest
from contact_meshes import ring
from drawings import beam_over_a_circle, block_in_a_corner, seal_in_a_groove
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

import bemcontact
from bemcontact.analysis import solve as analysis
from bemcontact.bem import mesh
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.problems import Problem
from bemcontact.report import figures
from bemcontact.report.figures.page import (
    PageLayout,
    RoundTicks,
    distance_label,
    legend_below,
    name_axis,
    new_page,
    pieces_of,
    settle,
)


@settings(deadline=None)
@given(
    touching=st.lists(st.booleans(), min_size=1, max_size=12),
    steps=st.randoms(use_true_random=False),
    closed=st.booleans(),
)
def test_pieces_go_once_round_and_cut_no_contact(touching: list[bool], steps, closed: bool):
    """Each point once, a closed piece ends at its first one; stretches of contact are those of a circle."""
    m = len(touching)
    arc = np.cumsum([steps.uniform(0.1, 3.0) for _ in range(m)])
    perimeter = float(arc[-1]) + 1.0
    between = np.diff(arc, append=arc[0] + perimeter)
    contact = replace(
        CondensedContact.from_compliance(np.eye(m), -np.ones(m), weights=(between + np.roll(between, 1)) / 2),
        arc_position=arc, run_length=np.array([perimeter if closed else np.inf]),
    )  # fmt: skip
    (piece,) = pieces_of(contact, np.array(touching))
    if not closed:
        np.testing.assert_array_equal(piece.index, np.arange(m))
        np.testing.assert_array_equal(piece.arc, arc)
        return
    assert sorted(piece.index[:-1]) == [*range(m)]
    assert piece.index[-1] == piece.index[0]
    assert (np.diff(piece.arc) > 0).all()
    np.testing.assert_allclose(piece.arc[-1] - piece.arc[0], perimeter)
    np.testing.assert_allclose(piece.arc % perimeter, arc[piece.index] % perimeter)
    around = np.array(touching)[piece.index]
    stretches = int((np.diff(np.concatenate([[0], around.astype(int), [0]])) > 0).sum())
    on_circle = sum(now and not before for now, before in zip(touching, touching[-1:] + touching[:-1], strict=True))
    assert stretches == (on_circle or any(touching))
    for start in arc[np.array(touching)]:
        place = piece.place_of(float(start), perimeter)
        assert piece.arc[0] <= place <= piece.arc[-1]


@pytest.mark.parametrize("zone", [0, 1, 2])
def test_no_line_goes_over_the_side_of_a_round_body_that_is_turned_away(zone: int):
    """Only half of the ring is turned to each plane: a piece ends there, and does not go on to its first point."""
    result = analysis.solve(seal_in_a_groove())
    contact, length = result.contact, 2 * np.pi * 2
    piece = [*pieces_of(contact, result.touching)][zone]
    assert sorted(piece.index) == np.flatnonzero(contact.zone == zone).tolist()
    assert np.diff(piece.arc) == pytest.approx(length / 64, rel=0.02)  # 32 elements of three nodes
    assert np.ptp(piece.arc) == pytest.approx(length / 2, abs=2 * length / 32)  # an element to either side


@pytest.mark.slow
@pytest.mark.parametrize("name", ["long words " * 60, "x" * 900, "方块"])
def test_long_and_foreign_names_fit(name: str, tmp_path: Path):
    problem = Problem(**{**block_in_a_corner().model_dump(), "name": name})
    figures.save(figures.figure_of_problem(problem, mesh.build(problem)), tmp_path / "problem.png")
    alone = analysis.solve(analysis.condense(problem))  # whose page has no picture of the body
    figures.save(figures.figure_of_result(alone), tmp_path / "result.png")
    for path in tmp_path.iterdir():
        height, width = matplotlib.image.imread(path).shape[:2]
        assert width < 13 * 160
        assert height < 12.5 * 160  # two zones


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_figure_written_twice_is_the_same(tmp_path: Path, ending: str):
    problem = beam_over_a_circle()
    for name in ("a", "b"):
        figures.save(figures.figure_of_problem(problem, mesh.build(problem)), tmp_path / f"{name}.{ending}")
    assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize(("ending", "magic"), [(".png", b"\x89PNG"), (".SVG", b"<?xml"), (".pdf", b"%PDF")])
def test_saved_in_the_format_of_the_ending(problem: Problem, tmp_path: Path, ending: str, magic: bytes):
    path = tmp_path / f"figure{ending}"
    figures.save(figures.figure_of_problem(problem, mesh.build(problem)), path)
    assert path.read_bytes().startswith(magic)
    assert [*tmp_path.iterdir()] == [path]


def test_a_page_is_laid_out_once_and_names_stay_beside_what_they_name(problem: Problem, tmp_path: Path, monkeypatch):
    """Settled for its names, its file has the same axes: one layout, and one drawing that is not thrown away."""
    calls = list[str]()
    for owner, name in ((PageLayout, "execute"), (Figure, "draw")):
        whole = getattr(owner, name)

        def counted(self, *arguments, name=name, whole=whole):
            calls.append(name)
            return whole(self, *arguments)

        monkeypatch.setattr(owner, name, counted)
    figure = figures.figure_of_problem(problem, mesh.build(problem))
    assert calls == ["draw", "execute"]
    settled = [axes.get_position().bounds for axes in figure.axes]
    figures.save(figure, tmp_path / "problem.png")
    assert calls == ["draw", "execute", "draw"]
    assert [axes.get_position().bounds for axes in figure.axes] == settled


def test_unknown_format_is_refused(tmp_path: Path):
    with pytest.raises(ValueError, match=r"\.png, \.svg or \.pdf"):
        figures.save(Figure(), tmp_path / "figure.gif")
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize(("seam", "beyond"), [(0.0, False), (90.0, True)])
def test_distances_beyond_once_round_are_explained(seam: float, beyond: bool):
    """Contact across the seam of a closed zone is drawn in one piece; 20 π is the length of the bore."""
    result = bemcontact.solve(ring(seam))
    label = distance_label(result.contact, [*pieces_of(result.contact, result.touching)])
    assert ("from 62.832 on it goes round again" in label) is beyond


@pytest.mark.parametrize("label", ["distance", "distance\nonly around the contact"])
def test_a_legend_below_is_below_the_label_of_the_axis(label: str):
    figure = new_page(5.4, 3.6)
    axes = figure.add_subplot()
    axes.plot([0, 1], label="press")
    axes.set_xlabel(label)
    legend_below(axes)
    figure.draw_without_rendering()
    legend = axes.get_legend()
    assert legend is not None
    assert legend.get_window_extent().y1 <= axes.xaxis.label.get_window_extent().y0


@pytest.mark.parametrize("label", ["gap [mm]", "gap", "gap [mm]\nper length", "gap of [a] [mm]"])
@pytest.mark.parametrize(("low", "high"), [(0.0, 3.5e-5), (44.95, 44.96), (0.0, 7e8), (12345.6, 12345.7), (0.0, 7.0)])
def test_a_power_of_ten_stands_with_the_unit_and_not_on_the_title(low: float, high: float, label: str):
    """Nothing is at the ends of the axes; what is written, times the power, is where it stands."""
    figure = new_page(5.0, 3.0)
    figure.set_layout_engine("none")
    upper, lower = figure.subplots(2, 1, sharex=True)
    lower.set(xlim=(low, high), ylim=(low, high))
    for axis in (upper.xaxis, lower.xaxis, lower.yaxis):
        name_axis(axis, label)
    figure.draw_without_rendering()
    for axis in (lower.xaxis, lower.yaxis):
        assert axis.get_offset_text().get_text() == ""
        written = axis.get_label_text()
        power = re.search(r"\$10\^\{(-?\d+)\}\$", written)
        assert written.replace(power[0], "").replace("[ ", "[").removesuffix(" []") == label if power else label
        ten = 10.0 ** int(power[1]) if power else 1.0
        for tick in axis.get_major_ticks():
            text = tick.label1.get_text().replace("\N{MINUS SIGN}", "-")
            assert float(text) * ten == pytest.approx(tick.get_loc(), abs=1e-3 * (high - low))
    assert upper.get_xlabel() == lower.get_xlabel()


@pytest.mark.parametrize(("low", "high"), [(0.0, 7.0), (0.058985, 0.059012), (-3.6e-7, 8.2e-7), (123450.0, 123457.0)])
@pytest.mark.parametrize("width", [3.0, 6.0])
def test_tick_labels_do_not_overlap(low: float, high: float, width: float):
    figure = new_page(width, 2.0)
    axes = figure.add_subplot()
    axes.set_xlim(low, high)
    axes.xaxis.set_major_locator(RoundTicks(7))
    axes.xaxis.set_major_formatter(ScalarFormatter(useOffset=False))
    figure.draw_without_rendering()  # the layout is settled
    figure.draw_without_rendering()
    shown = [label for label in axes.get_xticklabels() if low <= label.get_position()[0] <= high]
    boxes = [label.get_window_extent() for label in shown]
    assert len(shown) >= 2
    assert all(a.x1 < b.x0 for a, b in pairwise(boxes))


def test_a_title_of_several_lines_above_a_plan_does_not_reach_that_of_the_page():
    """Equal scales move the plan beside its color bar after its place is known, and its title with it."""
    figure = new_page(14, 5)
    plan, other = figure.subplots(1, 2)
    for axes in (plan, other):
        axes.set(aspect="equal", xlim=(0, 10.3), ylim=(0, 7))
    figure.colorbar(plan.imshow(np.eye(2), extent=(0, 9, 0, 7)), ax=plan, shrink=0.8)
    title = plan.set_title("one\ntwo\nthree", loc="left")
    page = figure.suptitle("title of the page")
    settle(plan)
    assert title.get_window_extent().y1 <= page.get_window_extent().y0
