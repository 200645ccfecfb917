"""Meshes that find the ends of contact: solve, locate them, grade the contact zones towards them, and again."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bemcontact.arrays import Array
from bemcontact.assessment.footprint import ContactInterval, footprint
from bemcontact.bem.condense import body_of, condense
from bemcontact.bem.fitted_ends import Touched, fitted_ends, resolved
from bemcontact.bem.zone_runs import SAME, ZoneRun, zone_runs
from bemcontact.contact import CondensedContact
from bemcontact.errors import ProblemError, SingularSystemError
from bemcontact.formulations import complementarity
from bemcontact.mesh_fit import FitPass, MeshFit
from bemcontact.problem.problem import Problem
from bemcontact.solution import ContactSolution, Status

MOST_PASSES = 4
"""Meshes tried after the one that was stated."""
SETTLED = 0.2
"""Movement of an element end, over the shorter element beside it, that counts as none."""

ElementEnds = Mapping[str, tuple[float, ...]]
"""By the name of an edge, where its elements end, as `Problem.with_element_ends` takes them."""


PEAK = 0.01
"""Change of the peak pressure with the fitted mesh above which it says that the mesh does not settle it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Trial:
    """A problem with some element ends placed, and where its ends of contact ask for them, if that is known."""

    problem: Problem
    placed: ElementEnds
    intervals: tuple[ContactInterval, ...]
    asked: ElementEnds | None
    movement: float | None
    notes: tuple[str, ...]
    peak: float = 0.0

    @property
    def settled(self) -> bool:
        return self.movement is not None and self.movement <= SETTLED


def fitted(problem: Problem, progress: Callable[[str], object] | None = None) -> tuple[Problem, MeshFit | None]:
    """Fit the mesh to the ends of contact, if the problem asks for it.

    The complementarity problem is solved on the mesh as stated, the elements of each contact zone are placed anew by
    `fitted_ends`, and so on until no element end moves by more than a fifth of the shorter element beside it, four
    times at most. All this is done without `mesh.refine`, which then cuts the fitted elements: so finer meshes contain
    each other, an observed order means something, and fitting costs little. But the ends of contact are then those of
    the mesh that was cut: where they matter to many digits, state more elements instead.

    Parameters
    ----------
    problem : Problem
    progress : told which pass begins

    Returns
    -------
    Problem
        With the element ends stated, and no longer asking for a fit.
    MeshFit or None
        None if the problem did not ask for a fit.

    Raises
    ------
    ProblemError, SingularSystemError
        As of `bemcontact.condense`, on the mesh as stated.
    """
    if not problem.mesh.fit_contact_edges:
        return problem, None
    stated = problem if problem.mesh.refine == 1 else problem.with_value("mesh.refine", 1)
    trials, failed = _trials(stated, progress or (lambda _: None))
    kept = min(range(len(trials)), key=lambda number: _unrest(trials[number]))
    fit = MeshFit(
        passes=tuple(FitPass(intervals=trial.intervals, movement=trial.movement) for trial in trials),
        kept=kept,
        settled=trials[kept].settled and not trials[kept].notes,
        notes=(*_told(trials, kept), *failed, *dict.fromkeys(note for trial in trials for note in trial.notes)),
    )
    return problem.with_element_ends(trials[kept].placed), fit


def _unrest(trial: _Trial) -> float:
    """How far a mesh is from the one that it asks for."""
    return np.inf if trial.movement is None else trial.movement


def _trials(stated: Problem, progress: Callable[[str], object]) -> tuple[list[_Trial], list[str]]:
    """Try the mesh as stated, then what the trial before asks for, until one is settled; with notes on what failed."""
    progress("mesh as stated")
    trials = [_trial(stated, {})]
    while len(trials) <= MOST_PASSES and trials[-1].asked and not trials[-1].settled:
        progress(f"pass {len(trials)}")
        try:
            trials.append(_trial(stated, _next_ends(trials)))
        except (ProblemError, SingularSystemError) as error:
            return trials, [f"the mesh of pass {len(trials)} was given up: {error}"]
    return trials, []


def _next_ends(trials: Sequence[_Trial]) -> ElementEnds:
    """The element ends to try next: half-way to those asked for where the ends of contact only swing to and fro."""
    last = trials[-1]
    assert last.asked is not None
    if len(trials) < 3 or last.movement is None or last.movement < _unrest(trials[-2]) / 2:
        return last.asked
    present = {name: last.problem.edge(name).breakpoints()[1:-1] for name in last.asked}
    return {name: tuple(((present[name] + np.array(ends)) / 2).tolist()) for name, ends in last.asked.items()}


def _trial(stated: Problem, placed: ElementEnds) -> _Trial:
    """Solve a problem with some element ends placed, and find where its ends of contact ask for them."""
    problem = stated.with_element_ends(placed)
    body = body_of(problem)
    contact = condense(body).contact
    solution = complementarity.solve(contact)
    if solution.status is not Status.SOLVED:
        note = f"the mesh could not be fitted to a state of contact: {solution.status.value}"
        return _Trial(problem=problem, placed=placed, intervals=(), asked=None, movement=None, notes=(note,))
    intervals = footprint(contact, solution).intervals
    asked: dict[str, tuple[float, ...]] = {}
    movements: list[float | None] = [0.0]
    notes: list[str] = []
    for run in zone_runs(body):
        touched = resolved(run, [*_touched(run, contact, solution, intervals)])
        if not any(item.start_free or item.end_free for item in touched):
            continue
        ends = fitted_ends(run, touched)
        if ends is None:
            notes.append(_too_few(run))
            continue
        asked |= run.fractions(ends)
        movements.append(_movement(run, asked))
    movement = None if None in movements else max(filter(None, movements), default=0.0)
    return _Trial(
        problem=problem,
        placed=placed,
        intervals=intervals,
        asked=asked,
        movement=movement,
        notes=tuple(notes),
        peak=contact.peak(solution.pressure),
    )


