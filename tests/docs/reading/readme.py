"""The parts of README.md that a run makes: what `make run` prints, and the plot of its flight.

`.venv/bin/python -m tests.docs.reading.readme` runs the chain and writes both anew.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

from records.log import load_log
from sim.columns import log_columns
from sim.plants import MODELS
from twinlaw.pages.run.report import flight_plot

ROOT = Path(__file__).resolve().parents[3]
README, PLOT = ROOT / "README.md", ROOT / "docs" / "flight.svg"
_BLOCK = re.compile(r"(<!-- output of make run -->\n```\n)(.*?)(```\n)", flags=re.DOTALL)


def shown(readme: str) -> str:
    """What the page says that `make run` prints."""
    found = _BLOCK.search(readme)
    assert found is not None
    return found[2]


def told(out: Path) -> str:
    """What the run prints, with its files in `out` named as `make run` names them."""
    command = [sys.executable, "-m", "twinlaw.command", "run", "--plant", "plants/ce150.toml", "--out", str(out)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.replace(str(out), "build")


def plot(out: Path) -> str:
    """The flight of that run as SVG text."""
    return flight_plot(load_log(out / "run.csv", log_columns(MODELS["ce150"]())))


def renew() -> None:
    """Run, and put what it printed and drew into the page."""
    with tempfile.TemporaryDirectory() as folder:
        printed = told(Path(folder))
        text = _BLOCK.sub(lambda found: found[1] + printed + found[3], README.read_text(encoding="utf-8"))
        README.write_text(text, encoding="utf-8")
        PLOT.write_text(plot(Path(folder)), encoding="utf-8")


if __name__ == "__main__":
    renew()
