"""Texts on the members of a study, where a long text that many members have is stated once."""

import re
from collections import defaultdict
from collections.abc import Sequence

SHORT = 60
"""Letters up to which a text stays in the row of each member."""
MEASURED = re.compile(r"(?<![\w.])-?\d+(?:(?:\.\d+)?e[-+]?\d+|\.\d+|(?= %))(?!\w|\.\d)")
"""A number that differs from member to member: with a point or an exponent, or in per cent."""


def stated_once(members: Sequence[Sequence[str]]) -> tuple[list[tuple[list[str], list[int]]], list[tuple[str, int]]]:
    """For each member its own texts, and the numbers of the shared ones, from 1 on; then these, each with its count.

    Texts that differ in measured numbers alone are one, which has the smallest and the largest of each number.
    """
    alike = defaultdict[str, list[str]](list)
    for texts in members:
        for text in texts:
            alike[MEASURED.sub("", text)].append(text)
    shared = {shape: texts for shape, texts in alike.items() if len(texts) > 1 and len(texts[0]) > SHORT}
    numbers = {shape: number for number, shape in enumerate(shared, 1)}
    rows = [
        (
            [text for text in texts if MEASURED.sub("", text) not in numbers],
            [numbers[shape] for text in texts if (shape := MEASURED.sub("", text)) in numbers],
        )
        for texts in members
    ]
    return rows, [(_together(texts), len(texts)) for texts in shared.values()]


def _together(texts: Sequence[str]) -> str:
    """Texts that differ in numbers alone, as one."""
    values = zip(*map(MEASURED.findall, texts), strict=True)
    ranges = iter([_range(min(each, key=float), max(each, key=float)) for each in values])
    return MEASURED.sub(lambda _: next(ranges), texts[0])


def _range(low: str, high: str) -> str:
    """A number, or from which to which it is."""
    return low if low == high else f"{low} to {high}"
