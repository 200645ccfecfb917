"""What objects show of themselves in a notebook, and as tables; `bemcontact.views` has the methods."""

import base64
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from importlib import import_module
from importlib.util import find_spec
from os import PathLike
from typing import Any

import numpy as np

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.assessment.comparison import Comparison
from bemcontact.checks.arguments import file_path
from bemcontact.errors import OptionError, ProblemError
from bemcontact.modelling.gap_design.designed_gap import GapDesign
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.problems import Problem
from bemcontact.report import figures
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import facts
from bemcontact.report.figures.drawing import picture_of
from bemcontact.report.figures.drawing import plot as plot
from bemcontact.report.formatting import materials_in_words, number, surface_in_words, with_unit
from bemcontact.report.study_page import rows_in_short
from bemcontact.report.verdicts import case_verdicts, result_verdicts
from bemcontact.report.zones import POINT_COLUMNS, by_case, point_lines
from bemcontact.studies.table import StudyTable

NEEDED = "it needs the extra tables: pip install 'bemcontact[tables]'"


def html(item: Any) -> str:
    """A picture and the main facts of an object, for notebooks."""
    picture = figures.vector_graphic(picture_of(item)) if _has_picture(item) else b""
    image = f"<img alt='' src='data:image/svg+xml;base64,{base64.b64encode(picture).decode()}'>" if picture else ""
    return f"<div>{image}{_table(item)}</div>"


def animate(path: ParameterPath, file: str | PathLike[str]) -> None:
    """Write the animation of a path; see `ParameterPath.animate`."""
    place = file_path(file, "file")
    try:
        figures.ensure_known_animation(place)
    except ValueError as error:
        raise OptionError(str(error)) from None
    figures.save_animation(path, place)


def _table(item: Any) -> str:
    """The table beside a picture."""
    match item:
        case StudyTable():
            return rows_in_short(item)
        case Comparison():
            rows = _contender_rows(item)
            head = "".join(f"<th>{name.replace('_', ' ')}</th>" for name in rows[0])
            body = "".join(f"<tr>{''.join(f'<td>{_cell(value)}</td>' for value in row.values())}</tr>" for row in rows)
            caption = f"<caption>{escape(f'{item.contact.name}: {item.verdict}')}</caption>"
            return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    rows = (f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in _facts(item))
    return f"<table style='text-align:left'>{''.join(rows)}</table>"


def _cell(value: Any) -> str:
    """A value in a table of HTML."""
    return "" if value is None else f"{value:.1e}" if isinstance(value, float) else escape(str(value))


def _has_picture(item: Any) -> bool:
    """Whether there is anything to draw."""
    if isinstance(item, StudyTable):
        return bool(item.columns) and any(len(axis.values) > 1 for axis in item.axes)
    return not (isinstance(item, ParameterPath) and item.infinite)


def _facts(item: Any) -> Iterator[tuple[str, str]]:
    """Names and values of the main facts of an object."""
    match item:
        case Problem():
            yield "Problem", item.title
            yield from (("Material", line) for line in materials_in_words(item))
            yield "Bodies", ", ".join(part.name or f"one, of {len(item.edges)} edges" for part in item.parts)
            for name, zone in item.zones.items():
                edges = ", ".join(item.edges_of(name))
                yield "Contact", f"{name}: {edges}, with {surface_in_words(zone.surface)}"
            yield from (("Load case", name) for name in item.case_names)
        case Result():
            yield "Result", item.contact.name
            yield from facts(item.to_dict(), units_of(item.contact))
            yield from ((verdict.of, verdict.words) for verdict in result_verdicts(item))
        case CaseResults():
            yield "Load cases", item.name
            for name, result in item.results.items():
                yield name, repr(result).partition(": ")[2].rstrip(">")
            yield from ((verdict.of, verdict.words) for verdict in case_verdicts(item))
        case ParameterPath():
            yield "Path", repr(item).strip("<>")
        case GapDesign():
            stress = units_of(item.before[0].contact).stress
            yield "Design", f"{item.goal.value} on {item.zone}"
            yield "Before", with_unit(number(item.value_before), stress)
            yield "After", with_unit(number(item.value), stress)
        case _:
            yield "", repr(item)


