"""A body condensed to its contact points: u_n = Δ1 + M p + R a with ℓᵀp = -load, [SS92] (11)-(15), (35)-(38).

Generalised to bodies that contact alone holds: the singular system is bordered by its free rigid motions, and
equilibrium itself is taken exactly, ℓ = J R, load = work of the applied loads in the free motions.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import linprog, nnls

from bemcontact.arrays import Array
from bemcontact.bem.contact_points import ContactPoints, contact_points
from bemcontact.bem.deflection import deflections
from bemcontact.bem.factorisation import solve
from bemcontact.bem.free_motions import BODY, UNSEEN, FreeMotions, PlacedTools, free_motions, placed_tools
from bemcontact.bem.loading import Loading, case_loadings, combined, permanent_loading
from bemcontact.bem.mesh import Mesh, build
from bemcontact.bem.rigid_motions import RigidMotions, free_rigid_motions
from bemcontact.bem.system import System
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.free_motions import Gauge, MotionAlgebra, fix_gauge
from bemcontact.contact.load_cases import LoadCases
from bemcontact.contact.tools import BALANCED, Pinned, Tools
from bemcontact.errors import Issue, ProblemError
from bemcontact.problem.problem import Problem

IDLE = 1e-7
"""Normal displacement in a motion that opens gaps, over that of the motion, from which it is one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """A problem on its mesh, before it is condensed: what is known, where contact may be, what may move rigidly.

    Parameters
    ----------
    problem, mesh, points : the stages up to here
    loadings : 1 + c, what is permanent and what each load case adds
    tools : rigid surfaces that move
    motions : all rigid motions of the body that the conditions leave free
    seen : those of them, and those of tools, or combinations, that move contact points along the rigid normals
    unseen : the others, that no contact point sees
    """

    problem: Problem
    mesh: Mesh
    points: ContactPoints
    loadings: tuple[Loading, ...]
    tools: PlacedTools
    motions: RigidMotions
    seen: FreeMotions
    unseen: FreeMotions

    @cached_property
    def factors(self) -> Array:
        """By how much each loading (1 + c,) acts."""
        named = self.problem.factors()
        return np.array([1.0, *(named.get(case, 0.0) for case in self.problem.load_cases)])

    @cached_property
    def acting(self) -> Loading:
        """What acts on the body."""
        return combined(self.loadings, self.factors.tolist())

    def motion_load(self, motions: FreeMotions) -> Array:
        """Work (k, 1 + c) of each loading, forces on tools included, in free motions [p L]."""
        on_body = np.column_stack([loading.work(self.mesh, motions.body) for loading in self.loadings])
        return on_body + motions.tools.T @ self.tools.force

    @cached_property
    def pinned(self) -> Pinned:
        """The motions that no contact point sees, with true loads: whether they balance is no matter of the mesh."""
        motions = self.unseen.in_user_units()
        return Pinned(
            motions=tuple(f"{motions.who(j)} against the {motions.way(j)}" for j in range(len(motions))),
            turns=np.array([motions.turns(j) for j in range(len(motions))], bool),
            load=np.column_stack([item.true_work(self.mesh, motions.body) for item in self.loadings]),
            tools=motions.tools,
            magnitude=np.array([item.magnitude(self.mesh) for item in self.loadings]),
            length=self.motions.radius,
        )

    @cached_property
    def forces(self) -> Array:
        """What the tools (3 t,) are loaded by."""
        return self.tools.force @ self.factors

    def normal_motion(self, motions: FreeMotions) -> Array:
        """R (n, k): what free motions add to the gaps."""
        return self.points.along_normals(motions.body) + self.tools.motions @ motions.tools

    @cached_property
    def relative_load(self) -> tuple[Array, Array]:
        """R (n, k) without round-off, and the load (k,) that acts in the seen motions, relative to the largest."""
        R, load = self.normal_motion(self.seen), self.motion_load(self.seen) @ self.factors
        largest = abs(load).max(initial=0.0)
        none = largest <= BALANCED * self.pinned.total(self.factors, self.forces)
        return np.where(abs(R) > UNSEEN, R, 0.0), np.zeros_like(load) if none else load / largest

    @cached_property
    def idle_motion(self) -> str | None:
        """A motion that opens gaps and closes none, and in which the loads do no work; None if there is none.

        Contact leaves open how far the body or a tool goes in it: a linear program.
        """
        R, load = self.relative_load
        if not load.size:
            return None
        found = linprog(
            -R.sum(axis=0), A_ub=-R, b_ub=np.zeros(len(R)), A_eq=load[None, :], b_eq=[0.0], bounds=(-1.0, 1.0),
            options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
        )  # fmt: skip
        idle = found.success and (R @ found.x).max() > IDLE
        return self.seen.combined(found.x[:, None]).describe()[0] if idle else None

    @property
    def notes(self) -> tuple[str, ...]:
        """What was decided and should be known."""
        pinned = tuple(
            f"the {motion} is seen by no contact point and loaded by nothing: {_pinned(self.unseen.who(j))} against it"
            for j, motion in enumerate(self.unseen.describe())
        )
        idle = self.idle_motion if self.relative_load[1].any() else None
        left_open = f"the loads do no work in the {idle}, which only opens gaps: contact leaves open how far it goes"
        return pinned if idle is None else (*pinned, left_open)


