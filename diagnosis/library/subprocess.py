"""A piece of Python's own work in a process of its own: of the threads of one process only one at a time does algebra."""

import os
import pickle
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from toolchain.host import INTERRUPTED

# The answer's way is kept clear of what imported code may print, which goes where errors go.
PROGRAM = """
import os, pickle, sys
answer = os.fdopen(os.dup(1), "wb")
os.dup2(2, 1)
work, items = pickle.load(sys.stdin.buffer)
answer.write(pickle.dumps(work(*items)))
"""


class NotDone(Exception):
    """The process did not give an answer; whoever asked does the work itself, and meets the cause if there is one."""


def in_subprocess(work: Callable[..., Any], *items: Any) -> Any:
    """work(*items) by another Python, which imports `work` by its name; items and answer are such as can be pickled.

    Not a worker of jobs/crew.py: a spawned one runs the script again that asks, a notebook's cells say. Raises NotDone where the other
    process fails, with what it said, and KeyboardInterrupt where Ctrl-C ended it.
    """
    path = os.pathsep.join(filter(None, sys.path))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        input=pickle.dumps((work, items)),
        capture_output=True,
        env={**os.environ, "PYTHONPATH": path},
        check=False,
    )
    if done.returncode in INTERRUPTED:
        raise KeyboardInterrupt
    if done.returncode != 0:
        raise NotDone(done.stderr.decode(errors="replace"))
    return pickle.loads(done.stdout)
