"""The journal of a study: one line for each member that is done, so that a run that was killed can go on."""

import io
import json
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

from bemcontact.errors import ProblemError
from bemcontact.files.output import naming
from bemcontact.serialization import Leaf, json_text

JOURNAL = "members.jsonl"
"""Name of the journal in the folder of a study."""
FIRST = "bemcontact study"
"""What the first line of a journal says."""
SYNC = 0.5
"""Seconds after which rows are written down to the disk. To wait for it with each row can take longer than the row."""
_HEAD = f"{json_text({'journal': FIRST}, None)}\n".encode()


def is_journal(path: Path) -> bool:
    """Whether a file is the journal of a study, even one whose first line was not written to its end."""
    try:
        with path.open("rb") as file:
            first = file.readline(1000)
    except OSError:
        return False
    return first == _HEAD or (not first.endswith(b"\n") and _HEAD.startswith(first))


def recorded(path: Path) -> dict[str, Mapping[str, Any]]:
    """Rows in a journal by the key of the member; lines that were not written to their end are left out."""
    rows = dict[str, Mapping[str, Any]]()
    if not path.is_file():
        return rows
    with path.open("rb") as file:
        for line in file:
            try:
                entry = json.loads(line) if line.endswith(b"\n") else None
            except ValueError:
                continue
            if isinstance(entry, dict) and isinstance(entry.get("row"), dict):
                rows[entry["key"]] = entry["row"]
    return rows


def state_of(path: Path) -> tuple[int, int] | None:
    """Number and size of a file, which change if another run writes it or puts another one there; None without one."""
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_ino, found.st_size


@contextmanager
def alone(folder: Path, seen: tuple[int, int] | None) -> Iterator[None]:
    """Keep other runs out of a folder, which is made; the system lets them in when this run ends, however it ends.

    `ProblemError` if another run writes to the folder, or has written to its journal since that had the state `seen`.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not find_spec("fcntl"):  # Windows does without
        yield
        return
    with (folder / JOURNAL).open("ab") as file:
        _lock(file, folder)
        if state_of(folder / JOURNAL) != (seen or (os.fstat(file.fileno()).st_ino, 0)):
            raise ProblemError(f"another run has just written a study to {folder}; start again to go on from it")
        yield


class Journal:
    """A journal that is open for further rows.

    A row that was added outlives this process, however it ends. Where the machine ends, the rows of the last `SYNC`
    seconds may be lost, and a run that goes on solves them again.
    """

    def __init__(self, file: io.FileIO, path: Path) -> None:
        self._file, self._path, self._synced = file, path, time.monotonic()

    def add(self, key: str, row: Leaf) -> None:
        """Write the row of a member."""
        self.write(f"{json_text({'key': key, 'row': row.to_dict()}, None)}\n".encode())
        if time.monotonic() - self._synced >= SYNC:
            self.sync()

    def write(self, line: bytes) -> None:
        """Write a line to its end; errors, such as that of a full disk, name the file."""
        with naming(self._path):
            while line:
                line = line[self._file.write(line) :]

    def sync(self) -> None:
        """Wait until all rows are on the disk."""
        os.fsync(self._file.fileno())
        self._synced = time.monotonic()


@contextmanager
def opened(folder: Path) -> Iterator[Journal]:
    """Open the journal in a folder, which is made."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / JOURNAL
    with path.open("ab", buffering=0) as file:
        journal = Journal(file, path)
        if path.stat().st_size < len(_HEAD):  # a run was killed before its first line was written to its end
            file.truncate(0)
            journal.write(_HEAD)
        elif not _ends_with_line(path):
            journal.write(b"\n")
        try:
            yield journal
        finally:
            journal.sync()


def _ends_with_line(path: Path) -> bool:
    """Whether the last line of a file was written to its end."""
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1) == b"\n"


def _lock(file: IO[bytes], folder: Path) -> None:
    """Refuse a journal that another run has open; the system unlocks it when that run ends, however it ends."""
    fcntl = import_module("fcntl")
    try:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise ProblemError(
            f"another run writes a study to {folder}; wait for its end, or name another folder"
        ) from None
    except OSError:  # a file system without locks
        return
