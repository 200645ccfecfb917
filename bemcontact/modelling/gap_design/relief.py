"""The set of profiles of a design: bounds on values, slope and curvature, or on a few shapes."""

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import Any, NamedTuple, Self

import numpy as np
import scipy
from numpy.typing import ArrayLike

from bemcontact.arrays import Array, IntArray, freeze_arrays, real_array
from bemcontact.cached import cached_property
from bemcontact.checks.arguments import real_number, shown
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen

ReliefShape = Callable[[Array], ArrayLike]
Range = float | tuple[float, float]
UNBOUNDED = 3
"""Status of an unbounded linear program of SciPy."""


class Bounds(NamedTuple):
    """Rows W (r, s) with limits low <= W c <= high, (r,) each."""

    rows: Array
    low: Array
    high: Array


@frozen
class Relief:
    """Bounds on a profile g that is added to the initial gap: g > 0 removes material. All given bounds hold at once.

    Parameters
    ----------
    lower, upper : of g [L], a number or one for each point of the interval
    slope : of g between neighboring points [1], ± a number or (least, largest)
    curvature : of g at inner points, by second divided differences over arc length [1/L], likewise
    shapes : functions of the arc position (m,) that g is a combination of, or their values (m, s) at the points of the
        interval; without them each point has a value of its own
    coefficients : (least, largest) of the shapes' coefficients, numbers or (s,) each

    Raises
    ------
    ProblemError
        Bounds that are no numbers or exclude each other, shapes of another kind, or coefficients without shapes.
    """

    lower: ArrayLike | None = None
    upper: ArrayLike | None = None
    slope: Range | None = None
    curvature: Range | None = None
    shapes: Sequence[ReliefShape] | Array | None = None
    coefficients: tuple[ArrayLike, ArrayLike] | None = None

    def __post_init__(self) -> None:
        """Refuse what no interval could make right."""
        for name, pair in self._bounds.items():
            _limits(pair, None, name)
        if isinstance(self.shapes, np.ndarray):
            real_array(self.shapes, "shapes", (None, None))
        elif self.shapes is None:
            if self.coefficients is not None:
                raise ProblemError("coefficients belong to shapes; give shapes, or lower and upper values")
        elif not isinstance(self.shapes, Sequence) or not self.shapes or not all(map(callable, self.shapes)):
            raise ProblemError(
                "shapes must be a list of functions of the arc position, or an array (m, s) of their values at m "
                f"points; found {shown(self.shapes)}"
            )

    @property
    def _bounds(self) -> dict[str, tuple[ArrayLike | None, ArrayLike | None]]:
        """What is bounded -> the least and the largest, as given."""
        given = self.lower is not None or self.upper is not None
        pairs: dict[str, Any] = {"values": (self.lower, self.upper)} if given else {}
        for name in ("slope", "curvature"):
            if (given := getattr(self, name)) is not None:
                pairs[name] = given if isinstance(given, tuple) else _both_signs(given, name)
        return pairs if self.coefficients is None else {**pairs, "coefficients": self.coefficients}


