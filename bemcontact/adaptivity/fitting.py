"""Mesh fitting: solve, locate the ends of contact, grade the contact zones towards them, and repeat."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from bemcontact.adaptivity.fitted_ends import fitted_ends, half_way, halved, movement, resolved
from bemcontact.adaptivity.oscillation import oscillation
from bemcontact.adaptivity.zone_runs import Stretch, ZoneRun, contact_stretches, zone_runs
from bemcontact.arrays import Array
from bemcontact.assessment.footprint import ContactInterval, footprint
from bemcontact.bem.body import Body, body_of
from bemcontact.bem.condense import condense
from bemcontact.contact.solution import Status
from bemcontact.errors import ProblemError, SingularSystemError
from bemcontact.formulations import complementarity
from bemcontact.problem.curves import Edge
from bemcontact.problem.problem import Problem
from bemcontact.serialization import Internal, Leaf


@dataclass(frozen=True, kw_only=True)
class FitPass(Leaf):
    """One pass of the mesh fit: a mesh and the contact on it."""

    intervals: tuple[ContactInterval, ...]
    """Contact intervals on this mesh."""
    movement: float | None
    """Largest distance of an end of contact from where the mesh is graded to, over the shorter element there.

    Null if the mesh is not graded to these ends of contact, as the first one mostly is not.
    """


@dataclass(frozen=True, kw_only=True)
class MeshFit(Leaf):
    """How a mesh was fitted to the ends of contact."""

    passes: tuple[FitPass, ...]
    """The mesh as it is stated, then each fitted one."""
    kept: int
    """Number of the pass whose mesh was kept; 0 is the mesh as it is stated."""
    settled: bool
    """Whether the ends of contact on it are those that it is fitted to, and no contact is narrower than an element."""
    notes: Internal[tuple[str, ...]]
    """What was done, in words."""


MOST_PASSES = 8
"""Meshes tried after the one that was stated."""
SETTLED = 0.2
"""Movement of an end of contact, over the shorter element there, up to which a mesh is settled."""
SWING = 5.0
"""Movement above which an end of contact does not alternate between two places, but still travels."""
OSCILLATION = 0.01
"""Oscillation of the pressure above which a fitted mesh is rejected, if it is larger than on the mesh as stated."""
OSCILLATION_UNKNOWN = 0.05
"""The limit if the mesh as stated has too few points to measure: twice the amplitude beside an infinite pressure."""
CHANGE = 0.01
"""Relative change of the peak pressure, or of the force on a zone, from which a note reports it."""

ElementEnds = Mapping[str, tuple[float, ...]]
"""By the name of an edge, where its elements end, as `Problem.with_element_ends` takes them."""
Stretches = Mapping[int, tuple[Stretch, ...]]
"""By the number of a run, its stretches of contact, of which one end at least is free."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Trial:
    """A mesh with some element ends placed, and where contact is on it, if that is known."""

    placed: ElementEnds
    elements: int = 0
    intervals: tuple[ContactInterval, ...] = ()
    fitted_to: Stretches = field(default_factory=dict)
    stretches: Stretches = field(default_factory=dict)
    movement: float | None = None
    narrow: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    oscillation: float | None = None
    peak: float = 0.0
    forces: Mapping[str, float] = field(default_factory=dict)

    @property
    def settled(self) -> bool:
        return self.movement is not None and self.movement <= SETTLED and not self.narrow


def fitted(problem: Problem, progress: Callable[[str], object] | None = None) -> tuple[Problem, MeshFit | None]:
    """Fit the mesh to the ends of contact, if the problem asks for it; the second value is None if it does not.

    The complementarity problem is solved on the mesh as stated. `fitted_ends` then places the elements of each contact
    zone anew. Both steps are repeated, eight times at most, until no end of contact moves by more than a fifth of the
    shorter element beside it. Elements beside a zone are halved until they are at most twice as long as the element at
    its end. A mesh is not kept if the pressure oscillates on it and did not on the mesh as stated.

    `mesh.refine` is not applied meanwhile: it cuts the fitted elements afterwards. Finer meshes then contain each
    other, observed orders are meaningful, and fitting costs little. But the ends of contact are those of the mesh that
    was cut. If they matter to many digits, state more elements instead.

    The fitted problem has the element ends stated, and does not ask for a fit. The errors are those of
    `bemcontact.condense` on the mesh as stated. `progress` is called with the name of each pass.
    """
    if not problem.mesh.fit_contact_edges:
        return problem, None
    refine = problem.mesh.refine
    stated = problem if refine == 1 else problem.with_value("mesh.refine", 1)
    trials, failed = _trials(stated, progress or (lambda _: None))
    kept = min(
        (i for i, trial in enumerate(trials) if not _oscillates(trial, trials[0])), key=lambda i: _unrest(trials[i])
    )
    fit = MeshFit(
        passes=tuple(FitPass(intervals=trial.intervals, movement=trial.movement) for trial in trials),
        kept=kept,
        settled=trials[kept].settled and not trials[kept].notes,
        notes=(
            *_notes(trials, kept, refine),
            *failed,
            *dict.fromkeys(note for trial in trials for note in trial.notes),
        ),
    )
    return problem.with_element_ends(trials[kept].placed), fit


