"""Arguments and options that several commands take."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, TypeVar

import typer

from bemcontact.errors import OptionError

Number = TypeVar("Number", int, float)

SpecArgument = Annotated[Path, typer.Argument(metavar="SPEC", help="Problem to read, a YAML file.", show_default=False)]
RefineOption = Annotated[int, typer.Option(min=1, metavar="K", help="Split each element into K equal parts.")]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY.PATH=VALUE",
        help="Replace one value of the spec before it is checked; repeatable.",
        show_default=False,
    ),
]
VariantOption = Annotated[
    str | None,
    typer.Option(
        "--variant",
        metavar="NAME",
        help="Take a variant of the spec; check lists them. --set comes on top.",
        show_default=False,
    ),
]
CaseOption = Annotated[
    str | None,
    typer.Option(
        "--case",
        metavar="NAME",
        help="Let one load case or combination of the spec act; check lists them.",
        show_default=False,
    ),
]
FitOption = Annotated[
    bool, typer.Option("--fit-edges", help="Grade the contact zones towards the ends of contact, once they are found.")
]
FigureOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Draw a picture; FILE ends in .png, .svg or .pdf.", show_default=False),
]
JsonOption = Annotated[
    Path | None,
    typer.Option("--json", metavar="FILE", help="Write all results; - for standard output.", show_default=False),
]
STANDARD_OUTPUT = Path("-")
"""The file name that means standard output."""


def with_case(overrides: list[str] | None, case: str | None) -> list[str]:
    """Changes of a spec with the load case that --case names among them."""
    return [*(overrides or ()), *([] if case is None else [f"case={json.dumps(case)}"])]


def names(text: str) -> list[str]:
    """Read names with commas between them, in any case."""
    return [item.strip().lower() for item in text.split(",")]


def several(text: str, option: str, kind: str, read: Callable[[str], Number]) -> list[Number]:
    """Read numbers with commas between them; `OptionError` says of what kind they should be, and which is not."""
    numbers = []
    for item in text.split(","):
        try:
            numbers.append(read(item))
        except ValueError:
            found = f"{option}: expected {kind}s with commas between, found '{item.strip()}'"
            raise OptionError(found) from None
    return numbers
