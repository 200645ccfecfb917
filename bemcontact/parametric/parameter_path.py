"""A load path as a function of a parameter: the data of its table, file and figure."""

from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from os import PathLike
from typing import Any

import numpy as np
from pydantic import computed_field

from bemcontact.assessment.accuracy import Accuracy, ErrorBar, Quantity, together
from bemcontact.assessment.footprint import ContactInterval, Footprint, footprint
from bemcontact.assessment.penetration import Penetration
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.record import UnitsRecord, units_record
from bemcontact.frozen import frozen
from bemcontact.parametric.path import LoadPath
from bemcontact.serialization import Internal, Leaf, Pair, Pairs, csv_text
from bemcontact.views import VIEWS, Tabular

BETWEEN = (0.25, 0.5, 0.75)
"""Fractions between two breakpoints at which intervals are evaluated, because their ends are not linear."""
ROUND_OFF = 1e-14
"""Fraction of a parameter that counts as zero."""
ROUND_OFF_OF_PEAK = 1e-9
"""Peak over the largest one of the path that counts as zero."""
RESIDUAL = 1e-10
"""Allowed residual at breakpoints, as in the certificate of a single solution."""


@frozen
class PathState(Leaf):
    """A contact state on a load path."""

    value: float
    """Value of the parameter."""
    breakpoint: bool
    """Whether a point enters or leaves contact here, or the path begins or ends."""
    entered: tuple[int, ...]
    """Indices of the points that enter contact, as the parameter goes from start to end."""
    left: tuple[int, ...]
    """Indices of the points that leave contact."""
    peak: float | None
    """Largest pressure [p]; null if it is infinite."""
    at: int | None
    """Index of the point with the largest pressure; null without contact, or if it is infinite."""
    resultant: tuple[Pair, ...]
    """Force (x, y) of the rigid surface of each zone on the body, per thickness [p L]."""
    moments: tuple[float, ...]
    """Moment of this force of each zone about the origin, counterclockwise, per thickness [p L²]."""
    touching: tuple[int, ...]
    """Indices of the points that bear a pressure."""
    footprint: Internal[Footprint]
    """Where the body touches, and how hard."""
    bars: tuple[ErrorBar, ...] = ()
    """Error bars at a breakpoint; empty if errors were not estimated."""

    def bar_of(self, quantity: Quantity, of: str | None = None, interval: int = 0) -> ErrorBar:
        """Find the error bar of a quantity by the name of its zone, as ``result.accuracy.bar_of`` does."""
        return Accuracy(asked=None, bars=self.bars, reason="this is no breakpoint").bar_of(quantity, of, interval)

    @property
    def peak_bar(self) -> float | None:
        """Estimated error of the peak, relative; None if it is not known."""
        return Accuracy(asked=None, bars=self.bars).peak_bar()

    @computed_field
    @property
    def intervals(self) -> tuple[ContactInterval, ...]:
        """Contact intervals, zone by zone; empty without contact."""
        return self.footprint.intervals

    def ends(self, zone: str) -> tuple[list[float], list[float]]:
        """Arc positions of the starts and ends of the intervals of a zone [L]."""
        intervals = [item for item in self.intervals if item.zone == zone]
        return [item.start_arc for item in intervals], [item.end_arc for item in intervals]