def frame(item: Any) -> Any:
    """A table for pandas; see `bemcontact.views.Tabular.to_frame`."""
    pandas = _module("pandas")
    match item:
        case Result() | CaseResults():
            lines = [line for case, result in by_case(item).items() for line in point_lines(case, result)]
            table = pandas.DataFrame(lines, columns=list(POINT_COLUMNS))
            table["touching"] = table["touching"].astype(bool)
            if isinstance(item, Result):
                table = table.drop(columns="case")
            first = item if isinstance(item, Result) else next(iter(item.results.values()))
            units = _units(units_of(first.contact))
        case ParameterPath():
            contact, path = item.contact, item.path
            count, n = path.pressure.shape
            values = np.repeat([item.value(t) for t in path.parameter.tolist()], n)
            names = np.array(contact.zone_names)[contact.zone]
            table = pandas.DataFrame(
                {
                    item.key: values, "zone": np.tile(names, count), "x": np.tile(contact.points[:, 0], count),
                    "y": np.tile(contact.points[:, 1], count), "arc": np.tile(contact.arc_position, count),
                    "pressure": path.pressure.ravel(), "gap": path.gap.ravel(),
                }
            )  # fmt: skip
            units = _units(units_of(contact))
        case StudyTable():
            table = pandas.DataFrame(item.table())
            units = {"length": item.units.length, "force": item.units.force}
        case Comparison():
            table = pandas.DataFrame(_contender_rows(item))
            units = _units(units_of(item.contact))
        case GapDesign():
            contact = item.before[0].contact
            at = item.points
            table = pandas.DataFrame(
                {
                    "x": contact.points[at, 0], "y": contact.points[at, 1], "arc": item.arc_position,
                    "profile": item.profile[at],
                }
            )  # fmt: skip
            units = _units(units_of(contact))
        case _:
            raise ProblemError(f"there is no table of {type(item).__name__}")
    table.attrs["units"] = units
    return table


def _contender_rows(comparison: Comparison) -> list[dict[str, Any]]:
    """A row for each formulation of a comparison."""
    rows = []
    for item in comparison.everyone:
        difference = comparison.difference(item.label)
        rows.append(
            {
                "formulation": item.label, "verdict": item.verdict.outcome, "objective": item.objective,
                "largest_difference": None if difference is None else difference.largest,
                "solver": None if item.assessment is None else item.assessment.solution.solver,
                "iterations": None if item.assessment is None else item.assessment.solution.iterations,
            }
        )  # fmt: skip
    return rows


def _units(units: Any) -> dict[str, str]:
    """Units of the columns of a table of contact points."""
    return {"x": units.length, "y": units.length, "arc": units.length, "gap": units.length, "pressure": units.stress}


def dataset(item: Any) -> Any:
    """Arrays for xarray; see `bemcontact.views.Tabular.to_xarray`."""
    xarray = _module("xarray")
    match item:
        case Result():
            return _points_dataset(xarray, item.contact, {}, item.pressure, item.gap)
        case CaseResults():
            results = [*item.results.values()]
            cases = {"case": [*item.results]}
            pressure, gap = ([getattr(result, name) for result in results] for name in ("pressure", "gap"))
            found = _points_dataset(xarray, results[0].contact, cases, pressure, gap)
            return found.assign_attrs(name=item.name)
        case ParameterPath():
            values = {"value": [item.value(t) for t in item.path.parameter.tolist()]}
            found = _points_dataset(xarray, item.contact, values, item.path.pressure, item.path.gap)
            return found.assign_attrs(key=item.key)
        case StudyTable():
            return _study_dataset(xarray, item)
    raise ProblemError(f"there are no arrays of {type(item).__name__}; to_frame has its table")


def _points_dataset(xarray: Any, contact: Any, others: Mapping[str, Any], pressure: Any, gap: Any) -> Any:
    """Pressure and gap by contact point, and by other dimensions before."""
    units, dims = units_of(contact), (*others, "point")
    names = np.array(contact.zone_names)[contact.zone]
    lengths = {"x": contact.points[:, 0], "y": contact.points[:, 1], "arc": contact.arc_position}
    return xarray.Dataset(
        {
            "pressure": (dims, np.array(pressure), {"units": units.stress}),
            "gap": (dims, np.array(gap), {"units": units.length}),
        },
        coords={
            **others, "zone": ("point", names),
            **{name: ("point", values, {"units": units.length}) for name, values in lengths.items()},
        },
        attrs={"name": contact.name},
    )  # fmt: skip


def _study_dataset(xarray: Any, study: StudyTable) -> Any:
    """Each output and its error by the parameters that are varied."""
    names = [axis.name for axis in study.axes]
    shape = tuple(len(axis.values) for axis in study.axes)
    table = study.table()
    data = {
        column: (names, np.array([np.nan if value is None else value for value in table[column]], float).reshape(shape))
        for output in study.columns
        for column in (output, f"{output}_error")
    }
    data["status"] = (names, np.array(table["status"]).reshape(shape))
    coordinates = {axis.name: _coordinates(axis.values) for axis in study.axes}
    return xarray.Dataset(data, coords=coordinates, attrs={"name": study.name})


def _coordinates(values: Sequence[Any]) -> list[Any]:
    """Values of a parameter; what is no number or text is written as one."""
    return [value if isinstance(value, int | float | str) else str(value) for value in values]


def _module(name: str) -> Any:
    """Import a module of the extra ``tables``."""
    if find_spec(name) is None:
        raise ModuleNotFoundError(f"{name} is not installed; {NEEDED}")
    return import_module(name)
