"""A file that gzip has packed: unpacked beside nothing, and read as what its name says without the last ending."""

import gzip
import tempfile
import zlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from recordings.signals import Contents
from records.errors import BadInput

SUFFIX = ".gz"
_PIECE = 1 << 20
MOST_BYTES = 8 << 30  # a log of 160 million rows; what unpacks to more is no log


def read(path: Path, inner: Callable[[Path], Contents]) -> Contents:
    """What `inner` reads of the unpacked file; raises BadInput for one that is missing or no whole gzip file, and for what `inner` does."""
    with tempfile.TemporaryDirectory() as folder:
        unpacked = Path(folder) / path.stem
        try:
            with gzip.open(path) as packed, unpacked.open("wb") as out:
                while piece := packed.read(_PIECE):
                    if out.tell() > MOST_BYTES:
                        got = f"more than {MOST_BYTES >> 30} GB unpacked"
                        raise BadInput("gzip file", str(path), got, "a log", "unpack it, and import a part")
                    out.write(piece)
        except (OSError, EOFError, zlib.error) as error:
            got = f"no whole gzip file ({error})"
            raise BadInput("gzip file", str(path), got, "a packed log", "pack it again, or unpack it") from error
        try:
            contents = inner(unpacked)
        except BadInput as error:
            raise BadInput(
                error.what, error.where.replace(str(unpacked), str(path)), error.got, error.expected, error.remedy
            ) from error
    return replace(contents, found=("unpacked", *contents.found))
