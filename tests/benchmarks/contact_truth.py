"""QP1 and QP2 of contact problems whose solution is known: units and stiffness, random starts, all contact sets.

    OPENBLAS_NUM_THREADS=1 python tests/benchmarks/contact_truth.py [TABLE ...] [--starts N] [--seeds N] [--nodes N ...]

TABLE is any of units, starts, sets, iterations; all of them if none is named. Nothing is polished. The reference is the
direct solver; of at most eight contact points, all contact sets. With the defaults a few minutes.
"""

import argparse
import statistics
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from contact_instance import (
    FREE,
    HELD,
    Array,
    Kind,
    beam_above_a_plane,
    beam_on_its_own_shape,
    contact_states,
    cylinder,
    hertz,
    in_newton_metres,
    is_among,
)
from local_solver import OURS
from peers import Claim, run
from qp_instance import Instance, compliance_rows, half_plane
from qp_instance import qp1 as raw_qp1
from qp_instance import qp2 as raw_qp2
from rich.console import Console
from rich.table import Table

from bemcontact import CondensedContact, ContactSolution, Equilibrium, Status, minimize_qp
from bemcontact.formulations import FORMULATIONS, complementarity
from bemcontact.formulations.scaling import scale
from bemcontact.formulations.starts import draw_starts
from bemcontact.options import SolveOptions

MODULI = (1e3, 2e6, 2e11)
"""Young's moduli in kN/cm²."""
RIGHT = 1e-8
"""Largest error of p and of u_n, each over its own largest entry, that is promised from the null vector."""
NEAR = 1e-6
"""The same, of an end that is the contact state and not another one."""
PENALTIES = (0.1, 1.0, 10.0)
QPSOL = {"qp1": 63, "qp2": 47, "qp3": 70}
"""Iterations that [SS92] prints for its first problem."""


@dataclass(frozen=True, kw_only=True)
class Error:
    """Largest error of p and of u_n over their largest entries, nan where a solver returned no numbers."""

    pressure: float
    displacement: float

    def __str__(self) -> str:
        text = f"{self.pressure:.0e} {self.displacement:.0e}"
        return f"[red]{text}[/red]" if not self.within(RIGHT) else text

    def within(self, tolerance: float) -> bool:
        return max(self.pressure, self.displacement) <= tolerance


def error(truth: ContactSolution, pressure: Array, displacement: Array) -> Error:
    return Error(
        pressure=float(np.abs(pressure - truth.pressure).max() / np.abs(truth.pressure).max()),
        displacement=float(np.abs(displacement - truth.displacement).max() / np.abs(truth.displacement).max()),
    )


def unpolished(contact: CondensedContact, formulation: str, options: SolveOptions | None = None) -> ContactSolution:
    return FORMULATIONS[formulation](contact, replace(options or SolveOptions.of(formulation), polish=False))


def from_draw_starts(
    contact: CondensedContact, formulation: str, count: int, options: SolveOptions | None = None
) -> list[ContactSolution]:
    given = options or SolveOptions.of(formulation)
    return [unpolished(contact, formulation, replace(given, start=start)) for start in draw_starts(contact, count)]


def table(title: str, *headings: str) -> Table:
    """The first column is of words, the others of numbers."""
    made = Table(title=title, title_justify="left")
    for number, heading in enumerate(headings):
        made.add_column(heading, justify="right" if number else "left")
    return made


def in_all_units(nodes: Iterable[int]) -> Iterator[tuple[str, str, CondensedContact]]:
    """Half-plane and Hertz at all moduli in kN and cm, and in N and m: the name, the units, the problem."""
    for modulus in MODULI:
        for n in nodes:
            for name, contact in (("half-plane", half_plane(n, modulus, seed=1)), ("Hertz", hertz(n, modulus))):
                for units, same in (("kN cm", contact), ("N m", in_newton_metres(contact))):
                    yield f"{name} E={modulus:.0e} n={n}", units, same


def units_and_stiffness(nodes: list[int], limit: float) -> Table:
    """Errors of p and u_n in the package's scaled form, and of the statement as printed, unscaled."""
    made = table(
        f"from the null vector: errors of p and of u_n over their largest entries (red: above {RIGHT:.0e})",
        "problem", "units", "QP1 scaled", "QP2 scaled", "QP1 raw", "claim", "QP2 raw, μ = 1", "claim",
    )  # fmt: skip
    columns: list[list[Error]] = [[], [], [], []]
    for name, units, contact in in_all_units(nodes):
        truth = complementarity.solve(contact)
        scaled_form = [unpolished(contact, formulation) for formulation in ("qp1", "qp2")]
        errors = [error(truth, found.pressure, found.displacement) for found in scaled_form]
        printed = [as_printed(state(contact, compliance_rows(contact)), truth, limit) for state in (raw_qp1, raw_qp2)]
        errors += [found for found, _ in printed]
        first, second, third, fourth = map(str, errors)
        made.add_row(name, units, first, second, third, printed[0][1], fourth, printed[1][1])
        for column, found in zip(columns, errors, strict=True):
            column.append(found)
    first, second, third, fourth = (f"{sum(e.within(RIGHT) for e in column)}/{len(column)}" for column in columns)
    made.add_section()
    made.add_row("right", "", first, second, third, "", fourth, "")
    return made


