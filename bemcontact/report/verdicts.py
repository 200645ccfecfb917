"""Verdicts on the equations and on the mesh: of results, load cases, paths and mesh studies."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

from bemcontact.analysis.case_comparisons import CaseComparisons
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.mesh_study import MeshStudy
from bemcontact.analysis.result import Result
from bemcontact.assessment.certificate import HEADINGS, CertificateKind
from bemcontact.assessment.penetration import Misfit
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.report.bars import bar_in_words, error_percent, worst_bar
from bemcontact.report.formatting import JsonObject, number, sentence_case


class Verdict(NamedTuple):
    """A verdict on the equations or on the mesh: its quality (good, fair or bad), in a few words, and in sentences."""

    of: str
    quality: str
    word: str
    words: str

    @property
    def good(self) -> bool:
        """Whether nothing is left open."""
        return self.quality == "good"


def overall(verdicts: Sequence[Verdict]) -> str:
    """Quality of an answer: good only if all verdicts are, bad if one is, else fair."""
    qualities = {item.quality for item in verdicts}
    return next(quality for quality in ("bad", "fair", "good") if quality in qualities)


def in_short(verdicts: Sequence[Verdict]) -> str:
    """Verdicts in few words, for a title: ``unique solution proved; error at most 0.4 % (asked 1 %)``."""
    return "; ".join(item.word if item.good else f"{item.of.lower()}: {item.word}" for item in verdicts)


def _quality(penetration: JsonObject, solved: bool) -> str:
    """Fair if the equations are solved, and only the theory is too rough."""
    return "fair" if solved and not Misfit(penetration["kind"]).serious else "bad"


def mesh_study_verdicts(report: JsonObject, words: str = "") -> tuple[Verdict, Verdict]:
    """Verdicts on the equations and on the finest mesh of a mesh study, from its JSON; `words` replace its own.

    The equations are solved if the direct solution is proved; a formulation that did not find it is a fair result.
    """
    finest = report["levels"][-1]
    compared = finest["comparison"]
    short = [level["refine"] for level in report["levels"][:-1] if not _proved(level)]
    direct = compared["reference"]["certified"]
    quality = "bad" if not direct else "good" if _proved(finest) and not short else "fair"
    if finest["penetration"] is not None:
        quality = _quality(finest["penetration"], direct)
    sentences = [sentence_case(words or report["verdict"])]
    if short:
        meshes = f"coarser mesh{'es' * (len(short) > 1)} (refine {', '.join(map(str, short))})"
        sentences.append(f"On the {meshes} some solutions are not proved.")
    equations = Verdict("Equations", quality, report["heading"], " ".join(sentences))
    return equations, mesh_verdict(finest["accuracy"])


def _proved(level: JsonObject) -> bool:
    """Whether all solutions on a mesh are proved, and the body penetrates no surface."""
    return level["comparison"]["certified"] and level["penetration"] is None


def mesh_verdict(accuracy: JsonObject) -> Verdict:
    """Verdict on the errors of the mesh."""
    asked, reason = accuracy["asked"], accuracy["reason"]
    if accuracy["met"] is None:
        return Verdict("Mesh", "fair", "not assessed", f"{sentence_case(reason)}.")
    largest = worst_bar(accuracy)
    known = largest is not None and largest["bar"] is not None
    error = error_percent(largest["bar"]) if largest is not None and known else "0 %"
    where = "" if largest is None else bar_in_words(largest)
    if accuracy["met"]:
        word = f"error at most {error} (asked {100 * asked:.3g} %)"
        return Verdict(
            "Mesh", "good", word, f"The largest error bar is that of the {where}." if where else "No contact."
        )
    found = f"The largest error bar is that of the {where}"
    if largest is not None and not known:
        error, found = "not known", f"The error of the {where} is not known: {largest['note']}"
    remedy = reason or "leave elements out, or give --accuracy, and a mesh is found"
    word = f"not met, error {'about ' * known}{error} (asked {100 * asked:.3g} %)"
    return Verdict("Mesh", "fair", word, f"{found}. {sentence_case(remedy)}.")


def result_verdicts(result: Result) -> tuple[Verdict, Verdict]:
    """Verdicts on the equations and on the mesh."""
    solved, deepest = result.certificate.certified, result.penetration
    quality, word = "good" if solved else "bad", result.certificate.heading
    if deepest is not None:
        quality, word = _quality(deepest.to_dict(), solved), str(deepest.kind)
    return Verdict("Equations", quality, word, result.words), mesh_verdict(result.accuracy.to_dict())


def case_verdicts(cases: CaseResults) -> tuple[Verdict, Verdict]:
    """Verdicts on the equations and on the mesh under all load cases; sentences on the cases that fall short."""
    pairs = {name: result_verdicts(result) for name, result in cases.results.items()}
    equations, mesh = ({name: pair[i] for name, pair in pairs.items() if not pair[i].good} for i in range(2))
    largest = max(cases.results, key=lambda name: cases.results[name].accuracy.worst)
    shared = (
        f"{pairs[largest][1].words[:-1]}, under {largest}; one mesh serves all load cases, so that they can be added"
    )
    return (
        _together(pairs[largest][0]._replace(words="In every load case."), equations),
        _together(pairs[largest][1]._replace(words=f"{shared}."), mesh),
    )


def _together(every: Verdict, short: Mapping[str, Verdict]) -> Verdict:
    """One verdict for all load cases: that on every one, or those that fall short, the same words once."""
    if not short:
        return every
    worst = next((item for item in short.values() if item.quality == "bad"), next(iter(short.values())))
    names = dict[str, list[str]]()
    for name, item in short.items():
        names.setdefault(item.words, []).append(name)
    return worst._replace(words=" ".join(f"{', '.join(own)}: {words}" for words, own in names.items()))


def shortfall(results: Result | CaseResults) -> str:
    """Why a result, or each load case that falls short, does not hold."""
    return _shortfall(result_verdicts(results) if isinstance(results, Result) else case_verdicts(results))


def mesh_study_shortfall(study: MeshStudy) -> str:
    """Why a comparison does not hold."""
    return _shortfall(mesh_study_verdicts(study.to_dict()))


def case_comparisons_shortfall(comparisons: CaseComparisons) -> str:
    """Why comparisons under load cases do not hold: formulations that fall short, then direct solutions that do."""
    failing = (
        f"{name}: {level.comparison.verdict}" for name, level in comparisons.levels.items() if not level.certified
    )
    return " ".join((*failing, *filter(None, [shortfall(comparisons.answers)])))


def path_shortfall(path: ParameterPath) -> str:
    """Why a path does not hold."""
    return _shortfall(path_verdicts(path))


def _shortfall(verdicts: Iterable[Verdict]) -> str:
    return " ".join(f"{item.of}: {item.word}. {item.words}" for item in verdicts if not item.good)


def path_verdicts(path: ParameterPath) -> Iterator[Verdict]:
    """Verdicts on the equations all along a path, and on the mesh at both ends."""
    beyond, word = path.penetration, HEADINGS[CertificateKind.UNIQUE] if path.certified else "not proved"
    quality = "good" if path.certified else "bad"
    if beyond is not None:
        word, quality = str(beyond.kind), _quality(beyond.to_dict(), path.proved)
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
        "bar of each."
    )


def path_sentence(path: ParameterPath) -> str:
    """Certificate of a path in sentences."""
    first, last = map(number, path.reaches)
    exact = f"The conditions of contact hold to {path.residual:.0e} at each breakpoint (natural residual)."
    notes = (f"{sentence_case(note)}." for note in path.notes)
    if path.certified:
        proved = f"Each state from {first} to {last} is proved to be the only contact state. {exact}"
        return " ".join((proved, *notes))
    deepest = () if path.penetration is None else (path.penetration.words,)
    where = () if path.penetrates_at is None else (f"This is at {path.key} = {number(path.penetrates_at)}.",)
    return " ".join((*deepest, *where, *notes, exact))
