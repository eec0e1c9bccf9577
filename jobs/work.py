"""What happens in a worker: one job, its failure as a sentence, and an end that leaves no half-made things behind."""

import json
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import parent_process
from time import perf_counter
from typing import Any

from jobs.code import ROOT, code_digest
from jobs.job import Answer
from records.errors import BadInput

KILLED = 70  # exit status of a worker that was told to stop


@dataclass(frozen=True)
class Outcome:
    """What a worker sends back: an answer or a failure, never an exception, since not every exception survives the way."""

    answer: Answer
    failure: str | None
    time_s: float


def work(function: Callable[[Any], Answer], record: Any, code: str) -> Outcome:
    """Call one job's function; `code` is the digest of those who ask, and a worker with other sources refuses."""
    if code != code_digest():
        told = "sources or libraries of this worker are not those of the one who asks, or were changed meanwhile; start again"
        return Outcome(None, told, 0.0)
    began = perf_counter()
    try:
        # As it will be read from where it is kept: a tuple has become a list, and what JSON cannot hold is told here.
        answer, failure = json.loads(json.dumps(function(record))), None
    except BadInput as error:
        answer, failure = None, str(error)
    except Exception as error:
        answer, failure = None, _told(error)
    except SystemExit:
        # Told to stop in the middle: what the job had open is closed by now.
        os._exit(KILLED)
    return Outcome(answer, failure, perf_counter() - began)


def _told(error: Exception) -> str:
    """An error that nobody expected, with its place in our own code."""
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename.startswith(str(ROOT))]
    at = f" ({os.path.relpath(frames[-1].filename, ROOT)}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {' '.join(str(error).split())}{at}"


def settle_in() -> None:
    """Prepare a worker process: Ctrl-C is its parent's to answer, SIGTERM ends it tidily, and it does not outlive its parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _stop)
    threading.Thread(target=_leave_with_parent, daemon=True).start()


def _stop(*_: object) -> None:
    """Once: who is told again, as a pool tells those that are left when one of them has ended, closes what it has open all the same."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    sys.exit(KILLED)


def _leave_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(KILLED)
