"""Load paths: all contact states between two of one body, exact, with every point that enters or leaves contact."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from pydantic import computed_field

from bemcontact.arrays import Array, BoolArray, freeze_arrays
from bemcontact.assessment.footprint import Footprint, footprint
from bemcontact.cached import cached_property
from bemcontact.checks.arguments import real_number, shown, whole_number
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import Change, LoadCases, Pinned
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.errors import ProblemError
from bemcontact.formulations import complementarity
from bemcontact.formulations.open_position import note_of_open, unheld_motions, with_chosen_position
from bemcontact.formulations.scaling import scale, scaled_change, scaled_point, unscaled
from bemcontact.frozen import frozen
from bemcontact.options import FormulationName
from bemcontact.parametric.pivoting import LinearChange, Trail, trail_along
from bemcontact.serialization import Internal, Leaf, Matrix, Pair, PairTables, Vector
from bemcontact.threads import one_thread

COMMON = {
    "compliance": "compliance",
    "rigid_motions": "free motions",
    "weights": "weights",
    "normals": "directions of the surfaces",
}
"""Fields that the ends of a path have in common, and their names in sentences."""
SAME = 1e-11
"""Difference of two compliances, motions or weights, over the largest entry, up to which it is round-off."""
SAME_LOAD = 1e-14
"""Difference of two loads, over the largest component, up to which it is round-off."""
CANCELLED = 4 * float(np.finfo(float).eps)
"""Sum of two ends of opposite sign, over the larger one, up to which they cancel each other."""
SOLVER = "parametric pivoting"
NOT_PROVED = "the compliance does not rule out other contact states beside those of this path"


@frozen
class LoadPath(Leaf):
    """The contact states between two ends, t = 0 and t = 1, linear in t between b breakpoints.

    Where the body tips over at a constant load, two breakpoints have the same t.
    """

    start: Internal[CondensedContact]
    """Problem at t = 0."""
    end: Internal[CondensedContact]
    """Problem at t = 1."""
    parameter: Vector
    """Parameter t (b,) of the breakpoints, ascending, those at which the path begins and ends included."""
    pressure: Matrix
    """Pressure p (b, n) at the breakpoints [p]."""
    gap: Matrix
    """Gap δ (b, n) at the breakpoints, zero on contact [L]."""
    rigid_amplitudes: Matrix
    """Amplitudes a (b, k) at the breakpoints."""
    touching: Internal[BoolArray]
    """Whether each point is in contact (b - 1, n) between two breakpoints."""
    unique: bool
    """Whether each state is proved to be the only one."""
    note: Internal[str]
    """Why the path does not reach from 0 to 1, or empty."""
    open: Internal[BoolArray]
    """Whether contact leaves a position open (b - 1,) between two breakpoints; it is then chosen by a rule."""
    left_open: Internal[tuple[tuple[str, tuple[Pair, ...]], ...]] = ()
    """Motions that contact leaves open, each with the ranges of t in which it does."""

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    def __repr__(self) -> str:
        """One line: name, range, breakpoints, notes."""
        wrong = "".join(f"; {text}" for text in self.notes)
        return (
            f"<LoadPath of {self.start.name!r}: {len(self.parameter)} breakpoints from {self.begins_at:g} to "
            f"{self.ends_at:g}, {self.pivots} pivots{wrong}>"
        )

    @computed_field
    @property
    def name(self) -> str:
        """Name of the problem."""
        return self.start.name

    @computed_field
    @property
    def zones(self) -> tuple[str, ...]:
        """Names of the contact zones."""
        return self.start.zone_names

    @computed_field
    @property
    def begins_at(self) -> float:
        """Least t to which the path reaches."""
        return float(self.parameter[0])

    @computed_field
    @property
    def ends_at(self) -> float:
        """Largest t to which the path reaches."""
        return float(self.parameter[-1])

    @computed_field
    @property
    def complete(self) -> bool:
        """Whether the path reaches from 0 to 1."""
        return self.begins_at == 0.0 and self.ends_at == 1.0

    @computed_field
    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the path, one sentence each."""
        return self.notes_at(float)

    def notes_at(self, value: Callable[[float], float]) -> tuple[str, ...]:
        """Notes on the path, one sentence each, with the value of the parameter at each t."""
        where = f"from {value(self.begins_at):.6g} on" if self.begins_at > 0.0 else f"up to {value(self.ends_at):.6g}"
        early = f"the path exists {where}; beyond that, {self.note}" if self.note else ""
        motions = [
            " ".join([name, " and ".join(f"from {value(a):.6g} to {value(b):.6g}" for a, b in ranges)])
            for name, ranges in self.left_open
        ]
        notes = (early, "" if self.unique else NOT_PROVED, note_of_open(motions) if motions else "")
        return tuple(filter(None, notes))

    @computed_field
    @cached_property
    def entered(self) -> tuple[tuple[int, ...], ...]:
        """Indices of the points that enter contact at each breakpoint, as t rises."""
        return self._changed(self.touching[1:] & ~self.touching[:-1])

    @computed_field
    @cached_property
    def left(self) -> tuple[tuple[int, ...], ...]:
        """Indices of the points that leave contact at each breakpoint, as t rises."""
        return self._changed(self.touching[:-1] & ~self.touching[1:])

    def _changed(self, masks: BoolArray) -> tuple[tuple[int, ...], ...]:
        """Indices of points at the breakpoints between the first and the last."""
        changed = (tuple(np.flatnonzero(mask).tolist()) for mask in masks)
        return ((), *changed, ())[: len(self.parameter)]

    @computed_field
    @property
    def pivots(self) -> int:
        """Number of times that a point enters or leaves contact."""
        return int((self.touching[1:] ^ self.touching[:-1]).sum())

    @computed_field
    @property
    def peak(self) -> Vector:
        """Largest pressure (b,) at the breakpoints [p]; convex in t between two of them."""
        return self.pressure.max(axis=1, initial=0.0)

    @computed_field
    @property
    def resultant(self) -> PairTables:
        """Force (x, y) of each contact on the body (b, zones, 2) at the breakpoints, per thickness [p L]."""
        return self.start.resultants(self.pressure)

    @cached_property
    def residual(self) -> float:
        """The largest natural residual at the breakpoints and midway between two, recomputed from p and a, relative."""
        unit, worst = measure(self.start, self.end), 0.0
        line, scaled = line_between(unit, self.start, self.end), scale(unit)
        found = (self.parameter, self.pressure, self.rigid_amplitudes)
        midway = ((values[1:] + values[:-1]) / 2 for values in found)
        states = zip(*(np.concatenate(pair) for pair in zip(found, midway, strict=True)), strict=True)
        for t, pressure, amplitudes in states:
            offset, load = line.at(t)
            stated = replace(scaled, offset=offset, motion_load=load)
            worst = max(worst, stated.residual(*scaled_point(unit, pressure, amplitudes)))
        return worst

    def contact(self, t: float) -> CondensedContact:
        """The contact problem at t; `ProblemError` where the path does not reach."""
        t = self._reached(t)
        first, last = self.start, self.end

        def between(one: Array, other: Array) -> Array:
            value = (1 - t) * one + t * other
            return np.where(np.abs(value) <= CANCELLED * np.maximum(np.abs(one), np.abs(other)), 0.0, value)

        load = between(first.motion_load, last.motion_load)
        largest = np.abs([first.motion_load, last.motion_load]).max(initial=0.0)
        none = np.abs(load).max(initial=0.0) <= CANCELLED * largest
        tools = last.tools
        if len(tools):
            position = between(first.tools.position, tools.position)
            tools = replace(tools, position=position, force=between(first.tools.force, tools.force))
        cases, pinned = self._cases(between)
        return replace(
            first,
            free_displacement=between(first.free_displacement, last.free_displacement),
            initial_gap=between(first.initial_gap, last.initial_gap),
            motion_load=np.zeros_like(load) if none else load,
            tools=tools,
            cases=cases,
            pinned=pinned,
        )

    def _cases(self, between: Callable[[Array, Array], Array]) -> tuple[LoadCases, Pinned]:
        """Load cases at a value between both ends, and what must balance.

        Either their factors differ at the ends, or they themselves do. If both do, their sum is not linear in either:
        the loads that act are permanent then.
        """
        first, last, pinned = self.start.cases, self.end.cases, self.start.pinned
        fixed = ("displacement", "motion_load", "position", "force")
        if first.names == last.names:
            if np.array_equal(first.factors, last.factors):
                parts = {name: between(getattr(first, name), getattr(last, name)) for name in fixed}
                return replace(first, **parts), pinned
            if all(np.array_equal(getattr(first, name), getattr(last, name)) for name in fixed):
                return replace(first, factors=between(first.factors, last.factors)), pinned
        n, k = self.start.rigid_motions.shape
        factors, others = np.append(1.0, first.factors), np.append(1.0, last.factors)
        largest = max(pinned.magnitude @ abs(factors), self.end.pinned.magnitude @ abs(others))
        acting = replace(pinned, load=(pinned.load @ factors)[:, None], magnitude=np.array([largest]))
        return LoadCases.none(n, k, len(self.start.tools)), acting

    def at(self, t: float) -> ContactSolution:
        """The contact state at t, exact.

        Parameters
        ----------
        t : from `begins_at` to `ends_at`

        Returns
        -------
        ContactSolution
            Solution of ``contact(t)``. Where the body tips over, it is the state after that.

        Raises
        ------
        ProblemError
            The path does not reach t.
        """
        t = self._reached(t)
        i = int(np.searchsorted(self.parameter, t, side="right")) - 1
        j = min(i + 1, len(self.parameter) - 1)
        width = self.parameter[j] - self.parameter[i]
        share = (t - self.parameter[i]) / width if width else 0.0
        pressure = (1 - share) * self.pressure[i] + share * self.pressure[j]
        amplitudes = (1 - share) * self.rigid_amplitudes[i] + share * self.rigid_amplitudes[j]
        state = self._solution(t, pressure, amplitudes)
        return with_chosen_position(self.contact(t), state) if self._is_open(t) else state

    def _is_open(self, t: float) -> bool:
        """Whether contact leaves a position open beside t, and the body does not tip there."""
        first, last = np.searchsorted(self.parameter, t, side="left"), np.searchsorted(self.parameter, t, side="right")
        return bool(last - first < 2 and self.open[max(first - 1, 0) : last].any())

    def breakpoint(self, i: int) -> ContactSolution:
        """The contact state at breakpoint i, of ``contact(parameter[i])``."""
        if whole_number(i, "number of a breakpoint", 0) >= len(self.parameter):
            raise ProblemError(f"there is no breakpoint {shown(i)}: there are {len(self.parameter)}, numbered from 0")
        return self._solution(float(self.parameter[i]), self.pressure[i], self.rigid_amplitudes[i])

    def _solution(self, t: float, pressure: Array, amplitudes: Array) -> ContactSolution:
        """A contact state from its pressure and amplitudes."""
        contact = self.contact(t)
        return ContactSolution(
            formulation=FormulationName.COMPLEMENTARITY,
            solver=SOLVER,
            status=Status.SOLVED,
            pressure=pressure,
            displacement=contact.gap(pressure, amplitudes) - contact.initial_gap,
            rigid_amplitudes=amplitudes,
            iterations=0,
        )

    def footprint(self, t: float) -> Footprint:
        """Intervals, peak and resultant at t; the ends of intervals are not linear in t."""
        return footprint(self.contact(t), self.at(t))

    def _reached(self, t: float) -> float:
        """Refuse a t outside of the path."""
        t = real_number(t, "t of a path")
        if not self.begins_at <= t <= self.ends_at:
            raise ProblemError(
                f"the path reaches from {self.begins_at:g} to {self.ends_at:g}, there is nothing at {t:g}"
                + (f": {self.note}" if self.note else "")
            )
        return t


