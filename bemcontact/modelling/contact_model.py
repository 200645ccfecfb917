"""A condensed contact as a model in cvxpy: variables, expressions, parameters, objective and constraints."""

from collections.abc import Sequence
from numbers import Real
from typing import Any, cast

import cvxpy as cp
import numpy as np

from bemcontact.arrays import Array
from bemcontact.cached import cached_property
from bemcontact.checks.arguments import instance_of, real_number, shown
from bemcontact.checks.attributes import WithHints
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import ContactScales
from bemcontact.contact.stress_operator import StressOperator, ensure_of
from bemcontact.errors import ProblemError, SolverError
from bemcontact.formulations import qp3
from bemcontact.formulations.clarabel import Answer, minimize_convex
from bemcontact.formulations.complementarity import ACTIVE_SET, polish
from bemcontact.formulations.scaling import ScaledContact, motion_sizes, scale
from bemcontact.frozen import frozen
from bemcontact.modelling.contact_problem import ContactProblem, ensure_convex
from bemcontact.modelling.model_result import ModelResult, judged, read_back, solution_at
from bemcontact.modelling.parameters import Parameters, Value
from bemcontact.modelling.stress_bounds import ModelStress
from bemcontact.options import Weights, ensure_whole
from bemcontact.threads import one_thread

WIDE = 1e5
"""Gaps over the displacements under the load from which a load is light: Clarabel's tolerance takes these digits."""


