"""Jobs for the tests, found by their names in other processes."""

import os
import signal
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jobs.threads import threads
from records.errors import BadInput


@dataclass(frozen=True)
class Throw:
    """So many normal numbers of one seed and index."""

    seed: int
    index: int
    count: int = 1000


def thrown(record: Throw) -> dict[str, Any]:
    """Numbers whose last bits would show another order, seed or number of threads."""
    draws = np.random.default_rng([record.seed, record.index]).standard_normal(record.count)
    square = np.outer(draws, draws)
    return {"sum": float(square.sum()), "trace": float(np.linalg.norm(square @ square)), "threads": threads()}


def odd_fails(index: int) -> int:
    """Odd numbers are refused, five is nobody's expectation."""
    if index == 5:
        raise ZeroDivisionError("five")
    if index % 2:
        raise BadInput("number", f"record {index}", "an odd one", "an even one", "add 1")
    return index


def deadly(record: tuple[int, int, str]) -> int:
    """Kills its process where index is the culprit; the others leave a mark each time that they are done."""
    index, culprit, folder = record
    if index == culprit:
        os.kill(os.getpid(), signal.SIGKILL)
    with (Path(folder) / f"{index}").open("a") as mark:
        mark.write("done\n")
    return index


def endless(folder: str) -> int:
    """Says that it has begun and waits to be stopped; is told so once more, as a pool does, and says so when it is."""
    place = Path(folder)
    try:
        (place / f"begun-{os.getpid()}").touch()
        threading.Event().wait()
    finally:
        os.kill(os.getpid(), signal.SIGTERM)
        (place / f"closed-{os.getpid()}").touch()
    return 0


def two_then_endless(record: tuple[int, str]) -> int:
    """The first two are done at once."""
    index, folder = record
    return index if index < 2 else endless(folder)


def no_json(_: int) -> object:
    """Nothing that JSON can hold."""
    return {1, 2}


def late(index: int) -> int:
    """The first comes last."""
    time.sleep(0.3 if index == 0 else 0.0)
    return index


def folder_of_files(text: str) -> dict[str, str]:
    """Two files, or three."""
    return {"a.txt": text, "b.txt": text * 2} | ({"c.txt": "more"} if text == "long" else {})
