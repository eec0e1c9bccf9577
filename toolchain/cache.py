"""Where all that can be made again is kept."""

import os
import struct
from pathlib import Path

CACHE_DIR = Path(os.environ.get("TWINLAW_CACHE", Path(__file__).resolve().parent.parent / ".cache"))


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
