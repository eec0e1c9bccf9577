"""Sealed cases answered by a baseline, side by side: what is asked of a worker, and what comes back."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from diagnosis.baselines import BASELINES
from jobs.crew import Crew
from jobs.job import Done, Job
from jobs.keep import Folders
from records.diagnosis import diagnosis_text
from records.log import load_log
from records.plant import load_plant
from sim.bind import bind
from sim.columns import log_columns
from twinlaw.workflows.diagnose.files import ANSWER
from twinlaw.workflows.diagnose.parcel import Parcel, opened, parcel
from twinlaw.workflows.diagnose.questions import Question
from twinlaw.workflows.sweeping import swept


@dataclass(frozen=True)
class PlainQuestion:
    """A case's nominal plant and logs, and the name of the baseline that is to answer."""

    baseline: str
    parcel: Parcel


def plain_answers(asked: Sequence[Question], baseline: str, out: Path, crew: Crew) -> Iterator[Done]:
    """The end of each question in order; its answer in out/NAME. Held-out logs are not looked at."""
    jobs = (
        Job(entry.name, plain_answer, PlainQuestion(baseline, parcel(replace(entry, holdout=())))) for entry in asked
    )
    return swept(f"answered by {baseline}", jobs, len(asked), crew, Folders(out, ANSWER))


def plain_answer(asked: PlainQuestion) -> dict[str, str]:
    """The text of diagnosis.json; raises BadInput that names the files."""
    with opened(asked.parcel) as (plant, logs, _):
        bound = bind(load_plant(plant))
        columns = log_columns(bound.model)
        found = BASELINES[asked.baseline](bound, [load_log(path, columns) for path in logs])
    return {ANSWER: diagnosis_text(found)}