def _pinned(who: str) -> str:
    """Tell who is pinned."""
    return "they are pinned" if who.endswith(" together") else f"{who} is pinned"


def body_of(problem: Problem) -> Body:
    """Mesh a problem, spread its conditions, and find out whether contact can hold it.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    Body

    Raises
    ------
    ProblemError
        If the loads pull the body off its support, move it in a way that no contact resists, or do not press it on;
        or if the conditions of a deflected contour do not hold the body. Of a problem with load cases of which none
        acts, it is not asked whether contact can hold the body.
    """
    mesh = build(problem)
    permanent, cases = permanent_loading(problem, mesh), case_loadings(problem, mesh)
    added = [loading.values for loading in cases]
    points = contact_points(problem, mesh, permanent.values, deflections(problem, mesh), added)
    tools = placed_tools(problem, points)
    motions = free_rigid_motions(mesh, permanent.values.displacement_given)
    seen, unseen = free_motions(points, motions, tools)
    body = Body(
        problem=problem, mesh=mesh, points=points, loadings=(permanent, *cases), tools=tools,
        motions=motions, seen=seen, unseen=unseen,
    )  # fmt: skip
    if problem.case is not None or not problem.load_cases:
        ensure_held(body)
    return body


def each_case(body: Body) -> Iterator[Body]:
    """The body under each load case and combination where none of them acts yet; else nothing."""
    if body.problem.case is None:
        yield from (replace(body, problem=body.problem.with_case(name)) for name in body.problem.case_names)


def ensure_held(body: Body) -> None:
    """Refuse what acts on a body if contact cannot hold it; `ProblemError` as of `body_of`."""
    try:
        if complaint := body.pinned.complaint(body.factors, body.forces):
            raise ProblemError(complaint)
        _check_support(body)
    except ProblemError as error:
        case = body.problem.case
        if case is None:
            raise
        path = ("load_cases" if case in body.problem.load_cases else "combinations", case)
        raise ProblemError(Issue(path=path, message=str(error))) from None


def _check_support(body: Body) -> None:
    """Refuse loads that no pressure p >= 0 can balance, and what nothing presses on."""
    R, load = body.relative_load
    forces, residual = nnls(R.T, -load) if load.any() else (np.zeros(len(R)), 0.0)
    if residual > BALANCED:
        pull = body.seen.combined((R.T @ forces + load)[:, None])
        who, off = pull.who(0), "its support" if pull.who(0) == BODY else "what it touches"
        raise ProblemError(
            f"the load pulls {who} off {off}: it drives the {pull.way(0)}, which no contact resists; "
            "turn the load around, or move it to where contact can hold it, or prescribe a displacement that holds "
            f"{who if off == 'its support' else 'it'}"
        )
    if not load.any() and body.idle_motion is not None:
        raise ProblemError(
            f"only contact holds {_against(body.seen)}, but no load presses it onto its support, so that its position "
            "is not determined; apply a load, or prescribe a displacement"
        )


def _against(motions: FreeMotions) -> str:
    """What is free to move, and how: the body against one motion and another, and a tool against a third."""
    ways: dict[str, list[str]] = {}
    for j in range(len(motions)):
        ways.setdefault(motions.who(j), []).append(f"the {motions.way(j)}")
    return ", and ".join(f"{who} against {' and '.join(way)}" for who, way in ways.items())


