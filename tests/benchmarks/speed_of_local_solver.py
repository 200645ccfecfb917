"""The local solver beside the other solvers that are installed, on the same programs."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import product

from judgement import judge
from local_solver import COLUMNS, COMPILED, OURS, Trial, ratio, rows, series
from peers import PEERS, Peer, run
from qp_instance import Instance, contact_instances, half_plane, qp1, read_folder, status_instances
from speed_page import Section, Settings, Table, Target
from timing import Spread, in_turns
from timing import ratio as ratio_of_turns

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
Each solver starts from zero. Its result, from a process of its own, is judged from its point alone, as on the page
[Solvers](solvers.md). *numba* takes the iterations of programs of up to 250 variables by machine code.
Peers that are not installed: {absent}.

Times are those of a user who solves many programs in one process: in each round each solver takes all of them, one
after the other, each once. Packages and machine code are loaded already. Times are of whole calls, where the point
fulfills the first-order conditions. *Median* is over the programs. *our time / its* is the geometric mean over the
programs that both solved. The second table has a program in each row, which both solvers take in turns.
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


def large(
    peers: Sequence[Peer], sizes: Sequence[int], say: Callable[[str], None]
) -> tuple[Table, dict[int, Spread | None]]:
    """Times of QP1 of half-planes in turns, and our time over that of the peer."""
    table, ratios = [], {}
    for n in sizes:
        contact = half_plane(n, 1e3, seed=0)
        instance = qp1(contact, contact.stiffness_rows)
        say(f"QP1 with {n} contact points")
        trials = [trial for [trial] in tried(peers, [instance], LIMIT_OF_LARGE, lambda _: None)]
        solved = [peer for peer, trial in zip(peers, trials, strict=True) if trial.right]
        turns = in_turns({peer.name: partial(peer.solve, instance) for peer in solved})
        both = {OURS.name, PEER} <= turns.keys()
        ratios[n] = ratio_of_turns(turns[OURS.name].cpu, turns[PEER].cpu) if both else None
        cells = [
            f"{min(turns[peer.name].cpu):.3f}" if peer in solved else trial.answer.says
            for peer, trial in zip(peers, trials, strict=True)
        ]
        table.append([n, *cells, ratios[n]])
    columns = {"n": "d", **dict.fromkeys((peer.name for peer in peers), ""), f"our time / {PEER}": ".2f"}
    return Table(title="QP1 of a half-plane with n contact points, CPU s", columns=columns, rows=table), ratios


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
    say("times")
    times = series(peers, done, *([3] if settings.quick else []))
    columns = {"Solver": "", **dict.fromkeys(COLUMNS, ""), "median, ms": ".2f", "our time / its": ".2f"}
    summary = Table(
        title=f"{len(instances)} programs, at most {LIMIT:g} s each", columns=columns, rows=rows(peers, done, times)
    )
    second, ratios = large(
        [peer for peer in peers if peer.name in (OURS.name, PEER)], LARGE[: 1 if settings.quick else None], say
    )
    taken = {peer.name: its for peer, its in zip(peers, times, strict=True)}
    targets = [
        Target(
            name=f"{peer.name} over {PEER}, geometric mean",
            asked=MEAN,
            measured=ratio(taken[peer.name], taken[PEER]) if PEER in taken else None,
        )
        for peer in own
    ]
    targets += [
        Target(name=f"{OURS.name} over {PEER}, QP1 with {n} contact points", asked=asked, measured=ratios.get(n))
        for n, asked in LARGEST.items()
        if n in ratios
    ]
    text = TEXT.format(
        folder=", and the instances of a folder (`--instances`)" if folder else "", absent=", ".join(absent) or "none"
    )
    names = [instance.name for instance in instances]
    raw = {"programs": names, **{name: its.tolist() for name, its in taken.items()}}
    return Section(title="Local solver", text=text, tables=[summary, second], targets=targets, raw=raw)
