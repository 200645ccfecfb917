"""The pictures that objects draw of themselves, by name; `bemcontact.views` has the method."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.assessment.comparison import Comparison
from bemcontact.bem.mesh import build
from bemcontact.checks.arguments import shown
from bemcontact.errors import OptionError, ProblemError
from bemcontact.modelling.gap_design.designed_gap import GapDesign
from bemcontact.options import StressMeasure, named
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.problems import Problem
from bemcontact.report.contact_words import units_of
from bemcontact.report.figures.contact import draw_contact
from bemcontact.report.figures.deformed import draw_deformed
from bemcontact.report.figures.design import draw_relief, draw_relieved_pressure
from bemcontact.report.figures.load_cases import draw_case_pressures
from bemcontact.report.figures.mesh_study import plan_of
from bemcontact.report.figures.page import labeled, name_axis, new_page
from bemcontact.report.figures.path import draw_interval_ends, draw_moments, draw_peaks, draw_resultants
from bemcontact.report.figures.problem import draw_problem
from bemcontact.report.figures.result import draw_gap, draw_pressure
from bemcontact.report.figures.study import draw_output
from bemcontact.studies.table import StudyTable

Draw = Callable[..., None]


def plot(shown_object: Any, axes: Axes | None, options: Mapping[str, Any]) -> Axes:
    """Draw what an object shows; see `bemcontact.views.Drawn.plot`."""
    draw = _drawing(shown_object, dict(options))
    if axes is None:
        axes = pyplot.figure(layout="constrained").add_subplot()
    elif not isinstance(axes, Axes):
        hint = "; .plot().figure.savefig(…) writes a file" if isinstance(axes, str) else ""
        hint = f"; write what={axes!r}" if isinstance(axes, str) and axes in _pictures(shown_object) else hint
        raise OptionError(f"axes must be axes of matplotlib, or None; found {shown(axes)}{hint}")
    draw(axes)
    return axes


def _drawing(item: Any, options: dict[str, Any]) -> Callable[[Axes], None]:
    """How an object is drawn with some options, which are checked here."""
    pictures = _pictures(item)
    default = next(iter(pictures))
    if isinstance(item, Result) and item.boundary is None:
        default = "pressure"
    what = options.pop("what", None) or default
    if what not in pictures:
        raise OptionError(f"there is no picture {shown(what)} of this; take one of {', '.join(pictures)}")
    draw, takes = pictures[what]
    for name in options:
        if name not in takes:
            choices = ", ".join([*takes, "axes", "what"])
            raise OptionError(f"the picture '{what}' has no option '{name}'; it takes {choices}")
    given = {name: value for name, value in options.items() if value is not None}
    if "zone" in given and given["zone"] not in (known := _zones(item)):
        raise OptionError(f"there is no contact zone {shown(given['zone'])}; take one of {', '.join(known)}")
    if "stress" in given:
        given["stress"] = named(StressMeasure, given["stress"], "stress")
    if isinstance(item, Result) and what in ("contact", "deformed") and item.boundary is None:
        raise ProblemError("the result of a condensed problem has no boundary to draw; solve the problem itself")
    return lambda axes: draw(axes, item, **given)


def _pictures(item: Any) -> Mapping[str, tuple[Draw, tuple[str, ...]]]:
    """The pictures of an object by name, the usual one first."""
    return PICTURES[next(kind for kind in PICTURES if isinstance(item, kind))]


def _zones(item: Any) -> Sequence[str]:
    """Names of the contact zones of an object."""
    if isinstance(item, ParameterPath):
        return item.zones
    first = next(iter(item.results.values())) if isinstance(item, CaseResults) else item
    return first.contact.zone_names


def _draw_problem(axes: Axes, problem: Problem) -> None:
    """Draw a problem on the mesh that it states, or on the first one of a search."""
    meshed = first_mesh(problem) if problem.adapts else problem
    draw_problem(axes, meshed, build(meshed))


def _draw_ends(axes: Axes, path: ParameterPath, zone: str | None = None) -> None:
    draw_interval_ends(axes, path, zone or path.zones[0])
    name_axis(axes.xaxis, path.key)


def _over_key(draw: Callable[[Axes, ParameterPath], None]) -> Draw:
    """A picture over the parameter of a path, with the name of it."""

    def drawn(axes: Axes, path: ParameterPath) -> None:
        draw(axes, path)
        name_axis(axes.xaxis, path.key)

    return drawn


def _draw_output(axes: Axes, study: StudyTable, output: str | None = None, over: str | None = None) -> None:
    """Draw an output of a study over one parameter."""
    output = study.columns[0] if output is None else output
    if output not in study.columns:
        raise OptionError(f"there is no output {shown(output)}; take one of {', '.join(study.columns)}")
    names = [axis.name for axis in study.axes]
    number_of_axis = max(range(len(names)), key=lambda i: len(study.axes[i].values)) if over is None else None
    if number_of_axis is None:
        if over not in names:
            raise OptionError(f"there is no parameter {shown(over)}; take one of {', '.join(names)}")
        number_of_axis = names.index(str(over))
    draw_output(axes, study, output, number_of_axis)


def _draw_contenders(axes: Axes, comparison: Comparison, zone: str | None = None) -> None:
    """Draw the pressure of each formulation along one contact, that of the largest pressure if none is named."""
    contact, units = comparison.contact, units_of(comparison.contact)
    solved = [item for item in comparison.everyone if item.assessment is not None]
    pressures = [item.assessment.solution.pressure for item in solved if item.assessment is not None]
    own = np.ones(contact.size, bool) if zone is None else contact.zone == contact.zone_names.index(zone)
    largest = np.where(own, np.max(pressures, axis=0), -np.inf)
    at = contact.points_of_run(int(contact.run[largest.argmax()]))
    arc = contact.arc_position[at]
    for order, (item, pressure) in enumerate(zip(solved, pressures, strict=True)):
        axes.plot(arc, pressure[at], linewidth=6.0 / (1 + order), alpha=1.0 if order else 0.5, label=item.label)
    pressed = arc[largest[at] > 0]
    if len(pressed):
        length = float(np.ptp(pressed)) or float(np.ptp(arc))
        axes.set_xlim(max(pressed[0] - length, arc[0]), min(pressed[-1] + length, arc[-1]))
    name_axis(axes.xaxis, labeled(f"distance along {contact.zone_names[int(contact.zone[at[0]])]}", units.length))
    name_axis(axes.yaxis, labeled("pressure", units.stress))
    axes.legend(frameon=False)


PICTURES: dict[type, dict[str, tuple[Draw, tuple[str, ...]]]] = {
    Problem: {"problem": (_draw_problem, ())},
    Result: {
        "contact": (draw_contact, ("zone", "stress")),
        "pressure": (draw_pressure, ("zone",)),
        "gap": (draw_gap, ("zone",)),
        "deformed": (draw_deformed, ()),
        "stress": (partial(draw_deformed, stress=StressMeasure.VON_MISES), ("stress",)),
    },
    CaseResults: {"pressure": (draw_case_pressures, ("zone",))},
    Comparison: {"pressure": (_draw_contenders, ("zone",))},
    ParameterPath: {
        "peak": (_over_key(draw_peaks), ()),
        "force": (_over_key(draw_resultants), ()),
        "moment": (_over_key(draw_moments), ()),
        "ends": (_draw_ends, ("zone",)),
    },
    StudyTable: {"output": (_draw_output, ("output", "over"))},
    GapDesign: {"profile": (draw_relief, ()), "pressure": (draw_relieved_pressure, ())},
}
"""Pictures of each kind of object by name, the first one if none is named, and the options of each."""


def picture_of(item: Any) -> Figure:
    """The picture of an object in a notebook."""
    if isinstance(item, Problem):
        return plan_of(first_mesh(item) if item.adapts else item)
    figure = new_page(6.0, 4.4)
    _drawing(item, {})(figure.add_subplot())
    return figure
