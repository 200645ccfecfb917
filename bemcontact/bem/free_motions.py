"""Motions in which bodies and tools move rigidly together: those that contact sees, the others, and their names."""

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Self

import numpy as np

from bemcontact.arrays import Array, BoolArray, short_svd
from bemcontact.bem.bonds import BondedPoints, split_motions
from bemcontact.bem.contact_points import ContactPoints
from bemcontact.bem.mesh import Mesh
from bemcontact.bem.rigid_motions import RigidMotions, echelon
from bemcontact.bem.unit_pressures import UnitPressures
from bemcontact.cached import cached_property
from bemcontact.frozen import frozen
from bemcontact.problems.contact_zone import ToolAction
from bemcontact.problems.problem import Problem
from bemcontact.problems.rigid_surface import DeflectedContour
from bemcontact.problems.validation import Point

MOST_WAYS = 3
"""Largest number of different ways in which parts move together that are named."""
UNSEEN = 1e-9
"""Largest normal displacement at contact points, relative to the motion's own, that counts as zero."""
WALL = 3
"""Least number of points with one normal that are those of a wall."""
MIDDLE = 0.1
"""Distance over the radius up to which a point is the middle of a body."""
BODY = "the body"
"""Name of an only body in sentences."""


@frozen
class PlacedTools:
    """t tools with their contact points; components are x, y and rotation, tool by tool.

    Parameters
    ----------
    names : of the tools
    point : (t, 2) about which each turns [L]
    places : (n, 2) of the contact points beside the surfaces as drawn: less the steps that contact has followed [L]
    motions : (n, 3 t) change -n·w of the gaps by a unit displacement along x and y [1], and by a unit rotation [L]
    free : (3 t,) whether the component is free
    position : (3 t, 1 + c) x, y [L] and rotation [rad] that are given: permanent, then by load case
    force : (3 t, 1 + c) x, y [p L] and moment [p L²] likewise
    """

    names: tuple[str, ...]
    point: Array
    places: Array
    motions: Array
    free: BoolArray
    position: Array
    force: Array

    @classmethod
    def none(cls, points: int, loadings: int) -> Self:
        """No tool, for n contact points and 1 + c loadings."""
        terms = np.zeros((0, loadings))
        return cls(
            names=(), point=np.zeros((0, 2)), places=np.zeros((points, 2)), motions=np.zeros((points, 0)),
            free=np.zeros(0, bool), position=terms, force=terms,
        )  # fmt: skip

    def poles(self, points: ContactPoints) -> Array:
        """Poles (t, 2) of rotation [L]: the middle of a tool's contact points, in directions in which the tool is free.

        A rotation about a point far away can hardly be distinguished from a translation.
        """
        poles = self.point.copy()
        for tool, (x, y, turns) in enumerate(self.free.reshape(-1, 3)):
            moved = np.any(self.motions[:, 3 * tool : 3 * tool + 3], axis=1)
            if turns and moved.any():
                middle = np.average(self.places[moved], axis=0, weights=points.tributary[moved])
                poles[tool] = np.where([y, x], middle, poles[tool])
        return poles


def placed_tools(problem: Problem, points: ContactPoints) -> PlacedTools:
    """Compute the motions of the contact points with the tools of a problem."""
    tools, cases = problem.tools, problem.load_cases
    if not tools:
        return PlacedTools.none(len(points), 1 + len(cases))
    names = tuple(problem.zones)
    places = points.mesh.nodes[points.node] - steps_of_surfaces(problem)[points.zone]
    motions, about = np.zeros((len(points), 3 * len(tools))), []
    for number, tool in enumerate(tools.values()):
        place = np.array(tool.point or (0.0, 0.0))
        moved = np.isin(points.zone, [names.index(zone) for zone in tool.zones])
        (x, y), (along_x, along_y) = (places - place).T, points.normals.T
        along = np.stack([along_x, along_y, along_y * x - along_x * y], axis=1)
        motions[moved, 3 * number : 3 * number + 3] = -along[moved]
        about.append(place)
    actions: list[Mapping[str, ToolAction]] = [tools, *(case.tools for case in cases.values())]
    position, force = np.zeros((2, 3 * len(tools), len(actions)))
    for row, name in enumerate(tools):
        for column, action in enumerate(actions):
            if name in action:
                own = slice(3 * row, 3 * row + 3), column
                position[own], force[own] = action[name].position, action[name].load
    return PlacedTools(
        names=tuple(tools),
        point=np.array(about).reshape(-1, 2),
        places=places,
        motions=motions,
        free=np.array([tool.free for tool in tools.values()], bool).ravel(),
        position=position,
        force=force,
    )


