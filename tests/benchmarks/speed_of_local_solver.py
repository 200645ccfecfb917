"""The local solver beside the other solvers that are installed, on the same programs."""

import statistics
from collections.abc import Callable, Sequence
from functools import partial
from itertools import product

from judgement import judge
from local_solver import COLUMNS, COMPILED, OURS, Trial, count
from peers import PEERS, Peer, run
from qp_instance import Instance, contact_instances, half_plane, qp1, read_folder, status_instances
from speed_page import Section, Settings, Table, Target
from timing import geometric_mean, in_turns

LIMIT = 10.0
"""Seconds for one program."""
NODES, SEEDS = (11, 21, 41), 2
"""Contact points of the half-planes, and random ones of each kind."""
LARGE, LIMIT_OF_LARGE = (100, 200, 400, 800), 120.0
"""Contact points of QP1 of a half-plane, and seconds for one."""
PEER = "BQPD (Uno)"
"""The peer of the targets."""
MEAN, LARGEST = 2.0, {400: 3.0, 800: 3.0}
"""Time over that of the peer that was asked for: geometric mean, and of QP1 by contact points."""

TEXT = """\
QP1 and QP2 of random half-planes, raw and scaled, programs that have no minimizer{folder}.
Each solver starts from zero, in a process of its own, and runs up to five times. The time is the median CPU time of a
whole call. Each program is given to all solvers before the next one. Each result is judged from its point alone, as
on the page [Solvers](solvers.md). *our time / its* is the geometric mean over the programs that both solved to a
point that fulfills the first-order conditions. *numba* takes the iterations of programs of up to 250 variables by
machine code, which is loaded already. Peers that are not installed: {absent}.

A process that is forked pays for memory that it shares: each page is copied when it is first written to, and a program
in Python writes to more of them. *In one process* both run in turns, on the same programs, and each time is the least
of several, as elsewhere on this page: this is what one program of a series costs.
"""


def tried(
    peers: Sequence[Peer], instances: Sequence[Instance], limit: float, say: Callable[[str], None]
) -> list[list[Trial]]:
    """Trials of each peer, program by program."""
    done: list[list[Trial]] = [[] for _ in peers]
    for number, instance in enumerate(instances):
        if number % 25 == 0:
            say(f"program {number + 1} of {len(instances)}")
        for peer, trials in zip(peers, done, strict=True):
            answer = run(peer, instance, limit)
            trials.append(Trial(instance=instance, answer=answer, judgement=judge(instance, answer.x)))
    return done


def ratio(ours: Sequence[Trial], its: Sequence[Trial]) -> float | None:
    """Geometric mean of our times over those of a peer, where both came to a first-order point."""
    pairs = zip(ours, its, strict=True)
    return geometric_mean(a.answer.seconds / b.answer.seconds for a, b in pairs if a.first_order and b.first_order)


def in_one_process(ours: Peer, trials: Sequence[Trial], peer: Peer, its: Sequence[Trial]) -> float | None:
    """The same ratio where both run in turns in this process, and each time is the least of several."""
    ratios = []
    for a, b in zip(trials, its, strict=True):
        if a.first_order and b.first_order:
            times = in_turns({it.name: partial(it.solve, a.instance) for it in (ours, peer)})
            ratios.append(times[ours.name].cpu / times[peer.name].cpu)
    return geometric_mean(ratios)


def summary(peers: Sequence[Peer], done: Sequence[list[Trial]]) -> Table:
    """A row for each solver."""
    rows = []
    for peer, trials in zip(peers, done, strict=True):
        counts = [count(trials, measured, among) for measured, among in COLUMNS.values()]
        median = statistics.median(trial.answer.seconds for trial in trials)
        rows.append([peer.name, *counts, 1e3 * median, ratio(done[0], trials)])
    columns = {"Solver": "", **dict.fromkeys(COLUMNS, ""), "median, ms": ".2f", "our time / its": ".2f"}
    return Table(title=f"{len(done[0])} programs, at most {LIMIT:g} s each", columns=columns, rows=rows)


def large(
    peers: Sequence[Peer], sizes: Sequence[int], say: Callable[[str], None]
) -> tuple[Table, dict[int, float | None]]:
    """Times of QP1 of half-planes, and our time over that of the peer."""
    rows, ratios = [], {}
    for n in sizes:
        contact = half_plane(n, 1e3, seed=0)
        instance = qp1(contact, contact.stiffness_rows)
        say(f"QP1 with {n} contact points")
        done = tried(peers, [instance], LIMIT_OF_LARGE, lambda _: None)
        rows.append([n, *(f"{trial.answer.seconds:.3f}" if trial.right else trial.answer.says for [trial] in done)])
        ratios[n] = next(
            (ratio(done[0], its) for peer, its in zip(peers, done, strict=True) if peer.name == PEER), None
        )
        rows[-1].append(ratios[n])
    columns = {"n": "d", **dict.fromkeys((peer.name for peer in peers), ""), f"our time / {PEER}": ".2f"}
    return Table(title="QP1 of a half-plane with n contact points, CPU s", columns=columns, rows=rows), ratios


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all programs, those of the folder included."""
    folder = settings.instances
    instances = [*(read_folder(folder) if folder else ()), *status_instances()]
    instances += contact_instances(list(NODES[:1] if settings.quick else NODES), SEEDS)
    peers = [peer for peer in (OURS, COMPILED, *PEERS) if peer.installed]
    own = [peer for peer in peers if peer in (OURS, COMPILED)]
    for peer, instance in product(own, status_instances()):  # compiles
        peer.solve(instance)
    absent = [peer.name for peer in PEERS if not peer.installed]
    done = tried(peers, instances, LIMIT, say)
    second, ratios = large(
        [peer for peer in peers if peer.name in (OURS.name, PEER)], LARGE[: 1 if settings.quick else None], say
    )
    say("the same in one process")
    its = next((trials for peer, trials in zip(peers, done, strict=True) if peer.name == PEER), None)
    targets = []
    for ours, trials in zip(own, done, strict=False):
        means = {"": None, ", in one process": None}
        if its is not None:
            theirs = next(peer for peer in peers if peer.name == PEER)
            means = {"": ratio(trials, its), ", in one process": in_one_process(ours, trials, theirs, its)}
        targets += [
            Target(name=f"{ours.name} over {PEER}, geometric mean{how}", asked=MEAN, measured=measured)
            for how, measured in means.items()
        ]
    targets += [
        Target(name=f"{OURS.name} over {PEER}, QP1 with {n} contact points", asked=asked, measured=ratios.get(n))
        for n, asked in LARGEST.items()
        if n in ratios
    ]
    text = TEXT.format(
        folder=", and the instances of a folder (`--instances`)" if folder else "", absent=", ".join(absent) or "none"
    )
    raw = {
        peer.name: {trial.instance.name: trial.answer.seconds for trial in trials}
        for peer, trials in zip(peers, done, strict=True)
    }
    return Section(title="Local solver", text=text, tables=[summary(peers, done), second], targets=targets, raw=raw)
