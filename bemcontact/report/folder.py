"""Folders of results, paths, designs, studies and reproductions; a folder is written completely or not at all."""

import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
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
    with _written(folder, REPORT, text, study.to_json(), pictures) as temporary:
        study.finest.comparison.contact.save(temporary / "contact.npz")
        if spec is not None:
            (temporary / "spec.yaml").write_text(spec, encoding="utf-8", newline="\n")


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
    with _written(folder, RESULT, text, results.to_json(), pictures) as temporary:
        _write_tables(results, temporary, spec)


def save_cases(comparisons: CaseComparisons, folder: Path, spec: str | None = None) -> None:
    """Write comparisons under all load cases as a folder: page, numbers, tables, pictures, spec if given."""
    ensure_folder_writable(folder)
    answers = comparisons.answers
    pictures = figures.vector_graphics(figures.pictures_of(answers))
    text = result_page.render(answers, pictures, spec, comparisons)
    with _written(folder, REPORT, text, comparisons.to_json(), pictures) as temporary:
        _write_tables(answers, temporary, spec)


def _write_tables(results: Result | CaseResults, folder: Path, spec: str | None) -> None:
    """Write the tables of results, and the spec if given."""
    tables = tables_of(results) if spec is None else {**tables_of(results), "spec.yaml": spec}
    for name, content in tables.items():
        (folder / name).write_text(content, encoding="utf-8", newline="\n")


def save_reproduction(reproduction: Reproduction, folder: Path) -> None:
    """Write the problems of the paper as a folder: page, numbers, pictures."""
    ensure_folder_writable(folder, REPRODUCTION)
    pictures = figures.vector_graphics(figures.figures_of_reproduction(reproduction))
    text = paper_page.render(reproduction.to_dict(), pictures)
    with _written(folder, REPRODUCTION, text, reproduction.to_json(), pictures):
        pass


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
    drawn = None if problem is None else Variation(_on_some_mesh(problem), path.key).at(path.end)
    pictures = figures.vector_graphics(figures.figures_of_path(path, drawn))
    if figures.can_be_animated(path):
        pictures["animation"] = figures.animated_graphic(figures.draw_animation(path, progress))
        pictures["states"] = figures.vector_graphic(figures.figure_of_states(figures.states_on(path)))
    text = path_page.render(path, pictures, problem, spec)
    with _written(folder, PATH, text, path.to_json(), pictures) as temporary:
        (temporary / "path.csv").write_text(path.to_csv(), encoding="utf-8", newline="\n")
        if spec is not None:
            (temporary / "spec.yaml").write_text(spec, encoding="utf-8", newline="\n")


def _on_some_mesh(problem: Problem) -> Problem:
    """The problem on its stated mesh, or on the first one of a search, to be drawn."""
    return first_mesh(problem) if problem.adapts else problem


def save_design(design: GapDesign, folder: Path, relief: Relief | None = None) -> None:
    """Write a designed gap as a folder: page, table, numbers, pictures; the page has the bounds if they are given."""
    ensure_folder_writable(folder, DESIGN)
    pictures = figures.vector_graphics(figures.figures_of_design(design))
    text = design_page.render(design, pictures, relief)
    with _written(folder, DESIGN, text, design.to_json(), pictures) as temporary:
        (temporary / "design.csv").write_text(design_page.design_csv(design), encoding="utf-8", newline="\n")


def save_study(study: StudyTable, folder: Path, spec: str | None = None) -> None:
    """Write a study of parameters as a folder: page, tables, pictures, the journal that is there, and spec if given."""
    ensure_folder_writable(folder, STUDY)
    pictures = figures.vector_graphics(figures.figures_of_study(study))
    text = study_page.render(study, pictures, spec)
    numbered = {f"{number:02d}": picture for number, picture in enumerate(pictures.values(), 1)}
    with _written(folder, STUDY, text, study.to_json(), numbered) as temporary:
        (temporary / "study.csv").write_text(study.to_csv(), encoding="utf-8", newline="\n")
        study.save_parquet(temporary / "study.parquet")
        if spec is not None:
            (temporary / "spec.yaml").write_text(spec, encoding="utf-8", newline="\n")
        if (folder / JOURNAL).is_file():
            shutil.copyfile(folder / JOURNAL, temporary / JOURNAL)


@contextmanager
def _written(
    folder: Path, contents: Contents, text: str, numbers: str, pictures: Mapping[str, bytes]
) -> Iterator[Path]:
    """Write page, numbers and pictures into a temporary folder; yield it for further files."""
    with output.whole_folder(folder) as temporary:
        if pictures:
            (temporary / PICTURES).mkdir()
        for name, picture in pictures.items():
            (temporary / PICTURES / f"{name}.svg").write_bytes(picture)
        (temporary / contents.numbers).write_text(f"{numbers}\n", encoding="utf-8", newline="\n")
        (temporary / contents.page).write_text(text, encoding="utf-8", newline="\n")
        yield temporary
        ensure_folder_writable(folder, contents)
