"""The five problems of [SS92] in `models/` beside quadratic triangles, which share no line with the package.

    OPENBLAS_NUM_THREADS=1 python tests/benchmarks/finite_elements.py [PROBLEM ...] [--levels 2] [--refine 1 4]

Each problem is solved by finite elements on nested meshes, each with the elements of the one before cut in four, and
extrapolated in h². The table holds these values, how far the last two meshes are from the limit (±), and how far
bemcontact is off on the mesh of the model and on finer ones.
"""

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import finite_elements_bodies as bodies
import numpy as np
from finite_elements_contact import Array, Field, Touch, node_at
from numpy.typing import ArrayLike
from rich.console import Console
from rich.table import Table

import bemcontact

Answer = dict[str, Any]

MODELS = Path(__file__).parents[2] / "models"
ORDER = 2
"""Of h in what is extrapolated; the pressure at a corner that attracts stresses converges more slowly."""
EXPECTED = {1: (0.03, 1.0), 4: (0.005, 0.5)}
"""By refinement: how far p may be off relative to its peak, and an end of contact in node spacings."""
LEGEND = """\
±: how far the finer mesh is from the limit. Forces are relative to the resultant, p to its peak, displacements to the
largest of the table; ends of contact are in node spacings of the coordinate.
Away from ends: by an element of the first mesh, and by 5 % of the contact, from ends that are not of symmetry.
(!): p away from ends off by more than 3 % at refine 1 or 0.5 % at 4, or an end by more than one or half a spacing."""
AWAY = 0.05
"""Of the length of contact: farther from its ends pressures are judged."""
NEAR = 1e-9
SAMPLES = 2001
"""Places between which the peak of finite elements is looked for."""


@dataclass(frozen=True, kw_only=True)
class Problem:
    """A problem and where its two solutions are compared.

    Parameters
    ----------
    touch : the contact by finite elements, with elements cut into so many parts
    coordinate : along the candidate side, and its name
    singular : which ends of the contact interval, 0 or 1, are none of symmetry
    points : where displacements are compared, by name
    """

    touch: Callable[[int], Touch]
    coordinate: Field
    label: str
    singular: tuple[int, ...]
    points: dict[str, tuple[float, float]]


ANGLE = np.radians(28.4)
PROBLEMS = {
    "cylinder_on_plane": Problem(
        touch=bodies.cylinder_on_plane,
        coordinate=bodies.along_x,
        label="x",
        singular=(1,),
        points={
            "lowest point": (0, 0),
            "28.4° from it": (8 * np.sin(ANGLE), 8 - 8 * np.cos(ANGLE)),
            "end of top": (8, 8),
            "center": (0, 8),
        },
    ),
    "cantilever_flat_surface": Problem(
        touch=bodies.cantilever_flat_surface,
        coordinate=bodies.along_x,
        label="x",
        singular=(0, 1),
        points={"start of zone": (40, 0), "lower tip": (50, 0), "upper tip": (50, 5), "middle of top": (25, 5)},
    ),
    "cantilever_curved_surface": Problem(
        touch=bodies.cantilever_curved_surface,
        coordinate=bodies.along_x,
        label="x",
        singular=(0, 1),
        points={"lower tip": (100, 0), "middle of tip": (100, 5), "upper tip": (100, 10)},
    ),
    "bolt_in_plate": Problem(
        touch=bodies.bolt_in_plate,
        coordinate=bodies.from_top,
        label="θ",
        singular=(0,),
        points={
            "on the bolt": (-2, 0), "top of hole": (0, 2), "right of hole": (2, 0), "left edge": (-6, 0),
            "upper left": (-6, 3), "pulled edge": (6, 0), "upper right": (6, 3),
        },
    ),
    "elliptical_crack_closure": Problem(
        touch=bodies.elliptical_crack_closure,
        coordinate=bodies.along_x,
        label="x",
        singular=(1,),
        points={"middle of crack": (0, 0.3), "top": (0, 10), "upper corner": (8, 10), "side": (8, 0)},
    ),
}  # fmt: skip


class Limit:
    """What values on nested meshes tend to."""

    def __init__(self, touches: Sequence[Touch]) -> None:
        self._coarse, self._fine = touches[-2:]

    def of(self, value: Callable[[Touch], Array | float]) -> tuple[Array, Array]:
        """A value extrapolated from the last two meshes, and how far the last one is from it."""
        return extrapolated(np.asarray(value(self._coarse)), np.asarray(value(self._fine)))


