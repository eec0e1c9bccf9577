"""Which rows of a file can be used, and what no row of a log may hold."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from records.errors import BadInput
from records.logs.columns import LogColumns
from records.logs.mended import Disordered, LateInput

MOST_DISORDERED = 0.1  # of a log's rows: with more the file is in no order, or its times are no times
Array = NDArray[np.float64]


def rising_rows(t_s: Array) -> NDArray[np.bool_]:
    """Rows (n,) whose time is later than all before, of one time the last, whose command holds; all rows where more than MOST_DISORDERED
    are not, as then the clock is no clock."""
    ends = np.flatnonzero(np.diff(t_s, append=np.inf) != 0.0)
    first = np.concatenate([[True], t_s[1:] > np.maximum.accumulate(t_s)[:-1]])
    rising = np.zeros(len(t_s), bool)
    rising[ends[np.searchsorted(ends, np.flatnonzero(first))]] = True
    few = bool(np.isfinite(t_s).all()) and float((~rising).mean()) <= MOST_DISORDERED
    return rising if few else np.ones(len(t_s), bool)


def disordered_rows(t_s: Array, y: Array, rising: NDArray[np.bool_]) -> Disordered:
    """What is to be known of the rows (n,) that do not rise; those that are written again, reading for reading, went back by nothing."""
    kept = np.flatnonzero(rising)
    first = kept[np.minimum(np.searchsorted(t_s[kept], t_s), len(kept) - 1)]
    again = (t_s == t_s[first]) & ((y == y[first]) | np.isnan(y)).all(axis=1)
    back = (t_s < np.maximum.accumulate(t_s)) & ~again
    edges = np.flatnonzero(np.diff(back, prepend=False, append=False)).reshape(-1, 2)
    later = [(kept[kept >= last], last - first) for first, last in edges.tolist()]
    went_back = tuple((float(t_s[on[0]]), count) for on, count in later if on.size)
    return Disordered(int((~rising).sum()), float(t_s[~rising][0]), went_back)


def from_the_inputs(
    data: Mapping[str, Array], begins: NDArray[np.int64], columns: LogColumns
) -> tuple[NDArray[np.bool_], tuple[LateInput, ...]]:
    """Rows (n,) but those that stand in front of an input's first number at the head of a recording, and what was left out."""
    kept = np.ones(len(data["t_s"]), bool)
    found = []
    for first, behind in pairwise([0, *begins.tolist(), len(kept)]):
        known = {name: ~np.isnan(data[name][first:behind]) for name in columns.inputs}
        rows = {name: int(np.argmax(there)) for name, there in known.items() if there.any()}
        last = max(rows, key=lambda name: rows[name], default=None)
        if last is None or not rows[last] or len(rows) < len(known):
            continue  # what never begins is refused with its line
        kept[first : first + rows[last]] = False
        found.append(LateInput(last, float(data["t_s"][first + rows[last]]), rows[last]))
    return kept, tuple(found)


def check_columns(names: tuple[str, ...], where: str, columns: LogColumns) -> None:
    needed = ("t_s", *columns.inputs, *columns.outputs)
    for name in needed:
        if name not in names:
            shown = ",".join(names)
            got = f"the header {shown if len(shown) < 200 else f'{shown[:197]}...'!r}, cells separated by commas"
            remedy = f"a log of {columns.plant} needs {','.join(needed)}; `twinlaw import` makes one of any other table"
            raise BadInput(f"column {name!r}", where, got, "a column of that name", remedy)
    for name in names:
        if name not in (*needed, *columns.optional, "seq"):
            known = ", ".join((*needed, "seq", *columns.optional))
            raise BadInput(f"column {name!r}", where, "an unknown column", f"one of {known}", "remove or rename it")
    if len(set(names)) != len(names):
        raise BadInput("header", where, "a column twice", "each column once", "remove the second")


def _no_number(values: Array, bad: NDArray[np.intp]) -> str:
    """The first of the values at the places `bad`, and in how many rows such stand."""
    first = float(values[bad[0]])
    told = "nan or an empty cell" if np.isnan(first) else repr(first)
    return told if len(bad) == 1 else f"{told}, and no number in {len(bad) - 1} more row{'s' if len(bad) > 2 else ''}"


def check_numbers(data: Mapping[str, Array], kept: NDArray[np.bool_], where: str, columns: LogColumns) -> None:
    """Raise BadInput for a number that cannot be, in an input only where its rows are `kept` (n,)."""
    for name in ("t_s", *columns.inputs, *(["seq"] if "seq" in data else [])):
        bad = np.flatnonzero(~np.isfinite(data[name]) & (kept if name in columns.inputs else True))
        if bad.size:
            raise BadInput(
                f"column {name!r}",
                f"{where}, line {bad[0] + 2}",
                _no_number(data[name], bad),
                "a finite number",
                "remove such rows" + (", or write what the controller sent there" if name in columns.inputs else ""),
            )
    if "seq" in data and np.any(data["seq"] != np.round(data["seq"])):
        row = int(np.flatnonzero(data["seq"] != np.round(data["seq"]))[0])
        raise BadInput(
            "column 'seq'", f"{where}, line {row + 2}", repr(float(data["seq"][row])), "a whole number", "mend the row"
        )
    for name in (*columns.outputs, *(name for name in columns.optional if name in data)):
        bad = np.flatnonzero(np.isinf(data[name]))
        if bad.size:
            raise BadInput(
                f"column {name!r}",
                f"{where}, line {bad[0] + 2}",
                "an infinity",
                "a number, or NaN where none was measured",
                "write nan",
            )
    late = np.flatnonzero(np.diff(data["t_s"]) <= 0.0)
    if late.size and bool(rising_rows(data["t_s"]).all()):
        row = int(late[0]) + 1
        raise BadInput(
            "t_s",
            f"{where}, line {row + 2}",
            f"{data['t_s'][row]:g} after {data['t_s'][row - 1]:g}",
            "a time that increases",
            "sort the rows and remove repeated ones, or let `twinlaw import` leave them out",
        )
