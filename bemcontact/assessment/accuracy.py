"""Error bars of a result, and whether they are as small as was asked."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import inf
from typing import ClassVar, Literal, Self, get_args

from pydantic import computed_field

from bemcontact.checks.attributes import ERROR, PEAK, PLACE, Words
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen_value
from bemcontact.serialization import Leaf, Pair

Quantity = Literal[
    "peak", "force", "start", "end", "length", "pressure", "displacement", "intensity", "motion", "rotation"
]
"""What an error bar is of."""
TOLD: tuple[Quantity, ...] = ("length", "intensity", "motion", "rotation")
"""Quantities that are told with their error bars, and to which the accuracy asked for does not apply."""


@frozen_value
class ErrorBar(Leaf):
    """A quantity with its estimated error."""

    _home = "accuracy.bars"
    _called: ClassVar[Words] = {
        "bar, which is relative": ERROR,
        "value": (*PEAK[1:], "force", "forces", "pressure", "displacement", "magnitude", "start", "end", "motion"),
        "at": PLACE,
        "quantity": ("name", "kind", "what"),
    }

    quantity: Quantity
    """Quantity: peak pressure, force on a zone, start, end or length of a contact interval, the pressure as a whole,
    largest displacement, intensity of an infinite pressure, or motion or rotation of a tool or along a free motion."""
    zone: str | None
    """Name of the contact zone; null for displacements and motions."""
    interval: int | None = None
    """Number of the contact interval of a start, an end or a length, from 0 on; null for others."""
    mover: str | None = None
    """Name of the tool or of the free motion of a motion or a rotation; null for others."""
    value: float | None
    """Value: pressure [p], sum of the magnitudes of the contact forces per thickness [p L], position along the run of
    the zone or length [L], root of the mean square of the pressure [p], displacement or motion [L], rotation [rad], or
    intensity K of p = K s^-α [p L^α]; null if there is none."""
    bar: float | None
    """Estimated error, relative to the value; of a start or an end, to the length of its interval. Null if unknown."""
    at: Pair | None = None
    """Place (x, y) of a start or an end of contact, of an infinite pressure, from which s is measured, or of the
    largest displacement if it is the only one [L]; null for others."""
    note: str = ""
    """Why there is no value or no error bar, or what they mean."""

    def __repr__(self) -> str:
        """One line: of what it is, its value, and the error, which is relative."""
        to = "the length of the interval" if self.quantity in ("start", "end") else "the value"
        value = "no value" if self.value is None else f"value {self.value:.6g}"
        bar = "bar not known" if self.bar is None else f"bar {self.bar:.2g} relative to {to}"
        return f"<ErrorBar of {self.name}: {value}, {bar}{'; ' * bool(self.note)}{self.note}>"

    @property
    def name(self) -> str:
        """Quantity and owner: ``end of 'foot', interval 0``."""
        owner = self.zone or self.mover
        of = f"{self.quantity} of {owner!r}" if owner else self.quantity
        return of if self.interval is None else f"{of}, interval {self.interval}"

    @computed_field
    @property
    def promised(self) -> bool:
        """Whether the accuracy asked for applies to it: not to lengths, intensities, motions and rotations.

        Nor does it where there is nothing to estimate.
        """
        nothing = self.value is None or (self.quantity == "force" and self.value == 0)
        return self.quantity not in TOLD and not (self.bar is None and nothing)


@frozen_value
class Accuracy(Leaf):
    """Accuracy that was asked for, and what was reached."""

    _called: ClassVar[Words] = {
        'bar_of, such as bar_of("peak", "foot")': (
            *PEAK, *get_args(Quantity), "forces", "ends", "width", "error_bar", "error_bars", "errors",
        ),
        "worst": ("error", "max_error", "largest", "largest_error", "relative_error", "value", "tolerance"),
        "met": ("ok", "success", "converged", "status"),
    }  # fmt: skip

    asked: float | None
    """Relative accuracy asked for; null if none is."""
    met: bool | None = None
    """Whether all error bars are below it to which it applies, `promised`; null if errors were not estimated."""
    passes: int = 0
    """Number of meshes whose errors were estimated; 1 for a mesh that was stated."""
    bars: tuple[ErrorBar, ...] = ()
    """Error bars of all quantities."""
    reason: str = ""
    """Why no better accuracy was reached, or why errors were not estimated."""

    @classmethod
    def of(cls, asked: float, passes: int, bars: Sequence[ErrorBar]) -> Self:
        """Judge error bars."""
        judged = cls(asked=asked, passes=passes, bars=tuple(bars))
        return replace(judged, met=bool(judged.worst <= asked))

    @property
    def holds(self) -> bool | None:
        """Whether the accuracy asked for is met; None if none is asked for, so that mesh errors are not assessed."""
        return None if self.asked is None else bool(self.met)

    @property
    def worst(self) -> float:
        """Largest error bar of those to which the accuracy applies; infinite if one is unknown."""
        judged = [item for item in self.bars if item.promised]
        return max((inf if item.bar is None else item.bar for item in judged), default=0.0)

    @property
    def in_short(self) -> str:
        """The largest error in a few words."""
        if self.met is None:
            return "error not estimated"
        return f"error at most {100 * self.worst:.2g} %" if self.worst < inf else "error not known"

    @property
    def infinite(self) -> tuple[str, ...]:
        """Names of the zones whose peak pressure is infinite."""
        return tuple(item.zone or "" for item in self.infinite_peaks)

    @property
    def infinite_peaks(self) -> tuple[ErrorBar, ...]:
        """The entries of peaks that are infinite."""
        return tuple(item for item in self.bars if item.quantity == "peak" and item.value is None)

    @property
    def infinite_places(self) -> list[Pair]:
        """Places where pressure is known to be infinite."""
        known = (*self.infinite_peaks, *(item for item in self.bars if item.quantity == "intensity"))
        return [item.at for item in known if item.at is not None]

    def bar_of(self, quantity: Quantity, of: str | None = None, interval: int = 0) -> ErrorBar:
        """Find the error bar of a quantity: ``bar_of("peak", "foot")``, ``bar_of("length", "foot", 1)``.

        Parameters
        ----------
        quantity : one of `Quantity`
        of : name of the zone, tool or free motion; it may be left out where only one has this quantity
        interval : number of the contact interval, for a start, an end or a length

        Raises
        ------
        ProblemError
            None or several of the error bars are meant; the text says which there are.
        """
        named = [item for item in self.bars if item.quantity == quantity and of in (None, item.zone, item.mover)]
        found = [item for item in named if item.interval in (None, interval)]
        if len(found) != 1:
            there = ", ".join(dict.fromkeys(item.name for item in named or self.bars)) or "none: " + self.reason
            what = f"{quantity} of {of}" if of else f"{quantity}"
            raise ProblemError(f"{len(found) or 'no'} error bars of '{what}', interval {interval}; there are: {there}")
        return found[0]

    def peak_bar(self, zone: str | None = None) -> float | None:
        """Estimated error of the largest finite peak pressure, or of that of a zone, relative; None if not known."""
        peaks = [item for item in self.bars if item.quantity == "peak" and zone in (None, item.zone)]
        return bar_of_largest([(item.value, item.bar) for item in peaks if item.value is not None])

    def knowing(self, *others: Self) -> Self:
        """Return the same, with the infinite peaks that were recognized on others of the same problem."""
        known = {item.zone: item for other in others for item in other.infinite_peaks}
        kept = [item for item in self.bars if item.quantity != "peak" or item.zone not in known]
        now = replace(self, bars=(*known.values(), *kept))
        return now if self.met is None else replace(now, met=self.asked is not None and now.worst <= self.asked)


def bar_of_largest(peaks: Sequence[tuple[float, float | None]]) -> float | None:
    """Relative error of the largest of some values with errors: another one may be larger than it seems."""
    if not peaks or any(bar is None for _, bar in peaks):
        return None
    value, own = max(peaks, key=lambda item: item[0])
    most = max(each * (1 + (bar or 0.0)) for each, bar in peaks)
    return max(own or 0.0, most / value - 1) if value else own


def together(judged: Iterable[bool | None]) -> bool | None:
    """Whether all hold: False if one does not, else None if one is not assessed."""
    found = {*judged}
    return False if False in found else None if None in found else True


NO_MESH = Accuracy(asked=None, reason="a condensed problem has no mesh whose errors could be estimated")
"""Accuracy of a problem that is given condensed."""
