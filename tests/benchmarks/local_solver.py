"""The local solver beside its peers on the same quadratic programs, and its time per iteration as they grow.

    python tests/benchmarks/local_solver.py [FOLDER] [--limit SECONDS] [--only NAME ...] [--nodes N ...] [--sizes N ...]

FOLDER holds instances as .npz files. QP1 and QP2 of random half-planes, raw and scaled, and programs without a
minimizer, are added to them. Every solver starts at the null vector; every point is judged from x.
Set OPENBLAS_NUM_THREADS=1.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from judgement import FIRST_ORDER, SECOND_ORDER, Judgement, judge
from peers import PEERS, Answer, Claim, Peer, run, silenced
from qp_instance import Instance, contact_instances, half_plane, qp1, qp2, read_folder, status_instances
from rich.console import Console
from rich.table import Table
from scipy.linalg import qr
from timing import Spread, best_of

from bemcontact.formulations.local_solver.minimize import minimize_qp
from bemcontact.formulations.local_solver.result import QPOptions, QPResult, QPStatus

RIGHT = 1e-6
"""Largest error of u_n and of p, each over its own largest entry, of a contact solution that is right."""
WRONG = 1e-3
"""The same, of one that is false if its solver calls it optimal."""
ROUNDS = 15
"""Times that each solver takes all programs, to be timed."""
LONG = 20.0
"""Seconds after which a solver takes them no more."""

CLAIMS = {
    QPStatus.LOCAL_MINIMIZER: Claim.OPTIMAL,
    QPStatus.INFEASIBLE: Claim.INFEASIBLE,
    QPStatus.UNBOUNDED: Claim.UNBOUNDED,
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial:
    """One solver on one instance."""

    instance: Instance
    answer: Answer
    judgement: Judgement

    @property
    def first_order(self) -> bool:
        return self.judgement.verdict in FIRST_ORDER

    @property
    def second_order(self) -> bool:
        return self.judgement.verdict in SECOND_ORDER

    @property
    def false_claim(self) -> bool:
        """Optimal where x is no local minimizer, or far from the only one; infeasible or unbounded where it is not."""
        claim, expected = self.answer.claim, self.instance.expected
        if claim is Claim.NOTHING:
            return False
        return claim.value != expected or self.falsely_optimal or (claim is Claim.OPTIMAL and not self.second_order)

    @property
    def named_right(self) -> bool:
        return self.answer.claim.value == self.instance.expected

    @property
    def right(self) -> bool:
        return self.judgement.error <= RIGHT

    @property
    def falsely_optimal(self) -> bool:
        """Called optimal, though far from the only right answer: stationary to the judge's tolerance or not."""
        return self.answer.claim is Claim.OPTIMAL and bool(self.instance.truth) and not self.judgement.error <= WRONG


def solve_locally(instance: Instance, *, by_numba: bool = False) -> QPResult:
    """Call ours with its defaults from the null vector."""
    options, bounds = QPOptions(by_numba=by_numba), (instance.cl, instance.cu, instance.bl, instance.bu)
    return minimize_qp(instance.H, instance.c, instance.A, *bounds, options=options)


def ours(instance: Instance, *, by_numba: bool = False) -> Answer:
    result = solve_locally(instance, by_numba=by_numba)
    return Answer(x=result.x, claim=CLAIMS.get(result.status, Claim.NOTHING), says=result.status.value)


OURS = Peer(name="bemcontact", package="bemcontact", solve=ours)
COMPILED = Peer(name="bemcontact (numba)", package="numba", solve=partial(ours, by_numba=True))


def trials(peer: Peer, instances: list[Instance], limit: float) -> list[Trial]:
    return [
        Trial(instance=instance, answer=(answer := run(peer, instance, limit)), judgement=judge(instance, answer.x))
        for instance in instances
    ]


def count(done: list[Trial], measure: Callable[[Trial], bool], counts: Callable[[Trial], bool]) -> str:
    """How many of those that count have the property, as "7/9"."""
    among = [trial for trial in done if counts(trial)]
    return f"{sum(map(measure, among))}/{len(among)}" if among else ""


