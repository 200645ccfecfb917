"""Tools: rigid surfaces that are displaced, or loaded so that contact must find where they go."""

from typing import Annotated, Self

from pydantic import AfterValidator, model_validator

from bemcontact.problem.contact_zone import EdgeNames
from bemcontact.problem.validation import Number, Point, Stated, complain


class ToolDisplacement(Stated):
    """Where a tool is displaced to; it stays where it is along what is left out."""

    x: Number | None = None
    """Displacement along x."""
    y: Number | None = None
    """Displacement along y."""
    rotation: Number | None = None
    """Small rotation about the point, in radians, anticlockwise."""


class ToolForce(Stated):
    """What a tool is loaded by, per thickness; it is free to move along what is given, be it 0."""

    x: Number | None = None
    """Force along x."""
    y: Number | None = None
    """Force along y."""
    moment: Number | None = None
    """Moment about the point, anticlockwise; if it is left out, the tool cannot tilt."""


WAYS = (("x", "x", "along x"), ("y", "y", "along y"), ("rotation", "moment", "in rotation"))
"""Component of the displacement, that of the force, and both in words."""


class ToolAction(Stated):
    """What happens to a tool: a displacement, a force, or one along one axis and the other along another."""

    displacement: ToolDisplacement = ToolDisplacement()
    """Displacement of the tool, along x and y, and rotation; small, so that gaps change by its normal component."""
    force: ToolForce = ToolForce()
    """Force on the tool along x and y, and moment; what the contact holds up to it is found."""

    @model_validator(mode="after")
    def _one_statement_per_axis(self) -> Self:
        """Refuse contradictions and emptiness."""
        for move, force, where in WAYS:
            if getattr(self.displacement, move) is not None and getattr(self.force, force) is not None:
                what = "moment" if force == "moment" else "force"
                raise complain(f"both displacement and {what} are given {where}; give one of them only")
        if not any(self.displaced) and not any(self.free):
            raise complain("it states nothing; give a displacement or a force, or leave the tool out")
        return self

    @property
    def displaced(self) -> tuple[bool, ...]:
        """Whether displacement along x and y and rotation are given."""
        return tuple(getattr(self.displacement, move) is not None for move, _, _ in WAYS)

    @property
    def free(self) -> tuple[bool, ...]:
        """Whether the tool is free to move along x and y and to rotate, as it has a force or moment."""
        return tuple(getattr(self.force, force) is not None for _, force, _ in WAYS)

    @property
    def position(self) -> tuple[float, ...]:
        """Displacement along x and y, and rotation, zero where none is given."""
        return tuple(getattr(self.displacement, move) or 0.0 for move, _, _ in WAYS)

    @property
    def load(self) -> tuple[float, ...]:
        """Force along x and y, and moment, zero where none is given."""
        return tuple(getattr(self.force, force) or 0.0 for _, force, _ in WAYS)

    def plus(self, factor: float, other: "ToolAction") -> "ToolAction":
        """Add a multiple of another action; what is given in either is given in the sum."""
        displacement = ToolDisplacement(**_sum(self.displacement, factor, other.displacement))
        return ToolAction(displacement=displacement, force=ToolForce(**_sum(self.force, factor, other.force)))


def _sum(one: Stated, factor: float, other: Stated) -> dict[str, float]:
    """Add a multiple of components that are given to those of the same kind, by name."""
    found: dict[str, float] = {}
    for weight, part in ((1.0, one), (factor, other)):
        for key, value in part:
            if value is not None:
                found[key] = found.get(key, 0.0) + weight * value
    return found


def _each_once(value: tuple[str, ...]) -> tuple[str, ...]:
    """Refuse a zone that is listed twice."""
    for i, name in enumerate(value):
        if name in value[:i]:
            raise complain(f"zone '{name}' is listed twice; list it once")
    return value


class RigidTool(ToolAction):
    """The rigid surfaces of some contact zones, as one body that moves.

    Raises
    ------
    ProblemError
        If along an axis both displacement and force are given, if neither is anywhere, or if a rotation or a moment
        has no point to be about.
    """

    zones: Annotated[EdgeNames, AfterValidator(_each_once)]
    """The name of the contact zone, or a list of names of zones, whose rigid surfaces move as one."""
    point: Point | None = None
    """The point [x, y] on which the force acts, and about which rotation and moment are."""

    @model_validator(mode="after")
    def _moment_has_a_point(self) -> Self:
        """Refuse a rotation or a moment about nowhere."""
        if self.point is None and (self.displaced[2] or self.free[2]):
            what = "rotation" if self.displaced[2] else "moment"
            raise complain(f"a {what} is about a point; give point: [x, y]")
        return self
