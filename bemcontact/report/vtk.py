"""Boundary and inside of a result as a file for ParaView; only this module uses meshio.

Points of the boundary are written once for each element, so that tractions may jump from one element to the next.
"""

from importlib.util import find_spec
from pathlib import Path

import numpy as np

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.files import output
from bemcontact.options import StressMeasure

FORMATS = {".vtu": "vtu", ".vtk": "vtk"}
"""Ending of a file that can be written -> the name of its format."""


def ensure_possible(path: Path) -> None:
    """Check the format of a file and that meshio is installed; `ValueError` or `ModuleNotFoundError` if not."""
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: the file name of a boundary must end in {' or '.join(FORMATS)}")
    if find_spec("meshio") is None:
        raise ModuleNotFoundError(f"{path} needs meshio, which is not installed; pip install 'bemcontact[vtk]'")


def save(result: Result, path: Path) -> None:
    """Write the undeformed boundary of a result as three-noded lines, and its inside as triangles, with fields.

    Point data are ``displacement`` [L] and ``traction`` [p] (three components, the third zero), ``pressure`` [p], zero
    off the contact points, ``gap`` [L], not a number off them, and the stresses ``stress_xx``, ``stress_yy``,
    ``stress_xy``, ``stress_zz``, ``von_mises`` and ``max_shear`` [p], not numbers where stress is infinite. Inside,
    traction is zero. Cell data are ``edge``, the number of the edge in the spec, from 0, and -1 for triangles, and
    ``body``, the number of the elastic body, from 0. Where bodies touch or are bonded each has its own stress.
    `ProblemError` for the result of a condensed problem; other errors as of `ensure_possible`.
    """
    ensure_possible(path)
    pressure, gap = result.contact_fields()
    boundary, problem = result.boundary, result.problem
    assert boundary is not None  # or there are no fields on it
    assert problem is not None
    import meshio

    inside, rim = result.triangulated, boundary.points[..., 0].size
    lines = np.arange(rim).reshape(-1, 3)[:, [0, 2, 1]]  # the middle node comes last
    names = [part.name for part in problem.parts]
    body = np.array([names.index(problem.part_of(edge)) for edge in boundary.edge_names])[boundary.edge]
    none, on_rim = np.zeros(len(inside.points)), []
    for number, name in enumerate(names):  # elements of one body follow one another
        on_rim.append(result.stress(boundary.points[body == number].reshape(-1, 2), name))
    stresses = {
        f"stress_{measure}" if measure.signed else str(measure): np.concatenate(
            [stress.measured(measure) for stress in (*on_rim, inside.stress)]
        )
        for measure in StressMeasure
    }
    mesh = meshio.Mesh(
        np.vstack([_in_space(boundary.points), _in_space(inside.points)]),
        [("line3", lines), ("triangle", rim + inside.triangles)],
        point_data={
            "displacement": np.vstack([_in_space(boundary.displacement), _in_space(inside.displacement)]),
            "traction": np.vstack([_in_space(boundary.traction), np.zeros((len(none), 3))]),
            "pressure": np.append(pressure, none),
            "gap": np.append(gap, np.full(len(none), np.nan)),
            **stresses,
        },
        cell_data={
            "edge": [np.asarray(boundary.edge, np.int64), np.full(len(inside.triangles), -1, np.int64)],
            "body": [body, np.asarray(inside.body, np.int64)],
        },
    )
    with output.whole_file(path) as temporary:
        mesh.write(temporary, file_format=FORMATS[path.suffix.lower()])


def _in_space(vectors: Array) -> Array:
    """Vectors (…, 2) as (k, 3), with a third component of zero."""
    flat = vectors.reshape(-1, 2)
    return np.column_stack([flat, np.zeros(len(flat))])