def steps_of_surfaces(problem: Problem) -> Array:
    """Displacements (z, 2) [L] that contact has followed, of the rigid surfaces of all zones; zero for others."""
    surfaces = [zone.surface for zone in problem.zones.values()]
    return np.array([(0.0, 0.0) if isinstance(it, DeflectedContour) else it.way[:2] for it in surfaces]).reshape(-1, 2)


@frozen
class FreeMotions:
    """k motions in which b elastic bodies and t tools move rigidly together.

    Parameters
    ----------
    coefficients : (k, 3 b + 3 t) x, y and rotation times radius of each body about its center, then of each tool about
        its pole
    bodies : how sentences call the bodies
    names : of the tools
    halves : half of the size of each body [L]; the radius if not given
    unit_changes : (n, 3 b + 3 t) of the gaps by the motions with one coefficient of one, the others zero
    centers : (b + t, 2) centers and poles [L]
    to_points : (3 t, 3 t) motion of the tools, x, y and rotation [rad/L] about their own points, from that about poles
    radius : [L]
    """

    coefficients: Array
    names: tuple[str, ...]
    centers: Array
    to_points: Array
    radius: float
    bodies: tuple[str, ...] = (BODY,)
    halves: tuple[float, ...] = ()
    unit_changes: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def __len__(self) -> int:
        """Return the number of motions."""
        return len(self.coefficients)

    def of_body(self, number: int) -> RigidMotions:
        """Motions of a body in each of them."""
        return self._part(number)

    def with_coefficients(self, coefficients: Array) -> "FreeMotions":
        """Other motions (k, 3 b + 3 t) of the same bodies and tools."""
        return FreeMotions(
            coefficients=coefficients, names=self.names, centers=self.centers, to_points=self.to_points,
            radius=self.radius, bodies=self.bodies, halves=self.halves, unit_changes=self.unit_changes,
        )  # fmt: skip

    @property
    def of_bodies(self) -> Array:
        """Coefficients (k, 3 b) of the bodies."""
        return self.coefficients[:, : 3 * len(self.bodies)]

    def displacement(self, mesh: Mesh) -> Array:
        """Displacement (N, 2, k) of all nodes of a mesh in each of them."""
        result = np.empty((*mesh.nodes.shape, len(self)))
        for number, part in enumerate(mesh.parts):
            result[part.nodes] = self.of_body(number).displacement(part.mesh.nodes)
        return result

    @property
    def tools(self) -> Array:
        """Motions of the tools (3 t, k): x, y and rotation [rad/L] about their points, tool by tool."""
        return self.to_points @ self.coefficients[:, 3 * len(self.bodies) :].T

    @property
    def gap_changes(self) -> Array:
        """R (n, k): the changes of all gaps."""
        return self.unit_changes @ self.coefficients.T

    def combined(self, factors: Array) -> "FreeMotions":
        """Combinations of these motions by the columns of factors (k, j)."""
        return self.with_coefficients(factors.T @ self.coefficients)

    def describe(self) -> tuple[str, ...]:
        """Describe each motion, with what moves unless it is an only body."""
        return tuple(self._whole(j) for j in range(len(self)))

    def _whole(self, motion: int) -> str:
        """Describe a motion, with what moves unless it is an only body."""
        ways = self._ways(motion)
        if len(ways) > 1:
            return self.way(motion)
        (way, parts), *_ = ways.items()
        who = self._together(parts)
        return way if who == BODY else f"{way} of {who}"

    def who(self, motion: int) -> str:
        """Name what moves: the body, tools, or several of them together."""
        return self._together(self._moving(motion))

    def several(self, motion: int) -> bool:
        """Whether several of body and tools move."""
        return len(self._moving(motion)) > 1

    def way(self, motion: int) -> str:
        """Describe how it moves; if its parts do not move alike, how each of them does."""
        ways = self._ways(motion)
        if len(ways) == 1:
            return next(iter(ways))
        if len(ways) > MOST_WAYS:
            (first, parts), *_ = ways.items()
            return f"joint motion of {self.who(motion)}: that with the {first} of {self._together(parts)}"
        return ", together with the ".join(f"{way} of {self._together(parts)}" for way, parts in ways.items())

    def _together(self, parts: Sequence[int]) -> str:
        """Name bodies and tools."""
        *others, last = (
            self.bodies[part] if part < len(self.bodies) else f"the tool '{self.names[part - len(self.bodies)]}'"
            for part in parts
        )
        return f"{', '.join(others)} and {last} together" if others else last

    def _ways(self, motion: int) -> dict[str, list[int]]:
        """How bodies and tools move, and which of them move so."""
        ways: dict[str, list[int]] = {}
        for part in self._moving(motion):
            half = self.halves[part] if part < len(self.halves) else None
            ways.setdefault(self._part(part).described(self._of(motion, part), half), []).append(part)
        return ways

    def in_user_units(self) -> "FreeMotions":
        """These motions scaled so that work in them is a force [p L] for a translation, else a moment [p L²]."""
        if not len(self):
            return self
        largest = np.hypot(self.coefficients[:, ::3], self.coefficients[:, 1::3]).max(axis=1, initial=UNSEEN)
        return self.combined(np.diag(np.where(np.isinf(self.arms), 1 / largest, self.arms)))

    @cached_property
    def arms(self) -> Array:
        """Distance (k,) [L] from the center of a rotation at which a motion moves by its amplitude; else infinite."""
        turns = (self._largest_turn(motion) if self.turns(motion) else 0.0 for motion in range(len(self)))
        return np.array([self.radius / turn if turn else np.inf for turn in turns], float)

    def direction(self, motion: int) -> Array | None:
        """Direction (2,) in which one part, the body or a tool, moves without turning; None for other motions."""
        moving = self._moving(motion)
        return None if self.turns(motion) or len(moving) > 1 else self._of(motion, moving[0])[:2]

    def along(self, motion: int) -> "FreeMotions":
        """Unit translations along x and y of what moves first in a motion."""
        part = self._moving(motion)[0]
        return self.with_coefficients(np.eye(self.coefficients.shape[1])[3 * part : 3 * part + 2])

    def rotations(self, centers: Sequence[Point | None]) -> "FreeMotions":
        """Rotation of each body about a center [L], if it is given one."""
        rows = np.zeros((len(centers), self.coefficients.shape[1]))
        for number, center in enumerate(centers):
            if center is not None:
                x, y = (np.array(center) - self.centers[number]) / self.radius
                rows[number, 3 * number : 3 * number + 3] = y, -x, 1.0
        return self.with_coefficients(rows[rows.any(axis=1)])

    def turns(self, motion: int) -> bool:
        """Whether something turns in a motion."""
        return self._largest_turn(motion) > UNSEEN * max(self._sizes(motion))

    def _largest_turn(self, motion: int) -> float:
        """Largest rotation times radius in a motion."""
        return max(map(abs, self.coefficients[motion, 2::3].tolist()))

    def _sizes(self, motion: int) -> list[float]:
        """Largest coefficient of each body and tool in a motion."""
        row = [*map(abs, self.coefficients[motion].tolist())]
        return [*map(max, row[0::3], row[1::3], row[2::3])]

    def _part(self, number: int) -> RigidMotions:
        """Motions of a body or of a tool, which count on, in each of them."""
        its = self.coefficients[:, 3 * number : 3 * number + 3]
        return RigidMotions(coefficients=its, center=self.centers[number], radius=self.radius)

    def _of(self, motion: int, part: int) -> Array:
        """Coefficients (3,) of a body or a tool in one of them."""
        return self.coefficients[motion, 3 * part : 3 * part + 3]

    def _moving(self, motion: int) -> list[int]:
        """Bodies and tools that move in one of them."""
        sizes = self._sizes(motion)
        least = UNSEEN * max(sizes)
        return [part for part, size in enumerate(sizes) if size > least]


