"""Arguments and options that several commands take."""

from pathlib import Path
from typing import Annotated

import typer

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
