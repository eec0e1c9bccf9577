"""Logs of one rig parted into those to explain and those held out, every way there is; one log by itself is cut first."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations, islice
from pathlib import Path

import numpy as np

from records.errors import BadInput
from records.log import RunLog, load_log, save_log
from records.logs.columns import LogColumns
from twinlaw.workflows.diagnose.questions import Question

LONGEST_NAME = 100  # letters, of a folder: file systems take 255
LEAST_PART_S = 4.0  # a hold-out says nothing in its first 2 s, and then once a second
LOG_PARTS = 3  # six splits; with two there would be two


def splits_of(plant: Path, logs: Sequence[Path], most: int) -> list[Question]:
    """At most `most` partitions into logs to explain and logs held out, neither empty, with the fewest to explain first.

    Of as many to explain, the logs named first come first; a question bears the names of those to explain. Raises BadInput for less than
    two logs.
    """
    if len(logs) < 2:
        raise BadInput("logs", "command line", f"{len(logs)}", "two or more", "name another, or cut one")
    return list(islice(_partitions(plant, logs), most))


def count_of(logs: Sequence[Path]) -> int:
    """How many partitions there are."""
    return (1 << len(logs)) - 2


def _partitions(plant: Path, logs: Sequence[Path]) -> Iterator[Question]:
    for size in range(1, len(logs)):
        for chosen in combinations(range(len(logs)), size):
            told = tuple(logs[place] for place in chosen)
            held = tuple(path for place, path in enumerate(logs) if place not in chosen)
            yield Question(_name(told, chosen), plant, told, held)


def _name(told: Sequence[Path], chosen: Sequence[int]) -> str:
    """The names of logs, or their places among all where these are too long for a folder."""
    name = "+".join(path.stem for path in told)
    return name if len(name) <= LONGEST_NAME else "+".join(f"log{place + 1}" for place in chosen)


def cut(path: Path, columns: LogColumns, folder: Path) -> list[Path]:
    """A log in parts of equal length in time, written to `folder`: thirds, or halves of a short one. Raises BadInput for a shorter one.

    What flew it is no longer named, as its code cannot be run again from the middle of a flight.
    """
    log = load_log(path, columns)
    length_s = float(log.t_s[-1] - log.t_s[0])
    parts = next((count for count in range(LOG_PARTS, 1, -1) if length_s >= count * LEAST_PART_S), 0)
    if not parts:
        expected = f"{2 * LEAST_PART_S:g} s or more"
        raise BadInput("run log", str(path), f"{length_s:.3g} s", expected, "name a second log, or record for longer")
    number = np.minimum((log.t_s - log.t_s[0]) / length_s * parts, parts - 1).astype(int)
    written = []
    for part in range(parts):
        written.append(folder / f"{path.stem}-{part + 1}of{parts}.csv")
        save_log(written[-1], _rows(log, number == part))
    return written


def _rows(log: RunLog, kept: np.ndarray) -> RunLog:
    return replace(
        log,
        t_s=log.t_s[kept],
        u=log.u[kept],
        y=log.y[kept],
        extra={name: column[kept] for name, column in log.extra.items()},
        seq=None if log.seq is None else log.seq[kept],
        table_digest=None,
    )
