"""Verdicts on the equations all along a path, and on the mesh at its ends."""

from collections.abc import Iterator

from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.assessment.penetration import Misfit
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.report.bars import error_percent
from bemcontact.report.formatting import number, sentence_case
from bemcontact.report.verdicts import Verdict, mesh_verdict, quality_of_misfit

MOVED_AWAY = (Misfit.OFF, Misfit.MOVED)
"""What may be wrong with a state of a path because the body moves far up to its end."""


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
        proved = f"Each state from {first} to {last} is proved to be the only contact state. {exact}"
        return proved
    notes = (f"{sentence_case(note)}." for note in path.notes)
    deepest = () if path.penetration is None else (path.penetration.words,)
    where = () if path.penetrates_at is None else (f"This is at {path.key} = {number(path.penetrates_at)}.",)
    if path.penetrates_at != path.reaches[1] and path.penetration and path.penetration.kind in MOVED_AWAY:
        where += ("A path has the gaps and normals of its end; a study has those of each value.",)
    return " ".join((*deepest, *where, *notes, exact))
