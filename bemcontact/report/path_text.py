"""A load path in words: breakpoints and verdicts, and the summary in the terminal; see `bemcontact.report.text`."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text

from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.assessment.penetration import Misfit
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.parametric.parameter_path import ParameterPath, PathState
from bemcontact.report.bars import error_percent, with_bar
from bemcontact.report.contact_words import units_of
from bemcontact.report.facts import UNRESOLVED
from bemcontact.report.formatting import NEGLIGIBLE, number, plural, sentence_case, vector
from bemcontact.report.tables import add, list_of_facts, table_of
from bemcontact.report.text import add_verdict
from bemcontact.report.verdicts import Verdict, mesh_verdict, quality_of_misfit

MANY = 4
"""Number of points up to which those that enter or leave together are named."""
MOVED_AWAY = (Misfit.OFF, Misfit.MOVED)
"""What may be wrong with a state of a path because the body moves far up to its end."""


class BreakpointWords(NamedTuple):
    """A breakpoint: value, what enters, what leaves, how many points touch, the peak and its place."""

    value: str
    enter: str
    leave: str
    touching: str
    peak: str
    place: str


def breakpoint_words(path: ParameterPath, state: PathState) -> BreakpointWords:
    """Write a breakpoint of a path; a peak whose error is not known has a question mark."""
    contact = path.contact
    unknown = " ± ?" * bool(state.peak and state.bars and state.peak_bar is None)
    return BreakpointWords(
        value=number(state.value),
        enter=_named(contact, state.entered),
        leave=_named(contact, state.left),
        touching=f"{len(state.touching)}",
        peak="infinite" if state.peak is None else with_bar(state.peak, state.peak_bar) + unknown,
        place="" if state.at is None else _place(contact, state.at, _shortest(contact, state.touching)),
    )


def _named(contact: CondensedContact, points: tuple[int, ...]) -> str:
    """Name points by their number and place."""
    if len(points) > MANY:
        return f"{len(points)} points"
    return ", ".join(f"{i} at {_place(contact, i)}" for i in points)


def _place(contact: CondensedContact, i: int, length: float = 0.0) -> str:
    """The place of a point; what is small beside the length of a contact is zero."""
    x, y = contact.points[i].tolist()
    return vector((x, y), "", scale=max(float(abs(contact.points).max()), UNRESOLVED * length / NEGLIGIBLE))


def _shortest(contact: CondensedContact, touching: tuple[int, ...]) -> float:
    """The shortest contact of a zone that touches at these points [L]."""
    lengths = np.bincount(contact.zone[[*touching]], weights=contact.weights[[*touching]])
    return float(lengths[lengths > 0].min())


def path_verdicts(path: ParameterPath) -> Iterator[Verdict]:
    """Verdicts on the equations all along a path, and on the mesh at both ends."""
    beyond, word = path.penetration, HEADINGS[CertificateKind.UNIQUE] if path.certified else "not proved"
    quality = "good" if path.certified else "bad"
    if beyond is not None:
        word, quality = str(beyond.kind), quality_of_misfit(beyond.to_dict(), path.proved)
    yield Verdict("Equations", quality, word, path_sentence(path))
    of_start = path.start, path.reaches[0], path.path.begins_at == 0.0, path.start_accuracy
    of_end = path.end, path.reaches[1], path.path.ends_at == 1.0, path.end_accuracy
    for value, last, reached, accuracy in (of_start, of_end):
        verdict = mesh_verdict(accuracy.to_dict())
        if not reached:
            words = f"The path ends at {number(last)}, where errors were not estimated."
            verdict = Verdict("Mesh", "fair", "not reached", words)
        yield verdict._replace(words=f"At {path.key} = {number(value)}. {verdict.words}")
    if path.coarse:
        yield Verdict("Mesh", "fair", "too coarse between the ends", _between_the_ends(path))
    elif not path.breakpoint_bars and (path.start_accuracy.bars or path.end_accuracy.bars):
        words = (
            "No path was found on the mesh with which errors are estimated. The errors at breakpoints are not known."
        )
        yield Verdict("Mesh", "fair", "not assessed between the ends", words)


def _between_the_ends(path: ParameterPath) -> str:
    """Say where the errors of peaks between the ends are larger than asked."""
    first, last = path.coarse[0], path.coarse[-1]
    values = " to ".join(dict.fromkeys(number(state.value) for state in (first, last)))
    known = [state.peak_bar for state in path.coarse if state.peak_bar is not None]
    error = f"up to {error_percent(max(known))}" if known else "or not known"
    error += ", or not known" * (0 < len(known) < len(path.coarse))
    return (
        f"The mesh is made for the ends of the path. At {len(path.coarse)} of {len(path.pressed)} breakpoints with "
        f"contact, at {path.key} = {values}, errors of peaks are larger than asked, {error}. The table has the error "
        "bar of each. A study makes a mesh for each value."
    )


def path_sentence(path: ParameterPath) -> str:
    """Certificate of a path in sentences; where it is missing, the notes say why."""
    first, last = map(number, path.reaches)
    exact = f"The conditions of contact hold to {path.residual:.0e} at each breakpoint (natural residual)."
    if path.certified:
        return f"Each state from {first} to {last} is proved to be the only contact state. {exact}"
    notes = (f"{sentence_case(note)}." for note in path.notes)
    deepest = () if path.penetration is None else (path.penetration.words,)
    where = () if path.penetrates_at is None else (f"This is at {path.key} = {number(path.penetrates_at)}.",)
    if path.penetrates_at != path.reaches[1] and path.penetration and path.penetration.kind in MOVED_AWAY:
        where += ("A path has the gaps and normals of its end; a study has those of each value.",)
    return " ".join((*deepest, *where, *notes, exact))


def path_summary(path: ParameterPath) -> RenderableType:
    """List where points enter and leave contact, and the peak pressure there."""
    units = units_of(path.contact)
    peak = f"peak, {units.stress}" if units.stress else "peak"
    table = table_of("", "enter", "leave", "in contact", peak, "at", right=frozenset({"", "in contact", peak}))
    for state in path.breakpoints:
        table.add_row(*map(Text, breakpoint_words(path, state)))
    where = f"{path.key} from {number(path.start)} to {number(path.end)}"
    counts = {"breakpoint": len(path.breakpoints), "pivot": path.pivots}
    how = ", ".join(f"{count} {plural(noun, count)}" for noun, count in counts.items())
    shown = list_of_facts()
    for note in path.notes if path.certified else ():
        add(shown, "Note", note)
    for verdict in path_verdicts(path):
        add_verdict(shown, verdict)
    return Group(Text(path.contact.name, "bold"), Text(f"{where}; {how}", "dim"), "", table, "", shown)
