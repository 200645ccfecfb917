"""The boundary of a body on a path, and error bars there: from a path on elements twice or half as long."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

from bemcontact.adaptivity.error_bars import error_bars
from bemcontact.adaptivity.fields import MeshDifference, Solved, answer_of
from bemcontact.adaptivity.singularities import Singularity, recognized
from bemcontact.adaptivity.zone_runs import ZoneRun, zone_runs
from bemcontact.analysis.variation import Variation
from bemcontact.assessment.accuracy import ErrorBar
from bemcontact.bem.boundary_values import BoundaryState
from bemcontact.bem.condense import Condensation, boundary_state
from bemcontact.contact.solution import ContactSolution
from bemcontact.parametric.path import LoadPath


class FollowedPath(NamedTuple):
    """A path on one mesh.

    Parameters
    ----------
    varied : the problem, condensed at the values that the path needs
    path : for t from 0 to 1
    start, end : values there
    """

    varied: Variation
    path: LoadPath
    start: float
    end: float

    def value(self, t: float) -> float:
        """The value at t."""
        return (1 - t) * self.start + t * self.end

    def state(self, t: float, solution: ContactSolution) -> tuple[Condensation, BoundaryState]:
        """The body at t with its contact problem, and its boundary.

        Between two condensations loads, and so displacements, change linearly.
        """
        varied, value, contact = self.varied, self.value(t), self.path.contact(t)
        p, a = solution.pressure, solution.rigid_amplitudes
        moves = varied.path[0] in ("load_cases", "contact_zones", "contacts")  # as a tool in the contact problem
        one = varied.condensed[min(varied.condensed)]
        body = replace(one.body, problem=varied.at(value)) if moves else one.body
        here = replace(one, body=body, contact=contact)
        if varied.acts_on_contact:
            return here, boundary_state(here, p, a)
        first, last = min(varied.condensed), max(varied.condensed)
        states = [boundary_state(varied.condensed[end], p, a) for end in (first, last)]
        share = (value - first) / (last - first)
        displacement = (1 - share) * states[0].displacement + share * states[1].displacement
        return here, replace(states[0], displacement=displacement)


def errors_at_breakpoints(
    coarse: FollowedPath, fine: FollowedPath, singular: Sequence[Singularity] | None, *, of_fine: bool
) -> Iterator[tuple[ErrorBar, ...]]:
    """Error bars at each breakpoint of one of two paths, on a mesh and on its halved elements; empty if not known.

    They are not where the other path does not reach. `singular` are infinite pressures that a search recognized; else
    those are taken that the two meshes show.
    """
    reported, other = (fine.path, coarse.path) if of_fine else (coarse.path, fine.path)
    runs = [tuple(zone_runs(next(iter(one.varied.condensed.values())).body)) for one in (coarse, fine)]
    for i, t in enumerate(reported.parameter.tolist()):
        if not other.begins_at <= t <= other.ends_at:
            yield ()
            continue
        both = [
            _solved(one, t, i if one.path is reported else None, its)
            for one, its in zip((coarse, fine), runs, strict=True)
        ]
        difference = MeshDifference(coarse=both[0], fine=both[1], number=0)
        its = recognized(difference) if singular is None else singular
        yield error_bars(difference, its, of_fine=of_fine)


def _solved(followed: FollowedPath, t: float, number: int | None, runs: tuple[ZoneRun, ...]) -> Solved:
    """The state at t, or at a breakpoint by its number."""
    solution = followed.path.at(t) if number is None else followed.path.breakpoint(number)
    condensation, state = followed.state(t, solution)
    return Solved(condensation=condensation, runs=runs, answers=(answer_of(condensation, solution, state, runs),))
