"""Folders of results, paths, designs, studies and reproductions; a folder is written completely or not at all."""

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

from bemcontact.adaptivity.mesh_sizes import first_mesh
from bemcontact.analysis.case_comparisons import CaseComparisons
from bemcontact.analysis.load_cases import CaseResults
from bemcontact.analysis.mesh_study import MeshStudy
from bemcontact.analysis.reproduction import Reproduction
from bemcontact.analysis.result import Result
from bemcontact.analysis.variation import Variation
from bemcontact.files import output
from bemcontact.modelling.gap_design.designed_gap import GapDesign
from bemcontact.modelling.gap_design.relief import Relief
from bemcontact.options import StressMeasure
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.problems import Problem
from bemcontact.report import design_page, figures, page, path_page, result_page, study_page
from bemcontact.report import reproduction as paper_page
from bemcontact.report.folder_kinds import (
    DESIGN,
    PATH,
    PICTURES,
    REPORT,
    REPRODUCTION,
    RESULT,
    STUDY,
    Contents,
    ensure_folder_writable,
)
from bemcontact.report.zones import tables_of
from bemcontact.studies.journal import JOURNAL
from bemcontact.studies.table import StudyTable


def save(study: MeshStudy, folder: Path, spec: str | None = None) -> None:
    """Write a mesh study as a folder: page, numbers, pictures, condensed problem of the finest mesh, spec if given."""
    ensure_folder_writable(folder)
    pictures = figures.vector_graphics(figures.figures_of(study))
    text = page.render(study.to_dict(), pictures, spec)
    contact = study.finest.comparison.contact
    others = {"spec.yaml": spec}
    _write(folder, REPORT, text, study.to_json(), pictures, others, lambda into: contact.save(into / "contact.npz"))


def save_result(
    results: Result | CaseResults,
    folder: Path,
    spec: str | None = None,
    stress: StressMeasure = StressMeasure.VON_MISES,
) -> None:
    """Write a result, or those of all load cases, as a folder: page, numbers, tables, pictures, spec if given."""
    ensure_folder_writable(folder, RESULT)
    pictures = figures.vector_graphics(figures.pictures_of(results, stress))
    text = result_page.render(results, pictures, spec, stress=stress)
    _write(folder, RESULT, text, results.to_json(), pictures, {**tables_of(results), "spec.yaml": spec})


def save_cases(comparisons: CaseComparisons, folder: Path, spec: str | None = None) -> None:
    """Write comparisons under all load cases as a folder: page, numbers, tables, pictures, spec if given."""
    ensure_folder_writable(folder)
    answers = comparisons.answers
    pictures = figures.vector_graphics(figures.pictures_of(answers))
    text = result_page.render(answers, pictures, spec, comparisons)
    _write(folder, REPORT, text, comparisons.to_json(), pictures, {**tables_of(answers), "spec.yaml": spec})


def save_reproduction(reproduction: Reproduction, folder: Path) -> None:
    """Write the problems of the paper as a folder: page, numbers, pictures."""
    ensure_folder_writable(folder, REPRODUCTION)
    pictures = figures.vector_graphics(figures.figures_of_reproduction(reproduction))
    text = paper_page.render(reproduction.to_dict(), pictures)
    _write(folder, REPRODUCTION, text, reproduction.to_json(), pictures)


def save_path(
    path: ParameterPath,
    folder: Path,
    problem: Problem | None = None,
    spec: str | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> None:
    """Write a load path as a folder: page, table, numbers, pictures, spec if given.

    The page describes the problem if it is given; it is drawn with the value at the end of the path. `progress` is
    called with the number of frames of the animation that are drawn, and that of all.
    """
    ensure_folder_writable(folder, PATH)
    drawn = problem
    if problem is not None:
        drawn = Variation(first_mesh(problem) if problem.adapts else problem, path.key).at(path.end)
    pictures = figures.vector_graphics(figures.figures_of_path(path, drawn))
    if figures.can_be_animated(path):
        pictures["animation"] = figures.animated_graphic(figures.draw_animation(path, progress))
        pictures["states"] = figures.vector_graphic(figures.figure_of_states(figures.states_on(path)))
    text = path_page.render(path, pictures, problem, spec)
    _write(folder, PATH, text, path.to_json(), pictures, {"path.csv": path.to_csv(), "spec.yaml": spec})


def save_design(design: GapDesign, folder: Path, relief: Relief | None = None) -> None:
    """Write a designed gap as a folder: page, table, numbers, pictures; the page has the bounds if they are given."""
    ensure_folder_writable(folder, DESIGN)
    pictures = figures.vector_graphics(figures.figures_of_design(design))
    text = design_page.render(design, pictures, relief)
    _write(folder, DESIGN, text, design.to_json(), pictures, {"design.csv": design_page.design_csv(design)})


def save_study(study: StudyTable, folder: Path, spec: str | None = None) -> None:
    """Write a study of parameters as a folder: page, tables, pictures, the journal that is there, and spec if given."""
    ensure_folder_writable(folder, STUDY)
    pictures = figures.vector_graphics(figures.figures_of_study(study))
    text = study_page.render(study, pictures, spec)
    numbered = {f"{number:02d}": picture for number, picture in enumerate(pictures.values(), 1)}

    def more(temporary: Path) -> None:
        study.save_parquet(temporary / "study.parquet")
        if (folder / JOURNAL).is_file():
            shutil.copyfile(folder / JOURNAL, temporary / JOURNAL)

    _write(folder, STUDY, text, study.to_json(), numbered, {"study.csv": study.to_csv(), "spec.yaml": spec}, more)


def _write(
    folder: Path,
    contents: Contents,
    page: str,
    numbers: str,
    pictures: Mapping[str, bytes],
    others: Mapping[str, str | None] | None = None,
    more: Callable[[Path], object] | None = None,
) -> None:
    """Write page, numbers, pictures and other texts; `more` writes into the temporary folder what is no text."""
    texts = {contents.page: page, contents.numbers: f"{numbers}\n", **(others or {})}
    with output.whole_folder(folder) as temporary:
        if pictures:
            (temporary / PICTURES).mkdir()
        for name, picture in pictures.items():
            (temporary / PICTURES / f"{name}.svg").write_bytes(picture)
        for name, text in texts.items():
            if text is not None:
                (temporary / name).write_text(text, encoding="utf-8", newline="\n")
        if more is not None:
            more(temporary)
        ensure_folder_writable(folder, contents)