@frozen
class ContactModel(WithHints):
    """Minimize F3 = pᵀJ gap with gap = q + M p + R a >= 0, p >= 0, ℓᵀp = -load, (40)-(42), to be extended in cvxpy.

    Everything is in the user's units; the variables behind the expressions are scaled, so that units do not matter to a
    solver. The expressions are affine and may be used in additions. After new values of parameters nothing is compiled
    anew. Values stay in the expressions until the next solve, as in cvxpy; `result` takes them out.

    Parameters
    ----------
    original : the contact problem that the model was made of
    parameters : `initial_gap`, `case_factors`, `tool_position` and `tool_force`, and the sums that they enter
    pressure : (n,) p [p], an expression
    motions : (k,) a, an expression; None without free motions
    gap : (n,) δ [L]
    displacement : (n,) u_n = Δ1 + M p + R a [L]
    tool_displacement : (t, 3) x, y [L] and rotation [rad] of the tools; None without tools
    objective : F3 [p L²], which is zero at a contact state; in equilibrium it is pᵀJ gap
    constraints : "no_penetration", "no_tension" and, with free motions, "equilibrium", scaled; `duals` has their
        multipliers in the user's units
    scales : displacement [L] and pressure [p] that the variables behind the expressions are divided by
    notes : warnings to the user
    """

    original: CondensedContact
    parameters: Parameters
    pressure: cp.Expression
    motions: cp.Expression | None
    gap: cp.Expression
    displacement: cp.Expression
    tool_displacement: cp.Expression | None
    objective: cp.Expression
    constraints: dict[str, cp.Constraint]
    scales: ContactScales
    notes: tuple[str, ...] = ()

    def __reduce__(self) -> tuple[Any, ...]:
        """Build copies, and what pickle reads, anew with the present values.

        cvxpy tells variables by numbers. In copied expressions those that it has compiled are wrong, and in another
        process new variables may have them.
        """
        parameters, variables, constraints = self._parts
        values = [part.value for part in (*parameters, *variables)], [item.dual_value for item in constraints]
        return _rebuilt, (self.original, *values)

    @property
    def _parts(self) -> tuple[list[cp.Parameter], list[cp.Variable], list[cp.Constraint]]:
        """Parameters, variables and constraints, all of which have values."""
        own, expressions = self.parameters, (self.pressure, self.motions)
        given = (own.initial_gap, own.case_factors, own.tool_position, own.tool_force)
        variables = [variable for item in expressions if item is not None for variable in item.variables()]
        return [item for item in given if item is not None], variables, list(self.constraints.values())

    def __repr__(self) -> str:
        """One line: name, points, what may change."""
        names = ", ".join(parameter.name() for parameter in self.objective.parameters())
        return f"<ContactModel of {self.original.name!r}: {self.original.size} points; {names} may change>"

    @property
    def initial_gap(self) -> cp.Parameter:
        """ε (n,) [L] with all tools undisplaced."""
        return self.parameters.initial_gap

    @property
    def case_factors(self) -> cp.Parameter | None:
        """Factors (c,) of the load cases; None without load cases."""
        return self.parameters.case_factors

    @property
    def tool_position(self) -> cp.Parameter | None:
        """Displacement (t, 3) of tools, x, y [L] and rotation [rad], beside that of load cases; None without tools.

        Free components are not used.
        """
        return self.parameters.tool_position

    @property
    def tool_force(self) -> cp.Parameter | None:
        """Force (t, 3) on free components of tools, x, y [p L] and moment [p L²], beside that of load cases.

        None without tools.
        """
        return self.parameters.tool_force

    def resultant(self, zone: str | None = None) -> cp.Expression:
        """Force (2,) [p L] of the rigid surface of a zone on the body, Σ w p n; of all zones if None.

        Parameters
        ----------
        zone : name of a contact zone

        Raises
        ------
        ProblemError
            There is no such zone.
        """
        names = self.original.zone_names
        if zone is not None and not (isinstance(zone, str) and zone in names):
            raise ProblemError(f"there is no contact zone {shown(zone)}; there are: {', '.join(names)}")
        inside = np.ones(self.original.size, bool) if zone is None else self.original.zone == names.index(zone)
        return self.original.forces(inside.astype(float)).T @ self.pressure

    def stress(self, operator: StressOperator) -> ModelStress:
        """Stress at points of the body, as expressions that can be bounded.

        Parameters
        ----------
        operator : of the same problem, as `bemcontact.stress_operator` makes it; a model of its contact fits

        Raises
        ------
        ProblemError
            It belongs to another body, mesh or load.
        """
        instance_of(operator, StressOperator, "operator", "bemcontact.stress_operator makes one")
        ensure_of(operator, self.original)
        return ModelStress.of(operator, self.pressure, self.motions, self.case_factors, self.scales.pressure)

    @property
    def duals(self) -> dict[str, Array]:
        """Multipliers of the named constraints, right after a solve, in the user's units.

        "no_penetration" (n,) [p], "no_tension" (n,) [L] and "equilibrium" (k,) belong to w gap >= 0, w p >= 0 and
        ℓᵀp + load = 0. If the first or the second zero becomes s at a point, the least objective changes by the
        multiplier times s. At a contact state they are the pressure, the gap and the motions themselves.

        Raises
        ------
        ProblemError
            No problem with these constraints has been solved to an optimum.
        """
        values = {name: constraint.dual_value for name, constraint in self.constraints.items()}
        if any(value is None for value in values.values()):
            raise ProblemError("there are no multipliers yet; solve the model to an optimum first")
        duals = {name: np.asarray(value, float) / self._dual_units[name] for name, value in values.items()}
        if "equilibrium" in duals:
            duals["equilibrium"] = duals["equilibrium"] - self._carried_by_form
        return duals

    @property
    def _carried_by_form(self) -> Array:
        """What `_work` adds to the multiplier of equilibrium (k,), because it sees P p and p0 apart.

        Its gradient lacks (I - Pᵀ)H(p - ½ p0) = ℓ c, which ℓᵀp = -load makes good: this is c.
        """
        scaled, (U, _) = scale(self.contact, self.scales), self.scales
        p = cast(Array, self.pressure.variables()[0].value) - scaled.balancing_pressure / 2
        weighted = scaled.weights[:, None] * scaled.compliance
        R, ell = scaled.rigid_motions, scaled.equilibrium
        return U / motion_sizes(self.original) * np.linalg.solve(R.T @ ell, R.T @ ((weighted + weighted.T) @ p))

    @cached_property
    def _dual_units(self) -> dict[str, Array]:
        """What the multipliers of the scaled constraints are divided by."""
        (U, T), w = self.scales, self.original.weights
        units = {"no_penetration": U * w, "no_tension": T * w}
        return units | {"equilibrium": T * w.max() * motion_sizes(self.original)}

    @property
    def contact(self) -> CondensedContact:
        """The contact problem with the present values of the parameters."""
        return self.parameters.contact()

    def problem(
        self, extra_objective: cp.Expression | None = None, extra_constraints: Sequence[cp.Constraint] = ()
    ) -> cp.Problem:
        """Put objective, constraints and additions together; it can be solved again after changes of parameters.

        Parameters
        ----------
        extra_objective : convex scalar that is added to F3 [p L²]
        extra_constraints : convex constraints

        Raises
        ------
        ProblemError
            The additions are of another kind or not convex, or parameters enter them so that each change is a new
            problem.
        """
        if extra_objective is not None and not isinstance(extra_objective, cp.Expression | Real):
            kind = type(extra_objective).__name__
            raise ProblemError(f"extra_objective is an expression, which is added to F3 and minimized; found {kind}")
        if isinstance(extra_constraints, cp.Constraint):
            raise ProblemError("extra_constraints is a list of constraints; put the one that is given into brackets")
        if not isinstance(extra_constraints, Sequence) or not all(map(_is_constraint, extra_constraints)):
            raise ProblemError(
                "extra_constraints is a list of constraints, such as [model.pressure <= 2.0]; found "
                f"{shown(extra_constraints)}"
            )
        if isinstance(extra_objective, cp.Expression):
            if not extra_objective.is_scalar() or extra_objective.is_complex():
                raise ProblemError(
                    f"extra_objective must be one real number, and its shape is {extra_objective.shape}; sum it"
                )
        elif extra_objective is not None:
            extra_objective = real_number(extra_objective, "extra_objective")
        goal = self.objective if extra_objective is None else self.objective + extra_objective
        problem = ContactProblem(cp.Minimize(goal), [*self.constraints.values(), *extra_constraints])
        ensure_convex(problem)
        return problem

    @cached_property
    def _pure(self) -> cp.Problem:
        """The problem with nothing added."""
        return self.problem()

    @one_thread
    def solve(
        self,
        extra_objective: cp.Expression | None = None,
        extra_constraints: Sequence[cp.Constraint] = (),
        *,
        problem: cp.Problem | None = None,
        max_iterations: int | None = None,
    ) -> ModelResult:
        """Solve with the present values of the parameters, to tolerances from which the contact state is polished.

        Parameters
        ----------
        extra_objective, extra_constraints : as in `problem`
        problem : a result of `problem`, instead of these; it is not compiled again
        max_iterations : of Clarabel, 200 if None

        Returns
        -------
        ModelResult
            Check its `status`: a model without a solution is not an error.

        Raises
        ------
        ProblemError
            As in `problem`, or if both a problem and additions are given.
        SolverError
            Clarabel cannot state the model, or none of several attempts leads to an optimum.
        """
        several = isinstance(extra_constraints, Sequence) and not isinstance(extra_constraints, cp.Constraint)
        added = extra_objective is not None or not several or len(extra_constraints) > 0
        if max_iterations is not None:
            ensure_whole(max_iterations, "limit of iterations", 1)
        if problem is not None:
            instance_of(problem, cp.Problem, "problem", "model.problem makes one")
        if problem is not None and added:
            raise ProblemError("give either a problem that was made before, or what is to be added, not both")
        chosen = problem or (self.problem(extra_objective, extra_constraints) if added else self._pure)
        if chosen is self._pure and (result := self._from_last()) is not None:
            return result
        pure = chosen is self._pure
        light = _of_light_load(self.contact)
        try:
            answer = minimize_convex(chosen, max_iterations, leave_point=pure, as_stated=not pure)
        except SolverError as error:
            raise SolverError(". ".join(filter(None, (str(error), light)))) from error
        notes = [answer.note] if answer.accurate else [answer.note, light]
        return self._read_back(chosen, answer._replace(note=". ".join(filter(None, notes))))

    def _from_last(self) -> ModelResult | None:
        """The contact state by a few active-set steps from the last solve; None if they do not lead to one."""
        if self.pressure.value is None:
            return None
        contact, motions = self.contact, self.motions
        result = judged(contact, polish(contact, solution_at(contact, self.pressure, motions, ACTIVE_SET)), added=False)
        solution, certificate = result.solution, result.certificate
        if solution is None or certificate is None or not certificate.certified:
            return None
        U, T = self.scales
        self.pressure.variables()[0].value = solution.pressure / T
        if motions is not None:
            motions.variables()[0].value = solution.rigid_amplitudes * (motion_sizes(self.original) / U)
        p, a = solution.pressure, solution.rigid_amplitudes
        for (name, constraint), value in zip(self.constraints.items(), (p, contact.gap(p, a), a), strict=False):
            own = self._carried_by_form if name == "equilibrium" else 0.0
            constraint.save_dual_value(self._dual_units[name] * (value + own))
        return result

    def result(self, problem: cp.Problem) -> ModelResult:
        """Take the result out of a solved problem, and assess it at the present values of the parameters.

        Parameters
        ----------
        problem : a result of `problem`, or one that was built otherwise from parts of the model

        Raises
        ------
        ProblemError
            It has not been solved, or does not contain the pressure of the model.
        """
        instance_of(problem, cp.Problem, "problem", "model.problem makes one")
        return self._read_back(problem, None)

    def _read_back(self, problem: cp.Problem, answer: Answer | None) -> ModelResult:
        """The result of a problem, with the answer of Clarabel if it was called here."""
        parts = zip(problem.constraints, self.constraints.values(), strict=False)
        pure = len(problem.constraints) == len(self.constraints) and all(one is other for one, other in parts)
        return read_back(
            self.contact,
            problem,
            self.pressure,
            self.motions,
            answer,
            added=not pure or problem.objective.expr is not self.objective,
        )