def _unrest(trial: _Trial) -> float:
    """Movement of the ends of contact on a mesh; infinite if unknown."""
    return np.inf if trial.movement is None else trial.movement


def _oscillates(trial: _Trial, first: _Trial) -> bool:
    """Whether the pressure oscillates on a mesh, and more than on the first one, or much if that has too few points."""
    if trial.oscillation is None:
        return False
    return trial.oscillation > (
        OSCILLATION_UNKNOWN if first.oscillation is None else max(OSCILLATION, first.oscillation)
    )


def _trials(stated: Problem, progress: Callable[[str], object]) -> tuple[list[_Trial], list[str]]:
    """Try the mesh as stated, then meshes fitted to the previous trial, until one settles; with notes on failures."""
    progress("mesh as stated")
    body = body_of(stated)
    runs = {run.number: run for run in zone_runs(body)}
    trials = [_trial(body, {}, runs, None)]
    while len(trials) <= MOST_PASSES and trials[-1].stretches and not trials[-1].settled:
        progress(f"pass {len(trials)}")
        try:
            aim = _aim(runs, trials)
            placed = _placed(runs, aim)
            trials.append(_trial(body_of(stated.with_element_ends(placed)), placed, runs, aim))
        except (ProblemError, SingularSystemError) as error:
            return trials, [f"the mesh of pass {len(trials)} was given up: {str(error).splitlines()[0]}"]
    return trials, []


def _aim(stated: Mapping[int, ZoneRun], trials: Sequence[_Trial]) -> Stretches:
    """Stretches of contact for the next mesh; half-way to the computed ones if the ends of contact only alternate."""
    last = trials[-1]
    if len(trials) < 3 or last.narrow or not _unrest(trials[-2]) / 2 <= _unrest(last) <= SWING:
        return last.stretches
    return {
        number: half_way(stated[number], last.fitted_to.get(number, ()), stretches)
        for number, stretches in last.stretches.items()
    }


def _placed(stated: Mapping[int, ZoneRun], aim: Stretches) -> ElementEnds:
    """Element ends of the runs on which contact ends, and of edges beside them that have long elements there."""
    placed: dict[str, tuple[float, ...]] = {}
    for number, stretches in aim.items():
        placed |= stated[number].fractions(fitted_ends(stated[number], stretches))
    for run in (stated[number] for number in aim):
        for edge, own, at in zip(run.beside, (run.edges[0], run.edges[-1]), (-1, 0), strict=False):
            inside, outside = _breakpoints(own, placed), _breakpoints(edge, placed)
            finer = halved(outside, np.diff(inside)[-1 - at] * own.length / edge.length, at)
            if len(finer) > len(outside):
                placed[edge.name] = tuple(finer[1:-1].tolist())
    return placed


def _breakpoints(edge: Edge, placed: ElementEnds) -> Array:
    """Fractions of the length of an edge where its elements begin and end."""
    return np.array([0.0, *placed[edge.name], 1.0]) if edge.name in placed else edge.breakpoints()


