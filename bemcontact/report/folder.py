"""The folder that a study is written to: page, numbers, pictures, matrices and spec, all of them or none."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

from bemcontact import output
from bemcontact.report.figures import figures_of, vector_graphic
from bemcontact.report.page import render
from bemcontact.study import Study

PAGE, NUMBERS, PICTURES, MATRICES, SPEC = "report.html", "report.json", "figures", "contact.npz", "spec.yaml"
"""What stands in a folder."""
PICTURE = re.compile(r"(problem|pressure|gap|deformed|difference|convergence|history-[a-z0-9-]+)\.svg")
"""What the pictures are called, as of `figures_of`."""
OURS = {"settings", "levels", "convergence", "versions"}
"""Keys by which our report.json is known."""


def ensure_folder_writable(folder: Path) -> None:
    """Find out, before any work is done, whether `save` will be able to write here without loss of foreign files.

    Parameters
    ----------
    folder : that does not exist, is empty, or holds a report and nothing else, which will be replaced

    Raises
    ------
    OSError
        With a sentence that says why not, and what to do.
    """
    output.ensure_folder_place(folder)
    present = [*folder.iterdir()] if folder.is_dir() else []
    foreign = [*_foreign(folder)]
    if foreign:
        raise FileExistsError(
            f"{folder} holds {foreign[0]}, which no report of ours has; name a new folder, or an empty one"
        )
    if present and not _is_report(folder / NUMBERS):
        raise FileExistsError(
            f"{folder} is not empty and has no {NUMBERS} of ours; name a new folder, or one with an earlier report"
        )


def save(study: Study, folder: Path, spec: str | None = None) -> None:
    """Write a study.

    Parameters
    ----------
    study : on one mesh or several
    folder : that appears, or is replaced, as a whole: report.html, report.json, figures/*.svg, contact.npz (condensed
        problem on the finest mesh) and, if it is given, spec.yaml
    spec : text of the spec as run

    Raises
    ------
    OSError
        As of `ensure_folder_writable`; nothing is changed then.
    """
    ensure_folder_writable(folder)
    pictures = {name: vector_graphic(figure) for name, figure in figures_of(study).items()}
    page = render(study.to_dict(), pictures, spec)
    with output.whole_folder(folder) as temporary:
        (temporary / PICTURES).mkdir()
        for name, picture in pictures.items():
            (temporary / PICTURES / f"{name}.svg").write_bytes(picture)
        study.finest.comparison.contact.save(temporary / MATRICES)
        if spec is not None:
            (temporary / SPEC).write_text(spec, encoding="utf-8", newline="\n")
        (temporary / NUMBERS).write_text(f"{study.to_json()}\n", encoding="utf-8", newline="\n")
        (temporary / PAGE).write_text(page, encoding="utf-8", newline="\n")
        ensure_folder_writable(folder)


def _foreign(folder: Path) -> Iterator[Path]:
    """Name what a report has not."""
    if not folder.is_dir():
        return
    for path in sorted(folder.iterdir()):
        if path.name == PICTURES and path.is_dir():
            yield from (
                picture
                for picture in sorted(path.iterdir())
                if not (PICTURE.fullmatch(picture.name) and picture.is_file())
            )
        elif path.name not in (PAGE, NUMBERS, MATRICES, SPEC) or not path.is_file():
            yield path


def _is_report(path: Path) -> bool:
    """Whether a file is a report.json that `save` wrote."""
    try:
        report = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(report, dict) and report.keys() >= OURS