def model(contact: CondensedContact) -> ContactModel:
    """Write a condensed contact as a cvxpy model whose parameters have the present values.

    Parameters
    ----------
    contact : a body condensed to n contact points, as `condense` makes it

    Returns
    -------
    ContactModel
        QP3 with the pressure [p] and the gap [L] as expressions, to which constraints and costs can be added.

    Raises
    ------
    ProblemError
        It is no condensed contact.
    NotConvexError
        The Hessian has a negative eigenvalue on the equilibrium space, of more than a hundredth of the largest.
    """
    instance_of(contact, CondensedContact, "contact", "bemcontact.condense makes one of a problem")
    U, T = scales = largest_scales(contact)
    scaled, given = scale(contact, scales), Parameters.of(contact)
    n, k = contact.rigid_motions.shape
    hessian, notes = _convex_hessian(scaled)
    p = cp.Variable(n, name="pressure")
    a = cp.Variable(k, name="motions") if k else None
    moved = scaled.compliance @ p + (scaled.rigid_motions @ a if a is not None else 0.0)
    sizes = motion_sizes(contact)
    load, offset = given.motion_load / (sizes * contact.weights.max() * T), given.offset / U
    balance = {} if a is None else {"equilibrium": scaled.equilibrium.T @ p == -load}
    motions = None if a is None else cp.multiply(U / sizes, a)
    return ContactModel(
        original=contact,
        parameters=given,
        pressure=T * p,
        motions=motions,
        gap=U * (offset + moved),
        displacement=U * (given.free_displacement / U + moved),
        tool_displacement=_tool_displacement(given, motions),
        objective=U * T * contact.weights.max() * _work(scaled, hessian, p, a, offset, load),
        constraints={"no_penetration": offset + moved >= 0, "no_tension": p >= 0, **balance},
        scales=scales,
        notes=notes,
    )


