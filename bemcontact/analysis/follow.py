"""Paths and sensitivities of a problem by the key paths of a spec."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from numbers import Real
from typing import Any, Unpack

import numpy as np

from bemcontact.adaptivity.adapt import Meshed, meshed
from bemcontact.adaptivity.mesh_sizes import cut
from bemcontact.adaptivity.resting_contacts import may_move
from bemcontact.analysis.path_states import FollowedPath, errors_at_breakpoints
from bemcontact.analysis.penetration import penetration_on_path
from bemcontact.analysis.result import Result
from bemcontact.analysis.solve import Prepared, Stopwatch, asked, assessed, ensure_acting, ensure_kind
from bemcontact.analysis.variation import Variation, case_of
from bemcontact.arrays import Array
from bemcontact.assessment.accuracy import Accuracy, ErrorBar
from bemcontact.bem.condense import condensed
from bemcontact.bem.modulus import modulus_rate
from bemcontact.checks.arguments import real_number, text_of_argument, texts
from bemcontact.contact.condensed_contact import CondensedContact
from bemcontact.contact.load_cases import Change
from bemcontact.errors import Issue, KeyPath, ProblemError, SingularSystemError, SolverError
from bemcontact.formulations import complementarity
from bemcontact.options import AskingKeywords, Weights
from bemcontact.parametric.parameter_path import ParameterPath
from bemcontact.parametric.path import COMMON, SAME, ensure_same_body, load_path
from bemcontact.parametric.sensitivity import Sensitivities
from bemcontact.parametric.sensitivity import sensitivities as sensitivities_of_contact
from bemcontact.problems.key_path import existing_path, parsed_path
from bemcontact.problems.problem import Problem
from bemcontact.problems.quantities import in_units
from bemcontact.problems.wording import described, unknown_word
from bemcontact.threads import one_thread

MODULUS = "young_modulus"
BODY = ("material", "boundary", "mesh", "materials")
"""Parts of a spec that make a body, so that more than gaps and loads depends on them."""
PLACED = {
    "bodies": ("material", "boundary", "copy_of", "shift", "rotate", "about", "rigid"),
    "contacts": ("between",),
}
"""Parts of several bodies and of their contacts that make or place bodies."""
BETWEEN = "errors between the breakpoints of a path are not estimated"
"""Why the mesh of a state on a path is not assessed."""
SHARES = tuple(0.5**k for k in range(1, 11))
"""Shares of the way between two values, at which gaps and loads are checked for linear change."""
NOTHING = 1e-13
"""Part of the largest entry that is the round-off of an entry that should be zero."""


@one_thread
def follow(
    problem: Problem, key: str, to: float | str, *, start: float | str | None = None, **asking: Unpack[AskingKeywords]
) -> ParameterPath:
    """Follow the contact state while one value of the problem changes, exactly.

    Parameters
    ----------
    problem : Problem
    key : path to the value, as of `Problem.with_value`, or "load_cases.wind" for the factor of a load case; gaps and
        loads must depend on it linearly, and nothing else
    to : value at the end of the path, a number or one with a unit, such as 40 MPa
    start : value at its beginning, that of the problem if not given
    asking : variant, set, case, accuracy and refine, as of `bemcontact.solve`

    Returns
    -------
    ParameterPath

    Raises
    ------
    ProblemError
        If the key leads to no number, more than gaps and loads depend on it, they do not linearly, or there is no
        contact state at either end.
    """
    ensure_kind(problem, Problem)
    problem = asked(problem, asking)
    text_of_argument(key, "key")
    end = _number(problem, key, to, f"{key}: the value at the end of the path (to)")
    begin = stated_value(problem, key) if start is None else _number(problem, key, start, f"{key}: the start value")
    if case_of(problem, key) is None:
        ensure_acting(problem)
    if begin == end:
        raise ProblemError(f"{key}: a path needs two different finite values; found {begin!r} and {end!r}")
    _ensure_no_part_of_bodies(parsed_path(key))
    on_mesh, found = _on_mesh(problem, key, begin, end)
    varied = Variation(on_mesh, key)
    path = load_path(*(replace(contact, name=problem.title) for contact in between(varied, begin, end)))
    first, last = (_accuracy(varied, value, found.get(value), _is_halved(on_mesh, found)) for value in (begin, end))
    infinite = (*first.infinite, *last.infinite)
    followed = FollowedPath(varied, path, begin, end)
    deepest, at, said = penetration_on_path(followed, infinite=infinite)
    bars = _errors(followed, found) if first.bars or last.bars else ()
    return ParameterPath(
        key=key, start=begin, end=end, path=path, start_accuracy=first, end_accuracy=last,
        penetration=deepest, penetrates_at=at, said=said, breakpoint_bars=bars,
        result_at=partial(_result, followed, Accuracy(asked=None, reason=BETWEEN).knowing(first, last)),
    )  # fmt: skip


def _number(problem: Problem, key: str, value: object, what: str) -> float:
    """Read a value of a key, a number or one with a unit."""
    if isinstance(value, str):
        value = in_units(value, parsed_path(key), problem.units.length.strip(), problem.units.force.strip())
    return real_number(value, what)


def _result(followed: FollowedPath, accuracy: Accuracy, t: float) -> Result:
    """The state at t of a path as a result; pressures are infinite only in zones that have some."""
    solution = followed.path.at(t)
    condensation, boundary = followed.state(t, solution)
    contact = condensation.contact
    pressed = {contact.zone_names[i] for i in np.unique(contact.zone[solution.pressure > 0])}
    accuracy = replace(accuracy, bars=tuple(bar for bar in accuracy.bars if bar.zone in pressed))
    here = Prepared(contact=contact, condensation=condensation, accuracy=accuracy)
    return assessed(here, solution, Weights.TRIBUTARY, Stopwatch(), boundary=boundary)


@one_thread
def sensitivities(
    problem: Problem | CondensedContact,
    changes: Mapping[str, Change] | Sequence[str] | None = None,
    **asking: Unpack[AskingKeywords],
) -> Sensitivities:
    """Differentiate the contact state of a problem.

    Parameters
    ----------
    problem : Problem or CondensedContact
    changes : with respect to what. By key, each per unit; or keys alone: those of `CondensedContact.changes`,
        "initial_gap[i]" for the gap at point i, and, of a `Problem`, also paths to a `young_modulus`, and to any value
        on which gaps and loads depend linearly, and nothing else. If not given, `CondensedContact.changes`. Pairs of
        points of several bodies are kept
    asking : variant, set, case, accuracy and refine, as of `bemcontact.solve`

    Returns
    -------
    Sensitivities
        On the mesh of the problem or on one that is found, with the error bars of the contact state.

    Raises
    ------
    ProblemError
        If a key is none of these, there is no contact state, or it does not determine a derivative.
    SingularSystemError
        If the equations of contact are singular to working precision.
    """
    ensure_kind(problem)
    problem = asked(problem, asking)
    ensure_acting(problem)
    given = changes if changes is None or isinstance(changes, Mapping) else _keys(changes)
    if isinstance(problem, CondensedContact):
        return _sensitivities(problem, None, given)
    found = meshed(problem)
    (accuracy,) = found.accuracies
    return _sensitivities(found.condensation.contact, found, given).knowing(accuracy)


def _sensitivities(
    contact: CondensedContact, found: Meshed | None, given: Mapping[str, Change] | Sequence[str] | None
) -> Sensitivities:
    """Sensitivities of a condensed problem, and of the problem on its mesh that it came from."""
    if given is None or isinstance(given, Mapping):
        return sensitivities_of_contact(contact, given)
    solution, known = complementarity.solve(contact), contact.changes
    wanted = {key: known[key] if key in known else _change(contact, found, key, solution.pressure) for key in given}
    return sensitivities_of_contact(contact, wanted, solution)


def _on_mesh(problem: Problem, key: str, start: float, end: float) -> tuple[Problem, Mapping[float, Meshed]]:
    """The problem on a mesh that is accurate at both ends of a path, if a mesh is to be found.

    Pairs of points of two elastic bodies are those at the end of the path. With the problem comes what the searches at
    both ends found, for only a search recognizes infinite pressures. At one end the load may fail to press the body
    onto its support.
    """
    if not problem.adapts:
        if may_move(problem):
            with suppress(ProblemError):
                problem = problem.on_contacts_of(meshed(Variation(problem, key).at(end), errors=False).problem)
        return problem, {}
    problem = problem.model_copy(update={"variants": {}})  # they may not fit the mesh that is found
    found: dict[float, Meshed] = {}
    refused: list[ProblemError] = []
    on_mesh = problem
    for value in (start, end):
        try:
            found[value] = meshed(Variation(_no_coarser(problem, on_mesh), key).at(value))
        except ProblemError as error:
            refused.append(error)
        else:
            on_mesh = problem.on_mesh_of(found[value].problem).on_contacts_of(found[value].problem)
    if not found:
        raise refused[0]
    return on_mesh, found


def _no_coarser(problem: Problem, on_mesh: Problem) -> Problem:
    """The problem with the elements of a mesh that was found for it, of which another one is to be made.

    They are the elements before their cut, for the next search cuts its mesh too.
    """
    if on_mesh is problem:
        return problem
    ends = {edge.name: edge.breakpoints()[1:-1].tolist() for edge in on_mesh.edges}
    whole = problem.on_mesh_of(on_mesh.with_element_ends(ends))
    return whole.model_copy(
        update={"mesh": problem.mesh.model_copy(update={"adapt": True}), "accuracy": problem.accuracy}
    )


def _accuracy(varied: Variation, value: float, found: Meshed | None, halved: bool) -> Accuracy:
    """Accuracy of the mesh at one value of a key; a load that presses nothing has no errors to estimate."""
    if found and all(
        one.boundary is other.boundary for one, other in zip(found.problem.parts, varied.problem.parts, strict=True)
    ):
        return found.accuracies[0]
    try:
        singular = found.singular if found else ()
        (accuracy,) = meshed(varied.at(value), singular=singular, halved=halved).accuracies
    except ProblemError as error:
        return Accuracy(asked=varied.problem.asked_accuracy, reason=str(error).splitlines()[0])
    return accuracy.knowing(*found.accuracies) if found else accuracy


def _is_halved(problem: Problem, found: Mapping[float, Meshed]) -> bool:
    """Whether a mesh that was found has halved elements; where no state could be solved, it has the first ones."""
    return bool(found) and problem.mesh.refine % 2 == 0


def _errors(followed: FollowedPath, found: Mapping[float, Meshed]) -> tuple[tuple[ErrorBar, ...], ...]:
    """Error bars at each breakpoint, by a path on elements half as long, or twice if the mesh was found; or none."""
    problem, key, start, end = followed.varied.problem, followed.varied.key, followed.start, followed.end
    refine, of_fine = problem.mesh.refine, _is_halved(problem, found)
    varied = Variation(cut(problem, refine // 2 if of_fine else 2 * refine), key)
    try:
        other = FollowedPath(varied, load_path(*between(varied, start, end)), start, end)
    except (ProblemError, SingularSystemError, SolverError):
        return ()
    singular = max((meshed.singular[0] for meshed in found.values() if meshed.singular), key=len, default=())
    pair = (other, followed) if of_fine else (followed, other)
    return tuple(errors_at_breakpoints(*pair, singular if of_fine else None, of_fine=of_fine))


def _keys(changes: object) -> tuple[str, ...]:
    """Read key paths, a single one as a list."""
    keys = texts((changes,) if isinstance(changes, str) else changes, "the keys of changes")
    for key in keys:
        parsed_path(key)
    return keys


def _change(contact: CondensedContact, found: Meshed | None, key: str, pressure: Array) -> Change:
    """Change of gap and load per unit of a key that is neither a load case nor a tool component."""
    path = parsed_path(key)
    if path[0] == "initial_gap":
        if len(path) == 2 and isinstance(path[1], int) and path[1] < contact.size:
            return Change(np.eye(contact.size)[path[1]], np.zeros(contact.free_motions))
        raise ProblemError(
            f"there is no '{key}': the contact points have initial_gap[0] to initial_gap[{contact.size - 1}]"
        )
    if found is None:
        known = ", ".join((*contact.changes, f"initial_gap[0] to initial_gap[{contact.size - 1}]"))
        raise ProblemError(f"there is no '{key}' in this condensed problem; it has: {known}")
    problem = found.problem
    value = stated_value(problem, key)
    if path[-1] == MODULUS:
        doubled = condensed(problem.with_value(key, 2 * value).on_contacts_of(problem))
        rate = modulus_rate(found.condensation, doubled, value, pressure)
        return Change(rate, np.zeros(contact.free_motions))
    other = 2 * value or 1.0
    first, last = between(Variation(problem, key), value, other)
    width = other - value
    return Change((last.offset - first.offset) / width, (last.motion_load - first.motion_load) / width)


def stated_value(problem: Problem, key: str) -> float:
    """Number at a key path, the value of a constant field, or the factor of a load case; else `ProblemError`."""
    if (case := case_of(problem, key)) is not None:
        return problem.factors().get(case, 0.0)
    data: Any = problem.model_dump()
    path = existing_path(data, parsed_path(key))
    for step in path:
        if isinstance(data, Mapping) and step not in data:
            message = f"there is no number to vary: {unknown_word('entry', str(step), map(str, data))}"
            raise ProblemError(Issue(path=path, message=message))
        data = None if data is None else data[step]
    if isinstance(data, Mapping) and "constant" in data and not any(data[name] for name in data if name != "constant"):
        data = data["constant"]
    if not isinstance(data, Real) or isinstance(data, bool):
        reason = "it is left out; state it, or give the start value"
        if data is not None:
            reason = f"it is {described(data)}; give a path to a number, or the start value"
        message = f"there is no number to vary: {reason}"
        raise ProblemError(Issue(path=path, message=message))
    return float(data)


def between(varied: Variation, start: float, end: float) -> tuple[CondensedContact, CondensedContact]:
    """Condense a problem at two values of a key, and check that gaps and loads change linearly between them.

    At one of the two values the load may fail to press the body onto its support. The contact problem at this value is
    extrapolated. `ProblemError` if neither value can be condensed, more than gaps and loads depends on the key, or the
    dependence is not linear. The mesh of the problem must not be one to be fitted.
    """
    _ensure_no_part_of_bodies(varied.path)
    if varied.acts_on_contact:
        return _stepped(varied, start, end)
    first, last = (varied.attempted(value) for value in (start, end))
    if isinstance(first, ProblemError):
        if isinstance(last, ProblemError):
            raise last
        return _extended(varied, last, end, start), last
    if isinstance(last, ProblemError):
        return first, _extended(varied, first, start, end)
    share, middle = _farthest(varied, start, end)
    _ensure_linear(varied.key, first, middle, last, share)
    return first, last


def _ensure_no_part_of_bodies(path: KeyPath) -> None:
    """Refuse a value that makes or places a body."""
    if path[0] in BODY or (len(path) > 2 and path[2] in PLACED.get(str(path[0]), ())):
        raise ProblemError(Issue(path=path, message=f"the compliance depends on it; {EXACT}"))


def _stepped(varied: Variation, start: float, end: float) -> tuple[CondensedContact, CondensedContact]:
    """The ends of a path over a factor or a component of a tool, condensed once: at an end that can be condensed."""
    at, contact = start, varied.attempted(start)
    if isinstance(contact, ProblemError):
        at, contact = end, varied.attempted(end)
    if isinstance(contact, ProblemError):
        raise contact
    first, last = (_with_step(contact, varied.path, value, value - at) for value in (start, end))
    return first, last


def _with_step(contact: CondensedContact, path: KeyPath, value: float, step: float) -> CondensedContact:
    """Set the factor of a load case to a value, or change a component of a tool by a step."""
    if not step:
        return contact
    if path[0] == "load_cases":
        factors = dict(zip(contact.cases.names, contact.cases.factors.tolist(), strict=True))
        return contact.with_factors({**factors, str(path[1]): value})
    steps = step * (np.array(contact.tools.keys) == ".".join(map(str, path)))
    return contact.with_tools(contact.tools.position + steps, contact.tools.force + steps)


def _farthest(varied: Variation, start: float, end: float) -> tuple[float, CondensedContact]:
    """Largest of `SHARES` at which the problem can be condensed, and this contact problem; else `ProblemError`."""
    refused: list[ProblemError] = []
    for share in SHARES:
        contact = varied.attempted(start + share * (end - start))
        if isinstance(contact, CondensedContact):
            return share, contact
        refused.append(contact)
    raise refused[0]


def _ensure_linear(
    key: str, first: CondensedContact, middle: CondensedContact, last: CondensedContact, share: float
) -> None:
    """Refuse a value on which more than gaps and loads depends, or these not linearly up to a share of the way."""
    for end in (first, last):
        try:
            ensure_same_body(middle, end)
        except ProblemError:
            part = next(what for name, what in COMMON.items() if _differs(getattr(middle, name), getattr(end, name)))
            message = f"the {part} depends on it; {EXACT}"
            raise ProblemError(Issue(path=parsed_path(key), message=message)) from None
    displacement, pressure = np.max([first.scales, last.scales], axis=0)
    least = {"offset": displacement, "motion_load": pressure * np.abs(middle.equilibrium).sum(axis=0)}
    for name, what in (("offset", "gap"), ("motion_load", "load")):
        one, inner, other = (getattr(item, name) for item in (first, middle, last))
        size = np.maximum(np.abs([one, other]).max(axis=0), least[name])
        if (bend := float((np.abs(inner - (1 - share) * one - share * other) / size).max(initial=0.0))) > SAME:
            message = f"the {what} depends on it nonlinearly, by {bend:.2g} relatively; {LINEAR}"
            raise ProblemError(Issue(path=parsed_path(key), message=message))


EXACT = "only loads, gaps and tools can be varied"
LINEAR = "only values can be varied that gaps and loads depend on linearly, such as forces and displacements"


def _differs(one: Array, other: Array) -> bool:
    return one.shape != other.shape or bool(np.abs(one - other).max(initial=0.0) > SAME * np.abs(one).max(initial=0.0))


def _extended(varied: Variation, first: CondensedContact, start: float, end: float) -> CondensedContact:
    """The contact problem at an end where nothing presses the body onto its support, extrapolated from the start."""
    reached, there = _farthest(varied, start, end)
    share, middle = _farthest(varied, start, start + reached * (end - start))
    _ensure_linear(varied.key, first, middle, there, share)

    def beyond(one: Array, other: Array) -> Array:
        value = one + (other - one) / reached
        return np.where(np.abs(value) <= NOTHING / reached * np.abs(one).max(initial=0.0), 0.0, value)

    tools, cases = first.tools, first.cases
    return replace(
        first,
        free_displacement=beyond(first.free_displacement, there.free_displacement),
        initial_gap=beyond(first.initial_gap, there.initial_gap),
        motion_load=beyond(first.motion_load, there.motion_load),
        tools=replace(
            tools, position=beyond(tools.position, there.tools.position), force=beyond(tools.force, there.tools.force)
        ),
        cases=replace(cases, factors=beyond(cases.factors, there.cases.factors)),
    )
