"""Sensitivities: exact derivatives of a contact state, from the points in contact and one factorization for all."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Self

import numpy as np
from pydantic import computed_field

from bemcontact.arrays import IntArray, freeze_arrays, real_array
from bemcontact.assessment.accuracy import NO_MESH, Accuracy
from bemcontact.assessment.footprint import ContactInterval, end_rates, footprint, resting_ends
from bemcontact.checks.arguments import shown
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import Change
from bemcontact.contact.solution import ContactSolution, Status
from bemcontact.errors import ProblemError, SingularSystemError
from bemcontact.formulations import complementarity
from bemcontact.formulations.scaling import scale, scaled_change, scaled_point, unscaled
from bemcontact.frozen import frozen
from bemcontact.parametric.path import NOT_PROVED
from bemcontact.parametric.pivoting import WEAK, Tangent, is_monotone
from bemcontact.serialization import Internal, Leaf, Pairs, Vector
from bemcontact.threads import one_thread

EXACT = 1e-9
"""Residual up to which a solution has a meaningful derivative."""
NAMED = 4
"""Points that a note names; the others are counted."""


@frozen
class Rates(Leaf):
    """Derivatives of a contact state per unit of what changes."""

    pressure: Vector
    """Derivative of the pressure (n,) [p]."""
    gap: Vector
    """Derivative of the gap (n,) [L]."""
    rigid_amplitudes: Vector
    """Derivative of the amplitudes (k,)."""
    resultant: Pairs
    """Derivative of the force of the rigid surface of each zone on the body (zones, 2), per thickness [p L]."""
    peak: float | None
    """Derivative of the largest pressure [p]; null if the peak pressure is infinite."""
    interval_ends: tuple[tuple[float | None, float | None], ...]
    """Derivatives of the arc positions of both ends of each contact interval [L].

    Zero where an end is kept at a point; null beside a point that is about to enter or leave contact. The ends move
    unevenly from point to point: the derivative is right on the average over a node spacing.
    """

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)


@frozen
class Sensitivity(Leaf):
    """Derivatives of a contact state with respect to one parameter."""

    key: str
    """Key of the parameter."""
    rising: Rates
    """Derivatives to the right, per unit by which the parameter rises."""
    falling: Rates
    """Derivatives to the left, per unit by which the parameter rises; the same where the state is smooth."""

    @computed_field
    @property
    def one_sided(self) -> bool:
        """Whether the two sides differ."""
        return self.rising is not self.falling

    def __repr__(self) -> str:
        """One line: key and rate of the peak."""
        return f"<Sensitivity to {self.in_short}>"

    @property
    def in_short(self) -> str:
        """Key and rate of the peak."""
        rising, falling = ("infinite" if it.peak is None else f"{it.peak:.6g}" for it in (self.rising, self.falling))
        peaks = f"{rising} rising, {falling} falling" if self.one_sided and rising != "infinite" else rising
        return f"{self.key}: peak {peaks}{' per unit' * (rising != 'infinite')}"

    def without_peak(self) -> Self:
        """Return a copy without the derivative of the largest pressure, which is infinite."""
        rising = replace(self.rising, peak=None)
        return replace(self, rising=rising, falling=replace(self.falling, peak=None) if self.one_sided else rising)


@frozen
class Sensitivities(Leaf):
    """Derivatives of a contact state with respect to its parameters."""

    solution: Internal[ContactSolution]
    """The contact state."""
    intervals: tuple[ContactInterval, ...]
    """Contact intervals, whose ends move."""
    each: Internal[Mapping[str, Sensitivity]]
    """Sensitivities by key."""
    weak: tuple[int, ...]
    """Indices of the points that are about to enter or leave contact: no pressure and no gap."""
    notes: tuple[str, ...]
    """Notes on the contact state."""
    accuracy: Accuracy = NO_MESH
    """Accuracy of the mesh in the contact state: error bars of the peak, of forces, and of the ends that move. The
    derivatives themselves have none."""

    def __getitem__(self, key: str) -> Sensitivity:
        """Return the sensitivity to a parameter; `ProblemError` if there is none of that key."""
        if not isinstance(key, str) or key not in self.each:
            raise ProblemError(f"there is no sensitivity to {shown(key)}; there are: {', '.join(self.each) or 'none'}")
        return self.each[key]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the keys."""
        return iter(self.each)

    def __len__(self) -> int:
        """Return the number of parameters."""
        return len(self.each)

    def __repr__(self) -> str:
        """A line for each key with the rate of the peak, and for each note."""
        head = f"<Sensitivities to {len(self)} parameter{'s' * (len(self) != 1)}>"
        return "\n".join([head, *(item.in_short for item in self.each.values()), *self.notes])

    def knowing(self, accuracy: Accuracy) -> Self:
        """Return a copy with the accuracy of its mesh; the largest pressure has no derivative if it is infinite."""
        each = {key: item.without_peak() for key, item in self.each.items()} if accuracy.infinite else self.each
        return replace(self, accuracy=accuracy, each=each)

    @computed_field
    @property
    def sensitivities(self) -> tuple[Sensitivity, ...]:
        """Derivatives with respect to each parameter."""
        return tuple(self.each.values())


