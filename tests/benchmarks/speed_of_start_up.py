"""Start of the commands against the import of the packages that all of them need."""

import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

from speed_cylinder import MESH, MODEL
from speed_page import Section, Settings, Table, Target
from timing import children_time, in_turns, ratio

import bemcontact

BASE = "numpy, scipy.linalg, pydantic, yaml"
LARGEST = {"check": 1.7, "solve": 2.2, "--help": 0.7}
"""CPU time over that of the base that was asked for."""
ROUNDS = 8
MODELS = sorted(Path(bemcontact.__file__).parents[1].glob("models/**/*.yaml"))
TEXT = f"""\
CPU time of whole processes. The base is `python -c "import {BASE}"`. `check` and `solve` read the
cylinder of the paper, and `solve` finds a mesh for it. *stated mesh* solves the variant of this name. The targets
are for these. The second table has shipped models: there most of `solve` is the work on larger problems.
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


def run(arguments: list[str]) -> None:
    """Run Python."""
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True)


def measure(settings: Settings, say: Callable[[str], None]) -> Section:
    """Measure all commands."""
    say("the cylinder")
    actions = {name: partial(run, arguments) for name, arguments in commands().items()}
    for action in actions.values():
        action()  # reads files and compiles
    times = in_turns(actions, 3 if settings.quick else ROUNDS, children_time)
    over = {name: ratio(item.cpu, times["base"].cpu) for name, item in times.items()}
    rows = [[name, min(item.cpu), min(item.wall), over[name]] for name, item in times.items()]
    table = Table(columns={"Command": "", "CPU, s": ".2f", "wall, s": ".2f", "over base": ".2f"}, rows=rows)
    models = {}
    for model in MODELS[:2] if settings.quick else MODELS:
        say(model.stem)
        of_it = {name: partial(run, ["-m", "bemcontact", name, str(model)]) for name in ("check", "solve")}
        turns = in_turns({"base": actions["base"], **of_it}, 1 if settings.quick else 3, children_time)
        models[model.stem] = {name: item.cpu for name, item in turns.items()}
    columns = {"Model": "", "check over base": ".2f", "solve over base": ".2f"}
    ratios = [
        [name, *(ratio(it[command], it["base"]) for command in ("check", "solve"))] for name, it in models.items()
    ]
    of_models = Table(columns=columns, rows=ratios)
    targets = [
        Target(name=f"`{name}` over the base of imports", asked=asked, measured=over[name])
        for name, asked in LARGEST.items()
    ]
    raw = {name: vars(item) for name, item in times.items()} | {"models": models}
    return Section(title="Start", text=TEXT, tables=[table, of_models], targets=targets, raw=raw)
