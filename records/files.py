"""Files that are either whole or not there."""

import errno
import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from records.errors import BadInput


def place_of(path: Path) -> str:
    """Where a path leads in the end: one that leads round in a circle is a place of its own, at which nothing can be read."""
    return os.path.realpath(path)


def write_atomic(path: Path, content: str | bytes) -> None:
    """Write `content` to `path` through a temporary file in the same folder, so that a reader never meets half of it.

    Raises BadInput when the folder cannot be made or written.
    """
    write_together({path: content})


def write_together(contents: Mapping[Path, str | bytes]) -> None:
    """Write files that belong together: none takes its place before all are written, so that no new one stands beside an old.

    Raises BadInput when a folder cannot be made or written.
    """
    written: dict[Path, Path] = {}
    try:
        for path, content in contents.items():
            _write_beside(path, content, written)
        for path, temporary in written.items():
            temporary.replace(path)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:  # Ctrl-C too must leave nothing beside them
        for temporary in written.values():
            temporary.unlink(missing_ok=True)


def _write_beside(path: Path, content: str | bytes, written: dict[Path, Path]) -> None:
    """Write `content` to a temporary file in the folder of `path`, which is noted before anything can go wrong with it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    written[path] = Path(name)
    with os.fdopen(handle, "wb") as stream:
        stream.write(content.encode("utf-8") if isinstance(content, str) else content)
    Path(name).chmod(0o644)


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
