"""The bytes of a text file as text: UTF-8, UTF-16, UTF-32, or the letters of Windows, and what is to be said of that."""

import codecs
import re
from pathlib import Path

from records.errors import BadInput

# The longer first: UTF-32's mark begins as UTF-16's.
MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
# By their first bytes; each names the formats of formats/table.py that begin so.
BINARY = {
    b"PK\x03\x04": "a zipped file, such as an Excel workbook or a NumPy file",
    b"\xd0\xcf\x11\xe0": "an old Excel workbook",
    b"MATLAB": "a MATLAB file",
    b"MDF  ": "an MDF file",
    b"\x89HDF": "an HDF5 file or a MATLAB file of version 7.3",
    b"PAR1": "a Parquet file",
    b"ARROW1\0\0": "an Arrow file",
    b"\x1f\x8b": "a file that gzip has packed",
    b"\x55Log": "a PX4 log",
    b"\x89MCAP": "an MCAP file",
    b"SQLite format 3": "a data base, such as a ROS bag",
    b"#ROSBAG": "a ROS bag",
    b"TDSm": "a TDMS file",
}


def binary_kind(start: bytes) -> str | None:
    """What a file that begins so is, where it is one of BINARY."""
    return next((what for mark, what in BINARY.items() if start.startswith(mark)), None)


def decoded(path: Path) -> tuple[str, tuple[str, ...]]:
    """The text of a file in UTF-8, -16, -32 or, where it is none of these, Windows-1252, and what is said of that; raises BadInput."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BadInput(
            "text file", str(path), error.strerror or str(error), "a readable file", "check the path"
        ) from error
    kind = binary_kind(content)
    if kind is not None:
        raise BadInput("text file", str(path), kind, "a table of text", "export it as CSV, or give it its own ending")
    encoding = next((encoding for mark, encoding in MARKS if content.startswith(mark)), None)
    whole = content.rstrip(b"\0")  # a logger that lost power leaves the rest of its block empty
    if encoding is None and b"\0" not in whole:
        content = whole
    if encoding is None and b"\0" in content[:4096]:
        encoding = next(
            (f"utf-16-{end}" for end, at in (("le", 1), ("be", 0)) if content[at:200:2].count(0) > 50), None
        )
    told: list[str] = []
    if encoding is None and b"\0" in content:
        content, said = _without_holes(content, path)
        told.append(said)
    try:
        text = content.decode(encoding or "utf-8")
        told += [f"encoding {encoding.removesuffix('-sig')} by its mark"] if encoding else []
    except UnicodeDecodeError:
        text = content.decode("cp1252", errors="replace")
        told.append("encoding Windows-1252, as it is no UTF-8")
    return _plain(text), tuple(told)


def _without_holes(content: bytes, path: Path) -> tuple[bytes, str]:
    """A text without runs of zero bytes, which a logger that lost power leaves within its file, and without the rows that one cut; and what
    is said of it. Raises BadInput where the rest is no text."""
    whole = re.sub(rb"(?:(?<=[\r\n])|^)\0+", b"", content)
    kept = re.sub(rb"[^\r\n\0]*\0+[^\r\n]*", b"", whole)
    if re.search(rb"[\x01-\x08\x0e-\x1a\x7f]", kept):
        raise BadInput("text file", str(path), "bytes that are no text", "a table of text", "export it as CSV")
    line = content.count(b"\n", 0, content.index(b"\0")) + 1
    cut = "" if kept == whole else "; the rows that they cut are left out"
    return kept, f"{content.count(bytes(1))} zero bytes within the text, first in line {line}, are passed over{cut}"


# A typesetter's minus, dash, small and wide hyphen; blanks that do not break.
_TYPESET = str.maketrans("\u2212\u2013\ufe63\uff0d\u00a0\u202f\u2009", "----   ")


def _plain(text: str) -> str:
    """The text with minus and blanks as numbers are written."""
    return text.translate(_TYPESET)