def extrapolated(coarse: Array, fine: Array) -> tuple[Array, Array]:
    """The limit of values with an error in h^ORDER, from those on h and h/2, and how far the latter are from it."""
    step = (fine - coarse) / (2**ORDER - 1)
    return fine + step, abs(step)


@dataclass(frozen=True, kw_only=True)
class Row:
    """A line of the table: a value of finite elements, and how far it is off in itself and with each mesh."""

    name: str
    value: str = ""
    uncertainty: str = ""
    off: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Pair:
    """Both solutions of a problem.

    Parameters
    ----------
    problem, limit : and its solution by finite elements
    edges : names of those that may touch
    refine : of the meshes
    results : what the package makes known of its solution on each
    """

    problem: Problem
    limit: Limit
    edges: tuple[str, ...]
    refine: tuple[int, ...]
    results: tuple[Answer, ...]

    def along(self, points: ArrayLike) -> Array:
        """Coordinate of points (..., 2)."""
        return self.problem.coordinate(*np.moveaxis(np.asarray(points, float), -1, 0))

    def zone(self, result: Answer) -> Array:
        """Coordinates (m, 3), in increasing order, of the nodes of the boundary elements that may touch."""
        inside = np.isin(result["boundary"]["edge"], self.edges)
        nodes = np.sort(self.along(result["boundary"]["points"])[inside], axis=1)
        return nodes[np.argsort(nodes[:, 0])]

    def stretch(self, part: float) -> tuple[float, float]:
        """Coordinates that are an element of the first mesh, and a part of the contact, away from its ends.

        Ends that are of symmetry count as part of the contact.
        """
        ends, (first, _, last) = self.limit.of(Touch.ends)[0], self.zone(self.results[0]).T
        lengths = (last - first)[np.clip(np.searchsorted(first, ends, side="right") - 1, 0, None)]
        away = np.maximum(lengths, part * np.ptp(ends)) * np.isin([0, 1], self.problem.singular)
        return float(ends[0] + away[0]), float(ends[1] - away[1])

    def peak(self) -> tuple[Array, Array]:
        """Largest pressure [p]."""
        lower, upper = self.stretch(AWAY)
        return self.limit.of(lambda touch: touch.pressure_at(np.linspace(lower, upper, SAMPLES)).max())

    def rows(self) -> Iterator[Row]:
        """The table."""
        balance = (result["residuals"]["force_balance"] for result in self.results)
        yield Row(name="force balance", off=tuple(f"{value:.1e}" for value in balance))
        yield from self.forces()
        yield self.pressures("p away from ends", *self.stretch(AWAY), judged=True)
        yield self.pressures("p an element away", *self.stretch(0.0), judged=False)
        yield self.pressures("p at all nodes", -np.inf, np.inf, judged=False)
        yield self.peaks()
        yield from self.ends()
        yield from self.displacements()

    def forces(self) -> Iterator[Row]:
        """Resultant of the contact pressure, relative to its magnitude."""
        force, uncertainty = self.limit.of(lambda touch: touch.force)
        size = np.hypot(*force)
        found = [np.array(result["resultant"]) for result in self.results]
        for i, axis in enumerate("xy"):
            off = tuple(percent((f[i] - force[i]) / size) for f in found)
            yield Row(
                name=f"force along {axis}", value=f"{force[i]:.6g}", uncertainty=percent(uncertainty[i] / size), off=off
            )

    def pressures(self, name: str, lower: float, upper: float, *, judged: bool) -> Row:
        """Largest difference of nodal pressures with lower <= coordinate <= upper, relative to the peak."""
        peak, words, worst = float(self.peak()[0]), [], 0.0
        for refine, result in zip(self.refine, self.results, strict=True):
            at = self.along(result["nodes"])
            inside = (at > lower - NEAR) & (at < upper + NEAR)
            right, uncertainty = self.limit.of(lambda touch, at=at[inside]: touch.pressure_at(at))
            off = abs(np.array(result["pressure"])[inside] - right) / peak
            worst = max(worst, uncertainty.max() / peak)
            mark = marked(off.max(), refine, 0) if judged else ""
            words.append(f"{percent(off.max())}{mark} at {at[inside][off.argmax()]:.4g}")
        where = f"{lower:.4g} to {upper:.4g}" if np.isfinite(lower) else ""
        return Row(name=name, value=where, uncertainty=percent(worst), off=tuple(words))

    def peaks(self) -> Row:
        """Largest pressure, relative to itself."""
        peak, uncertainty = map(float, self.peak())
        off = tuple(percent(result["peak"]["pressure"] / peak - 1) for result in self.results)
        return Row(name="peak of p there", value=f"{peak:.6g}", uncertainty=percent(uncertainty / peak), off=off)

    def ends(self) -> Iterator[Row]:
        """Ends of contact, in spacings of the nodes between which they lie."""
        right, uncertainty = self.limit.of(Touch.ends)
        for i in self.problem.singular:
            words = []
            for refine, result in zip(self.refine, self.results, strict=True):
                nodes = np.unique(self.zone(result))
                before = np.clip(np.searchsorted(nodes, right[i]), 1, len(nodes) - 1)
                spacing = nodes[before] - nodes[before - 1]
                reached = [self.along(item[side]) for item in result["intervals"] for side in ("start", "end")]
                off = ((max if i else min)(reached) - right[i]) / spacing
                words.append(f"{off:+.3f}{marked(abs(off), refine, 1)} of {spacing:.3g}")
            name = f"{'end' if i else 'start'} of contact"
            yield Row(name=name, value=f"{right[i]:.6g}", uncertainty=f"{uncertainty[i]:.1e}", off=tuple(words))

    def displacements(self) -> Iterator[Row]:
        """Displacements of the points, relative to the largest of them."""
        places = self.problem.points
        u, uncertainty = self.limit.of(lambda touch: np.array([touch.displacement_at(at) for at in places.values()]))
        largest = np.hypot(*u.T).max()
        for i, (name, at) in enumerate(places.items()):
            off = tuple(percent(np.hypot(*(displaced(result, at) - u[i])) / largest) for result in self.results)
            yield Row(
                name=f"u, {name}",
                value=f"({u[i, 0]:.5g}, {u[i, 1]:.5g})",
                uncertainty=percent(np.hypot(*uncertainty[i]) / largest),
                off=off,
            )


