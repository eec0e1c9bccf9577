"""Many diagnoses that know nothing of one another: which questions a folder holds, what travels to a worker, what comes back."""

import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from diagnosis.diagnose import diagnose
from jobs.crew import Crew
from jobs.job import Done, Job
from jobs.keep import Folders
from records.diagnosis import Diagnosis, parse_diagnosis
from records.errors import BadInput
from records.files import remove_all
from replay.table import TABLE_NAME
from twinlaw.workflows.diagnose.files import ANSWER, earlier_predictions, result_files
from twinlaw.workflows.diagnose.material import read_material
from twinlaw.workflows.sweeping import swept

PLANT_NAME = "plant.toml"
HELD_OUT = "hold"  # what a case's logs to check on begin with


@dataclass(frozen=True)
class Question:
    """One diagnosis to be made, and the folder name of its answer."""

    name: str
    plant: Path
    logs: tuple[Path, ...]
    holdout: tuple[Path, ...]


@dataclass(frozen=True)
class Parcel:
    """A question with all its files' bytes, by their names in the parcel: what its answer depends on, and no path of this computer."""

    plant: str
    logs: tuple[str, ...]
    holdout: tuple[str, ...]
    files: Mapping[str, bytes]


@dataclass(frozen=True)
class Answered:
    """A question's end: its diagnosis, or the sentence why there is none; `kept` if it had been answered before."""

    name: str
    diagnosis: Diagnosis | None
    failure: str | None
    kept: bool


def questions(plant: Path, paths: Sequence[Path], holdout: Sequence[Path]) -> list[Question]:
    """A question for each log of `paths`: files; folders of logs, and folders of cases.

    A case is a folder with its own plant.toml, whose logs are explained together but those named hold*, which are held out. A log by
    itself is explained with `plant` and `holdout`. Raises BadInput where a folder holds nothing or two would have one name.
    """
    found: list[Question] = []
    for path in paths:
        inside = list(_inside(path, plant, holdout)) if path.is_dir() else [_alone(path, plant, holdout)]
        if not inside:
            remedy = "name a folder of logs with their sidecars, or of cases with a plant.toml each"
            raise BadInput("logs", str(path), "neither a run log nor a case", "at least one", remedy)
        found += inside
    names = [entry.name for entry in found]
    for name in names:
        if names.count(name) > 1:
            raise BadInput("logs", name, "two of this name", "names that differ", "rename one, or give another --out")
    return found


def _alone(path: Path, plant: Path, holdout: Sequence[Path]) -> Question:
    return Question(path.stem, plant, (path,), tuple(holdout))


def _inside(folder: Path, plant: Path, holdout: Sequence[Path]) -> Iterator[Question]:
    if (folder / PLANT_NAME).exists():
        logs = _logs_in(folder)
        told = tuple(path for path in logs if not path.stem.startswith(HELD_OUT))
        if told:
            kept = tuple(path for path in logs if path not in told)
            yield Question(folder.resolve().name, folder / PLANT_NAME, told, kept)
        return
    apart = {path.resolve() for path in holdout}
    yield from (_alone(path, plant, holdout) for path in _logs_in(folder) if path.resolve() not in apart)
    for sub in sorted(folder.iterdir()):
        if (sub / PLANT_NAME).exists():
            yield from _inside(sub, plant, ())


def _logs_in(folder: Path) -> list[Path]:
    """CSV files with a sidecar: what else lies in a folder, a prediction say, has none."""
    return sorted(path for path in folder.glob("*.csv") if path.with_suffix(".toml").exists())


def answers(asked: Sequence[Question], out: Path, crew: Crew) -> Iterator[Answered]:
    """The end of each question in order; its files in out/NAME, where whole answers to the same bytes are left as they are."""
    jobs = (Job(entry.name, answer, parcel(entry)) for entry in asked)
    for entry, done in zip(asked, swept("diagnosed", jobs, len(asked), crew, Folders(out, ANSWER)), strict=True):
        if done.failure is None:
            own = {f"prediction-{path.stem}.csv" for path in entry.holdout}
            remove_all(earlier_predictions(out / entry.name, own))
        yield Answered(done.name, _read(done), done.failure, done.kept)


