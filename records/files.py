"""Files that are either whole or not there."""

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
    except OSError as error:
        Path(name).unlink(missing_ok=True)
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
    return BadInput(
        what="output file",
        where=str(path),
        got=error.strerror or str(error),
        expected="a folder that can be written",
        remedy="choose another --out or change the folder's permissions",
    )