@one_thread
def sensitivities(
    contact: CondensedContact,
    changes: Mapping[str, Change] | None = None,
    solution: ContactSolution | None = None,
) -> Sensitivities:
    """Differentiate a contact state with respect to parameters that change its gap and load linearly.

    Parameters
    ----------
    contact : CondensedContact
    changes : by key, per unit; `contact.changes`, factors of load cases and tools, if not given. A profile added to the
        initial gap is ``Change(profile, np.zeros(k))``
    solution : of the problem; that of the direct solver if not given

    Returns
    -------
    Sensitivities

    Raises
    ------
    ProblemError
        There is no contact state, the given one is none, or it does not determine a derivative: contact does not hold
        the body, or the change pulls it off.
    SingularSystemError
        The equations of contact are singular to working precision.
    """
    wanted = contact.changes if changes is None else {key: _fitting(contact, key, changes[key]) for key in changes}
    state = complementarity.solve(contact) if solution is None else solution
    if state.status is not Status.SOLVED:
        why = "; ".join(state.notes) or state.status.words
        raise ProblemError(f"there is no contact state to differentiate: {why}")
    scaled = scale(contact)
    p, a = scaled_point(contact, state.pressure, state.rigid_amplitudes)
    if (residual := scaled.residual(p, a)) > EXACT:
        raise ProblemError(f"the given solution is no contact state to differentiate: its residual is {residual:.2g}")
    tangent = Tangent.at(scaled, p, np.maximum(scaled.gap(p, a), 0.0), a, is_monotone(scaled))
    each = {key: _sensitivity(contact, state, tangent, key, change) for key, change in wanted.items()}
    return Sensitivities(
        solution=state,
        intervals=footprint(contact, state).intervals,
        each=each,
        weak=tuple(tangent.weak.tolist()),
        notes=(*_notes(contact, tangent.weak, _highest(contact, state), tangent.unique), *_at_rest(contact, state)),
    )


def _fitting(contact: CondensedContact, key: str, change: Change) -> Change:
    """Refuse a change that does not fit the problem."""
    n, k = contact.rigid_motions.shape
    if not isinstance(change, tuple) or len(change) != 2:
        raise ProblemError(
            f"{key}: a change needs an offset ({n},) and a load ({k},), as in bemcontact.Change(offset, load); found "
            f"{shown(change)}"
        )
    offset, load = change
    return Change(
        real_array(offset, f"{key}: the offset of the change", (n,)),
        real_array(load, f"{key}: the load of the change", (k,)),
    )


def _sensitivity(
    contact: CondensedContact, solution: ContactSolution, tangent: Tangent, key: str, change: Change
) -> Sensitivity:
    """Differentiate to the right, and to the left where that may differ."""
    highest = _highest(contact, solution)
    rising = _rates(contact, solution, tangent, key, change, highest, 1.0)
    smooth = not tangent.weak.size and len(highest) == 1
    falling = rising if smooth else _rates(contact, solution, tangent, key, change, highest, -1.0)
    return Sensitivity(key=key, rising=rising, falling=falling)


def _rates(
    contact: CondensedContact,
    solution: ContactSolution,
    tangent: Tangent,
    key: str,
    change: Change,
    highest: IntArray,
    side: float,
) -> Rates:
    """The derivative to one side, per unit by which the parameter rises."""
    towards = Change(side * change.offset, side * change.motion_load)
    try:
        rate = tangent.rate(scaled_change(contact, towards))
    except (ProblemError, SingularSystemError) as error:
        way = "rises" if side > 0 else "falls"
        raise type(error)(f"there is no derivative with respect to {key} as it {way}: {error}") from None
    pressure, _, amplitudes = unscaled(contact, side * rate.pressure, side * rate.amplitudes)
    gap = side * rate.gap * contact.scales.displacement
    about_to_change = np.isin(np.arange(contact.size), tangent.weak)
    return Rates(
        pressure=pressure,
        gap=gap,
        rigid_amplitudes=amplitudes,
        resultant=contact.resultants(pressure),
        peak=side * float((side * pressure[highest]).max()),
        interval_ends=end_rates(contact, solution, np.where(about_to_change, np.nan, gap)),
    )


def _highest(contact: CondensedContact, solution: ContactSolution) -> IntArray:
    """The points that bear the peak pressure."""
    p = solution.pressure
    return np.array(np.flatnonzero(p >= p.max(initial=0.0) - WEAK * contact.scales.pressure), np.int64)


def _notes(contact: CondensedContact, weak: IntArray, highest: IntArray, unique: bool) -> Iterator[str]:
    """Notes on weakly active points, a shared peak and uniqueness."""
    if weak.size:
        verb = "touch" if weak.size > 1 else "touches"
        yield f"{_placed(contact, weak)} {verb} without pressure: derivatives differ as a parameter rises and falls"
    elif highest.size > 1:
        yield f"{_placed(contact, highest)} share the peak pressure: its derivative has two sides"
    if not unique:
        yield NOT_PROVED


def _at_rest(contact: CondensedContact, state: ContactSolution) -> Iterator[str]:
    """Notes on ends of contact without a rate, because they are kept at a point."""
    for x, y in resting_ends(contact, state):
        yield (
            f"the end of contact at ({x:.6g}, {y:.6g}) is that of a point, and stays there under small changes, so "
            "that its rates are zero; follow a path to see it move"
        )


def _placed(contact: CondensedContact, points: IntArray) -> str:
    """Name points by number and place."""
    places = [f"{i} at ({x:g}, {y:g})" for i, (x, y) in zip(points, contact.points[points], strict=True)]
    more = f" and {len(places) - NAMED} more" if len(places) > NAMED else ""
    return f"{'points' if len(points) > 1 else 'point'} {', '.join(places[:NAMED])}{more}"