def as_printed(instance: Instance, truth: ContactSolution, limit: float) -> tuple[Error, str]:
    """Error and claim of the local solver on u_n = M p + Δ1 in raw units; a claim far from the truth is red."""
    answer = run(OURS, instance, limit)
    n = len(truth.pressure)
    x = np.full(2 * n, np.nan) if answer.x is None else answer.x
    found = error(truth, x[n:], x[:n])
    false = answer.claim is not Claim.NOTHING and not found.within(NEAR)  # F2 >= 0 is neither unbounded nor infeasible
    return found, f"[red]{answer.says}[/red]" if false else answer.says


def bodies(small: bool) -> Iterator[CondensedContact]:
    """The beams of [SS92] at about 20 contact points, and at about 80 unless small; the cylinder."""
    for along in (10,) if small else (10, 40):
        yield beam_on_its_own_shape(along)
        yield beam_above_a_plane(along)
    yield cylinder()


def random_starts(count: int, small: bool) -> Table:
    """How many searches end at the contact state, how near to it, and after how many iterations."""
    made = table(
        f"{count} random starts; errors of those that end at the contact state",
        "body", "cond M", "statement", "right", "told wrongly", "error of p", "of u_n", "iterations", "seconds",
    )  # fmt: skip
    for contact in bodies(small):
        truth = complementarity.solve(contact)
        for formulation in ("qp1", "qp2"):
            begin = time.perf_counter()
            found = from_draw_starts(contact, formulation, count)
            seconds = time.perf_counter() - begin
            errors = [error(truth, end.pressure, end.displacement) for end in found]
            right = [one for one in errors if one.within(NEAR)]
            false = sum(
                (end.status is Status.SOLVED) != one.within(NEAR) for end, one in zip(found, errors, strict=True)
            )
            steps = [end.iterations for end in found]
            made.add_row(
                contact.name, condition(contact), formulation, f"{len(right)}/{count}", str(false),
                f"{max((one.pressure for one in right), default=np.nan):.0e}",
                f"{max((one.displacement for one in right), default=np.nan):.0e}",
                f"{min(steps)}/{statistics.median(steps):g}/{max(steps)}", f"{seconds:.1f}",
            )  # fmt: skip
    return made


def condition(contact: CondensedContact) -> str:
    """That of M on the equilibrium space."""
    free = np.linalg.qr(contact.equilibrium, mode="complete")[0][:, contact.free_motions :]
    return f"{np.linalg.cond(free.T @ contact.compliance @ free):.0e}"


@dataclass(frozen=True, kw_only=True)
class Search:
    """One end: how it is told, its scaled objective, and whether it is one of the contact states."""

    status: Status
    objective: float
    right: bool

    @property
    def told_right(self) -> bool:
        return self.right == (self.status is Status.SOLVED)


def searches(
    contact: CondensedContact, states: list[Array], count: int, formulation: str, options: SolveOptions
) -> list[Search]:
    """From random starts."""
    T = contact.scales.pressure
    return [
        Search(status=end.status, objective=end.search.objective, right=is_among(end.pressure / T, states))
        for end in from_draw_starts(contact, formulation, count, options)
        if end.search
    ]


def qp3_searches(contact: CondensedContact, states: list[Array], count: int) -> list[Search]:
    """QP3 over p of a held body by the local solver, convex or not: min pᵀJ(q + M p), q + M p >= 0, p >= 0."""
    scaled, found = scale(contact), []
    weighted = scaled.weights[:, None] * scaled.compliance
    for start in draw_starts(contact, count):
        end = minimize_qp(
            weighted + weighted.T, scaled.weights * scaled.offset, A=scaled.compliance, cl=-scaled.offset,
            bl=np.zeros(contact.size), x0=start.pressure / contact.scales.pressure,
        )  # fmt: skip
        right = is_among(end.x, states)
        status = Status.SOLVED if abs(end.objective) <= NEAR else Status.LOCAL_MINIMUM
        found.append(Search(status=status, objective=end.objective, right=right))
    return found


def statements(contact: CondensedContact, states: list[Array], count: int) -> Iterator[tuple[str, list[Search]]]:
    """The name of each statement and what it finds."""
    yield "QP1", searches(contact, states, count, "qp1", SolveOptions.of("qp1"))
    for options in map(with_penalty, PENALTIES):
        yield f"QP2 μ = {options.penalty:g}", searches(contact, states, count, "qp2", options)
    if not contact.free_motions:
        yield "QP3, local solver", qp3_searches(contact, states, count)
        return
    for options in map(with_penalty, PENALTIES):
        name, paper = f"QP2 μ = {options.penalty:g}, ℓᵀp penalized", replace(options, equilibrium=Equilibrium.PENALTY)
        yield name, searches(contact, states, count, "qp2", paper)