@frozen
class Profiles:
    """The set of profiles g = S c with low <= W c <= high, at all n contact points of a problem; all of it is in [L].

    Parameters
    ----------
    points : (m,) indices of the contact points on the interval, in the order of the boundary
    shapes : (n, s) S, zero off the interval, the largest entry of each column 1
    rows : (r, s) W, the largest entry of each row 1
    low, high : (r,) [L]
    family : (r,) number in `families` of each row
    families : what is bounded, in words
    sizes : (s,) largest entry of each shape as it was given: user's coefficients are c / sizes
    shaped : whether shapes were given; if not, each point has a coefficient of its own
    """

    points: IntArray
    shapes: Array
    rows: Array
    low: Array
    high: Array
    family: IntArray
    families: tuple[str, ...]
    sizes: Array
    shaped: bool

    def __post_init__(self) -> None:
        """Make arrays read-only."""
        freeze_arrays(self)

    @classmethod
    def of(
        cls, contact: CondensedContact, relief: Relief, zone: str | None = None, arc: tuple[float, float] | None = None
    ) -> Self:
        """Write bounds as rows, on the whole zone or on an interval of arc positions [L].

        The zone may be left out if there is one only. `ProblemError` if there is no such zone or no point on the
        interval, shapes do not fit, the profile is not bounded, or bounds exclude each other.
        """
        points = _interval(contact, zone, arc)
        position, run = contact.arc_position[points], contact.run[points]
        given = _shapes(relief, position)
        sizes = np.abs(given).max(axis=0)
        shapes = np.zeros((contact.size, len(sizes)))
        shapes[points] = given / sizes
        families = _families(relief, shapes[points], sizes, position, run)
        rows, low, high = (np.concatenate(parts) for parts in zip(*families.values(), strict=True))
        size, family = (
            np.abs(rows).max(axis=1),
            np.repeat(np.arange(len(families)), [len(b.low) for b in families.values()]),
        )
        kept = (size > 0) | (low > 0) | (high < 0)  # what no profile changes and none violates bounds nothing
        size = np.where(size > 0, size, 1.0)
        profiles = cls(
            points=points,
            shapes=shapes,
            rows=(rows / size[:, None])[kept],
            low=(low / size)[kept],
            high=(high / size)[kept],
            family=family[kept],
            families=tuple(families),
            sizes=sizes,
            shaped=relief.shapes is not None,
        )
        profiles._ensure_some()
        return profiles

    def extreme(self, weights: Array) -> Array:
        """Find the coefficients (s,) of the profile with the least weights·g; weights (n,) at all contact points."""
        coefficients = self._least(self.shapes.T @ weights, range(len(self.families)))
        if coefficients is None or not np.isfinite(coefficients).all():
            raise ProblemError("the profile has no bound; give lower and upper values, or bounds on coefficients")
        return coefficients

    def nearest_to_none(self) -> Array:
        """Find the coefficients (s,) of a profile whose largest value is as small as can be."""
        there = self.shapes[self.points]
        below = np.hstack([np.vstack([there, -there]), -np.ones((2 * len(there), 1))])
        rows, limits = self._one_sided(range(len(self.families)))
        matrix = np.vstack([np.hstack([rows, np.zeros((len(rows), 1))]), below])
        cost = np.append(np.zeros(there.shape[1]), 1.0)
        optimum = scipy.optimize.linprog(
            cost, A_ub=matrix, b_ub=np.append(limits, np.zeros(len(below))), bounds=(None, None)
        )
        return self._unit * optimum.x[:-1]

    def kept(self, coefficients: Array) -> Array:
        """Move coefficients (s,) [L] that keep the bounds to the tolerance of a solver inwards to the exact bounds."""
        inner, now = self.rows @ self._innermost, self.rows @ coefficients
        over = np.stack([now - self.high, self.low - now])
        ways = np.stack([now - inner, inner - now])
        outside = (over > 0) & (ways > over)  # not where both limits are one
        share = float((over[outside] / ways[outside]).max(initial=0.0))
        return coefficients + share * (self._innermost - coefficients)

    @cached_property
    def _innermost(self) -> Array:
        """The c (s,) [L] that keeps farthest from all limits between which there is room."""
        rows, limits = self._one_sided(range(len(self.families)))
        bounded = np.isfinite(np.concatenate([self.high, -self.low]))
        room = np.tile(self.high > self.low, 2)[bounded, None].astype(float)
        cost = np.append(np.zeros(rows.shape[1]), -1.0)
        optimum = scipy.optimize.linprog(
            cost, A_ub=np.hstack([rows, room]), b_ub=limits, bounds=[(None, None)] * rows.shape[1] + [(0, 1)]
        )
        return self._unit * optimum.x[:-1]

    @cached_property
    def value_range(self) -> tuple[Array, Array]:
        """Least and largest g (n,) [L] that each point by itself may have."""
        unit = np.eye(len(self.shapes))
        low, high = np.zeros(len(unit)), np.zeros(len(unit))
        for i in self.points:
            low[i] = self.shapes[i] @ self.extreme(unit[i])
            high[i] = self.shapes[i] @ self.extreme(-unit[i])
        return low, high

    @cached_property
    def _unit(self) -> float:
        """The largest bound [L], in which linear programs are written."""
        limits = np.abs(np.concatenate([self.low, self.high]))
        return float(limits[np.isfinite(limits)].max(initial=0.0)) or 1.0

    def _one_sided(self, families: Iterable[int]) -> tuple[Array, Array]:
        """Rows and limits of W c <= high, -W c <= -low in some families, without those that bound nothing."""
        used = np.isin(self.family, list(families))
        rows, limits = np.vstack([self.rows, -self.rows]), np.concatenate([self.high, -self.low]) / self._unit
        kept = np.tile(used, 2) & np.isfinite(limits)
        return rows[kept], limits[kept]

    def _least(self, cost: Array, families: Iterable[int]) -> Array | None:
        """The c with the least cost·c within some families of bounds; None if they exclude each other."""
        rows, limits = self._one_sided(families)
        optimum = scipy.optimize.linprog(cost, A_ub=rows, b_ub=limits, bounds=(None, None))
        if optimum.status == UNBOUNDED:
            return np.full(len(cost), np.inf)
        return self._unit * optimum.x if optimum.success else None

    def _ensure_some(self) -> None:
        """Refuse bounds that exclude each other, by the fewest of them that do, and profiles without bounds."""
        everything, none = range(len(self.families)), np.zeros(self.shapes.shape[1])
        if self._least(none, everything) is None:
            few = next(
                some
                for count in range(1, len(self.families) + 1)
                for some in combinations(everything, count)
                if self._least(none, some) is None
            )
            names = " and ".join(self.families[i] for i in few)
            raise ProblemError(
                f"no profile keeps the bounds on {names}; widen {'it' if len(few) == 1 else 'one of them'}"
            )
        for weights in (self.shapes.sum(axis=1), -self.shapes.sum(axis=1)):
            self.extreme(weights)


