"""Load cases: what acts on the body beside what is permanent, by names that combinations refer to."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from bemcontact.errors import Complaint
from bemcontact.problem.conditions import Condition
from bemcontact.problem.loads import Loads
from bemcontact.problem.partial import Written
from bemcontact.problem.rigid_tool import WAYS, RigidTool, ToolAction
from bemcontact.problem.validation import KeyComplaint, Name, Number, Stated, Text, complain, unknown_word


class LoadCase(Stated):
    """Values of conditions, loads and tools that act in addition to those of the problem itself.

    A load case does not change what holds the body: a displacement may be given only where the problem has one, and a
    traction only where it has none.

    Raises
    ------
    ProblemError
        If it states nothing.
    """

    description: Text = ""
    """What the load case is."""
    conditions: dict[Name, Condition] = Field(default_factory=dict)
    """What is prescribed on edges in addition, by edge name."""
    loads: Loads = Loads()
    """Loads on the volume of the body."""
    tools: dict[Name, ToolAction] = Field(default_factory=dict)
    """Displacement of tools, and forces on them, in addition, by the name of the tool."""

    @model_validator(mode="after")
    def _states_something(self) -> Self:
        """Refuse emptiness."""
        if not self.conditions and self.loads == Loads() and not self.tools:
            raise complain("it states nothing; give conditions, loads or tools")
        return self


def _not_empty(value: dict[str, float]) -> dict[str, float]:
    """Refuse a combination of nothing."""
    if not value:
        raise complain("nothing is combined; give load cases with their factors, such as wind: 1.5")
    return value


Combination = Annotated[dict[Name, Number], AfterValidator(_not_empty), Field(json_schema_extra={"minProperties": 1})]
"""Factors by load case."""


def tool_complaints(tools: Written, zones: Written) -> Iterator[Complaint]:
    """Check that tools refer to contact zones that there are, and share none.

    Parameters
    ----------
    tools, zones : these parts of a problem, right or wrong; what is unreadable in them is passed over
    """
    names = [str(zone.path[-1]) for zone in zones.each()]
    tool_of: dict[str, str] = {}
    for tool in tools.each():
        members = tool.below(RigidTool, "zones")
        listed = [members] if isinstance(members.value, str) else members.each()
        for member in listed:
            zone, name = member.value, str(tool.path[-1])
            if names and isinstance(zone, str) and zone not in names:
                yield Complaint(path=member.path, message=unknown_word("contact zone", zone, names))
            elif isinstance(zone, str) and tool_of.setdefault(zone, name) != name:
                message = f"zone '{zone}' belongs to the tool '{tool_of[zone]}' already; a surface moves with one tool"
                yield Complaint(path=member.path, message=message)


def case_complaints(cases: Written, combinations: Written, parts: Mapping[str, Written]) -> Iterator[Complaint]:
    """Check that load cases fit what holds the body and its tools, and combinations the load cases.

    Parameters
    ----------
    cases, combinations : these parts of a problem, right or wrong; what is unreadable in them is passed over
    parts : its "conditions" and "tools", likewise
    """
    conditions = {str(item.path[-1]): item.read(Condition) for item in parts["conditions"].each()}
    tools = {str(item.path[-1]): item.read(RigidTool) for item in parts["tools"].each()}
    for case in cases.each():
        for item in case.below(LoadCase, "conditions").each():
            yield from _condition_complaints(item, conditions.get(str(item.path[-1])), str(item.path[-1]) in conditions)
        for item in case.below(LoadCase, "tools").each():
            name = str(item.path[-1])
            if name not in tools:
                yield KeyComplaint(path=item.path, message=unknown_word("tool", name, tools))
            elif (tool := tools[name]) is not None:
                yield from _action_complaints(item, tool)
    names = [str(case.path[-1]) for case in cases.each()]
    for combination in combinations.each():
        if (name := str(combination.path[-1])) in names:
            message = f"there is a load case '{name}' already; give the combination another name"
            yield KeyComplaint(path=combination.path, message=message)
        for factor in combination.each():
            if (name := str(factor.path[-1])) not in names:
                yield KeyComplaint(path=factor.path, message=unknown_word("load case", name, names))


def _condition_complaints(item: Written, base: Condition | None, stated: bool) -> Iterator[Complaint]:
    """Refuse a condition of a load case that would change how the edge is held."""
    condition = item.read(Condition)
    if condition is None or (stated and base is None):
        return
    held = base.displacement.given if base else ()
    for axis in condition.displacement.given:
        if axis not in held:
            message = (
                f"a load case cannot hold an edge that the problem leaves free along {axis}; give the displacement "
                f"0 along {axis} among the problem's own conditions, and this one in addition"
            )
            yield Complaint(path=(*item.path, "displacement", axis), message=message)
    axes = ("x", "y") if condition.pressure is not None else condition.traction.given
    for axis in sorted({*axes} & {*held}):
        key = ("pressure",) if condition.pressure is not None else ("traction", axis)
        message = f"the problem prescribes the displacement of this edge along {axis}, which leaves no room for it"
        yield Complaint(path=(*item.path, *key), message=message)


def _action_complaints(item: Written, tool: RigidTool) -> Iterator[Complaint]:
    """Refuse an action of a load case that would change how the tool is guided."""
    action = item.read(ToolAction)
    if action is None:
        return
    for (move, force, where), free, moved, loaded in zip(WAYS, tool.free, action.displaced, action.free, strict=True):
        if moved and free:
            what = "moment" if force == "moment" else "force"
            message = f"the tool is free {where}, as the problem loads it there; give a {what}"
            yield Complaint(path=(*item.path, "displacement", move), message=message)
        if loaded and not free:
            message = f"the tool is held {where}; give {force}: 0 among the problem's own forces on it to set it free"
            yield Complaint(path=(*item.path, "force", force), message=message)
        if move == "rotation" and moved and tool.point is None:
            message = "a rotation is about a point; give the tool its point: [x, y]"
            yield Complaint(path=(*item.path, "displacement", "rotation"), message=message)
