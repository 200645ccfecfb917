"""The boundary of a result as a file for ParaView and its like; the only room that knows meshio.

Points are written once for each element, so that tractions may jump from one element to the next.
"""

from importlib.util import find_spec
from pathlib import Path

import numpy as np

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.bem.condense import BoundaryState
from bemcontact.errors import ProblemError
from bemcontact.files import output
from bemcontact.problem.problem import Problem

FORMATS = {".vtu": "vtu", ".vtk": "vtk"}
"""Ending of a file that can be written -> the name of its format."""


def ensure_possible(path: Path) -> None:
    """Find out, before any work is done, whether `save` knows the format and has what it needs.

    Parameters
    ----------
    path : where the file is to appear

    Raises
    ------
    ValueError
        If the file name does not end in one of `FORMATS`.
    ModuleNotFoundError
        If meshio is not installed.
    """
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: a boundary is written as {', '.join(FORMATS)}; end the file name in one of them")
    if find_spec("meshio") is None:
        raise ModuleNotFoundError(f"{path} needs meshio, which is not installed; pip install 'bemcontact[vtk]'")


def save(result: Result, path: Path) -> None:
    """Write the undeformed boundary with its fields, whole or not at all.

    Three-noded lines carry, at their points, ``displacement`` [L] and ``traction`` [p] (vectors with a third component
    of zero, as viewers want them), ``pressure`` [p], zero off the contact points, and ``gap`` [L], not a number off
    them; and, once for each line, ``edge``, the number of its edge in the order of the spec, from 0.

    Parameters
    ----------
    result : of a problem, not of a condensed one
    path : ends in one of `FORMATS`

    Raises
    ------
    ProblemError
        If no boundary stands behind the result.
    ValueError, ModuleNotFoundError
        As from `ensure_possible`.
    """
    ensure_possible(path)
    problem, boundary = result.problem, result.boundary
    if problem is None or boundary is None:
        raise ProblemError("the result of a condensed problem has no boundary to write; solve the problem itself")
    import meshio

    pressure, gap = _contact_fields(result, problem, boundary)
    lines = np.arange(boundary.points[..., 0].size).reshape(-1, 3)[:, [0, 2, 1]]  # the middle node comes last
    mesh = meshio.Mesh(
        _in_space(boundary.points),
        [("line3", lines)],
        point_data={
            "displacement": _in_space(boundary.displacement),
            "traction": _in_space(boundary.traction),
            "pressure": pressure.ravel(),
            "gap": gap.ravel(),
        },
        cell_data={"edge": [np.asarray(boundary.edge, np.int64)]},
    )
    with output.whole_file(path) as temporary:
        mesh.write(temporary, file_format=FORMATS[path.suffix.lower()])


def _in_space(vectors: Array) -> Array:
    """Vectors (m, 3, 2) as (3m, 3), with a third component of zero."""
    flat = vectors.reshape(-1, 2)
    return np.column_stack([flat, np.zeros(len(flat))])


def _contact_fields(result: Result, problem: Problem, boundary: BoundaryState) -> tuple[Array, Array]:
    """Pressure and gap (m, 3) at the nodes of each element; an element shows those of the zone that its edge is in."""
    contact = result.contact
    gaps = contact.initial_gap + result.solution.displacement
    pressure, gap = np.zeros(boundary.points.shape[:2]), np.full(boundary.points.shape[:2], np.nan)
    for number, name in enumerate(contact.zone_names):
        edges = [boundary.edge_names.index(edge) for edge in problem.contact_zones[name].edges]
        at = {tuple(contact.points[i]): i for i in np.flatnonzero(contact.zone == number)}
        for element in np.flatnonzero(np.isin(boundary.edge, edges)):
            for local, point in enumerate(boundary.points[element]):
                if (i := at.get(tuple(point))) is not None:
                    pressure[element, local], gap[element, local] = result.solution.pressure[i], gaps[i]
    return pressure, gap