def _interval(contact: CondensedContact, zone: str | None, arc: tuple[float, float] | None) -> IntArray:
    """Indices of the contact points on an interval, by run and arc position."""
    names = contact.zone_names
    if not isinstance(zone, str | None):
        raise ProblemError(f"zone must be the name of a contact zone; found {shown(zone)}")
    if zone is None and len(names) > 1:
        raise ProblemError(f"say which zone is to be relieved: {', '.join(names)}")
    if zone is not None and zone not in names:
        raise ProblemError(f"there is no contact zone '{zone}'; there are: {', '.join(names)}")
    inside = contact.zone == (0 if zone is None else names.index(zone))
    if arc is not None:
        arc = _pair(arc, "arc, the least and largest arc position,")
        inside &= (contact.arc_position >= arc[0]) & (contact.arc_position <= arc[1])
    points = np.flatnonzero(inside)
    if not len(points):
        where = "in the zone" if arc is None else f"between the arc positions {arc[0]:g} and {arc[1]:g}"
        raise ProblemError(
            f"there is no contact point {where}; arc positions are lengths along the edge from its start"
        )
    return contact.in_order(points)


def _shapes(relief: Relief, position: Array) -> Array:
    """The shapes (m, s) as they were given; the unit vectors if none were."""
    m = len(position)
    if relief.shapes is None:
        return np.eye(m)
    if isinstance(relief.shapes, np.ndarray):
        shapes = np.atleast_2d(real_array(relief.shapes, "shapes"))
    else:
        columns = [_on_points(shape(position), number, m) for number, shape in enumerate(relief.shapes)]
        shapes = np.column_stack(columns) if columns else np.zeros((m, 0))
    if shapes.ndim != 2 or shapes.shape[0] != m or not shapes.shape[1]:
        raise ProblemError(
            f"shapes need finite values at the {m} points of the interval; found an array {shapes.shape}"
        )
    if not np.abs(shapes).max(axis=0).all():
        raise ProblemError(f"shape {int(np.argmin(np.abs(shapes).max(axis=0)))} is zero on the interval; leave it out")
    return shapes


