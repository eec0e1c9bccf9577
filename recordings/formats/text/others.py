"""Text that is no table: what it is, and what makes a table of it."""

import re
from collections.abc import Sequence

from records.errors import BadInput

_DECODE = (
    "decode it with the bus's database, as `cantools` or `asammdf` do, and export the signals as CSV or MDF "
    "from the tool that recorded it"
)
_HTML = "save it as .xlsx or CSV"
_FRAME = r"[0-9A-Fa-f]{1,8}x?"
_CAN = (
    re.compile(rf"\s*\(\d+\.\d+\)\s+\w+\s+{_FRAME}#"),  # candump -l
    re.compile(rf"(\s*\([\d.: -]+\))?\s+\w*can\w*\s+([RT]X\s.*?)?{_FRAME}\s+\[\d+\]"),  # candump
    re.compile(rf"\s*\d+\.\d+\s+\d+\s+{_FRAME}\s+[RT]x\s"),  # Vector's .asc
    re.compile(rf"\s*\d+\)\s+[\d.]+\s+[RT]x\s+{_FRAME}\s"),  # PEAK's .trc
)
FRAMES = 2  # lines of them: one may stand in a remark
SAMPLE_LINES = 40  # among which these are: a preamble has fewer lines
_KINDS = (
    (re.compile(r"\s*\[?\s*\{\s*\""), "JSON", "call it .json, or .jsonl with an object a line"),
    (re.compile(r"\s*<(!doctype html|html|table)\b", re.I), "a page of HTML", _HTML),
    (re.compile(r"\s*<\?xml|\s*<\w+[\s>]"), "XML", "export it as CSV from the tool that wrote it"),
    (re.compile(r"# Created by Octave"), "Octave's own text", "save it in Octave with save -v7 log.mat, or csvwrite"),
    (
        re.compile(r"\w[\w.]*:.*\n(?:(?: *\w[\w.]*:| *- ).*\n){0,200}---\n"),
        "what `ros2 topic echo` prints",
        "let it print a table, ros2 topic echo --csv TOPIC > log.csv, or record a bag",
    ),
    (
        re.compile(r"(?:#.*\n)*,result,table,.*_value,_field"),
        "a table of InfluxDB, one signal behind the other",
        'add |> pivot(rowKey: ["_time"], columnKey: ["_field"], valueColumn: "_value") to its query',
    ),
    (
        re.compile(r"FMT, *\d+, *\d+, *FMT,"),
        "a log of ArduPilot, a kind of message a line",
        "take one kind out of it: mavlogdump.py --types ATT --format csv LOG > att.csv",
    ),
)


def demand_table(text: str, where: str) -> None:
    """Refuses text of a kind that is known and no table of numbers; raises BadInput with what to type."""
    for form, what, remedy in _KINDS:
        if form.match(text):
            raise BadInput("text file", where, what, "a table of text", remedy)
    if _frames(text.splitlines()[:SAMPLE_LINES]) >= FRAMES:
        raise BadInput(
            "text file", where, "frames of a CAN bus, bytes that only its database explains", "signals", _DECODE
        )


def _frames(lines: Sequence[str]) -> int:
    return sum(any(form.match(line) for form in _CAN) for line in lines)
