"""Error bars of the largest stresses, from the stress on another mesh, as those of pressures are.

The other mesh has elements twice as long, where those of the answer are halves, or half as long. A largest stress may
change little by accident. So the bar is floored by the change of the stress around its place, and by the error of the
pressure.
"""

from dataclasses import replace

import numpy as np

from bemcontact.adaptivity.error_bars import NOTHING, SAFETY
from bemcontact.adaptivity.fields import solved
from bemcontact.adaptivity.mesh_sizes import cut
from bemcontact.analysis.body_stress import BodyStress
from bemcontact.analysis.largest_stress import RINGS, Measure
from bemcontact.analysis.stress_of_bodies import StressOfBodies
from bemcontact.arrays import Array, magnitudes
from bemcontact.assessment.accuracy import Accuracy
from bemcontact.contact.stress import LargestStresses, Stress, StressPeak
from bemcontact.errors import ProblemError, SingularSystemError, SolverError
from bemcontact.frozen import frozen
from bemcontact.problems.problem import Problem
from bemcontact.serialization import Pair

AROUND = np.vstack([[0.0, 0.0], RINGS / 2])
"""Places around a maximum inside the body, over its depth, at which the stress of two meshes is compared."""
TELLS_NOTHING = 1.0
"""Error bar from which on a stress is not known."""


def largest_with_bars(problem: Problem, stresses: StressOfBodies, accuracy: Accuracy) -> LargestStresses:
    """Find the largest stresses, with error bars; none of these are known where those of pressures are not."""
    largest = stresses.largest
    pressures = [item.bar for item in accuracy.bars if item.quantity == "pressure"]
    known = [bar for bar in pressures if bar is not None]
    if accuracy.met is None or len(known) < len(pressures):
        return largest
    of_fine = problem.mesh.refine % 2 == 0
    refine = problem.mesh.refine // 2 if of_fine else 2 * problem.mesh.refine
    try:
        other = _on_mesh(cut(problem, refine), accuracy.infinite_places)
    except (ProblemError, SingularSystemError, SolverError):
        return largest
    factor, its = SAFETY if of_fine else 1 + SAFETY, other.largest
    pairs = {
        one.name: _Pair(one=one, two=two, factor=factor, floor=max([NOTHING, *known]))
        for one, two in zip(stresses.bodies, other.bodies, strict=True)
    }

    def barred(peak: StressPeak | None, on_other: StressPeak | None, measure: Measure) -> StressPeak | None:
        return None if peak is None else replace(peak, bar=pairs[peak.body].bar(peak, on_other, measure))

    return replace(
        largest,
        shear={zone: barred(peak, its.shear[zone], _max_shear) for zone, peak in largest.shear.items()},
        inside=barred(largest.inside, its.inside, _von_mises),
        boundary=barred(largest.boundary, its.boundary, _von_mises),
    )


def _von_mises(stress: Stress) -> Array:
    return stress.von_mises


def _max_shear(stress: Stress) -> Array:
    return stress.max_shear


def _on_mesh(problem: Problem, infinite: list[Pair]) -> StressOfBodies:
    """The stress of a problem on its mesh; `SolverError` without a contact state."""
    answer = solved(problem).answers[0]
    return StressOfBodies.of(problem, answer.state, answer.pressure[:, :, 1] > 0, infinite)


@frozen
class _Pair:
    """The stress on two meshes.

    Parameters
    ----------
    one, two : on the mesh of the answer, and on the other one
    factor : error bar over the change
    floor : least error bar
    """

    one: BodyStress
    two: BodyStress
    factor: float
    floor: float

    def bar(self, peak: StressPeak, other: StressPeak | None, measure: Measure) -> float | None:
        """Relative error of a largest stress; None if the other mesh has none, or is not compared there."""
        if other is None:
            return None
        around = self._change_inside(peak, measure) if peak.edge is None else self._change_along(peak, peak.edge)
        if around is None:
            return None
        # A smaller one elsewhere says nothing of this one, which that mesh does not tell from an infinite one.
        away = np.hypot(*np.subtract(peak.point, other.point))
        elsewhere = (other.body, other.edge) != (peak.body, peak.edge) or away > self._reach(peak)
        change = max(other.value - peak.value, around) if elsewhere else max(abs(peak.value - other.value), around)
        bar = max(self.factor * change / peak.value, self.floor)
        return bar if bar < TELLS_NOTHING else None

    def _reach(self, peak: StressPeak) -> float:
        """Distance [L] up to which a maximum of the other mesh is that of this one: depth, or longer element there."""
        if peak.edge is None:
            return peak.depth
        lengths = []
        for mesh in (self.one.field.mesh, self.two.field.mesh):
            nearest = magnitudes(mesh.nodes[: len(mesh.elements)] - peak.point).argmin()
            lengths.append(float(mesh.lengths[nearest]))
        return max(lengths)

    def _change_inside(self, peak: StressPeak, measure: Measure) -> float | None:
        """Largest change [p] of a stress at places around a maximum inside."""
        points = np.array(peak.point) + peak.depth * AROUND
        pair = [(body, body.field.locate(points)) for body in (self.one, self.two)]
        inside = np.all([at.inside for _, at in pair], axis=0)
        one, two = (measure(body.at(at)) for body, at in pair)
        return float(abs(one - two)[inside].max()) if inside.any() else None

    def _change_along(self, peak: StressPeak, edge: str) -> float | None:
        """Largest change [p] of the equivalent stress at nodes of both meshes around a maximum on an edge."""
        fine, coarse = sorted((body.along(edge) for body in (self.one, self.two)), key=lambda item: -len(item.arc))
        away = magnitudes(coarse.points - peak.point).min(axis=1)
        element = int(away.argmin())
        near = slice(max(0, element - 1), element + 2)
        nodes = np.stack([fine.von_mises[0::2, 0], fine.von_mises[0::2, 2], fine.von_mises[1::2, 2]], axis=1)
        change = abs(nodes - coarse.von_mises)[near]
        return float(np.nanmax(change)) if np.isfinite(change).any() else None