def _families(relief: Relief, shapes: Array, sizes: Array, position: Array, run: IntArray) -> dict[str, Bounds]:
    """All bounds by family, as rows W with their limits: low <= W c <= high."""
    m, step = len(position), np.diff(position)
    inner = np.flatnonzero(run[1:] == run[:-1])
    slopes = (np.eye(m)[1:] - np.eye(m)[:-1])[inner] / step[inner, None]
    bent = np.flatnonzero((np.diff(inner) == 1) & (run[inner[:-1]] == run[inner[1:]])) if len(inner) > 1 else inner[:0]
    width = (step[inner[bent]] + step[inner[bent] + 1]) / 2
    curvatures = (slopes[bent + 1] - slopes[bent]) / width[:, None]
    rows = {
        "values": shapes,
        "slope": slopes @ shapes,
        "curvature": curvatures @ shapes,
        "coefficients": np.eye(len(sizes)),
    }
    families: dict[str, Bounds] = {}
    for name, pair in relief._bounds.items():
        if len(rows[name]):
            low, high = _limits(pair, len(rows[name]), name)
            size = sizes if name == "coefficients" else 1.0
            families[name] = Bounds(rows[name], low * size, high * size)
    if not families:
        raise ProblemError("nothing bounds the profile; give lower and upper values, or shapes with coefficients")
    return families


def _on_points(values: ArrayLike, number: int, count: int) -> Array:
    """Values (count,) of a shape, which may be the same everywhere."""
    array = real_array(values, f"shape {number}")
    if array.shape not in ((), (1,), (count,)):
        raise ProblemError(f"shape {number} has {array.shape} values where ({count},) are needed, one for each point")
    return np.broadcast_to(array, count)


def _both_signs(given: object, what: str) -> tuple[float, float]:
    """The bounds ± a number."""
    number = real_number(given, f"the bound on {what}, or each of a pair (least, largest),")
    if number < 0:
        raise ProblemError(f"the bound on {what} holds in both directions, so it is not negative; found {number:g}")
    return -number, number


def _pair(given: object, what: str) -> tuple[float, float]:
    """Read two finite numbers."""
    array = real_array(given, what, (2,))
    return float(array[0]), float(array[1])


def _limits(pair: tuple[ArrayLike | None, ArrayLike | None], count: int | None, what: str) -> tuple[Array, Array]:
    """Least and largest (count,), infinite where not given; without a count, as many as are given."""
    if not isinstance(pair, tuple | list) or len(pair) != 2:
        raise ProblemError(f"bounds on {what} are a least and a largest one, (least, largest); found {shown(pair)}")
    limits = []
    for given, otherwise in zip(pair, (-np.inf, np.inf), strict=True):
        numbers = real_array(otherwise if given is None else given, f"bounds on {what}", finite=False)
        real_array(numbers[~np.isinf(numbers)], f"bounds on {what}")  # none is too large; infinite ones are allowed
        limits.append(numbers)
    count = max(numbers.size for numbers in limits) if count is None else count
    for numbers in limits:
        if numbers.ndim and numbers.shape != (count,):
            raise ProblemError(f"bounds on {what} are a number or {count} of them; found an array {numbers.shape}")
    low, high = (np.broadcast_to(numbers, count).astype(float) for numbers in limits)
    if not (low <= high).all():
        raise ProblemError(f"the lower bound on {what} is above the upper one; exchange them")
    return low, high
