"""Verdicts on the equations and on the mesh: of results, load cases and mesh studies."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.result import Result
from bemcontact.assessment.penetration import Misfit
from bemcontact.report.bars import bar_in_words, error_percent, worst_bar
from bemcontact.report.formatting import JsonObject, sentence_case

NOT_LOOKED_AT = (
    "Friction, wear, plasticity, dynamics, and everything that is not plane: the model has none of them. Rigid "
    "surfaces do not yield. Whether the input is that of your part: compare the picture of the problem with it."
)
"""What no verdict covers."""


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

    def kind(self, assessed: bool) -> str:
        """Whether it is proved, or estimated from meshes, if errors were assessed."""
        if self.of == "Mesh":
            return "Estimated" if assessed else "Not estimated"
        return "Proved" if self.good else "Not proved"


def overall(verdicts: Sequence[Verdict]) -> str:
    """Quality of an answer: good only if all verdicts are, bad if one is, else fair."""
    qualities = {item.quality for item in verdicts}
    return next(quality for quality in ("bad", "fair", "good") if quality in qualities)


def in_short(verdicts: Sequence[Verdict]) -> str:
    """Verdicts in few words, for a title: ``unique solution proved; error at most 0.4 % (asked 1 %)``."""
    return "; ".join(item.word if item.good else f"{item.of.lower()}: {item.word}" for item in verdicts)


def quality_of_misfit(penetration: JsonObject, solved: bool) -> str:
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
        quality = quality_of_misfit(finest["penetration"], direct)
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
        quality, word = quality_of_misfit(deepest.to_dict(), solved), str(deepest.kind)
    return Verdict("Equations", quality, word, result.words), mesh_verdict(result.accuracy.to_dict())


def case_verdicts(cases: CaseResults) -> tuple[Verdict, Verdict]:
    """Verdicts on the equations and on the mesh under all load cases; sentences on the cases that fall short."""
    pairs = {name: result_verdicts(result) for name, result in cases.results.items()}
    equations, mesh = ({name: pair[i] for name, pair in pairs.items() if not pair[i].good} for i in range(2))
    largest = max(cases.results, key=lambda name: cases.results[name].accuracy.worst)
    shared = (
        f"{pairs[largest][1].words[:-1]}, under {largest}; one mesh serves all load cases, so that they can be compared"
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
    return shortfall_of(result_verdicts(results) if isinstance(results, Result) else case_verdicts(results))


def shortfall_of(verdicts: Iterable[Verdict]) -> str:
    """Sentences of the verdicts that leave something open."""
    return " ".join(f"{item.of}: {item.word}. {item.words}" for item in verdicts if not item.good)
