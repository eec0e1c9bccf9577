"""Many diagnoses that know nothing of one another, side by side: their ends in order, for a person and for a program."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from diagnosis.diagnose import diagnose
from jobs.crew import Crew
from jobs.job import Done, Job
from jobs.keep import Folders
from records.diagnosis import Diagnosis, parse_diagnosis
from records.files import remove_all
from twinlaw.workflows.diagnose.files import ANSWER, earlier_predictions, result_files
from twinlaw.workflows.diagnose.material import read_material
from twinlaw.workflows.diagnose.parcel import Parcel, opened, parcel
from twinlaw.workflows.diagnose.questions import Question
from twinlaw.workflows.sweeping import swept


@dataclass(frozen=True)
class Answered:
    """A question's end: its diagnosis, or the sentence why there is none; `kept` if it had been answered before."""

    name: str
    diagnosis: Diagnosis | None
    failure: str | None
    kept: bool


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


def answer(asked: Parcel) -> dict[str, str]:
    """The files of the diagnosis by name; raises BadInput that names the parcel's files without the folder they were put into."""
    with opened(asked) as (plant, logs, holdout):
        result = diagnose(*read_material(plant, logs, holdout))
        return dict(result_files(result, [path.name for path in logs]))


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
    return [row(told) for told in facts(found)]


def row(told: Mapping[str, Any]) -> tuple[str, ...]:
    """What is told of one for a program, as a row below HEADING."""
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
