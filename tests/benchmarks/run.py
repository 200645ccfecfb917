"""Run all benchmarks of speed and write one page, as Markdown and as JSON.

    python tests/benchmarks/run.py [--only SECTION ...] [--quick] [--out FOLDER] [--instances FOLDER]
                                  [--earlier COMMIT]

Each section runs in a process of its own. If one fails or is interrupted, the page says so and has the others. With
`--only`, the other sections are kept from the run before in the same folder, if machine and versions are the same.
"""

import argparse
import importlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from datetime import date
from pathlib import Path

from machine import described, load
from pydantic import ValidationError
from speed_page import RUN, SECTION, Outcome, Run, Settings, markdown

SECTIONS = {
    "condensation": "speed_of_condensation",
    "threads": "speed_on_threads",
    "solve": "speed_of_solve",
    "earlier": "speed_over_earlier",
    "formulations": "speed_of_formulations",
    "paths": "speed_of_paths",
    "finite_elements": "speed_of_finite_elements",
    "local_solver": "speed_of_local_solver",
    "start_up": "speed_of_start_up",
    "studies": "speed_of_studies",
}
"""Module of each section by name; its function `measure(settings, say)` returns a `Section`."""
LIMIT = 1200
"""Seconds after which a section is ended."""
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
FREE = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")
"""Settings of BLAS that are taken away, so that all machines choose by themselves."""


def measured(name: str, into: Path, settings: Settings) -> None:
    """Measure a section in this process, and write it."""

    def say(words: str) -> None:
        print(f"  {name}: {words}", flush=True)

    section = importlib.import_module(SECTIONS[name]).measure(settings, say)
    into.write_bytes(SECTION.dump_json(section))


def outcome(command: list[str], into: Path, limit: float = LIMIT) -> Outcome:
    """Run a command that writes a section into a file; how it ended."""
    begin = time.perf_counter()
    with tempfile.TemporaryFile("w+", encoding="utf-8") as errors:
        failed = _ended(command, errors, limit)
        if failed is None and into.is_file():
            done = Outcome(seconds=0, section=SECTION.validate_json(into.read_bytes()))
        else:
            errors.seek(0)
            words = [failed or "no section was written", *errors.read().strip().splitlines()[-12:]]
            done = Outcome(seconds=0, failed="\n".join(words))
    return replace(done, seconds=time.perf_counter() - begin)


def _ended(command: list[str], errors: object, limit: float) -> str | None:
    """Why a command did not end well; None if it did."""
    with subprocess.Popen(command, stderr=errors, env=environment(), start_new_session=True) as process:
        try:
            status = process.wait(limit)
        except subprocess.TimeoutExpired:
            _end(process)
            return f"ended after the limit of {limit:g} s"
        except KeyboardInterrupt:
            _end(process)
            return INTERRUPTED
    return f"ended with exit status {status}" if status else None


INTERRUPTED = "interrupted"


def _end(process: subprocess.Popen) -> None:
    """End a process and those that it started."""
    if hasattr(os, "killpg"):
        os.killpg(process.pid, signal.SIGKILL)
    process.kill()


def environment() -> dict[str, str]:
    """The environment of a section: one thread, and the settings of BLAS as the machine chooses them."""
    kept = {name: value for name, value in os.environ.items() if name not in FREE}
    return {**kept, **dict.fromkeys(ONE_THREAD, "1")}


def before(file: Path, run: Run) -> Mapping[str, Outcome]:
    """Sections of an earlier run in the same folder, if it was one of the same kind; else its page is put aside."""
    if not file.is_file():
        return {}
    with suppress(ValidationError):  # from another version of this benchmark
        earlier = RUN.validate_json(file.read_bytes())
        if (earlier.machine, earlier.quick) == (run.machine, run.quick):
            return earlier.outcomes
    for old in (file, file.with_suffix(".md")):
        with suppress(FileNotFoundError):
            old.replace(old.with_stem(f"{old.stem}_before"))
    print("the page in this folder is from another machine, version or setting; it is now speed_before.md")
    return {}


def write(folder: Path, run: Run) -> None:
    """Write the page; sections are in the order of `SECTIONS`."""
    order = [name for name in SECTIONS if name in run.outcomes]
    run = replace(run, outcomes={name: run.outcomes[name] for name in order})
    (folder / "speed.md").write_text(markdown(run), encoding="utf-8")
    (folder / "speed.json").write_bytes(RUN.dump_json(run, indent=1))


def run_all(names: list[str], folder: Path, settings: Settings) -> Run:
    """Run sections, and write the page after each of them."""
    folder.mkdir(parents=True, exist_ok=True)
    today, machine = date.today().isoformat(), described()
    run = Run(date=today, load=load(), quick=settings.quick, machine=machine, names=[*SECTIONS], outcomes={})
    run = replace(run, outcomes=before(folder / "speed.json", run))
    for number, name in enumerate(names, 1):
        print(f"[{number}/{len(names)}] {name}", flush=True)
        into = folder / f"{name}.json.new"
        command = [sys.executable, __file__, "--only", name, "--into", str(into), *arguments_of(settings)]
        with removed(into):
            done = outcome(command, into)
        run = replace(run, outcomes={**run.outcomes, name: done})
        write(folder, run)
        print(f"  {done.seconds:.0f} s" + (f", FAILED: {done.failed}" if done.failed else ""), flush=True)
        if done.failed.startswith(INTERRUPTED):
            break
    return run


def arguments_of(settings: Settings) -> list[str]:
    """The settings for the command line."""
    folder = ["--instances", str(settings.instances)] if settings.instances else []
    return [*(["--quick"] if settings.quick else []), *folder, "--earlier", settings.earlier]


@contextmanager
def removed(file: Path) -> Iterator[None]:
    """Remove a file at the end."""
    try:
        yield
    finally:
        file.unlink(missing_ok=True)


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--only", nargs="+", choices=SECTIONS, default=[*SECTIONS], metavar="SECTION",
        help=f"of {', '.join(SECTIONS)}; all by default",
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="fewer and smaller problems, in about three minutes")
    default = Path(tempfile.gettempdir()) / "bemcontact-speed"
    parser.add_argument(
        "--out", type=Path, default=default, metavar="FOLDER", help="of the page, %(default)s by default"
    )
    parser.add_argument("--instances", type=Path, metavar="FOLDER", help="quadratic programs (.npz) for local_solver")
    parser.add_argument(
        "--earlier", default=Settings.earlier, metavar="COMMIT",
        help="for the section of this name, by default %(default)s"
    )  # fmt: skip
    parser.add_argument("--into", type=Path, help=argparse.SUPPRESS)  # one section, in this process
    return parser.parse_args()


def main() -> int:
    given = arguments()
    settings = Settings(quick=given.quick, instances=given.instances, earlier=given.earlier)
    if given.into:
        measured(given.only[0], given.into, settings)
        return 0
    run = run_all(given.only, given.out, settings)
    print(f"written: {given.out / 'speed.md'} and {given.out / 'speed.json'}")
    return 1 if run.failed else 0


if __name__ == "__main__":
    sys.exit(main())
