"""How an option is declared: once, with its default, meaning and name in errors; and the checks of options."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import field, fields
from difflib import get_close_matches
from enum import StrEnum
from textwrap import fill
from typing import Any, TypeVar, cast

from bemcontact.checks.arguments import LARGEST_COUNT, shown, whole_number
from bemcontact.checks.docstrings import docstring
from bemcontact.checks.keywords import unknown_option
from bemcontact.errors import OptionError, ProblemError

Name = TypeVar("Name", bound=StrEnum)
Options = TypeVar("Options")

MEANT: Mapping[str, Sequence[str]] = {
    "--figure": (
        "plot",
        "picture",
        "image",
        "png",
        "svg",
        "pdf",
        "draw",
        "graph",
        "chart",
        "save-figure",
        "fig",
        "show",
        "view",
        "display",
    ),
    "--animation": ("animate", "gif", "movie", "film", "video", "frames"),
    "--out": ("output", "folder", "directory", "dir", "report", "html", "page", "o", "csv", "table", "save", "write"),
    "--accuracy": ("tolerance", "tol", "error", "precision", "eps", "rtol", "epsilon"),
    "--refine": ("mesh", "refinement", "elements", "density", "h", "fine", "n"),
    "--formulation": ("method", "formulations", "algorithm", "qp", "model", "type"),
    "--case": ("load-case", "loadcase", "load", "cases", "combination"),
    "--variant": ("version-of", "config", "configuration"),
    "--vary": ("grid", "sweep", "range", "over", "param", "parameter", "parameters", "key", "variable"),
    "--set": ("override", "overrides", "param", "parameter", "change", "define", "d", "value", "key"),
    "--json": ("data", "result", "results", "export", "verbose", "debug", "full"),
    "--vtk": ("paraview", "vtu"),
    "--max-iterations": ("iterations", "maxiter", "max-iter", "limit"),
    "--stress": ("von-mises", "contour", "shear"),
    "--workers": ("jobs", "j", "processes", "threads", "cores", "parallel", "cpus"),
}
"""Option -> what others call it."""

STARTS = "number of starts"
MOST_STARTS = 1_000_000
"""Largest number of random starts, which are drawn before the first search."""


def declared(
    default: Any,
    meaning: str,
    *,
    noun: str = "",
    metavar: str | None = None,
    least: int | None = None,
    shown: str | bool = True,
) -> Any:
    """Declare an option by its default and its meaning, for help and documentation.

    Parameters
    ----------
    noun : its name in errors, if that is another one
    metavar : stands for its value in the help of the command line
    least : least value of a whole number
    shown : the default in words, or whether the help shows it
    """
    about = {"meaning": meaning, "noun": noun, "metavar": metavar, "least": least, "shown": shown}
    return field(default=default, metadata=about)


def redeclared(options: type[Any], name: str, meaning: str = "") -> Any:
    """Declare an option as another class does; its meaning may be another one."""
    item = options.__dataclass_fields__[name]
    return field(default=item.default, metadata={**item.metadata, "meaning": meaning or item.metadata["meaning"]})


def documented(options: type[Options]) -> type[Options]:
    """Write the meanings of options into the docstring of their class, for `help` and documentation."""
    head, rule, rest = docstring(options).partition("\n\nRaises\n")
    about = (f"{item.name} : {item.metadata['meaning']}" for item in fields(cast(Any, options)))
    lines = "\n".join(fill(text, 96, subsequent_indent="    ") for text in about)
    options.__doc__ = f"{head}\n\nParameters\n----------\n{lines}{rule}{rest}"
    return options


def named(kind: type[Name], name: object, what: str) -> Name:
    """Read a name of a kind, which errors call `what`."""
    try:
        return kind(name if isinstance(name, str) else "")
    except ValueError:
        given = f"'{name}'" if isinstance(name, str) else shown(name)
        raise OptionError(f"no {what} {given:.80}; take one of {', '.join(item.value for item in kind)}") from None


def ensure_whole(value: object, what: str, least: int) -> None:
    """Refuse all but a whole number of at least `least`, and too many starts; errors call it `what`."""
    try:
        whole_number(value, what, least, MOST_STARTS if what == STARTS else LARGEST_COUNT)
    except ProblemError as error:
        raise OptionError(str(error)) from None


def ensure_whole_fields(options: Any) -> None:
    """Make each whole number among the fields that is given an int; refuse other values."""
    for item in options.__dataclass_fields__.values():
        value, least = getattr(options, item.name), item.metadata["least"]
        if least is not None and value is not None:
            ensure_whole(value, item.metadata["noun"] or item.name, least)
            object.__setattr__(options, item.name, whole_number(value, item.name, least))


EXPECTED_ACCURACY = "expected a relative accuracy between 0 and 1"
"""Beginning of the error of an accuracy that is something else."""


def ensure_known(options: Iterable[str], known: Collection[str]) -> None:
    """Refuse the name of an option that does not exist; list those that do."""
    for name in options:
        if name not in known:
            word = str(name).strip("-").lower().replace("_", "-")
            meant = [own for option, words in MEANT.items() if word in words and (own := _argument(option)) in known]
            raise unknown_option(name, known, meant or get_close_matches(str(name), [*known], n=1))


def _argument(option: str) -> str:
    """Name of the argument in Python of an option of the command line."""
    return option.strip("-").replace("-", "_")
