"""Condensation and whole solves over those of an earlier commit, in turns; numbers that must not have changed."""

import io
import json
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

import numpy as np
import speed_of_a_folder
from speed_cylinder import codes
from speed_page import Section, Settings, Table, Target
from timing import Turns, in_turns, ratio

ROOT = Path(__file__).parents[2]
EARLIER = "earlier"
UNKNOWNS = 152
"""Of the stated mesh. Cut into so many parts, it has as many times more."""
REFINE = (1, 4, 8, 16)
CONDENSATION = 0.55
SOLVE = {"NumPy": 0.5, "numba": 0.333}
"""Largest time over that of the earlier code that was asked for."""
ROUNDS = 8

TEXT = """\
The code of commit {commit} without numba, beside that of today. Each code has a process of its own, and they take
turns. The problems are those of the sections before, and read already; each code reads its own file of the model. A
problem that is used for the first time takes some milliseconds more, with either code. *Difference* is the largest one
of the compliances, or of the pressures for a whole solve, over the largest value.
"""


@contextmanager
def checked_out(commit: str) -> Iterator[Path]:
    """A folder with the package and the models of a commit of this repository."""
    command = ["git", "-C", str(ROOT), "archive", "--format=tar", commit, "bemcontact", "models"]
    packed = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
    with tempfile.TemporaryDirectory() as folder, tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        archive.extractall(folder, filter="data")
        yield Path(folder).resolve()


class Worker:
    """A process with the code of a folder."""

    def __init__(self, folder: Path, code: str) -> None:
        command = [sys.executable, speed_of_a_folder.__file__, str(folder), code]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8")
        self.spent = 0.0
        """Processor time [s] of all that it was asked for."""

    def __enter__(self) -> "Worker":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.communicate()

    def __call__(self, what: str, refine: int, into: Path | None = None) -> None:
        """Ask for something, and wait until it is done."""
        asked = {"what": what, "refine": refine, "into": into and str(into)}
        print(json.dumps(asked), file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(f"the code of {self.process.args[2]} cannot {what}")
        self.spent += float(line)


def compared(
    workers: dict[str, Worker], what: str, refine: int, rounds: int
) -> tuple[int, dict[str, Turns], dict[str, float]]:
    """Contact points, times, and differences from the first worker over the largest value."""
    values = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, worker in workers.items():
            worker(what, refine, into := Path(folder) / "values.npy")
            values[name] = np.load(into)
    first = values[EARLIER]
    apart = {name: float(abs(it - first).max() / abs(first).max()) for name, it in values.items()}
    actions = {name: partial(worker, what, refine) for name, worker in workers.items()}
    return len(first), in_turns(actions, rounds, lambda: sum(worker.spent for worker in workers.values())), apart


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all sizes."""
    rows, targets, raw, rounds = [], [], {}, 3 if settings.quick else ROUNDS
    with ExitStack() as stack:
        earlier = stack.enter_context(checked_out(settings.earlier))
        workers = {EARLIER: stack.enter_context(Worker(earlier, "NumPy"))}
        workers |= {code: stack.enter_context(Worker(ROOT, code)) for code in codes()}

        def add(what: str, refine: int, asked: dict[str, float]) -> None:
            """Add rows and targets for the codes that have one."""
            unknowns = UNKNOWNS * refine
            say(f"{what}, N = {unknowns}")
            mine = {name: worker for name, worker in workers.items() if name in (EARLIER, *asked)}
            points, times, apart = compared(mine, what, refine, rounds)
            raw[f"{what}, N = {unknowns}"] = {name: vars(its) for name, its in times.items()}
            for name, its in times.items():
                over = ratio(its.cpu, times[EARLIER].cpu)
                rows.append([f"`{what}`", unknowns, points, name, 1e3 * min(its.cpu), over, apart[name]])
            for code, largest in asked.items():
                over = ratio(times[code].cpu, times[EARLIER].cpu) if code in times else None
                name = f"`{what}` with {code} over commit {settings.earlier}, N = {unknowns}"
                targets.append(Target(name=name, asked=largest, measured=over))

        for refine in REFINE[: 2 if settings.quick else None]:
            add("condense", refine, {"NumPy": CONDENSATION})
        add("solve", 1, SOLVE)
    columns = {
        "": "", "N": "d", "n": "d", "Code": "", "CPU, ms": ".1f", "over earlier": ".2f", "Difference": ".0e"
    }  # fmt: skip
    text, table = TEXT.format(commit=settings.earlier), Table(columns=columns, rows=rows)
    return Section(title="Over an earlier commit", text=text, tables=[table], targets=targets, raw=raw)
