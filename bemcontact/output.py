"""Files that appear whole or not at all."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


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
