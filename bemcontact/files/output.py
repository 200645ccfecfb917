"""Writing of files and folders that are complete, or do not appear at all."""

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
"""System -> its call that exchanges two names, and the flag for the exchange."""
HERE = {"linux": -100, "darwin": -2}
"""System -> descriptor of the working directory (AT_FDCWD)."""
ABANDONED = 3600.0
"""Age in seconds above which a temporary file or folder is no longer in use."""


def _beside(target: Path) -> Path:
    """Unused path in the folder of the target."""
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")


def real(path: Path) -> Path:
    """Path without links; `OSError` if links lead back to themselves."""
    target = Path(os.path.realpath(path))
    if target.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return target


@contextmanager
def naming(path: Path, temporary: Path | None = None) -> Iterator[None]:
    """Let errors of writing name the path, not the temporary one or none."""
    try:
        yield
    except OSError as error:
        there = str(temporary or path)
        if error.errno is None or not str(error.filename or there).startswith(there):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error


def ensure_writable(path: Path) -> None:
    """Raise `OSError` with the reason if `whole_file` cannot write this file."""
    target = real(path)
    _ensure_replaceable(path, target)
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no directory {target.parent}; make it first")
    probe = _beside(target)
    try:
        probe.touch(exist_ok=False)
        probe.unlink()
    except OSError as error:
        raise OSError(f"{path} cannot be written: {error.strerror}") from error


def _ensure_replaceable(path: Path, target: Path) -> None:
    """Raise `OSError` for a directory, a device or a pipe, which a file must not replace."""
    if target.is_dir():
        raise IsADirectoryError(f"{path} is a directory; name a file in it")
    if target.exists() and not target.is_file():
        raise OSError(f"{path} is not a regular file; name a regular or a new file")


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Yield a temporary path that replaces `path` when the block ends without an error; links are followed.

    The temporary file is in the same directory, so that the replacement is one rename; it is removed on a failure. If
    the run is killed, a hidden file ``.NAME.xxxxxxxx.part`` may remain; a run that starts an hour later removes it.
    """
    target = real(path)
    _ensure_replaceable(path, target)
    _remove_abandoned(target)
    temporary = _beside(target)
    try:
        with naming(path, temporary):
            yield temporary
            os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)


def ensure_folder_place(path: Path) -> None:
    """Raise `OSError` with the reason if `whole_folder` cannot write this folder; its contents are not checked.

    Missing folders above it are made, and removed again.
    """
    target = real(path)
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"{path} is a file; name a folder")
    if target.is_mount():
        raise OSError(f"{path} is a mount point and cannot be replaced; name a folder in it")
    if target in (here := Path.cwd(), *here.parents):
        raise OSError(f"{path} is the current directory or contains it, and cannot be replaced; name a folder in it")
    above = next(folder for folder in target.parents if folder.exists())
    if not above.is_dir():
        raise NotADirectoryError(f"{path}: {above} is a file, and can hold no folder; name another place")
    try:
        with _parents(target):
            (probe := _beside(target)).mkdir()
            probe.rmdir()
            if target.is_dir() and not os.access(target, os.W_OK | os.X_OK):  # a probe could be left in it by a kill
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except OSError as error:
        raise OSError(f"{path} cannot be written: {error.strerror}") from error


@contextmanager
def _parents(target: Path) -> Iterator[None]:
    """Make the missing folders above a target; those in which nothing is at the end are removed again."""
    missing = [folder for folder in target.parents if not folder.exists()]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        yield
    finally:
        for folder in missing:
            with suppress(OSError):
                folder.rmdir()


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Yield an empty temporary folder that replaces `path` when the block ends without an error; links are followed.

    Missing folders above it are made. The contents of an old folder are lost. If the block fails, the temporary folder
    is removed. If the run is killed, the complete old folder or the complete new one has the name. A hidden folder
    ``.NAME.xxxxxxxx.part`` may remain; a run that starts an hour later removes it.

    Notes
    -----
    A new folder takes one rename. An old folder is exchanged with the new one by one system call (renameat2 of Linux,
    renameatx_np of macOS) and then removed. If there is no such call, or the file system refuses it, the old folder is
    renamed to ``.NAME.xxxxxxxx.old`` before the new one is renamed. If the run is killed between these two steps, both
    folders are complete, but neither has the name.
    """
    target = real(path)
    _remove_abandoned(target)
    temporary = _beside(target)
    with _parents(target):
        try:
            with naming(path, temporary):
                temporary.mkdir()
                yield temporary
                _flush(temporary)
                _put(temporary, target)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)


def _put(new: Path, target: Path) -> None:
    """Replace a folder by a new one; the old folder is removed, or remains under the name of the new one."""
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
    """Exchange two names in one step; False if the system or the file system cannot."""
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
    """Remove the temporary files or folders of runs that were killed long ago."""
    for left in target.parent.glob(f".{glob.escape(target.name)}.????????.part"):
        with suppress(OSError):  # another run may have removed it
            if time.time() - left.lstat().st_mtime > ABANDONED:
                shutil.rmtree(left) if left.is_dir() else left.unlink()


def _flush(folder: Path) -> None:
    """Write all files and folders in a folder to the disk."""
    for place, _, names in os.walk(folder):
        for name in names:
            with open(os.path.join(place, name), "rb+") as file:
                os.fsync(file.fileno())
        _flush_directory(Path(place))


def _flush_directory(folder: Path) -> None:
    """Write the names in a folder to the disk, if the system can open folders."""
    if os.name == "posix":
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
