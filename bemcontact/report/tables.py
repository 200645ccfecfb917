"""Tables and lists of facts for the terminal; all text of a user is plain text, never markup."""

from rich.table import Table
from rich.text import Text

RIGHT = {
    "length", "elements", "points", "objective", "unpolished", "off direct", "iterations", "seconds", "found",
    "expected", "difference",
}  # fmt: skip
"""Columns of numbers."""


def list_of_facts() -> Table:
    """Make a list of facts: what, and how much."""
    facts = Table.grid(padding=(0, 2))
    facts.add_column(no_wrap=True)
    facts.add_column(overflow="fold", max_width=76)
    return facts


def add(facts: Table, what: str, how_much: str) -> None:
    """Add a fact to a list."""
    facts.add_row(Text(what, "cyan"), Text(how_much))


def table_of(*columns: str) -> Table:
    """Make a table with these columns."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan", pad_edge=False)
    for column in columns:
        numbers = column in RIGHT
        table.add_column(column, justify="right" if numbers else "left", no_wrap=numbers, overflow="fold")
    return table
