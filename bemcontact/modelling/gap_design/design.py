"""The profile of a rigid surface that makes contact pressure low or uniform: `design_gap`.

For given contact sets the best profile is a convex program (`contact_sets`). Contact sets are improved by turning
points on their edge, as long as the goal gets smaller, from several starts. What comes out is solved again as a contact
problem.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.assessment.certificate import certify
from bemcontact.assessment.footprint import footprint
from bemcontact.assessment.residual import residuals
from bemcontact.checks.arguments import ensure_callable, instance_of, real_number, shown
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import Status
from bemcontact.contact.stress_operator import StressOperator, ensure_of
from bemcontact.errors import ProblemError, SolverError
from bemcontact.formulations import complementarity
from bemcontact.formulations.active_set import solve_active_set
from bemcontact.formulations.scaling import scale
from bemcontact.modelling.gap_design.contact_sets import BestProfile, SharedProfile
from bemcontact.modelling.gap_design.designed_gap import GapDesign, Goal, LoadState, relieved
from bemcontact.modelling.gap_design.relief import Profiles, Relief
from bemcontact.threads import one_thread

GAIN = 1e-8
"""Least relative gain of a step."""
MET = 1e-6
"""Distance from the lower bound, relative, at which a design is proved to be the best."""
STEPS = 200
CORNERS, KEPT = 60, 8
"""Random corners of the set of profiles that are looked at, as many as between them, and how many become starts."""
SAME = 1e-12
"""Relative difference of compliances that is round-off."""


@one_thread
def design_gap(
    contact: CondensedContact | Sequence[CondensedContact],
    relief: Relief,
    *,
    zone: str | None = None,
    arc: tuple[float, float] | None = None,
    cases: Sequence[Mapping[str, float]] | None = None,
    goal: Goal | str = Goal.PEAK,
    stress: StressOperator | None = None,
    von_mises: float | None = None,
    progress: Callable[[str, str], object] | None = None,
) -> GapDesign:
    """Find the profile within bounds that, added to the initial gap, makes the peak pressure smallest.

    Parameters
    ----------
    contact : the problem, or several load states of one body on the same surfaces, of which the worst counts
    relief : the bounds on the profile
    zone, arc : its interval: a contact zone, which may be left out if it is the only one, and the least and largest arc
        position on it [L], the whole zone if left out
    cases : factors of load cases, one mapping for each load state, as in `CondensedContact.with_factors`
    goal : a `Goal` or its name: "peak" (the largest pressure anywhere) or "uniform" (the mean square deviation of the
        pressure on the interval from its mean there) or "von_mises" (the largest stress at the points of `stress`)
    stress : stress at points of the body, as `bemcontact.stress_operator` makes it of the same problem
    von_mises : limit of von Mises's stress at these points [p], in each load state
    progress : called with two texts, the name of a stage and how far it has come, which is empty when it begins

    Returns
    -------
    GapDesign
        Of equally good profiles that with the least mean square, solved again by the direct solver and certified. Check
        `proved_optimal`.

    Raises
    ------
    ProblemError
        Bounds exclude each other, states are not those of one body, a state has no contact state, the operator is that
        of another problem, or no profile is found that keeps the limit of stress.
    SolverError
        Clarabel breaks down.
    """
    ensure_callable(progress, "progress")
    say = progress or (lambda *_: None)
    states, goal = _states(contact, cases), _goal(goal)
    instance_of(relief, Relief, "relief", "it holds the bounds on the profile: Relief(lower=0.0, upper=0.1)")
    profiles = Profiles.of(states[0], relief, zone, arc)
    limit = _limit(states, goal, stress, von_mises)
    shared = SharedProfile.of(states, profiles, goal, stress, limit)
    say("without a profile", "")
    before = tuple(_solved(state, np.zeros(state.size)) for state in states)
    best = _best(shared, states, say)
    say("lower bound", "")
    bound, coefficients, sets = shared.relaxed(best.value * shared.scales.pressure)
    if best.value * shared.scales.pressure > bound * (1 + MET):
        say("profiles of the lower bound", "")
        others = (_descended(shared, some) for some in (sets, _state(states, profiles.shapes @ coefficients)[1]))
        best = _least([piece for piece in (best, *others) if piece is not None])
    say("gentlest of equally good profiles", "")
    best, gentlest = _gently_descended(shared, best)
    say("contact with the profile", "")
    gentle = _carried_out(shared, states, before, gentlest, bound)
    if gentle.verified and gentle.value <= best.value * shared.scales.pressure * (1 + MET):
        return gentle
    plain = _carried_out(shared, states, before, best, bound)  # narrow bounds may cost the gentlest profile more
    return min((gentle, plain), key=lambda design: (not design.verified, design.value))


def _carried_out(
    shared: SharedProfile,
    states: Sequence[CondensedContact],
    before: tuple[LoadState, ...],
    piece: BestProfile,
    bound: float,
) -> GapDesign:
    """Solve the contact problems with the profile of a piece, and put the design together."""
    profiles = shared.profiles
    coefficients = profiles.kept(piece.coefficients)
    profile = profiles.shapes @ coefficients
    after = tuple(_solved(state, profile) for state in states)
    reached = shared.measure(state.pressure for state in after)
    return GapDesign(
        goal=shared.goal,
        zone=states[0].zone_names[states[0].zone[profiles.points[0]]],
        points=profiles.points,
        profile=profile,
        coefficients=coefficients / profiles.sizes if profiles.shaped else None,
        before=before,
        after=after,
        designed=np.array([_on_sets(*pair) for pair in zip(after, piece.touching, strict=True)]),
        value_before=shared.measure(state.pressure for state in before),
        value=reached,
        lower_bound=bound,
        proved_optimal=reached - bound <= MET * reached,
        von_mises_limit=shared.limit,
        von_mises=shared.von_mises(state.pressure for state in after),
    )


def _states(
    contact: CondensedContact | Sequence[CondensedContact], cases: Sequence[Mapping[str, float]] | None
) -> tuple[CondensedContact, ...]:
    """Check that the load states are those of one body."""
    several = contact if isinstance(contact, Sequence) else ()
    states = (contact,) if isinstance(contact, CondensedContact) else tuple(several)
    if not states or not all(isinstance(state, CondensedContact) for state in states):
        raise ProblemError("a design needs a CondensedContact, or several of one body; bemcontact.condense makes them")
    if cases is not None:
        if not isinstance(cases, Sequence):
            raise ProblemError(f"cases is a list, such as [{{'wind': 1.5}}]; found {shown(cases)}")
        if len(states) != 1 or not len(cases):
            raise ProblemError("factors of load cases go with one condensed contact, and at least one state is needed")
        return tuple(states[0].with_factors(factors) for factors in cases)
    first = states[0]
    for number, state in enumerate(states[1:], start=2):
        for key in ("points", "compliance", "rigid_motions", "weights"):
            one, other = getattr(first, key), getattr(state, key)
            if one.shape != other.shape or np.abs(one - other).max(initial=0.0) > SAME * np.abs(one).max(initial=0.0):
                raise ProblemError(
                    f"load state {number} differs from the first one in its {key.replace('_', ' ')}; states of a "
                    "design are one body on the same surfaces, as CondensedContact.with_factors makes them"
                )
    return states


def _limit(
    states: Sequence[CondensedContact], goal: Goal, stress: StressOperator | None, von_mises: float | None
) -> float | None:
    """Check that a limit of stress and the points that it holds at fit together."""
    if stress is None:
        if von_mises is not None or goal is Goal.VON_MISES:
            raise ProblemError("von Mises's stress needs points: give stress, which bemcontact.stress_operator makes")
        return None
    instance_of(stress, StressOperator, "stress", "bemcontact.stress_operator makes one of a problem and points")
    for state in states:
        ensure_of(stress, state)
    if von_mises is None:
        if goal is Goal.VON_MISES:
            return None
        raise ProblemError("stress is given, and nothing bounds it; give the limit von_mises, or the goal 'von_mises'")
    limit = real_number(von_mises, "von_mises")
    if limit <= 0:
        raise ProblemError(f"von_mises, the limit of stress, must be positive; found {limit:g}")
    return limit


def _within_limit(
    shared: SharedProfile, states: Sequence[CondensedContact], say: Callable[[str, str], object]
) -> BestProfile:
    """A design within the limit of stress, from that of the least stress; `ProblemError` if this is above the limit."""
    say("profiles of low stress", "")
    limit, T = shared.limit, shared.scales.pressure
    assert limit is not None
    lowest = replace(shared, goal=Goal.VON_MISES, limit=None)
    least = _best(lowest, states, say)
    piece = _descended(shared, least.touching) if least.value * T <= limit else None
    if piece is not None:
        return piece
    bound = lowest.relaxed(least.value * T).bound
    whether = "no profile within the bounds keeps" if bound > limit else "no profile was found that keeps"
    raise ProblemError(
        f"{whether} von Mises's stress at the given points below {limit:.5g}: {least.value * T:.5g} is the least that "
        f"was reached, and none goes below {bound:.5g}; raise the limit, or widen the bounds on the profile"
    )


def _goal(goal: Goal | str) -> Goal:
    """Read the name of a goal."""
    try:
        return Goal(goal if isinstance(goal, str) else "")
    except ValueError:
        raise ProblemError(
            f"there is no goal {shown(goal)}; there are: {', '.join(known.value for known in Goal)}"
        ) from None


def _solved(contact: CondensedContact, profile: Array) -> LoadState:
    """Solve and assess the contact problem with a profile (n,)."""
    there = relieved(contact, profile)
    solution = complementarity.solve(there)
    if solution.status is not Status.SOLVED:
        raise ProblemError(f"a load state has no contact state: {' '.join((solution.status.words, *solution.notes))}")
    recomputed = residuals(there, solution)
    return LoadState(
        contact=there,
        solution=solution,
        residuals=recomputed,
        certificate=certify(there, solution, recomputed),
        footprint=footprint(there, solution),
    )


def _on_sets(state: LoadState, touching: BoolArray) -> Array:
    """Pressure (n,) [p] on a designed contact set, of either sign; the program has it to its tolerance over λ only."""
    pressure, _ = solve_active_set(scale(state.contact), touching)
    return pressure * state.contact.scales.pressure


def _best(shared: SharedProfile, states: Sequence[CondensedContact], say: Callable[[str, str], object]) -> BestProfile:
    """The best end of all starts."""
    say("profiles to start from", "")
    starts = [*_starts(shared, states)]
    ends: list[BestProfile] = []
    say("contact sets", "")
    for number, sets in enumerate(starts, start=1):
        end = _descended(shared, sets)
        ends += [] if end is None else [end]
        known = f", {_least(ends).value * shared.scales.pressure:.4g} is reached" if ends else ""
        say("contact sets", f"start {number} of {len(starts)}{known}")
    if not ends and shared.limit is not None:
        return _within_limit(shared, states, say)
    if not ends:
        raise SolverError("no convex program of the design had an optimum; look in the mesh for very short elements")
    return _least(ends)


def _least(pieces: Sequence[BestProfile]) -> BestProfile:
    """The first of those with the least value, so that round-off does not choose between equal ones."""
    least = min(piece.value for piece in pieces)
    return next(piece for piece in pieces if piece.value <= least + GAIN * abs(least))


def _starts(shared: SharedProfile, states: Sequence[CondensedContact]) -> Iterator[BoolArray]:
    """Contact sets (loads, n) of the whole interval and of profiles.

    The profiles are next to zero, extreme in mean value, tilt and crown, and the best of random ones.
    """
    profiles, rng = shared.profiles, np.random.default_rng(0)
    yield np.tile(np.isin(np.arange(states[0].size), profiles.points), (len(states), 1))
    there = np.linspace(-1.0, 1.0, len(profiles.points))
    extremes = [_corner(profiles, sign * shape) for shape in (there**0, there, there**2 - 1 / 3) for sign in (1, -1)]
    for coefficients in (profiles.nearest_to_none(), *extremes):
        yield _state(states, profiles.shapes @ coefficients)[1]
    corners = [_corner(profiles, rng.standard_normal(len(there))) for _ in range(CORNERS)]
    mixed = [rng.dirichlet(np.ones(len(few))) @ few for few in zip(corners, corners[1:], corners[2:], strict=False)]
    looked_at = [_state(states, profiles.shapes @ coefficients) for coefficients in (*corners, *mixed)]
    looked_at.sort(key=lambda state: (shared.excess(state[0]), shared.measure(state[0])))
    distinct = {sets.tobytes(): sets for _, sets in looked_at}
    yield from list(distinct.values())[:KEPT]


def _corner(profiles: Profiles, direction: Array) -> Array:
    """The profile that reaches farthest against a direction (m,) on the interval."""
    spread = np.zeros(len(profiles.shapes))
    spread[profiles.points] = direction
    return profiles.extreme(spread)


def _state(states: Sequence[CondensedContact], profile: Array) -> tuple[list[Array], BoolArray]:
    """Pressure (n,) [p] of each state with a profile, and the contact sets (loads, n)."""
    contacts = [relieved(state, profile) for state in states]
    solutions = [complementarity.solve(contact) for contact in contacts]
    sets = [one.touching(two.pressure, two.displacement) for one, two in zip(contacts, solutions, strict=True)]
    return [solution.pressure for solution in solutions], np.array(sets)


def _descended(shared: SharedProfile, touching: BoolArray) -> BestProfile | None:
    """Turn points on the edge of contact as long as the goal gets smaller."""
    piece = shared.best_with(touching)
    for _ in range(STEPS if piece is not None else 0):
        assert piece is not None
        better = _next(shared, piece)
        if better is None:
            break
        piece = better
    return piece


def _gently_descended(shared: SharedProfile, best: BestProfile) -> tuple[BestProfile, BestProfile]:
    """Continue from the gentlest of equally good profiles: others may not be on an edge of contact that leads on."""
    gentlest = shared.gentlest(best)
    for _ in range(STEPS):
        better = _next(shared, gentlest)
        if better is None:
            break
        best = _descended(shared, better.touching) or better
        gentlest = shared.gentlest(best)
    return best, gentlest


def _next(shared: SharedProfile, piece: BestProfile) -> BestProfile | None:
    """The first better one of: all promising points turned at once, each by itself, each of the others."""
    promising, others = piece.turns[: piece.promising], piece.turns[piece.promising :]
    together = [promising] if len(promising) > 1 else []
    for turned in (*together, *((turn,) for turn in (*promising, *others))):
        touching = piece.touching.copy()
        for load, point in turned:
            touching[load, point] ^= True
        better = shared.best_with(touching)
        if better is not None and better.value < piece.value - GAIN * abs(piece.value):
            return better
    return None
