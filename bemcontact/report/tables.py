"""Tables and lists of facts in the terminal; text of a user goes into them as plain text, never as markup."""

from rich.table import Table
from rich.text import Text

RIGHT = frozenset({
    "length", "elements", "points", "objective", "unpolished", "difference", "iterations", "seconds", "computed",
    "expected", "allowed", "in contact",
})  # fmt: skip
"""Columns of numbers."""


def list_of_facts() -> Table:
    """Make a list of facts: name and value."""
    facts = Table.grid(padding=(0, 2))
    facts.add_column(no_wrap=True)
    facts.add_column(overflow="fold", max_width=76)
    return facts


def add(facts: Table, name: str, value: str) -> None:
    """Add a fact to a list."""
    facts.add_row(Text(name, "cyan"), Text(value))


def table_of(*columns: str, right: frozenset[str] = RIGHT) -> Table:
    """Make a table with these columns, those of numbers at the right."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan", pad_edge=False)
    for column in columns:
        numbers = column in right
        table.add_column(column, justify="right" if numbers else "left", no_wrap=numbers, overflow="fold")
    return table
