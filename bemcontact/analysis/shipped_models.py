"""The problems that come with the package: its folder ``models`` once it is installed, that of the source tree else."""

from importlib.resources import files

from bemcontact.errors import SpecError

FOLDER = "models"
"""Stands in the installed package, and beside the package in a source tree."""


def model(name: str) -> str:
    """Give the text of a problem that comes with the package.

    Parameters
    ----------
    name : such as ``cylinder_on_plane``, or a path below the folder, without its ending

    Returns
    -------
    str
        YAML, for `bemcontact.loads`.

    Raises
    ------
    SpecError
        The package has no such problem.
    """
    package = files("bemcontact")
    for folder in (package.joinpath(FOLDER), package.joinpath("..", FOLDER)):
        file = folder.joinpath(f"{name}.yaml")
        if file.is_file():
            return file.read_text(encoding="utf-8")
    raise SpecError(f"models/{name}.yaml is not where bemcontact is installed; install the package anew")