def free_motions(
    points: ContactPoints,
    of_bodies: Sequence[RigidMotions],
    tools: PlacedTools,
    bodies: tuple[str, ...],
    bonds: BondedPoints,
) -> tuple[FreeMotions, FreeMotions, FreeMotions]:
    """Separate the free motions of bodies and of tools into those that contact sees and those that it does not see.

    The seen motions have independent columns of R; those of bodies come first, then those of tools. In the unseen
    motions no gap changes, or bodies and tools move together. The last ones would move bonded bodies apart, or spin
    bodies that might, as the others do not.
    """
    t, first = len(tools.names), 3 * len(of_bodies)
    poles, radius = tools.poles(points), of_bodies[0].radius
    to_points = _to_points(tools.point - poles, radius)
    changes = [
        own.unit_changes(pressures, part.mesh, len(points))
        for own, part, pressures in zip(of_bodies, points.mesh.parts, points.unit_pressures, strict=True)
    ]
    basis = np.concatenate([*changes, tools.motions @ to_points], axis=1)
    every = FreeMotions(
        coefficients=np.zeros((0, first + 3 * t)),
        bodies=bodies,
        names=tools.names,
        centers=np.concatenate([[own.center for own in of_bodies], poles]),
        to_points=to_points,
        radius=radius,
        halves=tuple(part.mesh.size / 2 for part in points.mesh.parts),
        unit_changes=basis,
    )
    held = np.zeros((sum(map(len, of_bodies)), first + 3 * t))
    row = 0
    for number, own in enumerate(of_bodies):
        held[row : row + len(own), 3 * number : 3 * number + 3] = own.coefficients
        row += len(own)
    apart = held[:0]
    if len(bonds):
        held, apart = split_motions(held, _at_bonds(bonds, of_bodies) @ held[:, :first].T, UNSEEN)
    seen, unseen = _split(basis, held)
    if tools.free.any():
        (body, lost), (loaded, idle) = (seen, unseen), _split(basis, np.eye(first + 3 * t)[first:][tools.free])
        both = np.vstack([body, loaded])
        together = _null_vectors(basis @ both.T)
        alone = _null_vectors(together[: len(body)].T)
        seen, unseen = np.vstack([echelon(alone.T @ body), loaded]), np.vstack([lost, idle, echelon(together.T @ both)])
    seen = _along_walls(_counterclockwise(seen), [change[:, :2] for change in changes])
    motions = seen, _counterclockwise(unseen), apart
    of_seen, of_unseen, of_apart = map(every.with_coefficients, motions)
    return of_seen, of_unseen, of_apart


