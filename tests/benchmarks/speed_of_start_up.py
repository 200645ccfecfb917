"""Start of the commands against the import of the packages that all of them need."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from children import children_seconds
from speed_cylinder import MESH, MODEL
from speed_page import Section, Settings, Table, Target
from timing import least

import bemcontact

BASE = "numpy, scipy.linalg, pydantic, yaml"
LARGEST = {"check": 1.7, "solve": 2.2, "--help": 0.7}
"""CPU time over that of the base that was asked for."""
MODELS = sorted(Path(bemcontact.__file__).parents[1].glob("models/**/*.yaml"))
RUNS = 3
"""Runs of each command on each model."""
WORK = 10
"""CPU time of a first run, over that of the base, from which a command works more than it starts: it runs once."""

TEXT = f"""\
CPU time of whole processes, in turns. The base is `python -c "import {BASE}"`. `check` and `solve` read the
cylinder of the paper, and `solve` finds a mesh for it. *stated mesh* solves the variant of this name. The targets
are for these. The second table has all shipped models: there most of `solve` is the work on larger problems.
"""


def commands() -> dict[str, list[str]]:
    """Arguments of Python by name."""
    program, model = ["-m", "bemcontact"], str(MODEL)
    return {
        "base": ["-c", f"import {BASE}"],
        "--help": [*program, "--help"],
        "check": [*program, "check", model],
        "solve": [*program, "solve", model],
        "solve, stated mesh": [*program, "solve", model, "--variant", MESH],
        "solve, QP3": [*program, "solve", model, "--formulation", "qp3"],
    }


def over_base(model: Path, command: str, base: float) -> float:
    """CPU time of a command on a model over that of the base, the least of some runs."""
    arguments = ["-m", "bemcontact", command, str(model)]
    runs = [children_seconds(lambda: run(arguments))]
    while len(runs) < RUNS and runs[0].cpu < WORK * base:
        runs.append(children_seconds(lambda: run(arguments)))
    return least(runs).cpu / base


def run(arguments: list[str]) -> None:
    """Run Python."""
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True)


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all commands."""
    taken: dict[str, list] = {name: [] for name in commands()}
    for number in range(2 if settings.quick else 8):
        say(f"round {number + 1}")
        for name, arguments in commands().items():
            taken[name].append(children_seconds(lambda arguments=arguments: run(arguments)))
    times = {name: least(runs[1:]) for name, runs in taken.items()}  # the first run reads files and compiles
    base = times["base"].cpu
    rows = [[name, item.cpu, item.wall, item.cpu / base] for name, item in times.items()]
    table = Table(columns={"Command": "", "CPU, s": ".2f", "wall, s": ".2f", "over base": ".2f"}, rows=rows)
    models = {}
    for model in MODELS[:2] if settings.quick else MODELS:
        say(model.stem)
        models[model.stem] = [over_base(model, command, base) for command in ("check", "solve")]
    columns = {"Model": "", "check over base": ".2f", "solve over base": ".2f"}
    of_models = Table(columns=columns, rows=[[name, *ratios] for name, ratios in models.items()])
    targets = [
        Target(name=f"`{name}` over the base of imports", asked=asked, measured=times[name].cpu / base)
        for name, asked in LARGEST.items()
    ]
    raw = {name: [vars(run) for run in runs] for name, runs in taken.items()} | {"models": models}
    return Section(title="Start", text=TEXT, tables=[table, of_models], targets=targets, raw=raw)
