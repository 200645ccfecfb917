"""The picture of several load cases: each has its curve, its bar and its name."""

from dataclasses import replace
from functools import cache
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from drawings import block_in_a_corner, leaves, roller_in_a_groove
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mesh_studies import punch
from roller_bearings import bearing
from tool_problems import FREE, FREE_CASES, made, not_met, of_peaks

import bemcontact
from bemcontact import spec
from bemcontact.analysis import solve as analysis
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.problems import Problem, Units
from bemcontact.report import figures, result_page
from bemcontact.report.facts import peak_of
from bemcontact.report.figures.load_cases import shown_cases
from bemcontact.report.figures.page import new_page
from bemcontact.report.figures.result import drawn_near, panels_of
from bemcontact.report.verdicts import case_verdicts, in_short

MODELS = Path(__file__).parents[3] / "models"


@cache
def found() -> CaseResults:
    return not_met(bemcontact.solve_cases(made(FREE, **FREE_CASES)))


@cache
def figure_of_found() -> Figure:
    """Tests leave it as it is."""
    return figures.figure_of(found())


def case_axes(cases: CaseResults, figure: Figure | None = None) -> tuple[list[Axes], list[Axes]]:
    """The pictures of the contact of load cases, and the panels of pressures; of a new figure, if none is given."""
    axes = (figure or figures.figure_of(cases)).axes
    panels = [item for item in axes if item.get_ylabel().startswith("pressure")]
    return [item for item in axes if item not in panels][: len(shown_cases(cases))], panels


def test_each_case_has_its_picture_and_its_curves():
    """A picture with the name and the peak of each; in each panel the curves of all, and the largest of all."""
    contacts, panels = case_axes(found(), figure_of_found())
    results = found().results
    assert [axes.get_title(loc="left").split("\n")[0] for axes in contacts] == [*results]
    first = next(iter(results.values())).contact
    assert len(panels) == len(first.zone_names)
    for axes, zone in zip(panels, range(len(first.zone_names)), strict=True):
        own = first.zone == zone
        curves = [line for line in axes.lines if len(line.get_xdata()) > 2]
        assert [line.get_label() for line in curves] == [*results]
        for line, result in zip(curves, results.values(), strict=True):
            assert np.sort(line.get_ydata()) == pytest.approx(np.sort(result.solution.pressure[own]))
        (band,) = axes.collections
        highest = np.max([result.solution.pressure[own] for result in results.values()])
        assert band.get_datalim(axes.transData).y1 == pytest.approx(highest)


def test_cases_beyond_those_that_are_drawn_are_the_ones_with_small_forces():
    """Nine pictures at most, in the order of the cases."""
    one = next(iter(found().results.values()))
    sizes = [3, 9, 1, 7, 5, 2, 8, 6, 4, 10]
    results = {
        f"{size}": replace(one, footprint=replace(one.footprint, forces={"floor": (0.0, float(size))}))
        for size in sizes
    }
    assert shown_cases(replace(found(), results=results)) == [str(size) for size in sizes if size > 1]


@pytest.mark.slow
@pytest.mark.parametrize(("of_wind", "of_others"), [(None, 4e-3), (2.3e-3, 0.2), (0.5, 1e-4)])
def test_pictures_write_peaks_with_the_digits_of_the_table(of_wind: float | None, of_others: float):
    """Where a peak has an error bar, its number has no digit beyond it, in curves, in bodies and above them."""
    results = {
        name: replace(one, accuracy=of_peaks(one, of_wind if name == "wind" else of_others))
        for name, one in found().results.items()
    }
    contacts, _ = case_axes(replace(found(), results=results))
    written = [axes.get_title(loc="left").split("\n")[1] for axes in contacts]
    assert written == [peak_of(one.to_dict(), NO_UNITS) for one in results.values()]
    axes = Figure().add_subplot()
    figures.draw_pressure(axes, results["wind"])
    assert [text.get_text() for text in axes.texts] == [f"peak {written[[*results].index('wind')]}"]
    axes = Figure().add_subplot()
    figures.draw_contact(axes, results["wind"])
    assert written[[*results].index("wind")] in [text.get_text().split(",")[0] for text in axes.texts]


