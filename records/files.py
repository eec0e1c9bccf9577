"""Files that are either whole or not there."""

import errno
import os
import tempfile
from collections.abc import Iterable
from pathlib import Path

from records.errors import BadInput


def write_atomic(path: Path, content: str | bytes) -> None:
    """Write `content` to `path` through a temporary file in the same folder, so that a reader never meets half of it.

    Raises BadInput when the folder cannot be made or written.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    except OSError as error:
        raise _unwritable(path, error) from error
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
        Path(name).chmod(0o644)
        Path(name).replace(path)
    except BaseException as error:  # Ctrl-C too must leave nothing beside it
        Path(name).unlink(missing_ok=True)
        if isinstance(error, OSError):
            raise _unwritable(path, error) from error
        raise


def demand_writable(path: Path) -> None:
    """Raise BadInput where `write_atomic` could not write `path`, without writing it; makes the folder."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=path.parent).close()
    except OSError as error:
        raise _unwritable(path, error) from error


def remove_all(paths: Iterable[Path]) -> None:
    """Remove the files that are there; raises BadInput for one that cannot be removed."""
    for path in paths:
        try:
            path.unlink(missing_ok=True)
        except NotADirectoryError:
            return  # what stands in the way is named by the first file written
        except OSError as error:
            raise _unwritable(path, error) from error


def _unwritable(path: Path, error: OSError) -> BadInput:
    got = error.strerror or str(error)
    if error.errno in {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}:
        return BadInput("output file", str(path), got, "room for it", "make room, or choose another --out")
    expected, remedy = "a folder that can be written", "choose another --out or change the folder's permissions"
    return BadInput("output file", str(path), got, expected, remedy)