def of_group(*groups: str) -> Callable[[Trial], bool]:
    return lambda trial: trial.instance.group in groups


def nonconvex(trial: Trial) -> bool:
    return trial.instance.group not in ("convex", "degenerate", "status", "contact", "scaled contact")


def known(trial: Trial) -> bool:
    return nonconvex(trial) and np.isfinite(trial.instance.best)


COLUMNS: dict[str, tuple[Callable[[Trial], bool], Callable[[Trial], bool]]] = {
    "KKT": (lambda trial: trial.first_order, nonconvex),
    "second order": (lambda trial: trial.second_order, nonconvex),
    "global": (lambda trial: trial.judgement.is_global, known),
    "convex": (lambda trial: trial.judgement.is_global, of_group("convex")),
    "degenerate": (lambda trial: trial.judgement.is_global, of_group("degenerate")),
    "status": (lambda trial: trial.named_right, of_group("status")),
    "contact right": (lambda trial: trial.right, of_group("contact")),
    "contact falsely optimal": (lambda trial: trial.falsely_optimal, of_group("contact")),
    "scaled contact right": (lambda trial: trial.right, of_group("scaled contact")),
    "false claims": (lambda trial: trial.false_claim, lambda trial: True),
}
"""Heading -> (what is counted, among which trials)."""


def series(peers: Sequence[Peer], done: Sequence[Sequence[Trial]], rounds: int = ROUNDS) -> list[np.ndarray]:
    """CPU seconds (rounds, programs) of each solver, NaN where its trial came to no first-order point.

    In each round each solver takes all programs once, one after the other, in this process, as a user has them who
    solves many: what it needs is loaded, and caches have its program before. Where ours and BQPD take each program in
    turns, the ratio is 5 to 9 % smaller, for each empties the caches of the other.
    """
    times: list[list[list[float]]] = [[] for _ in peers]
    with silenced():
        for peer, trials in zip(peers, done, strict=True):
            for trial in [trial for trial in trials if trial.first_order][:1]:
                peer.solve(trial.instance)  # loads what it needs
        for _ in range(rounds):
            for peer, trials, taken in zip(peers, done, times, strict=True):
                if np.nansum(taken) < LONG:
                    taken.append([seconds(peer, trial.instance) if trial.first_order else np.nan for trial in trials])
    return [np.array(taken) for taken in times]


def seconds(peer: Peer, instance: Instance) -> float:
    """CPU time of one whole call, its input converted and its output read."""
    begin = time.process_time()
    peer.solve(instance)
    return time.process_time() - begin


def ratio(ours_taken: np.ndarray, taken: np.ndarray) -> Spread | None:
    """Of the geometric means of our times over those of a solver in the same round, where both have times."""
    rounds = min(len(ours_taken), len(taken))
    ratios = ours_taken[:rounds] / taken[:rounds]
    both = ~np.isnan(ratios[0])
    return Spread.of(np.exp(np.log(ratios[:, both]).mean(axis=1)).tolist()) if both.any() else None


def typical(taken: np.ndarray) -> float:
    """Median over programs of the least time of each; NaN if there are none."""
    least = taken.min(axis=0)
    return float(np.nanmedian(least)) if not np.isnan(least).all() else np.nan


def comparison(peers: list[Peer], instances: list[Instance], limit: float) -> tuple[Table, list[list[Trial]]]:
    """The table, a row for each solver, and the trials of each that is installed; ours is the first."""
    table = Table(title=f"{len(instances)} programs from x = 0, at most {limit:g} s each; judged from x")
    for heading in ("solver", *COLUMNS, "median ms", "our time / its"):
        table.add_column(heading, justify="left" if heading == "solver" else "right")
    installed = [peer for peer in (OURS, COMPILED, *peers) if peer.installed]
    all_done = [trials(peer, instances, limit) for peer in installed]
    for peer, *row in rows(installed, all_done, series(installed, all_done)):
        table.add_row(peer, *(cell if isinstance(cell, str) else f"{cell:.2f}" for cell in row))
    for peer in peers:
        if not peer.installed:
            table.add_row(peer.name, "absent")
    return table, all_done