def _along_walls(motions: Array, normals: Sequence[Array]) -> Array:
    """Motions (k, components) with the translations of a body between two walls along and across them, not along x, y.

    So the body slides along them without any round-off that another surface would have to hold. `normals` are those of
    all points (n, 2) for each body, zero where it has no part.
    """
    if len(motions) < 2:
        return motions
    motions = motions.copy()
    for number, own in enumerate(normals):
        ways = np.eye(motions.shape[1])[3 * number : 3 * number + 2]
        rows = [np.flatnonzero((abs(motions - way) <= UNSEEN).all(axis=1)) for way in ways]
        if not all(len(found) == 1 for found in rows):
            continue
        if (across := _axis_of_walls(own[own.any(axis=1)])) is not None:
            along = np.array([across[1], -across[0]])
            motions[np.concatenate(rows)] = np.array([along, across]) @ ways
    return motions


def _axis_of_walls(normals: Array) -> Array | None:
    """The upward normal (2,) of two opposite walls, from those of their points (n, 2); None if it is an axis."""
    angles = np.mod(np.arctan2(normals[:, 1], normals[:, 0]), 2 * np.pi)
    of_lines = np.mod(angles, np.pi)
    order = of_lines.argsort()
    group = np.append(0, (np.diff(of_lines[order]) > UNSEEN).cumsum())  # of points with normals along one line
    size, down = np.bincount(group), np.bincount(group, angles[order] >= np.pi)
    size[np.minimum(size - down, down) < WALL] = 0
    if not size.any():
        return None
    widest = order[group.searchsorted(size.argmax())]
    across = normals[widest] * np.sign(normals[widest, 1])
    return across if abs(across).min() > UNSEEN else None


