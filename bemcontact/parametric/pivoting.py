"""Follow a contact state along a straight line of offsets and loads, from breakpoint to breakpoint.

Between two breakpoints the points in contact stay the same and the state is linear. At a breakpoint points become
weakly active; the derivative of the state there (`bemcontact.parametric.derivative`) says which of them are in contact
afterwards. This is parametric principal pivoting (Cottle, Pang and Stone, "The Linear Complementarity Problem", 1992,
section 4.5), in which a block of several points is settled at once. On each piece state and derivative are solved for
anew from the points in contact: no error adds up.

If the load has moved beyond the support, the body tips at constant load until another point holds it: the pressure
stays, the position jumps.
"""

from dataclasses import dataclass

import numpy as np

from bemcontact.arrays import Array, BoolArray
from bemcontact.contact.load_cases import Change
from bemcontact.errors import ProblemError, SingularSystemError, SolverError
from bemcontact.formulations.active_set import ContactBlock
from bemcontact.formulations.scaling import ScaledContact
from bemcontact.parametric.derivative import RANK, STILL, WEAK, Tangent, is_monotone, size_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Line:
    """Offset and load between two ends, s = 0 and s = 1, dimensionless."""

    first: Change
    last: Change

    @property
    def rate(self) -> Change:
        """The change per unit of s."""
        return Change(*(last - first for first, last in zip(self.first, self.last, strict=True)))

    def at(self, s: float) -> Change:
        """Offset and load at s."""
        return Change(*((1 - s) * first + s * last for first, last in zip(self.first, self.last, strict=True)))


@dataclass(frozen=True, kw_only=True, eq=False)
class State:
    """A contact state on the line: s, p >= 0 (n,), δ >= 0 (n,), a (k,), dimensionless."""

    s: float
    pressure: Array
    gap: Array
    amplitudes: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Trail:
    """The breakpoints of a path, from s = 0 on.

    Parameters
    ----------
    states : b of them
    touching : (n,) for each of the b - 1 pieces between them, which points are in contact
    escape : (k,) motion in which the load carries the body away where the trail ends early, else None
    stop : why it ends early otherwise, else empty
    unique : whether each state is known to be the only one
    """

    states: tuple[State, ...]
    touching: tuple[BoolArray, ...]
    escape: Array | None = None
    stop: str = ""
    unique: bool


def follow(contact: ScaledContact, line: Line, pressure: Array, amplitudes: Array) -> Trail:
    """Follow a state along the line, as far as it goes.

    Parameters
    ----------
    contact : its compliance, motions and weights are used
    line : offsets and loads
    pressure, amplitudes : (n,) and (k,), a solution at s = 0

    Returns
    -------
    Trail
        Its first state is the limit of those that follow, which differs from the given one where that is not unique.

    Raises
    ------
    SolverError
        If more points enter and leave than can be, which round-off alone could bring about.
    """
    gap = line.first.offset + contact.compliance @ pressure + contact.rigid_motions @ amplitudes
    states = [State(s=0.0, pressure=pressure, gap=np.maximum(gap, 0.0), amplitudes=amplitudes)]
    touching: list[BoolArray] = []
    unique, block, escape, stop = is_monotone(contact), None, None, ""
    for _ in range(limit := 1000 + 50 * len(pressure)):
        if (state := states[-1]).s >= 1.0:
            break
        tangent = Tangent.at(contact, state.pressure, state.gap, state.amplitudes, unique, block)
        motion = tangent.escape(line.rate)
        try:
            if motion.any():
                block, following = None, _tipped(contact, state, tangent, motion)
            else:
                block = tangent.after(line.rate)
                following = _next(line, state.s, block)
        except (ProblemError, SingularSystemError) as error:
            stop = str(error)
            break
        if following is None:  # nor do the places to which it has tipped before hold it
            escape = motion
            while len(states) > 1 and states[-2].s == state.s:
                states.pop()
                touching.pop()
            break
        if following.s == 0.0:
            states.clear()
        else:
            touching.append(tangent.loaded if block is None else block.touching)
        states.append(following)
    else:
        raise SolverError(f"the path was given up after {limit} breakpoints: points keep entering and leaving")
    return Trail(states=tuple(states), touching=tuple(touching), escape=escape, stop=stop, unique=unique)


def _next(line: Line, s: float, block: ContactBlock) -> State:
    """Go on with the same points in contact until a pressure or a gap is zero, or to the end of the line."""
    touching, rate = block.touching, line.rate
    pressures, gaps, amplitudes = block.solve(line.at(s), rate)
    values, rates = np.where(touching, pressures, gaps)
    step, blocking = first_zero(values, rates, STILL * size_of(rate, pressures[1], amplitudes[1]))
    small = WEAK * (1.0 + np.abs(pressures[0]).max(initial=0.0) + np.abs(amplitudes[0]).sum())
    if s + step >= 1.0 or (values + (1.0 - s) * rates).min() >= -small:  # at the end all pressures may vanish
        step, blocking = 1.0 - s, np.zeros_like(touching)
    reached = np.where(blocking, 0.0, np.maximum(values + step * rates, 0.0))
    return State(
        s=1.0 if not blocking.any() else s + step,
        pressure=np.where(touching, reached, 0.0),
        gap=np.where(touching, 0.0, reached),
        amplitudes=amplitudes[0] + step * amplitudes[1],
    )


def _tipped(contact: ScaledContact, state: State, tangent: Tangent, motion: Array) -> State | None:
    """Let the body move under a constant load until a point closes; None if none does, and the load carries it away."""
    closed, opening = np.append(tangent.strong, tangent.weak), contact.rigid_motions @ motion
    opening[closed] = np.maximum(opening[closed], 0.0)
    step, blocking = first_zero(state.gap, opening, RANK * float(np.linalg.norm(motion)))
    if not blocking.any():
        return None
    gap = np.where(blocking, 0.0, state.gap + step * opening)
    return State(s=state.s, pressure=state.pressure, gap=gap, amplitudes=state.amplitudes + step * motion)


def first_zero(values: Array, rates: Array, still: float) -> tuple[float, BoolArray]:
    """Largest step of values >= 0 at their rates until one is zero, and which ones are; infinite if none falls.

    Rates up to `still` count as zero.
    """
    falling = rates < -still
    steps = np.full(len(values), np.inf)
    steps[falling] = np.maximum(values[falling], 0.0) / -rates[falling]
    step = float(steps.min(initial=np.inf))
    return step, falling & (steps <= step)