def rows(
    peers: Sequence[Peer], done: Sequence[list[Trial]], times: Sequence[np.ndarray]
) -> list[list[str | float | Spread]]:
    """A row for each solver: counts, median time [ms], and our time over its."""
    return [
        [
            peer.name,
            *(count(trials, measured, among) for measured, among in COLUMNS.values()),
            1e3 * typical(taken),
            ratio(times[0], taken) or "",
        ]
        for peer, trials, taken in zip(peers, done, times, strict=True)
    ]


def shortfalls(done: list[Trial]) -> list[str]:
    """A line for each program on which a solver made a false claim, found no answer, or a contact that is not right."""
    return [
        f"{trial.instance.group:14s} {trial.instance.name:28s} {trial.judgement.verdict.value:40s}"
        f" error {trial.judgement.error:8.1e}  says: {trial.answer.says}"
        for trial in done
        if trial.false_claim or not (trial.named_right and (trial.right or not trial.instance.truth))
    ]


def growth(sizes: list[int]) -> Table:
    """Time per iteration on QP1 and QP2 of n contact nodes, over matrix operations with as many rows as unknowns."""
    table = Table(title="time per iteration; matrix operations of order 2n, the number of unknowns")
    for heading in ("program", "unknowns", "iterations", "seconds", "ms each", "/GEMV", "/GEMM", "/QR", "order in n"):
        table.add_column(heading, justify="left" if heading == "program" else "right")
    for statement in (qp1, qp2):
        before: tuple[int, float] | None = None
        for n in sizes:
            contact = half_plane(n, 1e3, seed=0)
            instance = statement(contact, contact.stiffness_rows)
            before = _add_growth(table, instance, before)
    return table


def _add_growth(table: Table, instance: Instance, before: tuple[int, float] | None) -> tuple[int, float]:
    """A row of the table, with the order seen since the row before."""
    begin = time.perf_counter()
    result = solve_locally(instance)
    seconds = time.perf_counter() - begin
    each = seconds / max(1, result.iterations)
    matrix = np.random.default_rng(0).standard_normal(instance.H.shape)
    operations = (lambda: matrix @ matrix[0], lambda: matrix @ matrix, lambda: qr(matrix))
    ratios = [f"{each / best_of(operation):.3g}" for operation in operations]
    order = f"{np.log(each / before[1]) / np.log(len(matrix) / before[0]):.2f}" if before else ""
    table.add_row(
        instance.name, str(len(matrix)), str(result.iterations), f"{seconds:.3f}", f"{1e3 * each:.3f}", *ratios, order
    )
    return len(matrix), each


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    names = [peer.name for peer in PEERS]
    parser.add_argument("folder", nargs="?", type=Path, help="instances as .npz files")
    parser.add_argument("--limit", type=float, default=10, help="seconds for one program")
    parser.add_argument("--only", nargs="*", default=names, choices=names, help="peers to run beside ours")
    parser.add_argument("--nodes", nargs="*", type=int, default=[11, 21, 41], help="contact nodes of the half-planes")
    parser.add_argument("--seeds", type=int, default=2, help="random half-planes of each kind")
    parser.add_argument("--sizes", nargs="*", type=int, default=[50, 100, 200], help="contact nodes for the growth")
    parser.add_argument("--details", action="store_true", help="name the programs on which a solver fell short")
    return parser.parse_args()


def main() -> None:
    given = arguments()
    console = Console(width=220)
    instances = list(read_folder(given.folder)) if given.folder else []
    instances += [*status_instances(), *contact_instances(given.nodes, given.seeds)]
    peers = [peer for peer in PEERS if peer.name in given.only]
    table, all_done = comparison(peers, instances, given.limit)
    console.print(table)
    if given.details:
        for name, done in zip((peer for peer in (OURS, COMPILED, *peers) if peer.installed), all_done, strict=True):
            console.print(f"[bold]{name.name}[/bold]", *shortfalls(done), sep="\n")
    console.print(growth(given.sizes))


if __name__ == "__main__":
    main()