@one_thread
def load_path(start: CondensedContact, end: CondensedContact) -> LoadPath:
    """Follow the contact state from one problem to another of the same body, exactly.

    The path is followed from the start, or from the end backwards where the start has no solution or does not
    determine the position of the body.

    Parameters
    ----------
    start, end : with the same compliance, free motions and weights; gaps and loads differ, as `with_factors` and
        `with_tools` change them

    Returns
    -------
    LoadPath
        Where it ends early, `note` gives the reason.

    Raises
    ------
    ProblemError
        They are not condensed problems, differ in something else, or neither has a contact state from which a path
        leads.
    """
    for given in (start, end):
        if not isinstance(given, CondensedContact):
            kind = type(given).__name__
            raise ProblemError(f"a path leads between two CondensedContact, which condense makes; found {kind}")
    ensure_same_body(start, end)
    trail, note = _followed(start, end)
    if trail is None or len(trail.states) == 1:
        backwards, other = _followed(end, start)
        if backwards is None or len(backwards.states) == 1:
            raise ProblemError(f"there is no path of contact states: at the start, {note}; at the end, {other}")
        return _path(start, end, backwards, other, backwards=True)
    return _path(start, end, trail, note)


def ensure_same_body(start: CondensedContact, end: CondensedContact) -> None:
    """Refuse two problems that differ in more than gap and load; the `ProblemError` names the difference."""
    for name, what in COMMON.items():
        one, other = getattr(start, name), getattr(end, name)
        if one.shape != other.shape:
            raise ProblemError(f"the {what} of start and end differ in shape, {one.shape} and {other.shape}; {WAY_OUT}")
        size = np.abs(one).max(initial=0.0)
        if (apart := np.abs(one - other).max(initial=0.0)) > SAME * size:
            raise ProblemError(f"the {what} of start and end differ, by {apart / size:.2g} of the largest; {WAY_OUT}")


