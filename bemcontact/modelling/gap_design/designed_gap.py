"""A designed gap: the profile, the contact states without and with it, and the proof of optimality."""

from dataclasses import replace
from enum import StrEnum

import numpy as np
from pydantic import computed_field, field_serializer

from bemcontact.arrays import Array, IntArray, freeze_arrays
from bemcontact.assessment.certificate import Certificate
from bemcontact.assessment.footprint import Footprint, FootprintRecord, footprint_record
from bemcontact.assessment.residual import Residuals
from bemcontact.checks.arguments import shown
from bemcontact.checks.attributes import WithHints
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.solution import ContactSolution
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen
from bemcontact.problems.surface_lines import Polyline, Spline
from bemcontact.serialization import Internal, Leaf, Pairs, Vector
from bemcontact.views import Tabular

AGREED = 1e-6
"""Difference of the designed pressure from that of the contact state, over the peak, up to which they agree."""
STEEP = 3.0
"""Peak at an end of a zone, over the pressures at the two points beside it, above which it is taken for infinite."""
SURFACES = {"spline": Spline, "polyline": Polyline}


class Goal(StrEnum):
    """Quantity that a design minimizes, in the worst of all load states."""

    PEAK = "peak"
    UNIFORM = "uniform"
    VON_MISES = "von_mises"


MEASURED = {
    Goal.PEAK: "The largest pressure",
    Goal.UNIFORM: "The root mean square deviation from a uniform pressure",
    Goal.VON_MISES: "The largest von Mises stress at the given points",
}


class LoadStateRecord(FootprintRecord):
    """Contact state of a load state; JSON has its footprint without nesting."""

    pressure: Vector
    """Pressure at each contact point per undeformed length [p]."""
    residuals: Residuals
    """Residuals of the contact conditions and equations."""
    certificate: Certificate
    """What is proved."""


@frozen
class LoadState(WithHints):
    """A contact state, solved by the direct solver and assessed."""

    contact: CondensedContact
    solution: ContactSolution
    residuals: Residuals
    certificate: Certificate
    footprint: Footprint

    @property
    def pressure(self) -> Array:
        """The pressure (n,) [p]."""
        return self.solution.pressure

    @property
    def peak(self) -> float:
        """The largest pressure [p]."""
        return self.contact.peak(self.pressure)

    @property
    def infinite(self) -> bool:
        """Whether the peak rises steeply to an end of a zone, as at a sharp edge: then it is a number of the mesh.

        Points beside it without pressure tell nothing: so is a round body on a coarse mesh, cut at a line of symmetry.
        """
        at = int(np.argmax(self.pressure))
        own = self.contact.points_of_run(int(self.contact.run[at]))
        if np.isfinite(self.contact.run_length[self.contact.run[at]]) or at not in own[[0, -1]]:
            return False
        beside = own[1:3] if at == own[0] else own[-3:-1]
        pressed = self.pressure[beside]
        return bool((pressed > 0).all() and self.pressure[at] > STEEP * pressed.max(initial=0.0))

    def record(self) -> LoadStateRecord:
        """Return the JSON form of the state."""
        return LoadStateRecord(
            pressure=self.pressure,
            **dict(footprint_record(self.footprint)),
            residuals=self.residuals,
            certificate=self.certificate,
        )


