"""Parameters of a model: initial gap, load cases and tools as parameters of cvxpy, and the sums that they enter."""

from dataclasses import replace
from typing import Any, cast

import cvxpy as cp
import numpy as np

from bemcontact.arrays import Array, real_array
from bemcontact.cached import cached_property
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.errors import ProblemError
from bemcontact.frozen import frozen

Value = cp.Expression | Array


class RowParameter(cp.Parameter):
    """A parameter of cvxpy that reads a value as NumPy does; cvxpy itself reads nested lists by columns."""

    @property
    def value(self) -> Any:
        """The value; None before there is one."""
        return cast(Any, cp.Parameter.value).fget(self)

    @value.setter
    def value(self, val: Any) -> None:
        """Set the value; `ProblemError` unless it is an array of finite numbers in the shape of the parameter."""
        cast(Any, cp.Parameter.value).fset(self, None if val is None else self._read(val))

    def _read(self, given: Any) -> Array:
        """The array of a value."""
        return real_array(given, f"the value of {self.name()}", self.shape).copy()


@frozen
class Parameters:
    """Parameters in the user's units, None where there is nothing of the kind, and the sums that they enter linearly.

    Parameters
    ----------
    rest : the condensed contact with all load cases off and all tools undisplaced and unloaded
    initial_gap : (n,) [L]
    case_factors : (c,)
    tool_position, tool_force : (t, 3), without what the load cases add
    """

    rest: CondensedContact
    initial_gap: cp.Parameter
    case_factors: cp.Parameter | None
    tool_position: cp.Parameter | None
    tool_force: cp.Parameter | None

    @classmethod
    def of(cls, contact: CondensedContact) -> "Parameters":
        """Parameters with the present values of a contact problem."""
        cases, tools = contact.cases, contact.tools
        rest = contact.at_rest()
        position = (tools.position - cases.position @ cases.factors).reshape(-1, 3)
        force = (tools.force - cases.force @ cases.factors).reshape(-1, 3)
        return cls(
            rest=rest,
            initial_gap=RowParameter(contact.size, name="initial_gap", value=rest.initial_gap),
            case_factors=RowParameter(len(cases), name="case_factors", value=cases.factors) if len(cases) else None,
            tool_position=RowParameter((len(tools), 3), name="tool_position", value=position) if len(tools) else None,
            tool_force=RowParameter((len(tools), 3), name="tool_force", value=force) if len(tools) else None,
        )

    @cached_property
    def _factors(self) -> Value:
        return np.zeros(0) if self.case_factors is None else self.case_factors

    @cached_property
    def position(self) -> Value:
        """Displacement (3 t,) of the tools, zero where a component is free."""
        if self.tool_position is None:
            return np.zeros(0)  # cvxpy below 1.9 knows no expression of size zero
        own = cp.vec(self.tool_position, order="C")
        return cp.multiply(~self.rest.tools.free, own + self.rest.cases.position @ self._factors)

    @cached_property
    def force(self) -> Value:
        """Force (3 t,) on the tools, zero where a component is not free."""
        if self.tool_force is None:
            return np.zeros(0)
        own = cp.vec(self.tool_force, order="C")
        return cp.multiply(self.rest.tools.free, own + self.rest.cases.force @ self._factors)

    @cached_property
    def free_displacement(self) -> Value:
        """Δ1 (n,) [L]."""
        return self.rest.free_displacement + self.rest.cases.displacement @ self._factors

    @cached_property
    def offset(self) -> Value:
        """The gap without contact (n,), q = ε + Δ1 [L]."""
        return self.initial_gap + self.rest.tools.motions @ self.position + self.free_displacement

    @cached_property
    def motion_load(self) -> Value:
        """The load (k,)."""
        rest = self.rest
        if not rest.motion_load.size:
            return np.zeros(0)
        return rest.motion_load + rest.cases.motion_load @ self._factors + rest.tools.amplitudes.T @ self.force

    def contact(self) -> CondensedContact:
        """The contact problem with the present values."""
        rest, none = self.rest, np.zeros(3 * len(self.rest.tools))
        factors = np.zeros(0) if self.case_factors is None else value_of(self.case_factors)
        position = none if self.tool_position is None else value_of(self.tool_position).ravel()
        force = none if self.tool_force is None else value_of(self.tool_force).ravel()
        free = rest.tools.free[:, None]
        position = np.where(free, 0.0, np.column_stack([position, rest.cases.position * factors]))
        force = np.where(free, np.column_stack([force, rest.cases.force * factors]), 0.0)
        undisplaced = replace(rest, initial_gap=value_of(self.initial_gap))
        return undisplaced.stepped(factors, position, force).balanced()


def value_of(expression: cp.Expression) -> Array:
    """The value of an expression or parameter; `ProblemError` if it has none."""
    if expression.value is None:
        raise ProblemError(f"'{expression.name()}' has no value yet; set it, or solve first")
    return np.array(expression.value, float)
