"""Whether contact holds a body against its loads, and in which motions it does not."""

from collections.abc import Iterator

import numpy as np

from bemcontact.arrays import Array, BoolArray, nonnegative_residual, norm
from bemcontact.bem.body import Body
from bemcontact.bem.free_motions import BODY, UNSEEN, FreeMotions
from bemcontact.bem.rigid_motions import toward
from bemcontact.contact.free_motions import unseen_ways
from bemcontact.contact.load_cases import BALANCED
from bemcontact.errors import Issue, ProblemError
from bemcontact.problems.curves import CircularArc
from bemcontact.problems.rigid_surface import Circle

HELD_INSIDE = 1e-6
"""Depth over the size of a body up to which it is drawn as held in a surface: that of coordinates with six digits."""
IDLE = 1e-3
"""Least normal displacement, over that of the motion, of a motion that opens gaps. As a roller turns about nearly its
middle, gaps on a coarse mesh seem to open, by less. A motion without any turn has no such error."""


def each_case(body: Body) -> Iterator[Body]:
    """The body under each load case and combination where none of them acts yet; else nothing."""
    if body.problem.case is None:
        yield from (body.under(body.problem.with_case(name)) for name in body.problem.case_names)


def ensure_held(body: Body) -> None:
    """Refuse loads that contact cannot hold, with the `ProblemError` of `body_of`."""
    try:
        if len(body.pinned.motions):
            units = body.problem.units.model_dump()
            if violation := body.pinned.violation(body.factors, body.forces, units):
                raise ProblemError(violation + _rest_in_bore(body))
        _ensure_room_where_held(body)
        _check_support(body)
    except ProblemError as error:
        case = body.problem.case
        if case is None:
            raise
        path = ("load_cases" if case in body.problem.load_cases else "combinations", case)
        raise ProblemError(Issue(path=path, message=str(error))) from None


def _rest_in_bore(body: Body) -> str:
    """Say where a round body has to be drawn in a round bore so that its load goes through the middle of the bore."""
    problem, unit = body.problem, body.seen.with_coefficients(np.eye(body.seen.coefficients.shape[1]))
    bores = [zone.surface for zone in problem.zones.values()]
    rims = [problem.edge(name).curve for zone in problem.zones for name in problem.edges_of(zone)]
    if problem.several or problem.tools or not all(isinstance(it, Circle) and it.body == "inside" for it in bores):
        return ""
    middles = (
        {it.center for it in bores if isinstance(it, Circle)},
        {it.center for it in rims if isinstance(it, CircularArc)},
    )
    if not all(isinstance(it, CircularArc) for it in rims) or any(len(it) > 1 for it in middles):
        return ""
    (bore,), (rim,) = np.array(list(middles[0])), np.array(list(middles[1]))
    force = body.motion_load(unit)[:2] @ body.factors
    moment = body.motion_load(unit.rotations([tuple(rim.tolist())]))[0] @ body.factors
    if not force.any() or abs(moment) > BALANCED * problem.size * np.hypot(*force):
        return ""
    x, y = bore + np.hypot(*(rim - bore)) * force / np.hypot(*force) - rim
    return (
        f"; it slides around the bore until its load goes through the middle of the bore: draw it there, moved by "
        f"({x:.12g}, {y:.12g})"
    )


def _ensure_room_where_held(body: Body) -> None:
    """Refuse a surface that lies inside the body where conditions hold it: pressure there would have no bound."""
    held, problem, gap = body.points.held, body.problem, body.held_gaps
    if held is None or not len(gap):
        return
    if (depth := -gap.min(initial=0.0)) > HELD_INSIDE * body.mesh.size:
        worst = int(gap.argmin())
        x, y = body.mesh.nodes[held.node[worst]]
        inside = f"{depth:.3g} {problem.units.length}".strip()
        message = (
            f"where conditions hold the body, at ({x:.5g}, {y:.5g}), this surface is {inside} inside it: no pressure "
            "makes room there; move the surface, or hold the body elsewhere, or end the contact edge before this place"
        )
        zone = [*problem.zones][held.zone[worst]]
        raise ProblemError(Issue(path=("contact_zones", zone, "surface"), message=message))


