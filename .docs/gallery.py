"""Write models/README.md and the pictures in .docs/pictures: every shipped problem, and how far off its answer is.

    python .docs/gallery.py

Solves all problems anew, and writes the same errors into the tables of the pages in `TABLES`. A second run changes
nothing.
"""

import os
import re
from collections.abc import Iterable, Iterator
from functools import cache, partial
from pathlib import Path

for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(threads, "1")  # the same rounding on each run; before the first import of NumPy

from matplotlib.axes import Axes  # noqa: E402
from matplotlib.patches import Rectangle  # noqa: E402

import bemcontact  # noqa: E402
from bemcontact import Result  # noqa: E402
from bemcontact.reference import Score, expected, score  # noqa: E402
from bemcontact.report import figures  # noqa: E402
from bemcontact.report.figures.page import new_page  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
PICTURES = Path(".docs", "pictures")
PAGE = Path("models", "README.md")
TABLES = (Path("README.md"), Path(".docs", "validation", "closed_forms.md"))
"""Pages with tables of errors that are written by hand, but for their numbers."""
CASES = {"eccentric_punch": "beyond half", "roller_in_v_block": "down and aside"}
"""The load case in the picture, where it is not the first one."""
FOLDERS = {
    "models": "Problems of the paper, and the flat slit beside the crack",
    "models/gallery": "Problems with closed forms and statics",
    "models/bodies": "Problems of several elastic bodies",
}
"""Folders of problems, with the headings of their tables."""
SMALL = 0.08
"""Extent of the only contact over that of the body below which a close-up is drawn."""
README = ("cylinder_on_plane", "bolt_in_plate")
"""The picture at the beginning of the README."""
ROUND_OFF = 1e-6
"""Relative error below which it differs from machine to machine."""

HEAD = """\
# Gallery

<!-- Written by `python .docs/gallery.py`. -->

Each file here states one problem, mostly with a known answer. This command solves one and draws it:

```sh
bemcontact solve models/cylinder_on_plane.yaml --figure contact.svg
```

- Pale: the bodies, with displacements to scale. Grey: hatched rigid surfaces. Dashed lines show the undeformed bodies.
  Where the contact is small, only the part of the body around it is drawn. Of several bodies and surfaces each has its
  name where there is room, a surface that of its contact zone.
- Blue: supports. A model of a half or a quarter has rollers on its planes of symmetry.
- Green: loads on the boundary, and the direction of weight.
- Orange: the contact pressure, with its largest value in each contact, or of many contacts in one. At the edge of a
  punch and at a corner that presses on a surface, the largest value depends on the mesh. There the picture cuts the
  pressure off at three times its mean.

No file states a mesh. The errors are those of the default formulation on the mesh that is found for 1 %, or for the
accuracy that the file asks for. Each error is the largest over all load cases.
An error of a pressure is relative to the peak of the reference. An error of a mean square is relative to the mean
square of the reference, an error of an end of contact to the extent of contact, and every other error to its own
quantity. *Round-off* is an error below 0.0001 %. `bemcontact compare` checks each error against the tolerance in the
file.
"""


def models() -> list[Path]:
    """All problems, those of the paper first."""
    return [path for folder in FOLDERS for path in sorted((ROOT / folder).glob("*.yaml"))]


def page() -> str:
    """Write the gallery."""
    text = HEAD
    for folder, title in FOLDERS.items():
        rows = _table(path for path in models() if path.parent == ROOT / folder)
        text += "\n".join(["", f"## {title}", "", *rows, ""])
    return text


@cache
def results(path: Path) -> dict[str | None, Result]:
    """Results of a problem under each load case, on one mesh; under None without cases."""
    problem = bemcontact.load(path)
    return dict(bemcontact.solve_cases(problem).results) if problem.case_names else {None: bemcontact.solve(problem)}


def _table(paths: Iterable[Path]) -> Iterator[str]:
    """One row a problem."""
    yield "| picture | problem | closed form or source: measured error |"
    yield "|---|---|---|"
    for path in paths:
        problem = bemcontact.load(path)
        picture, file = ROOT / PICTURES / f"{path.stem}.svg", path.relative_to(ROOT / PAGE.parent)
        errors = _errors(results(path).values()) if problem.reference else ()
        shown = f" The picture shows the load case '{_case(path)}'." if problem.case_names else ""
        yield (
            f'| <img src="../{picture.relative_to(ROOT).as_posix()}" width="320" alt="{problem.name}"> '
            f"| [{problem.name}]({file.as_posix()}): {_first_sentence(problem.description)}{shown} "
            f"| {'<br>'.join(errors)} |"
        )


def _first_sentence(description: str) -> str:
    """The first sentence of a description, without what is in parentheses."""
    text = re.sub(r" \([^)]*\)", "", " ".join(description.split()))
    return re.split(r"(?<=[.:]) (?=[A-Z])", text)[0]