def _read(done: Done) -> Diagnosis | None:
    return None if done.failure is not None else parse_diagnosis(json.loads(done.answer[ANSWER]), done.name)


def parcel(asked: Question) -> Parcel:
    """Read all files of a question; one that cannot be read is left to be missed by who needs it. Raises BadInput without its plant."""
    try:
        files = {f"plant/{asked.plant.name}": asked.plant.read_bytes()}
    except OSError as error:
        got = error.strerror or str(error)
        raise BadInput("plant file", str(asked.plant), got, "a readable file", "check the path") from error
    names = []
    for place, path in enumerate((*asked.logs, *asked.holdout)):
        names.append(f"{place}/{path.name}")
        for part in (path, path.with_suffix(".toml"), path.with_name(TABLE_NAME)):
            if part.is_file():
                files[f"{place}/{part.name}"] = part.read_bytes()
    split = len(asked.logs)
    return Parcel(f"plant/{asked.plant.name}", tuple(names[:split]), tuple(names[split:]), files)


def answer(asked: Parcel) -> dict[str, str]:
    """The files of the diagnosis by name; raises BadInput that names the parcel's files without the folder they were put into."""
    with opened(asked) as (plant, logs, holdout):
        result = diagnose(*read_material(plant, logs, holdout))
        return dict(result_files(result, [path.name for path in logs]))


@contextmanager
def opened(asked: Parcel) -> Iterator[tuple[Path, list[Path], list[Path]]]:
    """Its plant, logs and held-out logs as files of a folder that is there for the body; a BadInput of the body names them without it."""
    with tempfile.TemporaryDirectory() as work:
        for name, content in asked.files.items():
            (Path(work) / name).parent.mkdir(exist_ok=True)
            (Path(work) / name).write_bytes(content)
        logs, holdout = ([Path(work) / name for name in names] for names in (asked.logs, asked.holdout))
        try:
            yield Path(work) / asked.plant, logs, holdout
        except BadInput as error:
            raise _without(work, error) from error


def _without(folder: str, error: BadInput) -> BadInput:
    """The same error of files by their own names."""
    places = re.compile(rf"{re.escape(folder)}/\w+/")
    told = {name: places.sub("", getattr(error, name)) for name in ("what", "where", "got", "expected", "remedy")}
    return BadInput(**told)


def facts(found: Sequence[Answered]) -> list[dict[str, Any]]:
    """What is told of each for a program."""
    return [_facts(entry) for entry in found]


def _facts(entry: Answered) -> dict[str, Any]:
    told = entry.diagnosis
    if told is None:
        return {"name": entry.name, "failure": entry.failure}
    shrinkage = told.shrinkage
    return {
        "name": entry.name,
        "verdict": told.verdict,
        "false_alarm_probability": told.false_alarm_probability,
        "found": list(told.found),
        "first": {"effect": told.effects[0].effect, "probability": told.effects[0].probability}
        if told.effects
        else None,
        "fraction": None if shrinkage is None else shrinkage.fraction,
    }


HEADING = ("log", "verdict", "found", "most likely", "probability", "error gone")


def rows(found: Sequence[Answered]) -> list[tuple[str, ...]]:
    """The same for a person."""
    return [_row(_facts(entry)) for entry in found]


def _row(told: Mapping[str, Any]) -> tuple[str, ...]:
    if "failure" in told:
        return (told["name"], "not answered", "", "", "", "")
    first, fraction = told["first"], told["fraction"]
    return (
        told["name"],
        told["verdict"],
        " + ".join(told["found"]) or "nothing",
        first["effect"] if first else "",
        f"{first['probability']:.2f}" if first else "",
        "" if fraction is None else f"{fraction:.0%}",
    )