def _check_support(body: Body) -> None:
    """Refuse loads that no pressure p >= 0 can balance, and a body that no load presses on."""
    R, load = body.relative_load
    pull = nonnegative_residual(R.T, -load)
    if norm(pull) > BALANCED:
        raise ProblemError(_pull(body, body.seen.combined(pull[:, None])))
    if not load.size or load.any():
        return
    shifts = unseen_ways(body.seen.coefficients[:, 2::3].T, UNSEEN)
    leaves = _may_leave(R) or _may_leave(R @ shifts, UNSEEN)
    if leaves or (idle_motion(body) is not None and not _may_be_squeezed(body)):
        raise ProblemError(
            f"contact holds {_against(body.seen)}, but no load presses it onto its support, so that its position "
            "is not determined; apply a load, or prescribe a displacement"
        )


def idle_motion(body: Body) -> str | None:
    """A motion that opens gaps and closes none, and in which the loads do no work; None if there is none.

    Its amplitude is not determined. Among the motions a with R a >= 0 in which the loads do no work, it is the one
    nearest to Rᵀ1, which opens all gaps.
    """
    R, load = body.relative_load
    if not load.size or (load.size == 1 and load.any()):
        return None
    workless = np.linalg.svd(load[None, :])[2][1:].T if load.any() else np.eye(load.size)
    rates = R @ workless
    rates[abs(rates) <= UNSEEN] = 0.0
    part, opened = _opening(rates)
    return body.seen.combined((workless @ part)[:, None]).describe()[0] if opened.any() else None


def _may_be_squeezed(body: Body) -> bool:
    """Whether a load, a displacement, a tool or a surface inside the body is stated: what may press without a load."""
    values, particular = body.acting.values, body.acting.particular
    stated = any(part.any() for part in (values.displacement, values.traction, particular.displacement))
    return stated or bool(body.problem.tools) or bool(body.points.gap.min() < -UNSEEN * body.mesh.size)


def _may_leave(rates: Array, least: float = IDLE) -> bool:
    """Whether motions with these changes (n, k) of gaps open all of them, by a `least` part, and close none."""
    while len(rates):
        opened = _opening(rates, least)[1]
        if not opened.any():
            return False
        rates = rates[~opened]  # enough of this motion makes up for what others close of these
    return True


def _opening(rates: Array, least: float = IDLE) -> tuple[Array, BoolArray]:
    """The motion (k,) of those with rates (n, k) that closes no gap and is nearest to ratesᵀ1; which (n,) it opens.

    It is a residual of nonnegative least squares (Moreau).
    """
    part = nonnegative_residual(rates.T, -rates.sum(axis=0))
    part /= max(np.linalg.norm(part), UNSEEN)
    size = abs(part).max(initial=0.0)
    return part, (rates @ part > least * size) & (size > UNSEEN)


def _pull(body: Body, pull: FreeMotions) -> str:
    """Say in which motion the loads pull the body or a tool off, and what to add against it."""
    who, way, direction = pull.who(0), pull.way(0), pull.direction(0)
    many = pull.several(0)
    off = "its support" if who == BODY else "what they touch" if many else "what it touches"
    load, against = "", "against this motion"
    if direction is not None:
        resultant = (body.motion_load(pull.along(0)) @ body.factors + 0.0).tolist()
        load, against = " of ({:.4g}, {:.4g})".format(*resultant), toward(-direction)
        load += f" {body.problem.units.line_force}".rstrip()
        way = f"{way}, {toward(direction)}"
    return (
        f"the load{load} pulls {who} off {off}: it drives the {way}, which nothing holds; add a load {against} that "
        f"presses {who} on, or turn the load around or move it, or prescribe a displacement that holds "
        f"{who if who == BODY else 'them' if many else 'it'}"
    )


def _against(motions: FreeMotions) -> str:
    """Describe who is free to move, and how: the body against one motion and another, and a tool against a third."""
    ways: dict[str, list[str]] = {}
    for j in range(len(motions)):
        ways.setdefault(motions.who(j), []).append(f"the {motions.way(j)}")
    return ", and ".join(f"{who} against {' and '.join(way)}" for who, way in ways.items())
