"""Reads a file in a program of its own: a damaged file can end a package that is partly in C, and all that runs with it.

Run as a program with a module of this folder and a path, it answers on standard output with what the module read, pickled.
"""

import os
import pickle
import subprocess
import sys
from dataclasses import astuple
from importlib import import_module
from pathlib import Path

from recordings.layout import FOUND
from recordings.signals import Contents
from records.errors import BadInput

ROOT = Path(__file__).resolve().parents[2]


def read(module: str, path: Path, called: str) -> Contents:
    """What `recordings.formats.MODULE` reads at `path`; raises its BadInput, and one where it ends before it answers."""
    command = [sys.executable, "-P", "-m", "recordings.formats.other_process", module, str(path)]
    places = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))
    done = subprocess.run(command, capture_output=True, check=False, env={**os.environ, "PYTHONPATH": places})
    if done.returncode:
        got = f"no whole file (its reader ended with status {done.returncode})"
        raise BadInput(called, str(path), got, "one that its reader can read", "save or export it again")
    contents, error = pickle.loads(done.stdout)
    if error is not None:
        raise BadInput(*error)
    answer: Contents = contents
    return answer


def main() -> int:
    """Read, and answer on standard output, on which nothing else may write."""
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    reader = import_module(f"recordings.formats.{sys.argv[1]}")
    answer: tuple[Contents | None, tuple[str, ...] | None]
    try:
        answer = (reader.read(Path(sys.argv[2]), FOUND), None)
    except BadInput as error:
        answer = (None, astuple(error))
    with out:
        pickle.dump(answer, out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
