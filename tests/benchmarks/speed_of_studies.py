"""Members of a study in a second, with one worker and with two."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from speed_cylinder import MODEL
from speed_page import Section, Settings, Table, Target
from timing import Spread, children_time, in_turns, ratio

MEMBERS, FEW = 1000, 40
WORKERS = (1, 2)
LONGEST, FASTER = 60.0, 1.8
"""Seconds for all members on two processors, and how many times faster two workers should be than one."""

TEXT = """\
The command `study` of the cylinder of the paper, whose load has so many values from 20 to 60 in equal steps. Each
member finds its own mesh. The command is timed with its start and the writing of its folder. A first study that is not
timed writes the byte code of the modules, as an installation does. Wall times say something only if nothing else runs
on the machine.
"""


def study(members: int, workers: int) -> None:
    """Run the command, with a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        vary = f"conditions.top.pressure=20:60:{members}"
        out = Path(folder) / "study"
        command = [sys.executable, "-m", "bemcontact", "study", str(MODEL), "--vary", vary, "--output", "peak"]
        with_byte_code = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        command += ["--workers", str(workers), "--out", str(out)]
        subprocess.run(command, check=True, capture_output=True, env=with_byte_code)


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure with each number of workers, in turns."""
    members = FEW if settings.quick else MEMBERS
    study(FEW, 1)
    say(f"{members} members")
    actions = {workers: partial(study, members, workers) for workers in WORKERS}
    times = in_turns(actions, 1 if settings.quick else 2, children_time)
    gains = {workers: ratio(times[1].wall, item.wall) for workers, item in times.items()}
    rows = [
        [n, members, min(item.wall), min(item.cpu), members / min(item.wall), gains[n]] for n, item in times.items()
    ]
    columns = {"Workers": "d", "Members": "d", "wall, s": ".1f", "CPU, s": ".1f", "members in a second": ".1f",
               "times as fast as one": ".2f"}  # fmt: skip
    wall = Spread.of(times[2].wall)
    targets = [
        Target(name=f"study of {members} members, two workers, wall", asked=LONGEST, measured=wall, unit="s"),
        Target(name="study: times as fast with two workers", asked=FASTER, at_least=True, measured=gains[2]),
    ]
    enough = (os.cpu_count() or 1) >= 2 and not settings.quick
    raw = {str(workers): vars(item) for workers, item in times.items()}
    return Section(
        title="Studies",
        text=TEXT,
        tables=[Table(columns=columns, rows=rows)],
        targets=targets if enough else [],
        raw=raw,
    )