@frozen
class GapDesign(Leaf, Tabular):
    """A designed profile, with the contact states of all load states without and with it."""

    goal: Goal
    """What is made small."""
    zone: str
    """Name of the contact zone."""
    points: IntArray
    """Contact points on the interval of the profile: their indices (m,); in JSON their places (x, y) [L]."""
    profile: Array
    """Profile, which is added to the initial gap [L]: at all n contact points; in JSON at those of the interval."""
    coefficients: Vector | None
    """Coefficients of the shapes, if the profile is made of some."""
    before: tuple[LoadState, ...]
    """Contact states without the profile."""
    after: tuple[LoadState, ...]
    """Contact states with the profile."""
    designed: Internal[Array]
    """Pressure (loads, n) on the designed contact sets, with which that of `after` is to agree [p]."""
    value_before: float
    """Value of the goal without the profile [p]."""
    value: float
    """Value of the goal with the profile [p]."""
    lower_bound: float
    """Lower bound of the goal within the bounds on the profile, by convex relaxation [p]."""
    proved_optimal: bool
    """Whether the value is at the bound, to a millionth."""
    von_mises_limit: float | None = None
    """Limit of von Mises's stress at the given points, if there is one [p]."""
    von_mises: float | None = None
    """Largest von Mises stress at the given points with the profile, of all load states; None without points [p]."""

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    def __repr__(self) -> str:
        """One line: zone, goal, values."""
        return f"<GapDesign on {self.zone!r}: {self.goal.value} {self.value_before:.6g} -> {self.value:.6g}>"

    @property
    def peak_before(self) -> float:
        """The largest pressure of all load states without the profile [p]."""
        return max(state.peak for state in self.before)

    @property
    def peak(self) -> float:
        """The largest pressure of all load states with the profile [p]."""
        return max(state.peak for state in self.after)

    @field_serializer("points")
    def _places(self, points: IntArray) -> Pairs:
        return self.before[0].contact.points[points]

    @field_serializer("profile")
    def _on_interval(self, profile: Array) -> Vector:
        return profile[self.points]

    @field_serializer("before", "after")
    def _records(self, states: tuple[LoadState, ...]) -> list[LoadStateRecord]:
        return [state.record() for state in states]

    @computed_field
    @property
    def arc_position(self) -> Vector:
        """Arc position of the points [L]."""
        return self.before[0].contact.arc_position[self.points]

    @computed_field
    @property
    def difference(self) -> float:
        """Largest difference of the designed pressure from that of the contact state, over the peak."""
        reached = np.array([state.pressure for state in self.after])
        return float(np.abs(reached - self.designed).max()) / (self.peak or 1.0)

    @computed_field
    @property
    def verified(self) -> bool:
        """Whether all load states with the profile are certified and as designed, to a millionth.

        They have the designed pressure, and von Mises's stress is within its limit.
        """
        return all(state.certificate.certified for state in self.after) and self.difference <= AGREED and self._within

    @property
    def _within(self) -> bool:
        """Whether von Mises's stress of the contact states is within its limit, if there is one."""
        return (
            self.von_mises_limit is None
            or self.von_mises is None
            or self.von_mises <= self.von_mises_limit * (1 + AGREED)
        )

    @computed_field
    @property
    def words(self) -> str:
        """The result and what is proved about it, in a few sentences."""
        change = f" ({100 * (self.value / self.value_before - 1):+.1f} %)" if self.value_before > 0 else ""
        worst = f", the worst of {len(self.after)} load states" if len(self.after) > 1 else ""
        change_of_goal = f"{MEASURED[self.goal]} goes from {self.value_before:.5g} to {self.value:.5g}{change}{worst}."
        if self.goal is Goal.PEAK and any(state.infinite for state in self.before):
            change_of_goal = (
                f"{MEASURED[self.goal]} is {self.value:.5g} with the profile{worst}. Without it, it is infinite in "
                f"theory, as at a sharp edge, and {self.value_before:.5g} on this mesh."
            )
        if self.proved_optimal:
            proof = "No profile within the bounds does better: the lower bound of the convex relaxation is met."
        else:
            proof = (
                f"Whether another profile does better is not proved: none goes below {self.lower_bound:.5g}, the lower "
                "bound of the convex relaxation."
            )
        if self.verified:
            how = (
                f"pressures differ by {self.difference:.0e} of the peak"
                if self.difference
                else "pressures are the same"
            )
            check = f"Solved again with the profile and certified: {how}."
        else:
            check = (
                f"The contact states with the profile are not as designed: pressures differ by {self.difference:.0e} "
                f"of the peak. {' '.join(state.certificate.words for state in self.after)}"
            )
        if self.von_mises_limit is not None:
            check += (
                f" Von Mises's stress at the given points is {self.von_mises:.5g}, limit {self.von_mises_limit:.5g}."
            )
        return f"{change_of_goal}{self._elsewhere} {proof} {check}{self._at_an_end}"

    @property
    def _elsewhere(self) -> str:
        """Say if the largest pressure is where the profile is not."""
        highest = max(self.after, key=lambda state: state.peak)
        inside = self.goal is not Goal.PEAK or int(np.argmax(highest.pressure)) in self.points
        return (
            "" if inside else " The largest pressure is now outside of the interval, where the profile cannot lower it."
        )

    @property
    def _at_an_end(self) -> str:
        """Say if contact reaches an end of the zone, where pressures at nodes do not tell that between them."""
        contact = self.before[0].contact
        runs = np.unique(contact.run[contact.zone == contact.zone[self.points[0]]])
        ends = [contact.points_of_run(run)[[0, -1]] for run in runs.tolist() if np.isinf(contact.run_length[run])]
        reached = sum(bool((state.pressure[np.ravel(ends).astype(int)] > 0).any()) for state in self.after)
        return (
            f" Contact reaches an end of the zone in {reached} of {len(self.after)} load states. If this is no line of "
            "symmetry, and the surface or the body has a sharp edge there, the pressure at it is infinite with any "
            "profile, and all of these numbers hold at the contact points of this mesh only."
            if reached
            else ""
        )

    def surface(self, kind: str = "spline") -> Spline | Polyline:
        """Make a rigid surface of the zone's own and the profile, through the feet of all its contact points.

        Its normals are tilted by the slope of the profile, which a contact problem on it sees as a relative change of
        pressure by about that slope. Tools are at their undisplaced place. Between two elastic bodies the profile is to
        be taken off one of them, and this surface is not the other one.

        Parameters
        ----------
        kind : "spline" or "polyline"

        Raises
        ------
        ProblemError
            The kind is unknown, the zone has several pieces or goes round, or the surface would fold.
        """
        if not isinstance(kind, str) or kind not in SURFACES:
            raise ProblemError(f"there is no surface of kind {shown(kind)} to write; there are: {', '.join(SURFACES)}")
        contact = self.before[0].contact.at_rest()
        inside = np.flatnonzero(contact.zone == contact.zone[self.points[0]])
        runs = np.unique(contact.run[inside])
        if len(runs) > 1 or np.isfinite(contact.run_length[runs[0]]):
            raise ProblemError(f"zone '{self.zone}' goes round or is in pieces, which no {kind} does; divide the zone")
        inside = contact.in_order(inside)
        normals = contact.normals[inside]
        feet = contact.points[inside] - (contact.initial_gap + self.profile)[inside, None] * normals
        steps = np.diff(feet, axis=0)
        lefts = np.column_stack([-steps[:, 1], steps[:, 0]])
        if len(feet) < 2 or not (np.einsum("ki,ki->k", lefts, normals[1:] + normals[:-1]) > 0).all():
            raise ProblemError("the designed surface folds back on itself; ask for less slope, or a coarser mesh")
        return SURFACES[kind](points=tuple((float(x), float(y)) for x, y in feet))

    def to_yaml(self, kind: str = "spline") -> str:
        """Write the `surface` of a kind as YAML, to go below the ``edges`` of a contact zone in a spec."""
        points = "".join(f"    - [{_number(x)}, {_number(y)}]\n" for x, y in self.surface(kind).points)
        return f"surface:\n  kind: {kind}\n  points:\n{points}"


def relieved(contact: CondensedContact, profile: Array) -> CondensedContact:
    """Add a profile (n,) [L] to the initial gap."""
    return replace(contact, initial_gap=contact.initial_gap + profile)


def _number(value: float) -> str:
    """All digits, with the point that YAML wants before an exponent."""
    mantissa, e, exponent = repr(value).partition("e")
    return mantissa + ("" if "." in mantissa or not e else ".0") + e + exponent