def _at_bonds(bonds: BondedPoints, of_bodies: Sequence[RigidMotions]) -> Array:
    """Changes (b, 3 b') of the components of bonds by unit motions of each body."""
    changes = [
        own.unit_changes(bonds.added_to(UnitPressures.none(), part, 0), part.mesh, len(bonds))
        for own, part in zip(of_bodies, bonds.mesh.parts, strict=True)
    ]
    return np.concatenate(changes, axis=1)


def _counterclockwise(motions: Array) -> Array:
    """Motions (k, 3 b + 3 t) with the sense in which the first part that turns does so counterclockwise."""
    if not len(motions):
        return motions
    turns = motions[:, 2::3]
    if not turns.any():
        return motions
    turning = abs(turns) > UNSEEN * abs(motions).max(axis=1, initial=UNSEEN, keepdims=True)
    first = turns[np.arange(len(turns)), turning.argmax(axis=1)]
    return np.where(turning.any(axis=1) & (first < 0), -1.0, 1.0)[:, None] * motions


def _to_points(levers: Array, radius: float) -> Array:
    """Motion (3 t, 3 t) of tools about their points from that about their poles, at levers (t, 2) from these."""
    motions = np.zeros((3 * len(levers), 3 * len(levers)))
    for first, (x, y) in zip(range(0, len(motions), 3), levers.tolist(), strict=True):
        own = slice(first, first + 3)
        motions[own, own] = [[1.0, 0.0, -y / radius], [0.0, 1.0, x / radius], [0.0, 0.0, 1 / radius]]
    return motions


def _split(basis: Array, motions: Array) -> tuple[Array, Array]:
    """Separate motions (k, components) that move contact points from those that move none.

    Where a body spins about its middle without moving any, as a disk does, the former have no part of this spin.
    """
    values, vectors = short_svd(basis @ motions.T)
    moves_none = values <= UNSEEN * np.sqrt(len(basis))
    seen, unseen = echelon(vectors[~moves_none] @ motions), echelon(vectors[moves_none] @ motions)
    for row in unseen:
        turn = 2 + 3 * int(abs(row[2::3]).argmax())
        if abs(np.delete(row, turn)).max() <= MIDDLE * abs(row[turn]):
            seen = echelon(seen - np.outer(seen[:, turn] / row[turn], row))
    return seen, unseen


def _null_vectors(matrix: Array) -> Array:
    """Orthonormal null vectors (k, j) of a matrix (n, k)."""
    values, vectors = short_svd(matrix)
    return vectors[values <= UNSEEN * np.sqrt(max(len(matrix), 1))].T