def displaced(result: Answer, point: tuple[float, float]) -> Array:
    """Displacement (2,) of a node of the boundary elements."""
    points, displacement = (np.reshape(result["boundary"][key], (-1, 2)) for key in ("points", "displacement"))
    return displacement[node_at(points, point)]


def percent(ratio: float) -> str:
    return f"{100 * ratio:.2g} %"


def marked(off: float, refine: int, which: int) -> str:
    """Mark what is farther off than expected."""
    return " (!)" if refine in EXPECTED and off > EXPECTED[refine][which] else ""


def compared(name: str, levels: int, refine: tuple[int, ...]) -> Table:
    """Solve a problem by both methods."""
    begin, problem = time.perf_counter(), PROBLEMS[name]
    touches = [problem.touch(2**level) for level in range(levels)]
    middle = time.perf_counter()
    model = bemcontact.load(MODELS / f"{name}.yaml", variant="stated mesh")
    edges = tuple(edge for zone in model.contact_zones.values() for edge in zone.edges)
    results = tuple(bemcontact.solve(model.refined(parts)).to_dict() for parts in refine)
    end = time.perf_counter()
    sizes = " and ".join(str(2 * len(touch.nodes)) for touch in touches[-2:])
    verdict = "" if all(result["certified"] for result in results) else "; NOT CERTIFIED"
    table = Table(
        title=f"{name}: coordinate {problem.label}; finite elements with {sizes} unknowns",
        caption=f"{middle - begin:.0f} s and {end - middle:.0f} s{verdict}",
    )
    columns = [f"refine {n}: {result['dof']} unknowns" for n, result in zip(refine, results, strict=True)]
    for column in ("", "finite elements", "±", *columns):
        table.add_column(column)
    for row in Pair(problem=problem, limit=Limit(touches), edges=edges, refine=refine, results=results).rows():
        table.add_row(row.name, row.value, row.uncertainty, *row.off)
    return table


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("problems", nargs="*", metavar="PROBLEM", help=", ".join(PROBLEMS), default=[*PROBLEMS])
    parser.add_argument("--levels", type=int, default=2, help="meshes of finite elements, at least 2")
    parser.add_argument("--refine", nargs="+", type=int, default=[1, 4], help="meshes of bemcontact, coarsest first")
    given = parser.parse_args()
    if unknown := set(given.problems) - set(PROBLEMS):
        parser.error(f"no problem {', '.join(sorted(unknown))}; take any of {', '.join(PROBLEMS)}")
    if given.levels < 2:
        parser.error("an extrapolation needs 2 levels or more")
    return given


def main() -> None:
    given = arguments()
    console = Console(width=150)
    for name in given.problems:
        console.print(compared(name, given.levels, tuple(given.refine)))
    console.print(LEGEND)


if __name__ == "__main__":
    main()
