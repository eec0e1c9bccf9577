"""The file formats, a row each: a new one is a file in this folder and a row here."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Protocol, cast

from recordings.formats import compressed, other_process
from recordings.formats.optional import is_installed, missing
from recordings.formats.text.decoding import binary_kind
from recordings.layout import TextLayout
from recordings.signals import Contents
from records.errors import BadInput


class Reader(Protocol):
    """A module that reads one format."""

    def read(self, path: Path, asked: TextLayout) -> Contents:
        """What the file holds; `asked` is for tables of text alone. Raises BadInput for a file that is missing, damaged or another."""
        ...


@dataclass(frozen=True)
class Format:
    """A file format: the module that reads it, what it is called, the package that it needs with the extra that installs it, if any.

    `in_other_process`: it is read in a program of its own, as its package is partly in C.
    """

    module: str
    called: str
    package: str | None = None
    extra: str = ""
    in_other_process: bool = False

    @property
    def is_binary(self) -> bool:
        """Whether no file of it is plain text."""
        return self.module not in ("text.delimited", "json_rows")


FORMATS: Mapping[tuple[str, ...], Format] = {
    (".csv", ".tsv", ".txt", ".dat", ".log", ".lvm", ".asc", ".prn"): Format("text.delimited", "table of text"),
    (".json", ".jsonl", ".ndjson"): Format("json_rows", "JSON file"),
    (".npz", ".npy"): Format("numpy_arrays", "NumPy file"),
    (".mat",): Format("matlab", "MATLAB file", in_other_process=True),  # version 7.3 as HDF5
    (".h5", ".hdf5"): Format("hdf5", "HDF5 file", "h5py", "hdf5", in_other_process=True),
    (".mf4", ".mdf"): Format("mdf", "MDF file", "asammdf", "mdf4", in_other_process=True),
    (".ulg",): Format("ulog", "PX4 log", "pyulog", "px4"),
    (".parquet",): Format("arrow", "Parquet file", "pyarrow", "parquet", in_other_process=True),
    (".feather", ".arrow"): Format("arrow", "Arrow file", "pyarrow", "parquet", in_other_process=True),
    (".orc",): Format("arrow", "ORC file", "pyarrow", "parquet", in_other_process=True),
    (".mcap",): Format("bags.mcap", "MCAP file", "mcap", "ros"),
    (".db3", ".bag"): Format("bags.ros_bag", "ROS bag", "rosbags", "ros"),
    (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods"): Format(
        "spreadsheet", "workbook", "python_calamine", "excel", in_other_process=True
    ),
    (".tdms",): Format("tdms", "TDMS file", "nptdms", "tdms"),
}
# What other programs write that is read nowhere but there, and what to type in them.
_SIGNALS = (
    "decode its frames with the bus's database and export the signals as CSV or MDF from the tool that recorded it"
)
_FLIGHT = "take one kind of message out of it: mavlogdump.py --types ATT --format csv LOG > att.csv"
ELSEWHERE: Mapping[str, tuple[str, str]] = {
    ".mldatx": (
        "a session of Simulink's Data Inspector",
        "in MATLAB Simulink.sdi.load('NAME.mldatx'); Simulink.sdi.exportRun(Simulink.sdi.getAllRunIDs, to='file', filename='log.xlsx')",
    ),
    ".fig": (
        "a figure of MATLAB",
        "in MATLAB get its lines' XData and YData, and save those with save('log.mat', ...)",
    ),
    ".slx": ("a model of Simulink", "simulate it, and save its logged signals"),
    ".blf": ("frames of a CAN bus", _SIGNALS),
    ".trc": ("frames of a CAN bus", _SIGNALS),
    ".raw": ("results of a circuit simulation", "in LTspice: File, Export data as text"),
    ".pkl": (
        "Python's own objects, which may run what they hold",
        "save arrays with numpy.savez, a table with to_parquet",
    ),
    ".bin": ("bytes of a kind that its name does not tell", f"of ArduPilot: {_FLIGHT}"),
    ".tlog": ("telemetry of MAVLink", _FLIGHT),
    ".bbl": ("a log of Betaflight", "blackbox_decode LOG.bbl, which writes a CSV"),
    ".tdm": ("a DIAdem file", "save it as .tdms, or as CSV"),
    ".7z": ("a packed file", "unpack it, or pack it as .zip or .gz"),
    ".tar": ("a packed file", "unpack it, or pack it as .zip or .gz"),
}
_BY_SUFFIX = {suffix: entry for suffixes, entry in FORMATS.items() for suffix in suffixes}
SUFFIXES = tuple(_BY_SUFFIX)
PACKED = compressed.SUFFIXES


def is_file(name: str) -> bool:
    """Whether a word of the command line means a file, and not a data set, whose names have no ending."""
    path = Path(name)
    return bool(path.suffix) or path.exists() or "/" in name


def read(path: Path, asked: TextLayout) -> Contents:
    """What the file at `path` holds; a folder is a ROS 2 bag. Raises BadInput, also for an ending that no row has."""
    suffix = ".db3" if path.is_dir() else path.suffix.lower()
    if suffix in PACKED:
        return compressed.read(path, lambda unpacked: read(unpacked, asked), SUFFIXES)
    if suffix in ELSEWHERE:
        what, remedy = ELSEWHERE[suffix]
        raise BadInput("file", str(path), what, "a file of signals", remedy)
    if suffix not in _BY_SUFFIX and _is_text(path):
        return _of_text(path, asked)
    if suffix not in _BY_SUFFIX:
        got = f"the ending {path.suffix!r}" if path.suffix else "a name without an ending"
        raise BadInput(
            "file",
            str(path),
            got,
            f"one of {', '.join(SUFFIXES)}",
            "export it as one of these, or call a table of text .csv",
        )
    entry = _BY_SUFFIX[suffix]
    if entry.is_binary and _is_text(path):
        return _of_text(path, asked)
    if asked != TextLayout() and entry.module != "text.delimited":
        got = f"--separator, --decimal or --skip for a {entry.called}"
        raise BadInput("option", str(path), got, "these for tables of text alone", "leave them out")
    if entry.package and not is_installed(entry.package):
        raise missing(entry.package, entry.extra, path)
    try:
        if entry.in_other_process:
            return other_process.read(entry.module, path, entry.called)
        return cast(Reader, import_module(f"recordings.formats.{entry.module}")).read(path, asked)
    except BadInput as error:
        raise _of_another_kind(path, entry) or error from error


def _of_another_kind(path: Path, entry: Format) -> BadInput | None:
    """What is said of a file that could not be read, where it begins as one of another format does."""
    kind = binary_kind(_start(path))
    if kind is None or entry.called in kind:
        return None
    return BadInput(
        entry.called,
        str(path),
        f"{kind}, by its first bytes",
        f"a file of the kind {path.suffix}",
        "give it its own ending",
    )


def _is_text(path: Path) -> bool:
    """Whether a file under an ending of another kind begins as text does: without a zero byte, and not as a known binary one."""
    start = _start(path)
    return bool(start) and b"\0" not in start and binary_kind(start) is None


def _start(path: Path) -> bytes:
    try:
        with path.open("rb") as stream:
            return stream.read(4096)
    except OSError:
        return b""


def _of_text(path: Path, asked: TextLayout) -> Contents:
    contents: Contents = import_module("recordings.formats.text.delimited").read(path, asked)
    told = f"the ending {path.suffix!r}" if path.suffix else "a name without an ending"
    return replace(contents, found=(f"{told}: taken as a table of text", *contents.found))
