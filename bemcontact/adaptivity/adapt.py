"""A mesh that nobody makes: solve, bisect, compare, and refine until the error bars are below the accuracy asked."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.adaptivity.coarse_mesh import CoarseMesh, unknown
from bemcontact.adaptivity.error_bars import SAFETY, error_bars, why_unresolved
from bemcontact.adaptivity.fields import CaseAnswer, MeshDifference, Solved, solved, solved_state
from bemcontact.adaptivity.hidden_changes import told_apart
from bemcontact.adaptivity.mesh_search import MeshSearch
from bemcontact.adaptivity.mesh_sizes import MOST_UNKNOWNS, cut
from bemcontact.adaptivity.resting_contacts import (
    MOST_STEPS,
    after_motion,
    has_cases,
    matters,
    may_move,
    with_resting_contacts,
)
from bemcontact.adaptivity.singularities import Singularity, recognized
from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.bem.condense import Condensation, Condenser, condensed
from bemcontact.errors import ProblemError, SingularSystemError, SolverError
from bemcontact.frozen import frozen
from bemcontact.problems.problem import ACCURACY, Problem

NONE_ASKED = "no accuracy is asked for, and errors are not estimated"
NOT_ESTIMATED = "the errors of this mesh were not estimated"
NOT_COMPARED = "this mesh is too coarse to tell its own error, and no mesh was found to compare it with"
MOST_PASSES, PASSES_TO_COMPARE = 14, 4
"""Largest number of passes for an answer, and for a mesh beside a stated one."""
HOPELESS, STALLED = 1.0, 4
"""Error that ends the search where it did not halve, and the passes that it had for that."""
MOST_FAILURES = 3
"""Number of first meshes that may have no contact state."""
ROUNDED = 100 * float(np.finfo(float).eps)
"""Deformation over the largest coordinate or displacement, below which gaps are round-off."""


@frozen
class Meshed:
    """A problem on the mesh that was found for it or stated, condensed, with the accuracy under each load case."""

    problem: Problem
    condensation: Condensation
    accuracies: tuple[Accuracy, ...]
    singular: tuple[tuple[Singularity, ...], ...] = ()
    """Infinite pressures that the search recognized, under each load case; empty for a stated mesh."""
    answers: tuple[CaseAnswer, ...] = ()
    """Answers of the direct solver on this mesh under each load case, whose errors are those above; else empty."""

    @property
    def worst(self) -> float:
        """Largest error bar under any load case."""
        return max(item.worst for item in self.accuracies)

    def because(self, reason: str) -> "Meshed":
        """Return a copy that says why no better accuracy was reached."""
        return replace(self, accuracies=tuple(replace(item, reason=reason) for item in self.accuracies))


def meshed(
    problem: Problem,
    progress: Callable[[str], object] | None = None,
    *,
    errors: bool = True,
    singular: Sequence[Sequence[Singularity]] = (),
    halved: bool = False,
) -> Meshed:
    """Condense a problem on the mesh that it states, or on one that is found for the accuracy asked.

    A found mesh is cut as `problem.mesh.refine` says. The errors of a stated mesh and of a cut one are estimated,
    unless no accuracy is asked for or `errors` is false: from its elements halved, or if those of a stated mesh are
    `halved` ones, as on a mesh that was found, from these. `singular` are infinite pressures under each load case that
    the search for another mesh of the problem recognized.

    Raises
    ------
    ProblemError
        If the problem has no answer.
    SingularSystemError
        If the equations of the body have no unique solution.
    """
    if not problem.adapts:
        return stated(problem, progress, errors=errors, singular=singular, halved=halved)
    progress = progress or (lambda _: None)
    found = _found(cut(problem, 1), progress)
    if problem.mesh.refine == 1:
        return found
    refined = found.problem.refined(problem.mesh.refine).on_contacts_of(found.problem)
    finer = stated(refined, progress, errors=errors, singular=found.singular)
    known = tuple(mine.knowing(its) for mine, its in zip(finer.accuracies, found.accuracies, strict=True))
    return replace(finer, accuracies=known, singular=found.singular)


def stated(
    problem: Problem,
    progress: Callable[[str], object] | None = None,
    *,
    errors: bool = True,
    singular: Sequence[Sequence[Singularity]] = (),
    halved: bool = False,
    condenser: Condenser = condensed,
) -> Meshed:
    """Condense a problem on its mesh, and estimate the errors from a mesh with elements twice or half as long.

    Parameters and errors are those of `meshed`; `condenser` condenses the problem on both meshes.
    """
    asked, refine, progress = problem.asked_accuracy, problem.mesh.refine, progress or (lambda _: None)
    reason = NONE_ASKED if asked is None else NOT_ESTIMATED
    progress("mesh as stated")
    condensation, judged = condenser(problem), errors and asked is not None
    if not judged and not (may_move(problem) and (errors or not has_cases(problem))):
        return _unsolved(problem, condensation, asked, reason)
    try:
        own = with_resting_contacts(solved_state(condensation), condenser)
    except SolverError as error:
        return _unsolved(problem, condensation, asked, str(error) if judged else reason)
    problem = own.body.problem
    if asked is None or not judged:
        return _unsolved(problem, own.condensation, asked, reason)
    try:
        unknowns = 2 * own.counted_unknowns
        if not halved and unknowns > MOST_UNKNOWNS:
            raise ProblemError(f"a mesh of half the elements' size has {unknowns} unknowns, more than {MOST_UNKNOWNS}")
        progress("every two elements in one" if halved else "every element in two")
        other = solved_state(condenser(cut(problem, refine // 2 if halved else 2 * refine)))
        coarse, fine = (other, own) if halved else (own, other)
        differences = _differences(coarse, fine, asked)
        singular = singular or tuple(map(recognized, differences))
        bars = [error_bars(item, its, of_fine=halved) for item, its in zip(differences, singular, strict=True)]
        if not halved and not all(_tells_its_error(item) for item in differences):
            bars = _compared(own, bars, progress)
        accuracies = [Accuracy.of(asked, 1, its) for its in bars]
    except (ProblemError, SingularSystemError, SolverError) as error:
        accuracies = [Accuracy(asked=asked, reason=str(error).splitlines()[0])] * len(own.answers)
    return Meshed(problem=problem, condensation=own.condensation, accuracies=tuple(accuracies), answers=own.answers)


def _tells_its_error(difference: MeshDifference) -> bool:
    """Whether bisecting a stated mesh tells its error; without contact a coarse one looks better than it is."""
    return not why_unresolved(difference, of_fine=False) and bool(difference.pair[0].pressure.any())


def _compared(
    own: Solved, bars: Sequence[Sequence[ErrorBar]], progress: Callable[[str], object]
) -> list[tuple[ErrorBar, ...]]:
    """Error bars under each load case of a mesh that is too coarse to tell them, from a mesh that is found."""
    problem = own.body.problem
    wanted = problem.to_be_meshed(max(problem.asked_accuracy or 0.0, ACCURACY))
    try:
        found = _found(wanted, lambda words: progress(f"to compare with: {words}"), PASSES_TO_COMPARE)
        finer = solved(found.problem)
    except (ProblemError, SingularSystemError, SolverError):
        return [tuple(unknown(item, NOT_COMPARED) for item in own_bars) for own_bars in bars]
    known = enumerate(zip(bars, found.accuracies, strict=True))
    return [CoarseMesh(own=own, finer=finer, number=i, known=its.bars).bars(stated) for i, (stated, its) in known]


def _differences(coarse: Solved, fine: Solved, asked: float) -> list[MeshDifference]:
    """What bisecting every element changes under each load case, with the parts of forces that may hide errors."""
    pairs = [MeshDifference(coarse=coarse, fine=fine, number=i) for i in range(len(fine.answers))]
    return told_apart(pairs, asked / SAFETY)


def _found(problem: Problem, progress: Callable[[str], object], passes: int = MOST_PASSES) -> Meshed:
    """Find a mesh on which all error bars are below the accuracy asked, and solve on it."""
    asked = problem.asked_accuracy
    assert asked is not None
    search = MeshSearch.of(problem)
    best: Meshed | None = None
    steps, moved = MOST_STEPS, False
    errors: list[float] = []
    reason = f"no better mesh was found in {passes} passes"
    for number in range(1, passes + 1):
        start = f"pass {number}" + (f", error at most {100 * best.worst:.2g} %" if best else "")
        try:

            def tell(unknowns: int, start: str = start) -> None:
                progress(f"{start}, {unknowns} unknowns")

            coarse = search.fitted(MOST_UNKNOWNS, tell)
            if number == 1 and (there := with_resting_contacts(coarse, condensed)) is not coarse:
                if search.goes_on_with(there):
                    coarse = there
                else:
                    search = MeshSearch.fitted_to(problem.on_contacts_of(there.body.problem), there)
                    coarse = search.fitted(MOST_UNKNOWNS, tell)
            elif number == 1 and after_motion(coarse)[1]:
                steps = 0  # contacts never come to rest
            if 2 * coarse.counted_unknowns > MOST_UNKNOWNS:
                reason = f"a finer mesh would have more than {MOST_UNKNOWNS} unknowns"
                break
            progress(f"{start}, {2 * coarse.degrees_of_freedom} unknowns")
            fine = search.bisected(coarse)
        except SolverError as error:
            reason = str(error)
            if best is not None or number > MOST_FAILURES:
                break
            search.halve()
            continue
        except (ProblemError, SingularSystemError) as error:
            if best is None:
                raise
            reason = str(error).splitlines()[0]
            break
        differences = _differences(coarse, fine, asked)
        singular = [search.watch.look(item) for item in differences]
        bars = [error_bars(item, its, searched=True) for item, its in zip(differences, singular, strict=True)]
        now = Meshed(
            problem=fine.body.problem,
            condensation=fine.condensation,
            accuracies=tuple(Accuracy.of(asked, number, its) for its in bars),
            singular=tuple(map(tuple, singular)),
            answers=fine.answers,
        )
        progress(f"pass {number}, {fine.degrees_of_freedom} unknowns, error at most {100 * now.worst:.2g} %")
        best = now if best is None or moved or now.worst <= best.worst else best
        resting, change = after_motion(fine) if steps else (problem, 0.0)
        if all(item.met for item in best.accuracies) and not matters(problem, change):
            return best
        if moved := change > 0:
            search.move(resting)
            steps -= 1
        if lost := _lost_digits(fine):
            reason = lost
            break
        errors.append(now.worst)
        if best.worst > HOPELESS and len(errors) > STALLED and best.worst > errors[-1 - STALLED] / 2:
            reason = f"the error did not halve in {STALLED} passes"
            break
        search.layers = search.with_counts(search.ends_of_contact(fine)[0])
        search.refine(differences, singular)
    if best is None:
        coarsest = search.mesh()
        return _unsolved(coarsest, condensed(coarsest), asked, reason)
    return best.because(reason)


def _lost_digits(answer: Solved) -> str | None:
    """Say that contact deforms the body by less than the rounding of its coordinates and displacements."""
    modulus = min(part.material.young_modulus for part in answer.body.problem.parts)
    for item in answer.answers:
        deformed = float(item.condensation.contact.weights @ item.solution.pressure) / modulus
        largest = float(max(np.abs(answer.mesh.nodes).max(), np.abs(item.displacement).max()))
        if 0 < deformed < ROUNDED * largest:
            return (
                f"contact deforms the body by about {deformed:.1g}, which is lost in the rounding of coordinates and "
                f"displacements of up to {largest:.3g}, on any mesh; check loads, lengths and Young's modulus"
            )
    return None


def _unsolved(problem: Problem, condensation: Condensation, asked: float | None, reason: str) -> Meshed:
    """A problem on a mesh whose errors were not estimated, for a reason."""
    count = 1 if problem.case is not None else max(1, len(problem.case_names))
    accuracies = (Accuracy(asked=asked, reason=reason),) * count
    return Meshed(problem=problem, condensation=condensation, accuracies=accuracies)
