"""Tables and lists of facts for the terminal; all text of a user is plain text, never markup."""

from rich.table import Table
from rich.text import Text

RIGHT = frozenset({
    "length", "elements", "points", "objective", "unpolished", "off direct", "iterations", "seconds", "found",
    "expected", "difference", "allowed", "in contact",
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


def add_verdict(facts: Table, word: str, good: bool, words: str) -> None:
    """Add the verdict to a list: in a word, and in sentences."""
    facts.add_row(Text("Verdict", "bold"), verdict_text(word, good, words))


def verdict_text(word: str, good: bool, words: str) -> Text:
    """Write a verdict: green if it is good, else red."""
    return Text.assemble((word, "bold green" if good else "bold red"), ". ", words)


def table_of(*columns: str, right: frozenset[str] = RIGHT) -> Table:
    """Make a table with these columns, those of numbers at the right."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="cyan", pad_edge=False)
    for column in columns:
        numbers = column in right
        table.add_column(column, justify="right" if numbers else "left", no_wrap=numbers, overflow="fold")
    return table
