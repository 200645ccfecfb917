"""The local solver on QP1 and QP2: its start, its search for a minimum, and whether the end is the contact state."""

import json
import os
from dataclasses import dataclass, replace
from itertools import groupby
from math import isfinite
from pathlib import Path

import numpy as np

from bemcontact.arrays import Array, real_array
from bemcontact.checks.arguments import label
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution, LocalSearch, Penalty, Status, Trace, traces_in_turn
from bemcontact.errors import OptionError, ProblemError, SpecError, escaped
from bemcontact.files.text import text_of
from bemcontact.formulations.complementarity import escape_note, polish
from bemcontact.formulations.local_solver import QPResult, QPStatus
from bemcontact.formulations.program import Program, minimize_program
from bemcontact.formulations.scaling import scale, scaled_point, unscaled
from bemcontact.options import STARTS, SolveOptions, StartName, Weights, ensure_whole

RESULTS = "a JSON file that `bemcontact solve --json FILE` has written"
"""What to name where a start is read."""
SPREAD = 2.0
"""Largest random pressure over T, and size of a random displacement over U."""
SOLUTION = 1e-8
"""Residual up to which the end of a search counts as the contact state: searches that go well leave 1e-10 and less."""
ZERO = 1e-6
"""Scaled objective that a solver's tolerance may leave where the best value is 0: large errors may hide behind it."""
STATIONARY = "stationary but not the solution, with an objective of {:.1e} (scaled) and not 0"
NEAR = "not the solution, but its objective, {:.1e} (scaled), is 0 within the tolerance of the solver"
LOST = "not the solution, although round-off makes it look stationary, with an objective of {:.1e} (scaled) and not 0"
BIASED = (
    "not the solution, with an objective of {:.1e} (scaled): consistent weights have negative entries, so that the "
    "least objective lies below 0 and off the solution, and an objective of 0 certifies nothing"
)
"""Descriptions of points where a search ended, with their objectives."""
POLISHED = (Status.SOLVED, Status.NO_SOLUTION_FOUND, Status.NUMERICAL_FAILURE)
"""Ends from which the polish is tried."""
NO_CONTACT_STATE = (
    "equations and bounds contradict each other: no pressure p >= 0 leaves a gap >= 0 at all contact points, so that "
    "no contact state exists, whatever the formulation"
)
SOLVER = "inertia-controlling active set"
QUANTITIES = {1: "infeasibility", 2: "objective"}
"""What each phase of the solver reduces."""
STATUSES = {
    QPStatus.LOCAL_MINIMIZER: Status.SOLVED,
    QPStatus.UNDECIDED: Status.SOLVED,
    QPStatus.UNBOUNDED: Status.UNBOUNDED,
    QPStatus.INFEASIBLE: Status.INFEASIBLE,
    QPStatus.ITERATION_LIMIT: Status.ITERATION_LIMIT,
    QPStatus.NUMERICAL_FAILURE: Status.NUMERICAL_FAILURE,
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """Where a local solver starts, in the user's units.

    Parameters
    ----------
    pressure : (n,) p [p]
    displacement : (n,) u_n [L]
    label : what reports call it
    """

    pressure: Array
    displacement: Array
    label: str = "given point"

    def __post_init__(self) -> None:
        """Refuse all but two equally long vectors of finite numbers; make them read-only."""
        for name in ("pressure", "displacement"):
            try:
                vector = np.atleast_1d(real_array(getattr(self, name), f"the {name} of a start")).copy()
            except ProblemError as error:
                raise OptionError(f"{error}; give finite numbers, one for each contact point") from None
            if vector.ndim != 1:
                raise OptionError(f"the {name} of a start needs finite numbers, one for each contact point")
            vector.setflags(write=False)
            object.__setattr__(self, name, vector)
        if self.pressure.shape != self.displacement.shape:
            raise OptionError(
                f"a start needs one pressure and one displacement for each contact point; found {self.pressure.size} "
                f"pressures and {self.displacement.size} displacements"
            )
        label(self.label, "the label of a start")


def read_start(path: str | os.PathLike[str]) -> Start:
    """Read a start from a file that `bemcontact solve --json` wrote; `SpecError` says what is wrong with it."""
    if os.fspath(path) == "-":
        raise SpecError(f"-: a start is not read from standard input; name {RESULTS}")
    name, text = escaped(os.fspath(path)), text_of(path, RESULTS)
    try:
        record = json.loads(text, parse_int=float)
    except json.JSONDecodeError as error:
        raise SpecError(f"{name}:{error.lineno}:{error.colno}: is no JSON ({error.msg}); name {RESULTS}") from None
    except RecursionError:
        raise SpecError(f"{name}: has too many nested brackets; name {RESULTS}") from None
    lists = []
    for key in ("pressure", "normal_displacement"):
        values = record.get(key) if isinstance(record, dict) else None
        if not isinstance(values, list) or not all(type(value) is float and isfinite(value) for value in values):
            raise SpecError(f"{name}: has no list '{key}' of numbers, one for each contact point; name {RESULTS}")
        lists.append(np.array(values))
    try:
        return Start(pressure=lists[0], displacement=lists[1], label=f"file {escaped(Path(path).name)}")
    except OptionError as error:
        raise SpecError(f"{name}: {error}") from None


def with_start_read(options: SolveOptions) -> SolveOptions:
    """Options with the start that its file contains."""
    return replace(options, start=read_start(options.start)) if isinstance(options.start, os.PathLike) else options


def start_of(contact: CondensedContact, options: SolveOptions) -> Start | None:
    """The start that options ask for, the first of several random ones; None is the null vector."""
    if options.is_random:
        return draw_starts(contact, 1, options.seed or 0)[0]
    given = with_start_read(options).start
    if given is None or isinstance(given, StartName | os.PathLike):
        return None
    if (size := np.size(given.pressure)) != contact.size:
        raise OptionError(
            f"the start has {size} contact points and the problem {contact.size}; give one pressure and one "
            "displacement for each, in the order of the problem's points"
        )
    return Start(pressure=given.pressure, displacement=given.displacement, label=given.label)


def draw_starts(contact: CondensedContact, count: int, seed: int = 0) -> tuple[Start, ...]:
    """Draw starts: pressures even in [0, 2T], displacements normal with deviation 2U, the body moved likewise.

    The same seed gives the same starts, in any units, and fewer starts are the first of more. `OptionError` for a count
    below 1, a negative seed, or numbers that are not whole.
    """
    ensure_whole(count, STARTS, 1)
    ensure_whole(seed, "seed", 0)
    rng = np.random.default_rng(seed)
    U, T = contact.scales
    motions = contact.rigid_motions / np.abs(contact.rigid_motions).max(axis=0, initial=0.0)
    starts = []
    for number in range(count):
        pressure = rng.uniform(0.0, SPREAD, contact.size)
        displacement = SPREAD * (rng.standard_normal(contact.size) + motions @ rng.standard_normal(motions.shape[1]))
        label = f"random point {number}, seed {seed}"
        starts.append(Start(pressure=pressure * T, displacement=displacement * U, label=label))
    return tuple(starts)


def start_vector(contact: CondensedContact, start: Start | None, size: int) -> Array:
    """A start as x of `size` entries: u_n/U, p/T, and the amplitudes that fit them best; None is the null vector."""
    x = np.zeros(size)
    if start is None:
        return x
    n = contact.size
    p, a = scaled_point(contact, start.pressure, amplitudes(contact, start.pressure, start.displacement))
    x[:n], x[n : 2 * n] = start.displacement / contact.scales.displacement, p
    x[2 * n :] = a[: size - 2 * n]
    return x


def amplitudes(contact: CondensedContact, pressure: Array, displacement: Array) -> Array:
    """The a (k,) with which u_n = Δ1 + M p + R a comes closest, in the least squares of the weights."""
    return contact.amplitudes_of(displacement - contact.free_displacement - contact.compliance @ pressure)


def searched(
    contact: CondensedContact,
    options: SolveOptions,
    program: Program,
    *,
    only: bool,
    penalty: Penalty | None = None,
) -> ContactSolution:
    """Solve a program and assess its end by its residual, not by the status of the solver.

    With weights that are not negative the least value is zero, attained at the contact state alone. An end elsewhere is
    a local minimum, or due to round-off if there is none (`only`). The displacement of the solution is the
    solver's own u_n. The penalty is reported with the search.
    """
    start = start_of(contact, options)
    result = minimize_program(program, start_vector(contact, start, len(program.linear)), options.max_iterations)
    solution = _solution(contact, options.formulation, result, _search(start, program, result, penalty))
    residual, objective = contact_residual(contact, solution), program.value(result.x)
    if solution.status is not Status.SOLVED or residual <= SOLUTION:
        return solution
    if options.weights is Weights.CONSISTENT:
        status, what = Status.LOCAL_MINIMUM, BIASED
    elif objective * max(1.0, program.penalty) <= ZERO:  # times μ it is the residual of the equations, squared
        status, what = Status.NO_SOLUTION_FOUND, NEAR
    else:
        status, what = (Status.NUMERICAL_FAILURE, LOST) if only else (Status.LOCAL_MINIMUM, STATIONARY)
    note = (
        f"{options.formulation.upper()} ended at a point where contact conditions and equations are violated by "
        f"{residual:.1e} of their scales; it is {what.format(objective)}"
    )
    return replace(solution, status=status, notes=(*solution.notes, note))


def polished(contact: CondensedContact, options: SolveOptions, solution: ContactSolution) -> ContactSolution:
    """Polish a solution where that is asked for and useful; an end that round-off has spoilt may become the solution.

    These are left as they are: a true minimum elsewhere, a search that was cut short or proved that there is no
    solution, and a solution with consistent weights.
    """
    if not options.polish or options.weights is Weights.CONSISTENT or solution.status not in POLISHED:
        return solution
    better = polish(contact, solution)
    if solution.status is Status.SOLVED or contact_residual(contact, better) > SOLUTION:
        return better
    return replace(better, status=Status.SOLVED, notes=(*better.notes, "the polish led from there to the solution"))


def contact_residual(contact: CondensedContact, solution: ContactSolution) -> float:
    """Largest of |min(p/T, δ/U)|, of (12) over U and of |ℓᵀp + load| over T Σ|ℓ|, over the size of the numbers."""
    scaled = scale(contact)
    p, a = scaled_point(contact, solution.pressure, solution.rigid_amplitudes)
    residual = solution.displacement - unscaled(contact, p, a)[1]
    size = 1.0 + float(np.abs(p).max(initial=0.0) + np.abs(a).sum())
    return max(scaled.residual(p, a), float(np.abs(residual).max()) / contact.scales.displacement / size)


def ray_in_words(contact: CondensedContact, ray: Array) -> str:
    """Name the contact points whose pressure or displacement grows most along a ray (N,)."""
    n = contact.size
    displacement, pressure = ray[:n], ray[n : 2 * n]
    terms = []
    for name, part in (("pressure", pressure), ("normal displacement", displacement)):
        if (i := int(np.argmax(np.abs(part)))) < n and part[i]:
            x, y = contact.points[i]
            terms.append(f"{name} {'grows' if part[i] > 0 else 'falls'} at contact point {i} ({x:.5g}, {y:.5g})")
    return " while ".join(terms) or "the body moves rigidly"


def _search(start: Start | None, program: Program, result: QPResult, penalty: Penalty | None) -> LocalSearch:
    """The report of a search."""
    return LocalSearch(
        start="null vector" if start is None else start.label,
        phase_one_iterations=result.phase_one_iterations,
        phase_two_iterations=result.phase_two_iterations,
        working_set_changes=result.working_set_changes,
        inertia=program.inertia,
        reduced_inertia_start=result.reduced_inertia_start,
        reduced_inertia_end=result.reduced_inertia_end,
        weakly_active=len(result.weakly_active),
        objective=program.value(result.x),
        penalty=penalty,
    )


def _solution(contact: CondensedContact, formulation: str, result: QPResult, search: LocalSearch) -> ContactSolution:
    """The end of the solver in the user's units."""
    n = contact.size
    U, T = contact.scales
    notes = []
    if result.status is QPStatus.UNDECIDED:
        notes.append("the local solver left open whether its end is a minimum: zero multipliers hide directions")
    if result.status is QPStatus.UNBOUNDED and result.ray is not None:
        notes.append(f"the objective falls without end along a ray: {ray_in_words(contact, result.ray)}")
    if result.status is QPStatus.INFEASIBLE:
        notes.append(escape_note(contact) or NO_CONTACT_STATE)
    u_n, p = result.x[:n] * U, result.x[n : 2 * n] * T
    return ContactSolution(
        formulation=formulation,
        solver=SOLVER,
        status=STATUSES[result.status],
        pressure=p,
        displacement=u_n,
        rigid_amplitudes=amplitudes(contact, p, u_n),
        iterations=result.iterations,
        search=search,
        history=_history(result),
        notes=tuple(notes),
    )


def _history(result: QPResult) -> tuple[Trace, ...]:
    """Sum of infeasibilities after each iteration of phase one, `Program.value` after each of phase two."""
    # The program is stated without a constant, so that the objective of the solver is that value. The solver goes back
    # to phase one where round-off has violated a constraint.
    phases = groupby(result.log, key=lambda line: line.phase)
    return traces_in_turn(*((QUANTITIES[phase], [line.value for line in lines]) for phase, lines in phases))