def with_penalty(penalty: float) -> SolveOptions:
    return SolveOptions.of("qp2", penalty=penalty)


def all_contact_sets(count: int, seeds: int, sizes: list[int]) -> Table:
    """Of each kind: what all contact sets give, and where searches from random starts end."""
    made = table(
        f"{seeds} problems of each size {sizes}, all contact sets, {count} random starts each",
        "M, J", "problems", "contact sets", "states", "statement", "ends", "right", "spurious", "infeasible",
        "told wrongly", "most objective, right", "least, spurious",
    )  # fmt: skip
    for kind in (*HELD, *FREE):
        add_kind(made, kind, count, [(seed, n) for n in sizes for seed in range(seeds)])
    return made


def add_kind(made: Table, kind: Kind, count: int, drawn: list[tuple[int, int]]) -> None:
    """The rows of a kind of problems, one for each statement."""
    found: dict[str, list[Search]] = {}
    number = 0
    for seed, n in drawn:
        contact = kind(np.random.default_rng([seed, n]), n)
        states = contact_states(contact)
        number += len(states)
        for name, ends in statements(contact, states, count):
            found.setdefault(name, []).extend(ends)
    words = [kind.__name__.replace("_", " "), str(len(drawn)), str(sum(2**n for _, n in drawn)), str(number)]
    for name, ends in found.items():
        right = [end for end in ends if end.right]
        infeasible = sum(end.status is Status.INFEASIBLE for end in ends)
        spurious = [end.objective for end in ends if not end.right and end.status is not Status.INFEASIBLE]
        made.add_row(
            *words, name, str(len(ends)), str(len(right)), str(len(spurious)), str(infeasible),
            str(sum(not end.told_right for end in ends)),
            f"{max((abs(end.objective) for end in right), default=np.nan):.0e}",
            f"{min(spurious):.0e}" if spurious else "",
        )  # fmt: skip
        words = ["", "", "", ""]


def iterations() -> Table:
    """From the null vector, beside those of QPSOL, which are of the first beam on a mesh that [SS92] half tells."""
    made = table(
        "iterations from the null vector; QPSOL's are those that [SS92] prints for its first problem alone",
        "body", "contact points", "QP1", "QP2", "QP3, local solver", "QP3, Clarabel",
    )  # fmt: skip
    for contact in (beam_on_its_own_shape(10), cylinder()):
        counts = [unpolished(contact, formulation).iterations for formulation in ("qp1", "qp2")]
        counts += [qp3_iterations(contact), unpolished(contact, "qp3").iterations]
        made.add_row(contact.name, str(contact.size), *map(str, counts))
    made.add_row("QPSOL, first problem", "?", *(str(QPSOL[name]) for name in ("qp1", "qp2", "qp3")), "")
    return made


def qp3_iterations(contact: CondensedContact) -> int:
    """(40)-(42) over (p, a) by the local solver."""
    scaled = scale(contact)
    M, R, ell, J = scaled.compliance, scaled.rigid_motions, scaled.equilibrium, scaled.weights
    n, k = R.shape
    weighted = J[:, None] * M
    found = minimize_qp(
        np.block([[weighted + weighted.T, ell], [ell.T, np.zeros((k, k))]]),
        np.append(J * scaled.offset, np.zeros(k)),
        A=np.block([[M, R], [ell.T, np.zeros((k, k))]]),
        cl=np.append(-scaled.offset, -scaled.motion_load),
        cu=np.append(np.full(n, np.inf), -scaled.motion_load),
        bl=np.append(np.zeros(n), np.full(k, -np.inf)),
    )
    return found.iterations


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    names = ["units", "starts", "sets", "iterations"]
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=", ".join(names), default=names)
    parser.add_argument("--nodes", nargs="*", type=int, default=[11, 21, 41, 81], help="contact points, for units")
    parser.add_argument("--limit", type=float, default=20, help="seconds for one unscaled program, for units")
    parser.add_argument("--starts", type=int, default=150, help="random starts of each body, for starts")
    parser.add_argument("--small", action="store_true", help="leave out the beams of 80 contact points, for starts")
    parser.add_argument("--sets-starts", type=int, default=200, help="random starts of each problem, for sets")
    parser.add_argument("--seeds", type=int, default=3, help="problems of each kind and size, for sets")
    parser.add_argument("--sizes", nargs="*", type=int, default=[3, 5, 8], help="contact points, for sets")
    given = parser.parse_args()
    if unknown := set(given.tables) - set(names):
        parser.error(f"no table {', '.join(sorted(unknown))}; take any of {', '.join(names)}")
    return given


def main() -> None:
    given = arguments()
    console = Console(width=220)
    made = {
        "units": lambda: units_and_stiffness(given.nodes, given.limit),
        "starts": lambda: random_starts(given.starts, given.small),
        "sets": lambda: all_contact_sets(given.sets_starts, given.seeds, given.sizes),
        "iterations": iterations,
    }
    for name in given.tables:
        console.print(made[name]())


if __name__ == "__main__":
    main()