WAY_OUT = "a path is exact only for loads, gaps and tools: condense once, then use with_factors and with_tools"


def _followed(first: CondensedContact, last: CondensedContact) -> tuple[Trail | None, str]:
    """Solve the first problem and follow its state to the last; the text is the reason if it does not reach it."""
    solution = complementarity.solve(first)
    if solution.status is not Status.SOLVED:
        return None, "; ".join(solution.notes) or solution.status.words
    unit = measure(first, last)
    point = scaled_point(unit, solution.pressure, solution.rigid_amplitudes)
    trail = trail_along(scale(unit), line_between(unit, first, last), *point)
    return trail, trail.stop if trail.escape is None else complementarity.escape_words(first, trail.escape)


def measure(first: CondensedContact, last: CondensedContact) -> CondensedContact:
    """The problem whose scales are used: the larger ones, but not those of a problem that needs no pressure."""
    loaded = [item for item in (first, last) if item.motion_load.any() or (item.offset < 0).any()]
    return max(loaded or (first, last), key=lambda item: item.scales.displacement)


def line_between(unit: CondensedContact, first: CondensedContact, last: CondensedContact) -> LinearChange:
    """The offsets and loads from one problem to another, over the scales of `unit`."""
    begin, end = (scaled_change(unit, Change(item.offset, item.motion_load)) for item in (first, last))
    largest = np.abs([begin.motion_load, end.motion_load]).max(initial=0.0)
    same = np.abs(end.motion_load - begin.motion_load) <= SAME_LOAD * largest
    return LinearChange(first=begin, last=Change(end.offset, np.where(same, begin.motion_load, end.motion_load)))


