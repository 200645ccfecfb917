"""Kinds of folders, and whether one may be written; nothing is drawn, so that a command checks its folder at once."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

from bemcontact.files import output
from bemcontact.frozen import frozen_value
from bemcontact.studies.journal import JOURNAL, is_journal

PICTURES = "figures"
"""Name of the folder of pictures."""
OF_RESULTS = ("zones.csv", "intervals.csv", "points.csv", "stress.csv", "largest_stresses.csv", "spec.yaml")
"""Tables and spec in folders of results."""


@frozen_value
class Contents:
    """Files of a kind of folder: title, names of page, JSON numbers, others and pictures, and keys of the numbers."""

    title: str
    page: str
    numbers: str
    others: tuple[str, ...] = ()
    picture: re.Pattern[str]
    keys: frozenset[str]
    journal: str = ""
    """Name of a journal, which is there before the numbers."""


REPORT = Contents(
    title="report",
    page="report.html",
    numbers="report.json",
    others=("contact.npz", *OF_RESULTS),
    picture=re.compile(
        r"(problem|contacts|(pressure|gap)(-\d+)?|deformed|difference|convergence|history-[a-z0-9-]+)\.svg"
    ),
    keys=frozenset({"settings", "versions"}),
)
"""Folder of a mesh study, or of the comparisons under all load cases."""
RESULT = Contents(
    title="result",
    page="result.html",
    numbers="result.json",
    others=OF_RESULTS,
    picture=re.compile(r"(problem|contacts|deformed|(contact|pressure|gap)(-\d+)?)\.svg"),
    keys=frozenset({"name", "version", "certified"}),
)
"""Folder of a result, or of all load cases."""
REPRODUCTION = Contents(
    title="reproduction",
    page="page.html",
    numbers="numbers.json",
    picture=re.compile(r"[a-z-]+-(problem|pressure)\.svg"),
    keys=frozenset({"reproduced", "refine", "problems", "versions"}),
)
"""Folder of the problems of the paper."""
PATH = Contents(
    title="path",
    page="path.html",
    numbers="path.json",
    others=("path.csv", "spec.yaml"),
    picture=re.compile(r"(problem|animation|states|peak|force|moment|pressure|contact-\d+)\.svg"),
    keys=frozenset({"key", "start", "end", "states"}),
)
"""Folder of a load path."""
DESIGN = Contents(
    title="design",
    page="design.html",
    numbers="design.json",
    others=("design.csv",),
    picture=re.compile(r"(pressure|profile)\.svg"),
    keys=frozenset({"goal", "zone", "profile", "before", "after"}),
)
"""Folder of a designed gap."""
STUDY = Contents(
    title="study",
    page="study.html",
    numbers="study.json",
    others=("study.csv", "study.parquet", "spec.yaml", JOURNAL),
    picture=re.compile(r"\d+\.svg"),
    keys=frozenset({"axes", "columns", "rows"}),
    journal=JOURNAL,
)
"""Folder of a study of parameters."""
KINDS = {kind.title: kind for kind in (REPORT, RESULT, REPRODUCTION, PATH, DESIGN, STUDY)}
"""Title -> kind of folder."""


def ensure_folder_writable(folder: Path, contents: Contents = REPORT) -> None:
    """Check that a folder is new, empty, or holds only an earlier output of the same kind, which is replaced.

    `OSError` with the reason if not.
    """
    output.ensure_folder_place(folder)
    present = [*folder.iterdir()] if folder.is_dir() else []
    foreign = [*_foreign(folder, contents)]
    if foreign:
        raise FileExistsError(
            f"{folder} holds {foreign[0]}, which is not part of a {contents.title}; name a new or an empty folder"
        )
    begun = bool(contents.journal) and is_journal(folder / contents.journal)
    if present and not begun and not _is_ours(folder / contents.numbers, contents):
        raise FileExistsError(
            f"{folder} is not empty and has no {contents.numbers} of bemcontact; name a new folder, or one with an "
            f"earlier {contents.title}"
        )


def _foreign(folder: Path, contents: Contents) -> Iterator[Path]:
    """List what does not belong into a folder of a kind."""
    if not folder.is_dir():
        return
    for path in sorted(folder.iterdir()):
        if path.name == PICTURES and path.is_dir():
            yield from (
                picture
                for picture in sorted(path.iterdir())
                if not (contents.picture.fullmatch(picture.name) and picture.is_file())
            )
        elif path.name not in (contents.page, contents.numbers, *contents.others) or not path.is_file():
            yield path


def _is_ours(path: Path, contents: Contents) -> bool:
    """Whether a file holds the numbers of a folder of this kind."""
    try:
        numbers = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(numbers, dict) and numbers.keys() >= contents.keys
