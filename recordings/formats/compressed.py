"""A packed file (.gz, .bz2, .xz, .zip): unpacked beside nothing, and read as what it holds."""

import bz2
import gzip
import lzma
import tempfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import IO, Any
from zipfile import BadZipFile, ZipFile

from recordings.signals import Contents, listed
from records.errors import BadInput

ARCHIVE = ".zip"
_OPEN: Mapping[str, Callable[[Path], Any]] = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}
SUFFIXES = (*_OPEN, ARCHIVE)
NOTES = (".txt", ".log")  # a readme beside a log of another ending
_PIECE = 1 << 20
MOST_BYTES = 8 << 30  # a log of 160 million rows; what unpacks to more is no log


def read(path: Path, inner: Callable[[Path], Contents], suffixes: tuple[str, ...]) -> Contents:
    """What `inner` reads of the unpacked file; of an archive's files the only one with an ending of `suffixes`.

    Raises BadInput for one that is missing or not whole, for an archive without or with several such files, and for what `inner` does.
    """
    kind = path.suffix.lower()
    with tempfile.TemporaryDirectory() as folder:
        try:
            if kind == ARCHIVE:
                unpacked, told = _from_archive(path, Path(folder), suffixes)
            else:
                unpacked, told = Path(folder) / path.stem, "unpacked"
                with _OPEN[kind](path) as packed:
                    _copy(packed, unpacked, path)
        except (OSError, EOFError, zlib.error, lzma.LZMAError, BadZipFile, RuntimeError, NotImplementedError) as error:
            got = f"no whole {kind} file ({error})"
            raise BadInput("packed file", str(path), got, "a packed log", "pack it again, or unpack it") from error
        try:
            contents = inner(unpacked)
        except BadInput as error:
            raise BadInput(
                error.what, error.where.replace(str(unpacked), str(path)), error.got, error.expected, error.remedy
            ) from error
    return replace(contents, found=(told, *contents.found))


def without_suffix(name: str) -> str:
    """A file's name without the ending of its packing: `run.csv` of `run.csv.gz`."""
    return next((name[: -len(suffix)] for suffix in SUFFIXES if name.lower().endswith(suffix)), name)


def _from_archive(path: Path, folder: Path, suffixes: tuple[str, ...]) -> tuple[Path, str]:
    """The only log of an archive, unpacked into the folder, and what is said of it."""
    with ZipFile(path) as archive:
        logs = [name for name in archive.namelist() if name.lower().endswith(suffixes) and _is_shown(name)]
        logs = [name for name in logs if not name.lower().endswith(NOTES)] or logs
        if len(logs) != 1:
            got = f"{len(logs) or 'no'} logs: {listed(logs or archive.namelist())}"
            raise BadInput("packed file", str(path), got, "one log", "unpack it, and name the file that is meant")
        sidecar = str(PurePosixPath(logs[0]).with_suffix(".toml"))
        for name in (logs[0], *({sidecar} & set(archive.namelist()))):
            with archive.open(name) as packed:
                _copy(packed, folder / PurePosixPath(name).name, path)
    return folder / PurePosixPath(logs[0]).name, f"{logs[0]} unpacked"


def _is_shown(name: str) -> bool:
    """Whether an archive's file is one that a user put there: macOS adds `__MACOSX/._run.csv`."""
    return not any(part.startswith((".", "__MACOSX")) for part in PurePosixPath(name).parts)


def _copy(packed: IO[bytes], unpacked: Path, path: Path) -> None:
    with unpacked.open("wb") as out:
        while piece := packed.read(_PIECE):
            if out.tell() > MOST_BYTES:
                got = f"more than {MOST_BYTES >> 30} GB unpacked"
                raise BadInput("packed file", str(path), got, "a log", "unpack it, and import a part")
            out.write(piece)
