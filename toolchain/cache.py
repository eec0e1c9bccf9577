"""Where all that can be made again is kept."""

import os
import shutil
import struct
import tempfile
from collections.abc import Iterator
from pathlib import Path

DEEPEST = 2  # of a cache's folders, those in which the compiler makes others; what lies in these one build has made
LEAST_ROOM_BYTES = 64 << 20  # the first build of an image leaves 43 MB


def cache_dir(home: Path, asked: str | None) -> Path:
    """The first of these folders that can be written: the one that is `asked` for by TWINLAW_CACHE, `.cache` in `home` where that is
    a checkout, the user's own (XDG_CACHE_HOME, or what the system has for it), a temporary one."""
    wanted = [Path(asked).expanduser().absolute()] if asked else []
    wanted += [home / ".cache"] if (home / "pyproject.toml").is_file() else []
    return next((place for place in wanted if _writable(place)), None) or _users_own()


def _users_own() -> Path:
    from platformdirs import user_cache_path  # which a checkout does without

    place = user_cache_path("twinlaw", appauthor=False)
    return place if _writable(place) else _temporary()


def _writable(place: Path) -> bool:
    """Whether files can be made there and in what of it is there already, which another user may have made; makes the folder.

    A name in bytes that are no UTF-8 could not be told to the compiler.
    """
    try:
        str(place).encode()
        place.mkdir(parents=True, exist_ok=True)
        return all(os.access(folder, os.W_OK | os.X_OK) for folder in _folders(place, DEEPEST))
    except (OSError, UnicodeEncodeError):
        return False


def _folders(place: Path, depth: int) -> Iterator[Path]:
    yield place
    if depth:
        for entry in os.scandir(place):
            if entry.is_dir(follow_symlinks=False):
                yield from _folders(Path(entry.path), depth - 1)


def room_bytes() -> int:
    """What is free on the disk of the cache."""
    return shutil.disk_usage(CACHE_DIR).free


def _temporary() -> Path:
    """The same for all processes of a user; a folder of that name that somebody else has made is not trusted with libraries.

    Where no folder at all can be written it is one that is not there: who writes first tells so.
    """
    user = os.getuid() if hasattr(os, "getuid") else None
    try:
        place = Path(tempfile.gettempdir()) / f"twinlaw-{user}"
        place.mkdir(mode=0o700, exist_ok=True)
        return place if user in (None, place.stat().st_uid) else Path(tempfile.mkdtemp(prefix="twinlaw-"))
    except OSError:
        return Path(os.sep, "tmp", f"twinlaw-{user}")


def elsewhere(asked: str | None, found: Path) -> str:
    """What is to be said where the folder that was asked for is not the one in use; empty where it is, or none was."""
    if not asked or Path(asked).expanduser().absolute() == found:
        return ""
    return f"TWINLAW_CACHE={asked} cannot be used: what can be made again is kept in {found}"


_ASKED = os.environ.get("TWINLAW_CACHE")
CACHE_DIR = cache_dir(Path(__file__).resolve().parent.parent, _ASKED)
NOT_AS_ASKED = elsewhere(_ASKED, CACHE_DIR)


def is_whole(product: Path) -> bool:
    """Whether what a compiler left is there to its end: a library that was cut short would be a bus error in whoever calls it.

    Linkers write the table of sections last, so it tells of an ELF file; of another format only that there is something.
    """
    try:
        with product.open("rb") as file:
            header, size = file.read(64), os.fstat(file.fileno()).st_size
    except OSError:
        return False
    if not header.startswith(b"\x7fELF"):
        return len(header) == 64 and header.strip(b"\0") != b""
    is_64_bit = header[4:5] == b"\2"
    if len(header) < (64 if is_64_bit else 52):
        return False
    (start,) = struct.unpack_from("<Q" if is_64_bit else "<I", header, 40 if is_64_bit else 32)  # e_shoff
    entry, entries = struct.unpack_from("<HH", header, 58 if is_64_bit else 46)  # e_shentsize, e_shnum
    return bool(size >= start + entry * entries > 0)