def _path(start: CondensedContact, end: CondensedContact, trail: Trail, note: str, backwards: bool = False) -> LoadPath:
    """Put units back, and t in ascending order."""
    unit, order = measure(start, end), slice(None, None, -1 if backwards else 1)
    pieces = len(trail.states) - 1
    states = trail.states[order]
    points = [unscaled(unit, state.pressure, state.amplitudes) for state in states]
    s = np.array([state.s for state in states])
    path = LoadPath(
        start=start,
        end=end,
        parameter=1.0 - s if backwards else s,
        pressure=np.array([pressure for pressure, _, _ in points]),
        gap=np.array([state.gap for state in states]) * unit.scales.displacement,
        rigid_amplitudes=np.array([amplitudes for _, _, amplitudes in points]),
        touching=np.array(trail.touching[order], bool).reshape(-1, start.size),
        unique=trail.unique,
        note=note,
        open=np.zeros(pieces, bool),
    )
    return _with_positions(path)


def _with_positions(path: LoadPath) -> LoadPath:
    """Choose the positions that are not determined by the rule of `settled`.

    At a breakpoint the points that are pressed beside it stay closed, so that the states between are linear.
    """
    leaves_open, ranges = np.zeros(len(path.open), bool), dict[str, list[Pair]]()
    midway = (path.pressure[1:] + path.pressure[:-1]) / 2
    for i, (begin, end) in enumerate(pairwise(path.parameter.tolist())):
        if begin < end and unheld_motions(path.start, midway[i]).size:
            middle = path.at((begin + end) / 2)
            chosen = with_chosen_position(path.contact((begin + end) / 2), middle)
            leaves_open[i] = chosen is not middle
            for name in chosen.undetermined if leaves_open[i] else ():
                own = ranges.setdefault(name, [])
                first = own.pop()[0] if own and own[-1][1] == begin else begin
                own.append((first, end))
    if not leaves_open.any():
        return path
    path = replace(path, open=leaves_open, left_open=tuple((name, tuple(own)) for name, own in ranges.items()))
    amplitudes, gap = path.rigid_amplitudes.copy(), path.gap.copy()
    pressed = np.vstack([path.pressure[:1], np.maximum(path.pressure[1:], path.pressure[:-1]), path.pressure[-1:]]) > 0
    for i, t in enumerate(path.parameter.tolist()):
        if path._is_open(t):
            closed = pressed[i] | pressed[i + 1]
            chosen = with_chosen_position(path.contact(t), path.breakpoint(i), closed)
            amplitudes[i] = chosen.rigid_amplitudes
            gap[i] = np.where(closed, 0.0, np.maximum(path.contact(t).initial_gap + chosen.displacement, 0.0))
    return replace(path, rigid_amplitudes=amplitudes, gap=gap)