def _trial(body: Body, placed: ElementEnds, stated: Mapping[int, ZoneRun], fitted_to: Stretches | None) -> _Trial:
    """Solve a problem with some element ends placed, and find where contact ends."""
    contact = condense(body).contact
    solution = complementarity.solve(contact)
    if solution.status is not Status.SOLVED:
        note = f"the mesh could not be fitted to a state of contact: {solution.status.words}"
        return _Trial(placed=placed, notes=(note,))
    intervals = footprint(contact, solution).intervals
    by_run: dict[int, tuple[Stretch, ...]] = {}
    movements: list[float | None] = [0.0]
    narrow: list[str] = []
    for run in zone_runs(body):
        here = [*contact_stretches(run, contact, solution, intervals)]
        narrow += [run.zone for one in here if one.narrow]
        stretches = resolved(stated[run.number], here)
        if any(item.start_free or item.end_free for item in stretches):
            by_run[run.number] = stretches
        movements.append(movement(run, stretches, None if fitted_to is None else fitted_to.get(run.number, ())))
    forces = np.bincount(contact.zone, contact.weights * solution.pressure, len(contact.zone_names))
    return _Trial(
        placed=placed,
        elements=len(body.mesh.elements),
        intervals=intervals,
        fitted_to=fitted_to or {},
        stretches=by_run,
        movement=None if None in movements else max(filter(None, movements), default=0.0),
        narrow=tuple(dict.fromkeys(narrow)),
        oscillation=oscillation(contact, solution.pressure),
        peak=contact.peak(solution.pressure),
        forces=dict(zip(contact.zone_names, forces.tolist(), strict=True)),
    )


def _notes(trials: Sequence[_Trial], kept: int, refine: int) -> Iterator[str]:
    """Notes on the number of meshes, on what moved, and on what did not settle."""
    yield from _fit_notes(trials[0], trials[kept], kept, refine) if kept else _no_fit_notes(trials)
    for zone in trials[kept].narrow:
        yield f"contact in {zone} is narrower than an element: its pressure and its width are those of the mesh"
    for number, (before, after) in enumerate(pairwise(trials), 1):
        if len(before.intervals) != len(after.intervals):
            counts = f"from {len(before.intervals)} to {len(after.intervals)}"
            yield f"the number of contact intervals changed {counts} with the mesh of pass {number}"


def _fit_notes(first: _Trial, last: _Trial, passes: int, refine: int) -> Iterator[str]:
    """Notes on a fitted mesh."""
    cut = f", before each was cut into {refine}" if refine > 1 else ""
    elements = f"it has {last.elements} elements where {first.elements} were stated{cut}"
    done = f"mesh fitted to the ends of contact in {passes} pass{'es' * (passes > 1)}"
    yield "; ".join([done, elements, *_moved(first.intervals, last.intervals)])
    yield from _changed(first, last)
    if last.movement is not None and last.movement > SETTLED:
        still = f"the ends of contact still move by {last.movement:.2g} of an element from pass to pass{cut}"
        yield f"{still}; state more elements in the zone{', not a finer cut' * (refine > 1)}"


def _no_fit_notes(trials: Sequence[_Trial]) -> Iterator[str]:
    """Notes on why the mesh is as stated."""
    first, largest = trials[0], max(trial.oscillation or 0.0 for trial in trials)
    if first.settled and first.stretches:
        yield "the mesh fits the ends of contact already"
    elif first.stretches and any(_oscillates(trial, first) for trial in trials):
        yield (
            "the mesh was left as stated: on fitted meshes the pressure oscillates from point to point by "
            f"{largest:.2g} of the peak, as where contact ends near a tip; grade the elements towards the tip, and "
            "state more of them"
        )
    elif first.stretches:
        yield "the mesh was left as stated, because the ends of contact did not settle on any fitted mesh"
    elif not first.notes and not first.intervals:
        yield "the mesh is as stated, because nothing touches"
    elif not first.notes:
        yield (
            "the mesh is as stated: contact ends at no place inside a zone towards which elements could be graded, for "
            "example because it reaches the ends of its zone"
        )


def _changed(first: _Trial, last: _Trial) -> Iterator[str]:
    """Notes on a peak pressure, or a force on a zone, that differs on the fitted mesh."""
    pairs = {"peak pressure": (first.peak, last.peak)}
    pairs |= {f"force on {zone}": (force, last.forces[zone]) for zone, force in first.forces.items()}
    for name, (before, after) in pairs.items():
        if abs(after - before) > CHANGE * before:
            yield (
                f"the {name} changed from {before:.5g} to {after:.5g} when the mesh was fitted: at least one mesh is "
                "too coarse for it; compare with finer meshes"
            )


def _moved(before: Sequence[ContactInterval], after: Sequence[ContactInterval]) -> Iterator[str]:
    """Notes on how far each end of contact moved, if the intervals are still the same."""
    if [item.zone for item in before] != [item.zone for item in after]:
        return
    for old, new in zip(before, after, strict=True):
        for which, start, end in (("start", old.start, new.start), ("end", old.end, new.end)):
            if start != end:
                yield f"{which} of contact in {old.zone} moved from {_point(start)} to {_point(end)}"


def _point(point: Array | tuple[float, float]) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"