@frozen
class ParameterPath(Leaf, Tabular):
    """A load path between two values of a parameter."""

    key: str
    """Key of the parameter."""
    start: float
    """Value of the parameter at the start."""
    end: float
    """Value of the parameter at the end."""
    path: Internal[LoadPath]
    """The path for t from 0 to 1."""
    start_accuracy: Accuracy
    """Accuracy of the mesh at the start."""
    end_accuracy: Accuracy
    """Accuracy of the mesh at the end."""
    penetration: Penetration | None = None
    """Deepest penetration of the boundary at a breakpoint that is not tolerated, or else the largest strains there that
    are not small; null if there are none."""
    penetrates_at: float | None = None
    """Value of the parameter there; null if there is none."""
    said: Internal[tuple[str, ...]] = ()
    """Notes on the states."""
    breakpoint_bars: Internal[tuple[tuple[ErrorBar, ...], ...]] = ()
    """Error bars at each breakpoint; empty if errors were not estimated."""
    result_at: Internal[Callable[[float], object] | None] = None
    """Gives the `bemcontact.Result` at t from 0 to 1, whose errors are not known; None if the body is not known."""

    def __repr__(self) -> str:
        """One line: key, values, the path."""
        counts = f"{len(self.path.parameter)} breakpoints, {self.path.pivots} pivots"
        notes = "".join(f"; {note}" for note in self.notes)
        coarse = f"; {len(self.coarse)} breakpoints with errors larger than asked" if self.coarse else ""
        return f"<ParameterPath of {self.key} from {self.start:g} to {self.end:g}: {counts}{coarse}{notes}>"

    @property
    def contact(self) -> CondensedContact:
        """The contact problem at the start; points, zones and units are those of all."""
        return self.path.start

    @property
    def infinite(self) -> tuple[str, ...]:
        """Names of the zones whose peak pressure is infinite at an end of the path, so that no peak is stated on it."""
        return tuple(dict.fromkeys((*self.start_accuracy.infinite, *self.end_accuracy.infinite)))

    @computed_field
    @property
    def name(self) -> str:
        """Name of the problem."""
        return self.contact.name

    @computed_field
    @property
    def certified(self) -> bool:
        """Whether the path reaches its end, and each state on it is proved to be the contact state, the only one.

        At breakpoints the body penetrates no rigid surface either, and strains are small.
        """
        return self.proved and self.penetration is None

    @property
    def proved(self) -> bool:
        """Whether the path reaches its end, and each state on it is proved to be the only solution of the equations."""
        return self.path.complete and self.path.unique and self.path.residual <= RESIDUAL

    @property
    def holds(self) -> bool | None:
        """Whether it is certified, and the accuracy asked is met at both ends, but where nothing presses.

        None if it is certified, and mesh errors are not assessed.
        """
        ends = ((self.start_accuracy, self.path.pressure[0]), (self.end_accuracy, self.path.pressure[-1]))
        of_meshes = (
            accuracy.holds if accuracy.holds is None or pressure.any() else True for accuracy, pressure in ends
        )
        return together((self.certified, *of_meshes))

    def animate(self, file: str | PathLike[str]) -> None:
        """Write an animation of the body with the pressure on its contact, above the peak pressure.

        Parameters
        ----------
        file : its name ends in .gif, or in .svg, which needs no script

        Raises
        ------
        ProblemError
            The file name has another ending, or the path ends where it begins.
        OSError
            The file cannot be written.
        """
        import_module(VIEWS).animate(self, file)

    def value(self, t: float) -> float:
        """The parameter at t of the path; round-off of its ends counts as zero."""
        value = (1 - t) * self.start + t * self.end
        return value if abs(value) > ROUND_OFF * max(abs(self.start), abs(self.end)) else 0.0

    @computed_field
    @property
    def reaches(self) -> Pair:
        """Values of the parameter between which there is a path."""
        return self.value(self.path.begins_at), self.value(self.path.ends_at)

    @computed_field
    @property
    def unique(self) -> bool:
        """Whether each state is proved to be the only one."""
        return self.path.unique

    @computed_field
    @property
    def residual(self) -> float:
        """Natural residual at the worst breakpoint, over the scales."""
        return self.path.residual

    @computed_field
    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the path and its states, one sentence each."""
        return (*self.path.notes_at(self.value), *self.said)

    @property
    def coarse(self) -> tuple[PathState, ...]:
        """Breakpoints with contact at which the error of the peak is larger than asked, or not known."""
        asked = self.start_accuracy.asked
        if asked is None or not self.breakpoint_bars:
            return ()
        return tuple(state for state in self.pressed if state.peak_bar is None or state.peak_bar > asked)

    @property
    def pressed(self) -> tuple[PathState, ...]:
        """Breakpoints with a finite peak that is more than round-off."""
        least = ROUND_OFF_OF_PEAK * float(self.path.peak.max(initial=0.0))
        return tuple(state for state in self.breakpoints if state.peak is not None and state.peak > least)

    @computed_field
    @property
    def pivots(self) -> int:
        """Number of times that a point enters or leaves contact."""
        return self.path.pivots

    @computed_field
    @property
    def units(self) -> UnitsRecord:
        """Labels of the units."""
        return units_record(self.contact)

    @computed_field
    @property
    def zones(self) -> tuple[str, ...]:
        """Names of the contact zones."""
        return self.contact.zone_names

    @computed_field
    @property
    def points(self) -> Pairs:
        """Undeformed place (x, y) of each contact point [L]."""
        return self.contact.points

    @computed_field
    @cached_property
    def states(self) -> tuple[PathState, ...]:
        """The breakpoints, and three states between each two of them."""
        return tuple(self._states())

    @cached_property
    def breakpoints(self) -> tuple[PathState, ...]:
        """The breakpoints alone."""
        return tuple(state for state in self.states if state.breakpoint)

    def _states(self) -> Iterator[PathState]:
        """States along the path."""
        for i, t in enumerate(self.path.parameter.tolist()):
            yield self._state(t, i)
            if i + 1 < len(self.path.parameter) and (width := self.path.parameter[i + 1] - t) > 0:
                yield from (self._state(float(t + share * width), None) for share in BETWEEN)

    def _state(self, t: float, i: int | None) -> PathState:
        """The state at breakpoint i, or at t."""
        solution = self.path.at(t) if i is None else self.path.breakpoint(i)
        contact = self.path.contact(t)
        where = footprint(contact, solution, infinite=self.infinite)
        p = solution.pressure if where.intervals else np.zeros_like(solution.pressure)  # at first touch: round-off
        return PathState(
            value=self.value(t),
            breakpoint=i is not None,
            entered=() if i is None else self.path.entered[i],
            left=() if i is None else self.path.left[i],
            peak=None if self.infinite else float(p.max(initial=0.0)),
            at=int(p.argmax()) if p.any() and not self.infinite else None,
            resultant=tuple((float(x), float(y)) for x, y in contact.resultants(p)),
            moments=tuple(contact.moments(p).tolist()),
            touching=tuple(np.flatnonzero(p > 0).tolist()),
            footprint=where,
            bars=() if i is None or not self.breakpoint_bars else self.breakpoint_bars[i],
        )

    def to_csv(self) -> str:
        """Write a line for each state; points and arc positions in a cell have blanks between them."""
        parts = ("resultant x", "resultant y", "moment", "starts", "ends")
        of_zones = [f"{zone} {part}" for zone in self.contact.zone_names for part in parts]
        head = (self.key, "breakpoint", "enter", "leave", "peak", "peak error", "peak x", "peak y")
        return csv_text([*head, *of_zones, "nodes in contact"], map(self._line, self.states))

    def _line(self, state: PathState) -> list[Any]:
        """The line of a state in the table."""
        place = (None, None) if state.at is None else self.contact.points[state.at].tolist()
        row = [state.value, int(state.breakpoint), _cell(state.entered), _cell(state.left), state.peak, state.peak_bar]
        row += place
        for zone, force, moment in zip(self.contact.zone_names, state.resultant, state.moments, strict=True):
            row += [*force, moment, *map(_cell, state.ends(zone))]
        return [*row, _cell(state.touching)]


def _cell(numbers: Sequence[float]) -> str:
    """Numbers in one cell."""
    return " ".join(map(repr, numbers))