def _case(path: Path) -> str | None:
    return CASES.get(path.stem, next(iter(results(path))))


def _errors(answers: Iterable[Result]) -> Iterator[str]:
    """For each source the largest error of each quantity over all load cases and references, in percent."""
    names, errors = dict[str, dict[str, None]](), dict[str, dict[str, float]]()
    for result in answers:
        for item in expected(result.problem, result.contact):
            names.setdefault(item.source, {})[item.name] = None
        for source, quantity, error, _ in _judged(result):
            quantities = errors.setdefault(source, {})
            quantities[quantity] = max(quantities.get(quantity, 0.0), error)
    for source, named in names.items():
        name = next(iter(named))
        title = source if len(named) > 1 or name.lower() in source.lower() else f"{name}, {source}"
        told = (f"{quantity} {_percent(error)}" for quantity, error in errors.get(source, {}).items())
        yield f"{title}: {', '.join(told) or 'this problem is out of its range'}"


def _judged(result: Result) -> Iterator[tuple[str, str, float, Score]]:
    """Source, quantity, error and score of each quantity by which a result is judged."""
    known = expected(result.problem, result.contact)
    sources = {item.name: item.source for item in known}
    for item in score(known, result.contact, result.footprint, result.solution.pressure):
        if item.judged and item.difference is not None:
            quantity = _QUANTITIES.get(item.quantity, item.quantity)
            yield sources[item.reference], quantity, abs(item.difference), item


_QUANTITIES = {"pressure (largest difference)": "pressure", "pressure (mean square)": "pressure in the mean square"}


def _percent(error: float) -> str:
    """A relative error with two figures."""
    return f"{100 * error:.2g} %" if error > ROUND_OFF else "round-off"


def filled(text: str) -> str:
    """Write the errors of today into each row of a table that names a model, or stands below one that does."""
    lines, model = [], None
    for line in text.splitlines():
        named = re.search(r"^\| `(\w+)` \||compare models/gallery/(\w+)\.yaml`", line)
        model = named[1] or named[2] if named else model if line.startswith("| |") else None
        lines.append(_MEASURED.sub(partial(_measured, model), line) if model else line)
    return "\n".join(lines) + "\n"


_MEASURED = re.compile(r"\b([a-z][a-z -]*?)(?: |( \| ))(?:\d[\d.e-]* %|round-off)(?(2) \| [^|]* \|$)")
"""A quantity with its error, in one cell of a table, or in two cells with the tolerance in a third one."""


def _measured(model: str, found: re.Match[str]) -> str:
    """Give a quantity with its largest error over all load cases and references, and the tolerance of that one."""
    quantity, own_cell = found[1], found[2]
    answers = results(ROOT / "models" / "gallery" / f"{model}.yaml").values()
    scores = [
        (error, item.tolerance) for answer in answers for _, key, error, item in _judged(answer) if key == quantity
    ]
    if not scores:
        raise ValueError(f"{model} has no error of {quantity}")
    error, tolerance = max(scores)
    allowed = f"{100 * tolerance:g} %" if tolerance > ROUND_OFF else f"{tolerance:.0e}".replace("e-0", "e-")
    return f"{quantity} | {_percent(error)} | {allowed} |" if own_cell else f"{quantity} {_percent(error)}"


def pictures() -> Iterator[tuple[Path, bytes]]:
    """Draw each problem, and two of them side by side for the README."""
    readme = new_page(8.3, 3.0)
    for axes, name in zip(readme.subplots(1, 2, width_ratios=(1, 2.2)), README, strict=True):
        path = ROOT / "models" / f"{name}.yaml"
        _draw(axes, path)
        axes.set_title(results(path)[None].contact.name, fontsize=10)
    yield PICTURES / "contact.svg", figures.vector_graphic(readme)
    for path in models():
        figure = new_page(4.2, 3.0)
        figure.add_artist(Rectangle((0, 0.5), 1, 0, facecolor="none", edgecolor="none"))  # all are equally wide
        _draw(figure.add_subplot(), path)
        yield PICTURES / f"{path.stem}.svg", figures.vector_graphic(figure)


def _draw(axes: Axes, path: Path) -> None:
    """Draw the contact of a problem."""
    axes.set_axis_off()
    result = results(path)[_case(path)]
    alone = len(result.contact.zone_names) == 1
    figures.draw_contact(axes, result, next(iter(figures.close_ups(result, SMALL)), None) if alone else None)


def main() -> None:
    """Write all files."""
    (ROOT / PICTURES).mkdir(exist_ok=True)
    for path, picture in pictures():
        (ROOT / path).write_bytes(picture)
    (ROOT / PAGE).write_text(page(), encoding="utf-8")
    for table in TABLES:
        (ROOT / table).write_text(filled((ROOT / table).read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
