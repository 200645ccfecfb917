"""The boundary of a result as a file for ParaView; only this module uses meshio.

Points are written once for each element, so that tractions may jump from one element to the next.
"""

from importlib.util import find_spec
from pathlib import Path

import numpy as np

from bemcontact.analysis.result import Result
from bemcontact.arrays import Array
from bemcontact.files import output

FORMATS = {".vtu": "vtu", ".vtk": "vtk"}
"""Ending of a file that can be written -> the name of its format."""


def ensure_possible(path: Path) -> None:
    """Check the format of a file and that meshio is installed; `ValueError` or `ModuleNotFoundError` if not."""
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"{path}: the file name of a boundary must end in {' or '.join(FORMATS)}")
    if find_spec("meshio") is None:
        raise ModuleNotFoundError(f"{path} needs meshio, which is not installed; pip install 'bemcontact[vtk]'")


def save(result: Result, path: Path) -> None:
    """Write the undeformed boundary of a result as three-noded lines with fields.

    Point data are ``displacement`` [L] and ``traction`` [p] (three components, the third zero), ``pressure`` [p], zero
    off the contact points, and ``gap`` [L], not a number off them. Cell data is ``edge``, the number of the edge in the
    spec, from 0. `ProblemError` for the result of a condensed problem; other errors as of `ensure_possible`.
    """
    ensure_possible(path)
    pressure, gap = result.contact_fields()
    boundary = result.boundary
    assert boundary is not None  # or there are no fields on it
    import meshio

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
