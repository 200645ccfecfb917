"""Meshes and boundary-value problems without contact, for tests of the boundary-element core alone."""

from collections.abc import Callable, Sequence

import numpy as np

from bemcontact.bem.boundary_values import BoundaryValues
from bemcontact.bem.loading import Loading, particular_solution
from bemcontact.bem.mesh import Mesh, elements_of_loops
from bemcontact.bem.rigid_motions import RigidMotions, all_rigid_motions, free_rigid_motions
from bemcontact.bem.solution import solve_system
from bemcontact.bem.system import System
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.problems.conditions import Loads
from bemcontact.problems.material import Material

Curve = Callable[[np.ndarray], np.ndarray]


def segment(start: Sequence[float], end: Sequence[float]) -> Curve:
    return lambda s: np.outer(1 - s, start) + np.outer(s, end)


def arc(center: Sequence[float], radius: float, first: float, last: float) -> Curve:
    """A circular arc between two angles in degrees."""

    def at(s: np.ndarray) -> np.ndarray:
        angle = np.radians(first + s * (last - first))
        return center + radius * np.column_stack([np.cos(angle), np.sin(angle)])

    return at


def mesh_of(*loops: Sequence[tuple[str, Curve, Sequence[float]]]) -> Mesh:
    """Mesh closed loops of edges (name, curve, fractions of the element ends from 0 to 1)."""
    starts, middles, after, edges = [], [], [], []
    for loop in loops:
        first = len(edges)
        for name, curve, ends in loop:
            ends = np.asarray(ends, float)
            starts.append(curve(ends[:-1]))
            middles.append(curve((ends[:-1] + ends[1:]) / 2))
            edges += [name] * (len(ends) - 1)
        after += [*range(first + 1, len(edges)), first]
    numbers = {name: number for number, name in enumerate(dict.fromkeys(edges))}
    return Mesh(
        nodes=np.vstack([*starts, *middles]),
        elements=elements_of_loops(np.array(after)),
        edge=np.array([numbers[name] for name in edges]),
        edge_names=tuple(numbers),
    )


def rectangle(width: float, height: float, along: Sequence[float], across: Sequence[float]) -> list:
    """The four edges bottom, right, top, left, counterclockwise from the origin."""
    w, h = width, height
    return [
        ("bottom", segment((0, 0), (w, 0)), along),
        ("right", segment((w, 0), (w, h)), across),
        ("top", segment((w, h), (0, h)), along),
        ("left", segment((0, h), (0, 0)), across),
    ]


def even(count: int) -> np.ndarray:
    return np.linspace(0, 1, count + 1)


def values_of(
    mesh: Mesh,
    fixed: dict[str, str],
    displacement: Callable[[np.ndarray], np.ndarray],
    traction: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> BoundaryValues:
    """Prescribe a known field: displacement along the axes ("x", "y", "xy") in `fixed` of an edge, else traction."""
    given = np.zeros((len(mesh.nodes), 2), bool)
    unknown = np.zeros((len(mesh.elements), 2), bool)
    for name, axes in fixed.items():
        on = np.flatnonzero(mesh.edge == mesh.edge_names.index(name))
        for axis in ("xy".index(letter) for letter in axes):
            unknown[on, axis] = True
            given[np.unique(mesh.elements[on]), axis] = True
    t = traction(mesh.nodes[mesh.elements], mesh.normals)
    return BoundaryValues(
        displacement_given=given,
        displacement=np.where(given, displacement(mesh.nodes), 0),
        traction_unknown=unknown,
        traction=np.where(unknown[:, None, :], 0, t),
        stiffness=np.zeros((*t.shape, 2)),
    )


def system_of(
    mesh: Mesh, material: Material, values: BoundaryValues, motions: RigidMotions, loads: Loads | None = None
) -> System:
    return System(
        mesh=mesh, material=material, points=UnitPressures.none(), motions=motions,
        loadings=(Loading(values=values, particular=particular_solution(loads or Loads(), material, mesh)),),
    )  # fmt: skip


def solved(
    mesh: Mesh, material: Material, values: BoundaryValues, loads: Loads | None = None
) -> tuple[np.ndarray, np.ndarray, System]:
    """Displacement (N, 2) and traction (m, 3, 2) of a body without contact, and its system."""
    motions = free_rigid_motions(mesh, values)
    system = system_of(mesh, material, values, motions, loads)
    displacement, traction = system.fields(solve_system(system).combined(np.ones(1)), system.loadings[0])
    return displacement, traction, system


def without_rigid_motion(mesh: Mesh, difference: np.ndarray) -> np.ndarray:
    """Take the best-fitting rigid motion out of nodal displacements."""
    every = all_rigid_motions(mesh)
    rows = every.displacement(mesh.nodes).reshape(-1, 3)
    fitted, *_ = np.linalg.lstsq(rows, difference.ravel(), rcond=None)
    return difference - (rows @ fitted).reshape(-1, 2)


ABRUPT = np.append(0, np.cumsum([1.0, 35, 1, 35, 35, 1, 1, 35])) / 144
"""Element ends whose lengths jump by 35, next to corners too."""


MESHES = {
    "rectangle": [rectangle(2, 1, even(6), even(3))],
    "rectangle, lengths 1:35": [rectangle(2, 1, ABRUPT, ABRUPT)],
    "circle of four elements": [[("c", arc((0, 0), 1, 0, 360), even(4))]],
    "circle of eight elements": [[("c", arc((0, 0), 1, 0, 360), even(8))]],
    "circle, lengths 1:35": [[("c", arc((0, 0), 1, 0, 360), ABRUPT)]],
    "half disc, lengths 1:35": [[("flat", segment((-1, 0), (1, 0)), even(4)), ("arc", arc((0, 0), 1, 0, 180), ABRUPT)]],
    "plate with a hole": [rectangle(2, 1, ABRUPT, even(4)), [("hole", arc((1, 0.5), 0.3, 360, 0), even(8))]],
    "ligament of 0.01": [rectangle(2, 1, even(20), even(10)), [("hole", arc((1, 0.5), 0.49, 360, 0), even(12))]],
}