@dataclass(frozen=True, kw_only=True, eq=False)
class Condensation:
    """A condensed body, and what it takes to find the whole boundary again from a pressure.

    Parameters
    ----------
    body : Body
    system : System
    response : (unknowns + border, 1 + c + n) solution for each loading alone and for unit pressures, dimensionless
    contact : CondensedContact
    gauge : Gauge
    """

    body: Body
    system: System
    response: Array
    contact: CondensedContact
    gauge: Gauge

    def acting(self, case: str | None = None) -> "Condensation":
        """The same body with the load case or combination that acts, or another; `ProblemError` as of `body_of`."""
        problem = self.body.problem if case is None else self.body.problem.with_case(case)
        if problem.case is None:
            return self
        body = replace(self.body, problem=problem)
        ensure_held(body)
        contact = self.contact.with_factors(problem.factors())
        named = replace(contact, name=problem.title, notes=body.notes)
        return replace(self, body=body, contact=named)

    @property
    def factors(self) -> Array:
        """By how much each loading (1 + c,) acts."""
        return np.append(1.0, self.contact.cases.factors)


def condense(body: Body) -> Condensation:
    """Eliminate everything but the contact points.

    Parameters
    ----------
    body : Body

    Returns
    -------
    Condensation

    Raises
    ------
    SingularSystemError
        If the equations of the body have no unique solution in floating-point arithmetic.
    """
    system = System(
        mesh=body.mesh, material=body.problem.material, points=body.points, motions=body.motions,
        loadings=body.loadings,
    )  # fmt: skip
    response = solve(system)
    points, tools, s = body.points, body.tools, len(body.loadings)
    observed = _observe(system, response)
    prescribed = [np.sum(points.normals * item.values.displacement[points.node], axis=1) for item in body.loadings]
    R, load = body.normal_motion(body.seen), body.motion_load(body.seen)
    own = np.any(body.seen.body.coefficients, axis=1)
    gauge = fix_gauge(
        MotionAlgebra(rigid_motions=R[:, own], weights=points.tributary, motion_load=load[own]),
        compliance=observed[:, s:] * (system.length / system.stress),
        free_displacement=observed[:, :s] * system.length + np.column_stack(prescribed),
    )
    on_body = np.where(own[:, None], load, 0.0)
    contact = CondensedContact(
        name=body.problem.name,
        zone_names=tuple(body.problem.contact_zones),
        units={"length": body.problem.units.length, "force": body.problem.units.force},
        notes=body.notes,
        motion_names=body.seen.describe(),
        points=body.mesh.nodes[points.node],
        normals=points.normals,
        zone=points.zone,
        run=points.run,
        arc_position=points.arc_position,
        run_length=points.run_length,
        compliance=gauge.compliance,
        free_displacement=gauge.free_displacement[:, 0],
        rigid_motions=R,
        motion_load=load[:, 0],
        initial_gap=points.gap + tools.motions @ tools.position[:, 0],
        weights=points.tributary,
        consistent_weights=points.consistent,
        element_length_weights=points.element_length,
        held_arc=points.held_arc,
        held_points=points.held_points,
        tools=Tools(
            names=tools.names,
            point=tools.point,
            motions=tools.motions,
            amplitudes=body.seen.tools,
            free=tools.free,
            position=tools.position[:, 0],
            force=tools.force[:, 0],
        ),
        pinned=body.pinned,
        cases=LoadCases(
            names=tuple(body.problem.load_cases),
            displacement=gauge.free_displacement[:, 1:],
            motion_load=on_body[:, 1:],
            position=tools.position[:, 1:],
            force=tools.force[:, 1:],
            factors=np.zeros(s - 1),
        ),
    )
    return Condensation(body=body, system=system, response=response, contact=contact, gauge=gauge).acting()


def _observe(system: System, response: Array) -> Array:
    """Normal displacement (n, s + n) at the contact points due to the unknowns, over L0."""
    points = system.points
    result = np.zeros((len(points), response.shape[1]))
    for normal, column in zip(points.normals.T, system.unknowns.displacement[points.node].T, strict=True):
        free = column >= 0
        result[free] += normal[free, None] * response[column[free]]
    return result