def _rebuilt(contact: CondensedContact, values: list[Any], duals: list[Any]) -> ContactModel:
    """The model of a contact problem with these values of parameters and variables, and multipliers."""
    copied = model(contact)
    parameters, variables, constraints = copied._parts
    for part, value in zip((*parameters, *variables), values, strict=True):
        part.value = value
    for constraint, dual in zip(constraints, duals, strict=True):
        if dual is not None:
            constraint.save_dual_value(dual)
    return copied


def _is_constraint(item: object) -> bool:
    """Whether cvxpy takes an item as a constraint: a comparison of numbers, True or False, is one too."""
    return isinstance(item, cp.Constraint | bool | np.bool_)


def _of_light_load(contact: CondensedContact) -> str:
    """What to do, if the gaps are so wide beside the displacements under the load that no digits are left of these."""
    wide = float(np.abs(contact.offset).max(initial=0.0)) / contact.scales.displacement
    if wide < WIDE:
        return ""
    return (
        f"The load is light: gaps are up to {wide:.0e} times the displacements under it, and the solver's tolerance is "
        "large beside these. Draw the body where it touches, or leave far points out of the zones"
    )


def largest_scales(contact: CondensedContact) -> ContactScales:
    """Displacement [L] and pressure [p] of the present state, or of a load case by itself, whichever is largest."""
    cases = contact.cases
    steps = np.eye(len(cases)) - cases.factors
    states = [contact, *(contact.stepped(step, cases.position * step, cases.force * step) for step in steps)]
    acting = [state for state in states if state.offset.any() or state.motion_load.any()]
    return max((state.scales for state in acting), default=contact.scales)


