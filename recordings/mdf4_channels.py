"""ASAM MDF4 recordings (.mf4) of measurement and calibration tools, by way of the optional package asammdf."""

import pickle
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from recordings.channels import Channel
from records.errors import BadInput


def read_mdf4(path: Path) -> tuple[dict[str, Channel], str]:
    """All channels of numbers by name, of several with one name the first; and the comment of the first group.

    Raises BadInput when asammdf is not installed, and for a file that is missing or no MDF.
    """
    if not path.is_file():
        raise BadInput("MDF4 file", str(path), "no such file", "a readable file", "check the path")
    if find_spec("asammdf") is None:
        raise BadInput(
            "MDF4 file",
            str(path),
            "no package asammdf to read it with",
            "the optional extra mdf4",
            "install it: .venv/bin/pip install -e '.[mdf4]'",
        )
    command = [sys.executable, "-P", "-m", "recordings.mdf4_reading", str(path)]
    done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode == 0:
        channels, comment = pickle.loads(done.stdout)
        return channels, comment
    told = done.stdout.decode(errors="replace").strip() or f"its reader ended with status {done.returncode}"
    raise BadInput("MDF4 file", str(path), f"no MDF ({told})", "an MDF4 file", "export it again")