def _touched(
    run: ZoneRun, contact: CondensedContact, solution: ContactSolution, intervals: Sequence[ContactInterval]
) -> Iterator[Touched]:
    """Stretches of contact on a run; an end is free unless contact goes on to the last point or to a corner."""
    on_run = np.flatnonzero(contact.run == run.number)
    touching = contact.touching(solution.pressure, solution.displacement)
    arcs = np.sort(contact.arc_position[on_run])
    arcs_touching = np.sort(contact.arc_position[on_run[touching[on_run]]])
    if run.closed:
        arcs_touching = np.concatenate([turn * run.arc[-1] + arcs_touching for turn in (-1, 0, 1, 2)])
    same = SAME * run.arc[-1]
    for interval in intervals:
        if interval.run != run.number or (run.closed and interval.end_arc - interval.start_arc >= run.arc[-1] - same):
            continue
        inside = arcs_touching[
            (arcs_touching >= interval.start_arc - same) & (arcs_touching <= interval.end_arc + same)
        ]
        first, last = float(inside[0]), float(inside[-1])
        start, start_free = _end(run, interval.start_arc, first, 0.0 if first == arcs[0] else None)
        end, end_free = _end(run, interval.end_arc, last, run.length if last == arcs[-1] else None)
        yield Touched(start=start, end=end, start_free=start_free, end_free=end_free)


def _end(run: ZoneRun, arc: float, outermost: float, limit: float | None) -> tuple[float, bool]:
    """Position of an end of contact, and whether it is free, from the outermost point that touches."""
    if limit is not None and not run.closed:
        return limit, False
    position = run.position(outermost)
    corners = run.joints[run.corner]
    turned = position % run.length if run.closed else position
    if corners.size and np.abs(corners - turned).min() <= SAME * 100 * run.length:
        return position, False
    return run.position(arc), True


def _movement(run: ZoneRun, asked: ElementEnds) -> float | None:
    """Largest movement of an element end of a run over the shorter element beside it; None if edges change count."""
    largest = 0.0
    for edge, old in zip(run.edges, run.breakpoints, strict=True):
        new = np.array([0.0, *asked[edge.name], 1.0])
        if len(new) != len(old):
            return None
        lengths = np.diff(old)
        beside = np.minimum(lengths[:-1], lengths[1:])
        largest = max(largest, float(np.max(np.abs(new - old)[1:-1] / beside, initial=0.0)))
    return largest


def _too_few(run: ZoneRun) -> str:
    return (
        f"the contact zone '{run.zone}' has too few elements to grade them towards its ends of contact: they were left "
        "as stated; give it more"
    )


def _told(trials: Sequence[_Trial], kept: int) -> Iterator[str]:
    """Say how many meshes it took, what moved, and what did not settle."""
    first, last = trials[0], trials[kept]
    if kept:
        moved = [*_moved(first.intervals, last.intervals)]
        finer = ", before it was refined" if last.problem.mesh.refine > 1 else ""
        yield "; ".join([f"mesh fitted to the ends of contact in {kept} pass{'es' * (kept > 1)}{finer}", *moved])
        if abs(last.peak - first.peak) > PEAK * first.peak:
            yield (
                f"the peak pressure went from {first.peak:.5g} to {last.peak:.5g} as the mesh was fitted: elements are "
                "too few or badly placed elsewhere in the zone or beside it; compare with finer meshes"
            )
        if not last.settled:
            still = f"the ends of contact still move by {last.movement:.1g} of an element from pass to pass"
            yield f"{still}; more elements in the zone settle them"
    elif first.asked:
        settled = "the mesh fits the ends of contact already"
        yield settled if first.settled else "the mesh was left as stated, for no fitted one came to rest"
    elif first.asked is not None and not first.notes:
        yield (
            "the mesh is as stated: contact ends at no place inside a zone that an element could be graded towards, as "
            "where it reaches the ends of its zone or is narrower than an element"
        )
    for number, (before, after) in enumerate(pairwise(trials), 1):
        if len(before.intervals) != len(after.intervals):
            counts = f"from {len(before.intervals)} to {len(after.intervals)}"
            yield f"the number of contact intervals changed {counts} with the mesh of pass {number}"


def _moved(before: Sequence[ContactInterval], after: Sequence[ContactInterval]) -> Iterator[str]:
    """Say from where to where each end of contact moved, where the intervals are still the same."""
    if [item.zone for item in before] != [item.zone for item in after]:
        return
    for old, new in zip(before, after, strict=True):
        for which, start, end in (("start", old.start, new.start), ("end", old.end, new.end)):
            if start != end:
                yield f"{which} of contact in {old.zone} moved from {_point(start)} to {_point(end)}"


def _point(point: Array | tuple[float, float]) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"