def _convex_hessian(scaled: ScaledContact) -> tuple[Array, tuple[str, ...]]:
    """Hessian (n, n) of F3 on the equilibrium space, as in QP3, and a note on the part that was dropped."""
    J = np.diag(scaled.weights)
    work, eigenvalue = qp3.objective(scaled, J), qp3.smallest_eigenvalue(scaled, J)
    if eigenvalue is None or eigenvalue >= -qp3.NEGLIGIBLE:
        return work.hessian, ()
    note = (
        f"F3 is not convex on this mesh (smallest eigenvalue {eigenvalue:.1e}): the negative part of its Hessian is "
        "left out, so that the optimum is near the contact state, not on it"
    )
    return qp3.nearly_convex(work, eigenvalue, Weights.TRIBUTARY).hessian, (note,)


def _work(
    scaled: ScaledContact, hessian: Array, p: cp.Variable, a: cp.Variable | None, offset: Value, load: Value
) -> cp.Expression:
    """F3, scaled: ½ pᵀPᵀHP p + (J q + ½ (I + Pᵀ) H p0)ᵀp - loadᵀa with H = JM + MᵀJ.

    With P and p0 of `qp3.objective` every p in equilibrium is P p + p0 and p0 = (I - P) p, so that
    pᵀJM p = ½ (P p)ᵀH P p + p0ᵀH P p + ½ p0ᵀH (I - P) p: linear in parameters, and no constant is left.
    """
    J = scaled.weights
    work = 0.5 * cp.quad_form(p, cp.psd_wrap(hessian)) + cp.multiply(J, offset) @ p
    if a is None:
        return work
    weighted = J[:, None] * scaled.compliance
    balancing = scaled.balancing(np.eye(scaled.rigid_motions.shape[1]))
    held = 0.5 * (np.eye(len(J)) + scaled.projector.T) @ (weighted + weighted.T) @ balancing
    return work + (held @ load) @ p - load @ a


def _tool_displacement(given: Parameters, motions: cp.Expression | None) -> cp.Expression | None:
    """Displacements (t, 3) of the tools."""
    tools = given.rest.tools
    if not len(tools):
        return None
    moved = given.position if motions is None else given.position + tools.amplitudes @ motions
    return cp.reshape(moved, (len(tools), 3), order="C")
