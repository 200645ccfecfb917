"""The table of the paper's problems for the terminal, from `Reproduction.to_dict` alone."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from bemcontact.report.formatting import seconds_in_words, sentence_case
from bemcontact.report.markup import Record
from bemcontact.report.reproduction_page import counts, found_in_words, verdict


def reproduction_summary(record: Record) -> RenderableType:
    """Tell of each problem what the paper says, what is found on each mesh, and whether it is certified and known.

    Parameters
    ----------
    record : what `Reproduction.to_dict` gives

    Returns
    -------
    RenderableType
        For `rich`; no wider than 100 columns.
    """
    parts = list[RenderableType]()
    for item in record["problems"]:
        proved = "certified" if item["certified"] else "NOT certified"
        held = f"{item['held']} of {item['judged']} reference quantities hold"
        good = item["certified"] and item["held"] == item["judged"]
        title = Text.assemble((sentence_case(item["name"]), "bold"), f" ({item['figure']}): ")
        parts += [title.append(f"{proved}, {held}", "green" if good else "red"), _statements(item), ""]
    word, style = ("reproduced", "bold green") if record["reproduced"] else ("NOT reproduced", "bold red")
    took = f"All of it took {seconds_in_words(record['seconds'])}."
    return Group(*parts, _iterations(record), "", Text.assemble((word, style), f". {verdict(record)} {took}"))


def _statements(item: Record) -> Table:
    """What the paper says beside what is found."""
    table = _table("", "the paper", *(run["label"] for run in item["runs"]))
    for row in item["statements"]:
        what = f"{row['what']} [{row['unit']}]" if row["unit"] else row["what"]
        table.add_row(*map(Text, (what, row["said"], *map(found_in_words, row["found"]))))
    return table


def _iterations(record: Record) -> Table:
    """How many iterations each solver took."""
    table = _table("iterations", "mesh", "points", "QP1", "QP2", "QP3", "direct")
    for item in record["problems"]:
        for order, row in enumerate(counts(item)):
            name = "" if order else sentence_case(item["name"])
            table.add_row(*map(Text, (name, row["label"], *row["cells"])), style="bold" if row["printed"] else "")
    return table


def _table(*columns: str) -> Table:
    """A table without lines, the numbers at the right."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan", pad_edge=False)
    for order, column in enumerate(columns):
        table.add_column(column, justify="left" if order < 2 else "right", overflow="fold")
    return table
