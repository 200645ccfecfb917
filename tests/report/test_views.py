"""What objects show of themselves: notebooks, data frames, arrays; each value is that of the object."""

import sys

import numpy as np
import pytest
from shown import GALLERY, LOAD, MODULUS, shown

import bemcontact
from bemcontact.report import views


@pytest.mark.slow
@pytest.mark.parametrize("name", ["problem", "result", "cases", "comparison", "path", "study"])
def test_a_notebook_shows_a_picture_and_a_table_without_markup_of_the_user(name):
    page = shown(name)._repr_html_()
    assert "src='data:image/svg+xml;base64," in page
    assert "<table" in page
    marked = bemcontact.load(GALLERY / "hertz_small.yaml", {"name": "<b>bold</b>"})._repr_html_()
    assert "<b>" not in marked
    assert "&lt;b&gt;bold" in marked


@pytest.mark.slow
def test_the_frame_of_a_result_has_each_contact_point():
    result = shown("result")
    frame = result.to_frame()
    assert [*frame.columns[:3]] == ["zone", "x", "y"]
    order = np.lexsort([frame.y, frame.x])
    mine = np.lexsort(result.points.T[::-1])
    np.testing.assert_array_equal(frame.pressure.to_numpy()[order], result.pressure[mine])
    np.testing.assert_array_equal(frame.gap.to_numpy()[order], result.gap[mine])
    assert frame.touching.sum() == result.touching.sum()
    assert frame.attrs["units"]["pressure"] == "MPa"


@pytest.mark.slow
def test_the_frame_of_load_cases_has_each_case():
    cases = shown("cases")
    frame = cases.to_frame()
    for name, result in cases.results.items():
        own = frame[frame.case == name]
        assert len(own) == result.contact.size
        assert own.pressure.max() == result.pressure.max()


def test_the_frame_of_a_path_has_each_breakpoint():
    path = shown("path")
    frame = path.to_frame()
    peaks = frame.groupby(path.key).pressure.max()
    assert [*peaks.index] == [path.value(t) for t in path.path.parameter.tolist()]
    np.testing.assert_array_equal(peaks, path.path.pressure.max(axis=1))


def test_the_frames_of_a_study_and_a_comparison_have_their_rows():
    study, comparison = shown("study"), shown("comparison")
    assert {name: [*column] for name, column in study.to_frame()[["member", "status"]].items()} == {
        name: study.table()[name] for name in ("member", "status")
    }
    assert [*comparison.to_frame().formulation] == ["QP3", "direct"]


@pytest.mark.slow
def test_arrays_have_named_dimensions():
    result, cases, path, study = (shown(name) for name in ("result", "cases", "path", "study"))
    arrays = result.to_xarray()
    np.testing.assert_array_equal(arrays.pressure, result.pressure)
    assert arrays.pressure.attrs["units"] == "MPa"
    by_case = cases.to_xarray()
    for name in cases.results:
        np.testing.assert_array_equal(by_case.pressure.sel(case=name), cases.results[name].pressure)
    assert by_case.attrs["name"] == cases.name
    np.testing.assert_array_equal(path.to_xarray().pressure, path.path.pressure)
    grid = study.to_xarray()
    assert grid.peak.dims == (LOAD, MODULUS)
    for row in study.rows:
        there = grid.sel({key: row.values[key] for key in (LOAD, MODULUS)})
        assert float(there.peak) == row.reading("peak").value
        assert str(there.status.item()) == row.status


def test_what_has_no_arrays_or_packages_says_so(monkeypatch):
    with pytest.raises(bemcontact.ProblemError, match="to_frame has its table"):
        shown("comparison").to_xarray()
    monkeypatch.setattr(views, "find_spec", lambda name: None)
    with pytest.raises(ModuleNotFoundError, match=r"pandas is not installed.*bemcontact\[tables\]"):
        shown("result").to_frame()
    with pytest.raises(ModuleNotFoundError, match="xarray is not installed"):
        shown("result").to_xarray()


def test_results_lead_to_their_parts_and_have_units_in_their_line():
    result = shown("result")
    assert result.peak is result.footprint.peak
    assert result.intervals is result.footprint.intervals
    assert result.forces is result.footprint.forces
    assert abs(result.gap[result.touching]).max() <= 1e-12 * result.contact.scales.displacement  # zero up to round-off
    assert result.peak.pressure == result.pressure.max()
    assert repr(result).endswith("MPa>")
    assert " ± " in repr(result)
    assert result.units.stress == "MPa"


@pytest.mark.slow
def test_nothing_is_imported_until_something_is_shown():
    import subprocess  # a fresh process: this one has drawn

    code = (
        "import sys, bemcontact; p = bemcontact.load(sys.argv[1]); r = bemcontact.solve(p, accuracy=0.1); "
        "assert not {'matplotlib', 'pandas', 'xarray'} & {*sys.modules}"
    )
    subprocess.run([sys.executable, "-c", code, str(GALLERY / "hertz_small.yaml")], check=True)
