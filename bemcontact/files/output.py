"""Files and folders that appear whole or not at all."""

import ctypes
import errno
import glob
import os
import secrets
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

EXCHANGES = {"linux": ("renameat2", 2), "darwin": ("renameatx_np", 2)}
"""System -> its call that exchanges two names at once, and the flag that asks for it."""
HERE = {"linux": -100, "darwin": -2}
"""System -> the descriptor that means the working directory (AT_FDCWD)."""
ABANDONED = 3600.0
"""Age in seconds of a temporary folder from which on nobody is writing it any more."""


def _beside(target: Path) -> Path:
    """Return a name beside the target that nobody else uses."""
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")


def ensure_writable(path: Path) -> None:
    """Find out, before any work is done, whether `whole_file` will be able to write here.

    Parameters
    ----------
    path : where the file is to appear

    Raises
    ------
    OSError
        With a sentence that says why not: a directory, a device, no such folder, no permission.
    """
    target = path.resolve()
    if target.is_dir():
        raise IsADirectoryError(f"{path} is a directory; name a file in it")
    if target.exists() and not target.is_file():
        raise OSError(f"{path} is not an ordinary file; name one that can be replaced")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no directory {target.parent}; make it first")
    probe = _beside(target)
    try:
        probe.touch(exist_ok=False)
        probe.unlink()
    except OSError as error:
        raise OSError(f"{path} cannot be written: {error.strerror}") from error


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary path to write to, and put it in the place of `path` when the block ends without an error.

    Parameters
    ----------
    path : where the file is to appear; a link is followed

    Yields
    ------
    Path
        In the same directory, so that the last step is one rename; removed if the block fails.
    """
    target = path.resolve()
    temporary = _beside(target)
    try:
        yield temporary
        os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)


def ensure_folder_place(path: Path) -> None:
    """Find out, before any work is done, whether `whole_folder` will be able to write here; contents are not looked at.

    Parameters
    ----------
    path : where the folder is to appear, or is

    Raises
    ------
    OSError
        With a sentence that says why not: a file, a mount point, no such parent, no permission.
    """
    target = path.resolve()
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"{path} is a file; name a folder")
    if target.is_mount():
        raise OSError(f"{path} is where a file system is mounted, and cannot be replaced; name a folder in it")
    if target in (here := Path.cwd(), *here.parents):
        raise OSError(f"{path} is the current directory or one above it, and cannot be replaced; name a folder in it")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no directory {target.parent}; make it first")
    probe = _beside(target)
    try:
        probe.mkdir()
        probe.rmdir()
        if target.is_dir():
            probe = _beside(target / "within")
            probe.mkdir()
            probe.rmdir()
    except OSError as error:
        raise OSError(f"{path} cannot be written: {error.strerror}") from error


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Give a temporary folder to write to, and put it in the place of `path` when the block ends without an error.

    A run that is killed leaves the whole old folder or the whole new one under the name. What it may leave beside is a
    hidden folder, ``.NAME.xxxxxxxx.part``, which a run removes that begins an hour later.

    Parameters
    ----------
    path : where the folder is to appear; a link is followed. What a folder of this name holds is lost

    Yields
    ------
    Path
        An empty folder in the same directory; removed if the block fails.

    Notes
    -----
    A new name is one rename. A folder that exists is exchanged with the new one by one call of the system (renameat2 of
    Linux, renameatx_np of macOS) and then removed. Where there is no such call, or the file system refuses it, the old
    folder is put aside as ``.NAME.xxxxxxxx.old`` and the new one renamed: killed between these two, neither has the
    name, but both are whole.
    """
    target = path.resolve()
    _remove_abandoned(target)
    temporary = _beside(target)
    temporary.mkdir()
    try:
        yield temporary
        _flush(temporary)
        _put(temporary, target)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _put(new: Path, target: Path) -> None:
    """Give a folder the name of another, which loses it; the other is left under the first name, or removed."""
    if not target.exists():
        os.rename(new, target)
        _flush_directory(target.parent)
        return
    shutil.copymode(target, new)
    if not _exchanged(new, target):
        aside = new.with_suffix(".old")
        os.rename(target, aside)
        try:
            os.rename(new, target)
        except OSError:
            os.rename(aside, target)
            raise
        shutil.rmtree(aside, ignore_errors=True)
    _flush_directory(target.parent)


def _exchanged(one: Path, other: Path) -> bool:
    """Exchange two names at once; tell whether system and file system can."""
    if sys.platform not in EXCHANGES:
        return False
    name, flag = EXCHANGES[sys.platform]
    call = getattr(ctypes.CDLL(None, use_errno=True), name, None)
    if call is None:
        return False
    here = HERE[sys.platform]
    if call(here, os.fsencode(one), here, os.fsencode(other), ctypes.c_uint(flag)) == 0:
        return True
    number = ctypes.get_errno()
    if number in (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP):
        return False
    raise OSError(number, os.strerror(number), str(other))


def _remove_abandoned(target: Path) -> None:
    """Remove the temporary folders of runs that were killed long ago."""
    for folder in target.parent.glob(f".{glob.escape(target.name)}.????????.part"):
        with suppress(OSError):  # another run may just have removed it
            if time.time() - folder.stat().st_mtime > ABANDONED:
                shutil.rmtree(folder, ignore_errors=True)


def _flush(folder: Path) -> None:
    """Have all files and folders in a folder on the disk before it gets its name."""
    for place, _, names in os.walk(folder):
        for name in names:
            with open(os.path.join(place, name), "rb+") as file:
                os.fsync(file.fileno())
        _flush_directory(Path(place))


def _flush_directory(folder: Path) -> None:
    """Have the names in a folder on the disk, where a system lets folders be opened."""
    if os.name == "posix":
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
