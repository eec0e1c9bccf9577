"""Logs diagnosed together, as the command runs it."""

from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Thread

from diagnosis.diagnose import diagnose
from diagnosis.result import Result
from jobs.thread_map import through_when_interrupted
from records.files import remove_all, write_atomic
from twinlaw.cli.console import stage
from twinlaw.workflows.diagnose.files import earlier_predictions, result_files, writable
from twinlaw.workflows.diagnose.material import read_material

PAGE = "twinlaw.pages.diagnose.report"


def diagnose_logs(plant: Path, logs: Sequence[Path], holdout: Sequence[Path], out: Path) -> Result:
    """Diagnose log files against a plant file and write all results into `out`; raises BadInput."""
    with writable(out):
        with stage("reading the logs and looking at them"):
            bound, material = read_material(plant, logs, holdout)
        with stage("searching for what the model lacks"), through_when_interrupted():
            Thread(target=_load_ahead, daemon=True).start()
            result = diagnose(bound, material)
        files = result_files(result, [path.name for path in logs])
        remove_all(earlier_predictions(out, files))
        for name, text in files.items():
            write_atomic(out / name, text)
    return result


def _load_ahead() -> None:
    """What the end needs takes a second to load, and Python has time while the filter runs; what fails to load is told where it is used."""
    with suppress(ImportError):
        for name in ("scipy.linalg", PAGE):
            import_module(name)