NO_UNITS = Units()


def test_title_states_both_verdicts():
    title = " ".join(figure_of_found().get_suptitle().split())
    assert title == f"free block: all load cases; {in_short(case_verdicts(found()))}"
    assert "mesh: not met, error about " in title


@pytest.mark.slow
@pytest.mark.parametrize(("ending", "magic"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF")])
def test_it_is_saved_in_each_format(ending: str, magic: bytes, tmp_path: Path):
    figures.save(figures.figure_of(found()), tmp_path / f"cases{ending}")
    assert (tmp_path / f"cases{ending}").read_bytes().startswith(magic)


def test_one_result_has_its_own_figure():
    one = found().results["wind"]
    assert "wind" in figures.figure_of(one).get_suptitle()


@pytest.mark.slow
def test_result_page_has_contact_pressure_gap_and_shape(result: analysis.Result):
    axes = figures.figure_of_result(result).axes
    contact, (shape,) = axes[0], [item for item in axes if "deformed shape" in item.get_title(loc="left")]
    pressures = [item for item in axes if item.get_ylabel().startswith("pressure")]
    gaps = [item for item in axes if item.get_ylabel().startswith("gap")]
    assert any("von Mises stress" in item.get_ylabel() for item in axes)
    assert contact.get_title(loc="left").startswith("contact pressure, displacements to scale")
    assert contact.get_aspect() == 1
    zones = len(result.contact.zone_names)
    assert len(pressures) == len(gaps) == zones
    assert all("per undeformed length" in axes.get_ylabel() for axes in pressures)
    assert all(axes.get_ylabel().startswith("gap") for axes in gaps)
    assert "deformed shape" in shape.get_title(loc="left")
    assert shape.get_aspect() == 1
    drawn = [np.asarray(line.get_ydata()) for axes in pressures for line in axes.lines if len(line.get_xdata()) > 2]
    assert np.sort(np.concatenate(drawn)) == pytest.approx(np.sort(result.solution.pressure))
    drawn = [np.asarray(line.get_ydata()) for axes in gaps for line in axes.lines if len(line.get_xdata()) > 2]
    assert np.sort(np.concatenate(drawn)) == pytest.approx(
        np.sort(result.contact.initial_gap + result.solution.displacement),
        abs=1e-9 * result.contact.scales.displacement,
    )


def test_round_off_in_the_gap_is_drawn_as_closed():
    problem = block_in_a_corner().model_dump()
    problem["contact_zones"].pop("wall")
    problem["conditions"].pop("right")
    problem["conditions"]["left"] = {"displacement": {"x": 0}}
    problem["conditions"]["top"] = {"pressure": 3}
    problem["loads"] = {}
    problem["boundary"]["holes"] = []
    result = analysis.solve(Problem(**problem))  # uniform compression
    axes = Figure().add_subplot()
    figures.draw_gap(axes, result)
    assert [text.get_text() for text in axes.texts] == ["closed everywhere"]
    assert axes.get_ylim()[1] == result.contact.scales.displacement


def test_zones_with_equal_pressures_are_both_seen():
    """The wall's line is thinner than the floor's and dashed; the legend is above the axes."""
    axes = Figure().add_subplot()
    figures.draw_pressure(axes, analysis.solve(block_in_a_corner()))
    first, second = (line for line in axes.lines if len(line.get_xdata()) > 2)
    assert first.get_linewidth() > second.get_linewidth()
    assert (first.get_linestyle(), second.get_linestyle()) == ("-", "--")
    legend = axes.get_legend()
    assert legend is not None
    assert legend.get_window_extent().y0 >= axes.get_window_extent().y1


def test_what_curves_are_stands_between_the_name_of_the_zone_and_the_axes():
    """The roller touches both sides of the groove, which are one zone: two curves, named by where they begin."""
    result = analysis.solve(roller_in_a_groove())
    for draw in (figures.draw_pressure, figures.draw_gap):
        page = new_page(5.4, 3.6)
        axes = page.add_subplot()
        draw(axes, result, "seat")
        page.draw_without_rendering()
        legend = axes.get_legend()
        assert legend is not None
        assert legend.get_title().get_text() == "seat"
        texts = [legend.get_title(), *legend.get_texts()]
        assert all(text.get_text().startswith("from (") for text in texts[1:])
        boxes = [text.get_window_extent() for text in texts]
        assert all(not one.overlaps(other) for one, other in combinations(boxes, 2))
        assert all(box.y0 >= axes.get_window_extent().y1 for box in boxes)
        assert all(box.x1 <= page.bbox.x1 for box in boxes)
        assert axes.get_title(loc="left") == ""


def test_a_close_up_says_how_many_contacts_of_its_zone_it_leaves_out():
    axes = new_page(5.4, 4.2).add_subplot()
    figures.draw_contact(axes, analysis.solve(roller_in_a_groove()), "seat")
    assert axes.get_xlabel() == "x\n1 of 2 contacts of this zone"


def test_result_of_a_condensed_problem_has_no_shape():
    result = analysis.solve(analysis.condense(block_in_a_corner()))
    assert len(figures.figure_of_result(result).axes) == 2 * len(result.contact.zone_names)
    with pytest.raises(ValueError, match="no boundary"):
        figures.draw_deformed(Figure().add_subplot(), result)
    with pytest.raises(ValueError, match="no boundary"):
        figures.draw_contact(Figure().add_subplot(), result)


@cache
def on_a_punch() -> CaseResults:
    """The punch under two loads; the pressure at its edge is infinite under both."""
    cases = {name: {"conditions": {"top": {"pressure": size}}} for name, size in (("low", 1.0), ("high", 3.0))}
    return bemcontact.solve_cases(
        punch(conditions={"left": {"displacement": {"x": 0}}}, load_cases=cases, reference={})
    )


def texts_of(figure: Figure) -> str:
    """All texts of a figure."""
    titles = [axes.get_title(loc=loc) for axes in figure.axes for loc in ("left", "center", "right")]
    return " ".join([*titles, *(text.get_text() for axes in figure.axes for text in axes.texts)])


@pytest.mark.slow
def test_infinite_pressures_are_cut_off_at_three_times_the_mean():
    """The mean is statics: 30 on 2 mm, and 10 for a third of the load."""
    one = on_a_punch().results["high"]
    assert one.solution.pressure.max() > 100
    page = figures.figure_of(one)
    (pressure,) = [item for item in page.axes if item.get_ylabel().startswith("pressure")]
    assert pressure.get_ylim()[1] == pytest.approx(3 * 15, rel=1e-3)
    assert "infinite in foot: cut off" in texts_of(page)
    assert "peak" not in texts_of(page)
    assert f"{one.solution.pressure.max():.5g}" not in texts_of(page)
    contacts, (panel,) = case_axes(on_a_punch())
    assert panel.get_ylim()[1] == pytest.approx(3 * 15, rel=1e-3)
    assert [axes.get_title(loc="left") for axes in contacts] == ["low\ninfinite in foot", "high\ninfinite in foot"]


@pytest.mark.slow
def test_color_of_the_title_is_that_of_the_worse_verdict():
    def color_of(result: analysis.Result) -> str:
        return figures.figure_of(result)._suptitle.get_color()  # pyright: ignore

    one = on_a_punch().results["low"]
    doubtful = replace(one.certificate, kind=CertificateKind.LOCAL, heading=HEADINGS[CertificateKind.LOCAL])
    unmet = replace(one, accuracy=replace(one.accuracy, met=False))
    colors = [color_of(item) for item in (one, unmet, replace(unmet, certificate=doubtful))]
    assert colors == ["#222222", "#8a5a00", "#d55e00"]


@cache
def drawn(name: str) -> tuple[analysis.Result, list[Axes]]:
    """A shipped model, solved, and the axes of its page."""
    result = analysis.solve(spec.load(MODELS / f"{name}.yaml"))
    return result, figures.figure_of_result(result).axes


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gallery/hertz_small", "gallery/flat_punch", "cylinder_on_plane"])
def test_panels_show_a_small_contact_and_about_its_width_to_either_side(name: str):
    """At least a sixth of the axis is contact; the largest value that is drawn in the frame fills it."""
    result, axes = drawn(name)
    (pressure,) = [item for item in axes if item.get_ylabel().startswith("pressure")]
    (gap,) = [item for item in axes if item.get_ylabel().startswith("gap")]
    arcs = [s for item in result.footprint.intervals for s in (item.start_arc, item.end_arc)]
    for axes in (pressure, gap):
        low, high = axes.get_xlim()
        assert low <= min(arcs) + 1e-9 * max(arcs)
        assert high >= max(arcs) * (1 - 1e-9)
        assert max(arcs) - min(arcs) > 0.13 * (high - low)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["gallery/hertz_small", "gallery/flat_punch", "cylinder_on_plane", "gallery/block_in_corner"]
)
def test_names_lie_in_the_picture_and_apart_from_each_other(name: str):
    """Right of the axes there may be room, up to the next ones."""
    axes, *others = drawn(name)[1]
    frame, page = axes.get_window_extent(), axes.figure.bbox
    boxes = [text.get_window_extent() for text in axes.texts]
    assert all(frame.x0 <= box.x0 and box.x1 <= page.x1 for box in boxes)
    assert all(frame.y0 <= box.y0 and box.y1 <= frame.y1 for box in boxes)
    assert not any(box.overlaps(other.get_tightbbox()) for box in boxes for other in others)
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


def test_contact_across_the_end_of_a_closed_zone_is_one_curve():
    """A pin that is drawn to the right in a hole whose line begins there: each case rises once and falls once."""
    hole = {
        "outer": [{"name": "out", "kind": "arc", "center": [0, 0], "radius": 2, "angles": [0, 360], "elements": 16}],
        "holes": [[{"name": "hole", "kind": "arc", "center": [0, 0], "radius": 1, "angles": [360, 0], "elements": 32}]],
    }
    ways = {"right": (1, 0), "up": (0, 1), "right and down": (1, -0.2)}
    problem = Problem(
        name="lug", material={"young_modulus": 1000, "poisson_ratio": 0.3}, boundary=hole,
        conditions={"out": {"displacement": {"x": 0, "y": 0}}},
        contact_zones={"pin": {"edges": "hole", "surface": {
            "kind": "circle", "center": [0, 0], "radius": 0.99, "body": "outside"}}},
        tools={"pin": {"zones": "pin", "force": {"x": 0, "y": 0}}},
        load_cases={name: {"tools": {"pin": {"force": {"x": x, "y": y}}}} for name, (x, y) in ways.items()},
        accuracy=None,
    )  # pyright: ignore  # fmt: skip
    cases = bemcontact.solve_cases(problem)
    axes = Figure().add_subplot()
    figures.draw_case_pressures(axes, cases)
    for case, result in cases.results.items():
        alone = Figure().add_subplot()
        figures.draw_pressure(alone, result)
        drawn = [line for line in axes.lines if line.get_label() == case] + [alone.lines[1]]
        for x, y in ((np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in drawn):
            assert (np.diff(x) > 0).all()
            assert x[-1] - x[0] == pytest.approx(result.contact.run_length[0])
            assert y[0] == y[-1] == 0
            rises = np.diff(y)[np.diff(y) != 0] > 0
            assert (np.diff(rises.astype(int)) != 0).sum() == 1
            assert np.trapezoid(y, x) == pytest.approx(result.contact.weights @ result.solution.pressure, rel=0.02)


def on_few_elements(problem: Problem) -> Problem:
    """The problem with 16 elements on each edge, and without an accuracy; copies of bodies have the same ones."""
    bodies = problem.model_dump(exclude_unset=True)["bodies"]
    boundaries = [body["boundary"] for body in bodies.values() if "boundary" in body]
    for edge in [edge for loops in boundaries for loop in (loops["outer"], *loops.get("holes", ())) for edge in loop]:
        edge["elements"] = 16
    return problem.with_values({"bodies": bodies, "accuracy": None})


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(MODELS.rglob("*.yaml")), ids=lambda path: path.stem)
def test_the_picture_of_each_model_can_be_drawn(path: Path):
    """Contact up to a clamp, all round a hole, of a slit and under load cases; the largest stress is in its colors."""
    problem = spec.load(path)
    if "stated mesh" in problem.variants:
        problem = spec.load(path, variant="stated mesh")
    elif path.stem == "roller_bearing":
        problem = on_few_elements(problem)  # on a mesh for its accuracy, eleven bodies take half a minute
    else:
        problem = problem.with_value("accuracy", 0.1)
    results = bemcontact.solve_cases(problem) if problem.load_cases else bemcontact.solve(problem)
    figures.figure_of(results).draw_without_rendering()


@pytest.mark.slow
def test_bars_show_each_of_many_contacts_that_is_closed():
    """The inner ring is pressed down: the rollers above it are free."""
    result = bemcontact.solve(bearing(1.0, 1e-3, elements=16))
    force = {name: np.hypot(*force) for name, force in result.footprint.forces.items()}
    closed = [name for name in result.contact.zone_names if force[name] > 0]
    assert 0 < len(closed) < len(force)
    page = figures.figure_of_result(result)
    page.draw_without_rendering()
    peaks, forces = (
        next(axes for axes in page.axes if axes.get_xlabel().startswith(label)) for label in ("largest", "force")
    )
    assert [label.get_text() for label in peaks.get_yticklabels()] == closed
    assert [bar.get_width() for bar in forces.patches] == pytest.approx([force[name] for name in closed])
    left_open = [name for name in force if name not in closed]
    assert peaks.get_title(loc="left").startswith(f"no contact: {left_open[0]}, ")
    panels = [axes.get_title(loc="left") for axes in page.axes if axes.get_ylabel().startswith("pressure")]
    most = sorted(closed, key=lambda name: -force[name])[:3]
    contact, pressure = result.contact, result.solution.pressure
    highest = contact.zone_names[int(contact.zone[pressure.argmax()])]
    assert [*panels] == [name for name in force if name in (*most, highest)]
    assert forces.get_xlabel().endswith(drawn_near([result]))
    assert drawn_near([result]).startswith(f"drawn near: {len(panels)} of {len(force)} contacts, ")


@pytest.mark.parametrize("forces", [[5, 4, 3, 2, 1], [5, 4, 0, 0, 0]])
def test_contacts_that_are_not_drawn_near_are_told(forces: list[float]):
    """Of five contacts the fifth is narrow: its force is the least, and its pressure the largest."""
    widths = np.array([1.0, 1.0, 1.0, 1.0, 0.01])
    contact = CondensedContact.from_compliance(np.eye(5), -np.array(forces) / widths, weights=widths)
    zones = tuple(f"pad {number}" for number in range(1, 6))
    result = bemcontact.solve(
        replace(contact, zone=np.arange(5), run=np.arange(5), run_length=np.full(5, np.inf), zone_names=zones)
    )
    shown = panels_of([result])
    if forces[-1]:
        assert shown == ["pad 1", "pad 2", "pad 3", "pad 5"]
        assert drawn_near([result]).endswith("the 3 with the largest forces, and that with the largest pressure")
    else:
        assert shown == ["pad 1", "pad 2"]
        assert drawn_near([result]) == "drawn near: 2 of 5 contacts, the others do not touch"
    page = " ".join(result_page.render(result, {}, None).split())
    assert drawn_near([result])[1:] in page


@pytest.mark.slow
def test_pictures_of_a_long_body_are_aligned():
    page = figures.figure_of_result(analysis.solve(leaves()))
    page.draw_without_rendering()
    contact, shape = (axes.get_position() for axes in page.axes[:2])
    assert (contact.x0, contact.x1) == pytest.approx((shape.x0, shape.x1), abs=5e-3)
    assert contact.width > 0.75
