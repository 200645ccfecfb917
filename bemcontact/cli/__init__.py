"""The command line: arguments, progress, exit status, nothing more.

The numerical half of the package is imported inside the commands, so that ``bemcontact --help`` answers at once.
"""

import logging
import signal
import sys
from importlib.metadata import PackageNotFoundError, version
from io import TextIOWrapper
from typing import Annotated

import typer

from bemcontact.cli import check, compare, path, reproduce, solve, study
from bemcontact.cli.command import MeaningCommand, MeaningGroup, flattened, help_of, refuse, reported
from bemcontact.cli.terminal import standard_output
from bemcontact.errors import LINE_BREAKS, escaped, hidden_character

app = typer.Typer(
    cls=MeaningGroup,
    add_completion=False,
    invoke_without_command=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,  # plain help, which breaks lines between words only
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)


def main() -> None:
    """Run the command line; the entry point of the ``bemcontact`` program."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it warns if it cannot keep its caches
    if hasattr(signal, "SIGPIPE"):  # a pipe that its reader closes ends the program, as it ends other programs
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a letter that the terminal lacks becomes a question mark
    try:
        with reported(), standard_output():
            _refuse_hidden_characters(sys.argv[1:])
            app()
    except typer.Exit as end:
        sys.exit(end.exit_code)
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # all is written and said, and the status is known


def _refuse_hidden_characters(arguments: list[str]) -> None:
    """Refuse arguments that the messages of the parser would print with hidden characters."""
    for argument in arguments:
        if hidden := hidden_character(argument, LINE_BREAKS):
            refuse(f"the argument '{escaped(argument)}' contains the hidden character {hidden}; remove or rename it")


def _show_version(wanted: bool) -> None:
    if wanted:
        try:
            typer.echo(f"bemcontact {version('bemcontact')}")
        except PackageNotFoundError:
            typer.echo("bemcontact, running from a source tree that is not installed")
        raise typer.Exit()


def bemcontact(
    context: typer.Context,
    show_version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Frictionless contact of elastic bodies and rigid surfaces: plane boundary elements, quadratic programming.

    Write the problem as a YAML file (see models/), check it with check, and solve it with solve.

    Exit status: 0 certified, and the accuracy asked is met (1 % by default); 1 not certified, or the accuracy
    is not met; 2 bad input.

    Examples
      bemcontact check models/cylinder_on_plane.yaml --figure problem.png
      bemcontact solve models/cylinder_on_plane.yaml --figure contact.png
    """
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


app.callback(help=help_of(bemcontact))(bemcontact)
for function in (
    check.check,
    solve.solve,
    compare.compare,
    path.path,
    study.study,
    reproduce.reproduce,
    check.condense,
    check.schema,
):
    app.command(cls=MeaningCommand, help=help_of(function), context_settings={"allow_extra_args": True})(
        flattened(function)
    )
