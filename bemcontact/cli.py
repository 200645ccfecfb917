"""The command line: arguments, progress, exit status, nothing more.

The numerical half of the package is imported inside the commands, so that ``bemcontact --help`` answers at once.
"""

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, NoReturn

import typer

from bemcontact import output
from bemcontact.choices import Equilibrium, FormulationName, Rows, StartName, Weights
from bemcontact.errors import BemContactError, NotConvexError, OptionError, ProblemError, SpecError
from bemcontact.terminal import busy, show, tell

UNCERTIFIED, BAD_INPUT, INTERRUPTED = 1, 2, 130
STANDARD_OUTPUT = Path("-")

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


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


def main() -> None:
    """Run the command line; the entry point of the ``bemcontact`` program."""
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")  # a terminal that lacks a letter shows a question mark
    app()


def _show_version(wanted: bool) -> None:
    if wanted:
        try:
            typer.echo(f"bemcontact {version('bemcontact')}")
        except PackageNotFoundError:
            typer.echo("bemcontact, running from a source tree that is not installed")
        raise typer.Exit()


@app.callback()
def bemcontact(
    show_version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Frictionless contact of an elastic body with rigid surfaces: plane boundary elements, quadratic programming.

    Write the problem as a YAML file (see models/), look at it with check, solve it with solve.

    Exit status: 0 certified solution, 1 a result that is not one, 2 bad input.

    [bold]Examples[/bold]
      bemcontact check models/cylinder_on_plane.yaml --figure problem.png
      bemcontact solve models/cylinder_on_plane.yaml --figure contact.png
    """


@app.command()
def check(
    spec: SpecArgument,
    figure: FigureOption = None,
    refine: RefineOption = 1,
    overrides: SetOption = None,
) -> None:
    """Validate a spec and say what is seen in it: edges, contact zones, mesh, loads, and what holds the body.

    Nothing is solved, but a body that nothing holds, or that its load pulls off its support, is found out.

    [bold]Examples[/bold]
      bemcontact check models/cylinder_on_plane.yaml
      bemcontact check models/cylinder_on_plane.yaml --figure problem.svg
      bemcontact check models/cylinder_on_plane.yaml --set mesh.refine=2
    """
    with _told(spec, overrides), busy("checking"):
        _claim(spec, {"--figure": figure})
        from bemcontact import spec as spec_file
        from bemcontact.bem.condense import body_of
        from bemcontact.report import text

        body = body_of(spec_file.load(spec, overrides or ()).refined(refine))
        if figure:
            from bemcontact.report import figures

            figures.save(figures.figure_of_problem(body.problem, body.mesh), figure)
    with _told(spec):
        show(text.problem_summary(body))


@app.command()
def solve(
    spec: SpecArgument,
    formulation: Annotated[
        FormulationName, typer.Option(help="Statement of the contact problem.")
    ] = FormulationName.QP3,
    weights: Annotated[
        Weights, typer.Option(help="Weights of the objective; complementarity has none.")
    ] = Weights.TRIBUTARY,
    penalty: Annotated[
        float,
        typer.Option(
            metavar="μ",
            help="qp2: an error of the equations costs its square over μ; a smaller μ enforces them harder.",
        ),
    ] = 1.0,
    rows: Annotated[
        Rows, typer.Option(help="qp1, qp2: equations in terms of pressure or of displacement.")
    ] = Rows.STIFFNESS,
    equilibrium: Annotated[
        Equilibrium, typer.Option(help="qp2, free bodies: exact, or penalised as in the paper.")
    ] = Equilibrium.CONSTRAINT,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="null|random|FILE", help="qp1, qp2: first point; a FILE that --json wrote.", show_default="null"
        ),
    ] = None,
    seed: Annotated[
        int | None,
        typer.Option(min=0, metavar="S", help="qp1, qp2: random starts, other ones for each S.", show_default="0"),
    ] = None,
    starts: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="qp1, qp2: N random starts; the best end is shown.")
    ] = None,
    max_iterations: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Stop the solver after N iterations.", show_default="its own")
    ] = None,
    refine: RefineOption = 1,
    overrides: SetOption = None,
    figure: FigureOption = None,
    json_file: Annotated[
        Path | None,
        typer.Option("--json", metavar="FILE", help="Write all results; - for standard output.", show_default=False),
    ] = None,
    vtk_file: Annotated[
        Path | None,
        typer.Option("--vtk", metavar="FILE", help="Write the boundary; ends in .vtu or .vtk.", show_default=False),
    ] = None,
) -> None:
    """Find the contact pressure, judge it, and say it in a short table.

    Pressures are per UNDEFORMED length. The exit status is 0 only if the solution is certified.

    qp3 is convex, complementarity direct; qp1 and qp2 are left to a local solver.

    [bold]Examples[/bold]
      bemcontact solve models/cylinder_on_plane.yaml
      bemcontact solve models/cylinder_on_plane.yaml --figure contact.png
      bemcontact solve models/cylinder_on_plane.yaml --set material.young_modulus=2e6
      bemcontact solve models/cylinder_on_plane.yaml --json - | jq .peak
      bemcontact solve models/cylinder_on_plane.yaml --formulation qp1
      bemcontact solve models/cylinder_on_plane.yaml --formulation qp2 --starts 20
    """
    with _told(spec, overrides), busy("solving") as say:
        json_claim = None if json_file == STANDARD_OUTPUT else json_file
        _claim(spec, {"--figure": figure, "--json": json_claim, "--vtk": vtk_file})
        from bemcontact import analysis
        from bemcontact import spec as spec_file
        from bemcontact.formulations import plan as plans
        from bemcontact.formulations import starts as starts_of
        from bemcontact.report import text, words

        plan = plans.planned(
            formulation,
            weights,
            penalty=penalty,
            rows=rows,
            equilibrium=equilibrium,
            start=start if start is None or start in [*StartName] else starts_of.read_start(start),
            seed=seed,
            starts=starts,
            max_iterations=max_iterations,
        )
        problem = spec_file.load(spec, overrides or ()).refined(refine)
        result = analysis.carry_out(
            plan, problem, lambda done: say(f"solving, start {min(done + 1, starts or 1)} of {starts}")
        )
        if figure:
            from bemcontact.report import figures

            figures.save(figures.figure_of_result(result), figure)
        if vtk_file:
            from bemcontact.report import vtk

            vtk.save(result, vtk_file)
        if json_file and json_file != STANDARD_OUTPUT:
            with output.whole_file(json_file) as temporary:
                temporary.write_text(result.to_json(indent=2) + "\n", encoding="utf-8")
    with _told(spec):
        if json_file == STANDARD_OUTPUT:
            _write_json(result.to_json(indent=2))
            if not result.certified:
                tell("not certified: ", words.verdict(result))
        else:
            show(text.result_summary(result))
    raise typer.Exit(0 if result.certified else UNCERTIFIED)


@app.command()
def condense(
    spec: SpecArgument,
    out: Annotated[Path, typer.Option(metavar="FILE.npz", help="Where to write.", show_default=False)],
    refine: RefineOption = 1,
    overrides: SetOption = None,
) -> None:
    """Reduce a body to its contact points and save compliance, gaps and weights as one .npz file.

    Read it with bemcontact.CondensedContact.load(FILE) and hand it to bemcontact.solve.

    [bold]Examples[/bold]
      bemcontact condense models/cylinder_on_plane.yaml --out cylinder.npz
      bemcontact condense models/cylinder_on_plane.yaml --refine 2 --out fine.npz
    """
    with _told(spec, overrides), busy("condensing"):
        _claim(spec, {"--out": out})
        from bemcontact import analysis
        from bemcontact import spec as spec_file
        from bemcontact.report import text

        condensed = analysis.condense(spec_file.load(spec, overrides or ()).refined(refine))
        condensed.save(out)
    with _told(spec):
        show(text.condensed_summary(condensed, out))


@app.command()
def schema() -> None:
    """Print the JSON Schema of a spec, which editors use to check and complete.

    [bold]Examples[/bold]
      bemcontact schema > bemcontact.schema.json
    """
    with _told():
        from bemcontact import spec

        _write_json(json.dumps(spec.schema(), indent=2, ensure_ascii=False))


def _claim(spec: Path, outputs: Mapping[str, Path | None]) -> None:
    """Refuse files (by option) that cannot be written, or that would overwrite another, before any work is done."""
    claimed = {spec.resolve(): "the spec itself"}
    for option, path in outputs.items():
        if path is None:
            continue
        if path.resolve() in claimed:
            _refuse(f"{option} {path} would overwrite {claimed[path.resolve()]}; name another file")
        claimed[path.resolve()] = f"the file of {option}"
        try:
            if option == "--figure":
                from bemcontact.report import figures

                figures.ensure_known_format(path)
            if option == "--vtk":
                from bemcontact.report import vtk

                vtk.ensure_possible(path)
            if option == "--out" and path.suffix != ".npz":
                raise ValueError(f"{path}: a condensed problem is written as .npz; end the file name in it")
            output.ensure_writable(path)
        except (OSError, ValueError, ModuleNotFoundError) as error:
            _refuse(f"{option}: {error}")


def _write_json(text: str) -> None:
    """Write JSON on standard output, which is UTF-8 whatever the terminal speaks."""
    typer.echo(text.encode() + b"\n", nl=False)


def _refuse(message: str) -> NoReturn:
    """Say what is wrong with the input and end."""
    tell("error: ", message)
    raise typer.Exit(BAD_INPUT)


@contextmanager
def _told(spec: Path | None = None, overrides: Sequence[str] | None = None) -> Iterator[None]:
    """Turn all that can go wrong on purpose into one text on standard error, about a spec, and an exit status."""
    try:
        yield
    except KeyboardInterrupt:
        raise typer.Exit(INTERRUPTED) from None
    except BrokenPipeError:
        raise
    except (SpecError, OptionError, NotConvexError) as error:
        _refuse(str(error))
    except ProblemError as error:
        if spec is None:
            _refuse(str(error))
        from bemcontact import spec as spec_file

        _refuse(str(spec_file.located(error, spec, overrides or ())))
    except OSError as error:
        where = error.filename or ("standard output" if error.errno else "")
        _refuse(f"{where}: {error.strerror}" if where else str(error))
    except BemContactError as error:
        tell("failed: ", str(error))
        raise typer.Exit(UNCERTIFIED) from error
    except MemoryError as error:
        tell("failed: ", "not enough memory for so many elements; take a smaller --refine")
        raise typer.Exit(UNCERTIFIED) from error


if __name__ == "__main__":
    main()
