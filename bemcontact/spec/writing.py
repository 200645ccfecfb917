"""Problems as YAML, which `load` reads again as equal problems."""

import os

from bemcontact.checks.arguments import file_path, shown
from bemcontact.errors import ProblemError
from bemcontact.files.output import ensure_writable, whole_file
from bemcontact.problems import Problem
from bemcontact.spec.yaml_1_2 import to_yaml


def dumps(problem: Problem) -> str:
    """Write a problem as YAML.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    str
        The text of a spec without defaults and comments. `loads` reads it as an equal problem.

    Raises
    ------
    ProblemError
        If this is no problem.
    """
    if not isinstance(problem, Problem):
        raise ProblemError(f"a Problem is needed, found {shown(problem)}; bemcontact.problem makes one from a mapping")
    return to_yaml(problem.to_dict())


def dump(problem: Problem, path: str | os.PathLike[str]) -> None:
    """Write a problem to a YAML file, which appears whole or not at all.

    Parameters
    ----------
    problem : Problem
    path : the file; one that exists is replaced

    Raises
    ------
    ProblemError
        If this is no problem.
    OSError
        If the file cannot be written.
    """
    text, file = dumps(problem), file_path(path, "file")
    ensure_writable(file)
    with whole_file(file) as temporary:
        temporary.write_text(text, encoding="utf-8")
