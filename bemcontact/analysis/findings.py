"""What is read off an answer to stand beside a statement of the paper."""

from collections.abc import Callable

import numpy as np

from bemcontact.analysis.paper import Quantity, Statement
from bemcontact.analysis.study import MeshLevel
from bemcontact.arrays import Array
from bemcontact.problem import Problem, Table, Units, Values
from bemcontact.reference.positions import coordinates

Found = tuple[float, ...]
"""A number, from where to where numbers go, or nothing where there is none."""
LEVEL = 1e-9
"""Part of an extent, or of a scale, below which a difference is round-off."""


def along(problem: Problem) -> Values | Table:
    """Find the coordinate of a problem: that of the first of its references which has one.

    Raises
    ------
    ValueError
        No reference has.
    """
    for reference in problem.reference.values():
        if isinstance(reference, Values | Table):
            return reference
    raise ValueError(f"{problem.name}: no reference is a list of values or a table, so that it has no coordinate")


def positions(level: MeshLevel, axis: Values | Table) -> Array:
    """Coordinate (n,) of the contact points [L], or in degrees."""
    contact = level.answer.contact
    return coordinates(axis, contact.points, contact.arc_position)


def extent(level: MeshLevel, axis: Values | Table) -> Found:
    """Smallest and largest coordinate of the ends of contact [L], or in degrees; empty without contact."""
    intervals = level.answer.footprint.intervals
    if not intervals:
        return ()
    ends = np.array([end for item in intervals for end in (item.start, item.end)])
    arcs = np.array([arc for item in intervals for arc in (item.start_arc, item.end_arc)])
    here = coordinates(axis, ends, arcs)
    low, high = float(here.min()), float(here.max())
    return (0.0 if abs(low) <= LEVEL * abs(high) else low, high)


def found(statement: Statement, level: MeshLevel, axis: Values | Table) -> Found:
    """Read what a statement is about off an answer.

    Parameters
    ----------
    statement : of the paper
    level : a problem on one mesh
    axis : the coordinate, as of `along`

    Returns
    -------
    tuple of float
        One number, or the smallest and the largest; empty where there is none, such as the ends of no contact.
    """
    return READERS[statement.quantity](statement, level, axis)


def unit_of(statement: Statement, axis: Values | Table, units: Units) -> str:
    """Label of the unit of what is found."""
    match statement.quantity:
        case Quantity.PRESSURE | Quantity.PEAK:
            return units.stress
        case Quantity.FORCE:
            return f"{units.force}/{units.length}" if units.stress else ""
        case Quantity.CONTACT if axis.against == "angle":
            return "°"
        case Quantity.CONTACT | Quantity.LEAST_GAP:
            return units.length
    return ""


def _pressure(statement: Statement, level: MeshLevel, axis: Values | Table) -> Found:
    """The smallest and the largest pressure of a range; one number if they are of one point."""
    here, pressure = positions(level, axis), level.answer.solution.pressure
    if statement.between is not None:
        slack = LEVEL * float(np.ptp(here))
        low, high = statement.between
        pressure = pressure[(here >= low - slack) & (here <= high + slack)]
    ends = (float(pressure.min()), float(pressure.max())) if len(pressure) else ()
    return ends[: len(pressure)]


def _peak(_: Statement, level: MeshLevel, axis: Values | Table) -> Found:
    peak = level.answer.footprint.peak
    return () if peak is None else (peak.pressure,)


def _open_points(_: Statement, level: MeshLevel, axis: Values | Table) -> Found:
    return (float(np.count_nonzero(~level.answer.touching)),)


def _least_gap(_: Statement, level: MeshLevel, axis: Values | Table) -> Found:
    """The smallest gap; round-off is zero."""
    contact = level.answer.contact
    gap = float((contact.initial_gap + level.answer.solution.displacement).min())
    return (0.0 if abs(gap) <= LEVEL * contact.scales.displacement else gap,)


def _force(statement: Statement, level: MeshLevel, axis: Values | Table) -> Found:
    return (abs(float(np.dot(level.answer.footprint.resultant.force, statement.direction))),)


def _apart(_: Statement, level: MeshLevel, axis: Values | Table) -> Found:
    compared = level.comparison
    apart = [item.unpolished for item in compared.differences if item.other == compared.reference.label]
    return (max(apart),) if apart else ()


READERS: dict[Quantity, Callable[[Statement, MeshLevel, Values | Table], Found]] = {
    Quantity.PRESSURE: _pressure,
    Quantity.PEAK: _peak,
    Quantity.CONTACT: lambda _, level, axis: extent(level, axis),
    Quantity.OPEN_POINTS: _open_points,
    Quantity.LEAST_GAP: _least_gap,
    Quantity.FORCE: _force,
    Quantity.APART: _apart,
}
"""Quantity -> how it is read off."""
